"""Signals and spectra of a run as programs of measurement read them: universal files, WAV with a scale."""

from collections.abc import Iterator
from itertools import product
from pathlib import Path

import numpy as np
from xarray import DataArray, DataTree

from asperity.arguments import FilePath, file_path, one_of, require, shown
from asperity.errors import InputError
from asperity.files import together, write_bytes
from asperity.reporting import data
from asperity.reporting.sound import Sound, pass_by_pressure
from asperity.schema.rolling import LAW, TIME
from asperity.text_files import write_csv
from asperity.universal_files import Channel, universal_text
from asperity.wave_files import wave_bytes
from asperity.written_numbers import rounded

FORMATS = ("uff", "wav")
UNIVERSAL, TABLE = "signals.uff", "signals.csv"
USUAL = ("N", "m/s2", "m/s", "Pa", "Hz")
"""Units of signals that are written unasked: displacements follow from them."""
BITS = 24
"""Of a sample in WAV: the static part of a force takes the upper ones."""
FREQUENCY = "frequency"
BY = " by "
"""What stands between a variable and its law in the name of a signal."""


def write_signals(
    result: DataTree, path: FilePath, *, format: str = "uff", what: str | None = None
) -> list[Path]:
    """Write signals and spectra of a run as programs of measurement read them.

    Parameters
    ----------
    result : xarray.DataTree
        The result of a run of any kind.
    path : path
        Folder that receives ``signals.uff``, or WAV files, and ``signals.csv``, which says what each signal
        is. It is made where it is missing.
    format : {"uff", "wav"}
        One universal file of all signals (dataset 58, time responses) and power spectral densities, in SI, of
        13 digits; or for each signal a WAV file of 24 bits at its own sampling rate, rounded to whole
        numbers, whose full scale is the largest value: in ``signals.csv``, and as JSON in the comment of the
        file (``{"full_scale": 9.81, "at": 8388607, "unit": "m/s2", …}``), by which `asperity bearing` reads
        it in its unit.
    what : str, optional
        One variable of the groups ``rolling`` and ``spectra``, or ``"pass_by_pressure"``; by default all
        forces, accelerations, velocities, pressures and speeds over time, and all power spectral densities.

    Returns
    -------
    list of Path
        The files with signals.

    Raises
    ------
    InputError
        If the run holds nothing of that name, or `path` is no path.
    ComputationError
        If a file cannot be written.

    Examples
    --------
    >>> import asperity
    >>> asperity.write_signals(asperity.run(case), "signals")[0].name
    'signals.uff'
    """
    data.refuse_no_result(result)
    one_of("format of the signals", format, FORMATS)
    folder = file_path("signals", path, "the path of a folder")
    channels = [each for each in channels_of(result, what) if format == "uff" or not each.is_spectrum]
    require(
        channels, "signals of the run", "spectra alone", 'signals over time in WAV; format "uff" has both'
    )
    files = [UNIVERSAL] * len(channels) if format == "uff" else [_file_name(each) for each in channels]
    heading = [
        "file",
        "signal",
        "meaning",
        "law",
        "place",
        "unit",
        "step",
        "unit of the step",
        "samples",
        "largest",
    ]
    rows = [
        [
            file, each.name.partition(BY)[0], *each.about, _unit(each), each.step,
            "Hz" if each.is_spectrum else "s", len(each.values), _largest(each),
        ]
        for file, each in zip(files, channels, strict=True)
    ]  # fmt: skip
    with together(folder, last=TABLE) as new:
        if format == "uff":
            write_bytes(new / UNIVERSAL, universal_text(channels).encode())
        else:
            for file, each in zip(files, channels, strict=True):
                write_bytes(new / file, _wave(each))
        write_csv(new / TABLE, heading, rows)
    return [folder / file for file in dict.fromkeys(files)]


def _wave(channel: Channel) -> bytes:
    full = _largest(channel) or 1.0
    rate = 1.0 / channel.step
    return wave_bytes(channel.values, rate, full, channel.unit, bits=BITS, what=channel.name)


def _largest(channel: Channel) -> float:
    return float(np.abs(channel.values).max(initial=0.0))


def _unit(channel: Channel) -> str:
    return f"({channel.unit})2/Hz" if channel.is_spectrum else channel.unit


def _file_name(channel: Channel) -> str:
    name, _, law = channel.name.partition(BY)
    return Sound(name, law, channel.about[2], channel.unit, channel.values).file_name


def channels_of(tree: DataTree, what: str | None) -> list[Channel]:
    """Signals of a run over time, and its power spectral densities: all that are usual, or a variable."""
    found = {str(each.name): each for each in _variables(tree)}
    usual = {name: each for name, each in found.items() if _of_what(each)[0] in USUAL}
    if what is not None and what not in found:
        allowed = ", ".join(found) or "nothing, for the run holds no signal of two samples or more"
        raise InputError("signals of the run", shown(what), allowed)
    chosen = usual if what is None else {what: found[what]}
    require(chosen, "signals of the run", "none of two samples or more", "a run that was recorded in time")
    return [channel for each in chosen.values() for channel in _channels(each)]


def _variables(tree: DataTree) -> Iterator[DataArray]:
    """What a run holds over time, or over frequency as a power spectral density, at equal steps."""
    for group, over in (("rolling", TIME.name), ("spectra", FREQUENCY)):
        for each in tree[group].to_dataset().data_vars.values() if group in tree.children else ():
            even = over in each.dims and each.sizes[over] > 1 and each.attrs.get("units") is not None
            density = str(each.attrs.get("units", "")).endswith("2/Hz")
            if even and (density or over == TIME.name) and np.isfinite(each.values).all():
                yield each
    if (pressure := pass_by_pressure(tree)) is not None:
        yield pressure.assign_attrs(long_name="sound pressure 7.5 m from the track")


def _of_what(values: DataArray) -> tuple[str, bool]:
    """Unit of a signal, or of what a power spectral density is of, and whether it is one."""
    unit = str(values.attrs["units"])
    spectrum = unit.endswith("2/Hz")
    return (unit.removesuffix("2/Hz").strip("()") if spectrum else unit), spectrum


def _channels(values: DataArray) -> Iterator[Channel]:
    """A variable at each of its places, by each law."""
    unit, spectrum = _of_what(values)
    over = FREQUENCY if spectrum else TIME.name
    at = values[over].values
    step = float(at[-1] - at[0]) / (len(at) - 1)
    others = [str(dim) for dim in values.dims if dim != over]
    for index in product(*(range(values.sizes[dim]) for dim in others)):
        one = values.isel(dict(zip(others, index, strict=True)))
        law = str(one[LAW.name].item()) if LAW.name in others else ""
        places = {dim: n for dim, n in zip(others, index, strict=True) if dim != LAW.name}
        words = ", ".join(_place(values, dim, n) for dim, n in places.items())
        name = BY.join(filter(None, (str(values.name), law)))
        number = (
            1 + int(np.ravel_multi_index(tuple(places.values()), [values.sizes[d] for d in places]))
            if places
            else 1
        )
        about = (str(values.attrs.get("long_name", values.name)), law, words)
        numbers = np.asarray(one.values, dtype=float)
        yield Channel(name, numbers, step, unit, spectrum, number, start=float(at[0]), about=about)


def _place(values: DataArray, dim: str, number: int) -> str:
    """Where something is, in words: the coordinate of a dimension, or the number on it."""
    if dim not in values.coords:
        return f"{dim} {number + 1}"
    at = values[dim]
    value = at.values[number]
    shows = rounded(float(value), 6) if at.dtype.kind in "fiu" else str(value)
    return f"{dim} {shows} {str(at.attrs.get('units', '')).removeprefix('1')}".strip()
