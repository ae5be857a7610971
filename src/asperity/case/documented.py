"""Signature and docstring of a section of a case, made of the keys that it declares."""

import inspect
import textwrap
from collections.abc import Iterator, Mapping
from typing import Protocol

from asperity.parameters import (
    Either,
    File,
    Flag,
    Key,
    ListOf,
    MaterialOrName,
    Number,
    Quantity,
    ValueKind,
)

_WIDTH = 100
_INDENT = "    "


class Declared(Protocol):
    """What declares keys, and sections inside it: a section."""

    @property
    def keys(self) -> Mapping[str, Key]:
        """Its keys by name."""
        ...

    def sections(self) -> "Mapping[str, DeclaredInside]":
        """Sections inside it by name."""
        ...


class DeclaredInside(Protocol):
    """A section inside another one, as that declares it."""

    @property
    def model(self) -> Declared:
        """What it declares itself."""
        ...

    @property
    def meaning(self) -> str:
        """What it is there for."""
        ...

    @property
    def repeated(self) -> bool:
        """Whether it may come several times."""
        ...


def signature_of(model: Declared) -> inspect.Signature:
    """Signature of a section: its keys by name, defaults as a case file writes them, then its sections."""
    defaults = {name: key.default for name, key in model.keys.items() if name != "kind"}
    defaults |= {name: None for name in model.sections() if name.isidentifier()}
    return inspect.Signature(
        [
            inspect.Parameter(name, inspect.Parameter.KEYWORD_ONLY, default=default)
            for name, default in defaults.items()
        ]
    )


def documentation_of(model: Declared, summary: str) -> str:
    """Docstring of a section: its summary, with all keys as parameters before the first heading of it."""
    text = inspect.cleandoc(summary)
    lines = text.splitlines()
    heading = next((n - 1 for n, line in enumerate(lines) if line and set(line) == {"-"}), len(lines))
    parts = [*lines[:heading], ""] if heading == len(lines) else lines[:heading]
    parts += ["Parameters", "----------", *_listed(model, getattr(model, "SHOWN", {}))]
    return "\n".join([*parts, "", *lines[heading:]]).strip("\n")


def _listed(model: Declared, shown: "dict[str, tuple[str, ...]]", title: str = "") -> Iterator[str]:
    """Keys of a section with unit, default, meaning and limits; then the sections inside it with theirs."""
    names = shown.get(title, tuple(model.keys))
    for name, key in model.keys.items():
        if name in names and name != "kind":
            yield f"{name} : {_form(key.kind)}{_default(key)}"
            yield from _wrapped(_sentence(key))
    for name, inner in model.sections().items():
        several = ", or a list of them" if inner.repeated else ""
        yield f"{name} : section of keys, as a mapping{several}"
        yield from _wrapped(f"{_capital(inner.meaning)}:")
        yield ""
        for line in _listed(inner.model, shown, name):
            yield f"{_INDENT}{line}" if line else ""


def allowed_in(key: Key) -> str:
    """What may stand behind a key, in words, without an example."""
    return key.kind.allowed.split(", with its unit")[0]


def _form(kind: ValueKind) -> str:
    """What a value is, in a word: the unit of a quantity."""
    if isinstance(kind, Quantity):
        return kind.dimension or "number"
    if isinstance(kind, ListOf):
        return f"list of {_form(kind.each)}"
    if isinstance(kind, Number):
        return "whole number" if kind.whole else "number"
    if isinstance(kind, Either):
        return f"{_form(kind.other)} or text"
    if isinstance(kind, File):
        return " or ".join(["path", *(each.__name__ for each in kind.held), *["array"] * bool(kind.columns)])
    if isinstance(kind, MaterialOrName):
        return "name or Material"
    return "bool" if isinstance(kind, Flag) else "text"


def _default(key: Key) -> str:
    """Its default, as it is written with its unit."""
    return ", optional" if key.default is None else f", default {key.default!r}"


def _sentence(key: Key) -> str:
    """Say what a key means, what is allowed, and what holds without it."""
    said = f"{_capital(key.meaning)} ({allowed_in(key)}"
    said += f"; {key.within})" if key.within else ")"
    said += f"; by default {key.otherwise}" if key.default is None and key.otherwise else ""
    return f"{said}; goes with {key.goes_with}." if key.goes_with else f"{said}."


def _capital(words: str) -> str:
    return f"{words[:1].upper()}{words[1:]}"


def _wrapped(sentence: str) -> list[str]:
    lines = textwrap.wrap(sentence, _WIDTH, break_long_words=False, break_on_hyphens=False)
    return [f"{_INDENT}{line}" for line in lines]
