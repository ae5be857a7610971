"""Compute a study into a folder: its table as netCDF and CSV, and what members met on the way."""

from __future__ import annotations

import json
from collections.abc import Sequence
from contextlib import AbstractContextManager, nullcontext, suppress
from pathlib import Path
from typing import TYPE_CHECKING, Any

from asperity.arguments import shown
from asperity.cli.study_files import SEED, write_ensemble, write_figures, write_mean
from asperity.comma_separated import write_csv
from asperity.errors import InputError
from asperity.files import alone_in, refuse_unwritable
from asperity.progress import progress_bar
from asperity.schema import rolling, spectra
from asperity.studies.columns import axes_of, columns_of
from asperity.studies.definition import Study, study_of
from asperity.studies.ensemble import SCATTER, mean_and_scatter
from asperity.terminal import remark, say, say_table

if TYPE_CHECKING:
    from concurrent.futures import Executor

    import xarray

MOST_ROWS = 60  # that are printed; the file has all of them
MOST_NAMED = 6  # members of a group of failures that are printed


def study_into(
    study: Study,
    directory: Path,
    *,
    workers: int | None = None,
    scheduler: str | None = None,
    overwrite: bool = False,
) -> dict[str, Any]:
    """Compute a study and write its tables and figures to a folder; return what a program wants to know.

    Either processes of this machine compute it, one per processor by default, or the workers of the Dask
    scheduler at an address. `overwrite` says whether another study in the folder may be replaced.
    """
    if scheduler is not None and workers is not None:
        raise InputError("--workers", "a number beside --scheduler", "one of them")
    refuse_unwritable(directory, "folder of the results", "Choose another folder with -o.")
    with alone_in(directory):
        if not overwrite:
            _refuse_to_overwrite(study, directory)
        return _study_alone(study, directory, workers, scheduler)


def _study_alone(study: Study, directory: Path, workers: int | None, scheduler: str | None) -> dict[str, Any]:
    """Compute a study and write its table, while no other run does into this folder."""
    from xarray import DataTree

    from asperity.results import save
    from asperity.studies.cluster import cluster
    from asperity.studies.running import study as computed

    size = " × ".join(f"{len(axis.values)} {axis.name}" for axis in study.axes)
    remark(f"Study of {size}")
    place: AbstractContextManager[Executor | None] = nullcontext()
    if scheduler is not None:
        place = cluster(scheduler)
    with place as executor, progress_bar() as progress:
        table = computed(study, executor=executor, workers=workers, progress=progress)
    means = mean_and_scatter(table) if table.sizes.get(SEED, 0) > 1 else None
    _show(table if means is None else means)
    _report(table)
    written = save(DataTree(table), directory / "study.nc")
    files = {"results": written, "table": write_csv(directory / "study.csv", *columns_of(table))}
    say(f"Results: {written.resolve()}")
    say(f"Table:   {files['table'].resolve()}")
    files |= write_mean(means, directory) | write_figures(table, means, directory)
    files |= write_ensemble(table, directory)
    heading, rows = columns_of(table, bands=False)
    return {
        "sweep": study.sweep,
        "members": int(table["completed"].size),
        "completed": int(table["completed"].sum()),
        "columns": heading,
        "rows": rows,
        "warnings": json.loads(table.attrs["warnings"]),
        "failures": json.loads(table.attrs["failures"]),
        "files": {name: str(path.resolve()) for name, path in files.items()},
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
        sweep[name] = [_value(each.strip()) for each in values.split(",")]
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
    import xarray

    try:
        with xarray.open_dataset(file, engine="h5netcdf") as found:
            earlier = dict(found.attrs)
            swept = json.loads(earlier["sweep"])
    except Exception:  # h5py and xarray raise errors of many kinds on damaged files
        earlier, swept = {}, None
    if earlier.get("case") != study.text or swept != study.sweep:
        remedy = "Choose another folder with -o, or replace it with --overwrite."
        allowed = "a new folder, or the folder of the same study"
        raise InputError(str(directory), "the study.nc of another study", allowed, remedy)


OVER = f"{spectra.FORCE_LEVEL.name}_a_difference_to_"
PRINTED = (
    f"{spectra.FORCE_LEVEL.name}_a",
    f"{OVER}linear_filtered",
    f"{OVER}linear",
    "rms_force",
    "peak_force",
    rolling.CONTACT_LOSS_SHARE.name,
)
"""Quantities that are printed; the file has all."""


def _show(found: xarray.Dataset) -> None:
    """Print the quantities that matter most, with ± where they are means over seeds."""
    names = [name for name in PRINTED if name in found]
    held = [name for name in (*names, *(f"{name}{SCATTER}" for name in names)) if name in found]
    heading, rows = columns_of(found[held].assign_attrs(found.attrs), bands=False)
    heading = [title.replace(OVER, "dB(A) over ") for title in heading]  # as wide as its numbers
    keys = len(axes_of(found))
    paired = len(held) > len(names)
    shown = [_printed_row(row, keys, paired=paired) for row in rows[:MOST_ROWS]]
    title = "Study"
    if paired:
        heading = [*heading[:keys], *heading[keys::2]]
        title = (
            f"Study: mean ± standard deviation over {found.attrs['members']} values of {found.attrs['over']}"
        )
    say_table(title, heading, shown, width=200)
    if len(rows) > MOST_ROWS:
        say(f"… and {len(rows) - MOST_ROWS} more rows, in study.csv")


def _printed_row(row: Sequence[object], keys: int, *, paired: bool) -> list[str]:
    words = [item if isinstance(item, str) else _short(item) for item in row]
    if not paired:
        return words
    pairs = zip(words[keys::2], words[keys + 1 :: 2], strict=True)
    return [*words[:keys], *(mean if scatter == "–" else f"{mean} ± {scatter}" for mean, scatter in pairs)]


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
