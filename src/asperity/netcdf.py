"""NetCDF-4 files as they lie in HDF5: groups, variables, and dimensions as scales, each with a number."""

from __future__ import annotations

from collections.abc import Mapping
from contextlib import suppress
from typing import IO, TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    import h5py
    import xarray

NO_VARIABLE = "This is a netCDF dimension but not a netCDF variable."
"""How the name of a scale that is a dimension alone begins, as the format words it; its size follows."""
LAYOUT = frozenset(
    {"CLASS", "NAME", "DIMENSION_LIST", "REFERENCE_LIST"}
    | {"_Netcdf4Dimid", "_Netcdf4Coordinates", "_NCProperties", "_nc3_strict"}
)
"""Attributes by which the format is laid out in HDF5, which say nothing of what is in a file."""
WHOLE_CHUNK = 2**20
"""Bytes up to which a variable is one chunk."""
PACKED = {"compression": "gzip", "compression_opts": 1, "shuffle": True, "fletcher32": True}
"""How numbers are written: compressed, and with a checksum."""


def write_netcdf(tree: xarray.DataTree, file: IO[bytes]) -> None:
    """Write a tree of groups to an empty file; each group defines its own dimensions.

    The layout is that of the netCDF-4 format specification (Unidata, "NetCDF-4 on top of HDF5"). xarray
    encodes values; h5py writes them, as the netCDF engines of xarray look each group up again for every
    attribute (``benchmarks/whole_runs.py`` times it).

    Parameters
    ----------
    tree : xarray.DataTree
        Groups of variables, whose attributes are text and numbers.
    file : binary file
        Where it is written.
    """
    import h5py

    with h5py.File(file, "w", track_order=True) as root:
        root.attrs["_NCProperties"] = np.bytes_(f"version=2,h5py={h5py.__version__}")
        numbers: dict[str, int] = {}  # of dimensions, by their paths
        for node in tree.subtree:
            group = root if node.path == "/" else root.create_group(node.path, track_order=True)
            _write_group(group, node.to_dataset(inherit=False), numbers)


def _write_group(group: h5py.Group, dataset: xarray.Dataset, numbers: dict[str, int]) -> None:
    from xarray.conventions import cf_encoder, encode_dataset_coordinates

    variables, attributes = cf_encoder(*encode_dataset_coordinates(dataset))
    _describe(group, attributes)
    sizes = {str(name): size for name, size in dataset.sizes.items()}
    numbers |= {f"{group.name}/{name}": len(numbers) + i for i, name in enumerate(sizes)}
    written = {str(name): _write_variable(group, str(name), held) for name, held in variables.items()}
    for name, size in sizes.items():
        scale = written.get(name)
        if scale is None:
            scale = group.create_dataset(name, (size,), ">f4", track_order=True)
            scale.make_scale(f"{NO_VARIABLE} {size:10d}")
        else:
            scale.make_scale(name)
        scale.attrs["_Netcdf4Dimid"] = np.int32(numbers[f"{group.name}/{name}"])
    for name, variable in written.items():
        dimensions = [str(each) for each in variables[name].dims]
        if dimensions != [name]:
            for axis, each in enumerate(dimensions):
                variable.dims[axis].attach_scale(group[each])
        if dimensions:
            ids = [numbers[f"{group.name}/{each}"] for each in dimensions]
            variable.attrs["_Netcdf4Coordinates"] = np.array(ids, np.int32)


def _write_variable(group: h5py.Group, name: str, variable: xarray.Variable) -> h5py.Dataset:
    import h5py

    values = np.asarray(variable.values)
    how: dict[str, Any] = {"track_order": True}
    if values.dtype.kind in "OU":
        values = values.astype(object)
        how["dtype"] = h5py.string_dtype()
    elif values.size and values.ndim:
        how |= PACKED | {"chunks": values.shape if values.nbytes <= WHOLE_CHUNK else True}
    if "_FillValue" in variable.attrs:
        how["fillvalue"] = variable.attrs["_FillValue"]
    written = group.create_dataset(name, data=values, **how)
    _describe(written, variable.attrs)
    return written


def _describe(of: h5py.Group | h5py.Dataset, attributes: Mapping[Any, Any]) -> None:
    for name, value in attributes.items():
        of.attrs[str(name)] = value if isinstance(value, str) else np.atleast_1d(value)


def held_in(group: h5py.Group) -> tuple[dict[str, h5py.Dataset], list[h5py.Group]]:
    """The variables of a group by name, all of its datasets but dimensions alone, and its groups."""
    import h5py

    held = dict(group.items())
    datasets = {name: each for name, each in held.items() if isinstance(each, h5py.Dataset)}
    variables = {name: each for name, each in datasets.items() if not _is_dimension_alone(each)}
    return variables, [each for each in held.values() if isinstance(each, h5py.Group)]


def _is_dimension_alone(dataset: h5py.Dataset) -> bool:
    import h5py

    return dataset.is_scale and h5py.h5ds.get_scale_name(dataset.id).startswith(NO_VARIABLE.encode())


def dimensions_of(variable: h5py.Dataset) -> tuple[str, ...]:
    """Names of the dimensions of a variable: those of the scales attached to its axes, or its own."""
    if variable.ndim == 1 and variable.is_scale:
        return (_name_of(variable.id),)
    return tuple(_scale_of(variable, axis) for axis in range(variable.ndim))


def _scale_of(variable: h5py.Dataset, axis: int) -> str:
    """Name of the last scale of an axis: each question to HDF5 reads the scales of all axes."""
    import h5py

    scales: list[h5py.h5d.DatasetID] = []
    with suppress(RuntimeError):  # no axis has one
        h5py.h5ds.iterate(variable.id, axis, scales.append, 0)
    if not scales:
        raise ValueError(f"a variable without dimensions, {_name_of(variable.id)}")
    return _name_of(scales[-1])


def _name_of(dataset: h5py.h5d.DatasetID) -> str:
    import h5py

    return str(h5py.h5i.get_name(dataset).decode().rpartition("/")[2])


def attributes_in(of: h5py.Group | h5py.Dataset) -> dict[str, Any]:
    """What a group or a variable says of itself: text, numbers, and arrays of more than one."""
    import h5py

    found = {}
    for name in of.attrs:
        if name in LAYOUT:
            continue
        value = of.attrs[name]
        if isinstance(value, h5py.Empty):
            value = "" if value.dtype.kind in "SO" else np.zeros(0, value.dtype)
        elif isinstance(value, bytes):
            value = value.decode()
        elif isinstance(value, np.ndarray) and value.shape == (1,):
            value = value[0]
        found[name] = value
    return found


def values_in(variable: h5py.Dataset) -> np.ndarray[Any, Any]:
    """Values of a variable, words as such."""
    import h5py

    words = h5py.check_string_dtype(variable.dtype) is not None
    return np.asarray(variable.asstr()[...] if words else variable[...])
