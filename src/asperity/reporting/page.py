"""The page: everything that the template shows, collected from a result tree."""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from importlib.resources import files
from typing import Any

from markupsafe import Markup
from xarray import DataTree

from asperity.reporting.chapter import Chapter
from asperity.reporting.chart import Chart
from asperity.reporting.convergence import setting_names
from asperity.reporting.data import json_list, missing, stated
from asperity.reporting.drawing import svg_of
from asperity.reporting.headline import Answers
from asperity.reporting.law_entries import law_colours, law_entries
from asperity.reporting.lights import lights, validity
from asperity.reporting.literature import literature, origins
from asperity.reporting.part import Data, Part
from asperity.reporting.payload import digest_of, numbers_table
from asperity.reporting.tables import ReportTable
from asperity.reporting.templates import PageFigure, whole_page
from asperity.schema import provenance

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


def _readable(instant: str) -> str:
    """A moment of ISO 8601 in universal time as people write it; other words as they are."""
    found = re.fullmatch(r"(\d{4}-\d\d-\d\d)T(\d\d:\d\d):\d\d\+00:00", instant)
    return f"{found[1]}, {found[2]} UTC" if found else instant


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
        created=_readable(str(stated(tree, provenance.CREATED) or "")),
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
