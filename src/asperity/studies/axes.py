"""What a study varies: a key and its values, or named changes of several keys, along an axis of its table."""

import json
import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from xarray import Variable

from asperity.arguments import require, shown
from asperity.case.any_case import AnyCase, CaseKey, entry_of
from asperity.case.form import Section, content
from asperity.case.in_memory import described_value, holds_memory
from asperity.case.written_values import value_in_toml
from asperity.errors import CaseError, InputError
from asperity.parameters import Origin, Text, key, keys_of
from asperity.reference.materials import Material
from asperity.reporting.data import TYPED_FACTOR, TYPED_UNIT
from asperity.results import variable
from asperity.structures.track import Track
from asperity.units import factor, quantity, unit_in


@dataclass(frozen=True, eq=False)
class SweptAxis:
    """A key and its values."""

    entry: CaseKey  # the key
    written: tuple[Any, ...]  # as they stand in TOML
    values: tuple[Any, ...]  # the same in SI

    @property
    def name(self) -> str:
        """The key with its section, as ``"contact.spacing"``."""
        return self.entry.dotted

    @property
    def told(self) -> Any:
        """The values as they stand in TOML, for tables and programs."""
        return list(self.written)

    @property
    def variable(self) -> Variable:
        """Coordinate along the axis: numbers in SI, or words as they were written.

        With the unit in which its first value was written that has one, and what that is in SI.
        """
        units = self.entry.unit or "1"
        written = (unit_in(value) for value in self.written if isinstance(value, str))
        unit = next(filter(None, written), units)
        bare = units in ("1", "dB") or unit == units
        typed = {} if bare else {TYPED_UNIT: unit, TYPED_FACTOR: factor(unit, units)}
        values = map(written_out, self.written) if self.entry.unit is None else self.values
        return variable(self.name, np.array(list(values)), units, self.entry.key.meaning, **typed)


def written_out(value: object) -> str:
    """Write a value of a key for people: words without quotes, lists with commas."""
    if isinstance(value, str):
        return value
    if isinstance(value, list | tuple):
        return ", ".join(map(written_out, value))
    if isinstance(value, Mapping):
        return ", ".join(f"{name} {written_out(item)}" for name, item in value.items())
    return described_value(value) if holds_memory(value) else json.dumps(value, default=str)


def as_in_toml(value: Any, found: Any, entry: CaseKey) -> Any:
    """A value as it would stand in a file: as it was given, but for numbers in SI."""
    bare = isinstance(value, int | float | np.generic | Material) and not isinstance(value, bool)
    return value_in_toml(found, entry.key) if bare else value


# --- named changes of several keys


VARIANT = "variant"
"""Dimension of the named changes."""
AS_IT_IS = "as it is"
"""Name of the first of them, which changes nothing."""
WAYS = {"times": (None, 0.0), "plus": (1.0, 1.0), "minus": (1.0, -1.0)}
"""Words before a number: factor of what the case has (None: the number), and sign of what is added to it."""
MOST_ERRORS = 20
"""Wrong keys of which each is looked at."""


class Unfit(Exception):
    """Why a change does not apply to a case."""


class Nothing(Unfit):
    """What a change would change is not there: any part of it is none, either."""


def _refuse_measured(case: AnyCase, entry: CaseKey) -> None:
    """What was measured on a track holds for that track alone, whose sound power it decides."""
    if entry.section != "track" or entry.name not in keys_of(Track, ""):
        return
    for name in ("decay_rates", "mobility"):
        if getattr(getattr(case, entry.section), name, None) is not None:
            raise Unfit(f"track.{name} was measured on the track as it is: leave it out to ask for another")


@dataclass(frozen=True)
class Change:
    """What becomes of a key."""

    entry: CaseKey  # the key
    written: Any  # as it stands in TOML, or in words: "times 0.5"
    value: Any = None  # that it gets
    former: Any = None  # that it must have had
    factor: float | None = None  # of what the case has, in place of a value, and in SI what is added to that
    added: float = 0.0

    @classmethod
    def read(cls, entry: CaseKey, written: Any, origin: Origin) -> "Change":
        """Read a change; an `InputError` says what is wrong with it."""
        words = written.strip() if isinstance(written, str) else ""
        way, _, number = words.partition(" ")
        value, instead, former = words.partition(" instead of ")
        if entry.unit is not None and way in WAYS:
            try:
                by = quantity(number, "" if way == "times" or entry.unit == "1" else entry.unit)
            except InputError as error:
                raise error.about(entry.dotted) from None
            require(0.0 < by < math.inf, entry.dotted, shown(written), f"{way} a number greater than 0")
            factor, sign = WAYS[way]
            return cls(entry, written, factor=factor or by, added=sign * by)
        if instead:
            entry.read(value, origin)
            return cls(entry, written, value, content(entry.read(former, origin)))
        return cls(entry, written, as_in_toml(written, entry.read(written, origin), entry))

    @property
    def is_part(self) -> bool:
        """Whether it takes a multiple of what the case has."""
        return self.factor is not None and not self.added

    def applied(self, case: AnyCase) -> Any:
        """The value that the key gets in a case, as it stands in TOML; `Unfit` says why there is none."""
        _refuse_measured(case, self.entry)
        if self.factor is None and self.former is None:
            return self.value
        now = value_of(case, self.entry)
        if self.factor is None:
            if content(now) != self.former:
                raise Unfit(f"{self.entry.dotted} is {now}, not {self.former}")
            return self.value
        found = self.factor * now + self.added
        whole = isinstance(now, int) and found == int(found)
        return value_in_toml(int(found) if whole else found, self.entry.key)


def value_of(case: AnyCase, entry: CaseKey) -> Any:
    """Value of a key in a case, that of a named set where it gives none."""
    section: Section = getattr(case, entry.section) if entry.section else case
    companion = entry.key.goes_with
    if (entry.section and entry.section not in case.section_names) or not section.is_active(entry.name):
        raise Nothing(
            f"the case has no {entry.dotted}{f', which goes with {companion}' if companion else ''}"
        )
    if section.is_absent:
        raise Nothing(f"the case has no {entry.section}")
    now = getattr(section, entry.name)
    now = section.default_of(entry.name) if now is None else now
    if now is None:
        raise Nothing(f"the case has no {entry.dotted}")
    return now


@dataclass(frozen=True, eq=False)
class VariantAxis(SweptAxis):
    """Named changes of a case; the first changes nothing."""

    changes: Mapping[str, tuple[Change, ...]]  # by name

    @property
    def told(self) -> dict[str, dict[str, Any]]:
        """The changes by name, as they stand in TOML."""
        return {
            name: {change.entry.dotted: change.written for change in changes}
            for name, changes in self.changes.items()
        }

    def keys(self, name: str, case: AnyCase) -> dict[str, Any]:
        """Keys that a variant changes in a case, with their values; an error says why it cannot be made.

        What it says is made as a whole, or not at all. But half of no damping is none: a part of what a case
        does not have changes nothing.
        """
        found = {}
        reasons = list[str]()
        whole = True
        for change in self.changes[name]:
            try:
                found[change.entry.dotted] = change.applied(case)
            except Unfit as reason:
                reasons.append(str(reason))
                whole = whole and isinstance(reason, Nothing) and change.is_part
        if reasons and not (whole and found):
            raise CaseError(name, reasons)
        return found


def variant_axis(model: type[Section], given: object, origin: Origin) -> tuple[VariantAxis, list[InputError]]:
    """Read named changes of a kind of case, and list what is wrong with them."""
    found: dict[str, tuple[Change, ...]] = {AS_IT_IS: ()}
    errors: list[InputError] = []
    named = given if isinstance(given, Mapping) else {}
    if not named:
        remedy = f'Write [sweep.{VARIANT}."soft pads"], and below it track.pad_stiffness = "times 0.5".'
        errors.append(InputError(VARIANT, shown(given), "names, each with keys and their values", remedy))
    for name, keys in named.items():
        what = f'{VARIANT}."{name}"'
        changes = dict[str, Change]()
        if not (isinstance(name, str) and name.strip() and name.isprintable() and name != AS_IT_IS):
            errors.append(InputError(what, "this name", f'a name of one line other than "{AS_IT_IS}"'))
        if not (isinstance(keys, Mapping) and keys):
            errors.append(InputError(what, shown(keys), "one key or more of the case, with their values"))
            continue
        for dotted, value in flat(keys):
            if len(errors) >= MOST_ERRORS:
                break
            try:
                require(dotted != "kind", dotted, "a key that is changed", "one kind of case in a study")
                require(dotted not in changes, dotted, "the key more than once", "each key once")
                changes[dotted] = Change.read(entry_of(model, dotted), value, origin)
            except InputError as error:
                errors.append(error.about(f"{what}.{error.what}"))
        found[name] = tuple(changes.values())
    entry = CaseKey(VARIANT, key(Text(), None, "what is changed of the case"))
    return VariantAxis(entry, tuple(found), tuple(found), found), errors


def flat(keys: Mapping[str, Any], section: str = "") -> Iterator[tuple[str, Any]]:
    """Keys with their sections, written as ``"a.b" =``, ``a.b =`` or below a section a."""
    for name, value in keys.items():
        if isinstance(value, Mapping) and not section and name != VARIANT:
            yield from flat(value, f"{name}.")
        else:
            yield f"{section}{name}", value
