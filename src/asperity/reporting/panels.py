"""Axes and panels of the field: spectra, one-third octaves, time; with what says little shaded."""

from collections.abc import Callable, Collection, Iterable, Sequence
from dataclasses import replace
from typing import Any

import numpy as np
from xarray import DataTree

from asperity.arguments import Array, Flags
from asperity.reporting import chart, data, figure
from asperity.reporting.chart import Axis, Line, Mark, Panel
from asperity.schema import Entry, rolling, spectra
from asperity.spectra import LEAST_PRODUCT, MOST_START

EDGE = 10**0.05
"""From the centre of a one-third octave to its upper edge."""


def frequency_axis(low: float, high: float, label: str = "frequency / Hz") -> Axis:
    """Logarithmic frequency axis with grid lines at the one-third octaves, named at the octaves."""
    centres = (1000 * 10 ** (np.arange(-30, 21) / 10)).tolist()
    ticks = tuple((f, data.nominal_band(f)) for f in centres[::3])  # … 31.5, 63, 125, …, 1k, 2k, 4k
    minor = tuple(f for n, f in enumerate(centres) if n % 3)
    return Axis(label, float(low), float(high), log=True, ticks=ticks, minor=minor, linked=chart.FREQUENCY)


def band_axis(bands: Array, label: str = "", name: Callable[[float], str] = data.nominal_band) -> Axis:
    """Logarithmic axis with every one-third octave named, of frequencies unless it has another label."""
    ticks = tuple((band, name(band)) for band in bands.tolist())
    low = float(bands[0] / EDGE)
    high = float(bands[-1] * EDGE)
    linked = "" if label else chart.FREQUENCY
    return Axis(label or "one-third octave band / Hz", low, high, log=True, ticks=ticks, linked=linked)


def wavenumber_axis(low: float, high: float) -> Axis:
    """Logarithmic axis of wavenumber in 1/m (cycles per metre), with the wavelength opposite."""
    second = chart.Second("wavelength", inverse=True, unit="m")
    label = "wavenumber / (1/m)"
    return Axis(label, float(low), float(high), log=True, second=second, linked="wavenumber")


def long_waves_left(axis: Axis, label: str, speed: float | None, linked: str = "") -> Axis:
    """Turn an axis of wavelength round, the frequency at a speed, m/s, opposite where it is known."""
    second = chart.Second(label, speed, inverse=True, unit="Hz") if speed else None
    return replace(axis, low=axis.high, high=axis.low, second=second, linked=linked)


def log_axis(label: str, found: Sequence[Array], lowest: float = 0.0) -> Axis:
    """Logarithmic axis that holds all positive values, at least `lowest`, between two of 1, 2, 5, 10, …"""
    positive = np.concatenate([each[each > 0] for each in found])
    if positive.size == 0:
        return Axis(label, 1.0, 10.0, log=True)
    low = max(positive.min(), min(lowest, positive.max()))
    high = positive.max()
    steps = np.outer(10.0 ** np.arange(np.floor(np.log10(low)), np.log10(high) + 1), [1, 2, 5, 10]).ravel()
    return Axis(label, float(steps[steps <= low].max()), float(steps[steps >= high].min()), log=True)


def words_axis(words: Sequence[str], label: str = "", *, margin: float = 0.5, down: bool = False) -> Axis:
    """Axis with a place, 0, 1, 2, …, for each word, the first at the bottom, or at the top."""
    ticks = tuple((float(n), word) for n, word in enumerate(words))
    low = -margin
    high = len(words) - 1 + margin
    return Axis(label, *((high, low) if down else (low, high)), ticks=ticks)


def levels_axis(label: str, levels: Iterable[Array], span: float = 80.0, step: float = 10.0) -> Axis:
    """Axis in dB that holds all the peaks, and at most `span` dB below the highest."""
    finite = np.concatenate([np.zeros(0), *(np.ravel(each)[np.isfinite(np.ravel(each))] for each in levels)])
    if finite.size == 0:
        return Axis(label, 0.0, step)
    top = step * np.ceil((finite.max() + 0.1 * step) / step)
    return Axis(label, float(max(step * np.floor(finite.min() / step), top - span)), float(top))


def stretches(flags: Flags) -> np.ndarray:
    """First and last index of each run of places (n,) that are flagged, (m, 2)."""
    edges = np.flatnonzero(np.diff(flags.astype(np.int8), prepend=0, append=0))
    return edges.reshape(-1, 2) - np.array([0, 1])


def shade(left: Array, right: Array, colour: str = chart.GRID, **look: Any) -> chart.Boxes:
    """Stretches of an axis, shaded from bottom to top."""
    whole = np.full(left.shape, np.inf)
    return chart.Boxes(left, right, -whole, whole, colour=colour, **look)


def zero(colour: str = chart.MUTED, width: float = 0.9) -> chart.Rules:
    """A full line at zero."""
    return chart.Rules(np.zeros(1), "y", colour=colour, dashes=(), width=width)


# --- bands that say little


def doubtful_boxes(bands: Array, doubtful: Flags, labelled: bool = True) -> list[Mark]:
    """Shades of the bands (by their centres) whose levels say little, and their name."""
    if not doubtful.any():
        return []
    first, last = np.sort(bands[stretches(doubtful)], axis=1).T  # wavelengths may fall
    note = chart.Note("says little", 0.005, 0.03, x_share=True, y_share=True)  # low bands are left
    return [shade(first / EDGE, last * EDGE, opacity=0.6), *([note] if labelled else [])]


def shaded_bands(tree: DataTree, labelled: bool = True) -> list[Mark]:
    """Shades of the frequencies of the bands that say little."""
    if not data.present(tree, spectra.BAND):
        return []
    doubtful = data.doubtful(tree, spectra.BAND_TIME_PRODUCT)
    return doubtful_boxes(data.values(tree, spectra.BAND), doubtful, labelled)


def shaded_words(tree: DataTree, product: Entry = spectra.BAND_TIME_PRODUCT) -> str:
    """Say what shaded bands are, where there are any."""
    of_force = product is spectra.BAND_TIME_PRODUCT
    if (of_force and not data.present(tree, spectra.BAND)) or not data.doubtful(tree, product).any():
        return ""
    start = ""
    low = -10.0 * np.log10(1.0 - MOST_START)
    if of_force and data.present(tree, spectra.START_SHARE):
        start = f", or resonances have not built up yet, and it is low by more than {low:.0f} dB"
    return (
        f"Shaded: levels that say little. Bandwidth times averaging time B T is below {LEAST_PRODUCT:g}, "
        f"and the standard deviation of a level above {4.34 / np.sqrt(LEAST_PRODUCT):.1f} dB{start}."
    )


def products(product: Entry) -> Callable[[DataTree], Iterable[figure.Series]]:
    """Columns: bandwidth times averaging time of bands, and whether their levels say something."""

    def columns(tree: DataTree) -> Iterable[figure.Series]:
        if data.present(tree, product):
            enough = (~data.doubtful(tree, product)).astype(float)
            yield figure.Series("B T", product.units, data.values(tree, product), product)
            yield figure.Series("level says something", "1", enough)

    return columns


# --- lines of laws, and of what else is told apart


def styled(
    tree: DataTree,
    x: Array,
    lines: Iterable[figure.Series],
    *,
    size: float = 1.0,
    markers: bool = False,
    main: str = "",
    **look: Any,
) -> list[Line]:
    """Lines in looks of their own; or in those of laws, the `main` one, else the first, thick and on top.

    What has neither looks like a sequence. Over x and in a unit of `size`, with the markers of laws if asked
    for; `look` overrides looks of lines.
    """
    shown = list(lines)
    main = main or next((line.law for line in shown), "")
    shown.sort(key=lambda line: (not line.law, line.law == main))
    drawn = []
    for line, usual in zip(shown, chart.sequence_styles(len(shown)), strict=True):
        own = dict(zip(("colour", "dashes", "width", "marker"), line.look, strict=False)) or usual
        if line.law:
            own = data.law_style(tree, line.law, main)
            own |= {"marker": data.law_entry(tree, line.law).marker} if markers else {}
        drawn.append(Line(x, line.values / size, line.label, **(own | look)))
    return drawn


def frequency_range(tree: DataTree) -> tuple[float, float]:
    """Frequencies that are drawn, in Hz: those of the one-third octaves, else all from 20 Hz on."""
    if data.present(tree, spectra.BAND):
        bands = data.values(tree, spectra.BAND)
        return bands[0] / EDGE, bands[-1] * EDGE
    high = data.values(tree, spectra.FREQUENCY)[-1]
    return min(20.0, high / 100), high


DRAWN = "drawn as mean power per 1/24 octave where the lines are denser than that"


def narrow_levels(
    tree: DataTree, lines: figure.Lines, shown: Iterable[figure.Series], reference: float = 1.0
) -> tuple[Array, list[figure.Series]]:
    """Levels of PSDs in dB within the drawn range, no denser than a line can show."""
    low, high = frequency_range(tree)
    kept = (lines.at >= low) & (lines.at <= high) & (lines.at > 0)
    if not kept.any():
        return np.array([low, high]), [replace(s, values=np.full(2, np.nan)) for s in shown]
    at = lines.at[kept]
    found = list(shown)
    levels = [chart.decibels(chart.smooth_on_log_axis(at, s.values[kept])[1], reference) for s in found]
    smooth = chart.smooth_on_log_axis(at, at)[0]
    return smooth, [replace(s, values=level) for s, level in zip(found, levels, strict=True)]


def spectrum_panel(tree: DataTree, label: str, levels: Sequence[Line], behind: Sequence[Mark]) -> Panel:
    """Levels over frequency, and other marks behind them."""
    axis = levels_axis(label, [line.y for line in levels])
    marks = (*shaded_bands(tree), *behind, *levels)
    return Panel(frequency_axis(*frequency_range(tree)), axis, marks, height=4.4)


def level_spectrum(
    tree: DataTree,
    lines: figure.Lines,
    label: str,
    reference: float = 1.0,
    behind: Sequence[Mark] = (),
    shown: slice = slice(None),
) -> Panel:
    """Levels of the PSDs of a figure, all or those `shown`, over frequency, other marks behind."""
    levels = styled(tree, *narrow_levels(tree, lines, lines.lines[shown], reference))
    return spectrum_panel(tree, label, levels, behind)


def band_panel(
    tree: DataTree,
    lines: figure.Lines,
    label: str,
    levels: Sequence[Line],
    *,
    of: Sequence[Line] = (),
    span: float = 60.0,
    height: float = 4.4,
) -> Panel:
    """Levels over one-third octaves, and an axis that suits them, or those alone that it is the axis `of`."""
    axis = levels_axis(label, [line.y for line in of or levels], span=span)
    shades = doubtful_boxes(lines.at, data.doubtful(tree, spectra.BAND_TIME_PRODUCT))
    return Panel(band_axis(lines.at), axis, (*shades, *levels), height=height)


# --- over time

HEADROOM = 0.5
"""Share of the main law's range by which other laws may widen its axis."""


def time_axis(tree: DataTree, time: Array) -> tuple[Axis, float]:
    """Axis from end to end of a piece of the run, and the size of its unit, that of the whole run."""
    unit, symbol = data.time_unit(float(np.ptp(data.values(tree, rolling.TIME))))
    axis = Axis(f"time / {symbol}", float(time[0]) / unit, float(time[-1]) / unit, linked=chart.TIME)
    return axis, unit


def main_limits(lines: Sequence[figure.Series], pulling: Collection[str]) -> tuple[float, float]:
    """Limits of an axis that suit the main law, the first of `lines`.

    Its range, wider by at most `HEADROOM` of it on either side where zero, or another law that can lose
    contact, needs it. A law that pulls, and swings as if nothing could be lost, widens nothing.
    """
    widening = [line.values for n, line in enumerate(lines) if not n or line.law not in pulling]
    ends = [(float(np.nanmin(force)), float(np.nanmax(force))) for force in widening]
    low, high = ends[0]
    room = HEADROOM * (high - low)
    bottom = min(max(low - room, least) for least, _ in ends)
    top = max(min(high + room, most) for _, most in ends)
    if low - room <= 0.0 <= high + room:
        bottom = min(bottom, 0.0)
        top = max(top, 0.0)
    margin = 0.04 * (top - bottom) or 1e-12
    return bottom - margin, top + margin
