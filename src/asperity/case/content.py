"""What a value of a case says, whatever object it is: to compare cases, to name results, to tell people."""

import hashlib
import json
from collections.abc import Callable, Mapping
from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING, Any, ClassVar, Protocol, runtime_checkable

import numpy as np

from asperity import __version__
from asperity.reference.materials import Material
from asperity.store import content_key
from asperity.surfaces.heightmap import HeightMap, Profile
from asperity.units import written

if TYPE_CHECKING:
    from asperity.parameters import Key


class Keyed:
    """What has keys, and sections of further ones, by name: each value is an attribute."""

    keys: ClassVar["dict[str, Key]"] = {}
    inner: ClassVar[dict[str, Any]] = {}

    @property
    def section_names(self) -> tuple[str, ...]:
        """Sections that matter; what is repeated with numbers, as ``fault[2]``."""
        return (*self.inner, *(name for name in vars(self) if name.endswith("]")))


@runtime_checkable
class Numbers(Protocol):
    """Any other object that stands for a file: a structure by its modes, for instance."""

    def numbers(self) -> dict[str, Any]:
        """All arrays that it is made of, by name."""
        ...


InMemory = HeightMap | Profile | np.ndarray | Numbers
"""What Python may hand over where a case file names a file."""


def content(value: Any, of_file: Callable[[Path], str] = str) -> Any:
    """Plain numbers, words, lists and dicts that are the same for values that mean the same.

    `of_file` says what stands for a file: its path, or a digest of what it holds.
    """
    if isinstance(value, Keyed):
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


def digest(value: InMemory) -> str:
    """SHA-256 over shape, spacing and numbers."""
    if isinstance(value, Numbers):
        held = [[name, digest(np.asarray(each))] for name, each in value.numbers().items()]
        return hashlib.sha256(json.dumps(held).encode()).hexdigest()
    numbers = np.ascontiguousarray(value if isinstance(value, np.ndarray) else value.heights)
    spacing: Any = None if isinstance(value, np.ndarray) else value.spacing
    if isinstance(value, Profile) and value.start is not None:
        spacing = spacing, value.start
    found = hashlib.sha256(f"{numbers.dtype.str} {numbers.shape} {spacing}".encode())
    found.update(numbers.data)
    return found.hexdigest()


def file_digest(path: Path) -> str:
    """SHA-256 over what a file holds."""
    with open(path, "rb") as file:
        return hashlib.file_digest(file, "sha256").hexdigest()


def case_key(
    name: str, version: int, case: Keyed, *more: object, of_file: Callable[[Path], str] = file_digest
) -> str:
    """Name of what is kept of a case, as `content_key`: by its keys, its files, and what else is told.

    Beside them by the version of what is kept, and of the program.
    """
    told = json.dumps(content(case, of_file), sort_keys=True)
    return content_key(name, version, __version__, told, *more)


def holds_memory(value: Any) -> bool:
    """Whether there is something in a value that no case file can hold."""
    if isinstance(value, Mapping):
        return any(map(holds_memory, value.values()))
    return any(map(holds_memory, value)) if isinstance(value, list | tuple) else isinstance(value, InMemory)


def name_of(value: Path | InMemory | tuple[InMemory, ...]) -> str:
    """Name of what was measured, for messages and records."""
    if isinstance(value, Path):
        return value.name
    if isinstance(value, tuple):
        return ", ".join(dict.fromkeys(map(name_of, value)))
    if isinstance(value, np.ndarray):
        return "a table in memory"
    if isinstance(value, Numbers):
        return f"a {type(value).__name__} in memory"
    return value.source or f"a {'height map' if isinstance(value, HeightMap) else 'profile'} in memory"


def described_value(value: object) -> str:
    """Say what stands in memory: what it is, how large, and the start of its digest."""
    if isinstance(value, list | tuple):
        return "; ".join(map(described_value, value))
    if isinstance(value, np.ndarray):
        what = f"table of {' × '.join(map(str, value.shape))} numbers"
    elif isinstance(value, HeightMap):
        dx, dy = (written(each, "m", "um") for each in value.spacing)
        what = f"height map of {value.shape[0]} × {value.shape[1]} points, {dx} × {dy} apart"
    elif isinstance(value, Profile):
        what = f"profile of {value.shape[0]} points, {written(value.spacing, 'm', 'um')} apart"
    elif isinstance(value, Numbers):
        what = f"{type(value).__name__} of {sum(map(np.size, value.numbers().values()))} numbers"
    else:
        return str(value)
    return f"{what}, in memory, sha256 {digest(value)[:16]}"
