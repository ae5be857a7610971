"""How much roughness each band of wavelengths may bear: by what each adds to the response, and by trials."""

import math
import warnings
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from typing import Any

import numpy as np
from scipy.optimize import Bounds, minimize, minimize_scalar

from asperity.arguments import Array
from asperity.errors import ComputationError, InputError
from asperity.threads import one_thread_in_linear_algebra

DECIBELS = 10.0 / math.log(10.0)
"""Of a ratio of energies whose logarithm is one."""
SLACK = 1e-6
"""By which a solution may miss a limit, dB or price."""
PRECISION = {"ftol": 1e-12, "maxiter": 500}
_NOTHING = "no texture within the limits was found"
_WIDER = "wider bounds of the levels, of the rms height or of the price"


@dataclass(frozen=True, eq=False)
class Limits:
    """What a texture may be: levels L (b,), dB re 1 µm, of its one-third octaves of wavelength."""

    start: Array  # levels that prices count from
    lowest: Array
    highest: Array
    price: Array  # of lowering a band by 1 dB; as much is saved by raising it
    budget: float = np.inf  # largest Σ price (start − L)
    rms_at_least: float = 0.0  # of all bands together, m
    rms_at_most: float = np.inf

    def __post_init__(self) -> None:
        """Refuse bounds that leave nothing between them."""
        crossed = np.flatnonzero(self.lowest > self.highest)
        if crossed.size:
            low, high = self.lowest[crossed[0]], self.highest[crossed[0]]
            received = f"{low:g} dB as lowest, {high:g} dB as highest, in band {crossed[0] + 1}"
            raise InputError("bounds of the levels", received, "lowest below highest in every band")

    def cost(self, levels: Array) -> float:
        """Price of a texture: Σ price (start − L)."""
        return float(self.price @ (self.start - levels))


@dataclass(frozen=True, eq=False)
class Response:
    """The energy of a response: a floor, and in each band as much as it has roughness.

    E(L) = floor + Σ weight 10^(L/10), relative to the square of the reference of the response's level.
    """

    weights: Array  # (b,), per µm²
    floor: float

    def energies(self, levels: Array) -> Array:
        """What each band adds (b,)."""
        return np.asarray(self.weights * energy_of(levels))

    def level(self, levels: Array) -> float:
        """10 lg E(L), dB."""
        return float(10.0 * np.log10(self.floor + self.energies(levels).sum()))


def energy_of(levels: Array) -> Array:
    """Mean square of each band, µm², of levels in dB re 1 µm."""
    return np.asarray(10.0 ** (levels / 10.0))


def rms_of(levels: Array) -> float:
    """Rms height of all bands together, m."""
    return float(1e-6 * np.sqrt(energy_of(levels).sum()))


Valued = Callable[[Array], tuple[float, Array]]
"""A function of levels (b,), dB, with its derivatives (b,), 1/dB."""


def quietest(response: Response, limits: Limits) -> Array:
    """Find the levels (b,), dB, with the least response within limits.

    What is found is the best there is: the problem is convex in the bands' energies. Raises
    `ComputationError` where nothing lies within the limits.
    """
    heard = _log_of_sum(response.weights, response.floor)
    return _best(limits, heard, (-1.0, _cost(limits), limits.budget))


def roughest(response: Response, limits: Limits, level: float) -> Array:
    """Find the cheapest levels (b,), dB, whose response has a level, dB, or less.

    Where nothing else binds, each band adds to the response in proportion to its price:
    weight 10^(L/10) = price (10^(level/10) − floor)/Σ price. Convex, as `quietest`; raises the same.
    """
    heard = _log_of_sum(response.weights, response.floor)
    found = _best(limits, _cost(limits), (-1.0, heard, level / DECIBELS))
    if limits.cost(found) > limits.budget + SLACK:
        raise ComputationError(f"{_NOTHING} (its price is {limits.cost(found):.3g})", _WIDER)
    return found


def _cost(limits: Limits) -> Valued:
    return lambda levels: (limits.cost(levels), -limits.price)


def _log_of_sum(weights: Array, floor: float = 0.0) -> Valued:
    """Logarithm of a floor and what each band adds to it."""

    def of(levels: Array) -> tuple[float, Array]:
        each = weights * energy_of(levels)
        total = floor + each.sum()
        return float(np.log(total)), each / total / DECIBELS

    return of


def _best(limits: Limits, least: Valued, *kept: tuple[float, Valued, float]) -> Array:
    """Levels within limits at which one function is least, others above (1.0) or below (−1.0) bounds."""
    rms = zip((1.0, -1.0), (limits.rms_at_least, limits.rms_at_most), strict=True)
    rough = _log_of_sum(np.ones_like(limits.start))
    every = [*kept, *((sign, rough, 2.0 * math.log(1e6 * bound)) for sign, bound in rms if bound)]
    constraints: list[Any] = [
        {
            "type": "ineq",
            "fun": lambda x, sign=sign, of=of, bound=bound: sign * (of(x)[0] - bound),
            "jac": lambda x, sign=sign, of=of: sign * of(x)[1],
        }
        for sign, of, bound in every
        if math.isfinite(bound)
    ]
    start, box = np.clip(limits.start, limits.lowest, limits.highest), Bounds(limits.lowest, limits.highest)
    how: Any = {"jac": True, "bounds": box, "constraints": constraints, "options": PRECISION}
    with one_thread_in_linear_algebra():  # more take many times as long for so few numbers
        levels = minimize(least, start, method="SLSQP", **how).x
    if any(each["fun"](levels) < -SLACK for each in constraints):
        raise ComputationError(f"{_NOTHING} (limits exclude each other)", _WIDER)
    return np.clip(levels, limits.lowest, limits.highest)


MOST_ROUNDS = 12
SETTLED_LEVEL = 0.05
"""Change of the response that no longer counts, dB."""
HALVINGS = 3
"""How often a step that makes it louder is halved, at most."""
LAY_TRIALS = 8
LAY_PRECISION = 0.05
"""Of the logarithm of the lay."""
SMALLEST_SHARE = 0.1
"""Of a weight that one round leaves at least: one record says no more."""
RELAXATION = 0.7
"""How far weights follow a trial where a limit is kept: responses steeper than in proportion would swing."""
LEAST_MOVE = 0.02
"""Change of a band's roughness, relative, below which it says nothing of its weight."""


@dataclass(frozen=True, eq=False)
class Trial:
    """A texture that was rolled over."""

    levels: Array  # (b,), of the bands that may be changed, dB re 1 µm
    lateral: float | None
    energies: Array  # (b,), of the response while each is passed
    rest: float  # energy of the response outside of them

    @property
    def level(self) -> float:
        """Level of the response, dB."""
        return float(10.0 * np.log10(self.energies.sum() + self.rest))


Roll = Callable[[Array, float | None], Trial]
"""Rolls over a texture of levels (b,) and a lay."""


def search(
    roll: Roll,
    start: Trial,
    limits: Limits,
    limit: float | None,
    lay: tuple[float, float] | None,
    told: Callable[[str], None],
) -> tuple[list[Trial], bool]:
    """Search the best texture; trials that it went on from, the best last, and whether the search settled.

    Parameters
    ----------
    roll : callable
        What rolls.
    start : Trial
        The texture of the case.
    limits : Limits
        What the texture may be.
    limit : float or None
        Level of the response that is kept at the least price; without one, the response is made small.
    lay : (float, float) or None
        Between which the lay is chosen.
    told : callable
        Is told of each trial.

    Notes
    -----
    Each round takes the response for a sum over bands, each in proportion to its roughness, and finds the
    best levels for it. Where a limit is kept, the proportions follow those of each trial; where the response
    is made small, they are the slopes between the last two. A response that is such a sum takes two rounds.
    """
    find = _quieter if limit is None else partial(_up_to, limit=limit)

    def at(lateral: float | None) -> Callable[[Array], Trial]:
        def rolled(levels: Array) -> Trial:
            trial = roll(levels, lateral)
            told(f"{trial.level:.2f} dB, rms {1e6 * rms_of(levels):.3g} µm")
            return trial

        return rolled

    trials, settled = find(at(start.lateral), [start], limits)
    if lay is not None:
        trials.append(_best_lay(roll, trials[-1], lay, told))
        trials, settled = find(at(trials[-1].lateral), trials, limits)
    return trials, settled


def _up_to(
    rolled: Callable[[Array], Trial], trials: list[Trial], limits: Limits, limit: float
) -> tuple[list[Trial], bool]:
    """Find the cheapest levels that keep a limit."""
    response, before = _in_proportion(trials[-1]), len(trials)
    for _ in range(MOST_ROUNDS):
        last = trials[-1]
        trial = rolled(roughest(response, limits, limit))
        trials, found = [*trials, trial], _in_proportion(trial)
        weights = response.weights ** (1.0 - RELAXATION) * found.weights**RELAXATION
        response = Response(weights, found.floor)
        still = np.abs(trial.levels - last.levels).max() < SETTLED_LEVEL
        if abs(trial.level - limit) < SETTLED_LEVEL or (still and trial.level < limit):
            return trials, True
    return [*trials, min(trials[before:], key=lambda each: abs(each.level - limit))], False


def _quieter(
    rolled: Callable[[Array], Trial], trials: list[Trial], limits: Limits
) -> tuple[list[Trial], bool]:
    """Find the levels with the least response; the texture of the case may lie outside of the limits."""
    first = trials[-1]
    response = _in_proportion(first)
    best = rolled(quietest(response, limits))
    trials, response = [*trials, best], _by_slopes(response, first, best)
    for _ in range(MOST_ROUNDS):
        wanted = quietest(response, limits)
        if response.level(wanted) > best.level - SETTLED_LEVEL:
            return trials, True
        trial = rolled(wanted)
        for _ in range(HALVINGS):
            if trial.level < best.level:
                break
            trial = rolled(_between(trial.levels, best.levels))
        trials, response = [*trials, trial], _by_slopes(response, best, trial)
        if trial.level > best.level - SETTLED_LEVEL:
            return [*trials, min(best, trial, key=lambda each: each.level)], True
        best = trial
    return trials, False


def _between(first: Array, second: Array) -> Array:
    """Half way in energies: limits that both keep are kept there, as they are convex in them."""
    return np.asarray(10.0 * np.log10(0.5 * (energy_of(first) + energy_of(second))))


def _in_proportion(trial: Trial) -> Response:
    return Response(trial.energies / energy_of(trial.levels), trial.rest)


def _by_slopes(response: Response, last: Trial, trial: Trial) -> Response:
    """Take each band's slope between two trials; what that leaves of the energy is the floor.

    A band whose energy comes from elsewhere, from other bands or another body, is not worth lowering.
    """
    before, after = energy_of(last.levels), energy_of(trial.levels)
    moved = np.abs(after - before) > LEAST_MOVE * np.maximum(before, after)
    slope = np.divide(
        trial.energies - last.energies, after - before, out=response.weights.copy(), where=moved
    )
    largest = trial.energies / after  # no band adds more than all it has
    weights = np.clip(slope, np.minimum(SMALLEST_SHARE * response.weights, largest), largest)
    return Response(weights, trial.rest + float(np.sum(trial.energies - weights * after)))


def _best_lay(roll: Roll, trial: Trial, lay: tuple[float, float], told: Callable[[str], None]) -> Trial:
    """Choose the lay that makes the least of a texture's response."""
    rolled = [trial]

    def louder(logarithm: float) -> float:
        lateral = float(np.exp(logarithm))
        rolled.append(roll(trial.levels, lateral))
        told(f"{rolled[-1].level:.2f} dB, lay {lateral:.3g}")
        return rolled[-1].level

    low, high = np.log(lay)
    for end in (low, high):
        louder(end)
    with warnings.catch_warnings(action="ignore", category=RuntimeWarning):  # of the last of few trials
        minimize_scalar(
            louder, bounds=(low, high), method="bounded",
            options={"maxiter": LAY_TRIALS, "xatol": LAY_PRECISION},
        )  # fmt: skip
    allowed = rolled if trial.lateral is not None and lay[0] <= trial.lateral <= lay[1] else rolled[1:]
    return min(allowed, key=lambda each: each.level)
