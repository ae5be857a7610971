"""The page: everything that the template shows, collected from a result tree."""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import cache
from typing import Any

from jinja2 import Environment, PackageLoader, StrictUndefined, Template
from markupsafe import Markup
from xarray import DataTree

from asperity.report.contact_figures import CONTACT
from asperity.report.data import entries, group_attrs, missing
from asperity.report.loss_figures import LOSS_FACTORS
from asperity.report.motion_figures import MOTION
from asperity.report.noise_figures import NOISE
from asperity.report.part import Part
from asperity.report.rail_force_figures import FORCE_PEAK, FORCE_PSD
from asperity.report.roughness_levels import ROUGHNESS_LEVELS
from asperity.report.spectrum_figures import FORCE_BANDS, SPECTRUM
from asperity.report.style import colour_variables, law_style, narrow_page, svg
from asperity.report.tables import (
    Table,
    energy_table,
    homogeneity_table,
    loss_table,
    reference_table,
    sound_power_table,
    statistics_table,
    validity_table,
)
from asperity.report.texture import TEXTURE
from asperity.report.time_figures import FORCE_ENVELOPE, TIME
from asperity.report.track_figures import TRACK


@dataclass(frozen=True)
class Chapter:
    """What a chapter can hold: its figures, then its tables."""

    name: str
    title: str
    parts: tuple[Part, ...]
    tables: tuple[Callable[[DataTree], Table | None], ...] = ()


_CONTACT = Chapter("contact", "Contact", CONTACT, (validity_table,))

BALL_ON_BEAM = (
    Chapter("texture", "Texture", TEXTURE, (statistics_table, homogeneity_table)),
    _CONTACT,
    Chapter("force", "Contact force", (*TIME, *SPECTRUM[:2]), (reference_table, loss_table)),
    Chapter("acceleration", "Acceleration", SPECTRUM[2:]),
    Chapter("energy", "Energy", (), (energy_table,)),
)
WHEEL_ON_RAIL = (
    Chapter("texture", "Texture", (ROUGHNESS_LEVELS, *TEXTURE), (statistics_table, homogeneity_table)),
    Chapter("track", "Track and wheel", (*TRACK, LOSS_FACTORS)),
    _CONTACT,
    Chapter(
        "force",
        "Contact force",
        (FORCE_ENVELOPE, FORCE_PEAK, FORCE_PSD, FORCE_BANDS),
        (reference_table, loss_table),
    ),
    Chapter("noise", "Rolling noise", NOISE, (sound_power_table,)),
    Chapter("motion", "Motion", MOTION),
)


def chapters(tree: DataTree) -> tuple[Chapter, ...]:
    """Chapters of the page for the kind of case that `tree` is the result of."""
    kind = group_attrs(tree, "scenario").get("kind")
    on_rail = kind == "wheel-on-rail" or (kind is None and "track" in tree.children)
    return WHEEL_ON_RAIL if on_rail else BALL_ON_BEAM


def every_part() -> list[Part]:
    """Figures that the page of any kind of case may have."""
    return [part for chapter in (*BALL_ON_BEAM, *WHEEL_ON_RAIL) for part in chapter.parts]


@dataclass(frozen=True)
class Picture:
    """A figure ready for the page: its SVG elements, for a wide and a narrow page, heading and caption."""

    name: str
    title: str
    caption: str
    svg: Markup
    narrow: Markup


@dataclass(frozen=True)
class Section:
    """A chapter of the page with its figures and tables, in the order they are shown."""

    name: str
    title: str
    blocks: list[Picture | Table]


def drawable_parts(tree: DataTree) -> list[Part]:
    """Figures that `tree` holds the data of, in the order of the page."""
    return [part for chapter in chapters(tree) for part in chapter.parts if part.drawable(tree)]


def _pictures(tree: DataTree, parts: tuple[Part, ...]) -> list[Picture | Table]:
    return [_picture(tree, part) for part in parts if part.drawable(tree)]


def _picture(tree: DataTree, part: Part) -> Picture:
    wide = svg(part.draw(tree), part.name, part.title)
    with narrow_page():
        narrow = svg(part.draw(tree), f"{part.name}-narrow", part.title)
    lost = missing(tree, *part.needs, *part.any_of)
    caption = f"{part.caption(tree)} {lost}".strip()
    return Picture(part.name, part.title, caption, Markup(wide), Markup(narrow))


def sections(tree: DataTree) -> list[Section]:
    """Chapters of the page; a chapter without any data is left out."""
    found = (
        Section(
            chapter.name,
            chapter.title,
            [*_pictures(tree, chapter.parts), *(t for make in chapter.tables if (t := make(tree)))],
        )
        for chapter in chapters(tree)
    )
    return [section for section in found if section.blocks]


def _records(attrs: Mapping[Any, Any], name: str) -> list[dict[str, Any]]:
    return [entry for entry in entries(attrs, name, []) if isinstance(entry, dict)]


_GRADES = {"out of range": ("out", "out of range"), "warning": ("", "warnings"), "note": ("note", "notes")}
"""Look and plural of the grades of warnings, the gravest first."""


def _warnings(root: Mapping[Any, Any]) -> list[dict[str, Any]]:
    """Warnings on the physics with their grade and its look."""
    graded = [{"grade": "warning", **warning} for warning in _records(root, "warnings")]
    return [warning | {"look": _GRADES.get(warning["grade"], ("", ""))[0]} for warning in graded]


def _graded(warnings: list[dict[str, Any]]) -> str:
    """Say how many warnings there are of each grade, as ``"1 out of range, 2 warnings"``."""
    counts = {grade: sum(w["grade"] == grade for w in warnings) for grade in _GRADES}
    named = [f"{n} {grade if n == 1 else _GRADES[grade][1]}" for grade, n in counts.items() if n]
    return ", ".join(named) or f"{len(warnings)} warnings"


def _law_key(tree: DataTree) -> list[dict[str, str]]:
    meanings = entries(group_attrs(tree, "scenario"), "laws", {})
    return [
        {"name": str(law), "meaning": str(text), "colour": law_style(law, "")["color"]}
        for law, text in meanings.items()
    ]


def _case_groups(parameters: list[dict[str, Any]]) -> list[tuple[str, list[dict[str, Any]]]]:
    """Parameters by the table of the case file they stand in, in their order."""
    groups: dict[str, list[dict[str, Any]]] = {}
    for parameter in parameters:
        table, dot, key = str(parameter.get("key", "")).rpartition(".")
        groups.setdefault(table if dot else "", []).append(parameter | {"short": key})
    return list(groups.items())


_UNITS = "[kM]?N|k?Hz|dB|%|[µmk]?m|m/s|[GM]?Pa|[µm]?s|mm²|µm²|g"


@cache
def _template() -> Template:
    environment = Environment(
        loader=PackageLoader("asperity.report", ""),
        autoescape=True,
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    environment.filters["unbroken"] = _unbroken
    return environment.get_template("report.html.jinja")


def _unbroken(text: str) -> str:
    """Keep numbers and their units on one line."""
    return re.sub(rf"(?<=\d) (?=(?:{_UNITS})(?!\w))", "\u00a0", text)


def page(tree: DataTree) -> str:
    """The whole page as HTML text.

    Parameters
    ----------
    tree : xarray.DataTree
        A result of a run.

    Returns
    -------
    str
        One self-contained document: styles and figures inside, nothing loaded from elsewhere.
    """
    root, scenario = dict(tree.attrs), group_attrs(tree, "scenario")
    parameters = _records(scenario, "parameters")
    warnings = _warnings(root)
    return _template().render(
        title=root.get("title") or scenario.get("kind") or "Rolling contact",
        verdict=root.get("verdict", ""),
        version=root.get("asperity_version", "unknown"),
        created=root.get("created", ""),
        seed=root.get("seed", ""),
        case=root.get("case", ""),
        kind=scenario.get("kind", ""),
        citations=[str(text) for text in entries(root, "citations", [])],
        warnings=warnings,
        graded=_graded(warnings),
        case_groups=_case_groups(parameters),
        changed=sum(not parameter.get("is_default", True) for parameter in parameters),
        numerics=_records(scenario, "numerics"),
        laws=_law_key(tree),
        sections=sections(tree),
        light=Markup(colour_variables(dark=False)),
        dark=Markup(colour_variables(dark=True)),
    )
