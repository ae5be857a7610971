"""Sound power of rolling by CNOSSOS-EU, of a track and a wheel by their labels."""

from typing import Any

import numpy as np

from asperity.arguments import Array, ArrayLike, Integers
from asperity.errors import Finding, Grade
from asperity.laws import Role, in_role, names
from asperity.reference import cnossos
from asperity.scenes import compute, schema
from asperity.schema import Values
from asperity.spectra import (
    HALF_BAND,
    a_weighted_total,
    energy_mean,
    energy_of,
    energy_sum,
    third_octave_numbers,
)
from asperity.speeds import SpeedCourse

Table = tuple[ArrayLike, ArrayLike]
"""Band centres and levels in dB, each (n,)."""

SOURCES = ("track", "wheel", "total")
EMPTY = -200.0
"""Level of a band without texture, dB re 1 µm."""
MONO_BLOCK = (110.0, 210.0)
"""Mass of half a mono-block sleeper of concrete, kg: 140 to 177.5 kg are published for models of tracks; half
of one of wood, or of two blocks, is lighter."""
CLOSE = 1.15
"""Ratio to the diameter of the label by which the wheel may be larger or smaller."""


def track_label(case: Any) -> str:
    """Class of rail pads nearest to those of the case."""
    return cnossos.nearest_pad_class(case.track.model().pad_stiffness)


def wheel_label(case: Any) -> str:
    """Diameter nearest to that of the wheel of the case."""
    return cnossos.nearest_wheel_transfer(2.0 * case.rolling.radius)


def findings_of_labels(case: Any) -> list[Finding]:
    """Hold track and wheel of a case to those of which CNOSSOS-EU knows the sound power."""
    track = case.track.model()
    wheel = float(wheel_label(case).split()[0])
    least, most = cnossos.PAD_CLASSES[track_label(case)]
    rows = {  # value, and between which it may lie
        "dynamic stiffness of the rail pads, MN/m": (1e-6 * track.pad_stiffness, 1e-6 * least, 1e-6 * most),
        "mass of half a sleeper, kg": (track.sleeper_mass, *MONO_BLOCK),
        "diameter of the wheel, mm": (2e3 * case.rolling.radius, wheel / CLOSE, wheel * CLOSE),
    }
    words = "CNOSSOS-EU's sound power is that of another one.", "Take the sound power from the vibration."
    return [
        Finding(f"{name}, for CNOSSOS-EU", f"{value:.4g}", f"{low:.4g} to {high:.4g}", Grade.WARNING, *words)
        for name, (value, low, high) in rows.items()
        if not low <= value <= high
    ]


def cited(case: Any) -> tuple[str, ...]:
    """What sound power at a constant speed is cited by."""
    return () if isinstance(case.speed, SpeedCourse) else (cnossos.CITATION,)


def rolling_sound_power(
    speed: float,
    rail_roughness: Table | None,
    wheel_roughness: Table | None,
    track_transfer: Table,
    wheel_transfer: Table,
    *,
    contact_filter: Table | None = None,
    axles: int = 1,
) -> tuple[Array, Array]:
    """Sound power of rolling: L_W = (L_rail ⊕ L_wheel + A₃) + L_H + 10 lg N, for N axles at a speed, m/s.

    Exact centres of the one-third octaves (b,), Hz, and levels of the `SOURCES` (3, b), dB re 1 pW.
    Roughnesses are wavelengths, m, and levels, dB re 1 µm, None for a smooth one; transfers frequencies, Hz,
    and L_H, dB, both for the same bands, in which the result is; the contact filter wavelengths, m, and A₃,
    dB, for all bands of the roughness. Leave it out where a difference of force levels will be added that
    holds the filtering of the contact already.

    A band of frequency f holds the wavelengths around v/f: those of two wavelength bands, whose energies are
    shared in proportion, that is interpolated in lg λ. Where one surface has no level, the other one's counts
    alone; where both have none, the band is NaN.
    """
    numbers, track = _bands(track_transfer)
    _, wheel = _bands(wheel_transfer)
    rough = [_bands(table) for table in (rail_roughness, wheel_roughness) if table is not None]
    wavelength = np.arange(min(n[0] for n, _ in rough), max(n[-1] for n, _ in rough) + 1)
    energy = np.zeros(len(wavelength))
    for at, level in rough:
        energy[at - wavelength[0]] += energy_of(level)
    if contact_filter is not None:
        at, gain = _bands(contact_filter)
        energy *= energy_of(gain[wavelength - at[0]])
    energy[energy == 0.0] = np.nan
    place = np.round(10.0 * np.log10(speed) - numbers, 9)  # 10 lg λ
    shared = axles * np.interp(place, wavelength, energy, left=np.nan, right=np.nan)
    levels = 10.0 * np.log10(shared) + np.stack([track, wheel])
    return 10.0 ** (numbers / 10.0), np.vstack([levels, energy_sum(levels, axis=0)])


def _bands(table: Table) -> tuple[Integers, Array]:
    """Numbers n of the bands 10^(n/10), rising, nearest to nominal or exact centres, and their levels."""
    numbers = third_octave_numbers(table[0]).astype(np.int64)
    levels = np.asarray(table[1], dtype=float)
    order = np.argsort(numbers)
    return numbers[order], levels[order]


def standard_power(computed: compute.Computed) -> Values:
    """Sound power of each law: that of the linear contact, changed in each band by as much as the force.

    Several contacts count by the energy mean of their changes, all with the roughness of the first. The
    linear law follows the bare line, so its sound power is that of CNOSSOS-EU without the contact filter A3:
    the difference of another law holds what its contact filters. Bands in which the force is not computed are
    left out of all totals. The linear law is rolled for it where the case does not name it. Nothing without
    roughness, nor at a speed that changes, of which CNOSSOS-EU does not know.
    """
    case = computed.case
    bare = in_role(Role.BARE, names())
    if bare is None or computed.bare_levels is None:
        return {}
    contact_filter = cnossos.nearest_contact_filter(computed.shape.load, 2.0 * case.rolling.radius)
    centres, linear = _linear(computed, None)
    _, filtered = _linear(computed, cnossos.contact_filter(contact_filter))
    changes = computed.force_levels - computed.bare_levels
    change = energy_mean(changes, axis=1)
    at = np.searchsorted(third_octave_numbers(computed.band), third_octave_numbers(centres))
    levels = linear + np.where(np.isfinite(change), change, 0.0)[:, None, at]
    power = schema.SOUND_POWER_LEVEL
    standard = schema.CNOSSOS_SOUND_POWER_LEVEL_A
    of_standard = a_weighted_total(filtered, centres)
    return {
        schema.SOURCE: SOURCES,
        schema.NOISE_BAND: centres,
        power: power.variable(levels, reference=bare),
        schema.SOUND_POWER_LEVEL_A: a_weighted_total(levels, centres),
        standard: standard.variable(of_standard, contact_filter=contact_filter),
    }


def _linear(computed: compute.Computed, contact_filter: Table | None) -> tuple[Array, Array]:
    """Sound power of CNOSSOS-EU in the bands for which there are roughness and force."""
    case = computed.case
    band = computed.band
    rail, wheel = (_roughness(computed, part) for part in ("rail", "wheel"))
    transfers = cnossos.track_transfer(track_label(case)), cnossos.wheel_transfer(wheel_label(case))
    centres, levels = rolling_sound_power(
        case.speed, rail, wheel, *transfers, contact_filter=contact_filter, axles=len(case.contacts_behind)
    )
    shown = (centres > band[0] / 1.05) & (centres < band[-1] * 1.05) & ~np.isnan(levels).any(axis=0)
    return centres[shown], levels[:, shown]


def _roughness(computed: compute.Computed, part: str) -> Table | None:
    """Band levels of a part of the line that is rolled over, at the wavelengths of CNOSSOS-EU, if rough."""
    if not np.ptp(computed.textures.parts[part]):
        return None
    known = cnossos.wavelengths()
    shortest = max(known.min(), 2.0 * computed.case.contact.spacing * HALF_BAND)
    longest = known.max()
    wavelength, level = computed.line_levels[part]
    inside = (wavelength > shortest / 1.05) & (wavelength < longest * 1.05)
    return wavelength[inside], np.where(np.isfinite(level), level, EMPTY)[inside]
