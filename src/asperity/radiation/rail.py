"""The rail as a source: how well its section radiates when it moves up and down."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from asperity.errors import InputError
from asperity.radiation.air import IMPEDANCE, wavenumber
from asperity.radiation.along import ForceOverBay, above_zero, squared_mobility
from asperity.radiation.elementary import cylinder
from asperity.structures.track import Track

STEEL_DENSITY = 7850.0
"""kg/m³; with the mass per length of a rail, the area of its section."""


@dataclass(frozen=True, eq=False)
class RailSection:
    """Section of a rail as a radiator of its vertical motion.

    Parameters
    ----------
    foot_width, head_width : float
        b_f and b_h, m.
    area : float
        S of the section, m².
    table : tuple of ndarray, optional
        Frequencies (n,), Hz, rising, and radiation ratios (n,) that replace the model: interpolated in their
        logarithms, and beyond the table as at its ends.

    Raises
    ------
    InputError
        If a dimension is not positive.

    Notes
    -----
    The power per length is ρ c · 2 b_f · σ · ⟨v²⟩: the ratio counts from the two faces of the foot. At low
    frequency the section is a line dipole, W' = ρ c ⟨v²⟩ k³ D²/8, of the area D = S + (π/4)(b_f² + b_h²) that
    it displaces and of the air that goes with it, for foot and head that of a flat strip each. At high
    frequency the faces of the foot radiate like plane ones; the head lies in front of one of them and adds
    nothing. In between the ratio is that of the oscillating cylinder with the same two limits, whose radius
    is (D²/(8 π b_f))^(1/3).

    Against a boundary element solution of the section 60E1 in free air (docs/noise.md): −0.7 to +1.4 dB in
    the one-third octaves up to 1.6 kHz, −3.8 dB at 2 kHz, where the space between head and foot resonates,
    −2.4 to +0.2 dB above. In two dimensions: the waves in the rail are longer than those in the air, and
    reach farther than those are long. Without the ground under the rail.
    """

    foot_width: float
    head_width: float
    area: float
    table: tuple[NDArray[np.float64], NDArray[np.float64]] | None = None

    def __post_init__(self) -> None:
        for what in ("foot_width", "head_width", "area"):
            value = getattr(self, what)
            if not (np.isfinite(value) and value > 0.0):
                raise InputError(f"{what} of the rail's section", value, "a finite positive number")

    @property
    def radiating_width(self) -> float:
        """Both faces of the foot, m."""
        return 2.0 * self.foot_width

    @property
    def dipole_area(self) -> float:
        """Area D of the section and of the air that goes with it, m²."""
        return self.area + 0.25 * np.pi * (self.foot_width**2 + self.head_width**2)

    def radiation_ratio(self, frequency: ArrayLike) -> NDArray[np.float64]:
        """Ratio σ (f,) at positive frequencies (f,), Hz."""
        f = above_zero(frequency)
        if self.table is not None:
            at, ratio = self.table
            return np.asarray(np.exp(np.interp(np.log(f), np.log(at), np.log(ratio))))
        radius = (self.dipole_area**2 / (4.0 * np.pi * self.radiating_width)) ** (1.0 / 3.0)
        return cylinder(wavenumber(f) * radius)

    def power_per_force(
        self, track: Track, frequency: ArrayLike, force: ForceOverBay | None = None
    ) -> NDArray[np.float64]:
        """Sound power of the whole rail per mean square force on it, (f,), W/N², at frequencies (f,), Hz.

        `force` is how that is spread over a bay, as in `squared_mobility`.
        """
        ratio = self.radiation_ratio(frequency)
        return IMPEDANCE * self.radiating_width * ratio * squared_mobility(track, frequency, force)
