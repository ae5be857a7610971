"""Figures of the wheel's contact force: around its largest value, and its spectrum with the track's marks."""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import MultipleLocator
from numpy.typing import NDArray
from xarray import DataTree

from asperity.kinds.wheel_on_rail.figures.marks import draw_sleeper_tones, draw_split, pinned_pinned_split
from asperity.reporting.data import engineering, laws, number, of_law, present, values
from asperity.reporting.part import Columns, Part
from asperity.reporting.spectrum_figures import FORCE as PSD
from asperity.reporting.spectrum_figures import REFERENCE_STYLE, Spectrum, shade_bands, shaded_words
from asperity.reporting.style import decibels, law_style, legend_above, level_limits, new_figure, styled
from asperity.reporting.time_figures import FORCE, bars_words, columns_of_piece, cut_off, forces_with_flights

AROUND_PEAK = 0.024
"""Length of the piece around the largest force, s."""
REFERENCE_PSD = "spectra/linear_reference_psd"
WIDEST = 20.0
"""Widest stretch, Hz, over which lines are averaged for drawing: narrower than what the track imprints."""


def around_peak(tree: DataTree, length: float = AROUND_PEAK) -> slice:
    """Time steps within `length` s around the largest force of the main law."""
    force = of_law(tree, FORCE, laws(tree, FORCE)[0], "time")
    time = values(tree, "rolling/time")
    peak = int(np.nanargmax(force))
    count = len(time)
    steps = min(count, max(2, round(length * (count - 1) / (time[-1] - time[0]))))
    start = min(max(peak - steps // 2, 0), count - steps)
    return slice(start, start + steps)


@styled()
def peak_figure(tree: DataTree) -> Figure:
    """Contact force of all laws around the largest force of the main law."""
    return forces_with_flights(tree, around_peak(tree))


def peak_columns(tree: DataTree) -> Columns:
    """Contact force per law around the largest force, every time step."""
    return columns_of_piece(tree, around_peak(tree))


def _peak_caption(tree: DataTree) -> str:
    main = laws(tree, FORCE)[0]
    force = of_law(tree, FORCE, main, "time")
    peak = int(np.nanargmax(force))
    where = f"{engineering(force[peak], 'N')} at {values(tree, 'rolling/time')[peak]:.4f} s"
    if present(tree, "rolling/position"):
        where += f", {values(tree, 'rolling/position')[peak]:.3f} m along the rail"
    part = around_peak(tree)
    words = f"{bars_words(tree, part)}{cut_off(tree, part)}"
    return f"Around the largest force of the main law, {main}: {where}. Every time step.{words}"


@styled()
def psd_figure(tree: DataTree) -> Figure:
    """Power spectral densities of the contact force on a linear frequency axis, with the track's marks."""
    names = laws(tree, PSD)
    figure = new_figure(4.6)
    axes = figure.subplots()
    high = values(tree, "spectra/band" if present(tree, "spectra/band") else "spectra/frequency")[-1]
    drawn = {law: _thinned(tree, of_law(tree, PSD, law, "frequency"), high) for law in names}
    for law, (frequency, level) in drawn.items():
        axes.plot(frequency, level, label=law, **law_style(law, names[0]) | _thin(law, names[0]))
    if present(tree, REFERENCE_PSD):
        axes.plot(*_thinned(tree, values(tree, REFERENCE_PSD), high), **REFERENCE_STYLE)
    axes.set_xlim(0, high)
    level_limits(axes, [level for _, level in drawn.values()])
    shade_bands(axes, tree)
    _finish(axes, tree)
    return figure


def _lines_per_point(frequency: NDArray[np.float64]) -> int:
    return max(1, int(WIDEST / (frequency[1] - frequency[0]) + 1e-9)) if len(frequency) > 1 else 1


def _thinned(tree: DataTree, psd: NDArray[np.float64], high: float) -> Spectrum:
    """Level up to `high` Hz in dB, as the mean power of neighbouring lines."""
    frequency = values(tree, "spectra/frequency")
    kept = np.flatnonzero((frequency > 0) & (frequency <= high))
    count = _lines_per_point(frequency)
    kept = kept[: len(kept) // count * count] if len(kept) >= count else kept[:0]
    means = [field[kept].reshape(-1, count).mean(axis=1) for field in (frequency, psd)]
    return means[0], decibels(means[1])


def _thin(law: str, main: str) -> dict[str, float]:
    return {"linewidth": 1.5 if law == main else 0.9}  # hundreds of lines side by side


def _finish(axes: Axes, tree: DataTree) -> None:
    axes.xaxis.set_major_locator(MultipleLocator(500))
    axes.set_xlabel("frequency / Hz")
    axes.set_ylabel("contact force PSD / dB re 1 N²/Hz")
    draw_sleeper_tones(axes, tree)
    draw_split(axes, tree)
    legend_above(axes)


def psd_columns(tree: DataTree) -> Columns:
    """Power spectral density of the contact force per law and by the frequency domain, all lines."""
    columns: Columns = {"frequency [Hz]": values(tree, "spectra/frequency")}
    for law in laws(tree, PSD):
        columns[f"{law} [N^2/Hz]"] = of_law(tree, PSD, law, "frequency")
    if present(tree, REFERENCE_PSD):
        columns["linear, frequency domain [N^2/Hz]"] = values(tree, REFERENCE_PSD)
    return columns


def _psd_caption(tree: DataTree) -> str:
    count = _lines_per_point(values(tree, "spectra/frequency"))
    drawn = f"drawn as mean power of {count} lines" if count > 1 else "every line"
    text = [f"One-sided PSD, {drawn}; thick: the main law, {laws(tree, PSD)[0]}."]
    if present(tree, REFERENCE_PSD):
        text.append(
            "Dashed: the linear contact in the frequency domain, F = −h/(α_W + α_C + α_R), at rest, with "
            "constant loss factors."
        )
    tone = number(tree, "spectra", "sleeper_passing_frequency")
    if tone:
        text.append(f"Ticks along the bottom: sleeper passing, n v/L, every {tone:.1f} Hz.")
    split = pinned_pinned_split(tree)
    if split:
        text.append(
            f"Dotted: the pinned–pinned frequency as the moving wheel meets it, {split[0]:.0f} and "
            f"{split[1]:.0f} Hz."
        )
    turns = number(tree, "spectra", "wheel_revolution_frequency")
    if turns:
        text.append(f"The wheel turns at {turns:.1f} Hz.")
    return " ".join(text) + shaded_words(tree)


FORCE_PEAK = Part(
    "force_peak",
    "Contact force around its largest value",
    (FORCE, "rolling/time"),
    peak_figure,
    peak_columns,
    _peak_caption,
)
FORCE_PSD = Part(
    "force_psd",
    "Contact force against frequency",
    (PSD, "spectra/frequency"),
    psd_figure,
    psd_columns,
    _psd_caption,
)
