"""Numbers of railways: named tracks and wheels, ground beside them, limits of decay rates and of noise.

The file ``railways.toml`` holds them.
"""

import math
import tomllib
from dataclasses import dataclass

import numpy as np

from asperity.arguments import Array, ArrayLike, one_of
from asperity.files import packaged

Parameters = dict[str, tuple[float, str]]
Dimensions = dict[str, float]

_TABLES = tomllib.loads(packaged("reference/railways.toml"))


def _part(name: str) -> Parameters:
    """Parameters of a part of tracks, each with its source."""
    told = dict(_TABLES["parts"][name])
    source = told.pop("source", "")
    each = {key: value if isinstance(value, list) else [value, ""] for key, value in told.items()}
    return {key: (value, source + added) for key, (value, added) in each.items()}


TRACKS: dict[str, Parameters] = {
    name: {key: value for part in parts for key, value in _part(part).items()}
    for name, parts in _TABLES["tracks"].items()
}
SECTIONS: dict[str, Dimensions] = _TABLES["sections"]
"""Dimensions in m, by the keywords of `asperity.structures.outline.WheelSection`."""


def named_track(name: str) -> Parameters:
    """Parameters of a named track of `TRACKS`, those of `Track`, each with (value in SI, source)."""
    return dict(TRACKS[one_of("track name", name, TRACKS)])


_HALF_BAND = 10.0**0.05
_FROM_BAND_DB_PER_M = ((250.0, 2.0), (400.0, 6.0), (800.0, 2.19), (1000.0, 0.8))
_LAST_BAND = 5000.0


def iso_3095_decay_rate(frequency: ArrayLike) -> Array:
    """Lower limit of the vertical decay rate of a reference track, dB/m, at frequencies (f,), Hz.

    That of the one-third octave which holds the frequency; NaN below 250 Hz and above 5 kHz. ISO 3095:2013;
    the edition of 2025 has not been compared.
    """
    at = np.asarray(frequency, dtype=np.float64)
    limit = np.full(at.shape, np.nan)
    for first, value in _FROM_BAND_DB_PER_M:
        limit[at >= first / _HALF_BAND] = value
    limit[at > _LAST_BAND * _HALF_BAND] = np.nan
    return limit


# --- ground beside a track, by its flow resistivity

GROUND_CITATION = (
    "M. E. Delany and E. N. Bazley, Applied Acoustics 3 (1970) 105 (impedance of porous material), with the "
    "classes of ground of B. Plovsing (2006), as in D. A. Bies, C. H. Hansen and C. Q. Howard, Engineering "
    "Noise Control, 5th edition, table 5.2."
)
HARD = "hard"
"""Ground that reflects all, and of whose interference only the mean is taken."""
GROUNDS: dict[str, float] = _TABLES["grounds"]
"""Flow resistivity, Pa s/m²: classes C (turf, loose soil) to G (asphalt, concrete) of `GROUND_CITATION`."""

# --- limits of the noise of passing vehicles in the European Union: TSI Noise, by type of vehicle

TSI_CITATION = (
    "Commission Regulation (EU) No 1304/2014 (TSI Noise), as amended up to (EU) 2023/1694, points 4.2.3 and "
    "6.2.2.3 (limits of pass-by noise)."
)
LIMITS: dict[str, list[float]] = _TABLES["limits"]
"""Table 4: L_pAeq,Tp at 80 and, where there is one, at 250 km/h, dB(A), by type of vehicle."""
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
    slow, fast = (*LIMITS[vehicle], None)[:2]
    ratio = speed / _FAST
    axles = 0.0
    if vehicle == WAGON:
        axles = -10.0 * math.log10(axles_per_length / _AXLES_PER_LENGTH)
    if ratio >= 1.0 - 1e-9:
        return PassByLimit(fast, _FAST, axles - 50.0 * math.log10(ratio), above=True)
    return PassByLimit(slow, _SLOW, axles - 30.0 * math.log10(max(speed / _SLOW, 1.0)))
