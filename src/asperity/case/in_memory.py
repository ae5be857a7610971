"""What Python may hand over where a case file names a file: which it is, and what it is called."""

import hashlib
import json
from collections.abc import Mapping
from pathlib import Path
from typing import Any, Protocol, runtime_checkable

import numpy as np

from asperity.surfaces.heightmap import HeightMap, Profile
from asperity.units import written


@runtime_checkable
class Numbers(Protocol):
    """Any other object that stands for a file: a structure by its modes, for instance."""

    def numbers(self) -> dict[str, Any]:
        """All arrays that it is made of, by name."""
        ...


PLAIN = (str, float, int, type(None))
"""What a value mostly is: asked first, as it takes long to see that something is no `Numbers`."""
InMemory = HeightMap | Profile | np.ndarray | Numbers
"""What Python may hand over where a case file names a file."""


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


def holds_memory(value: Any) -> bool:
    """Whether there is something in a value that no case file can hold."""
    if isinstance(value, PLAIN):
        return False
    if isinstance(value, Mapping):
        return any(map(holds_memory, value.values()))
    return any(map(holds_memory, value)) if isinstance(value, list | tuple) else isinstance(value, InMemory)


def name_of(value: Path | InMemory | tuple[InMemory, ...]) -> str:
    """Name of what was measured, for messages and records."""
    if isinstance(value, Path):
        return value.name
    if isinstance(value, tuple):
        return ", ".join(dict.fromkeys(map(name_of, value)))
    return getattr(value, "source", "") or described_value(value).partition(", ")[0]


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
