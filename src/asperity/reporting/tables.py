"""Tables of the report that all kinds of case share: statistics, differences of laws, loss of contact."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from xarray import DataTree

from asperity.reporting.data import (
    doubtful,
    engineering,
    json_list,
    laws,
    nominal_band,
    of_law,
    present,
    stored_variable,
    values,
)
from asperity.reporting.law_entries import differences, law_entry
from asperity.schema import Entry, contact, rolling, surface
from asperity.schema.spectra import (
    BAND,
    BAND_TIME_PRODUCT,
    FORCE_LEVEL_DIFFERENCE_TO_REFERENCE,
    FORCE_LEVEL_DIFFERENCES,
    PRACTICE,
)
from asperity.spectra import LEAST_PRODUCT


@dataclass(frozen=True)
class Cell:
    """One field of a table: its text, and a class for its look."""

    text: str
    look: str = ""


@dataclass(frozen=True)
class ReportTable:
    """A table of the page: its name, heading, column heads, rows of cells and a note."""

    name: str
    title: str
    head: list[str]
    rows: list[list[Cell]] = field(default_factory=list)
    note: str = ""


def text_cell(found: object) -> Cell:
    """Field of words."""
    return Cell(str(found))


def statistics_table(tree: DataTree) -> ReportTable | None:
    """Statistics of the texture, each with the bandwidth it holds for."""
    found = json_list(tree, surface.STATISTICS)
    if not found:
        return None
    rows = []
    for entry in found:
        value, unit = entry.get("value"), str(entry.get("unit", ""))
        shown = engineering(float(value), unit) if isinstance(value, int | float) else "–"
        names = [str(entry.get(name, "")) for name in ("symbol", "meaning", "surface")]
        rows.append(
            [
                text_cell(names[0]),
                text_cell(names[1]),
                text_cell(names[2]),
                Cell(shown, "number"),
                text_cell(entry.get("bandwidth", "")),
            ]
        )
    note = "A statistic of a texture holds for its bandwidth of wavelengths only."
    return ReportTable(
        "statistics",
        "Statistics of the texture",
        ["symbol", "meaning", "of", "value", "bandwidth"],
        rows,
        note,
    )


def homogeneity_table(tree: DataTree) -> ReportTable | None:
    """Whether the measured maps are the same everywhere."""
    tested = stored_variable(tree, surface.HOMOGENEITY_P)
    if tested is None or not present(tree, surface.TILE_VARIATION, surface.TILE_VARIATION_EXPECTED):
        return None
    significance = float(tested.attrs["significance"])
    shown = (surface.TILE_VARIATION, surface.TILE_VARIATION_EXPECTED, surface.HOMOGENEITY_P)
    columns = [values(tree, entry, "sample") for entry in shown]
    rows = []
    for number, (variation, expected, p) in enumerate(zip(*columns, strict=True), start=1):
        same = bool(p > significance)
        cells = [in_percent(variation), in_percent(expected), f"{p:.2g}"]
        look = "number" if same else "number off"
        told = "as far as chance tells" if same else "no"
        rows.append([Cell(str(number), "number"), *(Cell(text, look) for text in cells), text_cell(told)])
    note = (
        "Coefficient of variation of the mean squares of tiles; p: share of stationary textures with the "
        "same spectrum and heights that vary as much. At p ≤ "
        f"{significance:g} a map is not the same everywhere; one in twenty is so by chance."
    )
    head = ["map", "tiles vary by", "by chance", "p", "same everywhere?"]
    return ReportTable("homogeneity", "Homogeneity of the measured maps", head, rows, note)


def population_table(tree: DataTree) -> ReportTable | None:
    """Whether samples and path are one population and one stiffness is enough, and what follows in dB."""
    found = json_list(tree, contact.POPULATION)
    if not found:
        return None
    rows = [
        [
            text_cell(entry.get("question", "")),
            Cell(str(entry.get("value", "")), _GRADED.get(str(entry.get("grade", "")), "")),
            text_cell(entry.get("answer", "")),
        ]
        for entry in found
    ]
    note = (
        "Stiffness: dF/dr of each sample under the load. Maps and parts of the path are told apart by "
        "analysis of variance of their levels, at p ≤ 0.01. Direction: spectra of lines along the path over "
        "those of lines across, for wavelengths from half the length of the contact up. Shaded: more than "
        "1 dB, 3 dB."
    )
    return ReportTable("population", "One population?", ["question", "here", "answer"], rows, note)


_GRADED = {"out of range": "far", "warning": "off"}


def practice_table(tree: DataTree) -> ReportTable | None:
    """Level differences to the filtered linear contact, that of practice, per one-third octave."""
    entry = FORCE_LEVEL_DIFFERENCES[PRACTICE]
    return _differences_table(tree, "practice", entry, differences(tree).get(entry))


def reference_table(tree: DataTree) -> ReportTable | None:
    """Level differences to the reference law per one-third octave."""
    compared = stored_variable(tree, FORCE_LEVEL_DIFFERENCE_TO_REFERENCE)
    solved = None if compared is None else str(compared.attrs["reference"])
    return _differences_table(tree, "reference", FORCE_LEVEL_DIFFERENCE_TO_REFERENCE, solved)


def _differences_table(tree: DataTree, name: str, entry: Entry, to: str | None) -> ReportTable | None:
    names = [law for law in laws(tree, entry) if law != to]
    if to is None or not names or not present(tree, BAND):
        return None
    found = np.array([of_law(tree, entry, law, "band") for law in names])
    bands, faint = values(tree, BAND), doubtful(tree, BAND_TIME_PRODUCT)
    rows = [
        [
            Cell(nominal_band(f), "number faint" if doubt else "number"),
            *(_difference(d, doubt) for d in column),
        ]
        for f, column, doubt in zip(bands, found.T, faint, strict=True)
    ]
    told = [row[np.isfinite(row) & ~faint] for row in found]
    mean = [signed(row.mean()) if row.size else "–" for row in told]
    largest = [f"{np.abs(row).max():.1f}" if row.size else "–" for row in told]
    rows.append([Cell("mean", "total"), *(Cell(text, "number total") for text in mean)])
    rows.append([Cell("largest size", "total"), *(Cell(text, "number total") for text in largest)])
    note = "Shaded: more than 1 dB, more than 3 dB away."
    if faint.any():
        note += (
            " In grey and in brackets: bands whose bandwidth times averaging time is below "
            f"{LEAST_PRODUCT:g}, or that hold the start; they say little, and are not in the last two rows."
        )
    title = f"Contact force level minus that of {to}, in dB"
    return ReportTable(name, title, ["band / Hz", *names], rows, note)


def signed(difference: float) -> str:
    """Write a difference in dB with its sign."""
    rounded = round(float(difference), 1)
    return "–" if not np.isfinite(difference) else f"{rounded:+.1f}".replace("-", "−") if rounded else "0.0"


def _difference(value: float, doubt: bool) -> Cell:
    size = abs(value)
    if doubt:
        return Cell(f"({signed(value)})", "number faint")
    look = " far" if size > 3 else " off" if size > 1 else ""
    return Cell(signed(value), "number" + look)


def in_percent(share: float) -> str:
    """Write a share in per cent."""
    return f"{100 * share:.1f} %" if share >= 0.01 or share == 0 else f"{100 * share:.2g} %"


def _pulling_words(names: list[str]) -> str:
    if not names:
        return ""
    verb = "pulls" if len(names) == 1 else "pull"
    return f"{' and '.join(names)} cannot lose contact, but {verb} where others let go."


def loss_table(tree: DataTree) -> ReportTable | None:
    """Share of time without contact, number of events and the longest, per law."""
    names = laws(tree, rolling.CONTACT_LOSS_SHARE)
    if not names:
        return None
    shown = {
        rolling.CONTACT_LOSS_SHARE: ("time without contact", in_percent),
        rolling.CONTACT_LOSS_EVENTS: ("events", lambda events: f"{events:.0f}"),
        rolling.LONGEST_LOSS: ("longest", lambda time: engineering(time, "s") if time > 0 else "–"),
    }
    held = {entry: told for entry, told in shown.items() if present(tree, entry)}
    rows = [
        [text_cell(law)]
        + [Cell(write(float(of_law(tree, entry, law))), "number") for entry, (_, write) in held.items()]
        for law in names
    ]
    note = _pulling_words([law for law in names if law_entry(tree, law).may_pull])
    return ReportTable(
        "contact_loss", "Loss of contact", ["law", *(name for name, _ in held.values())], rows, note
    )
