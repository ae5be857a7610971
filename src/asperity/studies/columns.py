"""The table of a study as rows and columns: swept keys as they were typed, numbers, levels in bands."""

from __future__ import annotations

import json
from collections.abc import Sequence
from itertools import product
from typing import Any

import numpy as np
import xarray
from numpy.typing import NDArray

from asperity.reporting.typed import typed_unit, typed_values
from asperity.studies.ensemble import SCATTER

Rows = tuple[list[str], list[list[object]]]
"""Heading, and rows of numbers and words."""


def axes_of(table: xarray.Dataset) -> list[str]:
    """Swept keys that the table still has, and the law."""
    return [name for name in (*json.loads(table.attrs["sweep"]), "law") if name in table.dims]


def columns_of(table: xarray.Dataset, *, bands: bool = True) -> Rows:
    """Heading and rows of a study, one for each member and law; with or without what has bands."""
    axes = axes_of(table)
    heading = [key_title(table[axis]) for axis in axes]
    chosen: list[tuple[list[str], NDArray[Any]]] = []
    for name, others in _in_order(table, axes):
        if len(others) > 1 or (not bands and _has_bands(others)):
            continue
        values = table[name]
        own = [axis for axis in axes if axis in values.dims]
        chosen.append((own, values.transpose(*own, *others).values))
        heading += _titles(table, name, others)
    labels = {axis: typed_values(table[axis]) for axis in axes}
    rows: list[list[object]] = []
    for places in product(*(range(table.sizes[axis]) for axis in axes)):
        here = dict(zip(axes, places, strict=True))
        row: list[object] = [labels[axis][place] for axis, place in here.items()]
        for own, numbers in chosen:
            row += np.atleast_1d(numbers[tuple(here[axis] for axis in own)]).tolist()
        rows.append(row)
    return heading, rows


def _in_order(table: xarray.Dataset, axes: Sequence[str]) -> list[tuple[str, list[str]]]:
    """Quantities, each with its dimensions beside the axes: those with bands last, scatter after its mean."""
    names = [str(name) for name in table.data_vars]
    whole = [name for name in names if not name.endswith(SCATTER)]
    paired = [each for name in whole for each in (name, f"{name}{SCATTER}") if each in names]
    found = [(name, [str(dim) for dim in table[name].dims if dim not in axes]) for name in paired]
    return sorted(found, key=lambda item: _has_bands(item[1]))


def _has_bands(dims: Sequence[str]) -> bool:
    return any(dim.endswith("band") for dim in dims)


def _titles(table: xarray.Dataset, name: str, others: Sequence[str]) -> list[str]:
    own = name.removesuffix(SCATTER)
    shown = own if own == name else f"± {own}"
    units = table[name].attrs["units"]
    if not others:
        return [f"{shown} [{units}]"]
    place = table[others[0]]
    unit = "" if place.attrs["units"] == "1" else str(place.attrs["units"])
    words = [
        each if isinstance(each, str) else f"{each:.6g} {unit}".strip() for each in place.values.tolist()
    ]
    return [f"{shown} {word} [{units}]" for word in words]


def key_title(key: xarray.DataArray) -> str:
    """Heading of an axis, with the unit in which its values were typed."""
    unit = typed_unit(key)
    return f"{key.name} [{unit}]" if unit else str(key.name)


def long_columns(table: xarray.Dataset, axes: Sequence[str]) -> Rows:
    """Heading and rows of what has all these axes, one row for each place on them."""
    held = {
        str(name): values.transpose(*axes)
        for name, values in table.data_vars.items()
        if set(values.dims) == set(axes)
    }
    heading = [key_title(table[axis]) for axis in axes]
    heading += [f"{name} [{values.attrs['units']}]" for name, values in held.items()]
    labels = [typed_values(table[axis]) for axis in axes]
    numbers = [values.values.ravel().tolist() for values in held.values()]
    rows: list[list[object]] = [
        [*place, *found] for place, found in zip(product(*labels), zip(*numbers, strict=True), strict=True)
    ]
    return heading, rows
