"""A page of figures alone: of a study, of an optimised texture."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from markupsafe import Markup

from asperity import __version__
from asperity.printable import printable
from asperity.reporting.chart import Line
from asperity.reporting.law_entries import page_colours
from asperity.reporting.payload import chart_script, chart_style, charts_json, script_digest
from asperity.reporting.style import colour_variables
from asperity.reporting.templates import PageFigure, page_template


def figures_page(title: str, summary: str, figures: Sequence[PageFigure], files: Mapping[str, str]) -> str:
    """The page as one self-contained HTML text, with links to files beside it, by what they are."""
    charts = {figure.name: figure.chart for figure in figures}
    marks = (mark for chart in charts.values() for panel in chart.panels for mark in panel.marks)
    colours = page_colours(mark.colour for mark in marks if isinstance(mark, Line) and mark.law)
    text = page_template("figures.html.jinja").render(
        title=title,
        summary=summary,
        version=__version__,
        files=files,
        figures=figures,
        charts=Markup(charts_json(charts, colours)),
        script=Markup(chart_script()),
        script_style=Markup(chart_style()),
        digest=script_digest(),
        light=Markup(colour_variables(dark=False, colours=colours)),
        dark=Markup(colour_variables(dark=True, colours=colours)),
    )
    return printable(text, lines=True)
