"""What roughness does when things roll: rough 3-D contact, reduced, rolled and heard."""

from __future__ import annotations

import importlib
from typing import Any

__version__ = "0.1.0"

_HOME = {
    "Contact": "contact.halfspace",
    "HalfSpace": "contact.halfspace",
    "HeightMap": "surfaces.heightmap",
    "Profile": "surfaces.heightmap",
    "Track": "structures.track",
    "read_surface": "surfaces.readers",
    "scan": "reduction.scan",
    "run": "running",
    "load": "results",
    "study": "studies.running",
}

__all__ = [
    "Contact",
    "HalfSpace",
    "HeightMap",
    "Profile",
    "Track",
    "__version__",
    "load",
    "read_surface",
    "run",
    "scan",
    "study",
]


def __getattr__(name: str) -> Any:
    """Import a public name on first use, so that ``import asperity`` stays fast."""
    if name not in _HOME:
        raise AttributeError(f"module 'asperity' has no attribute {name!r}")
    return getattr(importlib.import_module(f"asperity.{_HOME[name]}"), name)


def __dir__() -> list[str]:
    return sorted(__all__)
