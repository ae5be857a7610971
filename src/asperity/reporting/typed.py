"""Swept keys of a study in the units in which they were typed; its data are in SI."""

from __future__ import annotations

from typing import Any

from xarray import DataArray

TYPED_UNIT = "typed_unit"
"""Attribute of a coordinate: the unit in which the values of a swept key were written, where it is no SI."""
TYPED_FACTOR = "typed_factor"
"""The same unit in SI."""


def typed_unit(key: DataArray) -> str:
    """Unit of a swept key as it was typed; empty for words."""
    return "" if key.dtype.kind == "U" else str(key.attrs.get(TYPED_UNIT, key.attrs["units"]))


def typed_values(key: DataArray) -> list[Any]:
    """Values of a swept key in the unit in which they were typed."""
    size = float(key.attrs.get(TYPED_FACTOR, 1.0))
    values = key.values.tolist()
    if key.dtype.kind == "U" or size == 1.0:
        return list(values)
    return [float(f"{value / size:.12g}") for value in values]


def typed_words(key: DataArray) -> list[str]:
    """Values of a swept key in words, each with its unit: ``"50 km/h"``."""
    unit = typed_unit(key).removesuffix("1")
    return [value if isinstance(value, str) else f"{value:.6g} {unit}".strip() for value in typed_values(key)]
