"""The exact receptance of a rail on supports that repeat after a cell of many, none of them alike.

The free rail carries two waves each way; a support is a point force that scatters them. All that is computed
decays: what a stretch reflects and lets through (never what it would take to undo it), the reflection of
half a track by doubling the cell, and from there waves that are carried from support to support.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import NamedTuple

import numpy as np

from asperity.arguments import Array, Complex
from asperity.structures.periodic_rail import refuse_decay, whole_power

_TRANSMITTED = 1e-9  # amplitude through half a track, from which on its end is not felt: squared it is 1e-18
_DOUBLINGS = 64
_SAME = 1e-9  # of the cell: a place as near to a support is at it


@dataclass(frozen=True, eq=False)
class CellWaves:
    """The two Floquet waves of a rail whose supports repeat after a cell, at each frequency.

    It answers as `asperity.structures.periodic_rail.PeriodicWaves` for a stretch of the track, by default the
    cell from its first support on: G(x|x0) = sum_j multipliers_j**p outgoing(xi)_j incoming(x0)_j. `bay` is
    the same for one of equal parts of the cell; waves change their scale from support to support, so that
    none leaves the range of doubles in a long cell.

    Between two supports a wave is sum_i forth_i exp(-i k_i xi) + back_i exp(-i k_i (l - xi)), l the distance
    of the supports.
    """

    wavenumbers: Complex  # (2, f), k_i of the free rail, rad/m, Im k_i <= 0
    edges: Array  # (n + 1,), places of the supports, from zero, and the end of the cell, m
    decaying: Complex  # (n, 2, 2, 2, f), waves that decay: axes (span, forth or back, i, wave, f)
    growing: Complex  # (n, 2, 2, 2, f), waves that grow, m/N
    steps: Complex  # (n, 2, f), change of scale from a span to the next
    start: float  # of the stretch, m
    spacing: float  # its length, m
    bays: int = 1  # equal parts of the cell

    @property
    def coefficients(self) -> Complex:
        """One (2, f): the growing waves hold them."""
        return np.ones_like(self.wavenumbers)

    @cached_property
    def multipliers(self) -> Complex:
        """Change of each wave over the stretch (2, f)."""
        return self._carried(self._span(0.0)[0], self._span(self.spacing)[0])

    def bay(self, number: int) -> "CellWaves":
        """One of the equal parts of the cell, counted from the first support; it goes on in the next cell."""
        length = self.edges[-1] / self.bays
        return replace(self, start=number % self.bays * length, spacing=length)

    def at_first(self, count: int) -> "CellWaves":
        """The same waves at so many of its frequencies, the first."""
        kept = (each[..., :count] for each in (self.wavenumbers, self.decaying, self.growing, self.steps))
        wavenumbers, decaying, growing, steps = kept
        return replace(self, wavenumbers=wavenumbers, decaying=decaying, growing=growing, steps=steps)

    @property
    def spans(self) -> "list[CellWaves]":
        """Stretches of the cell from each support to the next."""
        ends = zip(self.edges[:-1], np.diff(self.edges), strict=True)
        return [replace(self, start=float(start), spacing=float(length)) for start, length in ends]

    def carried(self, first: int, last: int, zone: slice = slice(None)) -> Complex:
        """Change of each wave (2, f) from one equal part to another, in either direction, in a zone of f."""
        whole = replace(self, start=0.0)
        length = self.edges[-1] / self.bays
        begin, end = (whole._span(bay * length)[0] for bay in sorted((first, last)))
        return self._carried(begin, end, zone)

    def outgoing(self, x: float) -> Complex:
        """Shapes (2, f) of the waves that decay towards growing x, 0 <= x <= spacing, m."""
        first, at = self._place(x)
        return self._carried(first, at[0]) * self._shape(self.decaying, at[0], self._parts(*at))

    def incoming(self, x: float) -> Complex:
        """Shapes (2, f) of the waves that grow towards growing x, 0 <= x <= spacing, m, in m/N."""
        first, at = self._place(x)
        return self._shape(self.growing, at[0], self._parts(*at)) / self._carried(first, at[0])

    def symmetric_shapes(self, places: Array) -> tuple[Complex, Complex]:
        """Shapes at any places (p,), m, two of (p, 2, f): of the decaying waves and of the growing ones."""
        outgoing, incoming = np.empty((2, len(places), *self.wavenumbers.shape), complex)
        for n, x in enumerate(places):
            first, at = self._place(float(x))
            carried = self._carried(first, at[0])
            parts = self._parts(*at)
            outgoing[n] = carried * self._shape(self.decaying, at[0], parts)
            incoming[n] = self._shape(self.growing, at[0], parts) / carried
        return outgoing, incoming

    def shapes_at_nodes(self, count: int) -> tuple[Complex, Complex]:
        """As `symmetric_shapes`, at the ends of so many equal parts of the stretch."""
        return self.symmetric_shapes(np.linspace(0.0, self.spacing, count + 1))

    def receptance(self, x: float, x0: float) -> Complex:
        """Displacement at `x` per force at `x0`, (f,), m/N; positions from the first support, m."""
        whole = replace(self, start=0.0)
        first = whole._span(min(x, x0))
        last = whole._span(max(x, x0))
        parts = self._parts(*last)
        decaying = self._shape(self.decaying, last[0], parts)
        waves = decaying * self._shape(self.growing, first[0], parts if x == x0 else self._parts(*first))
        return np.sum(waves * self._carried(first[0], last[0]), axis=0)

    def receptances(self, places: Sequence[float], x0: float) -> list[Complex]:
        """Displacements (f,), m/N, at places per force at `x0`; from the first support, m."""
        return [self.receptance(place, x0) for place in places]

    def _span(self, x: float) -> tuple[int, float]:
        """Number of the span at a place of the stretch, counted on through the cells, and the place in it."""
        at = self.start + x
        period = self.edges[-1]
        cell = int(np.floor(at / period + _SAME))
        place = at - cell * period
        inside = int(np.searchsorted(self.edges[1:-1], place + _SAME * period, side="right"))
        return cell * len(self.steps) + inside, place - self.edges[inside]

    def _place(self, x: float) -> tuple[int, tuple[int, float]]:
        """Span in which the stretch begins; that of a place and the place in it, refused if too far on."""
        first, before = self._span(0.0)
        refuse_decay(self.wavenumbers.imag * (before + x))
        return first, self._span(x)

    def _carried(self, first: int, last: int, zone: slice = slice(None)) -> Complex:
        """Change of each wave (2, f) from one span to a later one."""
        cells, rest = divmod(last - first, len(self.steps))
        steps = self.steps[..., zone]
        around = whole_power(np.prod(steps, axis=0), cells)
        for span in range(first, first + rest):
            around = around * steps[span % len(steps)]
        return around

    def _parts(self, span: int, place: float) -> Complex:
        """Free waves from both ends of a span at a place in it (2, 2, f)."""
        inside = span % len(self.steps)
        ends = np.array([place, self.edges[inside + 1] - self.edges[inside] - place])
        return np.exp(-1j * ends[:, None, None] * self.wavenumbers)

    def _shape(self, waves: Complex, span: int, parts: Complex) -> Complex:
        """Waves (2, f) in a span, in its own scale, by `_parts` at a place."""
        return np.einsum("eif,eijf->jf", parts, waves[span % len(self.steps)])


def cell_waves(
    wavenumbers: Complex, amplitudes: Complex, supports: Complex, lengths: Array, bays: int = 1
) -> CellWaves:
    """Floquet waves of a rail on n supports that repeat, from the receptance of the free rail.

    As `asperity.structures.periodic_rail.periodic_waves`, which is the same for n = 1: wavenumbers k_i,
    rad/m, and amplitudes A_i, m/N, of G_0(x) = sum_i A_i exp(-i k_i |x|), (2, f), and dynamic stiffnesses
    (n, f), N/m, each followed by a distance to the next (n,), m. Frequencies have a positive real part or
    lie in the lower half-plane. An `InputError` says if a free wave decays by more than exp(-200) from one
    support to the next.

    At a support a force F = -K w sends A_i F both ways. With the reflection Q of all that is behind it, b = Q
    a, this makes a = (I - g A y^T) a' of the amplitudes a' before it, y^T = 1^T (I + Q), g = K/(1 + K y^T A),
    and the reflection before it Q - g (I + Q) A y^T. Growing waves are those of the other half of the track
    whose bilinear concomitant sum_i (a_i b'_i - b_i a'_i)/A_i with the decaying wave of their number is one,
    and zero with the other.
    """
    refuse_decay(wavenumbers.imag * np.max(lengths))
    decays = np.exp(-1j * wavenumbers * np.asarray(lengths)[:, None, None])  # (n, 2, f)
    right = _half(amplitudes, supports, decays)
    left = _half(amplitudes, supports[::-1], np.roll(decays, 1, axis=0)[::-1]).reflection[::-1]
    decaying, growing = np.empty((2, len(supports), 2, 2, 2, decays.shape[-1]), complex)
    steps = _carry(amplitudes, supports, decays, right, decaying[:, 0])
    for span, decay in enumerate(decays[:, :, None]):
        forth = decaying[span, 0]
        decaying[span, 1] = back = _times(right.reflection[(span + 1) % len(supports)], decay * forth)
        leak = _times((back * decay / amplitudes[:, None]).swapaxes(0, 1), left[span])
        dual = _inverse((forth / amplitudes[:, None]).swapaxes(0, 1) - leak)
        growing[span] = _times(left[span], dual), dual / decay
    edges = np.concatenate([[0.0], np.cumsum(lengths)])
    return CellWaves(wavenumbers, edges, decaying, growing, steps, 0.0, float(edges[-1]), bays)


class _Half(NamedTuple):
    """Half a track, that looks forwards, before each of its supports."""

    reflection: Complex  # (n, 2, 2, f), before each support
    force: Complex  # (n, f), g
    felt: Complex  # (n, 2, f), y


def _half(amplitudes: Complex, supports: Complex, decays: Complex) -> _Half:
    """Half a track, from supports (n, f) and how waves decay behind each (n, 2, f)."""
    cell = _scattering(amplitudes, supports, decays)
    for _ in range(_DOUBLINGS):
        if np.abs(cell[1]).max(initial=0.0) < _TRANSMITTED:
            break
        cell = _joined(cell, cell)
    reflection = cell[0]
    found: list[tuple[Complex, Complex, Complex]] = []
    for support, decay in zip(supports[::-1], decays[::-1], strict=True):
        behind = decay[:, None] * reflection * decay
        felt = 1.0 + behind.sum(axis=0)
        force = support / (1.0 + support * np.sum(felt * amplitudes, axis=0))
        sent = amplitudes + np.einsum("ijf,jf->if", behind, amplitudes)
        reflection = behind - force * sent[:, None] * felt
        found.append((reflection, force, felt))
    return _Half(*(np.stack(each) for each in zip(*found[::-1], strict=True)))


_Scattering = tuple[Complex, Complex, Complex, Complex]
"""Of a stretch, (2, 2, f) each: reflected from the left, sent right, sent left, reflected from the right."""


def _scattering(amplitudes: Complex, supports: Complex, decays: Complex) -> _Scattering:
    """Scattering of a cell, each support followed by a span."""
    one = np.eye(2)[:, :, None]
    cell: _Scattering | None = None
    for support, decay in zip(supports, decays, strict=True):
        force = support / (1.0 + support * amplitudes.sum(axis=0))
        turned = -force * amplitudes[:, None] * np.ones((1, 2, 1))
        passed = one + turned
        span = turned, decay[:, None] * passed, passed * decay, decay[:, None] * turned * decay
        cell = span if cell is None else _joined(cell, span)
    assert cell is not None
    return cell


def _joined(one: _Scattering, two: _Scattering) -> _Scattering:
    """Scattering of two stretches in a row (Redheffer's star product)."""
    r1, t1, u1, v1 = one
    r2, t2, u2, v2 = two
    identity = np.eye(2)[:, :, None]
    right = _times(_inverse(identity - _times(v1, r2)), t1)
    left = _times(_inverse(identity - _times(r2, v1)), u2)
    return (
        r1 + _times(u1, _times(r2, right)),
        _times(t2, right),
        _times(u1, left),
        v2 + _times(t2, _times(v1, left)),
    )


def _times(a: Complex, b: Complex) -> Complex:
    return np.einsum("ijf,jkf->ikf", a, b)


def _inverse(a: Complex) -> Complex:
    """Inverse of (2, 2, f)."""
    determinant = a[0, 0] * a[1, 1] - a[0, 1] * a[1, 0]
    return np.array([[a[1, 1], -a[0, 1]], [-a[1, 0], a[0, 0]]]) / determinant


def _carry(amplitudes: Complex, supports: Complex, decays: Complex, right: _Half, found: Complex) -> Complex:
    """Write amplitudes of the decaying waves behind each support (n, i, wave, f); return steps (n, wave, f).

    The slower wave is carried forwards, the faster backwards: so rounding dies away.
    """
    count = len(supports)
    one = np.eye(2)[:, :, None]
    behind = np.arange(1, count + 1) % count  # the support behind each span

    def forwards(span: int, waves: Complex) -> Complex:
        sent = decays[span][:, None] * waves
        support = behind[span]
        felt = np.sum(right.felt[support][:, None] * sent, axis=0)
        return sent - right.force[support] * amplitudes[:, None] * felt

    def backwards(span: int, waves: Complex) -> Complex:
        """Before the span, times the decay of both waves."""
        felt = np.sum(right.felt[behind[span]][:, None] * waves, axis=0)
        return decays[span][::-1, None] * (waves + supports[behind[span]] * amplitudes[:, None] * felt)

    onwards = one + 0j * decays[0]
    returned = one + 0j * decays[0]
    for span in range(count):
        onwards = _normed(forwards(span, onwards))[0]
        returned = _normed(backwards(count - 1 - span, returned))[0]
    slow = _range_without(onwards, _smaller_eigenvalue(onwards))
    own = np.sum(slow.conj() * np.einsum("ijf,jf->if", returned, slow), axis=0)
    fast = _range_without(returned, own)
    steps = np.zeros_like(decays)
    found[0, :, 0] = slow
    found[0, :, 1] = fast
    for span in range(count):
        moved = forwards(span, found[span, :, :1])[:, 0]
        if span + 1 < count:
            moved, steps[span, 0] = _normed(moved)
            found[span + 1, :, 0] = moved
        else:
            steps[span, 0] = np.sum(slow.conj() * moved, axis=0)
    for span in range(count - 1, -1, -1):
        moved = backwards(span, found[behind[span], :, 1:])[:, 0]
        if span:
            found[span, :, 1], change = _normed(moved)
        else:
            change = np.sum(fast.conj() * moved, axis=0)
        steps[span, 1] = np.prod(decays[span], axis=0) / change
    return steps


def _normed(values: Complex) -> tuple[Complex, Complex]:
    """Values (..., f) over their norm, and the norm (f,)."""
    norm = np.sqrt(np.sum(np.abs(values) ** 2, axis=tuple(range(values.ndim - 1))))
    return values / norm, norm.astype(complex)


def _smaller_eigenvalue(a: Complex) -> Complex:
    """Eigenvalue (f,) of (2, 2, f) of the smaller modulus."""
    mean = 0.5 * (a[0, 0] + a[1, 1])
    product = a[0, 0] * a[1, 1] - a[0, 1] * a[1, 0]
    root = np.sqrt((0.5 * (a[0, 0] - a[1, 1])) ** 2 + a[0, 1] * a[1, 0])
    larger = mean + np.where(np.real(root * mean.conj()) < 0.0, -root, root)
    return product / larger


def _range_without(a: Complex, eigenvalue: Complex) -> Complex:
    """Unit eigenvector (2, f) of (2, 2, f) for the other eigenvalue: the larger column of A - lambda I."""
    columns = a - eigenvalue * np.eye(2)[:, :, None]
    larger = np.sum(np.abs(columns) ** 2, axis=0).argmax(axis=0)
    return _normed(np.take_along_axis(columns, larger[None, None], axis=1)[:, 0])[0]


_FAR = 40.0
"""Characteristic lengths of a rail on its supports to where a force is not felt: exp(-40)."""


def static_receptance_of_cell(
    stiffness: float, shear: float, supports: Array, lengths: Array, x: float
) -> float:
    """Static deflection per unit force, m/N, at a place x, m, by beam elements, which are exact at rest.

    As `asperity.structures.periodic_rail.static_receptance`; stiffnesses (n,), N/m, of the supports, each
    followed by a distance to the next (n,), m.
    """
    period = float(np.sum(lengths))
    characteristic = (4.0 * stiffness * period / np.sum(supports)) ** 0.25
    cells = 1 + int(np.ceil(_FAR * characteristic / period))
    within = np.concatenate([[0.0], np.cumsum(lengths[:-1])])
    nodes = (within + period * np.arange(-cells, cells + 1)[:, None]).ravel()
    held = np.tile(supports, 2 * cells + 1)
    at = x % period
    node = int(np.argmin(np.abs(nodes - at)))
    if abs(nodes[node] - at) > _SAME * period:
        node = int(np.searchsorted(nodes, at))
        nodes = np.insert(nodes, node, at)
        held = np.insert(held, node, 0.0)
    matrix = np.zeros((2 * nodes.size, 2 * nodes.size))
    matrix[::2, ::2] = np.diag(held)
    for first, span in enumerate(np.diff(nodes)):
        soft = 12.0 * stiffness * shear / span**2
        six = 6.0 * span
        near = (4.0 + soft) * span**2
        far = (2.0 - soft) * span**2
        beam = [
            [12.0, six, -12.0, six],
            [six, near, -six, far],
            [-12.0, -six, 12.0, -six],
            [six, far, -six, near],
        ]
        own = slice(2 * first, 2 * first + 4)
        matrix[own, own] += stiffness / (span**3 * (1.0 + soft)) * np.array(beam)
    force = np.zeros(2 * nodes.size)
    force[2 * node] = 1.0
    return float(np.linalg.solve(matrix, force)[2 * node])
