"""Figures over frequency: contact force in narrow bands and in one-third octaves."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import NDArray
from xarray import DataTree

from asperity.reporting.data import doubtful, laws, present, values
from asperity.reporting.law_entries import differences, law_entry, law_style
from asperity.reporting.part import Data, Part, Series, by_law, series
from asperity.reporting.style import (
    INK,
    MUTED,
    band_axis,
    decibels,
    frequency_axis,
    legend_above,
    level_limits,
    new_figure,
    shade_doubtful,
    smooth_on_log_axis,
    styled,
)
from asperity.schema import Entry
from asperity.schema.spectra import (
    BAND,
    BAND_TIME_PRODUCT,
    FORCE_LEVEL,
    FORCE_LEVEL_DIFFERENCE_TO_REFERENCE,
    FORCE_PSD,
    FREQUENCY,
    START_SHARE,
)
from asperity.spectra import LEAST_PRODUCT, MOST_START

IN_FREQUENCY = "linear, frequency domain"
"""Name of the linear contact that is solved there."""
REFERENCE_STYLE: dict[str, Any] = {
    "color": INK,
    "linestyle": (0, (3, 3)),
    "linewidth": 1.0,
    "zorder": 5,
    "label": IN_FREQUENCY,
}

Spectrum = tuple[NDArray[np.float64], NDArray[np.float64]]


def frequency_range(tree: DataTree) -> tuple[float, float]:
    """Frequencies that are drawn, in Hz: those of the one-third octaves, else all from 20 Hz on."""
    if present(tree, BAND):
        bands = values(tree, BAND)
        return bands[0] / 10**0.05, bands[-1] * 10**0.05
    high = values(tree, FREQUENCY)[-1]
    return min(20.0, high / 100), high


def narrow_level(tree: DataTree, psd: NDArray[np.float64], reference: float) -> Spectrum:
    """Level of a PSD in dB within the drawn range, no denser than a line can show."""
    frequency = values(tree, FREQUENCY)
    low, high = frequency_range(tree)
    kept = (frequency >= low) & (frequency <= high) & (frequency > 0)
    if not kept.any():
        return np.array([low, high]), np.full(2, np.nan)
    smooth, power = smooth_on_log_axis(frequency[kept], psd[kept], 24)
    return smooth, decibels(power, reference)


def shade_bands(axes: Axes, tree: DataTree, labelled: bool = True) -> None:
    """Shade the frequencies of the bands that say little."""
    if present(tree, BAND):
        shade_doubtful(axes, values(tree, BAND), doubtful(tree, BAND_TIME_PRODUCT), labelled)


def shaded_words(tree: DataTree) -> str:
    """Say what is shaded in a spectrum, where something is; a blank comes first."""
    return doubtful_words(tree, BAND_TIME_PRODUCT) if present(tree, BAND) else ""


def force_spectrum_data(tree: DataTree) -> Data:
    """Power spectral density of the contact force of each law, all lines."""
    return Data(series(tree, FREQUENCY), by_law(tree, FORCE_PSD))


@styled()
def force_spectrum_figure(tree: DataTree, data: Data) -> Figure:
    """Power spectral densities of the contact force of all laws on one axis."""
    figure = new_figure(4.4)
    axes = figure.subplots()
    draw_laws(axes, tree, data.lines, 1.0)
    axes.set_ylabel("contact force PSD / dB re 1 N²/Hz")
    return figure


def draw_laws(axes: Axes, tree: DataTree, lines: Mapping[Any, Series], reference: float) -> None:
    """Draw the level of each law's PSD, the main law first, over frequency."""
    main = next(iter(lines))
    spectra = {law: narrow_level(tree, psd.values, reference) for law, psd in lines.items()}
    for law, spectrum in spectra.items():
        axes.plot(*spectrum, label=law, **law_style(tree, law, main))
    finish_spectrum(axes, tree, list(spectra.values()))


def finish_spectrum(axes: Axes, tree: DataTree, spectra: Sequence[Spectrum]) -> None:
    """Axes of levels over frequency, what says little, and a legend."""
    frequency_axis(axes, *frequency_range(tree))
    shade_bands(axes, tree)
    level_limits(axes, [level for _, level in spectra])
    legend_above(axes)


def product_series(tree: DataTree, product: Entry) -> dict[Any, Series]:
    """Bandwidth times averaging time of bands, and whether their levels say something."""
    if not present(tree, product):
        return {}
    enough = (~doubtful(tree, product)).astype(float)
    return {
        product: series(tree, product, "B T"),
        "enough": Series("level says something", "1", enough),
    }


def band_data(tree: DataTree, *reference: Entry) -> Data:
    """Levels per one-third octave and law, and the differences; and the level of a `reference`."""
    lines = product_series(tree, BAND_TIME_PRODUCT)
    compared = {entry: f"{{}} minus {law}" for entry, law in differences(tree).items()}
    compared[FORCE_LEVEL_DIFFERENCE_TO_REFERENCE] = "{} minus reference"
    for entry, name in {FORCE_LEVEL: "{}", **compared}.items():
        lines |= {(entry, law): line for law, line in by_law(tree, entry, name).items()}
    lines |= {entry: series(tree, entry, IN_FREQUENCY) for entry in reference if present(tree, entry)}
    return Data(series(tree, BAND, "band centre"), lines)


@styled()
def band_figure(tree: DataTree, data: Data, *reference: Entry) -> Figure:
    """One-third-octave levels of the contact force, and below them the differences to the linear laws."""
    compared = differences(tree)
    figure = new_figure(4.0 + 2.4 * len(compared))
    heights = [3.4, *(2.4 for _ in compared)]
    panels = figure.subplots(len(heights), 1, sharex=True, squeeze=False, height_ratios=heights)[:, 0]
    _draw_bands(panels[0], tree, data, FORCE_LEVEL, span=100.0, step=10.0)
    for entry in reference:
        if entry in data.lines:
            panels[0].plot(values(tree, BAND), data.lines[entry].values, **REFERENCE_STYLE)
    panels[0].set_ylabel("contact force level / dB re 1 N")
    legend_above(panels[0])
    for axes, (entry, name) in zip(panels[1:], compared.items(), strict=True):
        _draw_bands(axes, tree, data, entry, span=np.inf, step=5.0)
        axes.axhline(0, color=MUTED, linewidth=0.9)
        axes.set_ylabel(f"level − {name} / dB")
    for axes in panels:
        shade_bands(axes, tree, labelled=axes is panels[0])
        axes.label_outer()
    return figure


def _draw_bands(axes: Axes, tree: DataTree, data: Data, entry: Entry, *, span: float, step: float) -> None:
    levels, main = data.of(entry), next(iter(data.of(FORCE_LEVEL)))
    for law, level in levels.items():
        style = law_style(tree, law, main)
        axes.plot(data.at, level, label=law, marker=law_entry(tree, law).marker, markeredgewidth=0, **style)
    level_limits(axes, list(levels.values()), span, step)
    band_axis(axes, data.at)


DRAWN = "drawn as mean power per 1/24 octave where the lines are denser than that"


def _force_caption(tree: DataTree) -> str:
    main = laws(tree, FORCE_PSD)[0]
    return (
        f"Contact force of all laws, one-sided PSD, {DRAWN}; thick: the main law, {main}. "
        "Ticks stand at the one-third octaves." + shaded_words(tree)
    )


def band_caption(tree: DataTree, *reference: Entry) -> str:
    """Say what the levels are compared with."""
    text = ["Levels per one-third octave (IEC 61260-1, base 10)."]
    if any(present(tree, entry) for entry in reference):
        text.append("Dashed: the linear contact solved in the frequency domain.")
    if compared := list(differences(tree).values()):
        named = " and that of ".join(compared)
        text.append(f"Below: level minus that of {named}; positive where linear contact underestimates.")
    return " ".join(text) + doubtful_words(tree, BAND_TIME_PRODUCT)


def doubtful_words(tree: DataTree, product: Entry) -> str:
    """Say what shaded bands are, where there are any; a blank comes first."""
    if not doubtful(tree, product).any():
        return ""
    scatter = 4.34 / np.sqrt(LEAST_PRODUCT)
    start = ""
    if product is BAND_TIME_PRODUCT and present(tree, START_SHARE):
        low = -10.0 * np.log10(1.0 - MOST_START)
        start = f", or resonances have not built up yet, and it is low by more than {low:.0f} dB"
    return (
        f" Shaded: levels that say little. Bandwidth times averaging time B T is below {LEAST_PRODUCT:g}, "
        f"and the standard deviation of a level above {scatter:.1f} dB{start}."
    )


def force_bands(*reference: Entry) -> Part:
    """Figure of the force in one-third octaves, with the levels of a `reference` where there is one."""
    return Part(
        "force_bands",
        "Contact force in one-third octaves",
        (FORCE_LEVEL, BAND),
        lambda tree: band_data(tree, *reference),
        lambda tree, data: band_figure(tree, data, *reference),
        lambda tree: band_caption(tree, *reference),
    )


FORCE_SPECTRUM = Part(
    "force_psd",
    "Contact force against frequency",
    (FORCE_PSD, FREQUENCY),
    force_spectrum_data,
    force_spectrum_figure,
    _force_caption,
)
FORCE_BANDS = force_bands()
