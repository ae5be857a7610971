"""The force over the approach: the curve of an ensemble of samples, and a table all along a path."""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from asperity.arguments import Array, ArrayLike, positive, require
from asperity.contact.halfspace import HalfSpace
from asperity.contact.pressed import block_of, solve_block
from asperity.contact.scan import Counts, total, warn_of_flaws
from asperity.kernels.curves import (
    OVERLAP,
    continued_to_touch,
    cubic_coefficients,
    monotone_slopes,
    splines_along,
)
from asperity.progress import Progress, counted
from asperity.reduction.texture import grid_index
from asperity.threads import in_order


@dataclass(frozen=True, eq=False)
class ForceCurve:
    """Contact force as a monotone, once differentiable function of the approach.

    The curve is a monotone piecewise cubic of ``g = F**(1/exponent)``: with the exponent 3/2 a Hertzian
    contact is a straight line in g, so the interpolation is exact for it and the square-root start of the
    stiffness needs no polynomial. Below the first knot the force is zero (unless `bilateral`, into tension);
    above the last one g goes on with its end slope.
    """

    knots: Array  # (k,), approaches, m, increasing
    # (k − 1, 4), of g in each interval, highest power first, in (approach − knot)
    coefficients: Array
    exponent: float = 1.5  # of g in the force
    upper: float = np.inf  # largest approach that the data cover, m; beyond it the curve is a continuation
    bilateral: bool = False

    @classmethod
    def from_samples(
        cls, approach: ArrayLike, force: ArrayLike, exponent: float = 1.5, stiffness: ArrayLike | None = None
    ) -> "ForceCurve":
        """Curve through computed pairs of approach, m, increasing, and force, N, with dF/ds, N/m, if known.

        Forces are not negative, increase once positive, and at least two are. The exponent is that of the
        start of the force, 3/2 for contact of solids. First touch lies where g, continued straight below its
        first positive sample, vanishes, but not below the last sample with zero force.
        """
        s = np.asarray(approach, dtype=float)
        f = np.asarray(force, dtype=float)
        _check_samples(f)
        g = continued_to_touch(s, f[None] ** (1.0 / exponent))[0]
        first = int(np.argmax(g > 0.0))
        slope = np.diff(g)[first - 1] / np.diff(s)[first - 1] if first else monotone_slopes(s, g)[0]
        s = s[first:]
        g = g[first:]
        s = np.concatenate([[s[0] - g[0] / slope], s])
        g = np.concatenate([[0.0], g])
        slopes = monotone_slopes(s, g)
        if stiffness is not None:
            known = np.asarray(stiffness, dtype=float)[first:] / (exponent * g[1:] ** (exponent - 1.0))
            secants = np.diff(g) / np.diff(s)
            # up to three times the secants beside it a cubic is monotone
            slopes[1:] = np.minimum(known, 3.0 * np.minimum(secants, np.append(secants[1:], secants[-1])))
        return cls(s, cubic_coefficients(s, g, slopes), exponent, float(s[-1]))

    @classmethod
    def hertz(cls, stiffness: float) -> "ForceCurve":
        """Hertzian point contact, F = K s^1.5, exact everywhere; K in N/m^1.5, 4/3 E* sqrt(R) for a ball."""
        slope = float(np.cbrt(positive("Hertz constant (N/m^1.5)", stiffness))) ** 2
        return cls(np.array([0.0, 1.0]), np.array([[0.0, 0.0, slope, 0.0]]))

    @classmethod
    def linear(cls, force: float, stiffness: float, approach: float = 0.0) -> "ForceCurve":
        """Linear spring through a working point, N, N/m and m, acting in tension too."""
        positive("contact stiffness (N/m)", stiffness)
        knots = np.array([approach, approach + 1.0])
        return cls(knots, np.array([[0.0, 0.0, stiffness, force]]), 1.0, bilateral=True)

    @property
    def first_touch(self) -> float:
        """Approach below which the force is zero, m (minus infinity for a bilateral curve)."""
        return -np.inf if self.bilateral else float(self.knots[0])

    def force(self, approach: ArrayLike) -> Array:
        """Contact force, N, at approaches, m."""
        g, _ = self._root(np.asarray(approach, dtype=float))
        return g if self.exponent == 1.0 else g**self.exponent

    def stiffness(self, approach: ArrayLike) -> Array:
        """Tangent stiffness dF/ds, N/m, at approaches, m."""
        g, slope = self._root(np.asarray(approach, dtype=float))
        return slope if self.exponent == 1.0 else self.exponent * g ** (self.exponent - 1.0) * slope

    def secant(self, approach: ArrayLike, datum: float) -> Array:
        """Secant stiffness k_c(r) = F/r, N/m, on the state r = approach + datum (thesis Eq. 2.3).

        Zero where r <= 0. The datum, m, is at least minus the first touch, so that r > 0 in contact.
        """
        state = np.asarray(approach, dtype=float) + datum
        return np.where(state > 0.0, self.force(approach) / np.where(state > 0.0, state, 1.0), 0.0)

    def inverse(self, force: ArrayLike) -> Array:
        """Approach, m, at which the curve has a force, N; the first touch for zero force.

        A force is not negative unless the curve is bilateral.
        """
        f = np.asarray(force, dtype=float)
        remedy = "A contact without adhesion only pushes."
        pushing = self.bilateral or np.all(f >= 0.0)
        require(pushing, "contact force (N)", f.min(initial=0.0), "zero or more", remedy)
        g = f if self.exponent == 1.0 else f ** (1.0 / self.exponent)
        interval = np.clip(np.searchsorted(self.coefficients[:, 3], g) - 1, 0, len(self.coefficients) - 1)
        cubic, square, slope, value = np.moveaxis(self.coefficients[interval], -1, 0)
        start = self.knots[interval]
        straight = start + (g - value) / slope
        curved = (cubic != 0.0) | (square != 0.0)
        if not curved.any():
            return straight
        low = start
        high = self.knots[interval + 1]
        for _ in range(65):  # halving a cubic's interval to rounding
            middle = 0.5 * (low + high)
            if np.all((middle == low) | (middle == high)):
                break
            within = middle - start
            below = ((cubic * within + square) * within + slope) * within + value < g
            low = np.where(below, middle, low)
            high = np.where(below, high, middle)
        end_value, end_slope = self._root(self.knots[-1])
        beyond = self.knots[-1] + (g - end_value) / end_slope
        return np.where(curved, np.where(g > end_value, beyond, middle), straight)

    def _root(self, s: Array) -> tuple[Array, Array]:
        """The interpolated g and its slope."""
        interval = np.clip(np.searchsorted(self.knots, s, side="right") - 1, 0, len(self.coefficients) - 1)
        cubic, square, slope, value = np.moveaxis(self.coefficients[interval], -1, 0)
        u = s - self.knots[interval]
        width = (self.knots[1:] - self.knots[:-1])[interval]
        within = np.clip(u, 0.0, width)
        g = ((cubic * within + square) * within + slope) * within + value
        derivative = (3.0 * cubic * within + 2.0 * square) * within + slope
        g = g + derivative * (u - within)
        if self.bilateral:
            return g, derivative
        touching = s > self.knots[0]
        return np.where(touching, np.maximum(g, 0.0), 0.0), np.where(touching, derivative, 0.0)


def _check_samples(force: Array) -> None:
    what = "forces of the force curve"
    positive = force > 0.0
    negative = np.count_nonzero(force < 0.0)
    received = f"{positive.sum()} positive and {negative} negative forces"
    remedy = "Choose contact.approaches that reach into the contact."
    enough = positive.sum() >= 2 and not negative
    require(enough, what, received, "at least two positive, none negative", remedy)
    received = "forces that fall or stay while the approach grows"
    remedy = "Raise contact.samples, or lower numerics.force_accuracy."
    rising = np.diff(force[np.argmax(positive) :]) > 0.0
    require(rising.all(), what, received, "strictly increasing forces once in contact (N)", remedy)


def isolated_share(pressure: Array) -> float:
    """Share of the force on cells that touch alone: asperities that the grid does not resolve.

    Of a pressure (nx, ny), Pa; 0 without contact. Cells count as alone where none of their four neighbours is
    in contact.
    """
    total = float(pressure.sum())
    touching = np.pad(pressure > 0.0, 1)
    beside = touching[:-2, 1:-1] | touching[2:, 1:-1] | touching[1:-1, :-2] | touching[1:-1, 2:]
    return float(pressure[~beside].sum()) / total if total > 0.0 else 0.0


TANGENT = 1e-4
"""Relative residual of the tangent stiffnesses of a loading curve."""


@dataclass(frozen=True, eq=False)
class StiffnessEnsemble:
    """Loading curves of N samples at common approaches."""

    approaches: Array  # (k,), from the samples' patch planes, m, positive closing
    forces: Array  # (N, k), N
    tangents: Array  # (N, k), dF/d(approach) of the solved contacts, N/m
    datum: float
    """d0, m: the state is r = approach + d0, one offset for all samples, no less than the highest first
    touch, so that F(r = 0) = 0 for each of them."""
    held: int  # states, from the lowest, in which the window holds the contacts of all samples

    @property
    def mean_force(self) -> Array:
        """Ensemble mean of the force, N, shape (k,)."""
        return self.forces.mean(axis=0)

    @property
    def force_spread(self) -> Array:
        """Standard deviation of the force between samples, N, shape (k,)."""
        if len(self.forces) < 2:
            return np.zeros(self.forces.shape[1])
        return self.forces.std(axis=0, ddof=1)

    @property
    def states(self) -> Array:
        """States r = approach + d0, m, shape (k,)."""
        return self.approaches + self.datum

    @property
    def curve(self) -> ForceCurve:
        """f(approach): monotone fit through the ensemble mean, with its slopes; k_c(r) = f/r (Eq. 2.3)."""
        return ForceCurve.from_samples(self.approaches, self.mean_force, stiffness=self.tangents.mean(axis=0))


def patches(maps: Sequence[Array], shape: tuple[int, int], count: int, weights: Array) -> list[Array]:
    """Cut at least so many samples of (nx, ny) cells out of maps, each levelled to the plane its patch feels.

    Samples are spread evenly over the maps, at least one from each, overlapping if need be; heights in m.
    The weights are from `punch_weights` at the working load: wavelengths longer than the patch, which the
    texture of the path carries, must not be counted a second time inside the samples.
    """
    result = []
    for index, heights in enumerate(maps):
        rows, lines = heights.shape
        spare = (heights.shape[0] - shape[0], heights.shape[1] - shape[1])
        allowed = f"no more than the map's {rows} × {lines} cells at this spacing"
        remedy = "Choose a smaller contact.window or provide larger maps."
        received = f"{shape[0]} × {shape[1]} cells"
        require(min(spare) >= 0, "window of the contact", received, allowed, remedy)
        for i, j in _spread(spare, samples_of_maps(len(maps), count)[index]):
            cut = heights[i : i + shape[0], j : j + shape[1]]
            result.append(cut - weighted_mean(cut, weights))
    return result


def samples_of_maps(maps: int, count: int) -> list[int]:
    """How many of at least so many samples are cut out of each of some maps."""
    return [max(count // maps + (index < count % maps), 1) for index in range(maps)]


def _spread(spare: tuple[int, int], count: int) -> list[tuple[int, int]]:
    """`count` offsets spread evenly over a rectangle: the points of a rank-one lattice."""
    golden = 0.5 * (np.sqrt(5.0) - 1.0)
    along = (np.arange(count) + 0.5) / count
    across = np.mod(0.5 + golden * np.arange(count), 1.0)
    return [(round(u * spare[0]), round(v * spare[1])) for u, v in zip(along, across, strict=True)]


def weighted_mean(heights: Array, weights: Array) -> float:
    """Mean height, m, under a patch at the middle of a sample of odd sides, by its `punch_weights`."""
    mx, my = (min(w, h) // 2 for w, h in zip(weights.shape, heights.shape, strict=True))
    cx = heights.shape[0] // 2
    cy = heights.shape[1] // 2
    wx = weights.shape[0] // 2
    wy = weights.shape[1] // 2
    inner = weights[wx - mx : wx + mx + 1, wy - my : wy + my + 1]
    return float(np.vdot(heights[cx - mx : cx + mx + 1, cy - my : cy + my + 1], inner) / inner.sum())


def stiffness_ensemble(
    samples: Sequence[Array],
    half_space: HalfSpace,
    body: Array,
    approaches: Array,
    datum: float,
    *,
    rtol: float = 1e-6,
    workers: int | None = None,
    progress: Progress | None = None,
    tolerance: str = "rtol",
    remedy: str = "Enlarge the window.",
) -> StiffnessEnsemble:
    """Press the body on each of the samples (nx, ny) from `patches`, stepping the approach (k,) up.

    Half-space, body and `rtol` are as in `ScanJob`, `datum` is d0 in m; `tolerance` and `remedy` say what to
    do about contacts that do not converge or are cut off, as in `warn_of_flaws`.
    """

    cell = half_space.cell_area

    def load(sample: Array) -> tuple[Array, Array, Counts]:
        block = solve_block(half_space, block_of(half_space, sample, body, np.zeros(1), approaches, 1, rtol))
        forces = cell * block.totals[:, 0]
        tangents = [
            half_space.tangent_stiffness(pressure, TANGENT) if force > 0.0 else 0.0
            for force, pressure in zip(forces, block.pressures[0], strict=True)
        ]
        return forces, np.array(tangents), Counts(*block.counts.tolist())

    pressed = in_order(load, samples, workers)
    scans = list(counted(pressed, len(samples), "pressing the samples", progress))
    forces, tangents = (np.array([scanned[i] for scanned in scans]) for i in (0, 1))
    counts = [scanned[2] for scanned in scans]
    warn_of_flaws(total(counts), "the loading curves", tolerance, remedy)
    cut_off = max(each.truncated for each in counts)  # contacts grow: the highest states are cut off
    return StiffnessEnsemble(
        np.asarray(approaches, dtype=np.float64), forces, tangents, datum, len(approaches) - cut_off
    )


PIECE = 8192
"""Positions worked on in one go."""


@dataclass(frozen=True, eq=False)
class ForceTable:
    """Contact force at positions of the path and states of the contact, at least two."""

    # (s, m), at state i and position m, N, not negative; not falling with the approach but by accuracy
    forces: Array
    approaches: Array  # (s,), of the states, m, increasing
    start: float  # position of the first point on the path, m
    spacing: float  # distance of the points, m
    touches: Array  # (m,), approach at which contact begins, m

    def at(self, positions: ArrayLike) -> Array:
        """Forces (n, s), N, at positions (n,), m, by cubic splines: not negative, not falling with states."""
        count = self.forces.shape[1]
        index = grid_index("force table", count, self.start, self.spacing, positions)
        result = np.empty((index.size, len(self.approaches)))
        for i in range(0, index.size, PIECE):
            piece = index[i : i + PIECE]
            first = max(0, int(piece.min()) - OVERLAP)
            stop = min(count, int(piece.max()) + 2 + OVERLAP)
            known = np.ascontiguousarray(self.forces[:, first:stop])
            result[i : i + PIECE] = splines_along(known, piece - first)
        # a spline may undershoot beside a place where contact is lost
        np.maximum(result, 0.0, out=result)
        for lower, upper in pairwise(result.T):
            np.maximum(lower, upper, out=upper)
        return result

    def touch_at(self, positions: ArrayLike) -> Array:
        """Approach at first touch at positions (n,), m, interpolated linearly."""
        at = self.start + self.spacing * np.arange(self.forces.shape[1])
        return np.interp(np.asarray(positions, dtype=float), at, self.touches)
