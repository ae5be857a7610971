"""What is looked at in a run: entries of the result, a function that finds them, and what is doubted."""

import json
import re
import warnings
from collections.abc import Callable, Collection, Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any, Protocol

import numpy as np
import xarray

from asperity import extensions
from asperity.arguments import Array, require, shown
from asperity.case.any_case import AnyCase
from asperity.errors import Finding, InputError, reason
from asperity.scenes import schema
from asperity.schema import (
    Attribute,
    Entry,
    Values,
    bearing,
    contact,
    convergence,
    declared,
    measured,
    provenance,
    rolling,
    spectra,
)

DECLARING = (bearing, contact, convergence, measured, provenance, rolling, spectra, schema)
"""Modules that declare what results hold."""
DECLARED = frozenset(item for module in DECLARING for item in declared(module))
"""All that these declare: what an observer of this program may lay out."""
QUANTITIES = {
    "contact_force": "forces of all contacts in time (contacts, steps), N",
    "acceleration": "accelerations at sensors in time (sensors, steps), m/s²",
    "scene": "bodies that roll over a structure",
    "track": "bodies that roll over a track",
    "bearing": "a ball bearing that turns",
}
"""What a run may have that an observer needs."""
OVER_A_STRUCTURE = ("scene",)
"""What an observer needs that says nothing of it."""


class ComputedRun(Protocol):
    """What every run that was computed has, of bodies on structures and of bearings alike.

    Beside it stands what its kind has: `asperity.scenes.compute.Computed` its scene, its shape and its
    textures, `asperity.scenes.computed_bearing.ComputedBearing` its bearing and its raceways.
    """

    @property
    def case(self) -> AnyCase:
        """The case."""

    @property
    def runs(self) -> Mapping[str, Any]:
        """Records in time, by law; each has its ``time`` and its ``contact_force`` (contacts, steps), N."""

    @property
    def quantities(self) -> frozenset[str]:
        """Which of the `QUANTITIES` it has."""

    def stacked(self, name: str) -> Array:
        """Stack one record of all runs, (laws, contacts or sensors, ...), by the name of its attribute."""


def _everywhere(computed: Any) -> bool:
    """Every run has what is looked at."""
    return True


def _nothing(computed: Any) -> tuple[Any, ...]:
    return ()


@dataclass(frozen=True)
class Observer:
    """What is looked at in each run that has what it takes, and laid out in its result.

    Parameters
    ----------
    name : str
        What is looked at; of a package of one's own the group of the result in which its entries stand.
    entries : collection of Entry and Attribute
        All that it may lay out, each with its dimensions, unit and meaning; `DECLARED` of what is built in.
    observe : callable
        ``observe(computed)`` returns values of some of them, by entry, of a run: its case, its records in
        time by law, and what its kind has beside (`ComputedRun`).
    needs : sequence of str
        Those of the `QUANTITIES` without which a run is not asked: ``["contact_force"]`` is asked of every
        run, ``["bearing"]`` of ball bearings. By default bodies on structures alone are asked.
    asked_of : callable
        ``asked_of(computed)`` says whether a run that has them has what it takes.
    findings : callable
        ``findings(computed)`` returns what is doubted of such a run, as `asperity.errors.Finding`, which
        stands in the table of validity and is warned of by its grade.
    numerics : callable
        ``numerics(computed)`` returns numbers of the computation: names and values, in words.
    sources : sequence of str, or callable
        What its method is cited by, where it lays something out; or a function of such a run that says so.

    Raises
    ------
    InputError
        If any of it is wrong.
    """

    name: str
    entries: Collection[Entry | Attribute]
    observe: Callable[[Any], Values]
    needs: Sequence[str] = OVER_A_STRUCTURE
    asked_of: Callable[[Any], bool] = _everywhere
    findings: Callable[[Any], Sequence[Finding]] = _nothing
    numerics: Callable[[Any], Iterable[tuple[str, str]]] = _nothing
    sources: Sequence[str] | Callable[[Any], Sequence[str]] = ()

    def __post_init__(self) -> None:
        what = f"observer {self.name}"
        word = isinstance(self.name, str) and re.fullmatch(r"\w+", self.name)
        require(word, "name of an observer", shown(self.name), "letters, digits and underscores")
        for function in (self.observe, self.asked_of, self.findings, self.numerics):
            require(callable(function), what, shown(function), "a function of what was computed")
        listed = not isinstance(self.needs, str) and set(self.needs) <= QUANTITIES.keys()
        require(listed, f"needs of {what}", shown(self.needs), f"a list of {', '.join(QUANTITIES)}")
        if not callable(self.sources):
            cited = not isinstance(self.sources, str) and all(isinstance(each, str) for each in self.sources)
            require(cited, f"sources of {what}", shown(self.sources), "a list of texts")
        require(self.entries, what, "no entry", "what it lays out, as asperity.schema.Entry")

    def look(self, computed: ComputedRun) -> "Observed":
        """Ask it of a run: nothing where that lacks what is needed."""
        if not set(self.needs) <= computed.quantities or not self.asked_of(computed):
            return Observed()
        values = self.observe(computed)
        sources = self.sources(computed) if callable(self.sources) else self.sources
        findings = self.findings(computed)
        numerics = self.numerics(computed)
        return Observed(values, list(findings), list(numerics), list(sources) if values else [])

    def declared(self, found: Any) -> Values:
        """Make what it found ready to be written; an `InputError` says what is not as it declares."""
        what = f"observer {self.name}"
        if not isinstance(found, Mapping):  # what is right is not written out
            raise InputError(what, shown(found), "values by its entries, as a dict")
        strange = [shown(each) for each in found if each not in self.entries]
        require(not strange, what, ", ".join(strange), "entries that it declares")
        return _fitting(what, found)


@dataclass(frozen=True)
class Observed:
    """What observers say of a run: what they lay out, what they doubt, numbers, and what that is cited by."""

    values: Values = field(default_factory=dict)
    findings: list[Finding] = field(default_factory=list)
    numerics: list[tuple[str, str]] = field(default_factory=list)
    sources: list[str] = field(default_factory=list)

    def __or__(self, other: "Observed") -> "Observed":
        return Observed(
            self.values | other.values,
            self.findings + other.findings,
            self.numerics + other.numerics,
            self.sources + other.sources,
        )


def _fitting(observer: str, found: Mapping[Entry | Attribute, Any]) -> Values:
    """Make what an observer found ready to be written, or say by an `InputError` what does not fit."""
    made = {item: _written(item, value, observer) for item, value in found.items()}
    variables = {item: value for item, value in made.items() if isinstance(item, Entry)}
    sizes: dict[str, dict[str, int]] = {entry.group: {} for entry in variables}
    for entry in sorted(variables, key=lambda item: item.place != item.name):  # coordinates first
        known = sizes[entry.group]
        shape = variables[entry].shape
        allowed = ", ".join(f"{name}: {known.get(name, 'any size')}" for name in entry.dims)
        fits = all(known.setdefault(*each) == each[1] for each in zip(entry.dims, shape, strict=True))
        require(fits, f"{entry.place} of {observer}", f"the shape {shape}", f"dimensions ({allowed})")
    return made


def _written(item: Entry | Attribute, value: Any, observer: str) -> Any:
    """Make one value as a result file holds it."""
    what = f"{item.place if isinstance(item, Entry) else item.name} of {observer}"
    try:
        if isinstance(item, Attribute) and item.units == "JSON":
            json.dumps(value)
            return value
        values = np.asarray(value)
    except (TypeError, ValueError) as error:  # of what JSON does not know; of lists of unequal lengths
        raise InputError(what, f"a failure, {reason(error)}", "one array, or what JSON holds") from error
    words = values.dtype.kind == "U" or (values.dtype.kind == "O" and _are_words(values))
    require(words or values.dtype.kind in "biuf", what, f"values of {values.dtype}", "real numbers, or texts")
    if isinstance(item, Attribute):
        require(values.ndim < 2, what, shown(values), "one number or text, or a list of them")
        return value
    made = isinstance(value, xarray.Variable | xarray.DataArray)
    names = value.dims if made else item.dims
    received = f"dimensions ({', '.join(map(str, names))})" if made else f"the shape {values.shape}"
    fits = values.ndim == len(item.dims) and tuple(names) == item.dims
    remedy = f'Name others behind it, as in Entry("{item.group}", "{item.name}(law, contact)", …).'
    require(
        fits,
        what,
        received,
        f"dimensions ({', '.join(item.dims)})",
        remedy if item.dims == (item.name,) else "",
    )
    return item.variable(values, **(value.attrs if made else {}))


def _are_words(values: np.ndarray[Any, Any]) -> bool:
    return all(isinstance(each, str) for each in values.flat)


def observers() -> dict[str, Observer]:
    """Observers of packages beside this one, by name."""
    return extensions.taken(extensions.OBSERVERS, _installed)


def _installed(name: str, observer: Any) -> Observer:
    allowed = "an asperity.scenes.observer.Observer"
    require(isinstance(observer, Observer), f'observer "{name}"', shown(observer), allowed)
    assert isinstance(observer, Observer)
    require(
        observer.name == name, "name of the observer", shown(observer.name), f'"{name}", as its entry point'
    )
    elsewhere = sorted({each.group for each in observer.entries if each.group != name})
    require(not elsewhere, f"observer {name}", ", ".join(elsewhere), f'entries of the group "{name}"')
    taken = {item.group for item in DECLARED}
    allowed = f"a group of its own, none of {', '.join(sorted(taken - {''}))}"
    require(name not in taken, "group of the observer", name, allowed)
    return observer


def observed(computed: ComputedRun, built_in: Iterable[Observer]) -> Observed:
    """Ask observers of a run: those that are built in, then those of packages beside this one.

    One of a package that fails is named in a warning, and left out.
    """
    seen = Observed()
    for observer in built_in:
        found = observer.look(computed)
        seen |= replace(found, values=observer.declared(found.values))
    for observer in observers().values():
        try:
            seen |= _of_a_package(observer, computed)
        except InputError as error:
            warnings.warn(extensions.ExtensionWarning(f"{error} It is left out."), stacklevel=2)
    return seen


def _of_a_package(observer: Observer, computed: ComputedRun) -> Observed:
    """Ask one that must not lose the run, whatever it does."""
    what = f"observer {observer.name}"
    try:
        seen = observer.look(computed)
        words = [each for name, value in seen.numerics for each in (name, value)] + seen.sources
    except Exception as error:
        raise InputError(what, f"a failure, {reason(error)}", "values of its entries") from error
    doubts = [shown(each) for each in seen.findings if not isinstance(each, Finding)]
    require(not doubts, f"findings of {what}", ", ".join(doubts), "asperity.errors.Finding")
    strange = [shown(each) for each in words if not isinstance(each, str)]
    require(not strange, f"numerics and sources of {what}", ", ".join(strange), "texts")
    return replace(seen, values=observer.declared(seen.values))
