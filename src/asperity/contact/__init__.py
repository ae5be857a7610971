"""Three-dimensional contact: the half-space solver and Hertz's closed forms."""

import importlib
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from asperity.contact.halfspace import Contact, HalfSpace
    from asperity.contact.hertz import Hertz

__all__ = ["Contact", "HalfSpace", "Hertz"]


def __getattr__(name: str) -> Any:
    """Import on first use: closed forms need no compiled solver."""
    if name not in __all__:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return getattr(importlib.import_module(f"{__name__}.{'hertz' if name == 'Hertz' else 'halfspace'}"), name)
