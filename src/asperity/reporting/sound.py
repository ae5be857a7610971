"""Sound pressure beside the track while a vehicle passes, from its sound power and its contact force."""

import re
from dataclasses import dataclass
from itertools import product
from pathlib import Path

import numpy as np
from scipy.fft import irfft, rfft, rfftfreq
from xarray import DataArray, DataTree

from asperity.arguments import Array, FilePath, file_path, shown
from asperity.errors import InputError
from asperity.files import together, write_bytes
from asperity.reporting import data
from asperity.schema.rolling import CONTACT, CONTACT_FORCE, LAW, SPEED, TIME
from asperity.spectra import HALF_BAND, a_weighting, band_energies, energy_of, energy_sum, root_mean_square
from asperity.text_files import write_csv
from asperity.wave_files import wave_bytes
from asperity.written_numbers import rounded

PASS_BY = "pass_by_pressure"
"""Name of what is heard."""
SOUND_POWERS = {"radiated_power_level": ("radiator", "band"), "sound_power_level": ("source", "noise_band")}
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
    band, level = found
    rolling = tree["rolling"].to_dataset()
    speed = tree[SPEED.group].attrs.get(SPEED.name)
    if CONTACT_FORCE.name not in rolling or speed is None:
        return None
    time = rolling[TIME.name].values
    distance = np.hypot(DISTANCE, float(speed) * (time - 0.5 * (time[0] + time[-1])))
    force = _of_first(rolling[CONTACT_FORCE.name]).transpose(LAW.name, TIME.name)
    step = float(time[-1] - time[0]) / (len(time) - 1)
    forces = force.values.astype(float)
    source = [radiated(one, step, band, bands) for one, bands in zip(forces, level, strict=True)]
    pressure = np.array(source) * np.sqrt(IMPEDANCE / (2.0 * np.pi)) / distance
    return DataArray(pressure, force.coords, force.dims, PASS_BY, {"units": "Pa"})


def _of_first(values: DataArray) -> DataArray:
    """Numbers of the first contact, where there are contacts."""
    return values.isel({CONTACT.name: 0}, missing_dims="ignore", drop=True)


def _sound_power(tree: DataTree) -> tuple[Array, Array] | None:
    """Band centres (b,), Hz, and levels of all sources together (law, b), dB re 1 pW."""
    held = tree["spectra"].to_dataset() if "spectra" in tree.children else {}
    for name, (source, band) in SOUND_POWERS.items():
        if name in held:
            levels = held[name].transpose(LAW.name, source, band)
            parts = [number for number, each in enumerate(levels[source].values) if each != WHOLE]
            known = np.nan_to_num(levels.values[:, parts], nan=-np.inf)
            return levels[band].values, energy_sum(known, axis=1)
    return None


def radiated(force: Array, step: float, centre: Array, level: Array) -> Array:
    """Shape a force (n,) so that its mean square has a sound power level in each band, √W.

    Time step in s; centres (b,), Hz, and levels (b,), dB re 1 pW, of one-third octaves.
    """
    n = len(force)
    spectrum = rfft(force)
    frequency = rfftfreq(n, step)
    density = 2.0 * np.abs(spectrum) ** 2 * step / n
    held = band_energies(frequency, density, centre / HALF_BAND, centre * HALF_BAND)
    gain = np.zeros(len(frequency))
    for middle, energy, wanted in zip(centre, held, PICOWATT * energy_of(level), strict=True):
        inside = (frequency >= middle / HALF_BAND) & (frequency < middle * HALF_BAND)
        if energy > 0.0:
            gain[inside] = np.sqrt(wanted / energy)
    return irfft(gain * spectrum, n)


RATE = 48_000
"""Samples of a WAV file per second."""
PEAK = 10 ** (-1.0 / 20.0)
"""Largest sample of all, as a share of what a file can hold: 1 dB is left for players that filter."""
FADE = 0.01
"""Time over which a sound begins and ends, s: a hard edge would click."""
HEARD = ("m/s2", "m/s", "N")
"""Units of what is listened to, the first that a run holds by default: displacements rumble below hearing."""
TABLE = "sounds.csv"
"""What each file is, and what its largest possible sample stands for."""


@dataclass(frozen=True, eq=False)
class Sound:
    """A signal at 48 kHz, without its mean."""

    quantity: str  # name of the variable
    law: str
    place: str  # of the sensor or point, as ``"0.5 m"``; empty where there is one only
    unit: str
    samples: Array  # (n,), in its unit

    @property
    def file_name(self) -> str:
        """Name of its file, which the names in a foreign result lead nowhere else."""
        words = "-".join(filter(None, (self.quantity, self.law, self.place)))
        return re.sub(r"[^\w.+-]", "_", words).lstrip(".") + ".wav"

    @property
    def weighted(self) -> float:
        """Root mean square after A-weighting, in its unit."""
        n = len(self.samples)
        gain = 10 ** (a_weighting(rfftfreq(n, 1.0 / RATE)) / 20.0)
        return root_mean_square(irfft(gain * rfft(self.samples), n))


def listen(result: DataTree, path: FilePath, *, what: str | None = None, matched: bool = False) -> list[Path]:
    """Write what a run sounds like: a WAV file for each law and place, and a table of what they are.

    Parameters
    ----------
    result : xarray.DataTree
        The result of a run.
    path : path
        Folder that receives the files, mono, 48 kHz, 16 bits, and ``sounds.csv``, which says what a full
        sample stands for. It is made where it is missing.
    what : str, optional
        A variable of the group ``rolling``, in m/s², m/s or N; by default an acceleration, else a velocity.
        Or ``"pass_by_pressure"``, the sound pressure 7.5 m from a track, where the sound power is known.
    matched : bool
        Make all as loud as each other, by A-weighted level. By default all have the same scale, so that
        louder laws are heard as such.

    Returns
    -------
    list of Path
        The WAV files, by law and place.

    Raises
    ------
    InputError
        If the run holds nothing of that name, or `path` is no path.
    ComputationError
        If a file cannot be written.

    Notes
    -----
    Vibration is heard as it is, neither radiated nor transmitted; docs/method/conventions.md says how the
    pressure beside a track is made. Means are taken off; what lies above 24 kHz is left out. Both ends
    fade over 10 ms.

    Examples
    --------
    >>> import asperity
    >>> files = asperity.listen(asperity.run(case), "sounds")
    >>> files[0].suffix
    '.wav'
    """
    data.refuse_no_result(result)
    folder = file_path("sounds", path, "the path of a folder")
    sounds = sounds_of(result, what)
    heard = [sound.weighted for sound in sounds]
    louder = [max(heard) / each if matched and each > 0.0 else 1.0 for each in heard]
    largest = max(f * np.abs(s.samples).max() for f, s in zip(louder, sounds, strict=True)) or 1.0
    full = [largest / PEAK / factor for factor in louder]
    heading = ["file", "quantity", "law", "place", "unit", "full sample", "A-weighted rms"]
    rows = [
        [s.file_name, s.quantity, s.law, s.place, s.unit, each, weighted]
        for s, each, weighted in zip(sounds, full, heard, strict=True)
    ]
    with together(folder, last=TABLE) as new:
        for sound, each in zip(sounds, full, strict=True):
            write_bytes(
                new / sound.file_name, wave_bytes(sound.samples, RATE, each, sound.unit, what=sound.quantity)
            )
        write_csv(new / TABLE, heading, rows)
    return [folder / sound.file_name for sound in sounds]


def sounds_of(tree: DataTree, what: str | None) -> list[Sound]:
    """Signals of a variable of the run in time, of each law and place."""
    found = _heard(tree)
    if what == PASS_BY and (pressure := pass_by_pressure(tree)) is not None:
        found[PASS_BY] = pressure
    name = next(iter(found), None) if what is None else what
    if name not in found:
        allowed = ", ".join(found) or "nothing, for the run holds no signal of two samples or more"
        raise InputError("what to listen to", shown(name), allowed)
    values = found[name]
    values = values if values.sizes.get(CONTACT.name, 1) > 1 else _of_first(values)
    time = tree["rolling"].to_dataset()[TIME.name].values
    step = float(time[-1] - time[0]) / (len(time) - 1)
    places = [dim for dim in values.dims if dim not in (LAW.name, TIME.name)]
    sounds = []
    for index in product(range(values.sizes[LAW.name]), *(range(values.sizes[dim]) for dim in places)):
        one = values.isel(dict(zip((LAW.name, *places), index, strict=True)))
        where = (
            f"{rounded(float(one[dim]), 6)} {one[dim].attrs.get('units', '').removeprefix('1')}".strip()
            for dim in places
        )
        samples = at_rate(one.values.astype(float), step)
        law = str(one[LAW.name].item())
        unit = str(values.attrs["units"])
        sounds.append(Sound(name, law, ", ".join(where), unit, samples))
    return sounds


def _heard(tree: DataTree) -> dict[str, DataArray]:
    """Variables that can be listened to, in the order of `HEARD`."""
    if "rolling" not in tree.children or len(tree["rolling"].to_dataset().get(TIME.name, ())) < 2:
        return {}
    signals = [
        values
        for values in tree["rolling"].to_dataset().data_vars.values()
        if {LAW.name, TIME.name} <= set(values.dims)
        and values.attrs.get("units") in HEARD
        and np.isfinite(values.values).all()
    ]
    return {str(v.name): v for v in sorted(signals, key=lambda v: HEARD.index(v.attrs["units"]))}


def at_rate(signal: Array, step: float) -> Array:
    """Signal (n,) of a time step, s, without its mean and with soft ends, at 48 kHz.

    By its Fourier series: exact for what repeats in the record, and longer or shorter than it by less than a
    sample, which changes pitch by less than that.
    """
    from scipy.signal import resample  # takes half a second to import, of every run
    from scipy.signal.windows import tukey

    n = len(signal)
    soft = (signal - signal.mean()) * tukey(n, min(2.0 * FADE / (n * step), 1.0))
    return resample(soft, max(round(n * step * RATE), 2))
