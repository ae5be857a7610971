"""Tables of the European method CNOSSOS-EU for the rolling noise of trains.

Directive (EU) 2015/996, appendix G, as amended by Delegated Directive (EU) 2021/1226: roughness of wheel
and rail (table G-1), contact filter (table G-2), transfer of track and vehicle from roughness to sound
power (table G-3), as ``cnossos.toml`` holds them. Wavelengths and frequencies are nominal one-third octaves.
"""

import math
import re
import tomllib
from collections.abc import Mapping, Sequence

import numpy as np

from asperity.arguments import Array, ArrayLike
from asperity.files import packaged

CITATION = "Directive (EU) 2015/996, appendix G, as amended by Delegated Directive (EU) 2021/1226"

Spectrum = tuple[Array, Array]
Tables = Mapping[str, Sequence[float]]

_TABLES = tomllib.loads(packaged("reference/cnossos.toml"))
WHEEL_ROUGHNESS: Tables = _TABLES["wheel_roughness"]
"""Table G-1a, wheel, dB re 1 µm at the nominal wavelengths from 1 m to 0.8 mm, by brake."""
WHEEL_TRANSFER: Tables = _TABLES["wheel_transfer"]
"""Table G-3b, vehicle by wheel diameter, dB at nominal frequencies from 50 Hz to 10 kHz."""

EVEN, CNOSSOS, DIPOLE = DIRECTIVITIES = ("even", "cnossos", "dipole")
"""Ways in which rolling noise is spread over directions; the second is `directivity`."""

PAD_CLASSES: dict[str, tuple[float, float]] = {
    "soft": (150e6, 250e6),
    "medium": (250e6, 800e6),
    "hard": (800e6, 1000e6),
}
"""Table [2.3.b], digit 3 of a track's descriptor: dynamic stiffness of rail pads, least and largest, N/m."""


def wavelengths() -> Array:
    """Nominal wavelengths of the tables (35,), m, falling from 2 m to 0.8 mm."""
    return np.array(_TABLES["wavelengths"]) * 1e-3


def rail_roughness(name: str) -> Spectrum:
    """Rail roughness in one-third octaves: nominal wavelengths (35,), m, and levels, dB re 1 µm.

    Of "iso3095" (well maintained) or "cnossos-average".
    Directive (EU) 2015/996 as amended by (EU) 2021/1226, table G-1b. Of the 35 bands EN ISO 3095:2013 itself
    gives the 22 from 400 mm to 3.15 mm.
    """
    return wavelengths(), _table("rail_roughness", name)


def wheel_roughness(name: str) -> Spectrum:
    """Wheel roughness in one-third octaves: nominal wavelengths (32,), m, 1 m to 0.8 mm, levels, dB re 1 µm.

    By the brake: "cast-iron", "composite" (K block) or "disc". Directive (EU) 2015/996 as amended by (EU)
    2021/1226, table G-1a, which gives nothing outside of these bands.
    """
    return wavelengths()[3:], _table("wheel_roughness", name)


def contact_filter(name: str) -> Spectrum:
    """Contact filter A3 in one-third octaves: nominal wavelengths (35,), m, and dB to add to roughness.

    By wheel load and diameter: "50 kN, 360 mm", "50 kN, 680 mm", "50 kN, 920 mm", "25 kN, 920 mm" or "100 kN,
    920 mm". Directive (EU) 2015/996 as amended by (EU) 2021/1226, table G-2.
    """
    return wavelengths(), _table("contact_filter", name)


def nearest_contact_filter(load: float, diameter: float) -> str:
    """Name of the contact filter whose load, N, and wheel diameter, m, are nearest.

    The smallest distance in ln(load), ln(diameter).
    """
    return _nearest(_TABLES["contact_filter"], 1e-3 * load, 1e3 * diameter)


def nearest_pad_class(stiffness: float) -> str:
    """Class of rail pads, of `PAD_CLASSES`, in which a stiffness, N/m, lies, or to which it is nearest."""
    return next((name for name, (_, most) in PAD_CLASSES.items() if stiffness < most), "hard")


def nearest_wheel_transfer(diameter: float) -> str:
    """Name of the wheel transfer whose diameter is nearest to one, m, by their ratio."""
    return _nearest(WHEEL_TRANSFER, 1e3 * diameter)


def track_transfer(name: str) -> Spectrum:
    """Transfer from the total effective roughness to the sound power of the track, (24,).

    Nominal band centres, 50 Hz to 10 kHz, and sound power level per axle less roughness level, dB re 1 pW and
    1 µm, by the rail pad of a track on mono-block sleepers: "soft", "medium" or "hard". Directive (EU)
    2015/996 as amended by (EU) 2021/1226, table G-3a.
    """
    return np.array(_TABLES["frequencies"]), _table("track_transfer", name)


def wheel_transfer(name: str) -> Spectrum:
    """Transfer from the total effective roughness to the sound power of the wheels, (24,).

    Nominal band centres, 50 Hz to 10 kHz, and sound power level per axle less roughness level, dB re 1 pW and
    1 µm, by the wheel diameter: "1200 mm", "920 mm", "840 mm" or "680 mm". Directive (EU) 2015/996 as amended
    by (EU) 2021/1226, table G-3b.
    """
    return np.array(_TABLES["frequencies"]), _table("wheel_transfer", name)


def directivity(azimuth: ArrayLike, elevation: ArrayLike, frequency: ArrayLike) -> Array:
    """Directivity of rolling noise, dB to add to the level of an even source, of all three broadcast.

    Angles in rad: around, from the track, and up, from the ground; downwards it is that at zero. Frequencies
    are centres of bands, Hz. Directive (EU) 2015/996, section 2.3, equations 2.3.15 and 2.3.16 (source A).
    """
    around, up, f = (np.asarray(each, dtype=float) for each in (azimuth, elevation, frequency))
    above = np.maximum(up, 0.0)
    vertical = 40.0 / 3.0 * (2.0 / 3.0 * np.sin(2.0 * above) - np.sin(above)) * np.log10((f + 600.0) / 200.0)
    return 10.0 * np.log10(0.01 + 0.99 * np.sin(around) ** 2) + vertical


def _nearest(names: Tables, *values: float) -> str:
    """Name whose numbers are nearest to some values, by their ratios."""

    def distance(name: str) -> float:
        numbers = map(float, re.findall(r"\d+", name))
        return math.hypot(*(math.log(value / n) for value, n in zip(values, numbers, strict=True)))

    return min(names, key=distance)


def _table(what: str, name: str) -> Array:
    return np.array(_TABLES[what][name])
