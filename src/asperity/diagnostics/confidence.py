"""How sure a verdict is: how often one like it was right, on measured records."""

from dataclasses import dataclass

import numpy as np

from asperity.arguments import Array

COEFFICIENTS = {
    "ball": (-2.59, 0.92, 1.11, 0.00, 0.00),
    "blows": (1.11, 0.00, 0.00, 0.00, 0.95),
    "elsewhere": (0.06, 0.62, 0.58, 0.00, 0.46),
    "fault": (1.15, 0.71, 0.54, 0.55, 0.53),
    "fault, shaft not found": (0.78, 0.35, 0.19, 0.54, 0.89),
    "nothing": (1.21, 0.00, 0.00, 0.00, 0.00),
    "sound": (1.82, 0.00, 0.00, 0.00, 0.00),
}
"""Log-odds by kind of verdict: a constant, and slopes over the `Basis.features`.

By `benchmarks/bearing_verdicts.py DATA --calibrate`: pieces of 2 to 120 turns of 28 records from three rigs,
with noise and without, of bearings with faults of the rings and of sound ones, asked at right speeds and at
wrong ones by a factor of 0.16 to 6.3; as if half of all bearings had a fault, and four of five speeds were
right. Those of a ball by made signals beside these, among which no ball has a fault. Those of no part,
``"nothing"`` and ``"sound"``, by `benchmarks/bearing_machines.py`, seeds 1201 and 1202, weighted alike: the
rigs have no fault so faint that it hides, machines with hum, gears and noise do.
"""
SCALE, MOST = 10.0, 40.0
"""Of margin and support: unit, and from where on more of it counts no more."""
FAINT, DEEP = 0.1, 1.0
"""Depths, of which the logarithm counts between them."""
SHORT, LONG = 2.0, 50.0
"""Turns of the shaft, of which the logarithm counts between them."""
LEAST = 0.03
"""Confidence, and doubt, at least: of 28 records that are all right the next one is by 29/30 (Laplace)."""
FOREIGN = 0.2
"""Share of records, as is supposed, whose blows are those of another bearing or machine where no line of the
shaft speaks for this one."""


def own_share(chance: float) -> float:
    """How sure it is that blows where a part has them are this bearing's, where those of others lie there by
    chance (Bayes)."""
    return (1.0 - FOREIGN) / (1.0 - FOREIGN + FOREIGN * chance)


def chance_elsewhere(support: float) -> float:
    """Chance that lines of a shaft speak so clearly for blows of something else, at some speed or other.

    Of 180 made records of another bearing alone one in ten has a support of 15, one in a hundred of 20.
    """
    return float(min(10.0 ** (2.0 - support / 5.0), 1.0))


@dataclass(frozen=True)
class Basis:
    """What a verdict rests on, and how sure that makes it.

    Attributes
    ----------
    kind : str
        ``"fault"`` of a ring at the speed given; ``"fault, shaft not found"``; ``"ball"``: of a ball at that
        speed; ``"elsewhere"``: of a part at another speed; ``"blows"`` of no part at the speed given;
        ``"sound"``: lines of the shaft and none of a part; ``"nothing"``: neither.
    turns : float
        Of the shaft in a piece of the record.
    margin, support : float
        Score by which the hypothesis is ahead of the next one, and how clearly the shaft speaks for it.
    depth : float
        Share by which the envelope follows the blows.
    """

    kind: str
    turns: float
    margin: float = 0.0
    support: float = 0.0
    depth: float = 0.0

    @property
    def features(self) -> Array:
        """What the log-odds are linear in, (4,)."""
        ahead = np.clip([self.margin, self.support], 0.0, MOST) / SCALE
        deep = np.log(np.clip(self.depth, FAINT, DEEP) / FAINT)
        return np.array([*ahead, deep, np.log(np.clip(self.turns, SHORT, LONG) / SHORT)])

    @property
    def confidence(self) -> float:
        """How sure the verdict is, 0.03 to 0.97: by a logistic line, fitted where the fault is known."""
        constant, *slopes = COEFFICIENTS[self.kind]
        odds = constant + self.features @ np.array(slopes)
        return float(np.clip(1.0 / (1.0 + np.exp(-odds)), LEAST, 1.0 - LEAST))
