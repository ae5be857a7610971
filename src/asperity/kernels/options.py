"""How kernels of the time loops are compiled.

They get named tuples of arrays; counting references to those arrays at every call costs ten times the
arithmetic. Functions that allocate nothing do not need to count (``_nrt``), and inside one compiled loop
nothing is left of the calls (``forceinline``).
"""

from __future__ import annotations

import hashlib
from collections.abc import Callable
from pathlib import Path
from typing import Any

from numba import njit

LOOP: dict[str, Any] = {"cache": True, "_nrt": False}
"""For a loop over time steps, called from Python."""
INNER: dict[str, Any] = {**LOOP, "forceinline": True}
"""For what such a loop calls; it allocates nothing."""
ONCE: dict[str, Any] = {**LOOP, "inline": "always"}
"""For what is called in one place and contains much: it is compiled there, not before and there again."""
REASSOCIATE: dict[str, Any] = {"fastmath": {"reassoc", "contract", "nsz"}}
"""Lets sums over poles be vectorised; NaN stays NaN."""


def _stamp() -> bytes:
    digest = hashlib.sha256()
    for source in sorted(Path(__file__).parent.glob("*.py")):
        digest.update(source.read_bytes())
    return digest.digest()


SOURCES = _stamp()
"""What all kernels are made of."""


def compiled(**options: Any) -> Callable[[Callable[..., Any]], Any]:
    """Compile a kernel with numba, and keep it until the source of any kernel changes.

    Parameters
    ----------
    **options
        As of `numba.njit`.

    Returns
    -------
    callable
        Decorator.

    Notes
    -----
    Numba looks at a function's own file alone. A kernel kept from before a change of another one that it
    calls, as by a new version of the package, would write where that one no longer expects it.
    """

    def decorate(function: Callable[..., Any]) -> Any:
        kernel = njit(**options)(function)
        if options.get("cache"):
            kernel._cache._cache_file._source_stamp = SOURCES
        return kernel

    return decorate
