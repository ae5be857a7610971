"""Where the power goes that a harmonic force feeds into a track: into rail, pads, ballast, rail dampers."""

import math
from dataclasses import replace
from itertools import pairwise

import numpy as np

from asperity.arguments import Array, ArrayLike, Complex, finite_array, real
from asperity.structures.cell_waves import CellWaves, cell_waves
from asperity.structures.support import MeasuredSleeper, Spring
from asperity.structures.track import Track

FEWEST_NODES = 10  # of Gauss's rule between two points, beside two per radian of the shortest wave


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
        measured, ``"rail_damper"``.

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
    chain, omega = track.support, field.omega
    moved = field.supports()
    found = {"rail": omega * field.strained()}
    parts = zip(track.elements.items(), chain.squares(omega), chain.below(omega), strict=True)
    for (name, element), (square, squeezed), below in parts:
        if isinstance(element, Spring):
            found[name] = omega * element.stiffness(omega).imag * squeezed * moved
        if isinstance(element, MeasuredSleeper):
            found[name] = omega * element.lost(omega, below) * square * moved
    if (damper := track.damper) is not None:
        found["rail_damper"] = omega * damper.spring(omega).imag * damper.squeezed(omega) * field.dampers()
    return found


class _Field:
    """Motion of the rail under a unit force at a place of a bay, by the waves between its points."""

    def __init__(self, track: Track, omega: Array, x: float) -> None:
        self.track, self.omega, self.spacing = track, omega, track.sleeper_spacing
        self.force = x % self.spacing
        support, hung = track.support.stiffness(omega), np.zeros(len(omega), complex)
        if track.damper is not None:
            hung = track.damper.stiffness(omega)
        self.held, bed = np.zeros(len(omega), complex), None
        if track.continuous:
            self.held = bed = (support + hung) / self.spacing
            support = hung = np.zeros(len(omega), complex)
        self.wavenumbers, amplitudes = track.rail.waves(omega.astype(complex), bed)
        halves = np.full(2, 0.5 * self.spacing)
        self.waves = cell_waves(self.wavenumbers, amplitudes, np.stack([support, hung]), halves)
        reached = self.waves.symmetric_shapes(np.array([self.force]))
        self.sent = {1: reached[1][0], -1: reached[0][0]}  # to the right, to the left, (2, f)

    def supports(self) -> Array:
        """Sum of the squared displacement over all supports, m²/N²."""
        return self._spread() if self.track.continuous else self._total(np.zeros(1), np.ones(1))

    def dampers(self) -> Array:
        """The same over all rail dampers."""
        middle = np.array([0.5 * self.spacing])
        return self._spread() if self.track.continuous else self._total(middle, np.ones(1))

    def _spread(self) -> Array:
        return self._total(*self._nodes()) / self.spacing

    def strained(self) -> Array:
        """Integral along the rail of Im EI times θ' squared and of Im S times w' - θ squared, m/N."""
        rail, squares = self.track.rail, self.wavenumbers**2
        relative, inertia = rail.losses.at(self.omega), rail.mass_per_length * self.omega**2 - self.held
        bent = rail.bending_stiffness * np.imag(relative)
        if rail.shear_stiffness is None:
            return np.asarray(bent * self._total(*self._nodes(), -squares, -squares))
        share = inertia / (rail.shear_stiffness * relative)
        slope = 1j * share / self.wavenumbers  # of w' - θ = S⁻¹ (m' ω² - s) w'/k²
        curvature = share - squares
        sheared = rail.shear_stiffness * np.imag(relative) * self._total(*self._nodes(), -slope, slope)
        return np.asarray(bent * self._total(*self._nodes(), curvature, curvature) + sheared)

    def _nodes(self) -> tuple[Array, Array]:
        """Gauss's rule over a bay, between supports, dampers and force."""
        ends = sorted({0.0, 0.5 * self.spacing, self.force, self.spacing})
        most = float(np.abs(self.wavenumbers).max()) * self.spacing
        node, weight = np.polynomial.legendre.leggauss(FEWEST_NODES + math.ceil(most))
        pieces = [(0.5 * (b - a) * (node + 1.0) + a, 0.5 * (b - a) * weight) for a, b in pairwise(ends)]
        places, weights = zip(*pieces, strict=True)
        return np.concatenate(places), np.concatenate(weights)

    def _total(
        self, places: Array, weights: Array, forth: Complex | None = None, back: Complex | None = None
    ) -> Array:
        """Sum over all bays of weights times squared motion at places of a bay.

        Of the motion itself, or of what factors (2, f) make of the waves that run forth and back.
        """
        waves = self.waves if forth is None or back is None else _changed(self.waves, forth, back)
        shapes = dict(zip((1, -1), waves.symmetric_shapes(places), strict=True))  # (p, 2, f)
        product = waves.multipliers[:, None] * waves.multipliers.conj()[None, :]
        behind, total = product / (1.0 - product), np.zeros(len(self.omega))
        for side, shape in shapes.items():
            here = (places >= self.force) == (side > 0)
            each = self.sent[side] * shape
            total += weights[here] @ np.abs(each[here].sum(axis=1)) ** 2
            total += np.einsum("p,pif,pjf,ijf->f", weights, each, each.conj(), behind, optimize=True).real
        return total


def _changed(waves: CellWaves, forth: Complex, back: Complex) -> CellWaves:
    """Waves whose parts that run forth and back between the points are multiplied by factors (2, f)."""
    factors = np.stack([forth, back])[:, :, None]
    return replace(waves, decaying=waves.decaying * factors, growing=waves.growing * factors)
