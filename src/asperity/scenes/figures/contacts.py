"""Figures of the forces of all contacts: one beside the other, and their sum."""

from __future__ import annotations

from typing import Any

import numpy as np
from xarray import DataTree

from asperity.reporting.axes import band_axis, levels_axis
from asperity.reporting.chart import INK, MUTED, Chart, Line, Panel, Rules, sequence_styles
from asperity.reporting.data import engineering, laws, of_law, present, values
from asperity.reporting.force_figures import (
    DRAWN,
    frequency_range,
    narrow_level,
    product_series,
    shaded_bands,
    shaded_words,
    spectrum_panel,
)
from asperity.reporting.part import Data, Part, Series, series
from asperity.reporting.tables import Cell, ReportTable, text_cell
from asperity.scenes.schema import PASSING_FREQUENCY, SUM_PSD
from asperity.schema.rolling import CONTACT, CONTACT_LOSS_SHARE, OFFSET, STATIC_LOAD
from asperity.schema.spectra import (
    BAND,
    BAND_TIME_PRODUCT,
    CONTACT_FORCE_LEVEL,
    CONTACT_FORCE_PSD,
    FREQUENCY,
)
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
    main = laws(tree, CONTACT_FORCE_LEVEL)[0]
    level = of_law(tree, CONTACT_FORCE_LEVEL, main, "contact", "band")
    lines = product_series(tree, BAND_TIME_PRODUCT)
    for contact in range(len(level)):
        lines[contact] = Series(_name(tree, contact), CONTACT_FORCE_LEVEL.units, level[contact])
    mean = energy_sum(np.nan_to_num(level, nan=-np.inf), axis=0) - 10.0 * np.log10(len(level))
    lines[MEAN] = Series(MEAN, CONTACT_FORCE_LEVEL.units, mean)
    return Data(series(tree, BAND, "band centre"), lines)


def contact_levels_chart(tree: DataTree, data: Data) -> Chart:
    """One-third-octave levels of the force of each contact."""
    shown = [data.lines[contact] for contact in _shown(tree)]
    levels = [
        Line(data.at, line.values, line.name, marker="o", **look)
        for line, look in zip(shown, sequence_styles(len(shown)), strict=True)
    ]
    levels.append(Line(data.at, data.lines[MEAN].values, f"{MEAN} of all", INK, width=2.0))
    axis = levels_axis("contact force level / dB re 1 N", [line.y for line in levels], span=100.0)
    return Chart((Panel(band_axis(data.at), axis, (*shaded_bands(tree), *levels), height=4.2),))


def _levels_caption(tree: DataTree) -> str:
    main, count = laws(tree, CONTACT_FORCE_LEVEL)[0], len(values(tree, CONTACT))
    some = "" if count <= MOST_LINES else f" {MOST_LINES} of {count} contacts are drawn; the file has all."
    what = f"Force of each contact by the main law, {main}, per one-third octave."
    return f"{what}{some}{shaded_words(tree)}"


def sum_data(tree: DataTree) -> Data:
    """Spectra of the sum of all contact forces, of contacts that would be strangers, and of the first."""
    main = laws(tree, SUM_PSD)[0]
    each = of_law(tree, CONTACT_FORCE_PSD, main, "contact", "frequency")
    lines: dict[Any, Series] = {
        "sum": Series("sum of all contact forces", SUM_PSD.units, of_law(tree, SUM_PSD, main, "frequency")),
        "apart": Series("sum of their powers", SUM_PSD.units, each.sum(axis=0)),
    }
    return Data(series(tree, FREQUENCY), lines)


def sum_chart(tree: DataTree, data: Data) -> Chart:
    """The sum of all contact forces against the sum of their powers."""
    looks: dict[str, dict[str, Any]] = {"apart": {"colour": MUTED, "dashes": (4, 2)}, "sum": {}}
    levels = [
        Line(*narrow_level(tree, data.lines[name].values, 1.0), data.lines[name].name, **look)
        for name, look in looks.items()
    ]
    return Chart((spectrum_panel(tree, levels, "force PSD / dB re 1 N²/Hz", tone_rules(tree)),))


def tone_rules(tree: DataTree) -> list[Rules]:
    """Multiples of the frequency at which contacts pass a place, while they stand apart."""
    if not present(tree, PASSING_FREQUENCY):
        return []
    low, high = frequency_range(tree)
    tones = values(tree, PASSING_FREQUENCY)
    return [Rules(tones[(tones > low) & (tones < high)][:10], dashes=(1, 2), width=0.6)]


def tones_words(tree: DataTree) -> str:
    """Say what dotted lines are; a blank comes first."""
    if not present(tree, PASSING_FREQUENCY):
        return ""
    first = float(values(tree, PASSING_FREQUENCY)[0])
    return f" Dotted: k v/L, multiples of the {first:.4g} Hz at which contacts pass a place; ten are drawn."


def _sum_caption(tree: DataTree) -> str:
    return (
        f"Where the sum of all forces lies below the sum of their powers, contacts cancel; above it, they "
        f"act together. Main law, {laws(tree, SUM_PSD)[0]}; {DRAWN}.{tones_words(tree)}{shaded_words(tree)}"
    )


def contacts_table(tree: DataTree) -> ReportTable | None:
    """Where the contacts are, what they carry, and how long they are lost."""
    if not present(tree, OFFSET, STATIC_LOAD, CONTACT_LOSS_SHARE):
        return None
    main = laws(tree, CONTACT_LOSS_SHARE)[0]
    lost = of_law(tree, CONTACT_LOSS_SHARE, main, "contact")
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
        (CONTACT_FORCE_LEVEL, BAND, CONTACT, OFFSET),
        contact_levels_data,
        contact_levels_chart,
        _levels_caption,
    ),
    Part(
        "force_sum",
        "Contacts together",
        (SUM_PSD, CONTACT_FORCE_PSD, FREQUENCY, CONTACT),
        sum_data,
        sum_chart,
        _sum_caption,
        worth=lambda tree: len(values(tree, CONTACT)) > 1,
    ),
)
