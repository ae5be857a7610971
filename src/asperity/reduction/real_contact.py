"""Whether the grid resolves the real contact of rough bodies."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray


def isolated_share(pressure: NDArray[np.float64]) -> float:
    """Share of the force on cells that touch alone: asperities that the grid does not resolve.

    Of a pressure (nx, ny), Pa; 0 without contact. Cells count as alone where none of their four neighbours is
    in contact.
    """
    total = float(pressure.sum())
    touching = np.pad(pressure > 0.0, 1)
    beside = touching[:-2, 1:-1] | touching[2:, 1:-1] | touching[1:-1, :-2] | touching[1:-1, 2:]
    return float(pressure[~beside].sum()) / total if total > 0.0 else 0.0
