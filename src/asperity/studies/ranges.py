"""Ranges of a swept key in words: ``"80..300 km/h, 6 steps"``, ``"60..1900 MN/m, 6 ratios"``, ``"1..20"``."""

from __future__ import annotations

import math
import re
from collections.abc import Iterator
from typing import Any

import numpy as np

from asperity.arguments import shown
from asperity.errors import InputError

_NUMBER = r"[+-]?(?:\d++\.?\d*+|\.\d++)(?:[eE][+-]?\d++)?"
_RANGE = re.compile(
    rf"\s*({_NUMBER})\s*\.\.\s*({_NUMBER})\s*([^\d\s,][^,]{{0,40}})?(?:,\s*(\d{{1,5}})\s*(steps|ratios))?\s*"
)
_BETWEEN = re.compile(r",(?!\s*\d+\s*(?:steps|ratios)\s*(?:,|$))")
"""Commas between the values of a list, but for that before the number of steps."""
MOST_VALUES = 10_000


def separated(values: str) -> list[str]:
    """Values that commas separate, each range one of them."""
    return [each.strip() for each in _BETWEEN.split(values)]


def expanded(what: str, values: object) -> object:
    """The values of a key, each range among them written out; what is neither text nor a list stays.

    From the first to the last value: ``steps`` counts values that are equally far apart, ``ratios`` values of
    which each is as many times the one before. Without them every whole number is a value.
    """
    if isinstance(values, str) and _RANGE.fullmatch(values):
        values = [values]
    if not isinstance(values, list | tuple):
        return values
    return [one for value in values for one in _values(what, value)]


def _values(what: str, value: Any) -> Iterator[Any]:
    match = _RANGE.fullmatch(value) if isinstance(value, str) else None
    if match is None:
        yield value
        return
    low, high, unit = float(match[1]), float(match[2]), (match[3] or "").strip()
    for number in _numbers(what, value, (low, high), match[4], match[5], unit):
        bare = int(number) if number == int(number) else number
        yield f"{bare} {unit}" if unit else bare


def _numbers(
    what: str, value: str, ends: tuple[float, float], count: str | None, way: str | None, unit: str
) -> list[float]:
    low, high = ends
    if not math.isfinite(high - low):
        raise InputError(what, shown(value), "ends that a computer can hold")
    if count is None:
        if unit or low != int(low) or high != int(high) or not low < high < low + MOST_VALUES:
            remedy = f"Say how many, as '{value.strip()}, 6 steps', or 6 ratios."
            raise InputError(what, shown(value), "a range with its number of values", remedy)
        return np.arange(low, high + 1.0).tolist()
    if not 2 <= int(count) <= MOST_VALUES or low == high:
        remedy = "Both ends count: the least is 2 steps."
        raise InputError(what, shown(value), f"two different ends and 2 to {MOST_VALUES} values", remedy)
    if way == "steps":
        found = np.linspace(low, high, int(count))
    elif low * high > 0.0:
        found = np.geomspace(low, high, int(count))
    else:
        raise InputError(what, shown(value), "ends above zero for equal ratios", "Write steps instead.")
    return [float(f"{number:.10g}") for number in found]
