"""Sound pressure beside the track while a vehicle passes, from its sound power and its contact force."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.fft import irfft, rfft, rfftfreq
from xarray import DataArray, DataTree

from asperity.schema.rolling import CONTACT_FORCE, LAW, SPEED, TIME
from asperity.spectra import HALF_BAND, band_energies, energy_sum

PASS_BY = "pass_by_pressure"
"""Name of what is heard."""
SOUND_POWER, NOISE_BAND, SOURCE = "sound_power_level", "noise_band", "source"
"""Of the variable of the group ``spectra``, in dB re 1 pW, and its dimensions."""
DISTANCE = 7.5
"""From the track, m (ISO 3095)."""
IMPEDANCE = 413.0
"""Of air at 20 °C, ρc, Pa s/m."""
PICOWATT = 1e-12


def pass_by_pressure(tree: DataTree) -> DataArray | None:
    """Sound pressure (law, time), Pa, 7.5 m from the track; None where the sound power is not known.

    The contact force of each law, weighted by one-third octaves so that it has the sound power level of the
    run, is the source; it passes the receiver in the middle of the record, at the speed of the run, and
    radiates evenly above reflecting ground: p² = W ρc/(2π d²). Doppler's effect, directivity and the length
    of the vehicle are left out, and what lies outside of the bands.
    """
    if "spectra" not in tree.children or SOUND_POWER not in tree["spectra"].to_dataset():
        return None
    power, rolling = tree["spectra"].to_dataset()[SOUND_POWER], tree["rolling"].to_dataset()
    speed = tree[SPEED.group].attrs.get(SPEED.name)
    if CONTACT_FORCE.name not in rolling or speed is None:
        return None
    time = rolling[TIME.name].values
    distance = np.hypot(DISTANCE, float(speed) * (time - 0.5 * (time[0] + time[-1])))
    level = energy_sum(
        np.nan_to_num(power.transpose(LAW.name, SOURCE, NOISE_BAND).values, nan=-np.inf), axis=1
    )
    force = rolling[CONTACT_FORCE.name].transpose(LAW.name, TIME.name)
    step = float(time[-1] - time[0]) / (len(time) - 1)
    source = [
        radiated(one, step, power[NOISE_BAND].values, bands)
        for one, bands in zip(force.values.astype(float), level, strict=True)
    ]
    pressure = np.array(source) * np.sqrt(IMPEDANCE / (2.0 * np.pi)) / distance
    return DataArray(pressure, force.coords, force.dims, PASS_BY, {"units": "Pa"})


def radiated(
    force: NDArray[np.float64], step: float, centre: NDArray[np.float64], level: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Shape a force (n,) so that its mean square has a sound power level in each band, √W.

    Time step in s; centres (b,), Hz, and levels (b,), dB re 1 pW, of one-third octaves.
    """
    n = len(force)
    spectrum, frequency = rfft(force), rfftfreq(n, step)
    density = 2.0 * np.abs(spectrum) ** 2 * step / n
    held = band_energies(frequency, density, centre / HALF_BAND, centre * HALF_BAND)
    gain = np.zeros(len(frequency))
    for middle, energy, wanted in zip(centre, held, PICOWATT * 10.0 ** (level / 10.0), strict=True):
        inside = (frequency >= middle / HALF_BAND) & (frequency < middle * HALF_BAND)
        if energy > 0.0:
            gain[inside] = np.sqrt(wanted / energy)
    return np.asarray(irfft(gain * spectrum, n))
