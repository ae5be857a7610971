"""Heights at points that are equally far apart, as surfaces are cleaned and levelled."""

from dataclasses import dataclass
from typing import Any

import numpy as np

from asperity.arguments import Array

MOST_LINES = 32
"""Lines side by side, at most, that a bare array is taken for without being told."""
SLENDER = 20.0
"""Times longer than wide, in points, that such an array is at least."""


@dataclass(frozen=True, eq=False)
class EvenHeights:
    """Heights of a map or a line, m, at points that are equally far apart."""

    heights: Array
    spacing: Any
    source: str = ""

    @property
    def x(self) -> Array:
        """Coordinates (nx,) along the rolling direction in m, from zero."""
        return np.arange(len(self.heights), dtype=np.float64) * float(np.atleast_1d(self.spacing)[0])

    @property
    def missing_share(self) -> float:
        """Share of the points without a height, 0 to 1."""
        return float(np.isnan(self.heights).mean())

    @property
    def holds_lines(self) -> bool:
        """Whether the shape is that of an array of lines measured side by side rather than of a map.

        At most 32 lines, each with at least 20 times as many points; such a file knows no distance across of
        lines.
        """
        few = min(self.heights.shape)
        many = max(self.heights.shape)
        return self.heights.ndim == 2 and few <= MOST_LINES and many >= SLENDER * few
