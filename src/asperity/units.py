"""Unit strings, at the door only: everything behind it is SI floats."""

from __future__ import annotations

import math
from functools import lru_cache
from typing import Any

from asperity.errors import InputError


@lru_cache(maxsize=1)
def _registry() -> Any:
    import pint  # 0.2 s to import: only where a unit string is met

    return pint.UnitRegistry()


@lru_cache(maxsize=256)
def factor(unit: str, dimension: str) -> float:
    """SI value of one `unit`.

    Parameters
    ----------
    unit : str
        A unit, as ``"um"``, ``"µm"``, ``"N s/m"``.
    dimension : str
        The SI unit it must be compatible with, as ``"m"``.

    Returns
    -------
    float
        How many `dimension` one `unit` is.

    Raises
    ------
    InputError
        If the unit is unknown or of another dimension.
    """
    import pint

    try:
        return float(_registry().Quantity(1.0, unit.strip()).to(dimension).magnitude)
    except pint.DimensionalityError:
        allowed = f"a unit that converts to {dimension}"
        raise InputError("unit", repr(unit), allowed, f"Write the quantity with such a unit, as in '1 {dimension}'.") from None
    except Exception:  # pint raises errors of many kinds on malformed text
        raise InputError("unit", repr(unit), f"a unit that converts to {dimension}", "Check its spelling.") from None


def quantity(text: str, dimension: str) -> float:
    """SI value of a quantity written with its unit.

    Parameters
    ----------
    text : str
        A number and a unit, as ``"25 mm"``; ``"inf"`` needs no unit.
    dimension : str
        The SI unit it must be compatible with; ``""`` for a pure number.

    Returns
    -------
    float
        The value in `dimension`.

    Raises
    ------
    InputError
        If the text is not a finite (or infinite, written ``inf``) number with a compatible unit.
    """
    number, _, unit = text.strip().partition(" ")
    if not unit:
        digits = len(number.rstrip("abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZµμ°/^²³%"))
        if number.lower().lstrip("+-") not in ("inf", "nan"):
            number, unit = number[:digits], number[digits:]
    allowed = f"a number and a unit of {dimension}, as '1 {dimension}'" if dimension else "a number"
    try:
        value = float(number)
    except ValueError:
        raise InputError("quantity", repr(text), allowed, "Write the number first, then the unit.") from None
    if math.isnan(value):
        raise InputError("quantity", repr(text), allowed, "NaN is not a value; give a number.")
    if not unit:
        if dimension and not math.isinf(value):
            raise InputError("quantity", repr(text), allowed, "Add the unit.")
        return value
    return value * factor(unit, dimension)
