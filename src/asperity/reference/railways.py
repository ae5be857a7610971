"""Numbers of railways: named tracks and wheels, ground beside them, limits of decay rates and of noise."""

import math
from dataclasses import dataclass

import numpy as np

from asperity.arguments import Array, ArrayLike, one_of

_NORDBORG = "A. Nordborg, J. Acoust. Soc. Am., 2002 (not seen), as used by a public re-implementation"
_NORDBORG_VISCOUS = "viscous variant of " + _NORDBORG
_UIC60 = "UIC 60 as in the program rolland: E = 210 GPa, I = 3037 cm^4, A = 76.7 cm^2, m' = 60.2 kg/m"
_UIC60_SHEAR = _UIC60 + "; kappa = 0.393, G = 80.77 GPa"
_RANGE = "chosen here within the published range "
_OWN = "default of asperity, chosen here: the thesis prints none; "

Parameters = dict[str, tuple[float, str]]

_UIC60_RAIL: Parameters = {
    "bending_stiffness": (210e9 * 3.037e-5, _UIC60),
    "mass_per_length": (60.2, _UIC60),
    "rail_loss_factor": (0.02, _UIC60),
}
_UIC60_SUPPORTS: Parameters = {
    "pad_stiffness": (180e6, _RANGE + "65 to 225 MN/m"),
    "pad_damping": (18e3, _RANGE + "18 to 30 kN s/m for pads of 180 MN/m"),
    "sleeper_mass": (150.0, _RANGE + "140 to 177.5 kg"),
    "ballast_stiffness": (40e6, _RANGE + "20 to 150 MN/m"),
    "ballast_damping": (47e3, "published together with a ballast of 40 MN/m"),
    "sleeper_spacing": (0.6, _RANGE + "0.55 to 0.65 m"),
}
_CHOSEN = "chosen here, no particular product"
_UIC60_TIMOSHENKO: Parameters = {
    **_UIC60_RAIL,
    "shear_stiffness": (80.77e9 * 76.7e-4 * 0.393, _UIC60_SHEAR),
    "rotary_inertia": (60.2 / 76.7e-4 * 3.037e-5, _UIC60),
}
_NORDBORG_RAIL: Parameters = {
    "bending_stiffness": (210e9 * 22.5e-6, _NORDBORG + ": E = 210 GPa, I = 2250 cm^4"),
    "mass_per_length": (60.0, _NORDBORG),
    "rail_loss_factor": (0.004, _NORDBORG),
    "pad_stiffness": (300e6, _NORDBORG),
    "sleeper_mass": (150.0, _NORDBORG),
    "ballast_stiffness": (150e6, _NORDBORG),
    "sleeper_spacing": (0.6, _NORDBORG),
}

TRACKS: dict[str, Parameters] = {
    "x2000": {
        "bending_stiffness": (210e9 * 3.037e-5, _OWN + _UIC60),
        "mass_per_length": (60.2, _OWN + _UIC60),
        "rail_loss_factor": (0.02, _OWN + _UIC60),
        "pad_stiffness": (200e6, _OWN + "published range 65 to 225 MN/m"),
        "pad_damping": (28e3, _OWN + "published together with a pad of 200 MN/m"),
        "sleeper_mass": (150.0, _OWN + "published range 140 to 177.5 kg"),
        "ballast_stiffness": (150e6, _OWN + "published range 20 to 150 MN/m"),
        "ballast_damping": (48e3, _OWN + "published together with a ballast of 150 MN/m"),
        "sleeper_spacing": (0.6, _OWN + "published range 0.55 to 0.65 m"),
    },
    "nordborg": {
        **_NORDBORG_RAIL,
        "pad_damping": (18e3, _NORDBORG_VISCOUS),
        "ballast_damping": (48e3, _NORDBORG_VISCOUS),
    },
    "nordborg-loss-factor": {
        **_NORDBORG_RAIL,
        "pad_loss_factor": (0.15, _NORDBORG),
        "ballast_loss_factor": (0.4, _NORDBORG),
    },
    "uic60": {**_UIC60_TIMOSHENKO, **_UIC60_SUPPORTS},
    "uic60-euler": {**_UIC60_RAIL, **_UIC60_SUPPORTS},
    "slab-blocks": {
        **_UIC60_TIMOSHENKO,
        "pad_stiffness": (150e6, _CHOSEN + ": a pad on a block"),
        "pad_loss_factor": (0.2, _CHOSEN),
        "sleeper_mass": (100.0, _CHOSEN + ": the block"),
        "ballast_stiffness": (25e6, _CHOSEN + ": the boot of the block, on a rigid slab"),
        "ballast_loss_factor": (0.2, _CHOSEN + ": of the boot"),
        "sleeper_spacing": (0.6, _RANGE + "0.55 to 0.65 m"),
    },
    "embedded": {
        **_UIC60_TIMOSHENKO,
        "pad_stiffness": (60e6, _CHOSEN + ": 100 MN/m per metre of rail"),
        "pad_loss_factor": (0.2, _CHOSEN),
        "sleeper_mass": (0.0, "none"),
        "ballast_stiffness": (float("inf"), "the trough of the rail is rigid"),
        "sleeper_spacing": (0.6, "a length of rail, to which pad_stiffness belongs"),
        "continuous": (True, "the rail lies on its embedment all along"),
    },
}


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


# --- sections of wheels: none is a product, they are drawn here with main dimensions as usual

Dimensions = dict[str, float]

_HUB: Dimensions = {"bore_radius": 0.0925, "hub_radius": 0.135, "hub_width": 0.175}
_RIM: Dimensions = {"rim_thickness": 0.065, "rim_width": 0.135, "fillet_radius": 0.025}
_TREAD: Dimensions = {"flange_height": 0.028, "flange_thickness": 0.032, "tread_slope": 0.05}

SECTIONS: dict[str, Dimensions] = {
    # a freight wheel: hub aside of the rim, the web bent on its way
    "curved-web": {
        **_HUB, **_RIM, **_TREAD,
        "hub_offset": 0.045, "web_bend": 0.0, "web_thickness": 0.026, "web_thickness_rim": 0.022,
    },
    # a wheel for disc brakes on the axle: a plane web under the middle of the rim
    "straight-web": {
        **_HUB, **_RIM, **_TREAD,
        "hub_offset": 0.0, "web_bend": 0.0, "web_thickness": 0.030, "web_thickness_rim": 0.025,
    },
    # a wheel for tread brakes, whose web gives way to heat: twice bent
    "bent-web": {
        **_HUB, **_RIM, **_TREAD,
        "hub_offset": 0.010, "web_bend": 0.045, "web_thickness": 0.024, "web_thickness_rim": 0.020,
    },
}  # fmt: skip
"""Dimensions in m, by the keywords of `asperity.structures.outline.WheelSection`."""

# --- ground beside a track, by its flow resistivity

GROUND_CITATION = (
    "M. E. Delany and E. N. Bazley, Applied Acoustics 3 (1970) 105 (impedance of porous material), with the "
    "classes of ground of B. Plovsing (2006), as in D. A. Bies, C. H. Hansen and C. Q. Howard, Engineering "
    "Noise Control, 5th edition, table 5.2."
)
HARD = "hard"
"""Ground that reflects all, and of whose interference only the mean is taken."""
GROUNDS: dict[str, float] = {
    "grass": 80e3,
    "pasture": 200e3,
    "lawn": 500e3,
    "gravel-road": 2e6,
    "asphalt": 20e6,
    "ballast-shoulder": 200e3,
}
"""Flow resistivity, Pa s/m²: the classes C (turf, loose soil) to G (asphalt, concrete) of `GROUND_CITATION`.

Of ballast none is printed. That of its shoulder is chosen here: the hardest class, D, of those that
CNOSSOS-EU (Directive (EU) 2015/996, 2.5) counts as wholly absorbing, as it counts rail tracks on ballast.
"""

# --- limits of the noise of passing vehicles in the European Union: TSI Noise, by type of vehicle

TSI_CITATION = (
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
    slow, fast = LIMITS[vehicle]
    ratio = speed / _FAST
    axles = 0.0
    if vehicle == WAGON:
        axles = -10.0 * math.log10(axles_per_length / _AXLES_PER_LENGTH)
    if ratio >= 1.0 - 1e-9:
        return PassByLimit(fast, _FAST, axles - 50.0 * math.log10(ratio), above=True)
    return PassByLimit(slow, _SLOW, axles - 30.0 * math.log10(max(speed / _SLOW, 1.0)))
