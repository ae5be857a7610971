"""Runs beside each other: what differs between their cases and results, as data, page and table."""

import os
from collections.abc import Sequence
from pathlib import Path

import xarray
from xarray import DataTree

from asperity.arguments import file_path, shown
from asperity.errors import InputError
from asperity.files import together, write_bytes
from asperity.printable import printable
from asperity.reporting.comparison import ComparedRuns, NamedRun, compared
from asperity.reporting.comparison_page import MOST_RUNS, comparison_page, table_rows
from asperity.results import read_result
from asperity.scenes.schema import KEPT
from asperity.schema.spectra import FORCE_LEVEL
from asperity.text_files import csv_text


def compare(
    *results: DataTree | str | os.PathLike[str],
    names: Sequence[str] | None = None,
    laws: Sequence[str] = (),
    path: str | os.PathLike[str] | None = None,
) -> xarray.Dataset:
    """Compare runs: what differs in their cases, levels, force, loss of contact, stiffness and filters.

    Parameters
    ----------
    *results : xarray.DataTree or path
        Two to eight runs: what `asperity.run` or `asperity.open_result` returned, or a ``run.nc`` or its
        folder. All differences are to the first.
    names : sequence of str, optional
        What the runs are called; by default as their folders, or by number.
    laws : sequence of str
        Laws that are compared, the first as the main one; by default all that the runs have.
    path : path, optional
        Folder that receives ``comparison.html`` and ``comparison.csv``, or the page itself, ``….html``,
        beside which the table is written.

    Returns
    -------
    xarray.Dataset
        By run, law and band: every level that the runs have, as ``force_level`` in dB, ``…_difference`` to
        the first run in dB; by run and law ``…_a``, A-weighted totals in dB(A), ``…_a_difference`` over the
        bands that both runs have, ``mean_force``, ``rms_force``, ``peak_force`` in N, and the loss of
        contact; by run and approach ``stiffness`` k_c in N/m; by run and wavenumber ``filter``, the magnitude
        in dB at the working approach. The attribute ``cases`` is a JSON list of keys that differ. NaN where a
        run has no such value.

    Raises
    ------
    InputError
        If there are fewer than two runs or more than eight, one cannot be read, or names or laws do not fit.
    ComputationError
        If a file cannot be written.

    Notes
    -----
    Several accelerometers, or points on a rail, count by their energy mean. A level of a record varies by
    chance with a standard deviation of 4.34/√(B T) dB, its bandwidth times its averaging time; the
    difference of two independent records with the root of the sum of both squares.

    Examples
    --------
    >>> import asperity
    >>> quiet = asperity.run(case)
    >>> table = asperity.compare(quiet, asperity.run(case.with_(speed=2.0)), names=["slow", "fast"])
    >>> table["force_level_difference"].dims
    ('run', 'law', 'band')
    """
    found = comparison_of(results, names, laws)
    if path is not None:
        write_comparison(found, path)
    return found.table


def comparison_of(
    results: Sequence[DataTree | str | os.PathLike[str]],
    names: Sequence[str] | None = None,
    laws: Sequence[str] = (),
) -> ComparedRuns:
    """Read runs, name them so that they can be told apart, and compare all levels over bands."""
    allowed = f"two to {MOST_RUNS} runs"
    if not 2 <= len(results) <= MOST_RUNS:
        raise InputError("runs to compare", len(results), allowed, "Give a run.nc or its folder for each.")
    called = names_of(results) if names is None else [str(name) for name in names]
    if len(called) != len(results) or len(set(called)) != len(called):
        raise InputError("names", shown(list(called)), "one name for each run, each once")
    runs = [NamedRun(printable(name), _tree(result)) for name, result in zip(called, results, strict=True)]
    held = {name for run in runs for group in run.tree.children.values() for name in group.data_vars}
    levels = (e for e in KEPT if e.units.startswith("dB re") and e.dims[-1].endswith("band"))
    return compared(runs, [FORCE_LEVEL, *(entry for entry in levels if entry.name in held)], laws)


def _tree(result: object) -> DataTree:
    if isinstance(result, DataTree):
        return result
    return read_result(file_path("run", result, "a result, or the path of a run.nc or of its folder"))


def names_of(results: Sequence[object]) -> list[str]:
    """Call each run as its folder or file, with as much of the path as tells all apart."""
    paths = [_place(result, number) for number, result in enumerate(results, 1)]
    for depth in range(1, max(map(len, paths)) + 1):
        found = ["/".join(parts[-depth:]) for parts in paths]
        if len(set(found)) == len(found):
            return found
    return [f"{name} ({number})" for number, name in enumerate(found, 1)]


def _place(result: object, number: int) -> tuple[str, ...]:
    if not isinstance(result, str | os.PathLike):
        return (f"run {number}",)
    path = Path(result).absolute()
    return path.parent.parts if path.name == "run.nc" else (*path.parent.parts, path.stem or "run")


def write_comparison(of: ComparedRuns, path: str | os.PathLike[str]) -> tuple[Path, Path]:
    """Write page and table of a comparison; return where they are."""
    target = file_path("comparison", path, "the path of a folder, or of a page that ends in .html")
    if target.suffix.lower() != ".html":
        target /= "comparison.html"
    rows = target.with_suffix(".csv")
    with together(target.parent, last=target.name) as new:
        for file, text in ((rows, csv_text(*table_rows(of))), (target, comparison_page(of, rows.name))):
            write_bytes(new / file.name, text.encode("utf-8", errors="backslashreplace"))
    return target, rows
