"""The sampling rate that stands beside a signal in its file: a number, a time step, or times of their own."""

from collections.abc import Mapping
from typing import Any

from asperity.arguments import NDArray, require
from asperity.studies.times import BARE_RATES, SAME, rate_of
from asperity.surfaces.readers.arrays import plain_word
from asperity.written_numbers import rounded

_RATES = {
    "fs", "sr", "sps", "fsamp", "fsample", "fsampling", "srate", "samprate", "samplerate", "samplesrate",
    "samplingrate", "samplefreq", "samplingfreq", "samplefrequency", "samplingfrequency", "abtastrate",
}  # fmt: skip
_LIKELY = {"rate", "frequency", "freq"}
"""Names of a rate that may be that of a shaft, too."""
_STEPS = {
    "dt", "ts", "deltat", "timestep", "sampleperiod", "samplingperiod", "sampletime", "samplingtime",
    "sampleinterval", "samplinginterval", "timeincrement", "xincrement",
}  # fmt: skip
_TIMES = {"t", "time", "times", "zeit", "temps", "tiempo", "tempo"}
_HERTZ = {"": 1.0, "hz": 1.0, "khz": 1e3}
_SECONDS = {"": 1.0, "s": 1.0, "sec": 1.0, "ms": 1e-3, "us": 1e-6}
LIKELY = 1e3
"""Hz, from which on a rate of whatever is that of sampling: shafts turn slower."""
_KINDS = {
    name + unit: (kind, factor)
    for kind, names, units in (
        ("rate", _RATES, _HERTZ),
        ("likely", _LIKELY, _HERTZ),
        ("step", _STEPS, _SECONDS),
        ("times", _TIMES, _SECONDS),
    )
    for name in names
    for unit, factor in units.items()
}
"""What arrays hold by their names, as `plain_word` writes these, and the SI value of their unit."""
WORDS = tuple(_KINDS)
"""Names of what tells a rate."""


def rate_in(beside: Mapping[str, NDArray[Any]], count: int, source: str) -> tuple[float, str] | None:
    """Sampling rate, Hz, of a signal of so many samples, and the name in its file that tells it.

    A number, or times of all samples, is believed where the rate is plausible; None where nothing tells it.
    Refused are several that contradict each other.
    """
    found = {name: rate for name, values in beside.items() if (rate := _rate_by(name, values, count))}
    if not found:
        return None
    name, rate = next(iter(found.items()))
    received = ", ".join(f"{each} {rounded(told, 6)} Hz" for each, told in found.items())
    same = all(abs(each / rate - 1.0) <= SAME for each in found.values())
    remedy = "Save the signal with the one that is right."
    require(same, f"sampling rates in {source}", received, "the same rate", remedy)
    return rate, name


def _rate_by(name: str, values: NDArray[Any], count: int) -> float | None:
    """Sampling rate, Hz, that an array of a name tells, if it is plausible."""
    kind, unit = _KINDS.get(plain_word(name), ("", 1.0))
    rate = None
    if kind == "times" and values.size == count:
        rate = rate_of(values.ravel() * unit, name)
    elif values.size == 1 and (number := float(values.flat[0]) * unit) > 0.0:
        rate = 1.0 / number if kind == "step" else number if kind in ("rate", "likely") else None
    least = LIKELY if kind == "likely" else BARE_RATES[0]
    return rate if rate is not None and least <= rate <= BARE_RATES[1] else None
