"""One look for all figures: colours that colour-blind readers can tell apart, and what the eye can see."""

from __future__ import annotations

from collections.abc import Mapping
from itertools import cycle
from typing import Any

import numpy as np
from numpy.typing import NDArray

WIDE, NARROW = 9.6, 4.5
"""Inches: a figure as wide as the page, and as that of a phone."""
INK, MUTED, GRID = "#1c2126", "#5b6670", "#dfe3e7"
BLUE, VERMILLION, GREEN = "#0067a5", "#c8500a", "#00805c"

# The page replaces every colour of this table by a CSS variable, with a second value for dark screens.
COLOURS = {
    INK: "#e8eaed",
    MUTED: "#a3adb7",
    GRID: "#333a42",
    "#6b3e12": "#d6a074",  # brown
    "#2c3e91": "#8f9dff",  # navy
    "#b01b3c": "#ff7d90",  # crimson
    "#6750b8": "#b9a8ff",  # violet
    BLUE: "#58b0f0",
    VERMILLION: "#ff8b4d",
    "#a8458f": "#e58fcf",  # purple
    GREEN: "#2fc79a",
    "#96700a": "#e3b341",  # ochre
    "#2a93c4": "#8fd3f4",  # sky
    "#6f7a85": "#98a3ae",  # grey
    # a sequence from low to high (approaches, sensors)
    "#2b0f7a": "#7f8cff",
    "#7a0fa8": "#b083ff",
    "#b52f8c": "#e27fd0",
    "#d9566b": "#ff8c94",
    "#e07f2d": "#ffb066",
    "#b58a00": "#f5e05f",
}
HATCHES = ("", "/", "\\", "x", ".", "-")
"""Of bars beside each other, for those who do not see colours."""
DASHES = ((), (6, 1.5), (6, 1.5, 1.5, 1.5), (3, 1.5), (1.5, 1.5), (9, 1.5, 1.5, 1.5, 1.5, 1.5))
"""Of lines of a sequence, for the same."""
LAW_COLOURS, SEQUENCE = tuple(COLOURS)[3:-6], tuple(COLOURS)[-6:]


def colour_variables(dark: bool, colours: Mapping[str, str] = COLOURS) -> str:
    """CSS declarations of colours, by their places in the table: of their own values, or for dark screens."""
    return "".join(
        f"--c{index}:{other if dark else colour};" for index, (colour, other) in enumerate(colours.items())
    )


def sequence(count: int) -> list[str]:
    """`count` colours from low to high; repeats nothing up to six."""
    picks = np.linspace(0, len(SEQUENCE) - 1, max(count, 1)).round().astype(int)
    return [SEQUENCE[pick] for pick in picks]


def sequence_styles(count: int) -> list[dict[str, Any]]:
    """Looks of `count` lines from low to high, by colour and by dashes."""
    looks = zip(sequence(count), cycle(DASHES), strict=False)
    return [{"colour": colour, "dashes": dashes} for colour, dashes in looks]


def decibels(power: NDArray[np.float64], reference: float = 1.0) -> NDArray[np.float64]:
    """10 lg(power/reference); NaN where there is no power."""
    ratio = np.where(power > 0, power / reference, np.nan)
    return 10 * np.log10(ratio)


def envelope(
    signal: NDArray[np.float64], columns: int
) -> tuple[NDArray[np.int64], NDArray[np.float64], NDArray[np.float64]]:
    """Smallest and largest value of a long series (n,) in each of at most `columns` stretches.

    Returns the index at which each stretch starts, and the extremes, all (m,).
    """
    starts = np.unique(
        np.linspace(0, len(signal), min(columns, len(signal)), endpoint=False).astype(np.int64)
    )
    return starts, np.fmin.reduceat(signal, starts), np.fmax.reduceat(signal, starts)


def smooth_on_log_axis(
    frequency: NDArray[np.float64], psd: NDArray[np.float64], per_octave: int = 24
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Mean power in stretches of 1/`per_octave` octave, where lines are denser than that; for drawing only.

    Positive, increasing frequencies or wavenumbers (n,) and PSD (..., n); returns the same, with fewer lines.
    """
    index = np.floor(np.log2(frequency / frequency[0]) * per_octave).astype(int)
    starts = np.flatnonzero(np.diff(index, prepend=-1))
    count = np.diff(np.append(starts, len(frequency)))
    return np.add.reduceat(frequency, starts) / count, np.add.reduceat(psd, starts, axis=-1) / count
