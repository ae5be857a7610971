"""Figures of a result as files for papers: which of them, in which format."""

from __future__ import annotations

import difflib
from collections.abc import Sequence
from pathlib import Path

from xarray import DataTree

from asperity.arguments import shown
from asperity.errors import InputError
from asperity.files import atomic_write
from asperity.reporting.chart import Chart
from asperity.reporting.part import Part

FORMATS = ("svg", "pdf", "png")
NEAREST = 3
"""Names that a message about a wrong one tells."""


def figure_format(what: str, format: object) -> str:
    """Take a format of figures; `what` it is for the message."""
    if format not in FORMATS:
        raise InputError(what, shown(format), ", ".join(FORMATS))
    return str(format)


def chosen_parts(parts: Sequence[Part], names: Sequence[object]) -> list[Part]:
    """Figures by name or title, or by what only one title begins with; all where no name is given."""
    return list(dict.fromkeys(_chosen(parts, name) for name in names)) if names else list(parts)


def _chosen(parts: Sequence[Part], name: object) -> Part:
    asked = " ".join(str(name).lower().split())
    for part in parts:
        if asked in (part.name, part.title.lower()):
            return part
    begun = [part for part in parts if asked and part.title.lower().startswith(asked)]
    if len(begun) == 1:
        return begun[0]
    held = ", ".join(part.name for part in parts) or "it has none"
    near = ", ".join(f'"{part.name}" ({part.title})' for part in (begun or _nearest(parts, asked))[:NEAREST])
    remedy = f"Nearest: {near}." if near else ""
    raise InputError(
        "name of a figure", shown(name), f"a figure of this result, by name or title: {held}", remedy
    )


def _nearest(parts: Sequence[Part], asked: str) -> list[Part]:
    """Figures whose names or titles are like what was asked for, the most alike first."""

    def likeness(part: Part) -> float:
        told = (part.name, part.title.lower())
        return max(difflib.SequenceMatcher(None, asked[:100], word).ratio() for word in told)

    return sorted((part for part in parts if likeness(part) > 0.5), key=likeness, reverse=True)


def write_figures(tree: DataTree, parts: Sequence[Part], folder: Path, format: str) -> list[Path]:
    """Draw figures of a result to files of a folder, each under its name."""
    return [write_chart(part.laid_out(tree), "", folder / f"{part.name}.{format}") for part in parts]


def write_chart(chart: Chart, title: str, path: Path) -> Path:
    """Draw a chart to a file, whose ending says in which format."""
    from asperity.reporting.paper import draw, save_figure  # matplotlib, which nothing else needs

    figure = draw(chart, title)
    return atomic_write(path, lambda file: save_figure(figure, file, path.suffix[1:].lower()))
