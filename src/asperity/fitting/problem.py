"""What is left between what was measured and what a case predicts, at values of what is free."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Any

import numpy as np

from asperity.arguments import Array, Flags, NDArray
from asperity.case.any_case import AnyCase
from asperity.case.form import content
from asperity.case.in_memory import digest
from asperity.errors import ComputationError, InputError, PhysicsWarning
from asperity.fitting.free import Free, spectrum_of
from asperity.fitting.search import (
    FAR,
    RUN_STEP,
    WIDE_STEP,
    central_slopes,
    forward_slopes,
    grouped_slopes,
)
from asperity.fitting.tried import FitRuns, TriedCase
from asperity.observables import observable
from asperity.observables.observable import Measured, Observable, Values
from asperity.store import content_key

APART = 4
"""Bands by which those are apart that are moved at once: a level follows few bands of roughness."""


@dataclass(frozen=True, eq=False)
class Problem:
    """A case, what was measured, and what is free.

    Parameters
    ----------
    case : AnyCase
        The case.
    measured : tuple of Measured
        What it is fitted to.
    free : tuple of Free
        What may change.
    fine : bool
        Whether bands are resolved as in a report.
    beyond : float
        Standard deviation of what the case leaves out, dB, beside the uncertainty of the data.
    chance : ndarray (n,), optional
        Standard deviation of what is predicted, dB, by the chance of the one record that is run.
    of_case : str
        Digest of the case and its files.
    runs : FitRuns
        Runs of the case.
    held : dict
        Of runs the slopes of all levels (n,), dB, by the name of what is free: many runs tell them.
    """

    case: AnyCase
    measured: tuple[Measured, ...]
    free: tuple[Free, ...]
    fine: bool = True
    beyond: float = 0.0
    chance: Array | None = None
    of_case: str = ""
    runs: FitRuns = field(default_factory=FitRuns)
    held: dict[str, Array] = field(default_factory=dict)

    @cached_property
    def low(self) -> Array:
        """Lower limits (p,), on the scale of the search."""
        return np.array([each.inward(each.low) for each in self.free])

    @cached_property
    def high(self) -> Array:
        """Upper limits (p,), likewise."""
        return np.array([each.inward(each.high) for each in self.free])

    @cached_property
    def start(self) -> Array:
        """Values of the case (p,), likewise."""
        return np.array([each.inward(each.start) for each in self.free])

    @cached_property
    def observables(self) -> tuple[Observable, ...]:
        """What each measurement is of."""
        return tuple(observable(each.what) for each in self.measured)

    @cached_property
    def uncertainty(self) -> Array:
        """Standard deviations of all data (n,), dB, with what the case leaves out."""
        return np.hypot(self.of_data, self.beyond)

    @cached_property
    def of_data(self) -> Array:
        """Standard deviations of the data (n,), dB, with the chance of the record beside which they stand."""
        told = np.concatenate(
            [
                np.tile(_uncertainty(each, of), 2 if np.iscomplexobj(each.values) else 1)
                for each, of in zip(self.measured, self.observables, strict=True)
            ]
        )
        return told if self.chance is None else np.hypot(told, self.chance)

    @property
    def stated(self) -> bool:
        """Whether all uncertainties are known: given, or the scatter of repeated measurements."""
        return all(each.uncertainty is not None for each in self.measured)

    @property
    def count(self) -> int:
        """Number of data."""
        return sum(each.count for each in self.measured)

    def values(self, place: Array) -> dict[str, float]:
        """Values of what is free, in SI, at a place on the scale of the search."""
        return {each.name: each.outward(at) for each, at in zip(self.free, place.tolist(), strict=True)}

    def changes(self, place: Array) -> dict[str, Any]:
        """Keys of the case at a place, by their dotted names; those that they replace as None."""
        return {**self._replaced, **changes_of(self.case, self.free, self.values(place))}

    @cached_property
    def _replaced(self) -> dict[str, None]:
        """Keys that the case gives, and of which another one that is free takes the place."""
        found: dict[str, None] = {}
        for each in self.free:
            if each.entry.section:
                section = getattr(self.case, each.entry.section)
                for pair in section.ALTERNATIVES:
                    if each.entry.name in pair:
                        other = pair[pair.index(each.entry.name) - 1]
                        if other in section.given_names:
                            found[f"{each.entry.section}.{other}"] = None
        return found

    def _tried(self, place: Array) -> Iterator[tuple[Observable, Measured, TriedCase]]:
        """Each measurement with the case at a place, under its conditions."""
        changes = self.changes(place)
        trials = dict[str, TriedCase]()
        for each, of in zip(self.measured, self.observables, strict=True):
            here = repr(sorted(content(each.conditions).items()))
            if here not in trials:
                tried = {**changes, **each.conditions}
                trials[here] = TriedCase(self.case, tried, self.fine, self.runs)
            yield of, each, trials[here]

    def predicted(self, place: Array) -> list[Values]:
        """What the case predicts for each measurement (n,) at a place."""
        return [of.predict(trial, each) for of, each, trial in self._tried(place)]

    def chance_of_runs(self) -> Array:
        """Standard deviation of what the case predicts as it is (n,), dB, by the chance of one record."""
        return np.concatenate(
            [
                np.zeros(each.count)
                if of.chance is None
                else np.nan_to_num(of.chance(trial.collected, each), nan=0.0, posinf=0.0)
                for of, each, trial in self._tried(self.start)
            ]
        )

    def chosen_by_runs(self) -> dict[str, Any]:
        """Keys that the case does not give, and that runs of it as it is chose, with their values."""
        return {
            dotted: value
            for of, _, trial in self._tried(self.start)
            if of.chosen is not None
            for dotted, value in of.chosen(trial).items()
        }

    def left(self, place: Array) -> list[Array]:
        """Level of what was measured over what is predicted, of each measurement, dB."""
        both = zip(self.observables, self.measured, self.predicted(place), strict=True)
        return [of.differs(each.values, predicted) for of, each, predicted in both]

    def residuals(self, place: Array) -> Array:
        """The same of all data (n,), in their uncertainties; `FAR` of what cannot be computed there."""
        try:
            with PhysicsWarning.ignored():
                left = np.concatenate(self.left(place))
        except (InputError, ComputationError):
            return np.full(self.count, FAR)
        found = left / self.uncertainty
        return np.where(np.isfinite(found), np.clip(found, -FAR, FAR), FAR)

    @cached_property
    def by_run(self) -> bool:
        """Whether the case is run for it."""
        return any(of.by_run for of in self.observables)

    @cached_property
    def jumps(self) -> bool:
        """Whether what runs give jumps as a value is moved a little."""
        return any(of.jumps for of in self.observables)

    @cached_property
    def runs_at_once(self) -> int:
        """Runs that residuals at one place take: one for each of the conditions of what was measured."""
        run = [each for each, of in zip(self.measured, self.observables, strict=True) if of.by_run]
        return len({repr(sorted(content(each.conditions).items())) for each in run})

    def slopes(self, place: Array) -> Array:
        """Slopes of the residuals (n, p) at a place."""
        if self.by_run:
            return self.quick_slopes(place)
        return central_slopes(self.residuals, self.low, self.high)(place)

    def quick_slopes(self, place: Array) -> Array:
        """The same for half of the work; of runs those that are held, wherever they were found."""
        if not self.by_run:
            return forward_slopes(self.residuals, self.low, self.high)(place)
        names = [each.name for each in self.free]
        if not self.held.keys() >= set(names):
            found = grouped_slopes(
                self.residuals, place, self.high, self._groups, WIDE_STEP if self.jumps else RUN_STEP
            )
            self.held.update(zip(names, found.T * self.uncertainty, strict=True))
        return np.stack([self.held[name] for name in names], axis=1) / self.uncertainty[:, None]

    @property
    def places_of_slopes(self) -> int:
        """Places beside another at which runs are needed for slopes there."""
        return len(self._groups)

    @cached_property
    def _groups(self) -> list[tuple[NDArray[np.int_], Flags]]:
        """What is moved at once, as numbers of what is free, and which data (n, k) each of them moves.

        A band of roughness moves the levels that are heard while it is passed, and those beside it.
        """
        alone = [n for n, each in enumerate(self.free) if each.band is None]
        groups = [(np.array([n]), np.ones((self.count, 1), dtype=bool)) for n in alone]
        bands = {n: each.band for n, each in enumerate(self.free) if each.band is not None}
        if not bands:
            return groups
        passed = np.concatenate([self._passed(each) for each in self.measured])
        numbers = {n: round(10.0 * np.log10(band)) for n, band in bands.items()}
        for rest in range(APART):
            together = np.array([n for n, number in numbers.items() if number % APART == rest], dtype=int)
            if len(together):
                centres = np.array([bands[n] for n in together.tolist()])
                away = np.abs(10.0 * np.log10(passed[:, None] / centres))
                nearest = away == away.min(axis=1, keepdims=True)
                groups.append((together, nearest & (away <= 0.5 * APART + 0.5)))
        return groups

    def _passed(self, measured: Measured) -> Array:
        """Wavelengths that are heard in the bands of a measurement (n,), m."""
        speed = measured.conditions.get("speed", getattr(self.case, "speed", np.nan))
        times = 2 if np.iscomplexobj(measured.values) else 1
        return np.tile(speed / measured.at, times)

    def key(self, *more: object) -> str:
        """Name of what is kept of it: all that it depends on, and more."""
        data = [
            [each.what, content(each.conditions), each.places, digest(each.at), digest(each.values)]
            for each in self.measured
        ]
        free = [[each.name, each.low, each.high] for each in self.free]
        return content_key("fit", self.of_case, data, digest(self.uncertainty), free, self.fine, *more)

    def without(self, number: int) -> "Problem":
        """The same with what is free but one, which is left as the case has it."""
        return replace(self, free=tuple(each for n, each in enumerate(self.free) if n != number))


def changes_of(case: AnyCase, free: Sequence[Free], values: Mapping[str, float]) -> dict[str, Any]:
    """Keys of a case, by their dotted names, with values of what is free: of a spectrum its table."""
    found: dict[str, Any] = {}
    for each in free:
        if each.band is None:
            found[each.name] = values[each.name]
            continue
        if each.entry.dotted not in found:
            found[each.entry.dotted] = np.column_stack(spectrum_of(case, each.entry))
        table = found[each.entry.dotted]
        table[np.argmin(np.abs(np.log(table[:, 0] / each.band))), 1] = values[each.name]
    return found


def _uncertainty(measured: Measured, of: Observable) -> Array:
    given = of.uncertainty if measured.uncertainty is None else measured.uncertainty
    return np.broadcast_to(np.asarray(given, dtype=float), measured.at.shape)
