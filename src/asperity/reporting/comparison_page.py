"""The page of a comparison: its tables, its figures, and what it says in short."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
import xarray
from numpy.typing import NDArray

from asperity import __version__
from asperity.reporting.axes import EDGE, band_axis, levels_axis, wavenumber_axis
from asperity.reporting.chart import (
    BLUE,
    GREEN,
    INK,
    MUTED,
    VERMILLION,
    Axis,
    Boxes,
    Chart,
    Dashes,
    Line,
    Numbers,
    Panel,
    Rules,
)
from asperity.reporting.comparison import DEVIATION, MAIN, OF_CONTACT, NamedRun
from asperity.reporting.data import (
    engineering,
    json_attribute,
    json_list,
    moment,
    nominal_band,
    stated,
    written_units,
)
from asperity.reporting.law_entries import law_colours, law_style
from asperity.reporting.page import PageFigure, PageSection, charts_of, whole_page
from asperity.reporting.payload import chart_tables
from asperity.reporting.tables import Cell, ReportTable, in_percent, signed, text_cell
from asperity.schema import contact, provenance, rolling
from asperity.spectra import nominal_frequency

KIND = "kind"
"""Key that names the kind of a case."""
SURE = 2.0
"""Standard deviation of a difference by chance, dB, from which a band says little."""


def table_rows(runs: Sequence[NamedRun], table: xarray.Dataset) -> tuple[list[str], list[list[object]]]:
    """Heading and rows of everything that is compared: a column for each run and each difference."""
    names = [run.name for run in runs]
    heading = ["what", "quantity", "law", "at", "unit", *names]
    heading += ["unit of the difference", *(f"{name} - {names[0]}" for name in names[1:])]
    blank = [""] * len(runs)
    rows: list[list[object]] = []
    for item in json.loads(table.attrs["cases"]):
        written = ["" if value is None else str(value) for value in item["values"]]
        rows.append(["case", item["key"], "", "", "", *written, *blank])
    for attribute in (provenance.VERDICT, provenance.ASPERITY_VERSION, provenance.CREATED):
        rows.append(
            ["run", attribute.name, "", "", "", *(str(stated(r.tree, attribute) or "") for r in runs), *blank]
        )
    for name in map(str, table.data_vars):
        if not name.endswith("_difference"):
            rows += _rows_of(table, name)
    return heading, rows


def _rows_of(table: xarray.Dataset, name: str) -> Iterator[list[object]]:
    """A quantity at each place, in all runs, and its differences: those kept, or plain ones."""
    held = table[name]
    kept = table.get(f"{name}_difference")
    what = {"approach": "contact", "wavenumber": "filter", "band": "level"}
    place = next((str(dim) for dim in held.dims if dim not in ("run", "law")), "")
    own = [dim for dim in held.dims if dim != "run"]
    for index in np.ndindex(*(held.sizes[dim] for dim in own)):
        at = dict(zip(own, index, strict=True))
        numbers = held.isel(at).values
        if not np.isfinite(numbers).any():
            continue
        less = (numbers - numbers[0] if kept is None else kept.isel(at).values)[1:].tolist()
        own_units = str(held.attrs["units"]) if kept is None else str(kept.attrs["units"])
        if name == DEVIATION:
            own_units, less = "", [""] * len(less)
        law = str(table["law"].values[at["law"]]) if "law" in at else ""
        where = f"{float(table[place][at[place]]):.6g} {table[place].attrs['units']}" if place else ""
        kind = what.get(place, "contact" if not law else "level" if name.endswith("_a") else "force")
        units = str(held.attrs["units"])
        yield [kind, name, law, where, units, *numbers.tolist(), own_units, *less]


def listed_keys(table: xarray.Dataset) -> list[dict[str, Any]]:
    """Keys that differ; of cases of different kinds only those that all have, for the others say little."""
    items: list[dict[str, Any]] = json.loads(table.attrs["cases"])
    if not any(item["key"] == KIND for item in items):
        return items
    return [item for item in items if None not in item["values"]]


def summary(runs: Sequence[NamedRun], table: xarray.Dataset, levels: Mapping[str, str]) -> str:
    """Say in a few sentences how the runs after the first differ from it, by their first law.

    Of the levels, by name with what they are, the first and the last: the force, and what it makes.
    """
    names = list(dict.fromkeys([*list(levels)[:1], *list(levels)[-1:]]))
    first = runs[0].name
    keys = [str(item["key"]) for item in listed_keys(table)]
    sentences = [_keys_sentence(keys)]
    law = str(table["law"].values[0]) if table.sizes["law"] else ""
    for r, run in enumerate(runs[1:], 1):
        told = [words for name in names if (words := _level_words(table, name, levels[name], r))]
        if told:
            sentences.append(f"{run.name} against {first}, {law}: {'; '.join(told)}")
    return ". ".join(sentences) + "."


def _keys_sentence(keys: Sequence[str]) -> str:
    if not keys:
        return "The cases are the same"
    shown = ", ".join(keys[:4]) + (f" and {len(keys) - 4} more" if len(keys) > 4 else "")
    return f"The cases differ in {shown}"


def _level_words(table: xarray.Dataset, name: str, title: str, run: int) -> str:
    """Range of the differences of a level over the bands that say something, and dB(A)."""
    difference = table[f"{name}_difference"][run, 0].values
    told = np.isfinite(difference) & sure(table, run)
    weighted = float(table[f"{name}_a_difference"][run, 0])
    if not told.any():
        return f"{title} {signed(weighted)} dB(A)" if np.isfinite(weighted) else ""
    band, change = table["band"].values[told], difference[told]
    ends = [
        f"{signed(float(change[i]))} dB ({nominal_frequency(float(band[i]))})"
        for i in (int(change.argmin()), int(change.argmax()))
    ]
    return f"{title} {' to '.join(ends)}, {signed(weighted)} dB(A)"


def chance(table: xarray.Dataset, run: int) -> NDArray[np.float64]:
    """Standard deviation of the level differences of a run to the first by chance, dB (bands,).

    Of records that know nothing of each other; runs over the same texture differ by less.
    """
    deviation = table[DEVIATION].values
    return np.asarray(np.sqrt(deviation[0] ** 2 + deviation[run] ** 2))


def sure(table: xarray.Dataset, run: int) -> NDArray[np.bool_]:
    """Bands whose difference to the first run says something; all where no chance is known."""
    return ~(chance(table, run) >= SURE)


RUN_COLOURS = (INK, VERMILLION, BLUE, GREEN, "#a8458f", "#96700a", "#2a93c4", "#6f7a85")
RUN_DASHES: tuple[Dashes, ...] = ((), (5, 1.5), (2, 1), (6, 1.5, 1, 1.5))
MOST_RUNS = len(RUN_COLOURS)
"""That can be told apart."""


def levels_chart(table: xarray.Dataset, name: str, looks: Mapping[str, Mapping[str, Any]]) -> Chart:
    """A level of all runs by their first law, and the differences to the first run.

    Of two runs the differences of all laws are drawn, in their `looks`; of more runs those of the first law.
    """
    level, difference = table[name].values, table[f"{name}_difference"].values
    runs, laws = ([str(item) for item in table[key].values] for key in ("run", "law"))
    band = table["band"].values
    above = [_of_run(r, run, band, level[r, 0]) for r, run in enumerate(runs)]
    below: list[Boxes | Line | Rules] = [Rules(np.zeros(1), "y", colour=INK, dashes=(), width=0.8)]
    if len(runs) == 2:
        held = [k for k in range(len(laws)) if np.isfinite(difference[1, k]).any()]
        below += _chance(band, chance(table, 1))
        below += [
            Line(band, difference[1, k], laws[k], **looks.get(laws[k], {"colour": MUTED})) for k in held
        ]
    else:
        below += [_of_run(r, run, band, difference[r, 0]) for r, run in enumerate(runs[1:], 1)]
    bands = band_axis(band[np.isfinite(level).any(axis=(0, 1))])
    heights = levels_axis(f"level of {laws[0]} / {written_units(table[name].attrs['units'])}", [level[:, 0]])
    over = Axis(f"over {runs[0]} / dB")
    return Chart(
        (Panel(bands, heights, tuple(above), height=3.2), Panel(bands, over, tuple(below), height=2.8))
    )


def _of_run(number: int, name: str, x: Numbers, y: Numbers, marker: str = "o") -> Line:
    """A line of a run by its number, from 0."""
    dashes = RUN_DASHES[number % len(RUN_DASHES)]
    return Line(x, y, name, RUN_COLOURS[number], dashes, 1.6, marker)


def _chance(band: Numbers, deviation: Numbers) -> list[Boxes]:
    """What two records that know nothing of each other differ by: one standard deviation."""
    known = np.isfinite(deviation)
    if not known.any():
        return []
    band, deviation = band[known], deviation[known]
    edges = band / EDGE, band * EDGE, -deviation, deviation
    return [Boxes(*edges, label="± 1 s by chance", colour=MUTED, opacity=0.18)]


def contact_chart(table: xarray.Dataset) -> Chart:
    """Stiffness of all runs over the approach, and their filters at the working approach."""
    panels = [_stiffness(table)] if "stiffness" in table else []
    panels += [_filters(table)] if "filter" in table else []
    return Chart((*panels[:1], *(replace(panel, beside=True, share=1.15) for panel in panels[1:])))


def _stiffness(table: xarray.Dataset) -> Panel:
    approach, stiffness = table["approach"].values * 1e6, table["stiffness"].values
    unit, symbol = (1e9, "GN/m") if np.nanmax(stiffness) > 2e9 else (1e6, "MN/m")
    working = table[contact.WORKING_APPROACH.name].values * 1e6
    lines = []
    for r, run in enumerate(map(str, table["run"].values)):
        kept = np.isfinite(stiffness[r])
        if kept.any():
            lines.append(_of_run(r, run, approach[kept], stiffness[r, kept] / unit, marker=""))
            at = np.interp(working[r : r + 1], *(lines[-1].x, lines[-1].y))
            lines.append(Line(working[r : r + 1], at, colour=RUN_COLOURS[r], width=0, marker="o"))
    along, up = Axis("approach / µm"), Axis(f"contact stiffness k_c / ({symbol})", low=0.0)
    return Panel(along, up, tuple(lines), height=3.9)


def _filters(table: xarray.Dataset) -> Panel:
    wavenumber, level = table["wavenumber"].values, table["filter"].values
    names = [str(run) for run in table["run"].values]
    lines = [
        _of_run(r, run, wavenumber, level[r], marker="")
        for r, run in enumerate(names)
        if np.isfinite(level[r]).any()
    ]
    kept = wavenumber[np.isfinite(level).any(axis=0)]
    up = Axis("contact filter |H| / dB", max(float(np.nanmin(level)) - 2.0, -40.0), 3.0)
    return Panel(wavenumber_axis(kept[0], kept[-1]), up, tuple(lines), height=3.9)


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
    told = (provenance.TITLE, provenance.KIND, provenance.ASPERITY_VERSION, provenance.CREATED)
    rows = [
        [run.name, *(moment(stated(run.tree, each)) for each in told), stated(run.tree, provenance.SEED)]
        for run in runs
    ]
    cells = [[text_cell("" if each is None else each) for each in row] for row in rows]
    head = ["run", "what was rolled", "kind", "asperity", "made", "seed"]
    note = (
        f"“{MAIN}” stands for the first law of each run."
        if len({r.laws[0] for r in runs if r.laws}) > 1
        else ""
    )
    return ReportTable("runs", "Runs", head, cells, note)
