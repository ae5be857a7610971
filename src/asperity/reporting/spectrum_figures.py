"""Figures over frequency: contact force in narrow bands and in one-third octaves."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray
from xarray import DataTree

from asperity.reporting.axes import band_axis, doubtful_boxes, frequency_axis, levels_axis
from asperity.reporting.chart import Boxes, Chart, Line, Mark, Note, Panel, Rules
from asperity.reporting.data import doubtful, laws, present, values
from asperity.reporting.law_entries import differences, law_entry, law_style
from asperity.reporting.part import Data, Part, Series, by_law, series
from asperity.reporting.style import INK, decibels, smooth_on_log_axis
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
    "colour": INK,
    "dashes": (3.0, 3.0),
    "width": 1.0,
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


def shaded_bands(tree: DataTree, labelled: bool = True) -> list[Boxes | Note]:
    """Shades of the frequencies of the bands that say little."""
    if not present(tree, BAND):
        return []
    return doubtful_boxes(values(tree, BAND), doubtful(tree, BAND_TIME_PRODUCT), labelled)


def shaded_words(tree: DataTree) -> str:
    """Say what is shaded in a spectrum, where something is; a blank comes first."""
    return doubtful_words(tree, BAND_TIME_PRODUCT) if present(tree, BAND) else ""


def force_spectrum_data(tree: DataTree) -> Data:
    """Power spectral density of the contact force of each law, all lines."""
    return Data(series(tree, FREQUENCY), by_law(tree, FORCE_PSD))


def force_spectrum_chart(tree: DataTree, data: Data) -> Chart:
    """Power spectral densities of the contact force of all laws on one axis."""
    return Chart((laws_panel(tree, data.lines, "contact force PSD / dB re 1 N²/Hz"),))


def laws_panel(tree: DataTree, lines: Mapping[Any, Series], label: str, reference: float = 1.0) -> Panel:
    """Level of each law's PSD over frequency, the main law first."""
    main = next(iter(lines))
    spectra = {law: narrow_level(tree, psd.values, reference) for law, psd in lines.items()}
    drawn = [Line(*spectra[law], label=law, **law_style(tree, law, main)) for law in main_last(spectra)]
    return spectrum_panel(tree, drawn, label)


def spectrum_panel(tree: DataTree, levels: Sequence[Line], label: str, behind: Sequence[Mark] = ()) -> Panel:
    """Levels over frequency, and other marks behind them."""
    axis = levels_axis(label, [line.y for line in levels])
    marks = (*shaded_bands(tree), *behind, *levels)
    return Panel(frequency_axis(*frequency_range(tree)), axis, marks, height=4.4)


def main_last(laws: Iterable[str]) -> list[str]:
    """Laws in the order in which they are drawn: the main law, the first, on top."""
    main, *others = laws
    return [*others, main]


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


def band_chart(tree: DataTree, data: Data, *reference: Entry) -> Chart:
    """One-third-octave levels of the contact force, and below them the differences to the linear laws."""
    levels = data.of(FORCE_LEVEL)
    held = [data.lines[entry].values for entry in reference if entry in data.lines]
    marks = [*_band_lines(tree, data, levels), *(Line(data.at, each, **REFERENCE_STYLE) for each in held)]
    axis = levels_axis("contact force level / dB re 1 N", list(levels.values()), span=100.0)
    panels = [Panel(band_axis(data.at), axis, (*shaded_bands(tree), *marks), height=3.6)]
    for entry, name in differences(tree).items():
        found = data.of(entry)
        axis = levels_axis(f"level − {name} / dB", list(found.values()), span=np.inf, step=5.0)
        under: list[Mark] = [*shaded_bands(tree, labelled=False), Rules(np.zeros(1), "y", dashes=())]
        lines = _band_lines(tree, data, found)
        panels.append(Panel(band_axis(data.at), axis, (*under, *lines), height=2.4))
    return Chart(tuple(panels))


def _band_lines(tree: DataTree, data: Data, levels: Mapping[str, NDArray[np.float64]]) -> list[Line]:
    main = next(iter(data.of(FORCE_LEVEL)))
    ordered = sorted(levels, key=lambda law: law == main)
    return [
        Line(
            data.at, levels[law], label=law, marker=law_entry(tree, law).marker, **law_style(tree, law, main)
        )
        for law in ordered
    ]


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
        "Contact force levels in one-third octaves",
        (FORCE_LEVEL, BAND),
        lambda tree: band_data(tree, *reference),
        lambda tree, data: band_chart(tree, data, *reference),
        lambda tree: band_caption(tree, *reference),
    )


FORCE_SPECTRUM = Part(
    "force_psd",
    "Contact force against frequency",
    (FORCE_PSD, FREQUENCY),
    force_spectrum_data,
    force_spectrum_chart,
    _force_caption,
)
FORCE_BANDS = force_bands()
