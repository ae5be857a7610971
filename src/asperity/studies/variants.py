"""Named changes of several keys of a case: to other values, or by as much as is told."""

import math
import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from typing import Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from asperity.arguments import require, shown
from asperity.case.content import content
from asperity.case.describing import CaseKey, entry_of, value_in_toml
from asperity.case.form import Section
from asperity.case.scene import Case
from asperity.errors import CaseError, InputError
from asperity.parameters import Origin, keys_of
from asperity.reference.materials import Material
from asperity.structures.track import Track
from asperity.units import quantity

VARIANT, AS_IT_IS = "variant", "as it is"
"""Dimension of the named changes, and the name of the first of them, which changes nothing."""
_BY = re.compile(r"\s*(times|plus|minus)\s+(.+)")
_INSTEAD = re.compile(r"\s*(.+?)\s+(instead of)\s+(.+?)\s*")


class Unfit(Exception):
    """Why a change does not apply to a case."""


def _refuse_measured(case: Case, entry: CaseKey) -> None:
    """What was measured on a track holds for that track alone, whose sound power it decides."""
    if entry.section != "track" or entry.name not in keys_of(Track, ""):
        return
    for name in ("decay_rates", "mobility"):
        if getattr(case.track, name, None) is not None:
            raise Unfit(f"track.{name} was measured on the track as it is: leave it out to ask for another")


@dataclass(frozen=True)
class Change:
    """What becomes of a key."""

    entry: CaseKey  # the key
    written: Any  # as it stands in TOML, or in words: "times 0.5"
    way: str = ""  # "times", "plus", "minus" or "instead of"; empty: what is written is the value
    by: Any = None  # by how much, in SI, or the value that the case must have
    value: Any = None  # that it then gets

    @classmethod
    def read(cls, entry: CaseKey, written: Any, origin: Origin) -> "Change":
        """Read a change; an `InputError` says what is wrong with it."""
        words = written if isinstance(written, str) else ""
        if entry.unit is not None and (match := _BY.fullmatch(words)):
            unit = "" if match[1] == "times" or entry.unit == "1" else entry.unit
            try:
                by = quantity(match[2], unit)
            except InputError as error:
                raise error.about(entry.dotted) from None
            require(0.0 < by < math.inf, entry.dotted, shown(written), f"{match[1]} a number greater than 0")
            return cls(entry, written, match[1], by)
        if match := _INSTEAD.fullmatch(words):
            entry.read(match[1], origin)
            return cls(entry, written, match[2], content(entry.read(match[3], origin)), match[1])
        found = entry.read(written, origin)
        return cls(entry, written, value=as_in_toml(written, found, entry))

    def applied(self, case: Case) -> Any:
        """The value that the key gets in a case, as it stands in TOML; `Unfit` says why there is none."""
        _refuse_measured(case, self.entry)
        if not self.way:
            return self.value
        now, name = _value_of(case, self.entry), self.entry.dotted
        if self.way == "instead of":
            if content(now) != self.by:
                raise Unfit(f"{name} is {now}, not {self.by}")
            return self.value
        found = now * self.by if self.way == "times" else now + self.by * (1 if self.way == "plus" else -1)
        whole = isinstance(now, int) and found == int(found)
        return value_in_toml(int(found) if whole else found, self.entry.key)


def _value_of(case: Case, entry: CaseKey) -> Any:
    """Value of a key in a case, that of a named set where it gives none."""
    section: Section = getattr(case, entry.section) if entry.section else case
    companion = entry.key.goes_with
    if (entry.section and entry.section not in case.section_names) or not section.is_active(entry.name):
        raise Unfit(f"the case has no {entry.dotted}{f', which goes with {companion}' if companion else ''}")
    now = getattr(section, entry.name)
    now = section.default_of(entry.name) if now is None else now
    if now is None:
        raise Unfit(f"the case has no {entry.dotted}")
    return now


@dataclass(frozen=True, eq=False)
class VariantAxis:
    """Named changes of a case; the first changes nothing."""

    changes: Mapping[str, tuple[Change, ...]]  # by name
    name: ClassVar[str] = VARIANT
    meaning: ClassVar[str] = "what is changed of the case"
    units: ClassVar[str] = "1"
    typed: Mapping[str, Any] = field(default_factory=dict)

    @property
    def values(self) -> tuple[str, ...]:
        """Names of the variants."""
        return tuple(self.changes)

    written = values

    @property
    def told(self) -> dict[str, dict[str, Any]]:
        """The changes by name, as they stand in TOML."""
        return {
            name: {change.entry.dotted: change.written for change in changes}
            for name, changes in self.changes.items()
        }

    @property
    def coordinate(self) -> NDArray[Any]:
        """Names along the axis."""
        return np.array(self.values)

    def keys(self, name: str, case: Case) -> dict[str, Any]:
        """Keys that a variant changes in a case, with their values; an error says why it changes none.

        What a case does not have is not changed: half of no damping is none.
        """
        found, reasons = {}, []
        for change in self.changes[name]:
            try:
                found[change.entry.dotted] = change.applied(case)
            except Unfit as reason:
                reasons.append(str(reason))
        if reasons and not found:
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
        what, changes = f'{VARIANT}."{name}"', []
        if not (isinstance(name, str) and name.strip() and name.isprintable() and name != AS_IT_IS):
            errors.append(InputError(what, "this name", f'a name of one line other than "{AS_IT_IS}"'))
        if not (isinstance(keys, Mapping) and keys):
            errors.append(InputError(what, shown(keys), "one key or more of the case, with their values"))
            continue
        for dotted, value in flat(keys):
            try:
                require(dotted != "kind", dotted, "a key that is changed", "one kind of case in a study")
                changes.append(Change.read(entry_of(model, dotted), value, origin))
            except InputError as error:
                errors.append(error.about(f"{what}.{error.what}"))
        found[name] = tuple(changes)
    return VariantAxis(found), errors


def flat(keys: Mapping[str, Any], section: str = "") -> Iterator[tuple[str, Any]]:
    """Keys with their sections, written as ``"a.b" =``, ``a.b =`` or below a section a."""
    for name, value in keys.items():
        if isinstance(value, Mapping) and not section and name != VARIANT:
            yield from flat(value, f"{name}.")
        else:
            yield f"{section}{name}", value


def as_in_toml(value: Any, found: Any, entry: CaseKey) -> Any:
    """A value as it would stand in a file: as it was given, but for numbers in SI."""
    bare = isinstance(value, int | float | np.generic | Material) and not isinstance(value, bool)
    return value_in_toml(found, entry.key) if bare else value
