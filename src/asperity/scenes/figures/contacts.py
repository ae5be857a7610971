"""Figures of the forces of all contacts: one beside the other, and their sum."""

from collections.abc import Iterator

import numpy as np
from xarray import DataTree

from asperity.reporting import data, panels
from asperity.reporting.chart import INK, MUTED, Mark, Panel, Rules
from asperity.reporting.figure import Figure, Lines, Of, Series
from asperity.reporting.tables import ReportTable, number_cells, table, text_cells
from asperity.scenes import schema
from asperity.schema import rolling
from asperity.schema.spectra import BAND, BAND_TIME_PRODUCT, CONTACT_FORCE_LEVEL, CONTACT_FORCE_PSD, FREQUENCY
from asperity.spectra import energy_sum

MOST_LINES = 6
"""Contacts that are drawn one by one."""
MEAN = "energy mean"


def _names(tree: DataTree) -> list[str]:
    offsets = data.values(tree, rolling.OFFSET)
    return [f"contact {number}, {offset:.4g} m" for number, offset in enumerate(offsets, 1)]


_LEVELS = Of(CONTACT_FORCE_LEVEL, "{contact}", called={"contact": _names})


def _mean(tree: DataTree) -> Iterator[Series]:
    """Energy mean of the levels of all contacts."""
    level = np.stack([np.nan_to_num(series.values, nan=-np.inf) for series in _LEVELS(tree)])
    mean = energy_sum(level, axis=0) - 10.0 * np.log10(len(level))
    yield Series(MEAN, CONTACT_FORCE_LEVEL.units, mean, None, f"{MEAN} of all", look=(INK, (), 2.0))


def _levels(tree: DataTree, lines: Lines) -> list[Panel]:
    """One-third-octave levels of the force of each contact, all or some from the first to the last."""
    every = lines.of(CONTACT_FORCE_LEVEL)
    shown = sorted({round(x) for x in np.linspace(0, len(every) - 1, min(len(every), MOST_LINES))})
    levels = panels.styled(tree, lines.at, [every[n] for n in shown], marker="o")
    levels += panels.styled(tree, lines.at, [series for series in lines.lines if series.name == MEAN])
    label = "contact force level / dB re 1 N"
    return [panels.band_panel(tree, lines, label, levels, span=100.0, height=4.2)]


def _levels_caption(tree: DataTree) -> str:
    main, count = data.laws(tree, CONTACT_FORCE_LEVEL)[0], len(data.values(tree, rolling.CONTACT))
    some = "" if count <= MOST_LINES else f" {MOST_LINES} of {count} contacts are drawn; the file has all."
    what = f"Force of each contact by the main law, {main}, per one-third octave."
    return f"{what}{some}{panels.shaded_words(tree)}"


def _powers(tree: DataTree) -> Iterator[Series]:
    """Sum of the powers of all contact forces."""
    every = np.stack([s.values for s in Of(CONTACT_FORCE_PSD, "{contact}")(tree)])
    name = "sum of their powers"
    yield Series(name, schema.SUM_PSD.units, every.sum(axis=0), None, name, look=(MUTED, (4, 2)))


def tone_rules(tree: DataTree) -> list[Mark]:
    """Multiples of the frequency at which contacts pass a place, while they stand apart."""
    if not data.present(tree, schema.PASSING_FREQUENCY):
        return []
    low, high = panels.frequency_range(tree)
    tones = data.values(tree, schema.PASSING_FREQUENCY)
    return [Rules(tones[(tones > low) & (tones < high)][:10], dashes=(1, 2), width=0.6)]


def tones_words(tree: DataTree) -> str:
    """Say what dotted lines are; a blank comes first."""
    if not data.present(tree, schema.PASSING_FREQUENCY):
        return ""
    first = float(data.values(tree, schema.PASSING_FREQUENCY)[0])
    return f" Dotted: k v/L, multiples of the {first:.4g} Hz at which contacts pass a place; ten are drawn."


def contacts_table(tree: DataTree) -> ReportTable | None:
    """Where the contacts are, what they carry, and how long they are lost."""
    if not data.present(tree, rolling.OFFSET, rolling.STATIC_LOAD, rolling.CONTACT_LOSS_SHARE):
        return None
    main = data.laws(tree, rolling.CONTACT_LOSS_SHARE)[0]
    lost = next(Of(rolling.CONTACT_LOSS_SHARE)(tree)).values
    columns = {
        "contact": text_cells(range(1, len(lost) + 1)),
        "ahead of the position of the run": number_cells(
            data.values(tree, rolling.OFFSET), lambda offset: data.engineering(offset, "m", 4)
        ),
        "static force": number_cells(data.values(tree, rolling.STATIC_LOAD), "N"),
        f"out of contact, {main}": number_cells(100.0 * lost, "{:.3g} %"),
    }
    for lateral in Of(schema.LATERAL_CONTACT_SPREAD)(tree):
        columns[f"lateral force, rms, {main}"] = number_cells(lateral.values, "N")
    return table("where_contacts_are", "Contacts", columns, "Static forces as on a rigid plane.")


def _several(tree: DataTree) -> bool:
    return len(data.values(tree, rolling.CONTACT)) > 1


CONTACTS = (
    Figure(
        "contact_levels",
        "Force of each contact",
        Of(BAND, "band centre"),
        (panels.products(BAND_TIME_PRODUCT), _LEVELS, _mean),
        _levels,
        _levels_caption,
        (rolling.CONTACT, rolling.OFFSET),
        worth=_several,
    ),
    Figure(
        "force_sum",
        "Contacts together",
        Of(FREQUENCY),
        (Of(schema.SUM_PSD, "sum of all contact forces", look=(INK,)), _powers),
        panels.draw_spectrum("force PSD / dB re 1 N²/Hz", 1.0, tone_rules, slice(None, None, -1)),
        lambda tree: (
            f"Where the sum of all forces lies below the sum of their powers, contacts cancel; above it, "
            f"they act together. Main law, {data.laws(tree, schema.SUM_PSD)[0]}; {panels.DRAWN}."
            f"{tones_words(tree)}{panels.shaded_words(tree)}"
        ),
        (CONTACT_FORCE_PSD, rolling.CONTACT),
        worth=_several,
    ),
)
