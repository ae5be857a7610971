"""One self-contained page per run, and the numbers of its figures: sees results only.

| name | what |
|---|---|
| `write_report`, `remove_report` | ``report.html`` and one CSV file per figure |
| `surface_picture`, `lines_picture` | picture of a measured surface, or of lines side by side |
"""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    import os

    from matplotlib.figure import Figure
    from numpy.typing import NDArray
    from xarray import DataTree

__all__ = ["lines_picture", "remove_report", "surface_picture", "write_report"]


def write_report(tree: DataTree, directory: str | os.PathLike[str]) -> Path:
    """Write the report of a run: one page, and one CSV file per figure.

    Parameters
    ----------
    tree : xarray.DataTree
        The result of a run. Whatever it lacks is left out of the report.
    directory : path
        Folder that receives ``report.html`` and the CSV files; made if missing.

    Returns
    -------
    Path
        The page.

    Raises
    ------
    ComputationError
        If a file cannot be written.
    """
    from asperity.files import write_bytes
    from asperity.report.csv_files import write_csv
    from asperity.report.page import drawable_parts, page

    directory = Path(directory)
    text = page(tree)
    for part in drawable_parts(tree):
        write_csv(part.columns(tree), directory / f"{part.name}.csv")
    return write_bytes(directory / "report.html", text.encode("utf-8", errors="backslashreplace"))


def remove_report(directory: str | os.PathLike[str]) -> None:
    """Remove an earlier report, of any kind of case: it would not belong to the run beside it.

    Parameters
    ----------
    directory : path
        The folder; files of other names stay.
    """
    from contextlib import suppress

    directory = Path(directory)
    if not (directory / "report.html").exists():
        return
    from asperity.report.page import every_part

    for name in ["report.html", *(f"{part.name}.csv" for part in every_part())]:
        with suppress(OSError):
            (directory / name).unlink(missing_ok=True)


def surface_picture(heights: NDArray[Any], spacing: tuple[float, float], title: str) -> Figure:
    """Draw what a surface file holds: its map and the distribution of its heights.

    Parameters
    ----------
    heights : (nx, ny) array, or (n,) array for a line
        Heights in m, positive out of the material; NaN where missing.
    spacing : (float, float)
        Distance of neighbouring points along x and y in m.
    title : str
        Heading, as the name of the file.

    Returns
    -------
    matplotlib.figure.Figure
        Save it with ``savefig``.
    """
    from asperity.report.texture import surface_picture as draw

    return draw(heights, spacing, title)


def lines_picture(lines: Sequence[NDArray[Any]], spacing: float, title: str) -> Figure:
    """Draw lines that were measured side by side, and the distribution of their heights.

    Parameters
    ----------
    lines : sequence of (n,) arrays
        Levelled heights in m, positive out of the material; NaN where missing.
    spacing : float
        Distance of neighbouring points along the lines in m.
    title : str
        Heading, as the name of the file.

    Returns
    -------
    matplotlib.figure.Figure
        Save it with ``savefig``.
    """
    from asperity.report.texture import lines_picture as draw

    return draw(lines, spacing, title)
