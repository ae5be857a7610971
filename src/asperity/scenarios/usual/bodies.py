"""Any two bodies."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from asperity.rolling.bodies import RolledOver, Rolls


@dataclass(frozen=True, eq=False)
class Bodies:
    """What is rolled over, and what rolls."""

    over: RolledOver
    rolls: Rolls


def square_transfer(bodies: Any, stiffness: float, frequency: NDArray[np.float64]) -> None:
    """Nothing is known of the linear contact force of bodies that are known in time alone."""
