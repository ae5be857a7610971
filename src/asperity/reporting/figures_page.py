"""A page of figures alone: of a study, of an optimised texture."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from asperity import __version__
from asperity.reporting.chart import Line
from asperity.reporting.law_entries import page_colours
from asperity.reporting.templates import PageFigure, whole_page


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
