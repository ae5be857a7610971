"""Figures of the forces of all contacts: one beside the other, and their sum."""

from __future__ import annotations

from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from xarray import DataTree

from asperity.kinds.bodies.schema import (
    CONTACT,
    FORCE_LEVELS,
    FORCE_PSDS,
    LOSS_SHARES,
    OFFSET,
    PASSING_FREQUENCY,
    STATIC_LOAD,
    SUM_PSD,
)
from asperity.reporting.data import engineering, laws, of_law, present, values
from asperity.reporting.part import Data, Part, Series, series
from asperity.reporting.spectrum_figures import (
    DRAWN,
    finish_spectrum,
    frequency_range,
    narrow_level,
    product_series,
    shade_bands,
    shaded_words,
)
from asperity.reporting.style import (
    INK,
    MUTED,
    band_axis,
    legend_above,
    level_limits,
    new_figure,
    sequence,
    styled,
)
from asperity.reporting.tables import Cell, ReportTable, text_cell
from asperity.schema.spectra import BAND, BAND_TIME_PRODUCT, FREQUENCY
from asperity.spectra import energy_sum

MOST_LINES = 6
"""Contacts that are drawn one by one."""
MEAN = "energy mean"


def _shown(tree: DataTree) -> list[int]:
    """Contacts that are drawn one by one: all, or some from the first to the last."""
    count = len(values(tree, CONTACT))
    return sorted({round(x) for x in np.linspace(0, count - 1, min(count, MOST_LINES))})


def _name(tree: DataTree, contact: int) -> str:
    return f"contact {contact + 1}, {values(tree, OFFSET)[contact]:.4g} m"


def contact_levels_data(tree: DataTree) -> Data:
    """Level of the force of each contact by the main law, and their energy mean."""
    main = laws(tree, FORCE_LEVELS)[0]
    level = of_law(tree, FORCE_LEVELS, main, "contact", "band")
    lines = product_series(tree, BAND_TIME_PRODUCT)
    for contact in range(len(level)):
        lines[contact] = Series(_name(tree, contact), FORCE_LEVELS.units, level[contact])
    mean = energy_sum(np.nan_to_num(level, nan=-np.inf), axis=0) - 10.0 * np.log10(len(level))
    lines[MEAN] = Series(MEAN, FORCE_LEVELS.units, mean)
    return Data(series(tree, BAND, "band centre"), lines)


@styled()
def contact_levels_figure(tree: DataTree, data: Data) -> Figure:
    """One-third-octave levels of the force of each contact."""
    figure = new_figure(4.2)
    axes = figure.subplots()
    shown = _shown(tree)
    for contact, colour in zip(shown, sequence(len(shown)), strict=True):
        line = data.lines[contact]
        axes.plot(data.at, line.values, color=colour, marker="o", markeredgewidth=0, label=line.name)
    axes.plot(data.at, data.lines[MEAN].values, color=INK, linewidth=2.0, label=f"{MEAN} of all")
    level_limits(axes, [data.lines[MEAN].values, *(data.lines[i].values for i in shown)], 100.0, 10.0)
    band_axis(axes, data.at)
    shade_bands(axes, tree)
    legend_above(axes)
    axes.set_ylabel("contact force level / dB re 1 N")
    return figure


def _levels_caption(tree: DataTree) -> str:
    main, count = laws(tree, FORCE_LEVELS)[0], len(values(tree, CONTACT))
    some = "" if count <= MOST_LINES else f" {MOST_LINES} of {count} contacts are drawn; the file has all."
    what = f"Force of each contact by the main law, {main}, per one-third octave."
    return f"{what}{some}{shaded_words(tree)}"


def sum_data(tree: DataTree) -> Data:
    """Spectra of the sum of all contact forces, of contacts that would be strangers, and of the first."""
    main = laws(tree, SUM_PSD)[0]
    each = of_law(tree, FORCE_PSDS, main, "contact", "frequency")
    lines: dict[Any, Series] = {
        "sum": Series("sum of all contact forces", SUM_PSD.units, of_law(tree, SUM_PSD, main, "frequency")),
        "apart": Series("sum of their powers", SUM_PSD.units, each.sum(axis=0)),
    }
    return Data(series(tree, FREQUENCY), lines)


@styled()
def sum_figure(tree: DataTree, data: Data) -> Figure:
    """The sum of all contact forces against the sum of their powers."""
    figure = new_figure(4.2)
    axes = figure.subplots()
    spectra = []
    for name, look in (("apart", {"color": MUTED, "linestyle": (0, (4, 2))}), ("sum", {"color": INK})):
        line = data.lines[name]
        spectra.append(narrow_level(tree, line.values, 1.0))
        axes.plot(*spectra[-1], label=line.name, **look)
    finish_spectrum(axes, tree, spectra)
    mark_tones(axes, tree)
    axes.set_ylabel("force PSD / dB re 1 N²/Hz")
    return figure


def mark_tones(axes: Axes, tree: DataTree) -> None:
    """Mark the multiples of the frequency at which contacts pass a place, while they stand apart."""
    if not present(tree, PASSING_FREQUENCY):
        return
    low, high = frequency_range(tree)
    tones = values(tree, PASSING_FREQUENCY)
    for tone in tones[(tones > low) & (tones < high)][:10]:
        axes.axvline(tone, color=MUTED, linewidth=0.6, linestyle=(0, (1, 2)))


def tones_words(tree: DataTree) -> str:
    """Say what dotted lines are; a blank comes first."""
    if not present(tree, PASSING_FREQUENCY):
        return ""
    first = float(values(tree, PASSING_FREQUENCY)[0])
    return f" Dotted: k v/L, multiples of the {first:.4g} Hz at which contacts pass a place, up to the tenth."


def _sum_caption(tree: DataTree) -> str:
    return (
        f"Where the sum of all forces lies below the sum of their powers, contacts cancel; above it, they "
        f"act together. Main law, {laws(tree, SUM_PSD)[0]}; {DRAWN}.{tones_words(tree)}{shaded_words(tree)}"
    )


def contacts_table(tree: DataTree) -> ReportTable | None:
    """Where the contacts are, what they carry, and how long they are lost."""
    if not present(tree, OFFSET, STATIC_LOAD, LOSS_SHARES):
        return None
    main = laws(tree, LOSS_SHARES)[0]
    lost = of_law(tree, LOSS_SHARES, main, "contact")
    rows = [
        [
            text_cell(f"{number}"),
            Cell(engineering(offset, "m", 4), "number"),
            Cell(engineering(load, "N"), "number"),
            Cell(f"{100.0 * share:.3g} %", "number"),
        ]
        for number, (offset, load, share) in enumerate(
            zip(values(tree, OFFSET), values(tree, STATIC_LOAD), lost, strict=True), start=1
        )
    ]
    head = ["contact", "ahead of the position of the run", "static force", f"out of contact, {main}"]
    return ReportTable("where_contacts_are", "Contacts", head, rows, "Static forces as on a rigid plane.")


CONTACTS = (
    Part(
        "contact_levels",
        "Force of each contact",
        (FORCE_LEVELS, BAND, CONTACT, OFFSET),
        contact_levels_data,
        contact_levels_figure,
        _levels_caption,
    ),
    Part(
        "force_sum",
        "Contacts together",
        (SUM_PSD, FORCE_PSDS, FREQUENCY, CONTACT),
        sum_data,
        sum_figure,
        _sum_caption,
        worth=lambda tree: len(values(tree, CONTACT)) > 1,
    ),
)
