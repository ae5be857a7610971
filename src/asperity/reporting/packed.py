"""Arrays in little room, for a browser to unpack: each once, in steps, in levels, or in single precision."""

from __future__ import annotations

import base64
import zlib
from typing import Any

import numpy as np

from asperity.reporting.chart import Numbers

LONG = 1000
"""Numbers from which an array is kept in levels."""
LEVELS = 2**14 - 2
"""Steps between the lowest and the highest number of such an array: finer than any screen."""


class Arrays:
    """Arrays in one run of bytes."""

    def __init__(self) -> None:
        self.told: list[dict[str, Any]] = []
        """How each is kept: ``start`` and ``step``, ``low`` and ``size`` of levels, or neither."""
        self._bytes: list[bytes] = []
        self._known: dict[tuple[bytes, bool, int], int] = {}

    def place(self, numbers: Numbers, linear: bool, levels: int = LEVELS) -> int:
        """Number under which an array is kept; one that is drawn on a `linear` axis may be rounded."""
        flat = np.ascontiguousarray(numbers, dtype=np.float64).ravel()
        key = (flat.tobytes(), linear, levels)
        if key not in self._known:
            self._known[key] = len(self.told)
            how, kept = _kept(flat, linear, levels)
            self.told.append({"count": flat.size, **how})
            self._bytes.append(kept)
        return self._known[key]

    @property
    def packed(self) -> str:
        """All of them: Base64 of zlib."""
        return base64.b64encode(zlib.compress(b"".join(self._bytes), 6)).decode("ascii")


def _kept(numbers: Numbers, linear: bool, levels: int) -> tuple[dict[str, float], bytes]:
    """How an array is kept, and its bytes."""
    if (steps := _steps(numbers)) is not None:
        return steps, b""
    finite = numbers[np.isfinite(numbers)]
    if linear and numbers.size > LONG and finite.size and not np.isinf(numbers).any():
        low, size = float(finite.min()), float(np.ptp(finite)) / levels
        return {"low": low, "size": size}, _levels((numbers - low) / (size or 1.0))
    with np.errstate(over="ignore"):
        single = numbers.astype("<f4")
    return {}, _planes(single)


def _steps(numbers: Numbers) -> dict[str, float] | None:
    """Start and step of numbers that are equally spaced."""
    if numbers.size < 3 or not np.isfinite(numbers).all():
        return None
    start, step = float(numbers[0]), float(numbers[-1] - numbers[0]) / (numbers.size - 1)
    off = np.abs(start + step * np.arange(numbers.size) - numbers).max()
    return {"start": start, "step": step} if off <= 1e-6 * abs(step) else None


def _levels(heights: Numbers) -> bytes:
    """Second differences of levels, modulo 2¹⁶; level 0 is a missing number, 1 the lowest."""
    levels = np.nan_to_num(np.rint(heights) + 1.0, nan=0.0).astype(np.int64)
    changes = np.diff(np.diff(levels, prepend=0), prepend=0)
    return _planes((changes & 0xFFFF).astype("<u2"))


def _planes(numbers: np.ndarray) -> bytes:
    """First bytes of all numbers, then their second ones, and so on: alike ones pack better."""
    return numbers.view(np.uint8).reshape(numbers.size, -1).T.tobytes()
