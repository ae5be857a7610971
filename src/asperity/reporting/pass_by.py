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
SOUND_POWERS = {
    "radiated_power_level": ("radiator", "band"),
    "sound_power_level": ("source", "noise_band"),
}
"""Of the group ``spectra``, dB re 1 pW, the better one first, and their dimensions beside the law."""
WHOLE = "total"
"""What stands among the sources for all of them together."""
DISTANCE = 7.5
"""From the track, m (ISO 3095)."""
IMPEDANCE = 413.0
"""Of air at 20 °C, ρc, Pa s/m."""
PICOWATT = 1e-12


def pass_by_pressure(tree: DataTree) -> DataArray | None:
    """Sound pressure (law, time), Pa, 7.5 m from the track; None where the sound power is not known.

    The contact force of each law, weighted by one-third octaves so that it has the sound power level of the
    run, from its vibration or else by CNOSSOS-EU, is the source; it passes the receiver in the middle of the
    record, at the speed of the run, and radiates evenly above reflecting ground: p² = W ρc/(2π d²). Doppler's
    effect, directivity and the length of the vehicle are left out, and what lies outside of the bands.
    """
    found = _sound_power(tree)
    if found is None:
        return None
    (band, level), rolling = found, tree["rolling"].to_dataset()
    speed = tree[SPEED.group].attrs.get(SPEED.name)
    if CONTACT_FORCE.name not in rolling or speed is None:
        return None
    time = rolling[TIME.name].values
    distance = np.hypot(DISTANCE, float(speed) * (time - 0.5 * (time[0] + time[-1])))
    force = rolling[CONTACT_FORCE.name].transpose(LAW.name, TIME.name)
    step = float(time[-1] - time[0]) / (len(time) - 1)
    forces = force.values.astype(float)
    source = [radiated(one, step, band, bands) for one, bands in zip(forces, level, strict=True)]
    pressure = np.array(source) * np.sqrt(IMPEDANCE / (2.0 * np.pi)) / distance
    return DataArray(pressure, force.coords, force.dims, PASS_BY, {"units": "Pa"})


def _sound_power(tree: DataTree) -> tuple[NDArray[np.float64], NDArray[np.float64]] | None:
    """Band centres (b,), Hz, and levels of all sources together (law, b), dB re 1 pW."""
    held = tree["spectra"].to_dataset() if "spectra" in tree.children else {}
    for name, (source, band) in SOUND_POWERS.items():
        if name in held:
            levels = held[name].transpose(LAW.name, source, band)
            parts = [number for number, each in enumerate(levels[source].values) if each != WHOLE]
            known = np.nan_to_num(levels.values[:, parts], nan=-np.inf)
            return levels[band].values, energy_sum(known, axis=1)
    return None


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
