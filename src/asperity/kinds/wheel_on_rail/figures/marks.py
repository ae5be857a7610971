"""What a track imprints on every figure: its natural frequencies, the passing of sleepers."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from xarray import DataTree

from asperity.kinds.wheel_on_rail import schema
from asperity.reporting.data import number, present, values
from asperity.reporting.style import INK, MUTED
from asperity.schema.rolling import POSITION, SPEED, TIME

LINE: dict[str, Any] = {"color": MUTED, "linewidth": 0.9, "linestyle": (0, (1, 1.5)), "zorder": 1}


@dataclass(frozen=True)
class Mark:
    """A frequency in Hz with the name it has in the field."""

    frequency: float
    label: str


def natural_frequencies(tree: DataTree) -> list[Mark]:
    """Frequencies of the resting track that the results state, low to high."""
    named = (
        (schema.ANTIRESONANCE_FREQUENCY, "anti-resonance"),
        (schema.CUT_ON_FREQUENCY, "cut-on"),
        (schema.PINNED_PINNED_FREQUENCY, "pinned–pinned"),
    )
    found = [(number(tree, attribute), label) for attribute, label in named]
    return sorted((Mark(f, label) for f, label in found if f), key=lambda mark: mark.frequency)


def draw_marks(axes: Axes, marks: list[Mark], labelled: bool = True, height: float = 0.03) -> None:
    """Dotted line at each frequency inside the axes, its name written along it at the share `height`."""
    low, high = axes.get_xlim()
    for mark in marks:
        if not low < mark.frequency < high:
            continue
        axes.axvline(mark.frequency, **LINE)
        if labelled:
            axes.annotate(
                f"{mark.label}, {mark.frequency:.0f} Hz", (mark.frequency, height),
                xycoords=axes.get_xaxis_transform(), xytext=(2, 0), textcoords="offset points",
                rotation=90, va="bottom", ha="left", fontsize=8, color=MUTED,
            )  # fmt: skip


def pinned_pinned_split(tree: DataTree) -> tuple[float, float] | None:
    """The two frequencies f_pp ∓ v/2L that a moving load feels instead of f_pp, in Hz."""
    low, high = number(tree, schema.PINNED_PINNED_LOW), number(tree, schema.PINNED_PINNED_HIGH)
    return (low, high) if low and high else None


def draw_split(axes: Axes, tree: DataTree) -> None:
    """Lines at f_pp ∓ v/2L, with their name between them at the top."""
    split = pinned_pinned_split(tree)
    if split is None or not axes.get_xlim()[0] < split[0] < split[1] < axes.get_xlim()[1]:
        return
    for frequency in split:
        axes.axvline(frequency, **LINE)
    axes.annotate(
        "f_pp ∓ v/2L", (split[1], 0.97), xycoords=axes.get_xaxis_transform(), xytext=(4, 0),
        textcoords="offset points", va="top", ha="left", fontsize=8.5, color=MUTED,
    )  # fmt: skip


def draw_sleeper_tones(axes: Axes, tree: DataTree) -> None:
    """Ticks along the bottom at n v/L, inside the axes."""
    tone = number(tree, schema.SLEEPER_PASSING_FREQUENCY)
    if not tone:
        return
    low, high = axes.get_xlim()
    tones = tone * np.arange(max(1, np.ceil(low / tone)), np.floor(high / tone) + 1)
    _ticks(axes, tones)


def draw_sleepers(axes: Axes, tree: DataTree, start: float, end: float, unit: float) -> None:
    """Ticks along the bottom where the wheel passes sleepers between two times, on an axis in `unit` s."""
    spacing, speed = number(tree, schema.SLEEPER_SPACING), number(tree, SPEED)
    if not spacing or not speed or not present(tree, POSITION):
        return
    time, position = values(tree, TIME), values(tree, POSITION)
    first, last = np.interp([start, end], time, position)
    sleepers = spacing * np.arange(np.ceil(first / spacing), np.floor(last / spacing) + 1)
    _ticks(axes, (time[0] + (sleepers - position[0]) / speed) / unit)


def _ticks(axes: Axes, places: np.ndarray) -> None:
    (ticks,) = axes.plot(
        places, np.full(len(places), 0.02), "|", transform=axes.get_xaxis_transform(), color=INK,
        markersize=6, markeredgewidth=0.8, clip_on=False, zorder=5, label="_ticks",
    )  # fmt: skip
    ticks.set_in_layout(False)
