"""What roughness does when things roll: rough 3-D contact, reduced, rolled and heard."""

from __future__ import annotations

import importlib
from typing import Any

__version__ = "0.1.0"

_HOME = {
    "Ball": "structures.ball",
    "Beam": "structures.beam",
    "Contact": "contact.halfspace",
    "HalfSpace": "contact.halfspace",
    "HeightMap": "surfaces.heightmap",
    "Hertz": "contact.hertz",
    "Material": "reference.materials",
    "Profile": "surfaces.heightmap",
    "Track": "structures.track",
    "Wheel": "structures.wheel",
    "laws": "laws",
    "material": "reference.materials",
    "open_result": "running",
    "read_surface": "surfaces.readers",
    "report": "kinds.report",
    "run": "running",
    "save": "results",
    "study": "studies.running",
}
"""Module of each public name; the cases of each kind come beside them."""


def _cases() -> dict[str, str]:
    """Classes of cases, by the words of their kinds joined: each in the module ``case`` of its kind."""
    kinds = importlib.import_module("asperity.kinds").KINDS
    return {name.title().replace("-", ""): f"{kind.folder}.case" for name, kind in kinds.items()}


def __getattr__(name: str) -> Any:
    """Import a public name on first use, so that ``import asperity`` stays fast."""
    if name == "__all__":
        return ["__version__", *_HOME, *_cases()]
    home = (
        f"asperity.{_HOME[name]}" if name in _HOME else None if name.startswith("_") else _cases().get(name)
    )
    if home is None:
        raise AttributeError(f"module 'asperity' has no attribute {name!r}")
    module = importlib.import_module(home)
    return module if home == f"asperity.{name}" else getattr(module, name)


def __dir__() -> list[str]:
    return sorted(["__version__", *_HOME, *_cases()])
