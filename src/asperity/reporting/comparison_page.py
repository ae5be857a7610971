"""The page of a comparison: its tables, its figures, and what it says in short."""

from collections.abc import Iterable, Iterator
from dataclasses import replace

import numpy as np
import xarray

from asperity.arguments import Array, Flags
from asperity.reporting import chart, data, headline, page, panels, tables
from asperity.reporting.chart import INK, MUTED, Axis, Drawn, Line, Panel
from asperity.reporting.comparison import DEVIATION, MAIN, OF_CONTACT, UNLIKE_RUNS, ComparedRuns
from asperity.reporting.figure import PageFigure
from asperity.reporting.tables import Cell, ReportTable, in_digits, number_cells, text_cells
from asperity.schema import contact, provenance, rolling
from asperity.schema.bearing import BAND_VELOCITY, JUDGED_BAND
from asperity.spectra import nominal_frequency
from asperity.written_numbers import capital, rounded

ANOTHER = "another texture was drawn"
"""What is said of runs that differ by chance, too."""
SURE = 2.0
"""Standard deviation of a difference by chance, dB, from which a band says little."""
OF_RUN = (provenance.VERDICT, provenance.ASPERITY_VERSION, provenance.CREATED)


def table_rows(of: ComparedRuns) -> tuple[list[str], list[list[object]]]:
    """Heading and rows of everything that is compared: a column for each run and each difference."""
    names = of.names
    blank = [""] * len(of.runs)
    heading = ["what", "quantity", "law", "at", "unit", *names]
    heading += ["unit of the difference", *(f"{name} - {names[0]}" for name in names[1:])]
    rows: list[list[object]] = []
    for item in of.keys:
        written = ["" if value is None else str(value) for value in item["values"]]
        rows.append(["case", item["key"], "", "", "", *written, *blank])
    for attribute in OF_RUN:
        told = [str(data.stated(run.tree, attribute) or "") for run in of.runs]
        rows.append(["run", attribute.name, "", "", "", *told, *blank])
    told = [ANOTHER * of.another_texture(r) for r in range(len(of.runs))]
    rows += [["run", "texture", "", "", "", *told, *blank]] * any(told)
    for name in map(str, of.table.data_vars):
        if not name.endswith("_difference"):
            rows += _rows_of(of.table, name)
    return heading, rows


def _rows_of(table: xarray.Dataset, name: str) -> Iterator[list[object]]:
    """A quantity at each place, in all runs, and its differences: those kept, or plain ones."""
    held = table[name]
    kept = table.get(f"{name}_difference")
    what = {"approach": "contact", "wavenumber": "filter", "band": "level", JUDGED_BAND.name: "velocity"}
    own = [dim for dim in held.dims if dim != "run"]
    place = next((str(dim) for dim in own if dim != "law"), "")
    units = str(held.attrs["units"])
    less_units = str((held if kept is None else kept).attrs["units"])
    for index in np.ndindex(*(held.sizes[dim] for dim in own)):
        at = dict(zip(own, index, strict=True))
        found = held.isel(at).values
        if not np.isfinite(found).any():
            continue
        less = (found - found[0] if kept is None else kept.isel(at).values)[1:].tolist()
        law = str(table["law"].values[at["law"]]) if "law" in at else ""
        where = _place(table[place][at[place]]) if place else ""
        kind = what.get(place, "contact" if not law else "level" if name.endswith("_a") else "force")
        last = ["", *[""] * len(less)] if name == DEVIATION else [less_units, *less]
        yield [kind, name, law, where, units, *found.tolist(), *last]


def _place(at: xarray.DataArray) -> str:
    """Where a number stands: a word, or a number with its unit."""
    if at.dtype.kind == "U":
        return str(at.values)
    return f"{rounded(float(at), 6)} {at.attrs['units']}"


def summary(of: ComparedRuns) -> str:
    """Say in a few sentences how the runs after the first differ from it, by their first law.

    Of bearings the velocities by which they are judged; of others, of the levels, the first and the last:
    the force, and what it makes.
    """
    shown = dict.fromkeys([*list(of.levels)[:1], *list(of.levels)[-1:]])
    keys = [str(item["key"]) for item in of.keys]
    more = f" and {len(keys) - 4} more" if len(keys) > 4 else ""
    sentences = [f"The cases differ in {', '.join(keys[:4])}{more}" if keys else "The cases are the same"]
    for r, name in enumerate(of.names[1:], 1):
        told = [words for level in shown if (words := _level_words(of, level, r))]
        words = _velocity_words(of, r) or "; ".join(told)
        if of.another_texture(r):
            words = f"{ANOTHER}, so that chance is in every difference" + f" ({words})" * bool(words)
        if words:
            sentences.append(f"{name} against {of.names[0]}, {of.laws[0]}: {words}")
    return ". ".join(sentences) + "."


def _velocity_words(of: ComparedRuns, run: int) -> str:
    """Differences of the velocities of a bearing in its bands; nothing of runs that are no bearings."""
    if BAND_VELOCITY.name not in of.table:
        return ""
    velocity = of.table[BAND_VELOCITY.name].values[:, 0]
    change = of.table[f"{BAND_VELOCITY.name}_difference"].values[run, 0]
    told = [
        f"{data.signed(less)} dB in {band} ({data.between(rounded(1e6 * first), rounded(1e6 * own))} µm/s)"
        for band, less, first, own in zip(
            of.table[JUDGED_BAND.name].values, change, velocity[0], velocity[run], strict=True
        )
        if np.isfinite(less)
    ]
    return f"radial velocity {', '.join(told)}" if told else ""


def _level_words(of: ComparedRuns, name: str, run: int) -> str:
    """Range of the differences of a level over the bands that say something, and dB(A)."""
    difference = of.table[f"{name}_difference"]
    title = of.levels[name]
    change = difference[run, 0].values
    without = difference.attrs.get(UNLIKE_RUNS, "")
    if without and not np.isfinite(change).any():
        return f"{title} not compared, for that of {without} is without its wheel"
    weighted = float(of.table[f"{name}_a_difference"][run, 0])
    told = np.flatnonzero(np.isfinite(change) & _sure(of.table, run))
    if not told.size:
        return f"{title} {data.signed(weighted)} dB(A)" if np.isfinite(weighted) else ""
    band = of.table["band"].values
    ends = {
        nominal_frequency(float(band[i])): f"{data.signed(change[i])} dB"
        for i in (told[change[told].argmin()], told[change[told].argmax()])
    }
    spread = " to ".join(f"{less} ({centre})" for centre, less in ends.items())
    if told.size > 1 and len(set(ends.values())) == 1:
        spread = f"{next(iter(ends.values()))} in {told.size} bands"
    return f"{title} {spread}, {data.signed(weighted)} dB(A)"


def _others_drawn(of: ComparedRuns) -> str:
    """Runs for which another texture was drawn than for the first; empty if there is none."""
    return " and ".join(name for r, name in enumerate(of.names) if of.another_texture(r))


def _chance(table: xarray.Dataset, run: int) -> Array:
    """Standard deviation of the level differences of a run to the first by chance, dB (bands,).

    Of records that know nothing of each other; runs over the same texture differ by less.
    """
    deviation = table[DEVIATION].values
    return np.sqrt(deviation[0] ** 2 + deviation[run] ** 2)


def _sure(table: xarray.Dataset, run: int) -> Flags:
    """Bands whose difference to the first run says something; all where no chance is known."""
    return ~(_chance(table, run) >= SURE)


# --- figures

RUN_COLOURS = (INK, chart.VERMILLION, chart.BLUE, chart.GREEN, "#a8458f", "#96700a", "#2a93c4", "#6f7a85")
RUN_DASHES = ((), (5, 1.5), (2, 1), (6, 1.5, 1, 1.5))
MOST_RUNS = len(RUN_COLOURS)
"""That can be told apart."""


def _of_run(of: ComparedRuns, number: int, x: Array, y: Array, marker: str = "o") -> Line:
    """A line of a run by its number, from 0."""
    dashes = RUN_DASHES[number % len(RUN_DASHES)]
    return Line(x, y, of.names[number], RUN_COLOURS[number], dashes, 1.6, marker)


def _level(of: ComparedRuns, name: str) -> Drawn:
    """A level of all runs by their first law, and the differences to the first run.

    Of two runs the differences of all laws are drawn, in their looks; of more runs those of the first law.
    """
    level = of.table[name].values
    difference = of.table[f"{name}_difference"].values
    band = of.table["band"].values
    runs = range(len(of.runs))
    main, *_ = of.laws
    above = tuple(_of_run(of, r, band, level[r, 0]) for r in runs)
    bands = panels.band_axis(band[np.isfinite(level).any(axis=(0, 1))])
    label = f"level of {main} / {data.written_units(of.table[name].attrs['units'])}"
    yield Panel(bands, panels.levels_axis(label, [level[:, 0]]), above, height=3.2)
    below: list[chart.Mark] = [panels.zero(colour=INK, width=0.8)]
    first, second, *others = of.names
    told = f"of {main} to {of.names[0]}"
    shaded = ""
    if others:
        below += [_of_run(of, r, band, difference[r, 0]) for r in runs[1:]]
    else:
        told = f"of all laws, {second} less {first}"
        shaded = (
            "Shaded: what two records differ by through chance alone, one standard deviation of the "
            "difference; runs over the same texture differ by less."
        )
        known = np.isfinite(by := _chance(of.table, 1))
        if known.any():
            edges = band[known] / panels.EDGE, band[known] * panels.EDGE, -by[known], by[known]
            below.append(
                chart.Boxes(*edges, label="± one standard deviation, by chance", colour=MUTED, opacity=0.18)
            )
        looks = {law: data.law_style(of.runs[0].tree, law, main) for law in of.runs[0].laws}
        for law, change in zip(of.laws, difference[1], strict=True):
            if np.isfinite(change).any():
                below.append(Line(band, change, law, **looks.get(law, {"colour": MUTED})))
    yield Panel(bands, Axis(f"over {first} / dB"), tuple(below), height=2.8)
    yield f"Above, {of.table[name].attrs['long_name']}, of {main} in all runs; below, the differences {told}."
    yield shaded
    if drawn := _others_drawn(of):
        yield f"For {drawn} {ANOTHER}: every difference holds the chance of it."


def _contacts(of: ComparedRuns) -> Drawn:
    """Stiffness of all runs over the approach, and their filters at the working approach."""
    table = of.table
    lines = list[Line]()
    if "stiffness" in table:
        approach = table["approach"].values * 1e6
        stiffness = table["stiffness"].values
        unit, symbol = (1e9, "GN/m") if np.nanmax(stiffness) > 2e9 else (1e6, "MN/m")
        working = table[contact.WORKING_APPROACH.name].values * 1e6
        for r, found in enumerate(stiffness):
            kept = np.isfinite(found)
            if kept.any():
                line = _of_run(of, r, approach[kept], found[kept] / unit, marker="")
                at = working[r : r + 1]
                point = Line(at, np.interp(at, line.x, line.y), colour=line.colour, width=0, marker="o")
                lines += [line, point]
        up = Axis(f"contact stiffness k_c / ({symbol})", low=0.0)
        yield Panel(Axis("approach / µm"), up, tuple(lines), height=3.9)
    if "filter" in table:
        wavenumber = table["wavenumber"].values
        level = table["filter"].values
        known = np.isfinite(level)
        filters = [_of_run(of, r, wavenumber, each, "") for r, each in enumerate(level) if known[r].any()]
        kept = wavenumber[known.any(axis=0)]
        up = Axis("contact filter |H| / dB", max(float(np.nanmin(level)) - 2.0, -40.0), 3.0)
        along = panels.wavenumber_axis(kept[0], kept[-1])
        beside = bool(lines)
        yield Panel(along, up, tuple(filters), height=3.9, beside=beside, share=1.15 if beside else 1.0)
    yield (
        "Contact stiffness k_c = F/r over the approach of the surfaces, mean of the samples, a ring at "
        "the working approach; magnitude of the contact filter at the working approach of each run, as "
        "fitted."
    )


# --- the page


def _known(table: xarray.Dataset, names: Iterable[str]) -> bool:
    """Whether any run has any of some numbers."""
    return any(bool(table[name].notnull().any()) for name in names)


def comparison_page(of: ComparedRuns, file: str) -> str:
    """The whole page as one self-contained HTML text; `file` is the name of the CSV file beside it."""
    beside = {"all numbers (CSV)": file}
    return page.figures_page(
        f"Comparison of {' and '.join(of.names)}", summary(of), compared_blocks(of), beside
    )


def compared_blocks(of: ComparedRuns) -> list[page.Block]:
    """What the page shows: cases, what each run says, force, each level, contact."""
    found: list[page.Block] = [_runs_table(of), _case_table(of)]
    if BAND_VELOCITY.name in of.table:
        found.append(_velocity_table(of))
    if _known(of.table, _FORCE):
        found.append(_numbers_table(of.table))
    for name, title in of.levels.items():
        found += [PageFigure.of(name, capital(title), _level(of, name)), _difference_table(of, name)]
    if {"stiffness", "filter"} & set(of.table):
        found.append(PageFigure.of("stiffness_and_filter", "Stiffness and filter", _contacts(of)))
    return [*found, _contact_table(of)] if _known(of.table, (entry.name for entry in OF_CONTACT)) else found


# --- tables


def _case_table(of: ComparedRuns) -> ReportTable:
    """Keys whose values differ."""
    written = [["–" if value is None else value for value in item["values"]] for item in of.keys]
    rows = [text_cells([i["key"], *values, i["note"]]) for i, values in zip(of.keys, written, strict=True)]
    note = (
        "All other keys that the runs share have the same values."
        if rows
        else "All keys have the same values in all runs."
    )
    return ReportTable("keys", "Keys that differ", ["key", *of.names, "what it is"], rows, note)


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
    law, run = np.nonzero(shown)
    columns = {
        "law": text_cells(table["law"].values[law], "name"),
        "run": text_cells(table["run"].values[run], "name"),
        **{head: number_cells(found[name][shown], write) for name, (head, write) in _FORCE.items()},
    }
    return tables.table("numbers", "By law and run", columns)


def _difference_table(of: ComparedRuns, name: str) -> ReportTable:
    """Differences to the first run in each band, and of the A-weighted totals."""
    table = of.table
    first, *others = of.names
    difference = table[f"{name}_difference"].values
    weighted = table[f"{name}_a_difference"].values
    kept = np.isfinite(difference[1:]).any(axis=(0, 1))
    bands = number_cells(table["band"].values[kept], data.nominal_band)
    columns: dict[str, list[Cell]] = {"band / Hz": [*bands, *text_cells(["dB(A)"], "total")]}
    for r, k in np.argwhere(np.isfinite(difference).any(axis=2)).tolist():
        if r > 0:
            head = of.laws[k] if len(others) == 1 else f"{of.names[r]}: {of.laws[k]}"
            another = of.another_texture(r)
            cells = tables.change_cells(difference[r, k, kept], ~_sure(table, r)[kept] | another)
            total = tables.change_cells(weighted[r, k : k + 1], np.array([another]), np.inf, np.inf)
            columns[head] = [*cells, *(replace(cell, look=f"{cell.look} total") for cell in total)]
    over = f"{others[0]} less {first}" if len(others) == 1 else f"less {first}"
    note = (
        "Shaded: more than 1 dB, more than 3 dB. In brackets: bands in which records of this "
        "length differ by 2 dB or more through chance alone. Last row: A-weighted, over the bands of both."
    )
    if drawn := _others_drawn(of):
        note += f" All of {drawn} is in brackets: {ANOTHER}."
    title = f"{capital(of.levels[name])}, {over}, in dB"
    return tables.table(f"{name}_difference", title, columns, note)


def _velocity_table(of: ComparedRuns) -> ReportTable:
    """Velocities of bearings in the bands in which they are judged, a row for each law and run."""
    velocity = of.table[BAND_VELOCITY.name]
    change = of.table[f"{BAND_VELOCITY.name}_difference"].values
    law, run = np.nonzero(np.isfinite(velocity.values).any(axis=2).T)
    columns = {
        "law": text_cells(of.table["law"].values[law], "name"),
        "run": text_cells(of.table["run"].values[run], "name"),
    }
    for n, band in enumerate(map(str, of.table[JUDGED_BAND.name].values)):
        columns[f"{band}, µm/s"] = number_cells(1e6 * velocity.values[run, law, n], in_digits(3))
        less = [data.signed(each) if r else "–" for r, each in zip(run, change[run, law, n], strict=True)]
        columns[f"{band}, over {of.names[0]}, dB"] = text_cells(less, "number")
    note = "Rms radial velocity at the first accelerometer, and 20 lg of its ratio to the first run."
    return tables.table("judged_bands", "Velocities in the bands of ISO 15242-2", columns, note)


def _contact_table(of: ComparedRuns) -> ReportTable:
    """Load, approach, stiffness and real contact of each run."""
    table = of.table
    load, approach, stiffness, area = (table[entry.name].values for entry in OF_CONTACT)
    ratio = [f"{data.signed(each)} dB" for each in table["working_stiffness_difference"].values[1:]]
    ratio = [f"({each})" if of.another_texture(r) else each for r, each in enumerate(ratio, 1)]
    columns = {
        "run": text_cells(table["run"].values),
        "load": number_cells(load, "N"),
        "approach under it": number_cells(approach, "m"),
        "stiffness dF/dr": number_cells(stiffness, "N/m"),
        "20 lg of its ratio to the first": text_cells(["–", *ratio], "number"),
        "real over smooth contact area": number_cells(area, data.in_percent),
    }
    return tables.table("working_point", "Under the load", columns)


_PROVENANCE = {
    "what it says": provenance.VERDICT,
    "what was rolled": provenance.TITLE,
    "kind": provenance.KIND,
    "asperity": provenance.ASPERITY_VERSION,
    "made": provenance.CREATED,
    "seed": provenance.SEED,
}


def _runs_table(of: ComparedRuns) -> ReportTable:
    """What the runs say, how far they are valid, and where they come from."""
    columns = {"run": text_cells(of.names)}
    for head, attribute in _PROVENANCE.items():
        told = (data.stated(run.tree, attribute) for run in of.runs)
        columns[head] = text_cells(data.moment("" if each is None else each) for each in told)
    valid = (headline.validity(headline.lights(run.tree)).quantity for run in of.runs)
    columns["validity"] = text_cells(valid)
    note = "Differences are to the first run."
    note += f" “{MAIN}” stands for the first law of each run." if of.laws[:1] == [MAIN] else ""
    return tables.table("runs", "Runs", columns, note)
