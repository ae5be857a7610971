"""Textures that change with the state of the contact: lines, and heights averaged under the patch."""

import math
from dataclasses import dataclass

import numpy as np
from scipy.fft import irfft, next_fast_len, rfft

from asperity.arguments import Array, ArrayLike, as_row, require
from asperity.kernels.curves import splines_along
from asperity.surfaces.strip import Rows, Strip
from asperity.threads import in_order, thread_count
from asperity.written_numbers import rounded


@dataclass(frozen=True, eq=False)
class StateTexture:
    """Filtered line textures along the path, one for each state (thesis Eq. 2.7).

    Between the approaches of the states the texture is interpolated linearly, outside them the nearest is
    used.
    """

    # (s, m), at state i and position m, m, positive *away* from the contact (h = −z)
    heights: Array
    approaches: Array  # (s,), of the states, m, increasing
    start: float  # position of the first point on the path, m
    spacing: float  # distance of the points, m

    def __post_init__(self) -> None:
        heights = np.atleast_2d(np.asarray(self.heights, dtype=float))
        approaches = as_row(self.approaches)
        object.__setattr__(self, "heights", heights)
        object.__setattr__(self, "approaches", approaches)

    @classmethod
    def unfiltered(cls, heights: ArrayLike, spacing: float, start: float = 0.0) -> "StateTexture":
        """One line texture (m,) for all states, m, positive away from the contact, from a position on, m."""
        return cls(np.atleast_2d(np.asarray(heights, dtype=float)), np.zeros(1), start, spacing)

    def held_at(self, approach: float) -> "StateTexture":
        """One line texture for all states: that at an approach, m."""
        states = self.approaches
        above = int(np.clip(np.searchsorted(states, approach), 1, max(len(states) - 1, 1)))
        lower = above - 1
        upper = min(above, len(states) - 1)
        step = states[upper] - states[lower]
        share = float(np.clip((approach - states[lower]) / step, 0.0, 1.0)) if step else 0.0
        heights = (1.0 - share) * self.heights[lower] + share * self.heights[upper]
        return StateTexture.unfiltered(heights, self.spacing, self.start)

    def with_fewer_states(self, share: float) -> "StateTexture":
        """The same without states that straight lines between those kept miss by no more than a share.

        That is of its largest height. A state is kept from which no line reaches further.
        """
        states = self.approaches
        heights = self.heights
        allowed = share * float(np.abs(heights).max(initial=0.0))
        if np.abs(heights - heights[0]).max(initial=0.0) <= allowed:
            return StateTexture(heights[:1], states[:1], self.start, self.spacing)
        kept = [0]
        for end in range(2, len(states)):
            first = kept[-1]
            along = ((states[first:end] - states[first]) / (states[end] - states[first]))[:, None]
            line = (1.0 - along) * heights[first] + along * heights[end]
            if np.abs(heights[first:end] - line).max() > allowed:
                kept.append(end - 1)
        kept.append(len(states) - 1)
        return StateTexture(heights[kept], states[kept], self.start, self.spacing)

    def at(self, positions: ArrayLike) -> Array:
        """Texture (n, s), m, of every state at positions (n,) on the path, m, by cubic splines along it."""
        return along_path("state texture", self.heights, self.start, self.spacing, positions)


def along_path(what: str, values: Array, start: float, spacing: float, positions: ArrayLike) -> Array:
    """Natural cubic splines (n, s) of rows (s, m) along a path, at positions (n,), m.

    The rows are sampled at ``start + spacing * arange(m)``; `what` they are is for the message.
    """
    index = grid_index(what, values.shape[1], start, spacing, positions)
    if not values.any():  # as on perfect surfaces
        return np.zeros((len(index), len(values)))
    return splines_along(np.ascontiguousarray(values, dtype=float), index)


def grid_index(what: str, points: int, start: float, spacing: float, positions: ArrayLike) -> Array:
    """Places, from 0 to points − 1, of positions on the path, m, on the grid of a state function.

    Its points begin at `start` and are a spacing apart, m; `what` is known there is for the message.
    """
    index = (as_row(positions) - start) / spacing
    last = points - 1
    slack = 1e-6  # of a spacing: rounding of the positions
    least = index.min()
    most = index.max()
    received = f"{start + spacing * least:.6g} to {start + spacing * most:.6g}"
    allowed = f"{start:.6g} to {start + spacing * last:.6g}, where the {what} is known"
    inside = least >= -slack and most <= last + slack
    require(inside, "path (m)", received, allowed, "Shorten the duration or provide a longer texture.")
    return np.clip(index, 0.0, last)


CONVOLVED = 2**14


class LongConvolution:
    """Convolution with weights (s, c, t), which are transformed once for all rows, and these for all weights.

    Results come in pieces of at most so many (overlap-save).
    """

    def __init__(self, weights: Array, piece: int = CONVOLVED) -> None:
        self.reach = weights.shape[-1] - 1
        self.piece = piece
        self.period = next_fast_len(piece + self.reach, real=True)
        self.transfer = rfft(weights, self.period)

    def of(self, rows: Array) -> Array:
        """Convolve rows (c, n), where weights lie on them as a whole, and add them up: (s, n − t + 1)."""
        count = rows.shape[-1] - self.reach
        result = np.empty((len(self.transfer), count))
        for first in range(0, count, self.piece):
            spectrum = rfft(rows[:, first : first + self.piece + self.reach], self.period)
            found = irfft(np.einsum("cf,scf->sf", spectrum, self.transfer), self.period)
            last = min(first + self.piece, count)
            result[:, first:last] = found[:, self.reach : self.reach + last - first]
        return result


PIECE = 2**11
"""Rows averaged in one go: few, so that their spectra stay in the processor's cache."""
AT_ONCE = 4
"""Pieces averaged at once, on threads: more would take memory, and wait for the interpreter."""

_NODES, _WEIGHTS = np.polynomial.legendre.leggauss(12)  # so weights are even to the last bit


def punch_weights(spacing: tuple[float, float], semi_axes: tuple[float, float]) -> Array:
    """Share (odd, odd) of the flat-punch pressure on each cell of a grid under an elliptic patch.

    (dx, dy) and the semi-axes (a_x, a_y) in m, the patch centred on the middle cell; the weights sum to one.
    w(ξ, η) = 1/(2π a_x a_y √(1 − ξ²/a_x² − η²/a_y²)), integrated over x in closed form and over y by Gauss's
    rule after y = a_y sin θ. By reciprocity this is the weight with which small heights enter the force of a
    Hertzian contact at constant approach; its transform is sin q/q, q² = (k_x a_x)² + (k_y a_y)².
    """
    dx, dy = spacing
    a, b = semi_axes
    columns = max(0, math.ceil(b / dy - 0.5))
    rows = max(0, math.ceil(a / dx - 0.5))
    edges_y = np.clip((np.arange(-columns, columns + 2) - 0.5) * dy / b, -1.0, 1.0)
    edges_x = (np.arange(-rows, rows + 2) - 0.5) * dx
    low = np.arcsin(edges_y[:-1])
    high = np.arcsin(edges_y[1:])
    theta = 0.5 * (low + high)[:, None] + 0.5 * (high - low)[:, None] * _NODES
    chord = a * np.cos(theta)
    cumulative = np.arcsin(np.clip(edges_x[:, None, None] / chord, -1.0, 1.0)) / math.pi
    inside = np.diff(cumulative, axis=0) * np.cos(theta)
    return 0.5 * np.sum(inside * _WEIGHTS, axis=2) * 0.5 * (high - low)


def areal_texture(
    heights: Array | Strip,
    spacing: tuple[float, float],
    approaches: ArrayLike,
    semi_axes: ArrayLike,
    start: float = 0.0,
) -> StateTexture:
    """Average a strip of texture under the flat-punch weight of the patch of each state: h̃_a, m.

    Heights (n, ny), m, peaks positive; the contact runs along the middle of the strip, so ny is odd, and the
    strip at least as wide as the widest patch. Approaches (k,), m, and semi-axes (k, 2) (a_x, a_y) of the
    nominal patch of each state, m; `start` is the position of the first row, m. The result is positive away
    from the contact; its ends, one semi-axis long, see zeros beyond the strip. Of heights that are alike all
    across one line is averaged. Pieces are made and averaged on threads; their number changes no digit.
    """
    axes = np.atleast_2d(np.asarray(semi_axes, dtype=np.float64))
    strip = Rows(heights) if isinstance(heights, np.ndarray) else heights
    n, ny = strip.shape
    width = ny * spacing[1]
    widest = 2 * axes[:, 1].max()
    allowed = f"at least the width of the widest patch, {rounded(widest)} m"
    received = f"{rounded(width)} m"
    remedy = "Enlarge contact.window."
    require(widest <= width, "width of the texture strip", received, allowed, remedy)
    if isinstance(heights, np.ndarray) and (heights == heights[:, :1]).all():
        strip = Rows(heights[:, :1])
        if not heights.any():
            return StateTexture(np.zeros((len(axes), n)), np.asarray(approaches, float), start, spacing[0])
    middle = strip.shape[1] // 2
    under = [punch_weights(spacing, (float(a), float(b))) for a, b in axes]
    halves = [_half(each if middle else each.sum(axis=1, keepdims=True), middle) for each in under]
    reach = max(half.shape[0] // 2 for half in halves)
    weights = np.zeros((len(halves), max(half.shape[1] for half in halves), 2 * reach + 1))
    for row, half in zip(weights, halves, strict=True):
        side = reach - half.shape[0] // 2
        row[: half.shape[1], side : 2 * reach + 1 - side] = -half.T
    averages = _averages(strip, weights)
    return StateTexture(averages, np.asarray(approaches, dtype=np.float64), start, spacing[0])


def _averages(strip: Strip, weights: Array) -> Array:
    """Averages (s, n), m, of a strip under weights (s, c, odd), even across, from its middle line on."""
    n = strip.shape[0]
    middle = strip.shape[1] // 2
    reach = weights.shape[2] // 2
    convolution = LongConvolution(weights, min(PIECE, n))

    def averaged(first: int) -> Array:
        low = max(0, first - reach)
        high = min(n, first + PIECE + reach)
        rows = strip.rows(low, high)
        folded = rows[:, middle : middle + weights.shape[1]].copy()
        folded[:, 1:] += rows[:, middle - 1 :: -1][:, : folded.shape[1] - 1] if middle else 0.0
        last = min(first + PIECE, n)
        beyond = (reach - (first - low), reach - (high - last))  # zeros
        return convolution.of(np.pad(folded.T, ((0, 0), beyond)))

    firsts = range(0, n, PIECE)
    workers = min(thread_count(), len(firsts), AT_ONCE)
    averages = np.empty((len(weights), n))
    for first, found in zip(firsts, in_order(averaged, firsts, workers), strict=True):
        averages[:, first : first + PIECE] = found
    return averages


def _half(weights: Array, middle: int) -> Array:
    """Columns of the weights from the middle on, no more than half a strip has."""
    return weights[:, weights.shape[1] // 2 :][:, : middle + 1]
