"""Continuation of a record that is shorter than the run: refused, mirrored or repeated."""

from __future__ import annotations

from typing import Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

from asperity.errors import InputError

Continuation = Literal["refuse", "mirror", "repeat"]

CHOICES = ("refuse", "mirror", "repeat")


def extend(
    heights: ArrayLike,
    rows: int,
    how: Continuation = "refuse",
    *,
    spacing: float,
    start: int = 0,
    crossfade: int = 0,
    what: str = "record",
) -> NDArray[np.float64]:
    """Heights (rows,) or (rows, k), m, along a path of any length from a record (n,) or (n, k).

    The record is complete. One that is too short is refused, mirrored, that is run through to and fro (no
    step, a kink where it turns), or repeated with period n, as the circumference of a wheel; then it is
    closed over the points `crossfade`, see `close`. `start` is the point that comes first, negative only if
    it is mirrored or repeated. `what` names the record in messages.
    """
    values = np.asarray(heights, dtype=np.float64)
    n = len(values)
    if how not in CHOICES:
        raise InputError(f"continuation of the {what}", repr(how), "one of " + ", ".join(CHOICES))
    if not np.isfinite(values).all():
        raise InputError(what, "missing points", "complete heights", "Fill or trim it first.")
    index = np.arange(start, start + rows)
    if how == "repeat":
        return close(values, crossfade)[np.mod(index, n)]
    if how == "mirror":
        folded = np.mod(index, 2 * (n - 1))
        return np.asarray(values[np.where(folded < n, folded, 2 * (n - 1) - folded)])
    if start < 0 or start + rows > n:
        received = f"{n * spacing:.4g} m"
        allowed = f"at least the run with its margins, {rows * spacing:.4g} m"
        if start:
            allowed += f", from {start * spacing:.4g} m on"
        remedy = "Set surface.continuation to 'mirror' or 'repeat', or shorten the run."
        raise InputError(f"length of the {what}", received, allowed, remedy)
    return np.asarray(values[start : start + rows])


def close(heights: ArrayLike, points: int) -> NDArray[np.float64]:
    """Close a periodic record: spread the step between its end and its start over both sides of the join.

    Heights (n,) or (n, k), m; half the step is taken from that many points on either side, fading with a
    raised cosine.
    """
    values = np.array(heights, dtype=np.float64)
    if not 0 <= 2 * points <= len(values):
        raise InputError("crossfade", f"{points} points", f"0 to {len(values) // 2}, half the record")
    if points == 0:
        return values
    fade = 0.5 + 0.5 * np.cos(np.pi * np.arange(points) / points)
    share = np.multiply.outer(fade, 0.5 * (values[0] - values[-1]))
    values[:points] -= share
    values[-points:] += share[::-1]
    return values
