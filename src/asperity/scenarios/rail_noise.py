"""What a contact law means for rolling noise: sound power of track and wheel by CNOSSOS-EU."""

from __future__ import annotations

import numpy as np
import xarray
from numpy.typing import NDArray

from asperity.reference import cnossos
from asperity.results import variable
from asperity.rolling.noise import SOURCES, SoundPower, rolling_sound_power
from asperity.scenarios.wheel_on_rail import Computed
from asperity.surfaces.heightmap import Profile
from asperity.surfaces.levels import band_levels_of


def noise_variables(
    computed: Computed, band: NDArray[np.float64], force_level: NDArray[np.float64]
) -> dict[str, xarray.Variable]:
    """Sound power of each law: that of the linear contact, changed in each band by as much as the force.

    Parameters
    ----------
    computed : Computed
        What was computed.
    band : ndarray, shape (b,)
        Band centres, Hz.
    force_level : ndarray, shape (laws, b)
        dB re 1 N.

    Returns
    -------
    dict of str to Variable
        Nothing without the linear law or without roughness.

    Notes
    -----
    The linear law follows the bare line, so its sound power is that of CNOSSOS-EU without the contact
    filter A3: the difference of another law holds what its contact filters. Bands in which the
    force is not computed are left out of all totals.
    """
    laws = list(computed.chain.runs)
    linear = _linear(computed)
    if linear is None or "linear" not in laws:
        return {}
    computed_bands = (linear.band > band[0] / 1.05) & (linear.band < band[-1] * 1.05)
    shown = computed_bands & ~np.isnan(linear.levels).any(axis=0)
    linear = SoundPower(linear.band[shown], linear.levels[:, shown])
    difference = force_level - force_level[laws.index("linear")]
    powers = [linear.with_difference(band, np.where(np.isfinite(d), d, np.nan)) for d in difference]
    return {
        "source": variable("source", np.array(SOURCES), "1", "what radiates"),
        "noise_band": variable("noise_band", linear.band, "Hz", "one-third-octave band centre"),
        "sound_power_level": variable(
            ("law", "source", "noise_band"),
            np.stack([power.levels for power in powers]),
            "dB re 1 pW",
            "sound power level of rolling",
        ),
        "sound_power_level_a": variable(
            ("law", "source"),
            np.stack([power.a_weighted for power in powers]),
            "dB(A) re 1 pW",
            "A-weighted sound power level of rolling, over the bands computed",
        ),
    }


def _linear(computed: Computed) -> SoundPower | None:
    """Sound power of CNOSSOS-EU without contact filter; None where nothing is rough."""
    case, textures = computed.case, computed.chain.textures
    rail, wheel = (_levels(textures.parts[part], case.contact.spacing) for part in ("rail", "wheel"))
    if rail is None and wheel is None:
        return None
    return rolling_sound_power(
        case.speed,
        rail,
        wheel,
        cnossos.track_transfer(case.noise.track_pad),
        cnossos.wheel_transfer(case.noise.wheel_transfer),
        axles=case.noise.axles,
    )


def _levels(
    line: NDArray[np.float64], spacing: float
) -> tuple[NDArray[np.float64], NDArray[np.float64]] | None:
    """Band levels of the line that is rolled over, where it is rough at all."""
    if not np.ptp(line):
        return None
    wavelength, level = band_levels_of(Profile(line, spacing))
    lowest = np.where(np.isfinite(level), level, -200.0)
    return wavelength, lowest
