"""Where the power goes that a harmonic force feeds into a track: into rail, pads, ballast, rail dampers."""

from dataclasses import replace

import numpy as np

from asperity.arguments import Array, ArrayLike, Complex, finite_array, real
from asperity.structures.cell_waves import CellWaves, cell_waves
from asperity.structures.mobility import Mobility
from asperity.structures.support import MeasuredSleeper, Spring
from asperity.structures.track import Track


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
        half = 0.5 * self.spacing
        self.place = int(x % self.spacing >= half), x % self.spacing % half
        support, hung = track.support.stiffness(omega), np.zeros(len(omega), complex)
        if track.damper is not None:
            hung = track.damper.stiffness(omega)
        self.held, bed = np.zeros(len(omega), complex), None
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
        rail, squares = self.track.rail, self.wavenumbers**2
        relative, inertia = rail.losses.at(self.omega), rail.mass_per_length * self.omega**2 - self.held
        bent = rail.bending_stiffness * np.imag(relative)
        if rail.shear_stiffness is None:
            return np.asarray(bent * self._along(_changed(self.waves, -squares, -squares)))
        share = inertia / (rail.shear_stiffness * relative)
        slope = 1j * share / self.wavenumbers  # of w' - θ = S⁻¹ (m' ω² - s) w'/k²
        curvature = share - squares
        sheared = rail.shear_stiffness * np.imag(relative) * self._along(_changed(self.waves, -slope, slope))
        return np.asarray(bent * self._along(_changed(self.waves, curvature, curvature)) + sheared)


def _changed(waves: CellWaves, forth: Complex, back: Complex) -> CellWaves:
    """Waves whose parts that run forth and back between the points are multiplied by factors (2, f)."""
    factors = np.stack([forth, back])[:, :, None]
    return replace(waves, decaying=waves.decaying * factors, growing=waves.growing * factors)
