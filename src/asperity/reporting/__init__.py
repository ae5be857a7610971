"""One self-contained page per run, and the numbers of its figures: sees results only.

| name | what |
|---|---|
| `surface_picture`, `lines_picture` | picture of a measured surface, or of lines side by side |
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from matplotlib.figure import Figure
    from numpy.typing import NDArray

__all__ = ["lines_picture", "surface_picture"]


def surface_picture(heights: NDArray[Any], spacing: tuple[float, float], title: str) -> Figure:
    """Draw what a surface file holds: its map and the distribution of its heights.

    Heights (nx, ny), or (n,) for a line, and distances along x and y, m, positive out of the material; NaN
    where missing.
    """
    from asperity.reporting.texture import surface_picture as draw

    return draw(heights, spacing, title)


def lines_picture(lines: Sequence[NDArray[Any]], spacing: float, title: str) -> Figure:
    """Draw lines that were measured side by side, and the distribution of their heights.

    Levelled heights (n,) and the distance of points along the lines, m, positive out of the material.
    """
    from asperity.reporting.texture import lines_picture as draw

    return draw(lines, spacing, title)
