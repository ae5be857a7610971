"""Figures and tables for the page: elements of a report, and what the script of all figures draws."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from functools import cache
from typing import Any

from asperity.reporting.chart import COLOURS, colour_variables
from asperity.reporting.page import PageFigure, page_template
from asperity.reporting.payload import chart_style, charts_json
from asperity.reporting.tables import ReportTable


def told_blocks(blocks: Sequence[PageFigure | ReportTable]) -> dict[str, str]:
    """Elements of figures and tables, one after the other, and the charts that go into them."""
    macros: Any = page_template("blocks.html.jinja").module
    # no file lies beside this page
    elements = [
        macros.figure(replace(block, file="")) if isinstance(block, PageFigure) else macros.table(block)
        for block in blocks
    ]
    charts = {block.name: block.chart for block in blocks if isinstance(block, PageFigure)}
    return {"blocks": "".join(elements), "charts": charts_json(charts, COLOURS)}


@cache
def figures_style() -> str:
    """Styles of figures, with the colours that their script asks for, light and dark."""
    light, dark = (colour_variables(dark=of) for of in (False, True))
    return (
        f":root {{ {light} }}\n@media (prefers-color-scheme: dark) {{ :root {{ {dark} }} }}\n{chart_style()}"
    )
