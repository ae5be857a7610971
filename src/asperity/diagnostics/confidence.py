"""How sure a verdict is: how often one like it was right, on measured records."""

import numpy as np

from asperity.arguments import Array

COEFFICIENTS = {
    "blows": (1.75, 0.00, 0.00, 0.00),
    "elsewhere": (0.28, 0.72, 0.32, 0.51),
    "fault": (0.51, 1.06, 0.55, 0.46),
    "fault, shaft not found": (0.68, 1.09, 0.49, 0.85),
    "nothing": (1.97, 0.00, 0.00, 0.00),
    "sound": (5.61, 0.00, 0.00, 0.00),
}
"""Log-odds by kind of verdict: a constant, and slopes over the `features`.

By `benchmarks/bearing_verdicts.py DATA --calibrate`: pieces of 0.25 to 4 s of 28 records from three rigs,
with noise and without, of bearings with faults of the rings and of sound ones, asked at right speeds and at
wrong ones by a factor of 0.25 to 4; as if half of all bearings had a fault, and four of five speeds were
right.
"""
SCALE, MOST = 10.0, 40.0
"""Of margin and support: unit, and from where on more of it counts no more."""
FAINT, DEEP = 0.1, 1.0
"""Depths, of which the logarithm counts between them."""
LEAST = 0.03
"""Confidence, and doubt, at least: of 28 records that are all right the next one is by 29/30 (Laplace)."""


def features(margin: float, support: float, depth: float) -> Array:
    """What the log-odds are linear in, (3,)."""
    ahead = np.clip([margin, support], 0.0, MOST) / SCALE
    return np.append(ahead, np.log(np.clip(depth, FAINT, DEEP) / FAINT))


def sure(kind: str, margin: float = 0.0, support: float = 0.0, depth: float = 0.0) -> float:
    """How sure a verdict is, 0.03 to 0.97.

    Parameters
    ----------
    kind : str
        ``"fault"`` of a part at the speed given; ``"fault, shaft not found"``; ``"elsewhere"``: of a part at
        another speed; ``"blows"`` of no part at the speed given; ``"sound"``: lines of the shaft and none of
        a part; ``"nothing"``: neither.
    margin, support : float
        Score by which the hypothesis is ahead of the next one, and how clearly the shaft speaks for it.
    depth : float
        Share by which the envelope follows the blows.

    Returns
    -------
    float
        By a logistic line of these, fitted to measured records.
    """
    constant, *slopes = COEFFICIENTS[kind]
    odds = constant + features(margin, support, depth) @ np.array(slopes)
    return float(np.clip(1.0 / (1.0 + np.exp(-odds)), LEAST, 1.0 - LEAST))
