"""The page of a comparison: its tables, its figures, and what it says in short."""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np
import xarray

from asperity import __version__
from asperity.reporting import data, panels, tables
from asperity.reporting.chart import (
    BLUE,
    GREEN,
    INK,
    MUTED,
    VERMILLION,
    Axis,
    Boxes,
    Chart,
    Flags,
    Line,
    Mark,
    Numbers,
    Panel,
)
from asperity.reporting.comparison import DEVIATION, MAIN, OF_CONTACT, NamedRun
from asperity.reporting.page import PageFigure, PageSection, whole_page
from asperity.reporting.payload import chart_tables
from asperity.reporting.tables import ReportTable, number_cells, text_cells
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
        told = [str(data.stated(run.tree, attribute) or "") for run in runs]
        rows.append(["run", attribute.name, "", "", "", *told, *blank])
    for name in map(str, table.data_vars):
        if not name.endswith("_difference"):
            rows += _rows_of(table, name)
    return heading, rows


def _rows_of(table: xarray.Dataset, name: str) -> Iterator[list[object]]:
    """A quantity at each place, in all runs, and its differences: those kept, or plain ones."""
    held, kept = table[name], table.get(f"{name}_difference")
    what = {"approach": "contact", "wavenumber": "filter", "band": "level"}
    own = [dim for dim in held.dims if dim != "run"]
    place = next((str(dim) for dim in own if dim != "law"), "")
    units, less_units = str(held.attrs["units"]), str((held if kept is None else kept).attrs["units"])
    for index in np.ndindex(*(held.sizes[dim] for dim in own)):
        at = dict(zip(own, index, strict=True))
        found = held.isel(at).values
        if not np.isfinite(found).any():
            continue
        less = (found - found[0] if kept is None else kept.isel(at).values)[1:].tolist()
        law = str(table["law"].values[at["law"]]) if "law" in at else ""
        where = f"{float(table[place][at[place]]):.6g} {table[place].attrs['units']}" if place else ""
        kind = what.get(place, "contact" if not law else "level" if name.endswith("_a") else "force")
        last = ["", *[""] * len(less)] if name == DEVIATION else [less_units, *less]
        yield [kind, name, law, where, units, *found.tolist(), *last]


def listed_keys(table: xarray.Dataset) -> list[dict[str, Any]]:
    """Keys that differ; of cases of different kinds only those that all have, for the others say little."""
    items: list[dict[str, Any]] = json.loads(table.attrs["cases"])
    mixed = any(item["key"] == KIND for item in items)
    return [item for item in items if not mixed or None not in item["values"]]


def summary(runs: Sequence[NamedRun], table: xarray.Dataset, levels: Mapping[str, str]) -> str:
    """Say in a few sentences how the runs after the first differ from it, by their first law.

    Of the levels, by name with what they are, the first and the last: the force, and what it makes.
    """
    names = list(dict.fromkeys([*list(levels)[:1], *list(levels)[-1:]]))
    keys = [str(item["key"]) for item in listed_keys(table)]
    more = f" and {len(keys) - 4} more" if len(keys) > 4 else ""
    sentences = [f"The cases differ in {', '.join(keys[:4])}{more}" if keys else "The cases are the same"]
    law = str(table["law"].values[0]) if table.sizes["law"] else ""
    for r, run in enumerate(runs[1:], 1):
        told = [each for name in names if (each := _level_words(table, name, levels[name], r))]
        if told:
            sentences.append(f"{run.name} against {runs[0].name}, {law}: {'; '.join(told)}")
    return ". ".join(sentences) + "."


def _level_words(table: xarray.Dataset, name: str, title: str, run: int) -> str:
    """Range of the differences of a level over the bands that say something, and dB(A)."""
    difference = table[f"{name}_difference"][run, 0].values
    told = np.isfinite(difference) & _sure(table, run)
    weighted = float(table[f"{name}_a_difference"][run, 0])
    if not told.any():
        return f"{title} {data.signed(weighted)} dB(A)" if np.isfinite(weighted) else ""
    band, change = table["band"].values[told], difference[told]
    ends = [
        f"{data.signed(change[i])} dB ({nominal_frequency(float(band[i]))})"
        for i in (int(change.argmin()), int(change.argmax()))
    ]
    return f"{title} {' to '.join(ends)}, {data.signed(weighted)} dB(A)"


def _chance(table: xarray.Dataset, run: int) -> Numbers:
    """Standard deviation of the level differences of a run to the first by chance, dB (bands,).

    Of records that know nothing of each other; runs over the same texture differ by less.
    """
    deviation = table[DEVIATION].values
    return np.asarray(np.sqrt(deviation[0] ** 2 + deviation[run] ** 2))


def _sure(table: xarray.Dataset, run: int) -> Flags:
    """Bands whose difference to the first run says something; all where no chance is known."""
    return ~(_chance(table, run) >= SURE)


# --- figures

RUN_COLOURS = (INK, VERMILLION, BLUE, GREEN, "#a8458f", "#96700a", "#2a93c4", "#6f7a85")
RUN_DASHES = ((), (5, 1.5), (2, 1), (6, 1.5, 1, 1.5))
MOST_RUNS = len(RUN_COLOURS)
"""That can be told apart."""


def _of_run(table: xarray.Dataset, number: int, x: Numbers, y: Numbers, marker: str = "o") -> Line:
    """A line of a run by its number, from 0."""
    name, dashes = str(table["run"].values[number]), RUN_DASHES[number % len(RUN_DASHES)]
    return Line(x, y, name, RUN_COLOURS[number], dashes, 1.6, marker)


def _levels_chart(table: xarray.Dataset, name: str, looks: Mapping[str, Mapping[str, Any]]) -> Chart:
    """A level of all runs by their first law, and the differences to the first run.

    Of two runs the differences of all laws are drawn, in their `looks`; of more runs those of the first law.
    """
    level, difference = table[name].values, table[f"{name}_difference"].values
    band, laws, runs = table["band"].values, list(map(str, table["law"].values)), table.sizes["run"]
    above = [_of_run(table, r, band, level[r, 0]) for r in range(runs)]
    below: list[Mark] = [panels.zero(colour=INK, width=0.8)]
    if runs == 2:
        deviation = _chance(table, 1)
        known = np.isfinite(deviation)
        if known.any():
            at, by = band[known], deviation[known]
            edges = at / panels.EDGE, at * panels.EDGE, -by, by
            below.append(Boxes(*edges, label="± 1 s by chance", colour=MUTED, opacity=0.18))
        for law, change in zip(laws, difference[1], strict=True):
            if np.isfinite(change).any():
                below.append(Line(band, change, law, **looks.get(law, {"colour": MUTED})))
    else:
        below += [_of_run(table, r, band, difference[r, 0]) for r in range(1, runs)]
    bands = panels.band_axis(band[np.isfinite(level).any(axis=(0, 1))])
    label = f"level of {laws[0]} / {data.written_units(table[name].attrs['units'])}"
    over = Axis(f"over {table['run'].values[0]} / dB")
    heights = panels.levels_axis(label, [level[:, 0]])
    return Chart(
        (Panel(bands, heights, tuple(above), height=3.2), Panel(bands, over, tuple(below), height=2.8))
    )


def _stiffness(table: xarray.Dataset) -> Panel:
    """Stiffness of all runs over the approach."""
    approach, stiffness = table["approach"].values * 1e6, table["stiffness"].values
    unit, symbol = (1e9, "GN/m") if np.nanmax(stiffness) > 2e9 else (1e6, "MN/m")
    working = table[contact.WORKING_APPROACH.name].values * 1e6
    lines = []
    for r, found in enumerate(stiffness):
        kept = np.isfinite(found)
        if kept.any():
            line = _of_run(table, r, approach[kept], found[kept] / unit, marker="")
            at = working[r : r + 1]
            point = Line(at, np.interp(at, line.x, line.y), colour=line.colour, width=0, marker="o")
            lines += [line, point]
    along, up = Axis("approach / µm"), Axis(f"contact stiffness k_c / ({symbol})", low=0.0)
    return Panel(along, up, tuple(lines), height=3.9)


def _filters(table: xarray.Dataset) -> Panel:
    """Filters of all runs at the working approach."""
    wavenumber, level = table["wavenumber"].values, table["filter"].values
    known = np.isfinite(level)
    lines = [
        _of_run(table, r, wavenumber, level[r], marker="") for r in np.flatnonzero(known.any(axis=1)).tolist()
    ]
    kept = wavenumber[known.any(axis=0)]
    up = Axis("contact filter |H| / dB", max(float(np.nanmin(level)) - 2.0, -40.0), 3.0)
    return Panel(panels.wavenumber_axis(kept[0], kept[-1]), up, tuple(lines), height=3.9)


# --- the page


def comparison_page(
    runs: Sequence[NamedRun], table: xarray.Dataset, levels: Mapping[str, str], file: str
) -> str:
    """The whole page as one self-contained HTML text.

    Runs and their table from `asperity.reporting.comparison.compared`; titles of its levels by name; name of
    the CSV file beside the page.
    """
    colours = {name: dark for run in reversed(runs) for name, dark in data.law_colours(run.tree).items()}
    citations = [text for run in runs for text in data.json_attribute(run.tree, provenance.CITATIONS, [])]
    drawn = compared_sections(runs, table, levels)
    blocks = [block for section in drawn for block in section.blocks]
    return whole_page(
        "comparison.html.jinja",
        blocks,
        colours,
        title=f"Comparison of {' and '.join(run.name for run in runs)}",
        summary=summary(runs, table, levels),
        first=runs[0].name,
        version=__version__,
        file=file,
        sections=drawn,
        provenance=_provenance_table(runs),
        citations=list(dict.fromkeys(map(str, citations))),
    )


def compared_sections(
    runs: Sequence[NamedRun], table: xarray.Dataset, levels: Mapping[str, str]
) -> list[PageSection]:
    """Chapters of the page: cases, verdicts, force, each level, contact."""

    def figure(name: str, title: str, caption: str, chart: Chart) -> PageFigure:
        return PageFigure(name, title, caption, chart, chart_tables(chart))

    found = [
        PageSection("case", "What differs in the cases", [_case_table(runs, table)]),
        PageSection("verdicts", "What each run says", [], list(_verdicts(runs))),
        PageSection("force", "Contact force and its loss", [_numbers_table(table)]),
    ]
    main = str(table["law"].values[0]) if table.sizes["law"] else ""
    looks = {law: data.law_style(runs[0].tree, law, main) for law in runs[0].laws}
    for name, title in levels.items():
        drawn = figure(
            name, title.capitalize(), _levels_caption(table, name), _levels_chart(table, name, looks)
        )
        blocks: list[PageFigure | ReportTable] = [drawn, _difference_table(table, name, title)]
        found.append(PageSection(f"levels-{name}", title.capitalize(), blocks))
    shown = [draw(table) for held, draw in (("stiffness", _stiffness), ("filter", _filters)) if held in table]
    beside = [replace(panel, beside=True, share=1.15) for panel in shown[1:]]
    caption = (
        "Contact stiffness k_c = F/r over the approach of the surfaces, mean of the samples, a ring at the "
        "working approach; magnitude of the contact filter at the working approach of each run, as fitted."
    )
    last = Chart((*shown[:1], *beside))
    figures = [figure("stiffness_and_filter", "Stiffness and filter", caption, last)] if shown else []
    return [*found, PageSection("contact", "Contact", [*figures, _contact_table(table)])]


def _levels_caption(table: xarray.Dataset, name: str) -> str:
    runs, law, shaded = list(map(str, table["run"].values)), table["law"].values[0], ""
    below = f"the differences of {law} to {runs[0]}"
    if len(runs) == 2:
        below = f"the differences of all laws, {runs[1]} less {runs[0]}"
        shaded = (
            " Shaded: what two records differ by through chance alone, one standard deviation of the "
            "difference; runs over the same texture differ by less."
        )
    return f"Above, {table[name].attrs['long_name']}, of {law} in all runs; below, {below}.{shaded}"


def _verdicts(runs: Sequence[NamedRun]) -> Iterator[tuple[str, str, str]]:
    """Verdict of each run, and its warnings."""
    for run in runs:
        yield run.name, str(data.stated(run.tree, provenance.VERDICT) or "no verdict was stored"), ""
        for warning in data.json_list(run.tree, provenance.WARNINGS):
            grade = str(warning.get("grade", "warning"))
            if grade != "note":
                yield f"{run.name}, {grade}", str(warning.get("message", "")), "note"


# --- tables


def _case_table(runs: Sequence[NamedRun], table: xarray.Dataset) -> ReportTable:
    """Keys whose values differ."""
    items = listed_keys(table)
    rows = [
        text_cells(
            [item["key"], *("–" if value is None else value for value in item["values"]), item["note"]]
        )
        for item in items
    ]
    note = "All other keys have the same values." if items else "All keys have the same values in all runs."
    if any(item["key"] == KIND for item in items):
        note = "Keys that one kind of case has alone are not listed; the table beside this page has them."
    return ReportTable("keys", "Keys that differ", ["key", *(r.name for r in runs), "what it is"], rows, note)


_FORCE: dict[str, tuple[str, str | tables.Writer]] = {
    "mean_force": ("mean force", "N"),
    "rms_force": ("rms about it", "N"),
    "peak_force": ("largest force", "N"),
    **{entry.name: how for entry, how in tables.LOSSES.items()},
    rolling.CONTACT_LOSS_EVENTS.name: ("losses of contact", "{:.0f}"),
    rolling.LONGEST_LOSS.name: ("longest loss", tables.LOSSES[rolling.LONGEST_LOSS][1]),
}


def _numbers_table(table: xarray.Dataset) -> ReportTable:
    """Numbers of the force, a row for each law and run."""
    found = {name: table[name].values.T for name in _FORCE}
    shown = np.isfinite(list(found.values())).any(axis=0)
    laws, runs = (
        table[key].values[places] for key, places in zip(("law", "run"), np.nonzero(shown), strict=True)
    )
    columns = {"law": text_cells(laws, "name"), "run": text_cells(runs, "name")}
    columns |= {head: number_cells(found[name][shown], write) for name, (head, write) in _FORCE.items()}
    return tables.table("numbers", "By law and run", columns)


def _difference_table(table: xarray.Dataset, name: str, title: str) -> ReportTable:
    """Differences to the first run in each band, and of the A-weighted totals."""
    difference, weighted = table[f"{name}_difference"].values, table[f"{name}_a_difference"].values
    runs, laws = (list(map(str, table[key].values)) for key in ("run", "law"))
    kept = np.isfinite(difference[1:]).any(axis=(0, 1))
    bands = number_cells(table["band"].values[kept], data.nominal_band)
    head, columns = ["band / Hz"], [[*bands, *text_cells(["dB(A)"], "total")]]
    for r, k in np.argwhere(np.isfinite(difference).any(axis=2)).tolist():
        if r > 0:
            head.append(laws[k] if len(runs) == 2 else f"{runs[r]}: {laws[k]}")
            cells = tables.change_cells(difference[r, k, kept], ~_sure(table, r)[kept])
            columns.append([*cells, *number_cells(weighted[r, k : k + 1], data.signed, "number total")])
    over = f"{runs[1]} less {runs[0]}" if len(runs) == 2 else f"less {runs[0]}"
    note = (
        "Shaded: more than 1 dB, more than 3 dB. In brackets: bands in which records of this "
        "length differ by 2 dB or more through chance alone. Last row: A-weighted, over the bands of both."
    )
    title, rows = f"{title.capitalize()}, {over}, in dB", [list(row) for row in zip(*columns, strict=True)]
    return ReportTable(f"{name}_difference", title, head, rows, note)


def _contact_table(table: xarray.Dataset) -> ReportTable:
    """Load, approach, stiffness and real contact of each run."""
    load, approach, stiffness, area = (table[entry.name].values for entry in OF_CONTACT)
    change = table["working_stiffness_difference"].values[1:]
    columns = {
        "run": text_cells(table["run"].values),
        "load": number_cells(load, "N"),
        "approach under it": number_cells(approach, "m"),
        "stiffness dF/dr": number_cells(stiffness, "N/m"),
        "20 lg of its ratio to the first": text_cells(
            ["–", *(f"{data.signed(each)} dB" for each in change)], "number"
        ),
        "real over smooth contact area": number_cells(area, data.in_percent),
    }
    return tables.table("working_point", "Under the load", columns)


def _provenance_table(runs: Sequence[NamedRun]) -> ReportTable:
    """Where the runs come from."""
    told = {
        "what was rolled": provenance.TITLE,
        "kind": provenance.KIND,
        "asperity": provenance.ASPERITY_VERSION,
        "made": provenance.CREATED,
    }
    seeds = [data.stated(run.tree, provenance.SEED) for run in runs]
    columns = {
        "run": text_cells(run.name for run in runs),
        **{
            head: text_cells(data.moment(data.stated(run.tree, each)) for run in runs)
            for head, each in told.items()
        },
        "seed": text_cells("" if seed is None else seed for seed in seeds),
    }
    mixed = len({run.laws[0] for run in runs if run.laws}) > 1
    return tables.table(
        "runs", "Runs", columns, f"“{MAIN}” stands for the first law of each run." if mixed else ""
    )
