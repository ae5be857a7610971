"""How kernels of the time loops are compiled.

They get named tuples of arrays; counting references to those arrays at every call costs ten times the
arithmetic. Functions that allocate nothing do not need to count (``_nrt``), and inside one compiled loop
nothing is left of the calls (``forceinline``).

``_nrt`` and ``forceinline`` are options that numba does not document, and ``_cache`` of a kernel is private.
They are tested with numba 0.60 to 0.68: the oldest that is allowed and the newest there is.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from numba import njit

from asperity.kernels.kept import Kept

LOOP: dict[str, Any] = {"cache": True, "_nrt": False}
"""For a loop over time steps, called from Python."""
INNER: dict[str, Any] = {**LOOP, "forceinline": True}
"""For what such a loop calls; it allocates nothing."""
ONCE: dict[str, Any] = {**LOOP, "inline": "always"}
"""For what is called in one place and contains much: it is compiled there, not before and there again."""
REASSOCIATE: dict[str, Any] = {"fastmath": {"reassoc", "contract", "nsz"}}
"""Lets sums over poles be vectorised; NaN stays NaN."""


def compiled(**options: Any) -> Callable[[Callable[..., Any]], Any]:
    """Compile a kernel as `numba.njit` does; with ``cache`` it is kept until any kernel's source changes."""
    keep = options.pop("cache", False)

    def decorate(function: Callable[..., Any]) -> Any:
        kernel = njit(**options)(function)
        if keep:
            inlined = options.get("forceinline", False) or options.get("inline") == "always"
            kernel._cache = Kept(function, inlined=inlined)  # what ``cache=True`` of numba would set
        return kernel

    return decorate


def is_kept(kernel: Any) -> bool:
    """Whether the machine code of a kernel is on disk, for any signature; False if it is not to be kept."""
    return isinstance(kernel._cache, Kept) and kernel._cache.is_kept()
