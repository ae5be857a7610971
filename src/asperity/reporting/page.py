"""The page: everything that the template shows, collected from a result tree."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from markupsafe import Markup
from xarray import DataTree

from asperity.printable import printable
from asperity.reporting.chapter import Chapter
from asperity.reporting.convergence import setting_names
from asperity.reporting.data import json_list, missing, stated
from asperity.reporting.headline import headline
from asperity.reporting.history import as_json, script, script_digest, script_style
from asperity.reporting.law_entries import law_colours, law_entries
from asperity.reporting.lights import counted, lights
from asperity.reporting.literature import literature
from asperity.reporting.part import Part
from asperity.reporting.style import narrow_page
from asperity.reporting.svg import colour_variables, drawing_of, share_styles
from asperity.reporting.tables import ReportTable
from asperity.reporting.templates import page_template
from asperity.schema import provenance


@dataclass(frozen=True)
class Picture:
    """A figure ready for the page: its SVG elements, for a wide and a narrow page, heading and caption."""

    name: str
    title: str
    caption: str
    svg: Markup
    narrow: Markup  # empty where a browser draws the figure itself
    file: str  # the wide drawing as a document of its own
    live: str = ""  # what a browser draws in its place, where it does

    def laid_out(self) -> dict[str, str]:
        """As text, for another process."""
        return {name: str(text) for name, text in vars(self).items()}

    @classmethod
    def read(cls, laid_out: Mapping[str, str]) -> Picture:
        """What was laid out, of this version of the program."""
        markup: dict[str, Any] = {name: Markup(laid_out[name]) for name in ("svg", "narrow", "live")}
        return cls(**{**laid_out, **markup})


@dataclass(frozen=True)
class PageSection:
    """A chapter of the page with its figures and tables, in the order they are shown."""

    name: str
    title: str
    blocks: list[Picture | ReportTable]


def drawable_parts(tree: DataTree, chapters: Sequence[Chapter]) -> list[Part]:
    """Figures that `tree` holds the data of, in the order of the page."""
    return [part for chapter in chapters for part in chapter.parts if part.drawable(tree)]


def picture(tree: DataTree, part: Part) -> Picture:
    """Draw a figure for a wide and for a narrow page."""
    data, colours = part.collect(tree), law_colours(tree)
    drawn = drawing_of(part.plot(tree, data), part.name)
    shown = {
        "svg": Markup(drawn.for_page(part.title, colours)),
        "narrow": Markup(),
        "live": Markup(as_json(part.live(tree))) if part.live else Markup(),
    }
    if part.live is None:
        with narrow_page():
            narrow = drawing_of(part.plot(tree, data), f"{part.name}-narrow")
        shown["narrow"] = Markup(narrow.for_page(part.title, colours))
    lost = missing(tree, *part.needs, *part.any_of)
    caption = f"{part.caption(tree)} {lost}".strip()
    return Picture(part.name, part.title, caption, file=drawn.for_file(part.title), **shown)


def sections(
    tree: DataTree, chapters: Sequence[Chapter], drawn: Mapping[str, Picture] | None = None
) -> list[PageSection]:
    """Chapters of the page, with figures drawn before, by name, or now; one without any data is left out."""
    found = []
    for chapter in chapters:
        parts = [part for part in chapter.parts if part.drawable(tree)]
        figures = [picture(tree, part) if drawn is None else drawn[part.name] for part in parts]
        tables = (table for make in chapter.tables if (table := make(tree)))
        blocks: list[Picture | ReportTable] = [*figures, *tables]
        if blocks:
            found.append(PageSection(chapter.name, chapter.title, blocks))
    return found


_GRADES = {"out of range": ("out", "out of range"), "warning": ("", "warnings"), "note": ("note", "notes")}
"""Look and plural of the grades of warnings, the gravest first."""


def _warnings(tree: DataTree) -> list[dict[str, Any]]:
    """Warnings on the physics with their grade and its look."""
    graded = [{"grade": "warning", **warning} for warning in json_list(tree, provenance.WARNINGS)]
    return [warning | {"look": _GRADES.get(warning["grade"], ("", ""))[0]} for warning in graded]


def _graded(warnings: list[dict[str, Any]]) -> str:
    """Say how many warnings there are of each grade, as ``"1 out of range, 2 warnings"``."""
    counts = {grade: sum(w["grade"] == grade for w in warnings) for grade in _GRADES}
    named = [f"{n} {grade if n == 1 else _GRADES[grade][1]}" for grade, n in counts.items() if n]
    return ", ".join(named) or f"{len(warnings)} warnings"


def _law_key(tree: DataTree) -> list[dict[str, str]]:
    numbers = {colour: number for number, colour in enumerate(law_colours(tree))}
    return [
        {
            "name": law.name,
            "meaning": law.meaning,
            "colour": f"var(--c{numbers[law.colour]})",
            "dashes": "" if isinstance(law.dashes, str) else " ".join(f"{2 * d:g}" for d in law.dashes[1]),
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


def page(tree: DataTree, chapters: Sequence[Chapter], drawn: Sequence[PageSection]) -> str:
    """The whole page of a result, with what `sections` drew of it, as one self-contained HTML text.

    Styles, figures and the script are inside; nothing is loaded from elsewhere, and no other script may run.
    """
    kind, parameters = stated(tree, provenance.KIND), json_list(tree, provenance.PARAMETERS)
    warnings, checks, colours = _warnings(tree), lights(tree), law_colours(tree)
    own = next((found for c in chapters if c.headline and (found := c.headline(tree))), None)
    text = page_template("report.html.jinja").render(
        title=stated(tree, provenance.TITLE) or kind or "Rolling contact",
        verdict=_verdict(tree),
        numbers=headline(tree, own),
        lights=checks,
        counted=counted(checks),
        version=stated(tree, provenance.ASPERITY_VERSION) or "unknown",
        created=stated(tree, provenance.CREATED) or "",
        seed="" if (seed := stated(tree, provenance.SEED)) is None else seed,
        case=stated(tree, provenance.CASE) or "",
        converged=bool(setting_names(tree)),
        kind=kind or "",
        literature=literature(tree),
        warnings=warnings,
        graded=_graded(warnings),
        case_groups=_case_groups(parameters),
        changed=_case_groups([p for p in parameters if not p.get("is_default", True)]),
        count=len(parameters),
        numerics=json_list(tree, provenance.NUMERICS),
        laws=_law_key(tree),
        sections=drawn,
        script=Markup(script()),
        script_style=Markup(script_style()),
        digest=script_digest(),
        light=Markup(colour_variables(dark=False, colours=colours)),
        dark=Markup(colour_variables(dark=True, colours=colours)),
    )
    return share_styles(printable(text, lines=True))


def _verdict(tree: DataTree) -> tuple[str, str]:
    """The first sentence of the verdict, and the others."""
    first, _, rest = str(stated(tree, provenance.VERDICT) or "").partition(". ")
    return (f"{first}.", rest) if rest else (first, "")
