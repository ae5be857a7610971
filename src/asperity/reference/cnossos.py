"""Tables of the European method CNOSSOS-EU for the rolling noise of trains.

Directive (EU) 2015/996, appendix G, as amended by Delegated Directive (EU) 2021/1226: roughness of wheel
and rail (table G-1), contact filter (table G-2), transfer of track and vehicle from roughness to sound
power (table G-3). Wavelengths and frequencies are nominal one-third octaves.
"""

from __future__ import annotations

import math
from collections.abc import Mapping

import numpy as np

from asperity.arguments import Array
from asperity.errors import InputError

CITATION = "Directive (EU) 2015/996, appendix G, as amended by Delegated Directive (EU) 2021/1226"

Spectrum = tuple[Array, Array]

WAVELENGTHS_MM = (
    2000.0, 1600.0, 1250.0, 1000.0, 800.0, 630.0, 500.0, 400.0, 315.0, 250.0, 200.0, 160.0, 125.0,
    100.0, 80.0, 63.0, 50.0, 40.0, 31.5, 25.0, 20.0, 16.0, 12.5, 10.0, 8.0, 6.3, 5.0, 4.0, 3.15,
    2.5, 2.0, 1.6, 1.25, 1.0, 0.8,
)  # fmt: skip

TRANSFER_FREQUENCIES = (
    50.0, 63.0, 80.0, 100.0, 125.0, 160.0, 200.0, 250.0, 315.0, 400.0, 500.0, 630.0, 800.0, 1000.0,
    1250.0, 1600.0, 2000.0, 2500.0, 3150.0, 4000.0, 5000.0, 6300.0, 8000.0, 10000.0,
)  # fmt: skip
"""Hz."""

RAIL_ROUGHNESS: dict[str, tuple[float, ...]] = {
    "iso3095": (
        17.1, 17.1, 17.1, 17.1, 17.1, 17.1, 17.1, 17.1, 15.0, 13.0, 11.0, 9.0, 7.0, 4.9, 2.9, 0.9, -1.1, -3.2,
        -5.0, -5.6, -6.2, -6.8, -7.4, -8.0, -8.6, -9.2, -9.8, -10.4, -11.0, -11.6, -12.2, -12.8, -13.4, -14.0,
        -14.0,
    ),
    "cnossos-average": (
        35.0, 31.0, 28.0, 25.0, 23.0, 20.0, 17.0, 13.5, 10.5, 9.0, 6.5, 5.5, 5.0, 3.5, 2.0, 0.1, -0.2, -0.3,
        -0.8, -3.0, -5.0, -7.0, -8.0, -9.0, -10.0, -12.0, -13.0, -14.0, -15.0, -16.0, -17.0, -18.0, -19.0,
        -19.0, -19.0,
    ),
}  # fmt: skip
"""Table G-1b, rail, dB re 1 µm at `WAVELENGTHS_MM`: well maintained (the limit of EN ISO 3095:2013, continued
by the directive beyond 400 mm and below 3.15 mm) and average network."""

WHEEL_WAVELENGTHS_MM = WAVELENGTHS_MM[3:]
"""Wavelengths of the wheel roughness, 1 m to 0.8 mm; table G-1a prints 120, 12, 3.2 and 1.2 mm for the bands
of 125, 12.5, 3.15 and 1.25 mm."""

WHEEL_ROUGHNESS: dict[str, tuple[float, ...]] = {
    "cast-iron": (
        2.2, 2.2, 2.2, 2.2, 2.2, 2.2, 2.2, 2.2, 2.4, 0.6, 2.6, 5.8, 8.8, 11.1, 11.0, 9.8, 7.5, 5.1, 3.0, 1.3,
        0.2, -0.7, -1.2, -1.0, 0.3, 0.2, 1.3, 3.1, 3.1, 3.1, 3.1, 3.1,
    ),
    "composite": (
        -4.0, -4.0, -4.0, -4.0, -4.0, -4.0, -4.0, -4.0, -4.0, -4.0, -4.0, -4.3, -4.6, -4.9, -5.2, -6.3, -6.8,
        -7.2, -7.3, -7.3, -7.1, -6.9, -6.7, -6.0, -3.7, -2.4, -2.6, -2.5, -2.5, -2.5, -2.5, -2.5,
    ),
    "disc": (
        -5.9, -5.9, -5.9, -5.9, -5.9, -5.9, 2.3, 2.8, 2.6, 1.2, 2.1, 0.9, -0.3, -1.6, -2.9, -4.9, -7.0, -8.6,
        -9.3, -9.5, -10.1, -10.3, -10.3, -10.8, -10.9, -9.5, -9.5, -9.5, -9.5, -9.5, -9.5, -9.5,
    ),
}  # fmt: skip
"""Table G-1a, wheel, dB re 1 µm at `WHEEL_WAVELENGTHS_MM`, by brake."""

CONTACT_FILTERS: dict[tuple[int, int], tuple[float, ...]] = {
    (50, 360): (
        0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, -0.1, -0.2, -0.3, -0.6,
        -1.0, -1.8, -3.2, -5.4, -8.7, -12.2, -16.7, -17.7, -17.8, -20.7, -22.1, -22.8, -24.0, -24.5, -24.7,
        -27.0, -27.8,
    ),
    (50, 680): (
        0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, -0.1, -0.2, -0.3, -0.7, -1.2,
        -2.0, -4.1, -6.0, -9.2, -13.8, -17.2, -17.7, -18.6, -21.5, -22.3, -23.1, -24.4, -24.5, -25.0, -28.0,
        -28.8, -29.6,
    ),
    (50, 920): (
        0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, -0.1, -0.1, -0.3, -0.6, -1.1, -1.3,
        -3.5, -5.3, -8.0, -12.0, -16.8, -17.7, -18.0, -21.5, -21.8, -22.8, -24.0, -24.5, -25.0, -27.3, -28.1,
        -28.9, -29.7,
    ),
    (25, 920): (
        0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, -0.1, -0.3, -0.5, -1.1,
        -1.8, -3.3, -5.3, -7.9, -12.8, -16.8, -17.7, -18.2, -20.5, -22.0, -22.8, -24.2, -24.5, -25.0, -27.4,
        -28.2, -29.0,
    ),
    (100, 920): (
        0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, -0.1, -0.2, -0.3, -0.6, -1.0, -1.8, -3.2,
        -5.4, -8.7, -12.2, -16.7, -17.7, -17.8, -20.7, -22.1, -22.8, -24.0, -24.5, -24.7, -27.0, -27.8,
        -28.6, -29.4, -30.2,
    ),
}  # fmt: skip
"""Table G-2, dB at `WAVELENGTHS_MM`, by wheel load in kN and wheel diameter in mm."""

TRACK_TRANSFER: dict[str, tuple[float, ...]] = {
    "soft": (
        53.3, 59.3, 67.2, 75.9, 79.2, 81.8, 84.2, 88.6, 91.0, 94.5, 97.0, 99.2, 104.0, 107.1, 108.3, 108.5,
        109.7, 110.0, 110.0, 110.0, 110.3, 110.0, 110.1, 110.6,
    ),
    "medium": (
        50.9, 57.8, 66.5, 76.8, 80.9, 83.3, 85.8, 90.0, 91.6, 93.9, 95.6, 97.4, 101.7, 104.4, 106.0, 106.8,
        108.3, 108.9, 109.1, 109.4, 109.9, 109.9, 110.3, 111.0,
    ),
    "hard": (
        50.1, 57.2, 66.3, 77.2, 81.6, 84.0, 86.5, 90.7, 92.1, 94.3, 95.8, 97.0, 100.3, 102.5, 104.2, 105.4,
        107.1, 107.9, 108.2, 108.7, 109.4, 109.7, 110.4, 111.4,
    ),
}  # fmt: skip
"""Table G-3a, track on mono-block sleepers by rail pad, dB at `TRANSFER_FREQUENCIES`."""

PAD_CLASSES: dict[str, tuple[float, float]] = {
    "soft": (150e6, 250e6),
    "medium": (250e6, 800e6),
    "hard": (800e6, 1000e6),
}
"""Table [2.3.b], digit 3 of a track's descriptor: dynamic stiffness of rail pads, least and largest, N/m."""

WHEEL_TRANSFER: dict[str, tuple[float, ...]] = {
    "920 mm": (
        75.4, 77.3, 81.1, 84.1, 83.3, 84.3, 86.0, 90.1, 89.8, 89.0, 88.8, 90.4, 92.4, 94.9, 100.4, 104.6,
        109.6, 114.9, 115.0, 115.0, 115.5, 115.6, 116.0, 116.7,
    ),
    "840 mm": (
        75.4, 77.3, 81.1, 84.1, 82.8, 83.3, 84.1, 86.9, 87.9, 89.9, 90.9, 91.5, 91.5, 93.0, 98.7, 101.6,
        107.6, 111.9, 114.5, 114.5, 115.0, 115.1, 115.5, 116.2,
    ),
    "680 mm": (
        75.4, 77.3, 81.1, 84.1, 82.8, 83.3, 83.9, 86.3, 88.0, 92.2, 93.9, 92.5, 90.9, 90.4, 93.2, 93.5, 99.6,
        104.9, 108.0, 111.0, 111.5, 111.6, 112.0, 112.7,
    ),
    "1200 mm": (
        75.4, 77.3, 81.1, 84.1, 82.8, 83.3, 84.5, 90.4, 90.4, 89.9, 90.1, 91.3, 91.5, 93.6, 100.5, 104.6,
        115.6, 115.9, 116.0, 116.0, 116.5, 116.6, 117.0, 117.7,
    ),
}  # fmt: skip
"""Table G-3b, vehicle by wheel diameter, dB at `TRANSFER_FREQUENCIES`."""


def wavelengths() -> Array:
    """Nominal wavelengths of the tables (35,), m, falling from 2 m to 0.8 mm."""
    return np.array(WAVELENGTHS_MM) * 1e-3


def rail_roughness(name: str) -> Spectrum:
    """Rail roughness in one-third octaves: nominal wavelengths (35,), m, and levels, dB re 1 µm.

    Of "iso3095" (or "EN ISO 3095:2013", well maintained) or "cnossos-average" (or "average-network").
    Directive (EU) 2015/996 as amended by (EU) 2021/1226, table G-1b. Of the 35 bands EN ISO 3095:2013 itself
    gives the 22 from 400 mm to 3.15 mm.
    """
    aliases = {"EN ISO 3095:2013": "iso3095", "average-network": "cnossos-average"}
    return wavelengths(), _table("rail roughness", RAIL_ROUGHNESS, aliases.get(name, name))


def wheel_roughness(name: str) -> Spectrum:
    """Wheel roughness in one-third octaves: nominal wavelengths (32,), m, 1 m to 0.8 mm, levels, dB re 1 µm.

    By the brake: "cast-iron", "composite" (K block) or "disc". Directive (EU) 2015/996 as amended by (EU)
    2021/1226, table G-1a, which gives nothing outside of these bands.
    """
    return np.array(WHEEL_WAVELENGTHS_MM) * 1e-3, _table("wheel roughness", WHEEL_ROUGHNESS, name)


def contact_filter(name: str) -> Spectrum:
    """Contact filter A3 in one-third octaves: nominal wavelengths (35,), m, and dB to add to roughness.

    By wheel load and diameter: "50 kN, 360 mm", "50 kN, 680 mm", "50 kN, 920 mm", "25 kN, 920 mm" or "100 kN,
    920 mm". Directive (EU) 2015/996 as amended by (EU) 2021/1226, table G-2.
    """
    named = {_filter_name(*key): values for key, values in CONTACT_FILTERS.items()}
    return wavelengths(), _table("contact filter", named, name)


def nearest_contact_filter(load: float, diameter: float) -> str:
    """Name of the contact filter whose load, N, and wheel diameter, m, are nearest.

    The smallest distance in ln(load), ln(diameter).
    """
    for what, value in (("wheel load (N)", load), ("wheel diameter (m)", diameter)):
        if not 0.0 < value < math.inf:
            raise InputError(what, value, "a finite positive number")

    def distance(key: tuple[int, int]) -> float:
        return math.hypot(math.log(load / (1e3 * key[0])), math.log(diameter / (1e-3 * key[1])))

    return _filter_name(*min(CONTACT_FILTERS, key=distance))


def nearest_pad_class(stiffness: float) -> str:
    """Class of rail pads, of `PAD_CLASSES`, in which a stiffness, N/m, lies, or to which it is nearest."""
    if not 0.0 < stiffness < math.inf:
        raise InputError("stiffness of a rail pad (N/m)", stiffness, "a finite positive number")
    return next((name for name, (_, most) in PAD_CLASSES.items() if stiffness < most), "hard")


def nearest_wheel_transfer(diameter: float) -> str:
    """Name of the wheel transfer whose diameter is nearest to one, m, by their ratio."""
    if not 0.0 < diameter < math.inf:
        raise InputError("wheel diameter (m)", diameter, "a finite positive number")
    return min(WHEEL_TRANSFER, key=lambda name: abs(math.log(1e3 * diameter / float(name.split()[0]))))


def track_transfer(name: str) -> Spectrum:
    """Transfer from the total effective roughness to the sound power of the track, (24,).

    Nominal band centres, 50 Hz to 10 kHz, and sound power level per axle less roughness level, dB re 1 pW and
    1 µm, by the rail pad of a track on mono-block sleepers: "soft", "medium" or "hard". Directive (EU)
    2015/996 as amended by (EU) 2021/1226, table G-3a.
    """
    return np.array(TRANSFER_FREQUENCIES), _table("track transfer", TRACK_TRANSFER, name)


def wheel_transfer(name: str) -> Spectrum:
    """Transfer from the total effective roughness to the sound power of the wheels, (24,).

    Nominal band centres, 50 Hz to 10 kHz, and sound power level per axle less roughness level, dB re 1 pW and
    1 µm, by the wheel diameter: "1200 mm", "920 mm", "840 mm" or "680 mm". Directive (EU) 2015/996 as amended
    by (EU) 2021/1226, table G-3b.
    """
    return np.array(TRANSFER_FREQUENCIES), _table("wheel transfer", WHEEL_TRANSFER, name)


def _filter_name(load_kn: int, diameter_mm: int) -> str:
    return f"{load_kn} kN, {diameter_mm} mm"


def _table(what: str, tables: Mapping[str, tuple[float, ...]], name: str) -> Array:
    if name not in tables:
        raise InputError(what, repr(name), "one of " + "; ".join(repr(key) for key in tables))
    return np.array(tables[name])
