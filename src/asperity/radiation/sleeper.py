"""The sleepers as sources: half of each, moved through its pad."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from asperity.errors import InputError
from asperity.radiation.air import IMPEDANCE, wavenumber
from asperity.radiation.along import ForceOverBay, above_zero, squared_sleeper_mobility
from asperity.radiation.elementary import baffled_piston
from asperity.structures.track import Track


@dataclass(frozen=True)
class SleeperTop:
    """Top of half a sleeper, whose other faces lie in ballast: a piston in a plane.

    Parameters
    ----------
    length : float
        Of the whole sleeper, m: half of it moves with each rail.
    width : float
        Of its top along the track, m.

    Raises
    ------
    InputError
        If a dimension is not positive.

    Notes
    -----
    A rigid circular piston of the same area in an infinite rigid plane. Each half sleeper radiates by
    itself: where the sound is longer than some sleeper distances, below about 300 Hz, neighbours that move
    together radiate more than the sum. Bending of the sleepers and absorption by the ballast are left out.
    """

    length: float
    width: float

    def __post_init__(self) -> None:
        for what in ("length", "width"):
            value = getattr(self, what)
            if not (np.isfinite(value) and value > 0.0):
                raise InputError(f"{what} of a sleeper", value, "a finite positive number")

    @property
    def area(self) -> float:
        """Of half a sleeper, m²."""
        return 0.5 * self.length * self.width

    @property
    def radius(self) -> float:
        """Radius of the circle of the same area, m."""
        return math.sqrt(self.area / math.pi)

    def radiation_ratio(self, frequency: ArrayLike) -> NDArray[np.float64]:
        """Ratio σ (f,) at positive frequencies (f,), Hz: of the power to ρ c S ⟨v²⟩."""
        return baffled_piston(wavenumber(above_zero(frequency)) * self.radius)

    def power_per_force(
        self, track: Track, frequency: ArrayLike, force: ForceOverBay | None = None
    ) -> NDArray[np.float64]:
        """Sound power of all half sleepers per mean square force on the rail, (f,), W/N²; frequencies, Hz.

        `force` is how that is spread over a bay, as in `asperity.radiation.along.squared_mobility`.
        """
        ratio = self.radiation_ratio(frequency)
        return IMPEDANCE * self.area * ratio * squared_sleeper_mobility(track, frequency, force)
