"""A result on its way to another process of this program: as it is in memory, without a file."""

from __future__ import annotations

import json
import math
from typing import TYPE_CHECKING, Any, BinaryIO

import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
    import xarray


def send_result(tree: xarray.DataTree, to: BinaryIO) -> None:
    """Send a result: a line that says what is in it, then the bytes of its variables."""
    groups: list[dict[str, Any]] = []
    values: list[NDArray[Any]] = []
    for node in tree.subtree:
        found = node.to_dataset(inherit=False)
        held = {name: _plain(variable.values) for name, variable in found.variables.items()}
        values += held.values()
        groups.append(
            {
                "path": node.path,
                "attributes": node.attrs,
                "variables": [
                    [name, found[name].dims, array.dtype.str, array.shape, found[name].attrs]
                    for name, array in held.items()
                ],
                "coordinates": list(found.coords),
            }
        )
    to.write(json.dumps(groups, default=lambda value: value.tolist()).encode() + b"\n")
    for array in values:
        to.write(array.reshape(-1).view(np.uint8).data)
    to.flush()


def receive_result(source: BinaryIO) -> xarray.DataTree | None:
    """Receive what `send_result` sent; None at the end of all."""
    import xarray

    line, found = source.readline(), {}
    if not line:
        return None
    for group in json.loads(line):
        variables = {
            name: xarray.Variable(dims, _array(source, np.dtype(kind), shape), attributes)
            for name, dims, kind, shape, attributes in group["variables"]
        }
        data = xarray.Dataset(variables, attrs=group["attributes"])
        found[group["path"]] = data.set_coords(group["coordinates"])
    return xarray.DataTree.from_dict(found)


def _plain(values: NDArray[Any]) -> NDArray[Any]:
    """In one piece of memory, words in as many letters as the longest has."""
    return np.asarray(values.astype(str) if values.dtype == object else values, order="C")


def _array(source: BinaryIO, kind: np.dtype[Any], shape: list[int]) -> NDArray[Any]:
    return np.frombuffer(source.read(math.prod(shape) * kind.itemsize), kind).reshape(shape)
