"""What a track imprints on every figure: its natural frequencies, the passing of sleepers."""

from __future__ import annotations

import numpy as np
from xarray import DataTree

from asperity.reporting.chart import INK, Note, Rules
from asperity.reporting.data import number, present, values
from asperity.scenes import schema
from asperity.schema.rolling import POSITION, SPEED, TIME

_NAMES = (
    (schema.ANTIRESONANCE_FREQUENCY, "anti-resonance"),
    (schema.CUT_ON_FREQUENCY, "cut-on"),
    (schema.PINNED_PINNED_FREQUENCY, "pinned–pinned"),
)


def natural_frequencies(tree: DataTree) -> dict[str, float]:
    """Frequencies of the resting track that the results state, in Hz, low to high, by name."""
    found = {label: f for attribute, label in _NAMES if (f := number(tree, attribute))}
    return dict(sorted(found.items(), key=lambda item: item[1]))


def natural_rules(tree: DataTree, low: float, high: float, named: bool = True) -> list[Rules | Note]:
    """Natural frequencies between two others, their names written along them."""
    inside = {label: f for label, f in natural_frequencies(tree).items() if low < f < high}
    names = [Note(f"{label}, {f:.0f} Hz", f, 0.03, y_share=True, upright=True) for label, f in inside.items()]
    return [Rules(np.array(list(inside.values()))), *(names if named else [])]


def pinned_pinned_split(tree: DataTree) -> tuple[float, float] | None:
    """The two frequencies f_pp ∓ v/2L that a moving load feels instead of f_pp, in Hz."""
    low, high = number(tree, schema.PINNED_PINNED_LOW), number(tree, schema.PINNED_PINNED_HIGH)
    return (low, high) if low and high else None


def split_rules(tree: DataTree, low: float, high: float) -> list[Rules | Note]:
    """Frequencies f_pp ∓ v/2L between two others, with their name at the top."""
    split = pinned_pinned_split(tree)
    if split is None or not low < split[0] < split[1] < high:
        return []
    return [Rules(np.array(split)), Note("f_pp ∓ v/2L", split[1], 0.97, y_share=True)]


def sleeper_tones(tree: DataTree, low: float, high: float) -> list[Rules]:
    """Short rules at n v/L between two frequencies."""
    tone = number(tree, schema.SLEEPER_PASSING_FREQUENCY)
    if not tone:
        return []
    return [_short(tone * np.arange(max(1, np.ceil(low / tone)), np.floor(high / tone) + 1))]


def sleeper_times(tree: DataTree, start: float, end: float, unit: float) -> list[Rules]:
    """Short rules where the wheel passes sleepers between two times, on an axis in `unit` s."""
    spacing, speed = number(tree, schema.SLEEPER_SPACING), number(tree, SPEED)
    if not spacing or not speed or not present(tree, POSITION):
        return []
    time, position = values(tree, TIME), values(tree, POSITION)
    first, last = np.interp([start, end], time, position)
    sleepers = spacing * np.arange(np.ceil(first / spacing), np.floor(last / spacing) + 1)
    return [_short((time[0] + (sleepers - position[0]) / speed) / unit)]


def _short(at: np.ndarray) -> Rules:
    return Rules(at, colour=INK, dashes=(), width=0.8, short=True)
