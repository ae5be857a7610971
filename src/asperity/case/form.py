"""A section of a case: keys with their defaults, read into a frozen object in SI, with all errors at once.

And what a section says: to compare cases, to name results, to write case files.
"""

import hashlib
import inspect
import json
import re
from collections.abc import Callable, Iterator, Mapping
from dataclasses import asdict, replace
from functools import cache
from pathlib import Path
from typing import Any, ClassVar, NamedTuple, NoReturn, Self

from asperity import __version__, extensions
from asperity.arguments import nearest, shown
from asperity.case import documented
from asperity.case.in_memory import PLAIN, InMemory, described_value, digest, holds_memory
from asperity.case.written_values import value_in_toml
from asperity.errors import CaseError, InputError
from asperity.parameters import FROM_PYTHON, Key, Origin, Problems, ValueKind, in_its_unit, outside
from asperity.reference.materials import Material
from asperity.speeds import SpeedCourse
from asperity.store import content_key

_NUMBER = re.compile(r"\[([2-9]|[1-9]\d{1,3})\]$")


class Inner(NamedTuple):
    """A section inside another one."""

    model: "type[Section]"
    meaning: str
    repeated: bool = False  # whether it may come several times
    last: bool = False  # whether it comes after those that are declared later


def section(
    model: "type[Section]", meaning: str, *, repeated: bool = False, last: bool = False, **defaults: Any
) -> Any:
    """Declare a section inside another one, and other defaults that its keys have there, as in TOML.

    One that may be repeated, as ``[[fault]]``, has the names ``fault``, ``fault[2]``, ``fault[3]`` …
    """
    return Inner(model.with_defaults(**defaults) if defaults else model, meaning, repeated, last)


def numbered(given: Mapping[str, Any]) -> dict[str, Any]:
    """Keys and values with lists of sections one by one, by their names with numbers."""
    found: dict[str, Any] = {}
    for name, value in given.items():
        of_sections = isinstance(value, list | tuple) and value
        if of_sections and all(isinstance(each, Mapping | Section) for each in value):
            found |= {f"{name}[{n}]" if n > 1 else name: each for n, each in enumerate(value, 1)}
        else:
            found[name] = value
    return found


class _Signature:
    """The signature of a section, which `inspect` and `help` ask for."""

    def __get__(self, _: object, model: "type[Section]") -> inspect.Signature:
        return documented.signature_of(model)


class _Documentation:
    """The docstring of a section: a summary, and all keys that the section declares."""

    def __init__(self, summary: str) -> None:
        self.summary = summary

    def __get__(self, _: object, model: "type[Section]") -> str:
        return documented.documentation_of(model, self.summary)


class Section:
    """A frozen section of a case: unknown keys are errors, and all errors are reported together.

    Its class attributes made by `key`, `optional` and `section` are its keys, in their order, those of its
    bases first; a class may declare a key of its base anew.
    """

    keys: ClassVar[dict[str, Key]] = {}
    inner: ClassVar[dict[str, Inner]] = {}
    ALTERNATIVES: ClassVar[tuple[tuple[str, str], ...]] = ()
    """Pairs of keys of which one may be given."""
    RENAMED: ClassVar[Mapping[str, str]] = {}
    """Keys and sections of its bases by their names there, and what they are called here; both are read."""
    ABSENT_WITHOUT: ClassVar[str] = ""
    """Key without which the case has nothing of what the section describes; empty for none."""
    OFFERED: ClassVar[tuple[str, ...]] = ()
    """What `dir` lists beside the keys: what a section does for people."""
    given_names: frozenset[str]
    """Keys that were given, not left out."""
    __signature__ = _Signature()

    def __init_subclass__(
        cls, parameters: Mapping[str, Key] | None = None, defaults: Mapping[str, Any] | None = None
    ) -> None:
        """Collect the keys: with those of `parameters`, and other `defaults`, as in TOML, for some."""
        declared: dict[str, Any] = {}
        for base in reversed(cls.__mro__):
            renamed = vars(base).get("RENAMED", {})
            declared = {renamed.get(name, name): each for name, each in declared.items()}
            own = vars(base).get("keys", {}) | vars(base).get("inner", {}) | vars(base)
            declared |= {name: each for name, each in own.items() if isinstance(each, Key | Inner)}
        declared |= parameters or {}
        declared |= {name: replace(declared[name], default=each) for name, each in (defaults or {}).items()}
        for name in [name for name, each in vars(cls).items() if isinstance(each, Key | Inner)]:
            delattr(cls, name)
        cls.keys = {name: each for name, each in declared.items() if isinstance(each, Key)}
        inner = [(name, each) for name, each in declared.items() if isinstance(each, Inner)]
        cls.inner = dict(sorted(inner, key=lambda named: named[1].last))
        type.__setattr__(cls, "__doc__", _Documentation(vars(cls)["__doc__"] or ""))

    @classmethod
    def called(cls, name: str) -> str:
        """What a key or a section of its bases is called here."""
        return cls.RENAMED.get(name, name)

    @classmethod
    def summary(cls) -> str:
        """First sentence of its docstring, without the full stop."""
        text: str = inspect.cleandoc(vars(cls)["__doc__"].summary)
        return text.partition("\n")[0].rstrip(".")

    @classmethod
    def sections(cls) -> Mapping[str, Inner]:
        """Sections inside it, by name."""
        return cls.inner

    @property
    def section_names(self) -> tuple[str, ...]:
        """Sections that matter; what is repeated with numbers, as ``fault[2]``."""
        return (*self.inner, *(name for name in vars(self) if name.endswith("]")))

    @classmethod
    def section_at(cls, name: str) -> Inner | None:
        """The section of a name, which may be numbered where it may be repeated; None where there is none."""
        inner = cls.sections().get(plain := _NUMBER.sub("", name))
        return inner if inner and (plain == name or inner.repeated) else None

    def __init__(self, **given: Any) -> None:
        if errors := self._fill(given, FROM_PYTHON, type(self)):
            raise CaseError(type(self).__name__, list(map(_told, errors)))

    @classmethod
    def read(cls, given: Mapping[str, Any], origin: Origin) -> Self:
        """Make it of keys and values, sections as mappings; a `CaseError` has all that is wrong with them."""
        made = cls.__new__(cls)
        if errors := made._fill(given, origin, cls):
            raise CaseError(origin.source, list(map(_told, errors)))
        return made

    @classmethod
    def with_defaults(cls, **defaults: Any) -> type[Self]:
        """The same section with other defaults, as in TOML."""
        own = {"__doc__": vars(cls)["__doc__"].summary, "__module__": cls.__module__}
        return type(cls.__name__, (cls,), own, defaults=defaults)

    def _fill(
        self, given: Mapping[str, Any], origin: Origin, whole: "type[Section]", title: str = ""
    ) -> list[InputError]:
        """Read all keys as a section of a whole, or the whole itself; return what is wrong with them."""
        errors = list[InputError]()
        held = self.__dict__
        for pair in self.RENAMED.items():
            if given.keys() >= set(pair):
                return [_both(pair)]
        try:
            called = {self.RENAMED.get(name, name): value for name, value in given.items()}
            given = self.prepared(numbered(called))
        except Problems as problems:
            return problems.errors
        held["given_names"] = frozenset([name for name, value in given.items() if value is not None])
        for name, key in self.keys.items():
            try:
                left_out = name not in given or (given[name] is None and key.default is None)
                held[name] = default_value(key) if left_out else key.kind(given[name], origin)
            except InputError as error:
                errors.append(error.about(name))
            except Problems as problems:
                errors += [_below(name, error) for error in problems.errors]
        sections = self.sections()
        others = [name for name in given if name not in self.keys and name not in sections]
        several = {name: inner for name in others if (inner := self.section_at(name))}
        for name, inner in {**sections, **several}.items():
            value = given.get(name)
            value = value.given() if isinstance(value, Section) else value
            held[name], wrong = _of_nothing(inner)
            if value and isinstance(value, Mapping):
                held[name] = inner.model.__new__(inner.model)
                wrong = held[name]._fill(value, origin, whole, name)
            elif not isinstance(value, Mapping | None):
                wrong = []
                errors.append(InputError(name, shown(value), f"a section [{name}]"))
            errors += [_below(name, each) for each in wrong]
            if (number := _NUMBER.search(name)) and (before := int(number[1]) - 1) > 1:
                gap = name.replace(number[0], f"[{before}]")
                errors += [] if gap in given else [InputError(name, f"one without {gap}", "one by one")]
        errors += [_unknown(name, type(self), whole, title) for name in others if name not in several]
        return errors or self._inconsistent()

    def _inconsistent(self) -> list[InputError]:
        """What is wrong with keys that are right one by one; what follows from others is filled in before."""
        implausible = list[InputError]()
        for name, key in self.keys.items():
            if name not in self.given_names or not key.within:
                continue
            value = getattr(self, name)
            every = (value.slowest, float(value)) if isinstance(value, SpeedCourse) else (value,)
            for each in value if isinstance(value, tuple) else every:
                implausible += outside(name, each, key.one, key.within)
        if implausible:
            return implausible
        self._choose()
        return [*self._lonely(), *self._both_given()] or [*self.problems()]

    @classmethod
    def prepared(cls, given: Mapping[str, Any]) -> Mapping[str, Any]:
        """Keys and values before they are read: what Python may hand over in other forms is put right."""
        return given

    def _choose(self) -> None:
        """Fill in what follows from other keys."""

    def problems(self) -> Iterator[InputError]:
        """Errors between keys that are right one by one."""
        yield from ()

    def _lonely(self) -> Iterator[InputError]:
        for name in sorted(self.given_names & self.keys.keys()):
            if self.keys[name].goes_with and not self.is_active(name):
                companion, _, value = self.keys[name].goes_with.partition("=")
                wanted = f'{companion} = "{value}"' if value else companion
                received = _shown(getattr(self, name), self.keys[name].one)
                yield InputError(name, received, f"only together with {wanted}")

    def _both_given(self) -> Iterator[InputError]:
        for pair in self.ALTERNATIVES:
            if self.given_names.issuperset(pair):
                yield _both(pair)

    def is_active(self, name: str) -> bool:
        """Whether the key that `name` goes with is there."""
        companion, _, value = self.keys[name].goes_with.partition("=")
        if value:
            return bool(getattr(self, companion) == value)
        return not companion or any(getattr(self, each) is not None for each in companion.split(" or "))

    @property
    def is_absent(self) -> bool:
        """Whether the case has nothing of what this section describes, whatever the defaults of its keys."""
        return bool(self.ABSENT_WITHOUT) and getattr(self, self.ABSENT_WITHOUT) is None

    def default_of(self, name: str) -> Any:
        """Value of a key that is left out; without a fixed default, what was chosen for it."""
        fixed = default_value(self.keys[name])
        return getattr(self, name) if fixed is None and name not in self.given_names else fixed

    def given(self) -> dict[str, Any]:
        """Keys whose values differ from their defaults, sections as dicts."""
        different = {
            name: getattr(self, name)
            for name in self.keys
            if name in self.given_names and content(getattr(self, name)) != content(self.default_of(name))
        }
        inner = {name: getattr(self, name).given() for name in self.section_names}
        return different | {name: keys for name, keys in inner.items() if keys}

    def with_chosen(self, **chosen: Any) -> Self:
        """The same section with values, in SI, for keys that are left out, or other sections inside it.

        What is chosen does not count as given. What was worked out of other values is forgotten.
        """
        held = self.given_names - self.sections().keys()
        return self._with({name: each for name, each in chosen.items() if name not in held}, self.given_names)

    def with_known(self, **values: Any) -> Self:
        """The same section with values, in SI, that are right and fit together: nothing is read again.

        Values count as given; None takes a key out. What was worked out of other values is forgotten.
        """
        taken = {name for name, value in values.items() if value is None}
        usual = {name: default_value(self.keys[name]) for name in taken}
        return self._with(values | usual, (self.given_names | values.keys()) - taken)

    def _with(self, values: Mapping[str, Any], given_names: frozenset[str]) -> Self:
        """The same keys and sections with other values for some, and names of those that count as given."""
        made = type(self).__new__(type(self))
        inside = self.keys.keys() | self.sections().keys()  # and numbered sections, as fault[2]
        read = {name: each for name, each in vars(self).items() if name in inside or name.endswith("]")}
        made.__dict__.update({**read, **values, "given_names": given_names})
        return made

    def __reduce__(self) -> tuple[Any, ...]:
        return _restored, (type(self), self._state())

    def _state(self) -> dict[str, Any]:
        """All that it holds, sections as dicts: their classes may have no name to be found by."""
        return {
            name: each._state() if isinstance(each, Section) else each for name, each in self.__dict__.items()
        }

    def __dir__(self) -> list[str]:
        """List keys and sections, and what a person does with them."""
        offered = {name for model in type(self).__mro__ for name in vars(model).get("OFFERED", ())}
        return sorted({*self.keys, *self.section_names, *offered})

    def __repr__(self) -> str:
        keys = in_toml(self, in_memory=lambda _, value: f"<{described_value(value)}>")
        return f"{type(self).__name__}({', '.join(f'{name}={value!r}' for name, value in keys.items())})"

    def __setattr__(self, name: str, value: object) -> NoReturn:
        remedy = f"Make another case: case.with_({name}=…), or with the section before a dot."
        raise AttributeError(f"{name} of {type(self).__name__} does not change. {remedy}")

    def __eq__(self, other: object) -> bool:
        return type(self) is type(other) and content(self) == content(other)

    def __hash__(self) -> int:
        return hash(json.dumps(content(self)))


def _restored(model: type[Section], state: Mapping[str, Any]) -> Section:
    """Make a section of its state, as it was."""
    made = model.__new__(model)
    for name, each in state.items():
        inner = model.section_at(name)
        made.__dict__[name] = each if inner is None else _restored(inner.model, each)
    return made


@cache
def _of_nothing(inner: Inner) -> tuple[Section, list[InputError]]:
    """A section of which nothing is given, made once, and what is wrong with that."""
    made = inner.model.__new__(inner.model)
    return made, made._fill({}, FROM_PYTHON, inner.model)


@cache
def default_value(key: Key) -> Any:
    """Default of a key, as a section has it."""
    return None if key.default is None else key.kind(key.default)


def _unknown(name: str, here: type[Section], whole: type[Section], title: str) -> InputError:
    """Error about an unknown key: the nearest one here, or the section in which it would be known."""
    place = f"keys of [{title}]" if title else "keys at the top of a case"
    homes = [f"[{other}]" for other, inner in whole.sections().items() if name in inner.model.keys]
    if title and name in {*whole.keys, *whole.sections()}:
        homes.insert(0, "the top of the case, above the first section")
    names = [*here.keys, *here.sections()]
    remedy = f"Move it to {homes[0]}." if homes else nearest(name, names)
    shown = getattr(whole, "SHOWN", {}).get(title, names)
    return InputError(str(name), "an unknown key", f"{place}: {', '.join(shown)}", remedy)


def _below(name: str, error: InputError) -> InputError:
    """An error told of something inside what has a name."""
    dot = "" if error.what.startswith("[") or not error.what else "."
    return error.about(f"{name}{dot}{error.what}")


def _both(pair: tuple[str, str]) -> InputError:
    return InputError("", f"both {pair[0]} and {pair[1]}", "one of them", "Remove one.")


def _told(error: InputError) -> str:
    return str(error if error.what else _below("the case", error))


def _shown(value: object, kind: ValueKind) -> str:
    if holds_memory(value):
        return described_value(value)
    return in_its_unit(str(value) if isinstance(value, Path) else value, kind)


# --- what sections say


def in_toml(section: Section, in_memory: Callable[[str, Any], Any], title: str = "") -> dict[str, Any]:
    """Keys that are not at their defaults as they would stand in a case file, to the last bit.

    `in_memory` says what stands for the surface or table that a dotted key has instead of a file.
    """
    keys: dict[str, Any] = {}
    for name, value in section.given().items():
        if name in section.section_names:
            keys[name] = in_toml(getattr(section, name), in_memory, f"{name}.")
        elif holds_memory(value):
            keys[name] = in_memory(f"{title}{name}", value)
        else:
            keys[name] = value_in_toml(value, section.keys[name])
    return keys


def content(value: Any, of_file: Callable[[Path], str] = str) -> Any:
    """Plain numbers, words, lists and dicts that are the same for values that mean the same.

    `of_file` says what stands for a file: its path, or a digest of what it holds.
    """
    if isinstance(value, PLAIN):
        return value.points if isinstance(value, SpeedCourse) else value
    if isinstance(value, Section):
        return {name: content(getattr(value, name), of_file) for name in (*value.keys, *value.section_names)}
    if isinstance(value, Mapping):
        return {name: content(item, of_file) for name, item in value.items()}
    if isinstance(value, list | tuple):
        return [content(item, of_file) for item in value]
    if isinstance(value, Material):
        return asdict(value)
    if isinstance(value, Path):
        return of_file(value)
    return digest(value) if isinstance(value, InMemory) else value


def file_digest(path: Path) -> str:
    """SHA-256 over what a file holds."""
    with open(path, "rb") as file:
        return hashlib.file_digest(file, "sha256").hexdigest()


def case_key(
    name: str, version: int, case: Section, *more: object, of_file: Callable[[Path], str] = file_digest
) -> str:
    """Name of what is kept of a case, as `content_key`: by its keys, its files, and what else is told.

    Beside them by the version of what is kept, of the program, and of packages that extend it.
    """
    told = json.dumps(content(case, of_file), sort_keys=True)
    return content_key(name, version, __version__, told, *more, *extensions.stamp())
