"""Signals and spectra as universal files have them: datasets 58, functions at nodal degrees of freedom."""

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np

from asperity.arguments import Array

TIME_RESPONSE, POWER_SPECTRAL_DENSITY = 1, 9
"""Types of functions."""
REAL, REAL_DOUBLE = 2, 4
TIME, FREQUENCY = 17, 18
OF_UNIT = {
    "m": (8, 1, 0), "m/s": (11, 1, 0), "m/s2": (12, 1, 0), "N": (13, 0, 1), "Pa": (15, -2, 1),
    "Hz": (18, 0, 0),
}  # fmt: skip
"""Type of data, and exponents of length and force, of each unit; others are unknown (0)."""
UNITS = """\
    -1
   164
         1SI: metre, newton            2
  1.00000000000000000D+00  1.00000000000000000D+00  1.00000000000000000D+00
  2.73150000000000000D+02
    -1
"""
"""Dataset 164: all is in SI."""
WIDTH = 80
"""Characters of a line of words."""


@dataclass(frozen=True, eq=False)
class Channel:
    """A function over time or frequency at one place, at equal steps from zero.

    Attributes
    ----------
    name : str
        What it is, in words.
    values : ndarray (n,)
        In its unit.
    step : float
        Of time, s, or of frequency, Hz.
    unit : str
        SI unit of a signal, or of what a spectrum is of, whose values are in its square over Hz.
    is_spectrum : bool
        Whether it is a power spectral density over frequency; else it is a signal over time.
    place : int
        Number of the sensor, point or contact, from 1.
    direction : int
        1 to 3 for x to z, 0 for none.
    start : float
        Time or frequency of the first value.
    about : tuple of str
        More words: case, law, place.
    """

    name: str
    values: Array
    step: float
    unit: str
    is_spectrum: bool = False
    place: int = 1
    direction: int = 0
    start: float = 0.0
    about: tuple[str, ...] = ()


def universal_text(channels: Iterable[Channel]) -> str:
    """Write a universal file of some channels: the units (dataset 164), then a dataset 58 for each.

    Numbers have 13 digits, the step of time 7: that is all the room there is.
    """
    return UNITS + "".join(map(_dataset, channels))


def _dataset(channel: Channel) -> str:
    kind, length, force = OF_UNIT.get(channel.unit, (0, 0, 0))
    words = [channel.name, *channel.about[:3]]
    words += ["NONE"] * (5 - len(words))
    function = POWER_SPECTRAL_DENSITY if channel.is_spectrum else TIME_RESPONSE
    place = f" {_words(channel.name)[:10]:10}{channel.place:10d}{channel.direction:4d}"
    reference = f" {'NONE':10}{0:10d}{0:4d}"
    points = f"{REAL_DOUBLE:10d}{len(channel.values):10d}{1:10d}"
    axis = f"{channel.start:13.6E}{channel.step:13.6E}{0.0:13.5E}"
    over = (FREQUENCY, "Frequency", "Hz") if channel.is_spectrum else (TIME, "Time", "s")
    unit = f"({channel.unit})^2/Hz" if channel.is_spectrum else channel.unit
    lines = ["    -1", "    58", *(_words(each) for each in words)]
    lines += [f"{function:5d}{0:10d}{0:5d}{0:10d}{place}{reference}", points + axis]
    lines += [_axis(over[0], 0, 0, over[1], over[2]), _axis(kind, length, force, channel.name, unit)]
    lines += [_axis(0, 0, 0, "NONE", "NONE")] * 2
    return "\n".join([*lines, *_numbers(channel.values), "    -1", ""])


def _words(text: str) -> str:
    """A line of words: never empty, in characters that all programs read."""
    plain = " ".join(text.encode("ascii", "replace").decode().split())
    return plain[:WIDTH] or "NONE"


def _axis(kind: int, length: int, force: int, label: str, unit: str) -> str:
    return f"{kind:10d}{length:5d}{force:5d}{0:5d} {_words(label)[:20]:20} {_words(unit)[:20]:20}"


def _numbers(values: Array) -> list[str]:
    """Lines of four numbers of 20 characters."""
    texts = [f"{value:20.12E}" for value in np.asarray(values, dtype=float).tolist()]
    return ["".join(texts[n : n + 4]) for n in range(0, len(texts), 4)]
