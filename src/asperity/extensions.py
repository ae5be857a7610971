"""What packages beside this one offer by entry points: laws, readers, structures, kinds, observers, chapters.

A package names what it offers in its ``pyproject.toml``, one line each, below
``[project.entry-points."asperity.laws"]`` and the like. Nothing of it is imported before it is asked for, and
what cannot be imported is named in a warning, while everything else works.
"""

import os
import sys
import warnings
from collections.abc import Callable
from functools import cache
from importlib import import_module
from importlib.util import find_spec
from pathlib import Path
from typing import Any, NamedTuple, TypeVar

from asperity.errors import InputError, printable, reason

LAWS = "asperity.laws"
READERS = "asperity.readers"
STRUCTURES = "asperity.structures"
KINDS = "asperity.kinds"
OBSERVERS = "asperity.observers"
CHAPTERS = "asperity.chapters"
GROUPS = {
    LAWS: "law",
    READERS: "reader",
    STRUCTURES: "structure",
    KINDS: "kind of case",
    OBSERVERS: "observer",
    CHAPTERS: "chapter",
}
"""Groups of entry points, and what each names."""
_MARK = b"[asperity."
_TOLD = (".dist-info", ".egg-info")
"""Folders in which an installed package says what it offers."""

T = TypeVar("T")


class ExtensionWarning(UserWarning):
    """Something that another package offers cannot be used."""


class Offer(NamedTuple):
    """What a package offers under a name."""

    group: str
    name: str
    place: str  # module and attribute, as ``"own_law:LAW"``
    package: str  # with its version

    @property
    def described(self) -> str:
        """Say what it is, for messages."""
        return printable(f'the {GROUPS[self.group]} "{self.name}" of the package {self.package}')

    def load(self) -> Any:
        """Import it; an `InputError` says why it cannot be."""
        module, _, attribute = self.place.partition(":")
        try:
            thing = import_module(module)
            for each in filter(None, attribute.split(".")):
                thing = getattr(thing, each)
        except (Exception, SystemExit) as error:  # whatever a module does when it is imported
            received = f"{self.place}, which fails with {reason(error)}"
            raise InputError(self.described, received, "an object that can be imported") from error
        return thing

    def refuse(self, why: InputError) -> None:
        """Warn that it cannot be used."""
        said = str(why) if why.what == self.described else f"{self.described}: {why}"
        warnings.warn(ExtensionWarning(f"{said} It is left out; mend or remove the package."), stacklevel=3)


def offers(group: str) -> tuple[Offer, ...]:
    """What packages offer in a group, in the order in which they are found."""
    return tuple(each for each in _found() if each.group == group)


@cache
def _found() -> tuple[Offer, ...]:
    """All offers of installed packages.

    Most installations have none: the library that reads what packages say of themselves takes longer to
    import than this program, and is asked only where a package names this one.
    """
    if not any(map(_names_this_program, sys.path)):
        return ()
    from importlib.metadata import distributions

    packages = {each.metadata["Name"]: each for each in reversed(list(distributions()))}  # first on the path
    return tuple(
        Offer(entry.group, entry.name, entry.value, f"{name} {package.version}")
        for name, package in reversed(packages.items())
        for entry in package.entry_points
        if entry.group in GROUPS
    )


def _names_this_program(folder: str) -> bool:
    """Whether a package that is installed in a folder offers something to this program."""
    try:
        with os.scandir(folder or ".") as inside:
            told = [entry.path for entry in inside if entry.name.endswith(_TOLD)]
    except OSError:
        return False
    for path in told:
        try:
            if _MARK in (Path(path) / "entry_points.txt").read_bytes():
                return True
        except OSError:  # it offers nothing at all
            continue
    return False


_taken: dict[str, dict[str, Any]] = {}


def taken(group: str, take: Callable[[str, Any], T]) -> dict[str, T]:
    """What packages offer in a group, by name, each imported once and passed through `take`.

    What cannot be imported, or what `take` refuses by an `InputError`, is left out with a warning.
    """
    if group not in _taken:
        held: dict[str, Any] = {}
        _taken[group] = held  # first, as modules may ask while they are imported
        for offer in offers(group):
            try:
                require_new(offer, held)
                held[offer.name] = take(offer.name, offer.load())
            except InputError as error:
                offer.refuse(error)
    return _taken[group]


def require_new(offer: Offer, held: dict[str, Any]) -> None:
    """Refuse a name that an offer before has."""
    if offer.name in held:
        raise InputError(offer.described, "a name that another package has", "a name of its own")


@cache
def stamp() -> tuple[str, ...]:
    """What results depend on beside this program: packages that offer something, and their modules.

    Empty where there is none.
    """
    return tuple(sorted({f"{each.package} {each.name} {_digest(each.place)}" for each in _found()}))


def _digest(place: str) -> str:
    """SHA-256 over the file of a module, which is not imported; empty where it is not found."""
    try:
        spec = find_spec(place.partition(":")[0])
    except (Exception, SystemExit):  # whatever the package around it does when it is imported
        return ""
    if spec is None or spec.origin is None or not os.path.isfile(spec.origin):
        return ""
    import hashlib  # which loads a library of ciphers

    return hashlib.sha256(Path(spec.origin).read_bytes()).hexdigest()


def forget() -> None:
    """Look for packages anew, after the path of modules has changed."""
    _found.cache_clear()
    stamp.cache_clear()
    _taken.clear()
