"""Computes a study into a folder: its table, means and band over seeds, a page of figures; and prints it."""

import json
from collections.abc import Iterator, Sequence
from contextlib import nullcontext, suppress
from dataclasses import replace
from itertools import product
from pathlib import Path
from typing import Any

import xarray

from asperity import files
from asperity.arguments import require, shown
from asperity.case.toml import toml_text
from asperity.cli.commands import require_writable, taken_folder
from asperity.errors import CaseError, InputError
from asperity.laws import spec_of
from asperity.progress import progress_bar
from asperity.reporting import chart, data, page, study_figures
from asperity.reporting.figure import PageFigure
from asperity.reporting.tables import ReportTable, text_cells
from asperity.reporting.tables import table as report_table
from asperity.results import attributes_of, save
from asperity.scenes.figures.effects import Effects, effects_table
from asperity.schema.spectra import FORCE_LEVEL
from asperity.studies import table as tables
from asperity.studies.axes import AS_IT_IS, VARIANT
from asperity.studies.definition import Study, load_study, separated, study_of
from asperity.studies.effects import effects, judged_levels, what_helps
from asperity.studies.ensemble import FEWEST, SEED, mean_and_scatter, prediction_band
from asperity.studies.member import PLACES, VELOCITY_LEVEL
from asperity.studies.signals import SignalSet
from asperity.studies.words import MISSING, table_in_words
from asperity.terminal import line_width, remark, say, say_files, say_table
from asperity.text_files import write_csv
from asperity.written_numbers import count_of

RESULTS = "study.nc"
TABLE = "study.csv"
MEANS = "study_mean.csv"
BAND = "ensemble.csv"
PAGE = "study.html"
EFFECTS = "effects.csv"
OFFERED = {
    "effects": "effects (CSV)",
    "table": "table (CSV)",
    "mean": "means over seeds (CSV)",
    "ensemble": "band over seeds (CSV)",
    "results": "results (netCDF)",
}
"""What lies beside the page, in its words."""
MOST_ROWS = 60  # that are printed; the file has all of them
FOLDED = 14  # characters of a line of a heading
WIDTH = 200  # characters of a line where standard output is no terminal
MOST_NAMED = 6  # members of a group of failures that are printed


def run_study(
    study: Study,
    directory: Path,
    *,
    workers: int | None = None,
    scheduler: str | None = None,
    overwrite: bool = False,
    show: Sequence[str] = (),
    **signals: str | None,
) -> dict[str, Any]:
    """Compute a study and write its tables and figures to a folder; return what a program wants to know.

    Either processes of this machine compute it, one per processor by default, or the workers of the Dask
    scheduler at an address. `overwrite` says whether another study in the folder may be replaced, `show`
    names what is printed and drawn instead of what is usual. `signals` are those of `commands.SIGNALS`.
    """
    from asperity.studies.cluster import cluster
    from asperity.studies.running import study as computed

    asked = tables.chosen(show)
    heard = _signals(**signals)
    if scheduler is not None and workers is not None:
        raise InputError("--workers", "a number beside --scheduler", "one of them")
    require_writable(directory)
    with files.alone_in(directory):
        if not overwrite:
            _refuse_other(study, directory)
        drawn = f"; drawn: {', '.join(study.drawn)}" if study.draws else ""
        remark(f"Study of {' × '.join(f'{len(axis.values)} {axis.name}' for axis in study.axes)}{drawn}")
        place = nullcontext() if scheduler is None else cluster(scheduler)
        with place as executor, progress_bar() as progress:
            table = computed(study, executor=executor, workers=workers, progress=progress, signals=heard)
        several = table.sizes.get(SEED, 0)
        mean, scatter = mean_and_scatter(table) if several > 1 else (table, None)
        band = prediction_band(table) if several >= FEWEST and FORCE_LEVEL.name in table else None
        effect = effects(table) if VARIANT in table.dims and judged_levels(table) else None
        told, left = _by_place(table, effect)
        for words, found in told:
            print_effects(effects_table(found), words)
        if left:
            remark(left)
        if asked or not (told and _effects_say_all(table)):
            print_table(mean, asked or tables.USUAL, scatter, asked=bool(asked))
        for name in (name for name in asked if name not in table):
            say(f"{name}: no member has it", err=True)
        _print_messages(table, left_out=bool(told))
        written = _write(directory, table, mean, scatter, band, effect, asked)
        if heard is not None:
            written["labels"] = heard.labels_file
            say(f"Signals: {heard.labels_file.resolve()}", lines=True)
    chosen = table[[name for name in asked if name in table]].assign_attrs(table.attrs) if asked else table
    heading, rows = tables.columns_of(chosen, bands=bool(asked))
    return {
        "sweep": study.sweep,
        "draw": study.drawn,
        "members": int(table["completed"].size),
        "completed": int(table["completed"].sum()),
        "columns": heading,
        "rows": rows,
        "in_words": {place: of.in_words for place, of in told},
        "warnings": json.loads(table.attrs["warnings"]),
        "failures": json.loads(table.attrs["failures"]),
        "files": written,
    }


def _signals(signals: str | None = None, **how: str | None) -> SignalSet | None:
    """Signals that are asked for, by the words of the command line."""
    given = {name: word for name, word in how.items() if word is not None}
    for name in given if signals is None else ():
        option = f"--{name.replace('_', '-')}"
        raise InputError(option, "signals of no study", "it goes with --signals", "Say in which folder.")
    return None if signals is None else SignalSet(signals, **given)


def defined(study: Path, words: Sequence[str], drawn: Sequence[str], *, helps: bool) -> Study:
    """Read a study; or make one of a case by the words of the command line, each ``KEY=VALUE, VALUE, …``.

    With the ready list of what helps, if it is asked for; and with keys that are drawn, each ``KEY=SPAN``.
    """
    if not (words or drawn or helps):
        return load_study(study)
    vary = _by_key("--vary", words, "speed = 80, 200 km/h")
    sweep = {name: [_value(each) for each in separated(values)] for name, values in vary.items()}
    draw: dict[str, Any] = dict(_by_key("--draw", drawn, "radial = 50..500 N"))
    draw = {
        name: text if ".." in text or "±" in text else [_value(each) for each in separated(text)]
        for name, text in draw.items()
    }
    require(not (helps and draw), "--draw", "keys that are drawn", "none with --what-helps")
    return what_helps(study, sweep) if helps else study_of(study, sweep, draw)


def _by_key(option: str, words: Sequence[str], example: str) -> dict[str, str]:
    """Values of an option that may be repeated by their keys, each ``KEY=VALUES``."""
    found: dict[str, str] = {}
    for word in words:
        name, mark, values = (part.strip() for part in word.partition("="))
        if not mark or not name:
            remedy = f"Write, for instance, {option} '{example}'."
            raise InputError(option, shown(word), "a key of the case, =, and its values", remedy)
        if name in found:
            received = f"{name} more than once"
            raise InputError(option, received, "each key once", "Put all values behind one.")
        found[name] = values
    return found


def _value(word: str) -> Any:
    """A number or a truth value as such, as TOML would read it; anything else as text."""
    if word in ("true", "false"):
        return word == "true"
    for number in (int, float):
        with suppress(ValueError):
            return word if "inf" in word.lower() else number(word)
    return word


def _refuse_other(study: Study, directory: Path) -> None:
    """Let a study replace its own table; another one in the folder stays."""
    file = directory / RESULTS
    if not file.exists():
        return
    try:
        earlier = attributes_of(file)
        told = json.loads(earlier["sweep"]), json.loads(earlier["draw"])
        same = earlier.get("case") == study.text and told == (study.sweep, study.drawn)
    except (InputError, ValueError, KeyError, TypeError):  # damaged, or of another kind
        same = False
    if not same:
        raise taken_folder(directory, "the study.nc of another study", "study")


# --- files


def _write(
    directory: Path,
    table: xarray.Dataset,
    mean: xarray.Dataset,
    scatter: xarray.Dataset | None,
    band: xarray.Dataset | None,
    effect: xarray.Dataset | None,
    asked: Sequence[str],
) -> dict[str, Path]:
    """Write all that there is of a study, in place of an earlier one, and say where; return files by name."""
    names = {"results": RESULTS, "table": TABLE}
    with files.together(directory, last=RESULTS) as new:
        save(xarray.DataTree(table), new / RESULTS)
        write_csv(new / TABLE, *tables.columns_of(table))
        if scatter is not None:
            names["mean"] = MEANS
            write_csv(new / MEANS, *tables.columns_of(mean, scatter))
        if band is not None:
            names["ensemble"] = BAND
            axes = [str(name) for name in band["force_level"].dims if name not in ("law", "band")]
            write_csv(new / BAND, *tables.long_columns(band, [*axes, "law", "band"]))
        if effect is not None:
            names["effects"] = EFFECTS
            write_csv(new / EFFECTS, *tables.long_columns(effect, list(map(str, effect["effect"].dims))))
        told, left = _by_place(table, effect)
        blocks: list[page.Block] = [*_blocks(told, left)]
        blocks += _figures(mean, scatter, band, asked or tables.USUAL_IN_FIGURES)
        if table["completed"].any() and not (told and _effects_say_all(table)):
            blocks.append(_table(mean, asked or tables.USUAL))
        if blocks:
            names["page"] = PAGE
            beside = {words: names[what] for what, words in OFFERED.items() if what in names}
            lead = (told and told[0][1].best) or _summary(table, mean)
            text = page.figures_page("Study", lead, blocks, beside, _remake(table))
            files.write_bytes(new / PAGE, text.encode())
        for name in {MEANS, BAND, EFFECTS, PAGE} - set(names.values()):  # of an earlier study
            files.discard(directory / name)
    written = {what: directory / name for what, name in names.items()}
    say_files(written)
    return written


def _remake(table: xarray.Dataset) -> page.Remake:
    """The study as files that compute it again, whether it was one or a case with options."""
    study = {name: keys for name in ("sweep", "draw") if (keys := json.loads(table.attrs[name]))}
    study["sweep"].get(VARIANT, {}).pop(AS_IT_IS, None)  # which every study of variants has
    texts = {"case.toml": table.attrs["case"], "study.toml": toml_text({"case": "case.toml", **study})}
    return page.Remake("asperity study study.toml", texts)


def _summary(table: xarray.Dataset, mean: xarray.Dataset) -> str:
    """Say what was swept, how much of it was computed, and between what and what its first level lies."""
    values = {name: count_of(table.sizes[name], "value") for name in json.loads(table.attrs["sweep"])}
    swept = " × ".join(f"{count} of {name}" for name, count in values.items())
    done = int(table["completed"].sum())
    count = table["completed"].size
    told = swept if done == count else f"{swept}; {done} of {count_of(count, 'member')} completed"
    return f"{told}. {ends}" if (ends := study_figures.ends_in_words(mean, tables.LOUDNESS)) else told


def _table(mean: xarray.Dataset, names: Sequence[str]) -> ReportTable:
    """Numbers of a study: a row for each place on its axes, as the page has them on paper, too."""
    shown = [name for name in names if name in mean and not {*PLACES} & {*mean[name].dims}]
    heading, rows = tables.columns_of(mean[shown], bands=False)
    heads, cells = table_in_words(heading, rows[:MOST_ROWS], len(tables.axes_of(mean)))
    columns = {
        head: text_cells(column, "" if all(isinstance(row[n], str) for row in rows) else "number")
        for n, (head, column) in enumerate(zip(heads, zip(*cells, strict=True), strict=True))
        if any(cell != MISSING for cell in column)
    }
    note = f"{MOST_ROWS} of {len(rows)} rows; study.csv has all." if len(rows) > MOST_ROWS else ""
    return report_table("numbers", "Numbers of the study", columns, note)


def _figures(
    mean: xarray.Dataset, scatter: xarray.Dataset | None, band: xarray.Dataset | None, names: Sequence[str]
) -> list[PageFigure]:
    """A figure for each swept key that is more than chance, of quantities by name, and one of the band."""
    laws = data.read_entries(spec_of(str(law)).entry() for law in mean["law"].values)
    looks = {name: law.style(1.6) | {"marker": law.marker} for name, law in laws.items()}
    figures = []
    for key in json.loads(mean.attrs["sweep"]):
        if mean.sizes.get(key, 0) > 1 and (key != VARIANT or not _effects_say_all(mean)):
            for name, title, parts in study_figures.key_figures(mean, scatter, key, looks, names):
                figures.append(PageFigure.of(name, title, parts))
    if band is not None and VARIANT not in band.dims:
        parts = study_figures.ensemble_figure(band, looks)
        figures.append(PageFigure.of("ensemble", "Contact force over the seeds", parts, BAND))
    return figures


# --- what each variant does


def _effects_say_all(table: xarray.Dataset) -> bool:
    """Whether effects stand for all that is shown of variants: of bearings lines are shown as well."""
    return bool(judged_levels(table)) and VELOCITY_LEVEL not in table


def _by_place(table: xarray.Dataset, effect: xarray.Dataset | None) -> tuple[list[tuple[str, Effects]], str]:
    """Effects of variants for places on the other axes of a study, named, and how many of them are shown.

    None without variants.
    """
    if effect is None:
        return [], ""
    others = [key for key in json.loads(table.attrs["sweep"]) if key in effect.dims and key != VARIANT]
    places = list(product(*(range(effect.sizes[key]) for key in others)))
    shown = [places[n] for n in chart.spread(len(places), study_figures.MOST_PANELS)]
    ats = [dict(zip(others, place, strict=True)) for place in shown]
    words = [", ".join(f"{key} = {data.typed_words(effect[key])[n]}" for key, n in at.items()) for at in ats]
    found = zip(words, (Effects(effect.isel(at)) for at in ats), strict=True)
    left = chart.part_shown(len(shown), len(places), f"values of {' and '.join(others)}")
    return [(told, of) for told, of in found if of.parts], left  # none where the case as it is has failed


def _blocks(told: Sequence[tuple[str, Effects]], left: str) -> Iterator[ReportTable]:
    """A table of what each variant does."""
    for n, (words, of) in enumerate(told, 1):
        title = f"What helps, {words}" if words else "What helps?"
        found = effects_table(of)
        yield replace(found, name=f"effects-{n}", title=title, note=f"{found.note} {left}".rstrip())


def print_effects(found: ReportTable, words: str = "") -> None:
    """Print what each variant does, at a place on other axes that words name, and in which units."""
    rows = [[cell.text for cell in row] for row in found.rows]
    say_table(f"{found.title}{f', {words}' if words else ''}", found.head, rows, width=WIDTH)
    say(found.note)


# --- what is printed


def print_table(
    table: xarray.Dataset, names: Sequence[str], scatter: xarray.Dataset | None = None, *, asked: bool
) -> None:
    """Print quantities by name, with ± where they are means over seeds.

    Unasked, neither what is missing throughout nor what each place on a body has for itself.
    """
    shown = [name for name in names if name in table and (asked or not {*PLACES} & {*table[name].dims})]
    heading, rows = tables.columns_of(table[shown])
    keys = len(tables.axes_of(table[shown]))
    title = "Study"
    spread: list[list[object]] = []
    if scatter is not None:
        title = f"Study: mean ± standard deviation over {table.attrs['members']} values of {SEED}"
        spread = tables.columns_of(scatter[shown])[1]
    heads, cells = table_in_words(heading, rows[:MOST_ROWS], keys, spread[:MOST_ROWS])
    columns = [n for n in range(len(heads)) if asked or any(row[n] != MISSING for row in cells)]
    needs = [_width(heads[n], [row[n] for row in cells]) for n in range(len(heads))]
    for block in _side_by_side(needs, columns, keys):
        rows_of_block = [[row[n] for n in block] for row in cells]
        widths = [needs[n] for n in block]
        say_table(title, [heads[n] for n in block], rows_of_block, width=WIDTH, widths=widths)
    if len(rows) > MOST_ROWS:
        say(f"… and {len(rows) - MOST_ROWS} more rows, in study.csv")


def _width(heading: str, cells: Sequence[str]) -> int:
    """Characters that a column needs: cells and the words of its heading stay whole."""
    longest = max(map(len, (*heading.split(), *cells)))
    return min(max(longest, FOLDED), len(heading)) if longest < len(heading) else longest


def _side_by_side(needs: Sequence[int], columns: Sequence[int], keys: int) -> Iterator[list[int]]:
    """Columns that one table is wide enough for; what is swept stands in each table."""
    width = line_width(WIDTH)
    swept = list(columns[:keys])
    block = list(swept)
    for n in columns[keys:]:
        if len(block) > keys and 1 + sum(3 + needs[each] for each in (*block, n)) > width:
            yield block
            block = list(swept)
        block.append(n)
    yield block


def _print_messages(table: xarray.Dataset, *, left_out: bool) -> None:
    """Print what members met, each kind of warning and failure once, but for cases that were left out."""
    count = table["completed"].size
    for warning in json.loads(table.attrs["warnings"]):
        grade = warning.get("grade", "warning").capitalize()
        say(f"{grade} ({warning['members']} of {count_of(count, 'member')}): {warning['message']}", err=True)
    for failure in json.loads(table.attrs["failures"]):
        if left_out and failure["error"] == CaseError.__name__:
            continue  # the table of effects says so
        names = failure["members"]
        say(
            f"Failed ({len(names)} of {count_of(count, 'member')}): {failure['message']}",
            err=True,
            lines=True,
        )
        for name in names[:MOST_NAMED]:
            say(f"  - {name}", err=True)
        if len(names) > MOST_NAMED:
            say(f"  - and {len(names) - MOST_NAMED} more", err=True)
