"""Pages: templates, figures as they take them, and the page of a result."""

import re
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from markupsafe import Markup
from xarray import DataTree

from asperity import __version__
from asperity.errors import printable
from asperity.files import packaged
from asperity.reporting import data, headline, payload
from asperity.reporting.chart import Line, colour_variables
from asperity.reporting.figure import Chapter, Figure, PageFigure
from asperity.reporting.tables import ReportTable, setting_names
from asperity.reporting.templates import page_template
from asperity.schema import provenance

Block = PageFigure | ReportTable


@dataclass(frozen=True)
class PageSection:
    """A chapter of the page with its figures and tables, in the order they are shown."""

    name: str
    title: str
    blocks: Sequence[Block]

    @property
    def figures(self) -> list[PageFigure]:
        """Its figures."""
        return [block for block in self.blocks if isinstance(block, PageFigure)]


def whole_page(
    name: str,
    blocks: Sequence[object],
    colours: Mapping[str, str],
    unticked: Sequence[str] = (),
    /,
    **words: object,
) -> str:
    """Fill a template with words, and with the figures among blocks, as one self-contained HTML text.

    Laws that are `unticked` are not shown until a reader ticks them.
    Styles, charts and the script are inside; nothing is loaded from elsewhere, and no other script may run.
    """
    charts = {each.name: each.chart for each in blocks if isinstance(each, PageFigure)}
    text = page_template(name).render(
        charts=Markup(payload.charts_json(charts, colours, unticked)),
        script=Markup(payload.chart_script()),
        script_style=Markup(payload.chart_style()),
        digest=payload.digest_of(payload.chart_script()),
        light=Markup(colour_variables(dark=False, colours=colours)),
        dark=Markup(colour_variables(dark=True, colours=colours)),
        **words,
    )
    return printable(text, lines=True)


@dataclass(frozen=True)
class Remake:
    """How what a page shows is computed again: a command, and the texts of its files by their names."""

    command: str
    files: Mapping[str, str]


def figures_page(
    title: str,
    summary: str,
    blocks: Sequence[Block],
    files: Mapping[str, str],
    remake: Remake | None = None,
) -> str:
    """A page of figures and tables as one self-contained HTML text, with links to files by what they are."""
    figures = (block for block in blocks if isinstance(block, PageFigure))
    marks = (mark for figure in figures for panel in figure.chart.panels for mark in panel.marks)
    colours = data.page_colours(mark.colour for mark in marks if isinstance(mark, Line) and mark.law)
    told = {"title": title, "summary": summary, "version": __version__, "files": files, "blocks": blocks}
    return whole_page("figures.html.jinja", blocks, colours, **told, remake=remake)


# --- the page of a result

SUMMARY_FIGURES = 3
"""That a summary shows, of each chapter the first of these that it has."""
ON_SHEET = (
    "load_zone", "ball_turn", "radiated_power_bands", "pass_by_level",
    "acceleration_sensors", "body_acceleration", "force_bands", "roughness", "texture_psd", "texture_path",
    "texture_sample",
)  # fmt: skip
CHANGES = 8
"""Parameters that the top of the page tells of."""
_OF_A_KEY = re.compile(r"([a-z_]+): (.+)", re.DOTALL)
"""Where the value of a key comes from: ``"pad_damping: published together with …"``."""


def _sources(tree: DataTree) -> list[str]:
    return [str(text) for text in data.json_attribute(tree, provenance.CITATIONS, [])]


def literature(tree: DataTree) -> list[str]:
    """The program in the version of a run, then the sources of what it computed, one text each."""
    version = data.stated(tree, provenance.ASPERITY_VERSION) or "of unknown version"
    own = f"asperity {version}: rough contact reduced to a moving point force. The asperity developers."
    return [own, *(source for source in _sources(tree) if not _OF_A_KEY.fullmatch(source))]


def _origins(tree: DataTree) -> dict[str, list[str]]:
    """Keys of the case whose values a named set gave, by where these come from."""
    found: dict[str, list[str]] = {}
    for told in filter(None, map(_OF_A_KEY.fullmatch, _sources(tree))):
        found.setdefault(told[2], []).append(told[1])
    return found


def drawn_figures(tree: DataTree, figures: Iterable[Figure]) -> list[PageFigure]:
    """Figures that `tree` holds the data of."""
    return [drawn for figure in figures if (drawn := data.unless_missing(figure.drawn, tree))]


def sections_of(tree: DataTree, chapters: Sequence[Chapter]) -> list[PageSection]:
    """Chapters of the page; what has no data is left out."""
    found = []
    for chapter in chapters:
        blocks: list[Block] = [*drawn_figures(tree, chapter.figures)]
        blocks += [table for make in chapter.tables if (table := data.unless_missing(make, tree))]
        if blocks:
            found.append(PageSection(chapter.name, chapter.title, blocks))
    return found


def answers_of(tree: DataTree, chapters: Sequence[Chapter]) -> headline.Answers:
    """What the chapters say first, together; what no chapter says is the verdict of the run."""
    verdict = str(data.stated(tree, provenance.VERDICT) or "")
    found = [told for each in chapters if each.answers and (told := data.unless_missing(each.answers, tree))]
    return headline.Answers(
        next((each.lead for each in found if each.lead), "") or verdict.partition(". ")[0],
        " ".join(each.more for each in found if each.more),
        tuple(number for each in found for number in each.numbers),
        tuple(table for each in found for table in each.tables),
    )


def _case_groups(parameters: list[dict[str, Any]]) -> list[tuple[str, list[dict[str, Any]]]]:
    """Parameters by the table of the case file they stand in, in their order."""
    groups: dict[str, list[dict[str, Any]]] = {}
    for parameter in parameters:
        table, dot, key = str(parameter.get("key", "")).rpartition(".")
        groups.setdefault(table if dot else "", []).append(parameter | {"short": key})
    return list(groups.items())


def page(
    tree: DataTree, sections: Sequence[PageSection], answers: headline.Answers, *, summary: bool = False
) -> str:
    """The page of a result, as one self-contained HTML text, or a summary of it on one sheet of paper."""
    held = ([each for each in section.figures if each.name in ON_SHEET] for section in sections)
    on_sheet = [min(some, key=lambda f: ON_SHEET.index(f.name)) for some in held if some][:SUMMARY_FIGURES]
    shown = [PageSection("summary", "", on_sheet)] if summary else sections
    checks = headline.lights(tree)
    colours = data.law_colours(tree)
    kind = data.stated(tree, provenance.KIND)
    parameters = data.json_list(tree, provenance.PARAMETERS)
    changed = [parameter for parameter in parameters if not parameter.get("is_default", True)]
    differing = [f"{each.get('key', '')} = {each.get('value', '')}" for each in changed[:CHANGES]]
    differing += [f"and {len(changed) - CHANGES} more"] if len(changed) > CHANGES else []
    verdict = str(data.stated(tree, provenance.VERDICT) or "")
    seed = data.stated(tree, provenance.SEED)
    button = packaged("reporting/summary.js")
    blocks = [block for section in shown for block in section.blocks]
    return whole_page(
        "report.html.jinja",
        blocks,
        colours,
        data.unticked_laws(tree),
        title=data.stated(tree, provenance.TITLE) or kind or "Rolling contact",
        summary=summary,
        on_sheet={figure.name for figure in on_sheet},
        answers=answers,
        verdict="" if data.is_of_bearing(tree) else verdict,  # of a bearing it stands at the top
        validity=headline.validity(checks),
        lights=checks,
        version=data.stated(tree, provenance.ASPERITY_VERSION) or "unknown",
        created=data.moment(data.stated(tree, provenance.CREATED)),
        seed="" if seed is None else seed,
        case=data.stated(tree, provenance.CASE) or "",
        in_memory=data.json_attribute(tree, provenance.IN_MEMORY, {}),
        asked=" --converge" * bool(setting_names(tree)) + " --what-helps" * ("effects" in tree.children),
        kind=kind or "",
        literature=literature(tree),
        origins=_origins(tree),
        case_groups=_case_groups(parameters),
        changed=_case_groups(changed),
        differing=", ".join(differing),
        count=len(parameters),
        numerics=data.json_list(tree, provenance.NUMERICS),
        laws=data.law_entries(tree).values(),
        variable={colour: f"--c{number}" for number, colour in enumerate(colours)},
        sections=shown,
        button=Markup(button),
        button_digest=payload.digest_of(button),
    )
