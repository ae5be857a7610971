"""How kernels of the time loops are compiled.

They get named tuples of arrays; counting references to those arrays at every call costs ten times the
arithmetic. Functions that allocate nothing do not need to count (``_nrt``), and inside one compiled loop
nothing is left of the calls (``forceinline``).

Entries take the compiler longer than most kernels: numba makes two, for Python and for C, and unpacks
every array of every named tuple in them. So only what Python calls has one, and none has one for C.

``_nrt``, ``forceinline`` and the options without entries are not documented by numba, ``_cache`` of a kernel
is private. They are tested with numba 0.60 to 0.68: the oldest that is allowed and the newest there is.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from numba import njit
from numba.core.registry import CPUDispatcher

from asperity.kernels.kept import Kept

LOOP: dict[str, Any] = {"cache": True, "_nrt": False}
"""For a loop over time steps, called from Python."""
ENTERED: dict[str, Any] = {**LOOP, "forceinline": True}
"""For what such a loop calls, and Python in every run; it allocates nothing."""
INNER: dict[str, Any] = {**ENTERED, "no_cpython_wrapper": True}
"""For what only kernels call, or rarely Python, for which it is compiled once more."""
CALLED: dict[str, Any] = {**LOOP, "no_cpython_wrapper": True}
"""Likewise, for what takes long to compile or is called in several places: they share one machine code."""
ONCE: dict[str, Any] = {**LOOP, "inline": "always"}
"""For what is called in one place and contains much: it is compiled there, not before and there again."""
REASSOCIATE: dict[str, Any] = {"fastmath": {"reassoc", "contract", "nsz"}}
"""Lets sums over poles be vectorised; NaN stays NaN."""


class _Inner(CPUDispatcher):
    """A kernel without an entry from Python: often this takes the compiler longer than the kernel itself."""

    def __call__(self, *arguments: Any) -> Any:
        """Call it from Python: compiled once more, with an entry."""
        if not hasattr(self, "_entered"):
            options = {k: v for k, v in self.targetoptions.items() if k in ("fastmath", "nogil", "_nrt")}
            self._entered = compiled(**options, cache=True)(self.py_func)
        return self._entered(*arguments)


class _Apart(_Inner):
    """One that is not compiled into those that call it."""

    def add_overload(self, result: Any) -> None:
        """Let callers find it by its name, where numba would hand them a copy to link and optimise again."""
        super().add_overload(result)
        context = result.target_context
        context.remove_user_function(result.entry_point)
        context.insert_user_function(result.entry_point, result.fndesc, ())


def compiled(**options: Any) -> Callable[[Callable[..., Any]], Any]:
    """Compile a kernel as `numba.njit` does; with ``cache`` it is kept until any kernel's source changes."""
    keep = options.pop("cache", False)
    entry = not options.get("no_cpython_wrapper", False)
    inlined = options.get("forceinline", False) or options.get("inline") == "always"
    options["no_cfunc_wrapper"] = True

    def decorate(function: Callable[..., Any]) -> Any:
        kernel = njit(**options)(function)
        if not entry:
            kernel.__class__ = _Inner if inlined else _Apart
        if keep:
            kernel._cache = Kept(function, inlined=inlined, entry=entry)  # what ``cache=True`` would set
        return kernel

    return decorate
