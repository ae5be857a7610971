"""States at which a path is scanned: those that the motion visits, each for itself."""

import numpy as np

from asperity.arguments import Array

EXPECTED = (0.75, 1.25)
"""Forces between which a motion is expected to stay, over the static loads, until it is known."""
FEWEST = 3
"""States, at least, through which forces are interpolated: F^(2/3) is nearly straight, and a little bent."""


def states_expected(approaches: Array, forces: Array, loads: Array) -> slice:
    """Which of the states (k,), m, a motion under static loads, N, is expected to visit.

    By the mean force (k,), N, of each state.
    """
    least, most = EXPECTED
    low, high = np.interp((least * loads.min(), most * loads.max()), forces, approaches)
    return states_around(approaches, (float(low), float(high)))


def states_around(approaches: Array, visited: tuple[float, float]) -> slice:
    """Which of the states (k,), m, lie around forces between two approaches, m: `FEWEST` or more.

    A slope at the outermost follows from one side: levels are within 0.05 dB of those through all states.
    """
    low, high = np.searchsorted(approaches, visited, side="right")
    last = len(approaches)
    first = min(max(int(low) - 1, 0), last - 1)
    end = max(min(int(high) + 1, last), min(first + FEWEST, last))
    return slice(max(min(first, end - FEWEST), 0), end)
