"""What a study writes beside its table: means over seeds, an ensemble's band, a page of figures."""

from __future__ import annotations

import json
from collections.abc import Iterator, Sequence
from contextlib import AbstractContextManager, nullcontext, suppress
from pathlib import Path
from typing import TYPE_CHECKING, Any

import xarray

from asperity.arguments import shown
from asperity.errors import InputError
from asperity.files import alone_in, discard, final_place, refuse_unwritable, together, write_bytes
from asperity.laws import spec_of
from asperity.progress import progress_bar
from asperity.reporting.data import read_entries
from asperity.reporting.page import PageFigure, figures_page
from asperity.reporting.payload import chart_tables
from asperity.reporting.study_figures import ensemble_chart, key_caption, key_chart
from asperity.studies.definition import Study, separated, study_of
from asperity.studies.ensemble import FEWEST, SCATTER, mean_and_scatter, prediction_band
from asperity.studies.member import PLACES, names_kept
from asperity.studies.table import OVER, USUAL, USUAL_IN_FIGURES, axes_of, chosen, columns_of, long_columns
from asperity.terminal import line_width, remark, say, say_table
from asperity.text_files import write_csv

if TYPE_CHECKING:
    from concurrent.futures import Executor

    import xarray

SEED = "seed"
"""The key by which members differ by chance alone."""
NOT_ALWAYS = ("study_mean.csv", "ensemble.csv", "study.html")
"""What not every study writes: that of an earlier one goes."""


def write_mean(means: xarray.Dataset | None, directory: Path) -> dict[str, Path]:
    """Write mean and standard deviation over the seeds, if they were swept."""
    path = directory / "study_mean.csv"
    if means is None:
        return {}
    write_csv(path, *columns_of(means))
    over = f"{means.attrs['members']} values of {SEED}"
    say(f"Means:   {final_place(path).resolve()}, over {over}, ± their standard deviation")
    return {"mean": path}


def write_ensemble(bands: xarray.Dataset | None, directory: Path) -> dict[str, Path]:
    """Write mean and band over the seeds of a study, if it sweeps enough of them."""
    if bands is None:
        return {}
    file = directory / "ensemble.csv"
    swept = [str(name) for name in bands["force_level"].dims if name not in ("law", "band")]
    write_csv(file, *long_columns(bands, [*swept, "law", "band"]))
    say(f"Seeds:   {final_place(file).resolve()}")
    say(str(bands.attrs["meaning"]))
    return {"ensemble": file}


def band_over_seeds(table: xarray.Dataset) -> xarray.Dataset | None:
    """Mean and band of levels over the seeds of a study, if it sweeps enough of them."""
    return prediction_band(table) if table.sizes.get(SEED, 0) >= FEWEST else None


def write_study_page(
    table: xarray.Dataset,
    means: xarray.Dataset | None,
    bands: xarray.Dataset | None,
    names: Sequence[str],
    directory: Path,
) -> dict[str, Path]:
    """Write figures on a page: of quantities by name over each swept key, and of the band over seeds."""
    laws = read_entries(spec_of(str(law)).entry() for law in table["law"].values)
    looks = {name: law.style(1.6) | {"marker": law.marker} for name, law in laws.items()}
    figures = _key_figures(table, means, names, looks)
    if bands is not None:
        chart = ensemble_chart(bands, looks)
        told = "Contact force over the seeds", str(bands.attrs["meaning"])
        figures.append(PageFigure("ensemble", *told, chart, chart_tables(chart), "ensemble.csv"))
    if not figures:
        return {}
    swept = " × ".join(f"{table.sizes[name]} values of {name}" for name in json.loads(table.attrs["sweep"]))
    done, count = int(table["completed"].sum()), table["completed"].size
    summary = swept if done == count else f"{swept}; {done} of {count} members completed"
    held = {
        "table (CSV)": "study.csv",
        "means over seeds (CSV)": "study_mean.csv",
        "band over seeds (CSV)": "ensemble.csv",
        "results (netCDF)": "study.nc",
    }
    files = {what: file for what, file in held.items() if (directory / file).exists()}
    path = directory / "study.html"
    write_bytes(path, figures_page("Study", summary, figures, files).encode())
    say(f"Page:    {final_place(path).resolve()}")
    return {"page": path}


def _key_figures(
    table: xarray.Dataset,
    means: xarray.Dataset | None,
    names: Sequence[str],
    looks: dict[str, dict[str, Any]],
) -> list[PageFigure]:
    """A figure for each swept key that is more than chance."""
    shown, scatter = table, None
    if means is not None:
        held = [str(name) for name in means.data_vars if str(name).endswith(SCATTER)]
        shown = means.drop_vars(held)
        scatter = means[held].rename({name: name.removesuffix(SCATTER) for name in held})
    swept = [key for key in json.loads(table.attrs["sweep"]) if shown.sizes.get(key, 0) > 1]
    charts = {key: key_chart(shown, scatter, key, looks, names) for key in swept}
    return [
        PageFigure(f"key-{key}", f"Over {key}", key_caption(shown, scatter, key), chart, chart_tables(chart))
        for key, chart in charts.items()
    ]


MOST_ROWS = 60  # that are printed; the file has all of them
FOLDED = 14  # characters of a line of a heading
WIDTH = 200  # characters of a line where standard output is no terminal
MOST_NAMED = 6  # members of a group of failures that are printed


def study_into(
    study: Study,
    directory: Path,
    *,
    workers: int | None = None,
    scheduler: str | None = None,
    overwrite: bool = False,
    show: Sequence[str] = (),
) -> dict[str, Any]:
    """Compute a study and write its tables and figures to a folder; return what a program wants to know.

    Either processes of this machine compute it, one per processor by default, or the workers of the Dask
    scheduler at an address. `overwrite` says whether another study in the folder may be replaced, `show`
    names what is printed and drawn instead of what is usual.
    """
    asked = chosen(show)
    if scheduler is not None and workers is not None:
        raise InputError("--workers", "a number beside --scheduler", "one of them")
    refuse_unwritable(directory, "folder of the results", "Choose another folder with -o.")
    with alone_in(directory):
        if not overwrite:
            _refuse_to_overwrite(study, directory)
        return _study_alone(study, directory, workers, scheduler, asked)


def _study_alone(
    study: Study, directory: Path, workers: int | None, scheduler: str | None, asked: tuple[str, ...]
) -> dict[str, Any]:
    """Compute a study and write its table, while no other run does into this folder."""
    from xarray import DataTree

    from asperity.results import save
    from asperity.studies.cluster import cluster
    from asperity.studies.running import study as computed

    remark(f"Study of {' × '.join(f'{len(axis.values)} {axis.name}' for axis in study.axes)}")
    place: AbstractContextManager[Executor | None] = nullcontext()
    if scheduler is not None:
        place = cluster(scheduler)
    with place as executor, progress_bar() as progress:
        table = computed(study, executor=executor, workers=workers, progress=progress)
    means = mean_and_scatter(table) if table.sizes.get(SEED, 0) > 1 else None
    names = asked or USUAL
    _show(table if means is None else means, names, asked=bool(asked))
    for name in asked:
        if name not in table:
            say(
                f"{name}: no member has it; there {names_kept()[name] or 'are no bands to add up'}",
                err=True,
            )
    _report(table)
    with together(directory, last="study.nc") as new:
        files = {"results": save(DataTree(table), new / "study.nc")}
        files["table"] = write_csv(new / "study.csv", *columns_of(table))
        say(f"Results: {final_place(files['results']).resolve()}")
        say(f"Table:   {final_place(files['table']).resolve()}")
        bands = band_over_seeds(table)
        files |= write_mean(means, new) | write_ensemble(bands, new)
        files |= write_study_page(table, means, bands, asked or USUAL_IN_FIGURES, new)
        for file in (each for pattern in NOT_ALWAYS for each in directory.glob(pattern)):
            if not (new / file.name).exists():
                discard(file)
    told = table[[name for name in asked if name in table]].assign_attrs(table.attrs) if asked else table
    heading, rows = columns_of(told, bands=bool(asked))
    return {
        "sweep": study.sweep,
        "members": int(table["completed"].size),
        "completed": int(table["completed"].sum()),
        "columns": heading,
        "rows": rows,
        "warnings": json.loads(table.attrs["warnings"]),
        "failures": json.loads(table.attrs["failures"]),
        "files": {name: str(final_place(path).resolve()) for name, path in files.items()},
    }


def varied(case: Path, words: Sequence[str]) -> Study:
    """Make a study of a case from the words of the command line, each ``KEY=VALUE, VALUE, …``."""
    sweep: dict[str, list[Any]] = {}
    for word in words:
        name, mark, values = (part.strip() for part in word.partition("="))
        if not mark or not name:
            remedy = "Write, for instance, --vary 'speed = 20 m/s, 200 km/h'."
            raise InputError("--vary", shown(word), "a key of the case, =, and its values", remedy)
        if name in sweep:
            raise InputError(
                "--vary", f"{name} more than once", "each key once", "Put all values behind one."
            )
        sweep[name] = [_value(each) for each in separated(values)]
    return study_of(case, sweep)


def _value(word: str) -> Any:
    """A number or a truth value as such, as TOML would read it; anything else as text."""
    if word in ("true", "false"):
        return word == "true"
    try:
        return int(word)
    except ValueError:
        with suppress(ValueError):
            return word if "inf" in word.lower() else float(word)
    return word


def _refuse_to_overwrite(study: Study, directory: Path) -> None:
    """Let a study replace its own table; another one in the folder stays."""
    file = directory / "study.nc"
    if not file.exists():
        return
    from asperity.results import attributes_of

    try:
        earlier = attributes_of(file)
        swept = json.loads(earlier["sweep"])
    except (InputError, ValueError, KeyError, TypeError):  # damaged, or of another kind
        earlier, swept = {}, None
    if earlier.get("case") != study.text or swept != study.sweep:
        remedy = "Choose another folder with -o, or replace it with --overwrite."
        allowed = "a new folder, or the folder of the same study"
        raise InputError(str(directory), "the study.nc of another study", allowed, remedy)


def _show(found: xarray.Dataset, names: Sequence[str], *, asked: bool) -> None:
    """Print quantities by name, with ± where they are means over seeds.

    Unasked, neither what is missing throughout nor what each place on a body has for itself.
    """
    held = [name for name in names if name in found and (asked or not {*PLACES} & {*found[name].dims})]
    heading, rows = columns_of(found[held])
    scatter = [f"{name}{SCATTER}" for name in held if f"{name}{SCATTER}" in found]
    spread: list[list[object]] = [[""] * len(row) for row in rows]
    title = "Study"
    if scatter:
        names_of = {name: name.removesuffix(SCATTER) for name in scatter}
        spread = columns_of(found[scatter].rename(names_of))[1]
        title = (
            f"Study: mean ± standard deviation over {found.attrs['members']} values of {found.attrs['over']}"
        )
    keys = len(axes_of(found[held]))
    words = [_printed_row(*pair, keys) for pair in zip(rows, spread, strict=True)]
    heading[keys:] = [each.replace(OVER, "dB(A) over ").replace("_", " ") for each in heading[keys:]]
    kept = [n for n in range(len(heading)) if asked or any(row[n] != "–" for row in words)]
    needs = [_width(heading[n], [row[n] for row in words[:MOST_ROWS]]) for n in range(len(heading))]
    for columns in _side_by_side(needs, kept, keys):
        shown = [[row[n] for n in columns] for row in words[:MOST_ROWS]]
        widths = [needs[n] for n in columns]
        say_table(title, [heading[n] for n in columns], shown, width=WIDTH, widths=widths)
    if len(rows) > MOST_ROWS:
        say(f"… and {len(rows) - MOST_ROWS} more rows, in study.csv")


def _width(heading: str, cells: Sequence[str]) -> int:
    """Characters that a column needs: cells and the words of its heading stay whole."""
    longest = max(map(len, (*heading.split(), *cells)))
    return min(max(longest, FOLDED), len(heading)) if longest < len(heading) else longest


def _side_by_side(needs: Sequence[int], kept: Sequence[int], keys: int) -> Iterator[list[int]]:
    """Columns that one table is wide enough for; what is swept stands in each table."""
    width = line_width(WIDTH)
    block = list(kept[:keys])
    for n in kept[keys:]:
        if len(block) > keys and 1 + sum(3 + needs[each] for each in (*block, n)) > width:
            yield block
            block = list(kept[:keys])
        block.append(n)
    yield block


def _printed_row(row: Sequence[object], scatter: Sequence[object], keys: int) -> list[str]:
    """What is swept, and numbers, each with its ± where it has one."""
    words, reach = ([each if isinstance(each, str) else _short(each) for each in of] for of in (row, scatter))
    numbers = zip(words[keys:], reach[keys:], strict=True)
    return [*words[:keys], *(f"{word} ± {by}" if by not in ("", "–") else word for word, by in numbers)]


def _short(number: object) -> str:
    return "–" if number != number else f"{number:.4g}"


def _report(found: xarray.Dataset) -> None:
    """Print what members met, each kind of warning and failure once."""
    count = found["completed"].size
    for warning in json.loads(found.attrs["warnings"]):
        grade = warning.get("grade", "warning").capitalize()
        say(f"{grade} ({warning['members']} of {count} members): {warning['message']}", err=True)
    for failure in json.loads(found.attrs["failures"]):
        names = failure["members"]
        say(f"Failed ({len(names)} of {count} members): {failure['message']}", err=True, lines=True)
        for name in names[:MOST_NAMED]:
            say(f"  - {name}", err=True)
        if len(names) > MOST_NAMED:
            say(f"  - and {len(names) - MOST_NAMED} more", err=True)
