"""Vibration of a track, summed along it under a force: over a cell that repeats, and where its power goes."""

import math
from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import lru_cache

import numpy as np

from asperity.arguments import Array, ArrayLike, Complex, finite_array, real
from asperity.quadrature import gauss
from asperity.structures.cell_waves import CellWaves, cell_waves
from asperity.structures.periodic_rail import PeriodicWaves
from asperity.structures.support import BendingSleeper, MeasuredSleeper, Spring
from asperity.structures.track import Track

Span = CellWaves | PeriodicWaves
"""Waves between two supports."""
Squares = Callable[[int, float], Array]
"""Squares (f,) under a unit force in a span, by number, at a place in it, m."""
ForceOverBay = Callable[[Array], Array]
"""Mean square of the force at places (n,), m from a sleeper, at the frequencies (n, f), in any unit."""
FEWEST_NODES = 6  # of Gauss's rule between two supports, beside one per radian of the shortest wave


class Mobility:
    """Places of a force all over a cell, by Gauss's rule, and what it does on both sides.

    Span by span, from a support to the next. What is sent to one side by a force at x0 of a span is sum_j
    s_j(x0) u_j(x), for decaying and growing waves in turn; quadratic forms of u_j, summed over the spans
    beyond with the steps of the waves, give the squares there.
    """

    def __init__(self, waves: CellWaves | PeriodicWaves, omega: Array) -> None:
        self.omega = omega
        self.steps = waves.steps
        self.spans = waves.spans
        self.edges = waves.edges
        shortest = float(np.abs(waves.wavenumbers).max())
        self.count = FEWEST_NODES + math.ceil(shortest * float(np.diff(waves.edges).max()))
        self.nodes, self.weights = gauss(2 * self.count)

    def rail(self, force: ForceOverBay | None) -> Array:
        """Integral along the rail of the squared mobility (f,), mean over the places of the force."""
        return self._mean(self.along(self.spans), force)

    def along(self, spans: Sequence[Span]) -> Squares:
        """Integral along the rail of the square of what spans make of the waves of a force."""
        ahead, behind = self._beyond(*(self._forms(spans, waves) for waves in ("outgoing", "incoming")))

        @lru_cache(maxsize=1)  # places come span after span
        def within(number: int) -> tuple[Complex, Complex]:
            return self._shapes(spans[number], "outgoing"), self._shapes(spans[number], "incoming")

        def squares(number: int, x0: float) -> Array:
            right, left = _sent(self.spans[number], x0)
            length = spans[number].spacing
            to_x0 = length * self._up_to(x0 / length)
            shares = length * self.weights - to_x0, to_x0
            total = _squared(right, ahead[number]) + _squared(left, behind[number])
            for sent, shapes, share in zip((right, left), within(number), shares, strict=True):
                moved = sent[0] * shapes[:, 0] + sent[1] * shapes[:, 1]
                total = total + share @ (moved.real**2 + moved.imag**2)
            return total

        return squares

    def _shapes(self, span: Span, waves: str) -> Complex:
        """Waves (nodes, 2, f) at nodes by which products of two are integrated from any place on."""
        return np.array([getattr(span, waves)(span.spacing * x) for x in self.nodes])

    def _up_to(self, place: float) -> Array:
        """Weights (nodes,) of an integral from zero to a place of a span, both in its lengths.

        Of the polynomial through all nodes, by Legendre coefficients: ∫ P_k = (P_{k+1} − P_{k−1})/(2k + 1).
        """
        count = len(self.nodes)
        x = 2.0 * place - 1.0
        at = np.polynomial.legendre.legvander(np.array([x]), count)[0]
        integral = np.concatenate([[x + 1.0], at[2:] - at[:-2]])  # times 2k + 1, of each k below count
        basis = np.polynomial.legendre.legvander(2.0 * self.nodes - 1.0, count - 1)
        return 0.5 * self.weights * (basis @ integral)

    def sleepers(self, track: Track, force: ForceOverBay | None) -> Array:
        """Sum over all half sleepers of the squared mobility (f,), mean over the places of the force."""
        moved = np.zeros((len(self.spans), self.omega.size))
        bays = [bay.support.sleeper_square(self.omega) for bay in track.bay_tracks]
        moved[:: len(self.spans) // track.cell_bays] = bays
        return self._mean(self.at_starts(moved), force)

    def at_starts(self, shares: Array) -> Squares:
        """Sum of the squares at all places where a span begins, times shares (n, f) or (n, 1)."""
        seen = np.array([[s.outgoing(0.0), s.incoming(0.0)] for s in self.spans])  # (n, side, 2, f)
        forms = shares[:, None, None, None] * seen[:, :, :, None] * seen[:, :, None].conj()
        ahead, behind = self._beyond(forms[:, 0], forms[:, 1])
        behind = behind + forms[:, 1]  # a span begins with its own support

        def squares(number: int, x0: float) -> Array:
            right, left = _sent(self.spans[number], x0)
            return _squared(right, ahead[number]) + _squared(left, behind[number])

        return squares

    def point(self, force: ForceOverBay | None) -> Array:
        """Squared mobility of the rail at the force (f,), mean over its places."""

        def squares(number: int, x0: float) -> Array:
            span = self.spans[number]
            return np.abs(np.sum(span.outgoing(x0) * _sent(span, x0)[0], axis=0)) ** 2

        return self._mean(squares, force)

    def _forms(self, spans: Sequence[Span], waves: str) -> Complex:
        """Integrals of products of waves over each span (n, i, j, f)."""
        forms = []
        for span in spans:
            places, lengths = gauss(self.count, 0.0, span.spacing)
            shapes = np.array([getattr(span, waves)(x) for x in places])
            forms.append(np.einsum("x,xif,xjf->ijf", lengths, shapes, shapes.conj(), optimize=True))
        return np.array(forms)

    def _beyond(self, decaying: Complex, growing: Complex) -> tuple[Complex, Complex]:
        """Forms (n, i, j, f) of all spans after each, and of all before it, in the scale of each."""
        step = self.steps[:, :, None] * self.steps[:, None].conj()  # from a span to the next
        around = np.prod(step, axis=0)
        after = np.zeros_like(decaying)
        before = np.zeros_like(growing)
        count = len(step)
        for lap in range(2):  # around the cell once to close it, and once more
            if lap:
                after[0] = after[0] / (1.0 - around)
                before[0] = before[0] / (1.0 - around)
            for span in range(count - 1, -1, -1):
                following = (span + 1) % count
                beyond = after[following] if lap or following else 0.0
                after[span] = step[span] * (decaying[following] + beyond)
            for span in range(1, count + 1):
                beyond = before[span - 1] if lap or span > 1 else 0.0
                before[span % count] = step[span - 1] * (growing[span - 1] + beyond)
        return after, before

    def _mean(self, squares: Squares, force: ForceOverBay | None) -> Array:
        """Mean of ω² times squares, by the weights of Gauss's rule and of the force."""
        places, lengths = zip(*(gauss(self.count, 0.0, span.spacing) for span in self.spans), strict=True)
        values = np.array([squares(n, float(x)) for n, within in enumerate(places) for x in within])
        along = np.concatenate([edge + each for edge, each in zip(self.edges, places, strict=False)])
        square = 1.0 if force is None else force(along)
        weights = np.concatenate(lengths)[:, None] * np.broadcast_to(square, values.shape)
        return self.omega**2 * np.average(values, axis=0, weights=weights)


def _squared(sent: Complex, form: Complex) -> Array:
    """Sum over i and j of s_i s_j* form_ij (f,)."""
    return np.einsum("if,jf,ijf->f", sent, sent.conj(), form).real


def _sent(span: Span, x0: float) -> tuple[Complex, Complex]:
    """How strongly a force at a place sends out the waves to the right and to the left, (2, f) each."""
    return span.coefficients * span.incoming(x0), span.coefficients * span.outgoing(x0)


# --- where the power goes that a harmonic force feeds into a track


def dissipated_power(track: Track, frequency: ArrayLike, x: float) -> dict[str, Array]:
    """Power that each part of a track dissipates, per mean square of a harmonic force on the rail.

    Parameters
    ----------
    track : Track
        With its damping as it is: constant loss factors and tables, or relaxations.
    frequency : array_like (f,)
        Hz, positive.
    x : float
        Position of the force, m from a sleeper.

    Returns
    -------
    dict of ndarray (f,)
        W/N², by the names of the track's parts: ``"rail"``, those of its springs, ``"sleeper"`` if it was
        measured or bends with losses, ``"rail_damper"``.

    Raises
    ------
    InputError
        If a frequency is not positive or the position not finite.

    Notes
    -----
    A stiffness k that is stretched by u dissipates ``ω Im k |u|²``: the supports where they are, and the
    bending and shear stiffness of the rail all along it, on both sides of the force. Each is integrated by
    itself; that together they are the power at the force, ``-ω Im G(x|x)``, is not used.
    """
    at = np.atleast_1d(finite_array("frequency (Hz)", frequency, "finite positive numbers", above=0.0))
    field = _Field(track, 2.0 * np.pi * at, real("position of the force (m)", x, "a finite number"))
    omega = field.omega
    found = {"rail": field.omega * field.strained()}
    hung = [] if track.damper is None else [(["rail_damper", "its mass"], track.damper, field.dampers())]
    for names, chain, moved in [(list(track.elements), track.support, field.supports()), *hung]:
        parts = zip(names, chain.elements, chain.squares(omega), chain.below(omega), strict=True)
        for name, element, (square, squeezed), below in parts:
            if isinstance(element, Spring):
                found[name] = omega * element.stiffness(omega).imag * squeezed * moved
            loses = isinstance(element, BendingSleeper) and track.sleeper_loss_factor
            if isinstance(element, MeasuredSleeper) or loses:
                assert isinstance(element, MeasuredSleeper | BendingSleeper)
                found[name] = omega * element.lost(omega, below) * square * moved
    return found


class _Field:
    """Motion of the rail under a unit force at a place of a bay, by the waves between its points."""

    def __init__(self, track: Track, omega: Array, x: float) -> None:
        self.track = track
        self.omega = omega
        self.spacing = track.sleeper_spacing
        half = 0.5 * self.spacing
        self.place = int(x % self.spacing >= half), x % self.spacing % half
        support = track.support.stiffness(omega)
        hung = np.zeros(len(omega), complex)
        if track.damper is not None:
            hung = track.damper.stiffness(omega)
        self.held = np.zeros(len(omega), complex)
        bed = None
        if track.continuous:
            self.held = bed = (support + hung) / self.spacing
            support = hung = np.zeros(len(omega), complex)
        self.wavenumbers, amplitudes = track.rail.waves(omega.astype(complex), bed)
        self.waves = cell_waves(self.wavenumbers, amplitudes, np.stack([support, hung]), np.full(2, half))
        self.mobility = Mobility(self.waves, omega)

    def supports(self) -> Array:
        """Sum of the squared displacement over all supports, m²/N²."""
        return self._at(np.array([[1.0], [0.0]]))

    def dampers(self) -> Array:
        """The same over all rail dampers."""
        return self._at(np.array([[0.0], [1.0]]))

    def _at(self, points: Array) -> Array:
        if self.track.continuous:
            return self._along(self.waves) / self.spacing
        return self.mobility.at_starts(points)(*self.place)

    def _along(self, waves: CellWaves) -> Array:
        return self.mobility.along(waves.spans)(*self.place)

    def strained(self) -> Array:
        """Integral along the rail of Im EI times θ' squared and of Im S times w' - θ squared, m/N."""
        rail = self.track.rail
        squares = self.wavenumbers**2
        relative = rail.losses.at(self.omega)
        inertia = rail.mass_per_length * self.omega**2 - self.held
        bent = rail.bending_stiffness * np.imag(relative)
        if rail.shear_stiffness is None:
            return bent * self._along(_changed(self.waves, -squares, -squares))
        share = inertia / (rail.shear_stiffness * relative)
        slope = 1j * share / self.wavenumbers  # of w' - θ = S⁻¹ (m' ω² - s) w'/k²
        curvature = share - squares
        sheared = rail.shear_stiffness * np.imag(relative) * self._along(_changed(self.waves, -slope, slope))
        return bent * self._along(_changed(self.waves, curvature, curvature)) + sheared


def _changed(waves: CellWaves, forth: Complex, back: Complex) -> CellWaves:
    """Waves whose parts that run forth and back between the points are multiplied by factors (2, f)."""
    factors = np.stack([forth, back])[:, :, None]
    return replace(waves, decaying=waves.decaying * factors, growing=waves.growing * factors)
