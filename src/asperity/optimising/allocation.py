"""How much roughness each band of wavelengths may bear: by what each adds to the response, and by trials."""

import warnings
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial

import numpy as np
from scipy.optimize import brentq, minimize_scalar

from asperity.arguments import Array
from asperity.errors import ComputationError, InputError
from asperity.spectra import energy_of
from asperity.written_numbers import engineering, rounded

SLACK = 1e-6
"""By which a solution may miss a limit, dB or price."""
FREE, UNHEARD = 1e-6, 1e-12
"""Of the highest price, and of the largest weight, what a band without any has: its share is a number."""
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
        """Refuse bounds, of levels, rms height and price, that leave nothing between them."""
        crossed = np.flatnonzero(self.lowest > self.highest)
        if crossed.size:
            low = self.lowest[crossed[0]]
            high = self.highest[crossed[0]]
            received = f"{low:g} dB as lowest, {high:g} dB as highest, in band {crossed[0] + 1}"
            raise InputError("bounds of the levels", received, "lowest below highest in every band")
        least = rms_of(self.lowest)
        most = rms_of(self.highest)
        wider = "Widen lowest, highest, reach, or the bands (longest, shortest)."
        if self.rms_at_least > most * (1.0 + 0.5 * SLACK):
            received = f"{engineering(self.rms_at_least, 'm')}"
            allowed = f"at most {engineering(most, 'm')}, which the highest levels of the bands have together"
            raise InputError("rms_at_least", received, allowed, wider)
        if self.rms_at_most < least * (1.0 - 0.5 * SLACK):
            received = f"{engineering(self.rms_at_most, 'm')}"
            allowed = (
                f"at least {engineering(least, 'm')}, which the lowest levels of the bands have together"
            )
            raise InputError("rms_at_most", received, allowed, wider)
        cheapest = self.cost(_shared(Response(np.ones_like(self.price), 0.0), self, 0.0))
        if cheapest > self.budget + SLACK:
            allowed = f"at least {rounded(cheapest)}, the price of the cheapest texture within the bounds"
            raise InputError("budget", rounded(self.budget), allowed, wider)

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
        return self.weights * energy_of(levels)

    def level(self, levels: Array) -> float:
        """10 lg E(L), dB."""
        return float(10.0 * np.log10(self.floor + self.energies(levels).sum()))


def rms_of(levels: Array) -> float:
    """Rms height of all bands together, m."""
    return float(1e-6 * np.sqrt(energy_of(levels).sum()))


def quietest(response: Response, limits: Limits) -> Array:
    """Find the levels (b,), dB, with the least response within limits.

    What is found is the best there is: the problem is convex in the bands' energies. Raises
    `ComputationError` where nothing lies within the limits.
    """
    return _balanced(response, limits, lambda levels: limits.budget - limits.cost(levels), cheap=False)


def roughest(response: Response, limits: Limits, level: float) -> Array:
    """Find the cheapest levels (b,), dB, whose response has a level, dB, or less.

    Where nothing else binds, each band adds to the response in proportion to its price:
    weight 10^(L/10) = price (10^(level/10) − floor)/Σ price. Convex, as `quietest`; raises the same.
    """
    found = _balanced(response, limits, lambda levels: level - response.level(levels), cheap=True)
    if limits.cost(found) > limits.budget + SLACK:
        raise ComputationError(f"{_NOTHING} (its price is {rounded(limits.cost(found))})", _WIDER)
    return found


def _balanced(response: Response, limits: Limits, left: Callable[[Array], float], *, cheap: bool) -> Array:
    """Levels that leave nothing of a limit; where those leave some, the cheapest, or the quietest of all."""

    def of(silence: float) -> float:
        return left(_shared(response, limits, silence))

    cheapest = _shared(response, limits, 0.0)
    softest = _least_heard(response, limits)
    if max(left(cheapest), left(softest)) < -SLACK:
        raise ComputationError(f"{_NOTHING} (a limit excludes the others)", _WIDER)
    best = cheapest if cheap else softest
    below = 0.0
    if left(best) >= 0.0:
        return best
    low, high, *_ = _energies(limits)
    shares = _at_least(limits.price, FREE) / _at_least(response.weights, UNHEARD)
    for silence in 10.0 ** np.arange(np.log10((shares / high).min()), np.log10((shares / low).max()) + 1.0):
        if of(silence) * left(cheapest) <= 0.0:
            return _shared(response, limits, _root(of, below, silence))
        below = silence
    return softest


def _root(of: Callable[[float], float], low: float, high: float) -> float:
    return float(brentq(of, low, high, xtol=1e-300, rtol=1e-15))


def _least_heard(response: Response, limits: Limits) -> Array:
    """Levels whatever they cost: as low as they may be, and the least rms height where it is heard least."""
    low, high, least, _ = _energies(limits)
    order = np.argsort(response.weights)
    room = (high - low)[order]
    low[order] += np.clip(least - low.sum() - (np.cumsum(room) - room), 0.0, room)
    return _levels(low, limits)


def _energies(limits: Limits) -> tuple[Array, Array, float, float]:
    """Bounds of the energies of each band (b,), and of all together, µm²."""
    low = energy_of(limits.lowest)
    high = energy_of(limits.highest)
    least, most = ((1e6 * rms) ** 2 for rms in (limits.rms_at_least, limits.rms_at_most))
    return low, high, least, most


def _levels(energies: Array, limits: Limits) -> Array:
    return np.clip(10.0 * np.log10(energies), limits.lowest, limits.highest)


def _at_least(values: Array, share: float) -> Array:
    return np.maximum(values, share * (values.max() or 1.0))


def _shared(response: Response, limits: Limits, silence: float) -> Array:
    """Levels of which each band's energy is price/(silence weight − relief), between its bounds.

    They are the best at that weight of silence over price: by its energy e the price of a band falls as
    price/e, and the response grows as its weight. The relief is that of the limits of the rms height.
    """
    low, high, least, most = _energies(limits)
    price = _at_least(limits.price, FREE)
    heard = silence * _at_least(response.weights, UNHEARD)

    def energies(below: Array) -> Array:
        return np.clip(np.divide(price, below, out=np.full_like(low, np.inf), where=below > 0.0), low, high)

    found = energies(heard)
    wanted = float(np.clip(np.clip(found.sum(), least, most), low.sum(), high.sum()))
    if wanted != found.sum():
        beyond = heard - heard.min()  # where silence weighs far more than prices, relief is lost beside it
        ends = -2.0 * (price / low).max(), beyond.max()
        relief = _root(lambda relief: energies(beyond - relief).sum() - wanted, *ends)
        found = energies(beyond - relief)
    return _levels(found, limits)


MOST_ROUNDS = 12
SETTLED_LEVEL = 0.05
"""Change of the response that no longer counts, dB."""
AIMED_BELOW = 0.5 * SETTLED_LEVEL
"""By how much a limit is undercut, dB: what lies as far on either side of that keeps it."""
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
            told(f"{trial.level:.2f} dB, rms {rounded(1e6 * rms_of(levels))} µm")
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
    response = _in_proportion(trials[-1])
    before = len(trials)
    aimed = limit - AIMED_BELOW
    for _ in range(MOST_ROUNDS):
        last = trials[-1]
        trial = rolled(roughest(response, limits, aimed))
        trials = [*trials, trial]
        found = _in_proportion(trial)
        weights = response.weights ** (1.0 - RELAXATION) * found.weights**RELAXATION
        response = Response(weights, found.floor)
        still = np.abs(trial.levels - last.levels).max() < SETTLED_LEVEL
        if abs(trial.level - aimed) <= AIMED_BELOW or (still and trial.level <= limit):
            return trials, True

    def rank(trial: Trial) -> tuple[float, float]:
        """By how much the limit is missed, then the price."""
        return max(trial.level - limit, 0.0), limits.cost(trial.levels)

    return [*trials, min(trials[before:], key=rank)], False


def _quieter(
    rolled: Callable[[Array], Trial], trials: list[Trial], limits: Limits
) -> tuple[list[Trial], bool]:
    """Find the levels with the least response; the texture of the case may lie outside of the limits."""
    first = trials[-1]
    response = _in_proportion(first)
    best = rolled(quietest(response, limits))
    trials = [*trials, best]
    response = _by_slopes(response, first, best)
    for _ in range(MOST_ROUNDS):
        wanted = quietest(response, limits)
        if response.level(wanted) > best.level - SETTLED_LEVEL:
            return trials, True
        trial = rolled(wanted)
        for _ in range(HALVINGS):
            if trial.level < best.level:
                break
            trial = rolled(_between(trial.levels, best.levels))
        trials = [*trials, trial]
        response = _by_slopes(response, best, trial)
        if trial.level > best.level - SETTLED_LEVEL:
            return [*trials, min(best, trial, key=lambda each: each.level)], True
        best = trial
    return trials, False


def _between(first: Array, second: Array) -> Array:
    """Half way in energies: limits that both keep are kept there, as they are convex in them."""
    return 10.0 * np.log10(0.5 * (energy_of(first) + energy_of(second)))


def _in_proportion(trial: Trial) -> Response:
    return Response(trial.energies / energy_of(trial.levels), trial.rest)


def _by_slopes(response: Response, last: Trial, trial: Trial) -> Response:
    """Take each band's slope between two trials; what that leaves of the energy is the floor.

    A band whose energy comes from elsewhere, from other bands or another body, is not worth lowering.
    """
    before = energy_of(last.levels)
    after = energy_of(trial.levels)
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
        told(f"{rolled[-1].level:.2f} dB, lay {rounded(lateral)}")
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
