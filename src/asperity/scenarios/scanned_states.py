"""States at which a path is scanned: those that the motion visits, pair by pair."""

import numpy as np

from asperity.arguments import Array

EXPECTED = (0.75, 1.25)
"""Forces between which a motion is expected to stay, over the static loads, until it is known."""


PAIR = 2
"""States that are scanned together, each pair for itself: motions that visit others share them."""


def states_expected(approaches: Array, forces: Array, loads: Array) -> slice:
    """Which of the states (k,), m, a motion under static loads, N, is expected to visit.

    By the mean force (k,), N, of each state.
    """
    least, most = EXPECTED
    low, high = np.interp((least * loads.min(), most * loads.max()), forces, approaches)
    return states_around(approaches, (float(low), float(high)))


def states_around(approaches: Array, visited: tuple[float, float]) -> slice:
    """Which of the states (k,), m, forces between two approaches, m, depend on, in whole pairs.

    Those around them, and one beyond on either side: slopes at a state follow from its neighbours. Between
    them the interpolation is the same as from all states.
    """
    low, high = np.searchsorted(approaches, visited, side="right")
    last = len(approaches)
    first = min(max(int(low) - 2, 0), last - 2)
    end = max(min(int(high) + 2, last), 2)
    return slice(first - first % PAIR, min(end + -end % PAIR, last))


def pairs_of(states: slice) -> list[slice]:
    """Split states into the pairs that are scanned: the same ones whatever else is visited."""
    return [slice(at, min(at + PAIR, states.stop)) for at in range(states.start, states.stop, PAIR)]
