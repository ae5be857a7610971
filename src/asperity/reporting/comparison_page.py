"""The page of a comparison of runs, in the look of the report."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np
import xarray

from asperity import __version__
from asperity.reporting.chart_table import chart_tables
from asperity.reporting.comparison import MAIN, OF_CONTACT, NamedRun
from asperity.reporting.comparison_figures import contact_chart, levels_chart
from asperity.reporting.comparison_table import KIND, listed_keys, summary, sure
from asperity.reporting.data import engineering, json_attribute, json_list, nominal_band, stated
from asperity.reporting.law_entries import law_colours, law_style
from asperity.reporting.page import PageSection, charts_of
from asperity.reporting.tables import Cell, ReportTable, in_percent, signed, text_cell
from asperity.reporting.templates import PageFigure, whole_page
from asperity.schema import provenance, rolling

OFF, FAR = 1.0, 3.0
"""Sizes of differences above which a field is shaded, and shaded more, dB."""


@dataclass(frozen=True)
class Paragraph:
    """A paragraph of the page: who or what it is about, its text, and a class for its look."""

    lead: str
    text: str
    look: str = ""


@dataclass(frozen=True)
class ComparedSection(PageSection):
    """A chapter of the page."""

    paragraphs: list[Paragraph] = field(default_factory=list)


def comparison_page(
    runs: Sequence[NamedRun], table: xarray.Dataset, levels: Mapping[str, str], file: str
) -> str:
    """The whole page as one self-contained HTML text.

    Runs and their table from `asperity.reporting.comparison.compared`; titles of its levels by name; name of
    the CSV file beside the page.
    """
    colours = {name: dark for run in reversed(runs) for name, dark in law_colours(run.tree).items()}
    citations = dict.fromkeys(
        str(text) for run in runs for text in json_attribute(run.tree, provenance.CITATIONS, [])
    )
    drawn = compared_sections(runs, table, levels)
    return whole_page(
        "comparison.html.jinja",
        charts_of(drawn),
        colours,
        title=f"Comparison of {' and '.join(run.name for run in runs)}",
        summary=summary(runs, table, levels),
        first=runs[0].name,
        version=__version__,
        file=file,
        sections=drawn,
        provenance=_provenance_table(runs),
        citations=list(citations),
    )


def compared_sections(
    runs: Sequence[NamedRun], table: xarray.Dataset, levels: Mapping[str, str]
) -> list[ComparedSection]:
    """Chapters of the page: cases, verdicts, force, each level, contact."""
    found = [
        ComparedSection("case", "What differs in the cases", [_case_table(runs, table)]),
        ComparedSection("verdicts", "What each run says", [], _verdicts(runs)),
        ComparedSection("force", "Contact force and its loss", [_numbers_table(table)]),
    ]
    looks = {law: law_style(runs[0].tree, law, str(table["law"].values[0])) for law in runs[0].laws}
    for name, title in levels.items():
        chart = levels_chart(table, name, looks)
        figure = PageFigure(
            name, title.capitalize(), _levels_caption(table, name), chart, chart_tables(chart)
        )
        blocks: list[PageFigure | ReportTable] = [figure, _difference_table(table, name, title)]
        found.append(ComparedSection(f"levels-{name}", title.capitalize(), blocks))
    last: list[PageFigure | ReportTable] = [_contact_table(table)]
    if "stiffness" in table or "filter" in table:
        chart = contact_chart(table)
        title = "Stiffness and filter"
        last.insert(0, PageFigure("stiffness_and_filter", title, _CONTACT, chart, chart_tables(chart)))
    found.append(ComparedSection("contact", "Contact", last))
    return found


_CONTACT = (
    "Contact stiffness k_c = F/r over the approach of the surfaces, mean of the samples, a ring at the "
    "working approach; magnitude of the contact filter at the working approach of each run, as fitted."
)


def _levels_caption(table: xarray.Dataset, name: str) -> str:
    what = str(table[name].attrs["long_name"])
    names = [str(run) for run in table["run"].values]
    law = str(table["law"].values[0])
    below = f"the differences of all laws, {names[1]} less {names[0]}"
    if len(names) > 2:
        below = f"the differences of {law} to {names[0]}"
    shaded = (
        " Shaded: what two records differ by through chance alone, one standard deviation of the difference; "
        "runs over the same texture differ by less."
        if len(names) == 2
        else ""
    )
    return f"Above, {what}, of {law} in all runs; below, {below}.{shaded}"


# --- tables


def _case_table(runs: Sequence[NamedRun], table: xarray.Dataset) -> ReportTable:
    """Keys whose values differ."""
    items = listed_keys(table)
    rows = [
        [
            text_cell(item["key"]),
            *(text_cell("–" if value is None else value) for value in item["values"]),
            text_cell(item["note"]),
        ]
        for item in items
    ]
    note = "All other keys have the same values." if items else "All keys have the same values in all runs."
    if any(item["key"] == KIND for item in items):
        note = "Keys that one kind of case has alone are not listed; the table beside this page has them."
    return ReportTable("keys", "Keys that differ", ["key", *(r.name for r in runs), "what it is"], rows, note)


def _verdicts(runs: Sequence[NamedRun]) -> list[Paragraph]:
    """Verdict of each run, and its warnings."""
    found = []
    for run in runs:
        found.append(
            Paragraph(run.name, str(stated(run.tree, provenance.VERDICT) or "no verdict was stored"))
        )
        for warning in json_list(run.tree, provenance.WARNINGS):
            grade = str(warning.get("grade", "warning"))
            if grade != "note":
                found.append(Paragraph(f"{run.name}, {grade}", str(warning.get("message", "")), "note"))
    return found


_WRITTEN: dict[str, tuple[str, Callable[[float], str]]] = {
    "mean_force": ("mean force", lambda value: engineering(value, "N")),
    "rms_force": ("rms about it", lambda value: engineering(value, "N")),
    "peak_force": ("largest force", lambda value: engineering(value, "N")),
    rolling.CONTACT_LOSS_SHARE.name: ("time without contact", in_percent),
    rolling.CONTACT_LOSS_EVENTS.name: ("losses of contact", lambda value: f"{value:.0f}"),
    rolling.LONGEST_LOSS.name: ("longest loss", lambda value: engineering(value, "s") if value else "–"),
}


def _numbers_table(table: xarray.Dataset) -> ReportTable:
    """Numbers of the force, a row for each law and run."""
    held = {name: how for name, how in _WRITTEN.items() if name in table}
    rows = []
    for k, law in enumerate(map(str, table["law"].values)):
        for r, run in enumerate(map(str, table["run"].values)):
            numbers = [float(table[name].values[r, k]) for name in held]
            if not np.isfinite(numbers).any():
                continue
            cells = [
                Cell(write(value) if np.isfinite(value) else "–", "number")
                for value, (_, write) in zip(numbers, held.values(), strict=True)
            ]
            rows.append([Cell(law, "name"), Cell(run, "name"), *cells])
    head = ["law", "run", *(title for title, _ in held.values())]
    return ReportTable("numbers", "By law and run", head, rows)


def _difference_table(table: xarray.Dataset, name: str, title: str) -> ReportTable:
    """Differences to the first run in each band, and of the A-weighted totals."""
    difference, weighted = table[f"{name}_difference"].values, table[f"{name}_a_difference"].values
    runs, names = ([str(item) for item in table[key].values] for key in ("run", "law"))
    places = [
        (r, k) for r in range(1, len(runs)) for k in range(len(names)) if np.isfinite(difference[r, k]).any()
    ]
    head = [names[k] if len(runs) == 2 else f"{runs[r]}: {names[k]}" for r, k in places]
    trusted = {r: sure(table, r) for r in range(1, len(runs))}
    rows = [
        [
            Cell(nominal_band(float(f)), "number"),
            *(_cell(float(difference[r, k, b]), bool(trusted[r][b])) for r, k in places),
        ]
        for b, f in enumerate(table["band"].values)
        if np.isfinite(difference[1:, :, b]).any()
    ]
    total = [Cell(_told(float(weighted[r, k])), "number total") for r, k in places]
    rows.append([Cell("dB(A)", "total"), *total])
    over = f"{runs[1]} less {runs[0]}" if len(runs) == 2 else f"less {runs[0]}"
    note = (
        f"Shaded: more than {OFF:g} dB, more than {FAR:g} dB. In brackets: bands in which records of this "
        "length differ by 2 dB or more through chance alone. Last row: A-weighted, over the bands of both."
    )
    return ReportTable(
        f"{name}_difference", f"{title.capitalize()}, {over}, in dB", ["band / Hz", *head], rows, note
    )


def _cell(value: float, trusted: bool) -> Cell:
    if not np.isfinite(value):
        return Cell("–", "number")
    if not trusted:
        return Cell(f"({signed(value)})", "number faint")
    size = abs(value)
    return Cell(signed(value), "number" + (" far" if size > FAR else " off" if size > OFF else ""))


def _told(value: float) -> str:
    return signed(value) if np.isfinite(value) else "–"


def _contact_table(table: xarray.Dataset) -> ReportTable:
    """Load, approach, stiffness and real contact of each run."""
    heads = ["load", "approach under it", "stiffness dF/dr", "real over smooth contact area"]
    writes: list[Callable[[float], str]] = [
        lambda value: engineering(value, "N"),
        lambda value: engineering(value, "m"),
        lambda value: engineering(value, "N/m"),
        in_percent,
    ]
    change = table["working_stiffness_difference"].values
    rows = []
    for r, run in enumerate(map(str, table["run"].values)):
        numbers = [float(table[entry.name].values[r]) for entry in OF_CONTACT]
        cells = [w(v) if np.isfinite(v) else "–" for w, v in zip(writes, numbers, strict=True)]
        cells.insert(3, _told(float(change[r])) + " dB" if r else "–")
        rows.append([text_cell(run), *(Cell(text, "number") for text in cells)])
    heads.insert(3, "20 lg of its ratio to the first")
    return ReportTable("working_point", "Under the load", ["run", *heads], rows)


def _provenance_table(runs: Sequence[NamedRun]) -> ReportTable:
    rows = [
        [
            text_cell(run.name),
            *(
                text_cell("" if (value := stated(run.tree, attribute)) is None else value)
                for attribute in (
                    provenance.TITLE,
                    provenance.KIND,
                    provenance.ASPERITY_VERSION,
                    provenance.CREATED,
                    provenance.SEED,
                )
            ),
        ]
        for run in runs
    ]
    head = ["run", "what was rolled", "kind", "asperity", "made", "seed"]
    note = (
        f"“{MAIN}” stands for the first law of each run."
        if len({r.laws[0] for r in runs if r.laws}) > 1
        else ""
    )
    return ReportTable("runs", "Runs", head, rows, note)
