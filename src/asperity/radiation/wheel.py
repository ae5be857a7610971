"""The wheel as a source: how well its modes radiate, by their number of nodal diameters.

D. J. Thompson and C. J. C. Jones, Sound radiation from a vibrating railway wheel, J. Sound Vib. 253 (2002)
401–419, give the radiation ratio of each number of nodal diameters n by one transition frequency: below it
axial motion rises as f^(2n+4), radial motion as f^(2n+2), above it the ratio is one. This form is used here.
Their transition frequencies are not: those here follow from the limit of low frequency, in closed form, of a
thin disc and of a narrow ring.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.special import beta, gamma

from asperity.errors import InputError
from asperity.radiation.air import IMPEDANCE, SPEED_OF_SOUND
from asperity.radiation.along import above_zero


def axial_transition(nodal_diameters: int) -> float:
    """Wavenumber times radius, ka, at which axial motion starts to radiate fully.

    A thin disc of radius a in free air, whose axial velocity goes as r^n cos(nθ): the flow around it at low
    frequency, φ = Γ(n+1)/(√π Γ(n+3/2)) v (r/a)^n √(a² − r²) cos(nθ), radiates as a layer of dipoles. The
    ratio that follows, per 2πa² ⟨v²⟩, is C (ka)^(2n+4), here set equal to one. For n = 0 C = 8/(27π²), that
    of a rigid disc (Rayleigh).
    """
    n = _diameters(nodal_diameters)
    flow = gamma(n + 1.0) / (math.sqrt(math.pi) * gamma(n + 1.5))
    layer = gamma(1.5) / (2.0 ** (n + 1) * gamma(n + 2.5))
    limit = (n + 1.0) * (flow * layer) ** 2 * beta(1.5, n + 1.0)
    return float(limit ** (-1.0 / (2 * n + 4)))


def radial_transition(nodal_diameters: int, width_ratio: float) -> float:
    """Wavenumber times radius, ka, at which radial motion starts to radiate fully.

    A ring of radius a and width b, here given as b/a, whose outer face alone moves air, with cos(nθ): as
    monopoles its ratio per 2πab ⟨v²⟩ is k²ab/4 ∫J_n²(ka sinϑ) sinϑ dϑ, which at low frequency is (b/a)
    (ka)^(2n+2) B(1/2, n+1)/(4^(n+1) n!²), here set equal to one.
    """
    n = _diameters(nodal_diameters)
    if not (np.isfinite(width_ratio) and width_ratio > 0.0):
        raise InputError("width of the tread over its radius", width_ratio, "a finite positive number")
    limit = width_ratio * beta(0.5, n + 1.0) / (4.0 ** (n + 1) * gamma(n + 1.0) ** 2)
    return float(limit ** (-1.0 / (2 * n + 2)))


def _diameters(number: int) -> int:
    if number != int(number) or number < 0:
        raise InputError("number of nodal diameters", number, "a whole number, zero or more")
    return int(number)


@dataclass(frozen=True, eq=False)
class RadiatingWheel:
    """A wheel as a radiator of its modes.

    Parameters
    ----------
    radius, width : float
        Of the tread, m.
    nodal_diameters : ndarray (p,) of int
        n of each mode.
    axial, radial : ndarray (p,)
        Root mean square, over the disc, of the axial velocity, and over the tread, of the radial velocity,
        both per radial velocity at the contact.

    Raises
    ------
    InputError
        If a dimension is not positive, a ratio negative, or the lists differ in length.

    Notes
    -----
    W = ρ c Σ [2πa² σ_a(n) ⟨v_a²⟩ + 2πab σ_r(n) ⟨v_r²⟩], each mode by itself: two modes of the same n that
    move together in a band would radiate more or less than their sum.
    """

    radius: float
    width: float
    nodal_diameters: NDArray[np.int64]
    axial: NDArray[np.float64]
    radial: NDArray[np.float64]

    def __post_init__(self) -> None:
        for what, value in (("radius", self.radius), ("width", self.width)):
            if not (np.isfinite(value) and value > 0.0):
                raise InputError(f"{what} of the wheel's tread", value, "a finite positive number")
        shapes = {np.shape(each) for each in (self.nodal_diameters, self.axial, self.radial)}
        if len(shapes) != 1 or len(shapes.pop()) != 1:
            raise InputError("radiating modes", "lists of different lengths", "one value of each per mode")
        for what, values in (("axial", self.axial), ("radial", self.radial)):
            if not (np.isfinite(values) & (np.asarray(values) >= 0.0)).all():
                raise InputError(f"{what} velocity of a mode", values, "finite ratios, zero or more")

    def axial_ratio(self, frequency: ArrayLike) -> NDArray[np.float64]:
        """σ_a (p, f) at positive frequencies (f,), Hz: 1/(1 + (f_ca/f)^(2n+4))."""
        transition = np.array([axial_transition(n) for n in self.nodal_diameters])
        return self._ratio(frequency, transition, 2 * self.nodal_diameters + 4)

    def radial_ratio(self, frequency: ArrayLike) -> NDArray[np.float64]:
        """σ_r (p, f) at positive frequencies (f,), Hz: 1/(1 + (f_cr/f)^(2n+2))."""
        slender = self.width / self.radius
        transition = np.array([radial_transition(n, slender) for n in self.nodal_diameters])
        return self._ratio(frequency, transition, 2 * self.nodal_diameters + 2)

    def power(self, frequency: ArrayLike, square: NDArray[np.float64]) -> NDArray[np.float64]:
        """Sound power (f,), W, from mean square radial velocities of the modes at the contact (p, f), m²/s².

        Per Hz where these are densities. Frequencies (f,), Hz.
        """
        disc = 2.0 * np.pi * self.radius**2 * self.axial[:, None] ** 2 * self.axial_ratio(frequency)
        around = 2.0 * np.pi * self.radius * self.width
        tread = around * self.radial[:, None] ** 2 * self.radial_ratio(frequency)
        return IMPEDANCE * np.sum((disc + tread) * square, axis=0)

    def _ratio(
        self, frequency: ArrayLike, transition: NDArray[np.float64], exponent: NDArray[np.int64]
    ) -> NDArray[np.float64]:
        over = 2.0 * np.pi * above_zero(frequency) * self.radius / SPEED_OF_SOUND / transition[:, None]
        return np.asarray(1.0 / (1.0 + over ** -exponent[:, None].astype(float)))
