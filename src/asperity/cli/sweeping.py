"""Compute one case at several speeds and loads, and tabulate what comes out."""

from __future__ import annotations

import csv
import io
import sys
from itertools import product
from pathlib import Path
from typing import TYPE_CHECKING

import click

from asperity.config import WheelOnRailCase
from asperity.errors import InputError
from asperity.progress import progress_bar
from asperity.store import atomic_write
from asperity.units import quantity

if TYPE_CHECKING:
    import xarray

    from asperity.config import Case

ROWS = ("law", "speed", "load")


def sweep_into(case: Case, speeds: str | None, loads: str | None, directory: Path, overwrite: bool) -> None:
    """Compute a case at several speeds and loads and write the results.

    Parameters
    ----------
    case : WheelOnRailCase
        The case.
    speeds, loads : str or None
        Values with units, with commas between them; None for the case's own.
    directory : Path
        Where ``sweep.nc`` and ``sweep.csv`` go.
    overwrite : bool
        Whether a sweep in `directory` may be replaced.

    Raises
    ------
    InputError
        If the case is of another kind, a value is wrong, or `directory` holds a sweep.
    """
    if not isinstance(case, WheelOnRailCase):
        raise InputError("kind", f"'{case.kind}'", '"wheel-on-rail"', "Only a wheel on a rail is swept.")
    if (directory / "sweep.nc").exists() and not overwrite:
        remedy = "Choose another folder with -o, or replace it with --overwrite."
        raise InputError(str(directory), "a sweep.nc", "a folder without a sweep", remedy)
    wanted_speeds = values_of(speeds, "m/s", "--speed") or [case.speed]
    wanted_loads = values_of(loads, "N", "--load") or [case.wheel.load]
    from xarray import DataTree

    from asperity.results import save
    from asperity.scenarios.sweep import sweep

    with progress_bar() as progress:
        found = sweep(case, wanted_speeds, wanted_loads, progress)
    _show(found)
    written = save(DataTree(found), directory / "sweep.nc")
    text = table_text(found)
    table = atomic_write(directory / "sweep.csv", lambda file: file.write(text.encode("utf-8")))
    click.echo(f"Results: {written.resolve()}")
    click.echo(f"Table:   {table.resolve()}")


def values_of(text: str | None, dimension: str, name: str) -> list[float]:
    """Read a list of quantities from the command line.

    Parameters
    ----------
    text : str or None
        Quantities with units, with commas between them.
    dimension : str
        Their SI unit.
    name : str
        The option, for messages.

    Returns
    -------
    list of float
        In SI, in the order given; empty without `text`.

    Raises
    ------
    InputError
        If a value has no unit, is not greater than 0 and finite, or stands there twice.
    """
    if text is None:
        return []
    values = []
    for item in text.split(","):
        try:
            value = quantity(item.strip(), dimension)
        except InputError as error:
            raise InputError(name, error.received, error.allowed, error.remedy) from None
        if not 0 < value < float("inf"):
            raise InputError(name, f"'{item.strip()}'", "finite values greater than 0")
        if value in values:
            raise InputError(name, f"'{item.strip()}' more than once", "each value once")
        values.append(value)
    return values


def table_text(found: xarray.Dataset) -> str:
    """Write a sweep as comma-separated text.

    Parameters
    ----------
    found : Dataset
        What a sweep returned.

    Returns
    -------
    str
        One row per law, speed and load; one column per quantity, and per band where there are bands.
    """
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    heading, rows = _table(found)
    writer.writerow(heading)
    writer.writerows(rows)
    return text.getvalue()


def _table(found: xarray.Dataset, *, bands: bool = True) -> tuple[list[str], list[list[object]]]:
    """Heading and rows of a sweep, with or without the quantities that have bands."""
    axes = [axis for axis in ROWS if axis in found.dims]
    heading = [f"{axis} [{found[axis].attrs['units']}]" if axis != "law" else "law" for axis in axes]
    chosen = {}
    for name, values in found.data_vars.items():
        others = [dim for dim in values.dims if dim not in ROWS]
        if others and (not bands or len(others) > 1):
            continue
        chosen[name] = others
        units = values.attrs["units"]
        if not others:
            heading.append(f"{name} [{units}]")
        for place in found[others[0]].values if others else ():
            shown = place if isinstance(place, str) else f"{place:.6g} {found[others[0]].attrs['units']}"
            heading.append(f"{name} {shown} [{units}]")
    rows: list[list[object]] = []
    for places in product(*(found[axis].values.tolist() for axis in axes)):
        here = dict(zip(axes, places, strict=True))
        row: list[object] = list(places)
        for name, others in chosen.items():
            one = found[name].sel({axis: here[axis] for axis in axes if axis in found[name].dims}).values
            row += one.tolist() if others else [one.item()]
        rows.append(row)
    return heading, rows


def _show(found: xarray.Dataset) -> None:
    """Print the quantities of a sweep that have no bands."""
    from rich.console import Console
    from rich.table import Table

    console = Console(file=sys.stdout)
    if not console.is_terminal:
        console.width = 160
    heading, rows = _table(found, bands=False)
    table = Table(title="Sweep", title_justify="left")
    for name in heading:
        table.add_column(name)
    for row in rows:
        table.add_row(*(item if isinstance(item, str) else f"{item:.4g}" for item in row))
    console.print(table)
