"""How far what rolls is out of round, by orders: waves around it, and the frequencies at which they pass."""

import math
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np

from asperity.arguments import Array
from asperity.reporting import data
from asperity.scenarios.scene import PreparedCase
from asperity.scenes import schema
from asperity.scenes.observer import DECLARED, Observer
from asperity.schema import Values
from asperity.spectra import level_of
from asperity.speeds import at_fastest, reached
from asperity.written_numbers import rounded

MOST_ORDERS = 60
"""Orders that are told; beyond, waves are roughness, which has its one-third octaves."""
MOST_NAMED = 3
"""Orders that are named in words."""
SMALL = 1e-3
"""Part of the largest amplitude below which an order is not named."""
MICROMETRE = 1e-6


@dataclass(frozen=True, eq=False)
class Orders:
    """Waves around what rolls.

    Parameters
    ----------
    amplitude : ndarray (n,)
        Amplitudes of orders 1, 2, …, n, m.
    revolution : float
        Turns per second.
    swing : float
        Highest less lowest point around it, m: its run-out.
    at : str
        Of which speed frequencies are, where it changes.
    """

    amplitude: Array
    revolution: float
    swing: float
    at: str = ""

    @property
    def number(self) -> Array:
        """The orders (n,), from 1."""
        return np.arange(1.0, len(self.amplitude) + 1.0)

    @property
    def level(self) -> Array:
        """Levels of the rms of each (n,), dB re 1 µm."""
        return level_of(0.5 * (self.amplitude / MICROMETRE) ** 2)

    @property
    def in_words(self) -> str:
        """Run-out and the largest orders: ``"run-out 80 µm; order 3 30 µm at 58.1 Hz, …"``."""
        largest = np.argsort(-self.amplitude, kind="stable")[:MOST_NAMED]
        told = [
            f"order {n + 1} {data.engineering(self.amplitude[n], 'm')} at "
            f"{rounded((n + 1) * self.revolution)} Hz"
            for n in largest.tolist()
            if self.amplitude[n] > SMALL * self.amplitude.max()
        ]
        return f"run-out {data.engineering(self.swing, 'm')}; amplitudes: {', '.join(told)}{self.at}"


def orders_of(prepared: PreparedCase) -> Orders | None:
    """Orders of what rolls where its line was measured around; None elsewhere, or of less than a turn."""
    case = prepared.case
    around = prepared.textures.parts.get("wheel")
    if case.rolling.line is None or around is None:
        return None
    rows = points_of_a_turn(case)
    if len(around) < rows:
        return None
    turn = around[:rows]
    count = min(MOST_ORDERS, (rows - 1) // 2)
    amplitude = 2.0 / rows * np.abs(np.fft.rfft(turn))[1 : count + 1]
    revolution = case.speed / case.rolling.circumference
    return Orders(amplitude, revolution, float(np.ptp(turn)), at_fastest(case.speed))


def points_of_a_turn(case: Any) -> int:
    """Points of the contact grid around what rolls."""
    return round(case.rolling.circumference / case.contact.spacing)


def planned_roundness(prepared: PreparedCase) -> Iterator[tuple[str, str]]:
    """Say how far what rolls is out of round; nothing where no line around it was measured."""
    case = prepared.case
    if case.rolling.line is None:
        return
    name = f"{case.ROLLING} out of round"
    if (found := orders_of(prepared)) is not None:
        yield name, found.in_words
        return
    share = len(prepared.textures.line) / points_of_a_turn(case)
    longer = math.ceil(100.0 * reached(case.speed, case.rolling.circumference)) / 100.0
    yield name, f"the run rolls {share:.0%} of a turn: orders are told from a duration of {longer:g} s on"


def orders_group(prepared: PreparedCase) -> Values:
    """Lay out the orders of what rolls, where a line around it was measured."""
    if (found := orders_of(prepared)) is None:
        return {}
    return {
        schema.ORDER: found.number.astype(int),
        schema.ORDER_FREQUENCY: found.number * found.revolution,
        schema.ORDER_LEVEL: found.level,
        schema.RUN_OUT: found.swing,
    }


OBSERVER = Observer(
    "roundness",
    DECLARED,
    orders_group,
    numerics=planned_roundness,
)
