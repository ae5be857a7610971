"""A result on its way from another process of this program: as it is in memory, without a file."""

from __future__ import annotations

import json
from collections.abc import Iterable, Mapping
from typing import TYPE_CHECKING, Any, BinaryIO, cast

import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
    import io

    import xarray


Group = tuple[str, Mapping[Any, Any], Mapping[str, tuple[Any, NDArray[Any], Mapping[Any, Any]]]]
"""Path and attributes of a group, and its variables by name, each with dimensions, values and attributes."""


def send_groups(groups: Iterable[Group], to: BinaryIO) -> None:
    """Send groups of variables: a line that says what is in them, then the bytes of the variables."""
    told: list[dict[str, Any]] = []
    values: list[NDArray[Any]] = []
    for path, attributes, variables in groups:
        held = {name: _plain(array) for name, (_, array, _) in variables.items()}
        values += held.values()
        told.append(
            {
                "path": path,
                "attributes": attributes,
                "variables": [
                    [name, variables[name][0], array.dtype.str, array.shape, variables[name][2]]
                    for name, array in held.items()
                ],
            }
        )
    to.write(json.dumps(told, default=lambda value: value.tolist()).encode() + b"\n")
    for array in values:
        to.write(array.reshape(-1).view(np.uint8).data)
    to.flush()


def receive_result(source: BinaryIO) -> xarray.DataTree | None:
    """Receive what `send_groups` sent; None at the end of all."""
    import xarray

    line, found = source.readline(), {}
    if not line:
        return None
    for group in json.loads(line):
        variables = {
            name: xarray.Variable(dims, _array(source, np.dtype(kind), shape), attributes)
            for name, dims, kind, shape, attributes in group["variables"]
        }
        found[group["path"]] = xarray.Dataset(variables, attrs=group["attributes"])
    return xarray.DataTree.from_dict(found)


def _plain(values: NDArray[Any]) -> NDArray[Any]:
    """In one piece of memory, words in as many letters as the longest has."""
    return np.asarray(values.astype(str) if values.dtype == object else values, order="C")


def _array(source: BinaryIO, kind: np.dtype[Any], shape: list[int]) -> NDArray[Any]:
    array = np.empty(shape, kind)
    memory = array.reshape(-1).view(np.uint8).data
    if cast("io.BufferedIOBase", source).readinto(memory) < memory.nbytes:
        raise ValueError("the stream breaks off")
    return array
