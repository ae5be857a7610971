"""The report of a run of any scene: its chapters, the page, and the numbers of its figures."""

import os
from functools import cache
from importlib.metadata import entry_points
from pathlib import Path

from xarray import DataTree

from asperity.arguments import file_path, shown
from asperity.errors import InputError
from asperity.files import together, write_bytes
from asperity.reporting import contact_figures, headline, tables, texture_figures
from asperity.reporting.figure import Chapter, Figure, figure_format, write_columns, write_figures
from asperity.reporting.page import drawable_figures, page
from asperity.scenes.figures import (
    contacts,
    effects,
    force,
    limits,
    measured,
    motion,
    noise,
    roughness,
    scene,
    sideways,
    track,
)

PAGE, SUMMARY = "report.html", "summary.html"
OF_OTHERS = "asperity.chapters"
"""Group of entry points under which other packages name chapters of their own."""
CHAPTERS = (
    Chapter(
        "noise",
        "Rolling noise",
        (noise.RADIATED, *noise.NOISE),
        (noise.radiated_table, noise.wheel_table, noise.sound_power_table),
        noise.noise_answers,
    ),
    Chapter(
        "pass_by",
        "Pass-by",
        (noise.PASS_BY, measured.PASS_BY_BANDS),
        (limits.limits_table, noise.pass_by_table, measured.passage_table),
        noise.pass_by_answers,
    ),
    Chapter(
        "effects",
        "What helps?",
        (effects.WHAT_HELPS,),
        (effects.what_helps_table,),
        effects.what_helps_answers,
    ),
    Chapter("acceleration", "Acceleration", motion.ACCELERATION, answers=motion.acceleration_answers),
    Chapter("motion", "Motion of the bodies", (motion.BODIES,)),
    Chapter("force", "Contact force", force.FORCE, (tables.loss_table,), headline.force_answers),
    Chapter("contacts", "All contacts", contacts.CONTACTS, (contacts.contacts_table,)),
    Chapter("setup", "Scene", scene.SCENES),
    Chapter(
        "texture",
        "Texture",
        (roughness.ROUGHNESS, *texture_figures.TEXTURE),
        (tables.statistics_table, tables.homogeneity_table),
    ),
    Chapter("track", "Track and wheel", (*track.TRACK, track.LOSS_FACTORS), (measured.measured_table,)),
    Chapter("sideways", "Sideways", sideways.SIDEWAYS, (sideways.sideways_table,)),
    Chapter("rail", "Motion of the rail", motion.RAIL),
    Chapter("energy", "Energy", (), (motion.energy_table,)),
    Chapter(
        "contact",
        "Contact",
        (contact_figures.PRESSURE, texture_figures.RUNNING_IN),
        (tables.population_table, tables.condition_table, tables.passes_table),
    ),
    Chapter(
        "laws",
        "How the contact laws work",
        (contact_figures.LOADING, contact_figures.FILTER, contact_figures.PRINTED_FILTER),
        (tables.practice_table, tables.reference_table),
    ),
    Chapter(
        "uncertainty",
        "Uncertainty",
        (),
        (tables.uncertainty_table, tables.settings_table, tables.changes_table),
    ),
)
"""In the order of the page; what a result lacks is left out."""


@cache
def chapters() -> tuple[Chapter, ...]:
    """All chapters of reports; those that other packages name stand last."""
    return (*CHAPTERS, *(each.load() for each in entry_points(group=OF_OTHERS)))


def figures_of(tree: DataTree) -> list[Figure]:
    """Figures that `tree` holds the data of, in the order of the page."""
    return drawable_figures(tree, chapters())


def page_of(tree: DataTree, *, summary: bool = False) -> str:
    """The whole page of a run, see `asperity.reporting.page.page`."""
    return page(tree, chapters(), summary=summary)


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
    return write_bytes(target, page(result, chapters(), collected).encode())


def write_summary(result: DataTree, target: Path) -> Path:
    """Write a summary of a result, on one sheet of paper."""
    return write_bytes(target, page_of(result, summary=True).encode())


def names_of_reports() -> list[str]:
    """Names of all files that a report may have, or that of an earlier version."""
    figures = (figure.name for chapter in chapters() for figure in chapter.figures)
    return [PAGE, *dict.fromkeys(f"{name}.{ending}" for name in figures for ending in ("csv", "svg"))]
