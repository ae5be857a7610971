"""The report of a run of any kind: a page, and its figures as drawings and as numbers."""

from __future__ import annotations

import os
from collections.abc import Mapping
from pathlib import Path
from types import MappingProxyType

from xarray import DataTree

from asperity.arguments import file_path, shown
from asperity.errors import InputError
from asperity.files import together, write_bytes
from asperity.forked import in_processes
from asperity.kinds import KINDS
from asperity.printable import printable
from asperity.reporting.ahead import DrawnAhead
from asperity.reporting.chapter import Chapter
from asperity.reporting.csv_files import write_columns
from asperity.reporting.data import holds, stated
from asperity.reporting.page import Picture, drawable_parts, page, picture, sections
from asperity.reporting.part import Part
from asperity.schema.provenance import KIND


def chapters_of(tree: DataTree) -> tuple[Chapter, ...]:
    """Chapters for the kind of case that `tree` is the result of; where it does not say, that shows most."""
    kind = stated(tree, KIND)
    if kind in KINDS:
        return KINDS[kind].chapters
    return max(
        (kind.chapters for kind in KINDS.values()), key=lambda chapters: len(drawable_parts(tree, chapters))
    )


def parts_of(tree: DataTree) -> list[Part]:
    """Figures that `tree` holds the data of, in the order of the page."""
    return drawable_parts(tree, chapters_of(tree))


def page_of(tree: DataTree) -> str:
    """The whole page of a run, see `asperity.reporting.page.page`."""
    chapters = chapters_of(tree)
    return page(tree, chapters, sections(tree, chapters))


def report(result: DataTree, path: str | os.PathLike[str]) -> Path:
    """Write the report of a run: one page, and of each figure its drawing (SVG) and its numbers (CSV).

    Parameters
    ----------
    result : xarray.DataTree
        The result of a run. Whatever it lacks is left out of the report.
    path : path
        Folder that receives ``report.html`` and the files of the figures, or the page itself, ``….html``,
        beside which these are written. Folders are made where they are missing.

    Returns
    -------
    Path
        The page.

    Raises
    ------
    InputError
        If `result` is none, or `path` is no path.
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
        target /= "report.html"
    with together(target.parent, last=target.name) as new:
        write_page(result, new / target.name)
    return target


def draw_all(
    result: DataTree, processes: int = 1, ahead: Mapping[str, DrawnAhead] = MappingProxyType({})
) -> dict[str, Picture]:
    """Draw all figures of a result, by name, in so many processes, but for those that were drawn ahead."""
    parts = parts_of(result)
    drawn = {part.name: ahead[part.name] for part in parts if part.name in ahead}
    kept = {name: early.picture for name, early in drawn.items() if holds(result, early.looks)}
    # motion, with panels one above the other, takes longest: it should not be what is waited for at the end
    left = [part for part in reversed(parts) if part.name not in kept]
    found = in_processes(lambda part: picture(result, part).laid_out(), left, processes)
    return kept | {laid_out["name"]: Picture.read(laid_out) for laid_out in found}


def write_page(
    result: DataTree, target: Path, drawn: Mapping[str, Picture] | None = None, processes: int = 1
) -> Path:
    """Write the page of a result and, beside it, the drawings and numbers of its figures."""
    found = draw_all(result, processes) if drawn is None else drawn

    def write_files(part: Part) -> None:
        _write(target.parent / f"{part.name}.svg", found[part.name].file)
        write_columns(part.columns(result), target.parent / f"{part.name}.csv")

    in_processes(write_files, parts_of(result), processes)
    chapters = chapters_of(result)
    return _write(target, page(result, chapters, sections(result, chapters, found)))


def _write(path: Path, text: str) -> Path:
    return write_bytes(path, printable(text, lines=True).encode())


def names_of_reports() -> list[str]:
    """Names of all files that a report of any kind may have."""
    parts = (part for kind in KINDS.values() for chapter in kind.chapters for part in chapter.parts)
    return ["report.html", *(f"{part.name}.{ending}" for part in parts for ending in ("csv", "svg"))]
