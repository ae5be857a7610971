"""What a contact law means for rolling noise: sound power of track and wheel by CNOSSOS-EU."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from asperity.kinds.wheel_on_rail import schema
from asperity.kinds.wheel_on_rail.compute import Computed
from asperity.kinds.wheel_on_rail.labels import track_label, wheel_label
from asperity.kinds.wheel_on_rail.sound_power import SOURCES, SoundPower, rolling_sound_power
from asperity.laws import Role, in_role
from asperity.reference import cnossos
from asperity.schema import Entry
from asperity.spectra import HALF_BAND
from asperity.surfaces.heightmap import Profile
from asperity.surfaces.levels import band_levels_of

EMPTY = -200.0
"""Level of a band without texture, dB re 1 µm."""


def noise(
    computed: Computed, band: NDArray[np.float64], force_level: NDArray[np.float64]
) -> dict[Entry, Any]:
    """Sound power of each law: that of the linear contact, changed in each band by as much as the force.

    Force levels (laws, b), dB re 1 N, in bands with centres (b,), Hz. The linear law follows the bare line,
    so its sound power is that of CNOSSOS-EU without the contact filter A3: the difference of another law
    holds what its contact filters. Bands in which the force is not computed are left out of all totals.
    Nothing without the linear law or without roughness.
    """
    laws = list(computed.chain.runs)
    bare = in_role(Role.BARE, laws)
    if bare is None or not np.ptp(computed.chain.textures.line):
        return {}
    linear, filtered = (_within(_linear(computed, name), band) for name in (None, _filter_of(computed)))
    difference = force_level - force_level[laws.index(bare)]
    powers = [linear.with_difference(band, np.where(np.isfinite(d), d, np.nan)) for d in difference]
    levels = np.stack([power.levels for power in powers])
    standard = schema.CNOSSOS_SOUND_POWER_LEVEL_A
    return {
        schema.SOURCE: SOURCES,
        schema.NOISE_BAND: linear.band,
        schema.SOUND_POWER_LEVEL: schema.SOUND_POWER_LEVEL.variable(levels, reference=bare),
        schema.SOUND_POWER_LEVEL_A: np.stack([power.a_weighted for power in powers]),
        standard: standard.variable(filtered.a_weighted, contact_filter=_filter_of(computed)),
    }


def _filter_of(computed: Computed) -> str:
    wheel = computed.case.wheel
    return cnossos.nearest_contact_filter(wheel.load, 2.0 * wheel.radius)


def _linear(computed: Computed, contact_filter: str | None) -> SoundPower:
    """Sound power of CNOSSOS-EU, with or without a contact filter."""
    case, textures = computed.case, computed.chain.textures
    rail, wheel = (_levels(textures.parts[part], case.contact.spacing) for part in ("rail", "wheel"))
    return rolling_sound_power(
        case.speed,
        rail,
        wheel,
        cnossos.track_transfer(track_label(case)),
        cnossos.wheel_transfer(wheel_label(case)),
        contact_filter=None if contact_filter is None else cnossos.contact_filter(contact_filter),
        axles=case.noise.axles,
    )


def _within(power: SoundPower, band: NDArray[np.float64]) -> SoundPower:
    """Keep the bands for which there are roughness and force."""
    shown = (power.band > band[0] / 1.05) & (power.band < band[-1] * 1.05)
    shown &= ~np.isnan(power.levels).any(axis=0)
    return SoundPower(power.band[shown], power.levels[:, shown])


def _levels(
    line: NDArray[np.float64], spacing: float
) -> tuple[NDArray[np.float64], NDArray[np.float64]] | None:
    """Band levels of the line that is rolled over, at the wavelengths of CNOSSOS-EU, where it is rough."""
    if not np.ptp(line):
        return None
    known = cnossos.wavelengths()
    shortest, longest = max(known.min(), 2.0 * spacing * HALF_BAND), known.max()
    wavelength, level = band_levels_of(Profile(line, spacing))
    inside = (wavelength > shortest / 1.05) & (wavelength < longest * 1.05)
    return wavelength[inside], np.where(np.isfinite(level), level, EMPTY)[inside]
