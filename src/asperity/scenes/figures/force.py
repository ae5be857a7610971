"""Figures of the wheel's contact force: around its largest value, and its spectrum with the track's marks."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray
from xarray import DataTree

from asperity.reporting.axes import levels_axis, linear_frequency_axis
from asperity.reporting.chart import Chart, Line, Panel, decibels
from asperity.reporting.data import engineering, laws, number, of_law, present, values
from asperity.reporting.force_figures import (
    IN_FREQUENCY,
    REFERENCE_STYLE,
    Spectrum,
    bars_words,
    cut_off,
    force_bands,
    forces_chart,
    forces_data,
    main_last,
    shaded_bands,
    shaded_words,
)
from asperity.reporting.law_entries import law_style
from asperity.reporting.part import Data, Part, Series, by_law, series
from asperity.scenes import schema
from asperity.scenes.figures.marks import pinned_pinned_split, sleeper_tones, split_rules
from asperity.schema.rolling import CONTACT_FORCE, POSITION, TIME
from asperity.schema.spectra import BAND, FORCE_PSD, FREQUENCY

AROUND_PEAK = 0.024
"""Length of the piece around the largest force, s."""
REFERENCE = schema.LINEAR_REFERENCE_PSD
WIDEST = 20.0
"""Widest stretch, Hz, over which lines are averaged for drawing: narrower than what the track imprints."""


def around_peak(tree: DataTree, length: float = AROUND_PEAK) -> slice:
    """Time steps within `length` s around the largest force of the main law."""
    force = of_law(tree, CONTACT_FORCE, laws(tree, CONTACT_FORCE)[0], "time")
    time = values(tree, TIME)
    peak = int(np.nanargmax(force))
    count = len(time)
    steps = min(count, max(2, round(length * (count - 1) / (time[-1] - time[0]))))
    start = min(max(peak - steps // 2, 0), count - steps)
    return slice(start, start + steps)


def peak_data(tree: DataTree) -> Data:
    """Contact force of each law around the largest force of the main law."""
    return forces_data(tree, around_peak(tree))


def _peak_caption(tree: DataTree) -> str:
    main = laws(tree, CONTACT_FORCE)[0]
    force = of_law(tree, CONTACT_FORCE, main, "time")
    peak = int(np.nanargmax(force))
    where = f"{engineering(force[peak], 'N')} at {values(tree, TIME)[peak]:.4f} s"
    if present(tree, POSITION):
        where += f", {values(tree, POSITION)[peak]:.3f} m along the rail"
    data = peak_data(tree)
    words = f"{bars_words(tree, data)}{cut_off(tree, data)}"
    return f"Around the largest force of the main law, {main}: {where}. Every time step.{words}"


def force_psd_data(tree: DataTree) -> Data:
    """Power spectral density of the contact force by each law and by the frequency domain, all lines."""
    lines: dict[Any, Series] = {**by_law(tree, FORCE_PSD)}
    if present(tree, REFERENCE):
        lines[REFERENCE] = series(tree, REFERENCE, IN_FREQUENCY)
    return Data(series(tree, FREQUENCY), lines)


def force_psd_chart(tree: DataTree, data: Data) -> Chart:
    """Power spectral densities of the contact force on a linear frequency axis, with the track's marks."""
    high = float(values(tree, BAND if present(tree, BAND) else FREQUENCY)[-1])
    drawn = {key: _thinned(data.at, psd.values, high) for key, psd in data.lines.items()}
    reference, main = drawn.pop(REFERENCE, None), next(iter(drawn))
    lines = [
        Line(*drawn[law], label=law, **law_style(tree, law, main) | _thin(law, main))
        for law in main_last(drawn)
    ]
    lines += [] if reference is None else [Line(*reference, **REFERENCE_STYLE)]
    axis = levels_axis("contact force PSD / dB re 1 N²/Hz", [level for _, level in drawn.values()])
    behind = (*shaded_bands(tree), *sleeper_tones(tree, 0.0, high), *split_rules(tree, 0.0, high))
    return Chart((Panel(linear_frequency_axis(high), axis, (*behind, *lines), height=4.6),))


def _lines_per_point(frequency: NDArray[np.float64]) -> int:
    return max(1, int(WIDEST / (frequency[1] - frequency[0]) + 1e-9)) if len(frequency) > 1 else 1


def _thinned(frequency: NDArray[np.float64], psd: NDArray[np.float64], high: float) -> Spectrum:
    """Level up to `high` Hz in dB, as the mean power of neighbouring lines."""
    kept = np.flatnonzero((frequency > 0) & (frequency <= high))
    count = _lines_per_point(frequency)
    kept = kept[: len(kept) // count * count] if len(kept) >= count else kept[:0]
    means = [field[kept].reshape(-1, count).mean(axis=1) for field in (frequency, psd)]
    return means[0], decibels(means[1])


def _thin(law: str, main: str) -> dict[str, float]:
    return {"width": 1.5 if law == main else 0.9}  # hundreds of lines side by side


def _psd_caption(tree: DataTree) -> str:
    count = _lines_per_point(values(tree, FREQUENCY))
    drawn = f"drawn as mean power of {count} lines" if count > 1 else "every line"
    text = [f"One-sided PSD, {drawn}; thick: the main law, {laws(tree, FORCE_PSD)[0]}."]
    if present(tree, REFERENCE):
        text.append(
            "Dashed: the linear contact in the frequency domain, F = −h/(α_W + α_C + α_R), at rest, with "
            "constant loss factors."
        )
    tone = number(tree, schema.SLEEPER_PASSING_FREQUENCY)
    if tone:
        text.append(f"Ticks along the bottom: sleeper passing, n v/L, every {tone:.1f} Hz.")
    split = pinned_pinned_split(tree)
    if split:
        text.append(
            f"Dotted: the pinned–pinned frequency as the moving wheel meets it, {split[0]:.0f} and "
            f"{split[1]:.0f} Hz."
        )
    turns = number(tree, schema.WHEEL_REVOLUTION_FREQUENCY)
    if turns:
        text.append(f"The wheel turns at {turns:.1f} Hz.")
    return " ".join(text) + shaded_words(tree)


FORCE_PEAK = Part(
    "force_peak",
    "Contact force around its largest value",
    (CONTACT_FORCE, TIME),
    peak_data,
    forces_chart,
    _peak_caption,
)
FORCE_SPECTRUM = Part(
    "force_psd",
    "Contact force against frequency",
    (FORCE_PSD, FREQUENCY),
    force_psd_data,
    force_psd_chart,
    _psd_caption,
)
FORCE_BANDS = force_bands(schema.LINEAR_REFERENCE_LEVEL)
