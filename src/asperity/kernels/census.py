"""All kernels that a few entries need, and what share of the compiler's time each takes."""

from __future__ import annotations

import dis
from collections.abc import Iterable
from functools import cache
from typing import Any

from numba.core.registry import CPUDispatcher

from asperity.kernels.kept import Kept, kept_names

INLINED = 0.3
"""Of what a function takes alone, what it takes again in each place where nothing is left of its call."""


class Census:
    """Kernels, by the names under which they are kept, with their instructions: so long each takes."""

    def __init__(self, entries: Iterable[Any]) -> None:
        self.sizes: dict[str, float] = {}
        for entry in entries:
            self._count(entry)

    def _count(self, kernel: Any) -> None:
        if isinstance(kernel._cache, Kept) and kernel._cache.name not in self.sizes:
            if not _is_copied(kernel):
                self.sizes[kernel._cache.name] = instructions(kernel)
            for called in _calls(kernel):
                self._count(called)

    def done(self) -> float:
        """Share of the work that is done: what this process has compiled, and what lies in the folders."""
        there = kept_names()
        return sum(size for name, size in self.sizes.items() if name in there) / sum(self.sizes.values())


@cache
def instructions(kernel: Any) -> float:
    """Instructions of a kernel, with those that the calls in it are replaced by."""
    total = float(sum(1 for _ in dis.get_instructions(kernel.py_func)))
    for called in _calls(kernel):
        if _is_copied(called):
            total += instructions(called)
        elif called.targetoptions.get("forceinline"):
            total += INLINED * instructions(called)
    return total


def _is_copied(kernel: Any) -> bool:
    """Whether callers compile its source as their own."""
    return bool(kernel.targetoptions.get("inline") == "always")


@cache
def _calls(kernel: Any) -> list[Any]:
    """Kernels that a kernel calls, as often as it names them."""
    known = kernel.py_func.__globals__
    named = (i.argval for i in dis.get_instructions(kernel.py_func) if i.opname == "LOAD_GLOBAL")
    return [known[name] for name in named if isinstance(known.get(name), CPUDispatcher)]
