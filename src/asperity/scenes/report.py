"""The report of a run of any scene: its page and the numbers of its figures; in a notebook; beside others."""

import base64
import os
from collections import deque
from collections.abc import Sequence
from html import escape
from pathlib import Path
from typing import TYPE_CHECKING, Any

import xarray

from asperity import extensions
from asperity.arguments import FilePath, file_path, require, shown
from asperity.errors import InputError, printable
from asperity.files import together, write_bytes
from asperity.reporting import contact_figures, data, headline, tables, texture_figures
from asperity.reporting.comparison import ComparedRuns, NamedRun, compared
from asperity.reporting.comparison_page import MOST_RUNS, comparison_page, table_rows
from asperity.reporting.figure import (
    Chapter,
    PageFigure,
    chosen_figures,
    figure_format,
    write_columns,
    write_figures,
)
from asperity.reporting.page import answers_of, drawn_figures, page, sections_of
from asperity.results import read_result
from asperity.scenes.figures import (
    bearing,
    bearing_wear,
    effects,
    force,
    measured,
    motion,
    noise,
    run_up,
    scene,
    sideways,
    track,
)
from asperity.scenes.schema import KEPT
from asperity.schema import bearing as of_bearing
from asperity.schema import provenance, rolling
from asperity.schema.spectra import FORCE_LEVEL
from asperity.text_files import csv_text
from asperity.threads import in_order

if TYPE_CHECKING:
    from matplotlib.figure import Figure as MatplotlibFigure

PAGE = "report.html"
CHAPTERS = (
    Chapter(
        "bearing",
        "How quiet it runs",
        bearing.QUIET,
        (bearing.bands_table, bearing.lines_table),
        bearing.bearing_answers,
    ),
    Chapter("run_up", "Its run-up", run_up.RUN_UP),
    Chapter(
        "load",
        "How it carries its load",
        (bearing.ball_turn, bearing.along_roller, bearing.ball_films, bearing_wear.raceway_wear),
        (bearing.ball_contacts_table, bearing.films_table, bearing.ball_sliding_table),
    ),
    Chapter(
        "noise",
        "Rolling noise",
        (noise.radiated_power_bands,),
        (noise.sound_power_table, noise.wheel_table),
        noise.noise_answers,
    ),
    Chapter(
        "pass_by",
        "Pass-by",
        (noise.pass_by_level, measured.pass_by_bands),
        (measured.limits_table, noise.pass_by_table, measured.measured_sound_table),
        noise.pass_by_answers,
    ),
    Chapter("effects", "What helps?", (), (effects.what_helps_table,), effects.what_helps_answers),
    Chapter("acceleration", "Acceleration", motion.ACCELERATION, answers=motion.acceleration_answers),
    Chapter("motion", "Motion of the bodies", (motion.body_acceleration,)),
    Chapter("force", "Contact force", force.FORCE, (tables.loss_table,), headline.force_answers),
    Chapter("contacts", "All contacts", (force.contact_levels,), (force.contacts_table,)),
    Chapter(
        "measured",
        "Measured against computed",
        (measured.beside_measured,),
        (measured.beside_table,),
    ),
    Chapter("setup", "Scene", (scene.scene,)),
    Chapter(
        "texture",
        "Texture",
        (track.roughness, track.out_of_round, *texture_figures.TEXTURE),
        (tables.statistics_table, tables.homogeneity_table),
    ),
    Chapter(
        "track",
        "Track and wheel",
        (track.receptance, track.decay_rate, track.loss_factors),
        (measured.measured_table,),
    ),
    Chapter("sideways", "Sideways", sideways.SIDEWAYS, (sideways.sideways_table,)),
    Chapter(
        "creep", "Creep and friction", sideways.CREEP, (sideways.friction_table,), sideways.creep_answers
    ),
    Chapter("rail", "Motion of the rail", motion.RAIL),
    Chapter("energy", "Energy", (), (motion.energy_table,)),
    Chapter(
        "contact",
        "Contact",
        (contact_figures.contact_pressure, texture_figures.running_in),
        (tables.population_table, tables.condition_table),
    ),
    Chapter(
        "laws", "How the contact laws work", (contact_figures.contact_force, contact_figures.contact_filter)
    ),
    Chapter(
        "uncertainty",
        "Uncertainty",
        (),
        (tables.uncertainty_table, tables.settings_table, tables.changes_table),
    ),
)
"""In the order of the page; what a result lacks is left out."""


def chapters() -> tuple[Chapter, ...]:
    """All chapters of reports; those of packages beside this one stand last."""
    return (*CHAPTERS, *extensions.taken(extensions.CHAPTERS, _installed_chapter).values())


def _installed_chapter(name: str, chapter: Any) -> Chapter:
    """A chapter that another package offers."""
    allowed = "an asperity.reporting.figure.Chapter"
    require(isinstance(chapter, Chapter), f'chapter "{name}"', shown(chapter), allowed)
    assert isinstance(chapter, Chapter)
    return chapter


def figures_of(tree: xarray.DataTree) -> list[PageFigure]:
    """Figures that `tree` holds the data of, in the order of the page."""
    return drawn_figures(tree, (figure for chapter in chapters() for figure in chapter.figures))


def page_of(tree: xarray.DataTree, *, summary: bool = False) -> str:
    """The whole page of a run, see `asperity.reporting.page.page`."""
    return page(tree, sections_of(tree, chapters()), answers_of(tree, chapters()), summary=summary)


def report(result: xarray.DataTree, path: FilePath, figures: str | None = None) -> Path:
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
    data.refuse_no_result(result)
    target = _page_in("report", path)
    format = None if figures is None else figure_format("figures", figures)
    with together(target.parent, last=target.name) as new:
        if format is not None:
            write_figures(figures_of(result), new, format)
        write_page(result, new / target.name)
    return target


def _page_in(name: str, path: object) -> Path:
    """Path of a page in a folder that is given, unless it is given itself."""
    target = file_path(name, path, "the path of a folder, or of a page that ends in .html")
    return target if target.suffix.lower() == ".html" else target / f"{name}.html"


def write_page(result: xarray.DataTree, target: Path) -> Path:
    """Write the page of a result and, beside it, the numbers of its figures."""
    sections = sections_of(result, chapters())

    def write(figure: PageFigure) -> None:
        write_columns(figure.columns, target.parent / figure.file)

    figures = [figure for section in sections for figure in section.figures]
    deque(in_order(write, figures), maxlen=0)  # on threads, as each waits for the disk
    return write_bytes(target, page(result, sections, answers_of(result, chapters())).encode())


def write_summary(result: xarray.DataTree, target: Path) -> Path:
    """Write a summary of a result, on one sheet of paper."""
    return write_bytes(target, page_of(result, summary=True).encode())


def names_of_reports() -> list[str]:
    """Names of all files that a report may have, or that of an earlier version."""
    figures = (figure.name for chapter in chapters() for figure in chapter.figures)
    return [PAGE, *dict.fromkeys(f"{name}.{ending}" for name in figures for ending in ("csv", "svg"))]


# --- a result that shows itself in a notebook

MAIN = ("force_bands", "load_zone")
"""Figures that stand for a run, the second for that of a bearing."""


class Result(xarray.DataTree):  # type: ignore[no-untyped-call]
    """The result of a run: a tree of datasets, which a notebook shows as verdict, numbers and a figure.

    It is an `xarray.DataTree` with the groups scenario, surface, contact, rolling and spectra, and what the
    kind of case adds; `plot` draws its figures, and `asperity.report` writes all of it as a page.
    """

    __slots__ = ()

    @classmethod
    def of(cls, tree: xarray.DataTree) -> "Result":
        """Make a result of a tree."""
        return cls(tree.to_dataset(inherit=False), children=tree.children)

    def plot(self, name: str | None = None) -> "MatplotlibFigure":
        """Draw a figure of the result, for a notebook to show or for ``savefig``.

        Parameters
        ----------
        name : str, optional
            A figure of the report by the name of its file, as ``"force_bands"``, or by its title or the
            beginning of it, as ``"contact force levels"``; by default this one, of a bearing its load zone.

        Returns
        -------
        matplotlib.figure.Figure
            The figure.

        Raises
        ------
        InputError
            If the result has no such figure; the message lists those that it has, and the nearest.

        Examples
        --------
        >>> import asperity
        >>> result = asperity.run(case)
        >>> result.plot().savefig("force.png")
        >>> result.plot("force_bands").axes[0].get_xlabel()
        'one-third octave band / Hz'
        """
        from asperity.reporting.paper import draw  # matplotlib, which nothing else needs

        figures = figures_of(self)
        main = next((figure.name for figure in figures if figure.name in MAIN), None)
        (figure,) = chosen_figures(figures, [main if name is None else name])
        return draw(figure.chart)

    def _repr_html_(self) -> str:
        tree: str = super()._repr_html_()  # type: ignore[no-untyped-call]
        rolled = data.present(self, rolling.CONTACT_FORCE) or data.is_of_bearing(self)
        if data.stated(self, provenance.VERDICT) is None or not rolled:
            return tree
        title, verdict = (
            escape(str(data.stated(self, each))) for each in (provenance.TITLE, provenance.VERDICT)
        )
        valid = headline.validity(headline.lights(self)).quantity
        image = base64.b64encode(self.plot()._repr_png_()).decode()  # type: ignore[attr-defined]
        return (
            f"<div><p><strong>{title}.</strong> {verdict} {valid}</p>\n{_numbers(self)}\n"
            f'<img alt="main figure" width="840" src="data:image/png;base64,{image}">\n'
            f"<details><summary>All data</summary>{tree}</details></div>"
        )


def _numbers(tree: xarray.DataTree) -> str:
    """The numbers with which the page of the result begins."""
    cells = ((each.name, each.value, each.note) for each in answers_of(tree, chapters()).numbers)
    rows = ("".join(f"<td>{escape(cell)}</td>" for cell in row) for row in cells)
    return f"<table>{''.join(f'<tr>{row}</tr>' for row in rows)}</table>"


# --- runs beside each other


def compare(
    *results: xarray.DataTree | FilePath,
    names: Sequence[str] | None = None,
    path: FilePath | None = None,
) -> xarray.Dataset:
    """Compare runs: what differs in their cases, levels, force, loss of contact, stiffness and filters.

    Parameters
    ----------
    *results : xarray.DataTree or path
        Two to eight runs: what `asperity.run` or `asperity.open_result` returned, or a ``run.nc`` or its
        folder. All differences are to the first.
    names : sequence of str, optional
        What the runs are called; by default as their folders, or by number.
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
        If there are fewer than two runs or more than eight, one cannot be read, or names do not fit.
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
    found = comparison_of(results, names)
    if path is not None:
        write_comparison(found, path)
    return found.table


def comparison_of(
    results: Sequence[xarray.DataTree | FilePath], names: Sequence[str] | None = None
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
    levels = (
        e for e in (*KEPT, *of_bearing.KEPT) if e.units.startswith("dB re") and e.dims[-1].endswith("band")
    )
    return compared(runs, list(dict.fromkeys([FORCE_LEVEL, *(each for each in levels if each.name in held)])))


def _tree(result: object) -> xarray.DataTree:
    if isinstance(result, xarray.DataTree):
        return result
    return read_result(file_path("run", result, "a result, or the path of a run.nc or of its folder"))


def names_of(results: Sequence[object]) -> list[str]:
    """Call each run as its folder or file, with as much of the path as tells all apart."""
    paths = [_place(result, number) for number, result in enumerate(results, 1)]
    for depth in range(1, max(map(len, paths)) + 1):
        found = [Path(*parts[-depth:]).as_posix() for parts in paths]
        if len(set(found)) == len(found):
            return found
    return [f"{parts[-1]} ({number})" for number, parts in enumerate(paths, 1)]  # one of them twice


def _place(result: object, number: int) -> tuple[str, ...]:
    if not isinstance(result, str | os.PathLike):
        return (f"run {number}",)
    path = Path(result).absolute()
    return path.parent.parts if path.name == "run.nc" else (*path.parent.parts, path.stem or "run")


def write_comparison(of: ComparedRuns, path: FilePath) -> tuple[Path, Path]:
    """Write page and table of a comparison; return where they are."""
    target = _page_in("comparison", path)
    rows = target.with_suffix(".csv")
    with together(target.parent, last=target.name) as new:
        for file, text in ((rows, csv_text(*table_rows(of))), (target, comparison_page(of, rows.name))):
            write_bytes(new / file.name, text.encode("utf-8", errors="backslashreplace"))
    return target, rows
