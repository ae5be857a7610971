"""The report of a run of any kind: a page, and the numbers of its figures."""

from __future__ import annotations

import os
from pathlib import Path

from xarray import DataTree

from asperity.arguments import file_path, shown
from asperity.errors import InputError
from asperity.files import together, write_bytes
from asperity.reporting.figure import Figure, figure_format, write_columns, write_figures
from asperity.reporting.page import drawable_figures, page
from asperity.scenes.chapters import chapters_of

PAGE, SUMMARY = "report.html", "summary.html"


def figures_of(tree: DataTree) -> list[Figure]:
    """Figures that `tree` holds the data of, in the order of the page."""
    return drawable_figures(tree, chapters_of(tree))


def page_of(tree: DataTree, *, summary: bool = False) -> str:
    """The whole page of a run, see `asperity.reporting.page.page`."""
    return page(tree, chapters_of(tree), summary=summary)


def report(result: DataTree, path: str | os.PathLike[str], figures: str | None = None) -> Path:
    """Write the report of a run: one page, and the numbers (CSV) of each of its figures.

    Parameters
    ----------
    result : xarray.DataTree
        The result of a run. Whatever it lacks is left out of the report.
    path : path
        Folder that receives ``report.html`` and the files of the figures, or the page itself, ``….html``,
        beside which these are written. Folders are made where they are missing.
    figures : str, optional
        ``"svg"``, ``"pdf"`` or ``"png"``, to have each figure as a file, too.

    Returns
    -------
    Path
        The page.

    Raises
    ------
    InputError
        If `result` is none, `path` is no path, or `figures` no format.
    ComputationError
        If a file cannot be written.

    Examples
    --------
    >>> import asperity
    >>> page = asperity.report(asperity.run(case), "page")
    >>> page.name, len(list(page.parent.glob("*.csv"))) > 3  # one for each figure
    ('report.html', True)
    """
    if not isinstance(result, DataTree):
        raise InputError("result", shown(result), "what asperity.run or asperity.open_result returned")
    target = file_path("report", path, "the path of a folder, or of a page that ends in .html")
    if target.suffix.lower() != ".html":
        target /= PAGE
    format = None if figures is None else figure_format("figures", figures)
    with together(target.parent, last=target.name) as new:
        if format is not None:
            write_figures(result, figures_of(result), new, format)
        write_page(result, new / target.name)
    return target


def write_page(result: DataTree, target: Path) -> Path:
    """Write the page of a result and, beside it, the numbers of its figures."""
    collected = {figure.name: figure.collect(result) for figure in figures_of(result)}
    for name, lines in collected.items():
        write_columns(lines.columns, target.parent / f"{name}.csv")
    return write_bytes(target, page(result, chapters_of(result), collected).encode())


def write_summary(result: DataTree, target: Path) -> Path:
    """Write a summary of a result, on one sheet of paper."""
    return write_bytes(target, page_of(result, summary=True).encode())


def names_of_reports() -> list[str]:
    """Names of all files that a report may have, or that of an earlier version."""
    every = DataTree.from_dict({"/scenario": None, "/track": None})
    figures = [
        each for tree in (DataTree(), every) for chapter in chapters_of(tree) for each in chapter.figures
    ]
    return [PAGE, *dict.fromkeys(f"{each.name}.{ending}" for each in figures for ending in ("csv", "svg"))]
