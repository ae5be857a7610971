"""How kernels of the time loops are compiled.

They get named tuples of arrays; counting references to those arrays at every call costs ten times the
arithmetic. Functions that allocate nothing do not need to count (``_nrt``), and inside one compiled loop
nothing is left of the calls (``forceinline``).
"""

from __future__ import annotations

from typing import Any

LOOP: dict[str, Any] = {"cache": True, "_nrt": False}
"""For a loop over time steps, called from Python."""
INNER: dict[str, Any] = {**LOOP, "forceinline": True, "cache": False}
"""For what such a loop calls, and is kept with; it allocates nothing."""
ONCE: dict[str, Any] = {**LOOP, "inline": "always"}
"""For what is called in one place and contains much: it is compiled there, not before and there again."""
REASSOCIATE: dict[str, Any] = {"fastmath": {"reassoc", "contract", "nsz"}}
"""Lets sums over poles be vectorised; NaN stays NaN."""
