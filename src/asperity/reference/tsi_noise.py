"""Limits of the noise of passing vehicles in the European Union: TSI Noise, by type of vehicle."""

import math
from dataclasses import dataclass

CITATION = (
    "Commission Regulation (EU) No 1304/2014 (TSI Noise), as amended up to (EU) 2023/1694, points 4.2.3 and "
    "6.2.2.3 (limits of pass-by noise)."
)
LIMITS: dict[str, tuple[float, float | None]] = {
    "electric-locomotive": (84.0, 99.0),
    "diesel-locomotive": (85.0, None),
    "emu": (80.0, 95.0),
    "dmu": (81.0, 96.0),
    "coach": (79.0, None),
    "wagon": (83.0, None),
}
"""Table 4: L_pAeq,Tp at 80 and at 250 km/h, dB(A), by type of vehicle."""
WAGON = "wagon"
RECEIVER = 7.5, 1.2
"""Distance from the middle of the track and height above the rail head for which they hold, m."""
ABOVE = 7.5, 3.5
"""The same of the additional place from 250 km/h on; point 4.2.3 says its height and the limits' distance."""
GREATEST_SPEED = 320.0 / 3.6
"""Of a test, m/s."""
_SLOW, _FAST = 80.0 / 3.6, 250.0 / 3.6
_AXLES_PER_LENGTH = 0.225  # of a wagon, 1/m


@dataclass(frozen=True)
class PassByLimit:
    """Limit of L_pAeq,Tp, None where there is none, for the speed, m/s, to which a level is normalised."""

    level: float | None
    speed: float
    normalisation: float  # dB to add to a level that was found
    above: bool = False  # whether it holds at the additional place, too

    def met(self, normalised: float) -> bool:
        """Whether a normalised level is within the limit, both as whole decibels."""
        return self.level is None or math.floor(normalised + 0.5) <= self.level


def pass_by_limit(vehicle: str, speed: float, axles_per_length: float) -> PassByLimit:
    """Limit for a type of vehicle that passed at a speed, m/s, and what normalises its level.

    Axles per length over the buffers, 1/m, matter for wagons alone. From 250 km/h on levels are normalised to
    that by 50 lg v, below to 80 km/h by 30 lg v; those at 80 km/h or less count as of a vehicle that runs no
    faster, as they are.
    """
    (slow, fast), ratio = LIMITS[vehicle], speed / _FAST
    axles = 0.0
    if vehicle == WAGON:
        axles = -10.0 * math.log10(axles_per_length / _AXLES_PER_LENGTH)
    if ratio >= 1.0 - 1e-9:
        return PassByLimit(fast, _FAST, axles - 50.0 * math.log10(ratio), above=True)
    return PassByLimit(slow, _SLOW, axles - 30.0 * math.log10(max(speed / _SLOW, 1.0)))
