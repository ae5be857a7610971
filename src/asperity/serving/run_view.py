"""What the page shows of runs: force and texture to watch, figures and sounds; and several side by side."""

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
from scipy.ndimage import uniform_filter1d
from xarray import DataTree

from asperity.arguments import Array
from asperity.reporting import chart, data, page, payload
from asperity.reporting.comparison_page import compared_blocks, summary
from asperity.reporting.figure import PageFigure
from asperity.reporting.templates import page_template
from asperity.results import read_result
from asperity.scenes.figures import bearing
from asperity.scenes.figures.force import force_bands, force_envelope
from asperity.scenes.report import comparison_of, report
from asperity.schema import contact, provenance
from asperity.schema.rolling import CONTACT_FORCE, POSITION, TIME
from asperity.serving.stored_runs import sounds_of_run

PIECE = 20_000
"""Samples of a law, at most, that are watched one by one: those over the piece of texture that is kept."""
FIGURES = (*bearing.QUIET, force_bands, force_envelope)
LINE_POINTS = 20_000
STRETCH = 4
"""Length over which a texture that is looked at has no mean, in its widths."""


def viewed_run(path: str) -> dict[str, Any]:
    """Everything that the page draws of a run, by the path of its ``run.nc``."""
    tree = read_result(path)
    colours = data.law_colours(tree)
    return {
        "title": data.stated(tree, provenance.TITLE) or "",
        "verdict": data.stated(tree, provenance.VERDICT) or "",
        "warnings": [
            {"grade": str(each.get("grade", "warning")), "message": str(each.get("message", ""))}
            for each in data.json_list(tree, provenance.WARNINGS)
        ],
        "laws": [
            {"name": law.name, "colour": law.colour, "dark": colours[law.colour]}
            for law in data.law_entries(tree).values()
        ],
        "force": _force(tree),
        "texture": _texture(tree),
        "patch": {
            "along": data.number(tree, contact.HERTZ_RADIUS),
            "across": data.number(tree, contact.HERTZ_RADIUS_ACROSS),
            "load": data.number(tree, contact.WORKING_LOAD),
        },
        "sounds": sounds_of_run(Path(path).parent),
        **told_blocks(page.drawn_figures(tree, FIGURES), data.unticked_laws(tree)),
    }


def _force(tree: DataTree) -> dict[str, Any] | None:
    """Force of each law, sample by sample over the texture that is kept."""
    if not data.present(tree, CONTACT_FORCE, TIME, POSITION):
        return None
    time = data.values(tree, TIME)
    position = data.values(tree, POSITION)
    count = min(int(np.searchsorted(position - position[0], _watched(tree), side="right")), PIECE, len(time))
    pieces = {law: data.of_law(tree, CONTACT_FORCE, law)[:count] for law in data.laws(tree, CONTACT_FORCE)}
    return {
        "watched": float(time[count - 1] - time[0]),
        "distance": position[:count] - position[0],
        "pieces": pieces,
        "range": {law: [float(np.nanmin(force)), float(np.nanmax(force))] for law, force in pieces.items()},
    }


def _watched(tree: DataTree) -> float:
    """Length of the texture that is kept, m; of a line, of its first points."""
    along = contact.PATH_X if data.present(tree, contact.PATH_HEIGHTS) else contact.DISTANCE
    if not data.present(tree, along):
        return np.inf
    return float(data.values(tree, along)[:LINE_POINTS][-1])


def _texture(tree: DataTree) -> dict[str, Any] | None:
    """Heights that are rolled over, seen from above; where there is only a line, that."""
    if data.present(tree, contact.PATH_HEIGHTS):
        heights = _about_long_waves(data.values(tree, contact.PATH_HEIGHTS))
        dx, dy = (_spacing(data.values(tree, entry)) for entry in (contact.PATH_X, contact.PATH_Y))
    elif data.present(tree, contact.LINE):
        heights = data.values(tree, contact.LINE)[:LINE_POINTS, None]
        dx = _spacing(data.values(tree, contact.DISTANCE))
        dy = 0.0
    else:
        return None
    return {"shape": list(heights.shape), "dx": dx, "dy": dy, "heights": heights - heights.mean()}


def _about_long_waves(heights: Array) -> Array:
    """Heights (nx, ny) about their mean over a stretch around each row: long waves would hide all others."""
    stretch = min(STRETCH * heights.shape[1] | 1, len(heights))  # an odd one has a middle
    return heights - uniform_filter1d(heights.mean(axis=1), stretch, mode="nearest")[:, None]


def _spacing(coordinate: Array) -> float:
    return float(coordinate[1] - coordinate[0]) if len(coordinate) > 1 else 0.0


# --- figures and tables


def told_blocks(blocks: Sequence[page.Block], unticked: Sequence[str] = ()) -> dict[str, str]:
    """Elements of figures and tables, one after the other, and the charts that go into them.

    Laws that are `unticked` are not shown at first.
    """
    macros: Any = page_template("blocks.html.jinja").module
    charts = {block.name: block.chart for block in blocks if isinstance(block, PageFigure)}
    # no file lies beside this page
    elements = (
        macros.figure(replace(block, file="")) if isinstance(block, PageFigure) else macros.table(block)
        for block in blocks
    )
    return {"blocks": "".join(elements), "charts": payload.charts_json(charts, chart.COLOURS, unticked)}


# --- several runs


def compared_runs(paths: list[str], names: list[str]) -> dict[str, Any]:
    """A sentence, and what the page of the comparison shows below it."""
    told = [name if names.count(name) == 1 else f"{name} ({n})" for n, name in enumerate(names, 1)]
    found = comparison_of(paths, told)
    return {"summary": summary(found), **told_blocks(compared_blocks(found))}


def write_report(path: str) -> dict[str, Any]:
    """Write the report of a run, with the numbers of its figures, beside its result."""
    report(read_result(path), Path(path).parent)
    return {}
