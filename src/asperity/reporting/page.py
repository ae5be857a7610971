"""Templates of pages, and a figure as they take it."""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cache
from importlib.resources import files
from typing import Any

from jinja2 import Environment, PackageLoader, StrictUndefined, Template
from markupsafe import Markup
from xarray import DataTree

from asperity import __version__
from asperity.printable import printable
from asperity.reporting.chapter import Chapter
from asperity.reporting.chart import Chart, Line, colour_variables
from asperity.reporting.data import json_attribute, json_list, missing, moment, stated
from asperity.reporting.drawing import svg_of
from asperity.reporting.headline import Answers, lights, validity
from asperity.reporting.law_entries import law_colours, law_entries, page_colours
from asperity.reporting.part import Data, Part
from asperity.reporting.payload import (
    chart_script,
    chart_style,
    charts_json,
    digest_of,
    numbers_table,
    script_digest,
)
from asperity.reporting.tables import ReportTable
from asperity.reporting.uncertainty import setting_names
from asperity.schema import provenance

_UNITS = "[kM]?N|k?Hz|dB|%|[µmk]?m|m/s|[GM]?Pa|[µm]?s|mm²|µm²|g"


@dataclass(frozen=True, eq=False)
class PageFigure:
    """A figure of a page, which the script of the page draws unless it is a `drawing`."""

    name: str
    title: str
    caption: str
    chart: Chart
    numbers: list[ReportTable] = field(default_factory=list)  # shown where no script runs
    file: str = ""  # with its numbers, beside the page
    drawing: Markup | None = None  # elements of the page


def whole_page(name: str, charts: Mapping[str, Chart], colours: Mapping[str, str], **told: object) -> str:
    """Fill a template with what is `told`, as one self-contained HTML text.

    Styles, charts and the script are inside; nothing is loaded from elsewhere, and no other script may run.
    """
    text = page_template(name).render(
        charts=Markup(charts_json(charts, colours)),
        script=Markup(chart_script()),
        script_style=Markup(chart_style()),
        digest=script_digest(),
        light=Markup(colour_variables(dark=False, colours=colours)),
        dark=Markup(colour_variables(dark=True, colours=colours)),
        **told,
    )
    return printable(text, lines=True)


@cache
def page_template(name: str) -> Template:
    """A template of this package, which writes text of others so that it is seen and does nothing."""
    environment = Environment(
        loader=PackageLoader("asperity.reporting", ""),
        autoescape=True,
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    environment.filters["unbroken"] = _unbroken
    return environment.get_template(name)


def _unbroken(text: str) -> str:
    """Keep numbers and their units on one line."""
    return re.sub(rf"(?<=\d) (?=(?:{_UNITS})(?!\w))", "\u00a0", text)


_OF_A_KEY = re.compile(r"([a-z_]+): (.+)", re.DOTALL)
"""Where the value of a key comes from: ``"pad_damping: published together with …"``."""


def literature(tree: DataTree) -> list[str]:
    """The program in the version of a run, then the sources of what it computed, one text each."""
    version = stated(tree, provenance.ASPERITY_VERSION) or "of unknown version"
    own = f"asperity {version}: rough contact reduced to a moving point force. The asperity developers."
    return [own, *(source for source in _sources(tree) if not _OF_A_KEY.fullmatch(source))]


def origins(tree: DataTree) -> dict[str, list[str]]:
    """Keys of the case whose values a named set gave, by where these come from."""
    found: dict[str, list[str]] = {}
    for told in filter(None, map(_OF_A_KEY.fullmatch, _sources(tree))):
        found.setdefault(told[2], []).append(told[1])
    return found


def _sources(tree: DataTree) -> list[str]:
    return [str(text) for text in json_attribute(tree, provenance.CITATIONS, [])]


def figures_page(title: str, summary: str, figures: Sequence[PageFigure], files: Mapping[str, str]) -> str:
    """The page as one self-contained HTML text, with links to files beside it, by what they are."""
    charts = {figure.name: figure.chart for figure in figures}
    marks = (mark for chart in charts.values() for panel in chart.panels for mark in panel.marks)
    colours = page_colours(mark.colour for mark in marks if isinstance(mark, Line) and mark.law)
    return whole_page(
        "figures.html.jinja",
        charts,
        colours,
        title=title,
        summary=summary,
        version=__version__,
        files=files,
        figures=figures,
    )


SUMMARY_FIGURES = 3
"""That a summary shows."""
CHANGES = 8
"""Parameters that the top of the page tells of."""


@dataclass(frozen=True)
class PageSection:
    """A chapter of the page with its figures and tables, in the order they are shown."""

    name: str
    title: str
    blocks: list[PageFigure | ReportTable]


def drawable_parts(tree: DataTree, chapters: Sequence[Chapter]) -> list[Part]:
    """Figures that `tree` holds the data of, in the order of the page."""
    return [part for chapter in chapters for part in chapter.parts if part.drawable(tree)]


def summary_parts(tree: DataTree, chapters: Sequence[Chapter]) -> list[Part]:
    """Figures of a summary: one of each of the first chapters that name any."""
    firsts = (next((part for part in chapter.summary if part.drawable(tree)), None) for chapter in chapters)
    return [part for part in firsts if part is not None][:SUMMARY_FIGURES]


def page_figure(tree: DataTree, part: Part, data: Data, colours: Mapping[str, str]) -> PageFigure:
    """A figure of the page, from numbers that were collected."""
    chart = part.chart(tree, data)
    lost = missing(tree, *part.needs, *part.any_of)
    return PageFigure(
        part.name,
        part.title,
        f"{part.caption(tree)} {lost}".strip(),
        chart,
        [] if chart.drawing else [numbers_table(data)],
        f"{part.name}.csv",
        Markup(svg_of(chart, part.title, colours)) if chart.drawing else None,
    )


def sections(tree: DataTree, chapters: Sequence[Chapter], collected: Mapping[str, Data]) -> list[PageSection]:
    """Chapters of the page, with numbers that were collected; one without any data is left out."""
    found, colours = [], law_colours(tree)
    for chapter in chapters:
        parts = [part for part in chapter.parts if part.drawable(tree)]
        figures = [page_figure(tree, part, collected[part.name], colours) for part in parts]
        tables = (table for make in chapter.tables if (table := make(tree)))
        blocks: list[PageFigure | ReportTable] = [*figures, *tables]
        if blocks:
            found.append(PageSection(chapter.name, chapter.title, blocks))
    return found


def charts_of(drawn: Iterable[PageSection]) -> dict[str, Chart]:
    """What the script of a page draws, by the names of its figures."""
    blocks = (block for section in drawn for block in section.blocks)
    return {block.name: block.chart for block in blocks if isinstance(block, PageFigure)}


def answers_of(tree: DataTree, chapters: Sequence[Chapter]) -> Answers:
    """What the chapters say first, together; what no chapter says is the verdict of the run."""
    found = [told for chapter in chapters if chapter.answers and (told := chapter.answers(tree))]
    lead = next((each.lead for each in found if each.lead), "")
    return Answers(
        lead or _verdict(tree).partition(". ")[0],
        " ".join(each.more for each in found if each.more),
        tuple(number for each in found for number in each.numbers),
        tuple(table for each in found for table in each.tables),
    )


def _verdict(tree: DataTree) -> str:
    return str(stated(tree, provenance.VERDICT) or "")


def _law_key(tree: DataTree) -> list[dict[str, str]]:
    numbers = {colour: number for number, colour in enumerate(law_colours(tree))}
    return [
        {
            "name": law.name,
            "meaning": law.meaning,
            "colour": f"var(--c{numbers[law.colour]})",
            "dashes": " ".join(f"{2 * length:g}" for length in law.dashes),
        }
        for law in law_entries(tree).values()
    ]


def _case_groups(parameters: list[dict[str, Any]]) -> list[tuple[str, list[dict[str, Any]]]]:
    """Parameters by the table of the case file they stand in, in their order."""
    groups: dict[str, list[dict[str, Any]]] = {}
    for parameter in parameters:
        table, dot, key = str(parameter.get("key", "")).rpartition(".")
        groups.setdefault(table if dot else "", []).append(parameter | {"short": key})
    return list(groups.items())


def _differing(changed: list[dict[str, Any]]) -> str:
    """The first parameters that are not the defaults, in a line, and how many more there are."""
    told = [f"{each.get('key', '')} = {each.get('value', '')}" for each in changed[:CHANGES]]
    more = len(changed) - len(told)
    return ", ".join([*told, *([f"and {more} more"] if more else [])])


@cache
def _button() -> str:
    """Script that prints the summary."""
    return (files("asperity.reporting") / "summary.js").read_text(encoding="utf-8")


def page(
    tree: DataTree,
    chapters: Sequence[Chapter],
    collected: Mapping[str, Data] | None = None,
    *,
    summary: bool = False,
) -> str:
    """The whole page of a result, as one self-contained HTML text, or a summary of it on one sheet of paper.

    Numbers of the figures, by name, are `collected` unless they were before.
    """
    on_sheet = summary_parts(tree, chapters)
    shown = [Chapter("summary", "", tuple(on_sheet))] if summary else chapters
    if collected is None:
        collected = {part.name: part.collect(tree) for part in drawable_parts(tree, shown)}
    drawn, checks, colours = sections(tree, shown, collected), lights(tree), law_colours(tree)
    kind, parameters = stated(tree, provenance.KIND), json_list(tree, provenance.PARAMETERS)
    changed = [parameter for parameter in parameters if not parameter.get("is_default", True)]
    return whole_page(
        "report.html.jinja",
        charts_of(drawn),
        colours,
        title=stated(tree, provenance.TITLE) or kind or "Rolling contact",
        summary=summary,
        on_sheet={part.name for part in on_sheet},
        answers=answers_of(tree, chapters),
        verdict=_verdict(tree),
        validity=validity(checks),
        lights=checks,
        version=stated(tree, provenance.ASPERITY_VERSION) or "unknown",
        created=moment(stated(tree, provenance.CREATED)),
        seed="" if (seed := stated(tree, provenance.SEED)) is None else seed,
        case=stated(tree, provenance.CASE) or "",
        converged=bool(setting_names(tree)),
        kind=kind or "",
        literature=literature(tree),
        origins=origins(tree),
        case_groups=_case_groups(parameters),
        changed=_case_groups(changed),
        differing=_differing(changed),
        count=len(parameters),
        numerics=json_list(tree, provenance.NUMERICS),
        laws=_law_key(tree),
        sections=drawn,
        button=Markup(_button()),
        button_digest=digest_of(_button()),
    )
