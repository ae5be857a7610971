"""What a study computes: one case, and lists of values for some of its keys."""

from __future__ import annotations

import hashlib
import json
import math
import os
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from asperity import __version__
from asperity.arguments import file_path, shown
from asperity.config.case import Case
from asperity.config.describing import Entry
from asperity.config.parsing import plain_data, read_definition, read_toml
from asperity.config.single_keys import entry_of, reader_of, unit_of
from asperity.config.writing import toml_text
from asperity.errors import CaseError, InputError
from asperity.kinds.cases import case_of, kind_named
from asperity.store import content_key

MOST_MEMBERS = 10_000
MOST_KEYS = 100  # that are swept: more than a case has
FORMAT = 1
"""Raise it when what is kept of a member no longer means what it meant."""
TEMPLATE = """\
# A case for every combination of the values of some keys. Run it with: asperity study STUDY
# The case: its path, from the folder of this file, or a section [case] with its keys.

case = "case.toml"

[sweep]                         # keys of the case, each with a list of values as they stand in a case
speed = ["20 m/s", "56 m/s"]
seed = [1, 2, 3]
# "contact.spacing" = ["4 um", "8 um"]
"""


@dataclass(frozen=True, eq=False)
class Axis:
    """A key and its values."""

    entry: Entry  # the key
    written: tuple[Any, ...]  # as they stand in TOML
    values: tuple[Any, ...]  # the same in SI

    @property
    def name(self) -> str:
        """The key with its section, as ``"contact.spacing"``."""
        return self.entry.dotted

    @property
    def units(self) -> str:
        """SI unit of the coordinate; ``"1"`` where the values are words."""
        return unit_of(self.entry) or "1"

    @property
    def coordinate(self) -> NDArray[Any]:
        """Values along the axis: numbers in SI, or words as they were written."""
        if unit_of(self.entry) is not None:
            return np.array(self.values)
        return np.array([written_out(value) for value in self.written])


@dataclass(frozen=True, eq=False)
class Member:
    """One case of a study."""

    index: tuple[int, ...]  # its place on the axes
    values: dict[str, Any]  # the swept keys with their values as they stand in TOML
    case: Case | None  # None if its values do not fit together
    error: CaseError | None  # why there is no case
    key: str  # names its result by everything the result depends on

    @property
    def label(self) -> str:
        """Its values, for people."""
        return ", ".join(f"{name} = {written_out(value)}" for name, value in self.values.items())


@dataclass(frozen=True, eq=False)
class Study:
    """A case, and lists of values for some of its keys."""

    data: dict[str, Any]  # keys and values of the case, as TOML gives them
    text: str  # TOML of the case
    source: str  # its file, from whose folder relative paths start
    axes: tuple[Axis, ...]  # the keys that are swept

    @property
    def shape(self) -> tuple[int, ...]:
        """Number of values of each swept key."""
        return tuple(len(axis.values) for axis in self.axes)

    @property
    def sweep(self) -> dict[str, list[Any]]:
        """Swept keys with their values as they stand in TOML."""
        return {axis.name: list(axis.written) for axis in self.axes}

    def members(self) -> list[Member]:
        """List all cases; the last key varies fastest. A `CaseError` says that none is valid."""
        digests: dict[Path, str] = {}
        found = [self._member(index, digests) for index in np.ndindex(self.shape)]
        errors = [member.error for member in found if member.error is not None]
        if len(errors) == len(found):
            messages = dict.fromkeys(message for error in errors for message in error.errors)
            raise CaseError(self.source, list(messages))
        return found

    def _member(self, index: tuple[int, ...], digests: dict[Path, str]) -> Member:
        values = {axis.name: axis.written[i] for axis, i in zip(self.axes, index, strict=True)}
        try:
            case = case_of(_with_values(self.data, values), self.text, self.source)
        except CaseError as error:
            return Member(index, values, None, error, "")
        content = json.dumps(_content(case.model_dump(), digests), sort_keys=True)  # at once: there are many
        return Member(index, values, case, None, content_key("member", FORMAT, __version__, content))


def load_study(path: str | os.PathLike[str]) -> Study:
    """Read a study, with all its values, from a TOML file: ``case``, a path or a section, and ``[sweep]``.

    All errors of keys and values are reported at once.
    """
    remedy = "Check the path, or write a study with 'asperity new study > study.toml'."
    data = read_toml(read_definition(path, "study", remedy), "study", path)
    errors = [
        str(InputError(name, "an unknown key", "case and [sweep]"))
        for name in data.keys() - {"case", "sweep"}
    ]
    base = data.get("case")
    if not isinstance(base, str | dict):
        received = "nothing" if base is None else shown(base)
        allowed = "the path of a case, or a section [case] with its keys"
        errors.append(str(InputError("case", received, allowed)))
    if errors:
        raise CaseError(str(path), sorted(errors))
    source = Path(path)
    if isinstance(base, dict):
        text = json.dumps(base, ensure_ascii=False, default=str)
        return _checked(base, text, source, data.get("sweep", {}), source)
    return _checked(*_read_case(source.parent / str(base)), data.get("sweep", {}), source)


def study_of(case: str | os.PathLike[str] | Mapping[str, Any] | Case, sweep: Mapping[str, Any]) -> Study:
    """Make a study of a case.

    Parameters
    ----------
    case : path, mapping or case object
        The case, as `asperity.run` takes it.
    sweep : mapping of str to list
        Keys with lists of values as they stand in TOML, as ``{"contact.spacing": ["4 um", "8 um"]}``.

    Returns
    -------
    Study
        The study, with all its values read.

    Raises
    ------
    InputError
        If the file is missing or no TOML.
    CaseError
        With all errors at once, if keys or values are wrong.
    """
    if isinstance(case, Case):
        return _checked(case.given, case.text, Path(case.source), sweep, "study")
    if isinstance(case, Mapping):
        data = plain_data(case)
        return _checked(data, toml_text(data), Path("case"), sweep, "study")
    allowed = "the path of a case file, its keys as a mapping, or a case object"
    return _checked(*_read_case(file_path("case", case, allowed)), sweep, "study")


def written_out(value: object) -> str:
    """Write a value of a key for people: words without quotes, lists with commas."""
    if isinstance(value, str):
        return value
    if isinstance(value, list | tuple):
        return ", ".join(map(written_out, value))
    if isinstance(value, Mapping):
        return ", ".join(f"{name} {written_out(item)}" for name, item in value.items())
    return json.dumps(value)


def _read_case(path: Path) -> tuple[dict[str, Any], str, Path]:
    text = read_definition(path, "case", "Check the path.")
    return read_toml(text, "case", path), text, path


def _checked(
    data: dict[str, Any], text: str, case_source: Path, sweep: object, source: str | os.PathLike[str]
) -> Study:
    """Read the swept values, or say all that is wrong with them."""
    if not isinstance(sweep, Mapping) or not sweep:
        received = "nothing" if not sweep else shown(sweep)
        example = 'Write [sweep] and below it, for instance, speed = ["20 m/s", "56 m/s"].'
        raise CaseError(str(source), [str(InputError("sweep", received, "a key with its values", example))])
    errors: list[str] = []
    axes: list[Axis] = []
    for dotted, values in _flat(sweep):
        if len(axes) + len(errors) >= MOST_KEYS:
            errors.append(str(InputError("sweep", "more keys", f"at most {MOST_KEYS} keys")))
            break
        try:
            if dotted in (axis.name for axis in axes):
                raise InputError(
                    dotted, "the key more than once", "each key once", "Put all values into one list."
                )
            axes.append(_axis(data.get("kind"), dotted, values, case_source))
        except InputError as error:
            name = error.what if error.what == "kind" else f"sweep.{error.what}"
            errors.append(str(InputError(name, error.received, error.allowed, error.remedy)))
    count = math.prod(len(axis.values) for axis in axes)
    if count > MOST_MEMBERS:
        received = f"{' × '.join(str(len(axis.values)) for axis in axes)} = {count} members"
        remedy = "Split the study: what is finished is kept."
        errors.append(str(InputError("sweep", received, f"at most {MOST_MEMBERS} members", remedy)))
    if errors:
        raise CaseError(str(source), list(dict.fromkeys(errors)))
    return Study(data, text, str(case_source.resolve()), tuple(axes))


def _flat(sweep: Mapping[str, Any], section: str = "") -> Iterator[tuple[str, Any]]:
    """Keys with their sections, written as ``"a.b" =``, ``a.b =`` or below [sweep.a]."""
    for name, values in sweep.items():
        if isinstance(values, Mapping) and not section:
            yield from _flat(values, f"{name}.")
        else:
            yield f"{section}{name}", values


def _axis(kind: object, dotted: str, values: object, source: Path) -> Axis:
    if dotted == "kind":
        raise InputError("kind", "a swept key", "one kind of case in a study", "Write a study for each kind.")
    entry = entry_of(kind_named(kind).case, dotted)
    if not isinstance(values, list | tuple):
        raise InputError(dotted, shown(values), "a list of values", "Put the values into [ ].")
    if not values:
        raise InputError(dotted, "an empty list", "one value or more", "Remove the key for that of the case.")
    if len(values) > MOST_MEMBERS:
        raise InputError(dotted, f"{len(values)} values", f"at most {MOST_MEMBERS}", "Split the study.")
    read: dict[Any, None] = {}  # in their order
    value_of = reader_of(entry, source)
    for number, value in enumerate(values, 1):
        try:
            found = value_of(value)
        except InputError as error:
            raise InputError(f"{dotted}[{number}]", error.received, error.allowed, error.remedy) from None
        if found in read:
            raise InputError(dotted, f"{shown(value)} more than once", "each value once")
        read[found] = None
    return Axis(entry, tuple(values), tuple(read))


def _with_values(data: Mapping[str, Any], values: Mapping[str, Any]) -> dict[str, Any]:
    """Keys of a case with other values for some of them."""
    changed = dict(data)
    for dotted, value in values.items():
        section, _, name = dotted.rpartition(".")
        if not section:
            changed[name] = value
        elif isinstance(changed.setdefault(section, {}), Mapping):
            changed[section] = {**changed[section], name: value}
    return changed


def _content(value: Any, digests: dict[Path, str]) -> Any:
    """Values of a case with what its files hold in place of their names."""
    if isinstance(value, Mapping):
        return {name: _content(item, digests) for name, item in value.items()}
    if isinstance(value, list | tuple):
        return [_content(item, digests) for item in value]
    if isinstance(value, Path):
        if value not in digests:
            with open(value, "rb") as file:
                digests[value] = hashlib.file_digest(file, "sha256").hexdigest()
        return digests[value]
    return value
