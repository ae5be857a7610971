"""Templates of pages, and a figure as they take it."""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cache

from jinja2 import Environment, PackageLoader, StrictUndefined, Template
from markupsafe import Markup

from asperity.printable import printable
from asperity.reporting.chart import Chart
from asperity.reporting.payload import chart_script, chart_style, charts_json, script_digest
from asperity.reporting.style import colour_variables
from asperity.reporting.tables import ReportTable

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
