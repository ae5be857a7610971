"""Compute a study into a folder: its table as netCDF and CSV, and what members met on the way."""

from __future__ import annotations

import io
import json
from collections.abc import Sequence
from contextlib import AbstractContextManager, nullcontext, suppress
from itertools import product
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from asperity.arguments import shown
from asperity.comma_separated import write_csv
from asperity.errors import InputError
from asperity.files import alone_in, refuse_unwritable, write_bytes
from asperity.progress import progress_bar
from asperity.studies.definition import Study, study_of
from asperity.terminal import say, say_table

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
) -> None:
    """Compute a study and write ``study.nc`` and ``study.csv`` to a folder.

    Either processes of this machine compute it, one per processor by default, or the workers of the Dask
    scheduler at an address. `overwrite` says whether another study in the folder may be replaced.
    """
    if scheduler is not None and workers is not None:
        raise InputError("--workers", "a number beside --scheduler", "one of them")
    refuse_unwritable(directory, "folder of the results", "Choose another folder with -o.")
    with alone_in(directory):
        if not overwrite:
            _refuse_to_overwrite(study, directory)
        _study_alone(study, directory, workers, scheduler)


def _study_alone(study: Study, directory: Path, workers: int | None, scheduler: str | None) -> None:
    """Compute a study and write its table, while no other run does into this folder."""
    from xarray import DataTree

    from asperity.results import save
    from asperity.studies.cluster import cluster
    from asperity.studies.running import study as computed

    size = " × ".join(f"{len(axis.values)} {axis.name}" for axis in study.axes)
    say(f"Study of {size}", err=True)
    place: AbstractContextManager[Executor | None] = nullcontext()
    if scheduler is not None:
        place = cluster(scheduler)
    with place as executor, progress_bar() as progress:
        table = computed(study, executor=executor, workers=workers, progress=progress)
    _show(table)
    _report(table)
    written = save(DataTree(table), directory / "study.nc")
    rows = write_csv(directory / "study.csv", *_table(table))
    say(f"Results: {written.resolve()}")
    say(f"Table:   {rows.resolve()}")
    _ensemble(table, directory)


def _ensemble(table: xarray.Dataset, directory: Path) -> None:
    """Write mean and band over the seeds of a study, if it sweeps them, as CSV and as a figure."""
    from asperity.laws import spec_of
    from asperity.reporting.ensemble import ensemble_figure
    from asperity.studies.ensemble import FEWEST, prediction_band

    files = [directory / name for name in ("ensemble.csv", "ensemble.png")]
    if table.sizes.get("seed", 0) < FEWEST:
        for file in files:  # of an earlier study
            file.unlink(missing_ok=True)
        return
    bands = prediction_band(table)
    colours = {str(law): str(spec_of(str(law)).entry()["colour"]) for law in bands["law"].values}
    swept = [name for name in json.loads(table.attrs["sweep"]) if name != "seed"]
    write_csv(files[0], *_long_table(bands, [*swept, "law", "band"]))
    image = io.BytesIO()
    ensemble_figure(bands, colours).savefig(image, format="png", dpi=150)
    write_bytes(files[1], image.getvalue())
    say(f"Seeds:   {files[1].resolve()}, and as numbers {files[0].name}")
    say(str(bands.attrs["meaning"]))


def _long_table(bands: xarray.Dataset, axes: Sequence[str]) -> tuple[list[str], list[list[object]]]:
    """Heading and rows of what has all these axes, one row for each place on them."""
    held = {
        str(name): values.transpose(*axes)
        for name, values in bands.data_vars.items()
        if set(values.dims) == set(axes)
    }
    heading = [_titled(bands[axis]) for axis in axes] + [_titled(values) for values in held.values()]
    labels = [bands[axis].values.tolist() for axis in axes]
    numbers = [values.values.ravel().tolist() for values in held.values()]
    rows: list[list[object]] = [
        [*place, *found] for place, found in zip(product(*labels), zip(*numbers, strict=True), strict=True)
    ]
    return heading, rows


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


def _table(found: xarray.Dataset, *, bands: bool = True) -> tuple[list[str], list[list[object]]]:
    """Heading and rows of a study, with or without the quantities that have bands."""
    axes = [*json.loads(found.attrs["sweep"]), *(["law"] if "law" in found.dims else [])]
    heading = [_titled(found[axis]) for axis in axes]
    chosen: list[tuple[list[str], NDArray[Any]]] = []
    for name, values in found.data_vars.items():
        others = [str(dim) for dim in values.dims if dim not in axes]
        if len(others) > (1 if bands else 0):
            continue
        own = [axis for axis in axes if axis in values.dims]
        chosen.append((own, values.transpose(*own, *others).values))
        if not others:
            heading.append(_titled(values))
        for place in found[others[0]].values.tolist() if others else ():
            shown = place if isinstance(place, str) else f"{place:.6g} {_unit(found[others[0]])}".strip()
            heading.append(f"{name} {shown} [{values.attrs['units']}]")
    labels = {axis: found[axis].values.tolist() for axis in axes}
    rows: list[list[object]] = []
    for places in product(*(range(found.sizes[axis]) for axis in axes)):
        here = dict(zip(axes, places, strict=True))
        row: list[object] = [labels[axis][place] for axis, place in here.items()]
        for own, numbers in chosen:
            row += np.atleast_1d(numbers[tuple(here[axis] for axis in own)]).tolist()
        rows.append(row)
    return heading, rows


def _unit(values: xarray.DataArray) -> str:
    return "" if values.attrs["units"] == "1" else str(values.attrs["units"])


def _titled(values: xarray.DataArray) -> str:
    words = values.dtype.kind == "U"
    return str(values.name) if words else f"{values.name} [{values.attrs['units']}]"


def _show(found: xarray.Dataset) -> None:
    """Print the quantities of a study that have no bands."""
    heading, rows = _table(found, bands=False)
    shown = ([item if isinstance(item, str) else _short(item) for item in row] for row in rows[:MOST_ROWS])
    say_table("Study", heading, shown, width=200)
    if len(rows) > MOST_ROWS:
        say(f"… and {len(rows) - MOST_ROWS} more rows, in study.csv")


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
