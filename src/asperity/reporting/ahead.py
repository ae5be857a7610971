"""Figures drawn while a run still computes, from what is already known of its result."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from contextlib import suppress
from typing import NamedTuple

from matplotlib.figure import Figure
from xarray import DataTree

from asperity.reporting.data import Looks, noted
from asperity.reporting.page import Picture, picture
from asperity.reporting.part import Part
from asperity.reporting.style import frequency_axis, legend_above, new_figure, styled
from asperity.reporting.svg import drawing_of
from asperity.reporting.templates import page_template


class DrawnAhead(NamedTuple):
    """A picture, and all that was looked at for it: a result that says the same has the same picture."""

    picture: Picture
    looks: Looks


def drawn_ahead(known: DataTree, parts: Sequence[Part], enough: Callable[[], bool]) -> dict[str, DrawnAhead]:
    """Draw figures from what is known of a result, one after the other until it is enough, by name."""
    found = {}
    for part in parts:
        if enough():
            break
        with noted() as looks, suppress(Exception):  # what it failed for may not be known yet
            found[part.name] = DrawnAhead(picture(known, part), looks)
    return found


def warm_up() -> None:
    """Draw a figure for nobody, and read the page: what is done but once need not wait for a result."""
    drawing_of(_any_figure(), "warm-up")
    page_template("report.html.jinja")


@styled()
def _any_figure() -> Figure:
    figure = new_figure(3.9)
    axes, image = figure.subplots(2, 1)
    axes.semilogy([20.0, 5000.0], [1.0, 10.0], label="line")
    frequency_axis(axes, 20.0, 5000.0)
    legend_above(axes)
    figure.colorbar(image.pcolormesh([[0.0, 1.0], [1.0, 0.0]], rasterized=True), ax=image)
    return figure
