"""Rolling in time: structures coupled through a contact law."""

import importlib
from typing import Any

_HOME = {
    "BearingRings": "bearing",
    "RolledBearing": "bearing",
    "RolledBodies": "roll",
    "roll_bearing": "bearing",
    "roll_bodies": "roll",
}
"""Module of each public name."""


def __getattr__(name: str) -> Any:
    """Import a public name on first use, as it brings compiled code."""
    if name == "__all__":
        return list(_HOME)
    if name not in _HOME:
        raise AttributeError(f"module 'asperity.rolling' has no attribute {name!r}")
    return getattr(importlib.import_module(f"asperity.rolling.{_HOME[name]}"), name)


def __dir__() -> list[str]:
    return sorted(_HOME)
