"""Fitting a case: from measurements and free keys to values, what is known of them, and the new case."""

import os
import warnings
from collections.abc import Collection, Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from asperity.arguments import Array, FilePath, NDArray, file_path, require, shown, whole
from asperity.case import cases
from asperity.case.any_case import AnyCase, entry_of
from asperity.case.form import case_key
from asperity.case.written_values import in_words
from asperity.errors import BandsWarning, InputError
from asperity.fitting import determined
from asperity.fitting.fitted import Estimate, Fitted, Undetermined
from asperity.fitting.free import (
    Free,
    Range,
    free_bands,
    free_key,
    is_spectrum,
    read_free,
    read_range,
)
from asperity.fitting.interval_ends import LIMIT, MOST, Bowl, End
from asperity.fitting.problem import Problem
from asperity.fitting.row import NEIGHBOURS, Row, places_of
from asperity.fitting.search import (
    FAR,
    FINE,
    ROUGH,
    SCREENED,
    TOLERANCE,
    Optimum,
    descend,
    on_limits,
    starts_within,
    updated_slopes,
)
from asperity.fitting.tried import FitRuns
from asperity.observables import observable, reading
from asperity.observables.observable import Measured, Values
from asperity.progress import Progress, shown_progress
from asperity.running import with_choices_fixed
from asperity.store import Store, made
from asperity.threads import one_thread_in_linear_algebra
from asperity.written_numbers import count_of, rounded

FORMAT = 1
"""Raise it when what is kept of a search no longer means what it meant."""
USUALLY_LEFT_OUT = 1.0
"""By a case, dB, while nothing is known of it."""
RUNS = 15
"""Most steps of a search in which each takes a run."""
RUNS_AGAIN = 5
"""Most steps of such a search that goes on from another's end."""
OF_RUNS = 1e-3
"""Part by which a sum of squares still changes where each of its values takes a run."""
ROUNDS = 6
"""Rounds at most in which what the case leaves out is found."""
SAME = 0.05
"""Part by which it may still change in the last of them."""
STARTS = 8
"""From which a smallest sum of squares is sought, where predictions are quick."""
STARTS_OF_JUMPS = 2
"""The same where runs jump as a value is moved, and rise and fall with it."""
REACH = float(np.log(10.0))
"""On the scale of the search, how far from the case it then begins: a factor of ten."""
RIVAL = 1.05
"""Ratio of root mean squares up to which another minimum meets the data as well."""
NEAR = 0.1
"""On the scale of the search, by which minima are apart at least."""
LIMITS = {-1: "least", 0: "", 1: "largest"}
"""What a value on a limit lies on, by `on_limits`."""
FreeKeys = Sequence[str] | Mapping[str, object] | None


def fit(
    case: FilePath | Mapping[str, Any] | AnyCase,
    measured: object = None,
    free: FreeKeys = None,
    progress: Progress | None = None,
    *,
    where: Mapping[str, str] | None = None,
    what: str | None = None,
    starts: int | None = None,
) -> Fitted:
    """Fit keys of a case to what was measured.

    Parameters
    ----------
    case : path, mapping or case object
        The case, as `asperity.run` takes it.
    measured : path, `Measured`, or a list of them, optional
        Tables of what was measured, or objects; by default what the case itself names (keys of ``measured``,
        ``track.decay_rates``, ``track.mobility``, ``noise.measured_bands``).
    free : list of str, or mapping, optional
        Dotted keys that may change, as ``"track.pad_stiffness"`` or ``"track.pad_stiffness = 100..2000
        MN/m"``; or keys with their least and largest value, ``{"track.pad_stiffness": (1e8, 2e9)}``. By
        default those that decide most of what was measured.
    progress : callable, optional
        ``progress(done, total, message)``, called during long work.
    where : mapping, optional
        Of tables with a measurement in each line those alone in which columns hold this, as ``{"section":
        "B5"}``.
    what : str, optional
        What tables hold, where their heading does not tell.
    starts : int, optional
        From how many places the smallest sum of squares is sought.

    Returns
    -------
    Fitted
        Values with 95 % intervals, what the data leave open, and the case with the values found.

    Raises
    ------
    InputError
        If the case or a table is wrong, the case cannot predict what was measured, or there are not more data
        than free keys.

    Notes
    -----
    Levels of measured over predicted values, dB, divided by their standard deviations, are made small as the
    sum of their squares (SciPy's least squares), over logarithms of what is free. Standard deviations are
    those of repeated measurements, else the usual one of the quantity, and then the scatter that is left
    tells the intervals, by Student. Their ends are moved outward to where the sum of squares has risen by as
    much as it should. A direction in which an interval would reach beyond a factor of three
    either way is not determined: the key that takes part most is left as it was, and the others are fitted
    again.

    Examples
    --------
    >>> import asperity
    >>> import numpy as np
    >>> track = asperity.WheelOnRail(surface={"smooth": True})
    >>> stiff = track.with_(**{"track.pad_stiffness": "400 MN/m"}).track.model()
    >>> frequency = np.array([100.0, 160.0, 250.0, 400.0, 630.0, 1000.0])
    >>> mobility = 2.0 * np.pi * frequency * abs(stiff.receptance(frequency, 0.3, 0.3))
    >>> data = asperity.Measured("mobility", frequency, mobility)
    >>> found = asperity.fit(track, data, ["track.pad_stiffness"], starts=1)
    >>> round(found.values["track.pad_stiffness"] / 1e6)
    400
    """
    given = cases.as_case(case)
    with shown_progress(progress) as told, one_thread_in_linear_algebra():
        found = measured_for(given, measured, where or {}, what)
        return fitted(given, found, chosen_free(given, found, free), told, starts)


def measured_for(
    case: AnyCase, measured: object, where: Mapping[str, str], what: str | None
) -> tuple[Measured, ...]:
    """What a case is fitted to, repeated measurements combined; what the case names where none is given."""
    if measured is None:
        found = reading.beside(case)
        remedy = "Name files of what was measured behind --to."
        require(found, "what was measured", "nothing", "files, or keys of the case that name them", remedy)
    else:
        several = isinstance(measured, Iterable) and not isinstance(measured, str | os.PathLike)
        each = list(measured) if several else [measured]  # type: ignore[call-overload]
        require(each, "what was measured", "nothing", "one file or more")
        found = list[Measured]()
        titles = list[str]()
        for one in each:
            if isinstance(one, Measured):
                found.append(one)
                continue
            path = file_path("what was measured", one, "the path of a table, or a Measured")
            read, columns = reading.read_measured(case, path, where, what)
            found += read
            titles += columns
        reading.refuse_unfound(where, titles)
    for each in found:
        of = observable(each.what)
        if lacks := of.lacks(case):
            allowed = "what the case can predict"
            raise InputError(f"{each.what} in {each.source}", f"a case with {lacks}", allowed)
    return tuple(reading.combined(found))


def chosen_free(case: AnyCase, measured: Sequence[Measured], free: FreeKeys) -> tuple[Free, ...]:
    """What may change: as named, or as what was measured suggests."""
    if free is None:
        names = [name for each in measured for name in observable(each.what).free(case)]
        return tuple(free_key(case, name) for name in dict.fromkeys(names))
    require(
        isinstance(free, Mapping | Sequence) and not isinstance(free, str),
        "free",
        shown(free),
        "a list of keys",
    )
    asked: dict[str, object] = {}
    named = free.items() if isinstance(free, Mapping) else (read_free(each) for each in free)
    for name, within in named:
        require(name not in asked, name, "free more than once", "each key once")
        asked[name] = within
    require(asked, "free", "no key", "one key or more")
    return tuple(each for name, within in asked.items() for each in _free(case, name, within, measured))


def _free(case: AnyCase, name: str, within: object, measured: Sequence[Measured]) -> list[Free]:
    """A key, or, of one that holds a spectrum, its bands whose wavelengths are heard in what was measured."""
    entry = entry_of(type(case), name)
    bands = is_spectrum(entry)
    unit = "dB" if bands else entry.unit or "1"
    ends = None if within is None else read_range(name, within, unit)
    if not bands:
        return [free_key(case, name, ends)]
    return free_bands(case, entry, _heard(case, measured), ends)


def _heard(case: AnyCase, measured: Sequence[Measured]) -> Range:
    """Shortest and longest wavelength that is heard in what was measured in bands, m."""
    own = float(getattr(case, "speed", np.nan))
    speeds = np.concatenate([float(each.conditions.get("speed", own)) / each.at for each in measured])
    return float(speeds.min()), float(speeds.max())


def fitted(
    case: AnyCase,
    measured: tuple[Measured, ...],
    chosen: tuple[Free, ...],
    progress: Progress,
    starts: int | None = None,
) -> Fitted:
    """Fit a case to measurements by what may change, as `fit` does."""
    case = with_choices_fixed(case, case.laws[:1])
    runs = FitRuns(progress)
    asked = Problem(case, tuple(measured), chosen, of_case=case_key("fit", FORMAT, case), runs=runs)
    usual = STARTS if not asked.by_run else STARTS_OF_JUMPS if asked.jumps else 1
    count = whole("starts", starts or usual, "1 to 100", at_least=1, at_most=100)
    runs.most = _most_runs(asked, count)
    known, before = _known(replace(asked, free=()))
    problem = _with_choices_of_runs(replace(asked, measured=known))
    case = problem.case
    received = f"{count_of(len(chosen), 'free key')} and {count_of(problem.count, 'value')}"
    require(len(chosen) < problem.count, "fit", received, "more values than free keys", "Free fewer keys.")
    if (row := _row(problem)) is not None:
        return _told_by_row(case, problem, before, row)
    problem = replace(problem, chance=replace(problem, free=()).chance_of_runs())
    left_open = list[Undetermined]()
    rough = replace(problem, fine=False)
    places = _starts(problem, count, rough)
    problem, minima = _searched(problem, places, progress)
    problem.held.clear()  # those of runs are found once more, where the search has ended
    contradicted = set[str]()
    while (least := _least_determined(problem, minima.best, contradicted)) is not None:
        places = [np.delete(minima.best.place, least.number)]
        places += [] if problem.by_run else [np.delete(problem.start, least.number)]
        fewer, held = _searched(problem.without(least.number), places, progress)
        left = held.best.residuals * fewer.uncertainty / problem.uncertainty
        if float(left @ left) - minima.best.square > least.allowed:
            contradicted.add(problem.free[least.number].name)
            continue
        left_open.append(least.words)
        if not fewer.free:
            raise _all_open(left_open)
        problem = fewer
        minima = held
    runs.most = runs.done + _runs_of_ends(problem)
    return _told(case, problem, before, minima, left_open)


def _sought(problem: Problem) -> tuple[Array, Array]:
    """Between which values a search begins: the limits; where runs jump, near the case."""
    if not problem.jumps:
        return problem.low, problem.high
    low, high = (np.clip(problem.start + by, problem.low, problem.high) for by in (-REACH, REACH))
    return low, high


def _starts(problem: Problem, count: int, rough: Problem) -> list[Array]:
    """Places from which a search begins: the case, and the best of those that are looked at beside."""
    return starts_within(*_sought(problem), problem.start, count, rough.residuals)


def _places_in_row(problem: Problem) -> Array:
    """Places (m, 1) of the only key where runs jump, one beside the other about the case; else none."""
    if not problem.jumps or len(problem.free) != 1:
        return np.zeros((0, 1))
    low, high = (float(end[0]) for end in _sought(problem))
    return places_of(low, high)[:, None]


def _row(problem: Problem) -> Row | None:
    """What is left of the data at these, where they can be computed at enough of them."""
    places = _places_in_row(problem)
    left = np.array([problem.residuals(place) for place in places]).reshape(len(places), problem.count)
    computed = np.all(np.abs(left) < FAR, axis=1)
    if np.count_nonzero(computed) < 2 * NEIGHBOURS:
        return None
    return Row(places[computed, 0], (left * problem.uncertainty)[computed])


def _told_by_row(case: AnyCase, problem: Problem, before: list[Values], found: Row) -> Fitted:
    """Lay out what was found of the only key where runs jump."""
    (free,) = problem.free
    repeated = problem.stated and any(each.records > 1 for each in problem.measured)
    met = found.met(problem.of_data, stated=problem.stated, repeated=repeated)
    if met.ends[1].place - met.ends[0].place > 2.0 * determined.WIDEST:
        raise _all_open([Undetermined(free, ())])
    place = np.array([met.place])
    problem = replace(problem, chance=met.chance, beyond=met.beyond)
    (end,) = on_limits(place, problem.low, problem.high).tolist()
    stops = [
        LIMIT if each.stop and each.place in (problem.low[0], problem.high[0]) else each.stop
        for each in met.ends
    ]
    low, high = (free.end(each.place) for each in met.ends)
    interval = None if end else (low, high)
    estimate = Estimate(free, free.outward(met.place), interval, LIMITS[end], (stops[0], stops[1]))
    return Fitted(
        case.with_(**problem.changes(place)),
        case,
        problem.measured,
        (estimate,),
        (),
        np.eye(int(not end)),
        before,
        problem.predicted(place),
        problem.stated,
        problem.beyond,
        (),
    )


def _all_open(left_open: Sequence[Undetermined]) -> InputError:
    """That nothing is left to be fitted."""
    received = f"data that leave every free key open ({'; '.join(each.words for each in left_open)})"
    return InputError("fit", received, "data that tell one of them")


def _with_choices_of_runs(problem: Problem) -> Problem:
    """The same of a case in which what its runs chose stays, whatever is tried; a warning tells it."""
    chosen = replace(problem, free=()).chosen_by_runs()
    if not chosen:
        return problem
    case = problem.case.with_(**chosen)
    for dotted in chosen:
        told = in_words(getattr(case, dotted), entry_of(type(case), dotted).key)
        stays = f"{dotted} = {told}, as the run of the case chose it, stays while others are tried"
        warnings.warn(f"{stays}: give that of the measurement", BandsWarning, stacklevel=4)
    return replace(problem, case=case, of_case=case_key("fit", FORMAT, case))


def _most_runs(problem: Problem, starts: int) -> int:
    """Runs of a fit from so many starts at most, the one of the case as it is among them."""
    chosen = int(any(of.chosen is not None for of in problem.observables))  # then it is run once more
    if row := len(_places_in_row(problem)):
        return problem.runs_at_once * (row + 2 + chosen)
    again = RUNS_AGAIN * (1 + (ROUNDS if problem.stated else 0))
    screened = SCREENED * (starts - 1)
    searched = RUNS * (starts if starts > 1 else 0) + RUNS + again
    held = 2 * len(problem.free) * again  # each key found to be contradicted, then held nevertheless
    places = 1 + chosen + screened + searched + 2 * problem.places_of_slopes + held
    return problem.runs_at_once * places + _runs_of_ends(problem)


def _runs_of_ends(problem: Problem) -> int:
    """Runs at most by which the ends of all intervals are found."""
    return problem.runs_at_once * 2 * MOST * sum(each.band is None for each in problem.free)


@dataclass(frozen=True)
class _Least:
    """A key that data leave open, unless they contradict the value that the case has of it."""

    number: int
    words: Undetermined
    allowed: float  # by which the sum of squares may rise where it is held


def _least_determined(problem: Problem, best: Optimum, contradicted: Collection[str]) -> _Least | None:
    """The key that is left open most, but for those whose value in the case the data contradict.

    Where they contradict all of those between which they cannot tell at all, one is held nevertheless.
    """
    slopes = problem.slopes(best.place)
    inside = np.flatnonzero(_pushed(problem, best, slopes) == 0)
    spread = _spread(problem, best, len(inside))
    names = [problem.free[number].name for number in inside]
    known = [number for number, name in enumerate(names) if name in contradicted]
    allowed = (spread.quantile * spread.scale) ** 2
    found = determined.open_direction(slopes[:, inside], spread, known)
    if found is None:
        found = determined.open_direction(slopes[:, inside], spread)
        allowed = np.inf
        if found is None or np.isfinite(found.half_width):
            return None
    number = int(inside[found.number])
    others = tuple((names[other], by) for other, by in found.others.items())
    levels = tuple(each.name for each in problem.free if each.units == "dB")
    return _Least(number, Undetermined(problem.free[number], others, levels), allowed)


def _known(problem: Problem) -> tuple[tuple[Measured, ...], list[Values]]:
    """Measurements where the case predicts anything at all, and what it predicts there as it is.

    A warning tells what is left out; an `InputError` says that nothing is left of a measurement.
    """
    predicted = problem.predicted(problem.start)
    known = list[Measured]()
    before = list[Values]()
    for each, values in zip(problem.measured, predicted, strict=True):
        inside = np.isfinite(values)
        out = ", ".join(rounded(at, 4) for at in each.at[~inside])
        where = f"{each.what} in {each.source}, {observable(each.what).axis}"
        if not inside.any():
            remedy = "Does numerics.highest_frequency reach them?" if "Hz" in where else ""
            raise InputError(where, out, "where the case predicts something", remedy)
        if out:
            told = f"{where}: {out} left out, as the case predicts nothing there"
            warnings.warn(told, BandsWarning, stacklevel=4)
        uncertainty = None if each.uncertainty is None else np.asarray(each.uncertainty)[inside]
        known.append(replace(each, at=each.at[inside], values=each.values[inside], uncertainty=uncertainty))
        before.append(values[inside])
    return tuple(known), before


@dataclass(frozen=True, eq=False)
class _Minima:
    """Where a sum of squares is smallest, and what else was met on the way."""

    best: Optimum  # with bands as in a report
    rough: tuple[Optimum, ...]  # where searches from several starts ended, the best first


def _searched(problem: Problem, starts: Sequence[Array], progress: Progress) -> tuple[Problem, _Minima]:
    """Go down from each start, then from the best of these places to the end.

    While it is not known what the case leaves out, data whose uncertainty is known count as if that were as
    large as usual; it is found at the end, from what is left.
    """
    rough = replace(problem, fine=False, beyond=USUALLY_LEFT_OUT if problem.stated else 0.0)
    words = f"search for {count_of(len(problem.free), 'key')}" if problem.free else "the case as it is"
    found = list[Optimum]()
    for number, start in enumerate(starts if len(starts) > 1 else ()):
        progress(number, len(starts) + 1, words)
        found.append(_descent(rough, start, ROUGH))
        problem.held.clear()  # slopes of runs are those of where they were found
    progress(len(starts), len(starts) + 1, words)
    found.sort(key=lambda each: each.square)
    best = _descent(problem, found[0].place if found else starts[0], FINE)
    for _ in range(ROUNDS if problem.stated else 0):
        left = best.residuals * problem.uncertainty
        beyond = determined.left_out(left, problem.of_data, problem.count - len(problem.free))
        if abs(beyond - problem.beyond) <= SAME * beyond:
            break
        problem = replace(problem, beyond=beyond)
        best = _descent(problem, best.place, FINE)
    progress(len(starts) + 1, len(starts) + 1, words)
    return problem, _Minima(best, tuple(found))


def _spread(problem: Problem, best: Optimum, free: int) -> determined.Spread:
    """Scatter of the data about the best values, of which so many are free."""
    repeated = problem.stated and any(each.records > 1 for each in problem.measured)
    believed = problem.stated and not problem.beyond and not repeated
    read = repeated or bool(np.any(problem.chance))
    return determined.spread_of(best.square, problem.count - free, believed=believed, read=read)


def _descent(problem: Problem, start: Array, most: int) -> Optimum:
    """Go down from a start; where that ended is kept, so that an interrupted fit goes on from there."""

    def descended() -> dict[str, Array]:
        tolerance = OF_RUNS if problem.by_run else TOLERANCE
        limits = (problem.low, problem.high)
        slopes = problem.quick_slopes
        follow = updated_slopes(problem.residuals, slopes) if problem.by_run else slopes
        steps = RUNS_AGAIN if problem.held else RUNS
        count = steps if problem.by_run else most
        end = descend(problem.residuals, follow, start, *limits, count, tolerance)
        return {"place": end.place, "residuals": end.residuals}

    kept = made(Store(), problem.key("descent", start.tolist(), most), descended)
    return Optimum(kept["place"], kept["residuals"])


def _pushed(problem: Problem, best: Optimum, slopes: Array) -> NDArray[np.int_]:
    """Which values lie on a limit beyond which the data want them (p,), as `on_limits`.

    One that lies there by chance, as the data leave it open, is none of these: beyond it the sum of squares
    would fall by less than the data scatter.
    """
    ends = on_limits(best.place, problem.low, problem.high)
    spread = _spread(problem, best, int(np.count_nonzero(ends == 0)))
    gradient = slopes.T @ best.residuals
    size = np.sum(slopes**2, axis=0)
    gain = gradient**2 / np.maximum(size, np.finfo(float).tiny) / spread.scale**2
    return np.where(gain > 1.0, ends, 0)


def _told(
    case: AnyCase, problem: Problem, before: list[Values], minima: _Minima, left_open: list[Undetermined]
) -> Fitted:
    """Lay out what was found."""
    place = minima.best.place
    slopes = problem.slopes(minima.best.place)
    pushed = _pushed(problem, minima.best, slopes)
    ends = on_limits(place, problem.low, problem.high)
    inside = np.flatnonzero(pushed == 0)
    spread = _spread(problem, minima.best, len(inside))
    spreads = determined.covariance(slopes[:, inside], spread)
    half = np.full(len(place), np.nan)
    half[inside] = spread.quantile * np.sqrt(np.diag(spreads))
    allowed = (spread.quantile * spread.scale) ** 2
    left = minima.best.residuals
    bowl = Bowl(problem.residuals, place, left, slopes, problem.low, problem.high, inside, allowed)
    estimates = []
    for number, (each, at, end) in enumerate(zip(problem.free, place.tolist(), ends.tolist(), strict=True)):
        problem.runs.progress(number, len(place), "ends of intervals")
        found = _interval(problem, bowl, number, float(half[number])) if number in inside else None
        interval = (each.end(found[0].place), each.end(found[1].place)) if found else None
        stops = (found[0].stop, found[1].stop) if found else ("", "")
        estimates.append(Estimate(each, each.outward(at), interval, LIMITS[end], stops))
    problem.runs.progress(len(place), len(place), "ends of intervals")
    return Fitted(
        case.with_(**problem.changes(place)),
        case,
        problem.measured,
        tuple(estimates),
        tuple(left_open),
        determined.correlations(spreads),
        before,
        problem.predicted(place),
        problem.stated,
        problem.beyond,
        tuple(_rivals(problem, minima, np.nan_to_num(half, nan=0.0))),
    )


def _interval(problem: Problem, bowl: Bowl, number: int, half: float) -> tuple[End, End]:
    """Ends of the interval of a value; of a band of roughness as slopes have it, as these take many runs."""
    at = float(bowl.place[number])
    if problem.by_run and problem.free[number].band is not None:
        return End(at - half), End(at + half)
    return bowl.end(number, -half), bowl.end(number, half)


def _rivals(problem: Problem, minima: _Minima, half: Array) -> Iterable[dict[str, float]]:
    """Values of other minima that meet the data nearly as well, and lie beyond the intervals."""
    met = [minima.best.place]
    for other in minima.rough[1:]:
        apart = [np.max(np.abs(other.place - each) / (2.0 * half + NEAR)) for each in met]
        if other.square <= RIVAL**2 * minima.rough[0].square and min(apart) > 1.0:
            met.append(other.place)
            yield problem.values(other.place)
