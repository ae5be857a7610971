"""One netCDF-4 file per run: groups with units, long names and provenance."""

from __future__ import annotations

import io
from collections.abc import Sequence
from numbers import Integral
from pathlib import Path
from typing import TYPE_CHECKING, Any

from asperity.arguments import ArrayLike, FilePath, NDArray, file_path, no_file, shown
from asperity.errors import InputError, reason
from asperity.files import is_sealed, write_bytes
from asperity.hdf5 import MOST_UNPACKED, SIGNATURE, most_unpacked, opened_hdf5, size_unpacked
from asperity.netcdf import (
    attributes_in,
    dimensions_of,
    held_in,
    values_in,
    write_netcdf,
)
from asperity.sandbox import Answer, sandboxed
from asperity.schema import VERSION, VIEW_OF, bearing, provenance

if TYPE_CHECKING:
    import xarray

GROUPS = ("scenario", "contact", "rolling", "spectra")
LARGEST_FILE = 16 * 2**30  # bytes
_ALLOWED = "a result file that a run has written (run.nc)"
_AGAIN = "Run its case again."


def variable(
    dims: str | Sequence[str], values: ArrayLike, units: str, long_name: str, **attrs: Any
) -> xarray.Variable:
    """Make a variable of a result, with its attributes.

    Units are in SI, ``"1"`` for a pure number, ``"dB re 1 N"`` for a level; `long_name` says what it is, in
    the words that a figure's axis carries.
    """
    import xarray

    return xarray.Variable(dims, values, {"units": units, "long_name": long_name, **attrs})


def save(tree: xarray.DataTree, path: FilePath) -> Path:
    """Write a result to one netCDF-4 file, completely or not at all.

    Parameters
    ----------
    tree : xarray.DataTree
        The result; every variable with units and a long name.
    path : path
        The file.

    Returns
    -------
    Path
        The file written.

    Examples
    --------
    >>> import asperity
    >>> asperity.save(asperity.run(case), "runs/first/run.nc").name
    'run.nc'
    """
    nodes = {node.path: node.to_dataset(inherit=False).variables for node in tree.subtree}
    all_of = [(f"{path}/{name}", values) for path, held in nodes.items() for name, values in held.items()]
    bare = [path for path, values in all_of if not {"units", "long_name"} <= values.attrs.keys()]
    if bare:  # a fault of the program
        raise ValueError(f"results without units or long_name: {', '.join(bare)}".replace("//", "/"))
    image = io.BytesIO()  # HDF5 itself ends the process where a disk is full
    write_netcdf(_storable(tree), image)
    return write_bytes(path, image.getbuffer(), sealed=True)


def _storable(tree: xarray.DataTree) -> xarray.DataTree:
    """Leave views out, and spell out what UTF-8 does not have, as bytes in names of files, in words."""
    tree = tree.copy()
    for node in tree.subtree:
        views = [name for name, values in node.data_vars.items() if VIEW_OF in values.attrs]
        node.dataset = node.to_dataset(inherit=False).drop_vars(views)
        words = {name: value for name, value in node.attrs.items() if isinstance(value, str)}
        spelled = {name: word.encode(errors="backslashreplace").decode() for name, word in words.items()}
        node.attrs = node.attrs | spelled
    return tree


def read_result(path: FilePath) -> xarray.DataTree:
    """Read a result that a run has written, a ``run.nc`` or the folder of one, to memory."""
    path = file_path("result", path, "the path of a run.nc, or of the folder that holds one")
    if no_file(path) == "a folder":
        path = path / "run.nc"
    tree = _decoded(path, _opened_apart(path))
    if provenance.ASPERITY_VERSION.name not in tree.attrs or not set(GROUPS) <= set(tree.children):
        raise InputError(str(path), "a netCDF-4 file of another kind", _ALLOWED)
    _check_version(path, tree)
    return tree


def _opened_apart(path: Path, *, whole: bool = True) -> xarray.DataTree:
    """Open a result in a process of its own: HDF5 may hang in a file, or end, whatever its digest says."""
    import xarray

    if received := no_file(path):
        raise InputError(str(path), received, _ALLOWED, "Check the path.")
    size = path.stat().st_size
    if size > LARGEST_FILE:
        raise InputError(str(path), f"{size / 2**30:.0f} GiB", f"{_ALLOWED} of at most 16 GiB")
    with open(path, "rb") as file:
        signature = file.read(8)
        intact = is_sealed(file)
    if signature != SIGNATURE:
        raise InputError(str(path), "a file that is not netCDF-4", _ALLOWED)
    if intact is False:
        received = "a damaged file: its digest does not fit its contents"
        raise InputError(str(path), received, _ALLOWED, _AGAIN)
    groups, arrays = sandboxed(
        groups_of_netcdf, path, [whole], source=str(path), kind="netCDF-4", packages=["h5py"]
    )
    numbers = iter(arrays)
    found = {}
    for name, attributes, variables in groups:
        held = {each: xarray.Variable(dims, next(numbers), told) for each, dims, told in variables}
        found[name] = xarray.Dataset(held, attrs=attributes)
    return xarray.DataTree.from_dict(found)


def _decoded(path: Path, tree: xarray.DataTree) -> xarray.DataTree:
    """The groups of a file as they were before they were laid out for netCDF."""
    import xarray

    try:
        found = {node.path: xarray.decode_cf(node.to_dataset(inherit=False)) for node in tree.subtree}
        return bearing.with_ring_forces(xarray.DataTree.from_dict(found).load())
    except Exception as error:  # xarray raises errors of many kinds on what does not fit together
        raise InputError(str(path), f"a damaged file ({reason(error)})", _ALLOWED, _AGAIN) from error


def _check_version(path: Path, tree: xarray.DataTree) -> None:
    """Refuse a result whose names are those of another version: figures would vanish from its report."""
    stated = tree.attrs.get(provenance.SCHEMA_VERSION.name)
    found = int(stated) if isinstance(stated, Integral) else 0
    if found == VERSION:
        return
    writer = f"asperity {shown(tree.attrs[provenance.ASPERITY_VERSION.name])}"
    received = f"a result of schema version {found}, written by {writer}"
    remedy = "Update asperity." if found > VERSION else f"Run its case again, or read it with {writer}."
    raise InputError(str(path), received, f"schema version {VERSION}", remedy)


def groups_of_netcdf(path: str, whole: bool) -> Answer:
    """Read all that is in a file, or its attributes alone: groups, what their variables are, and these."""
    left = most_unpacked(path)
    groups: list[Any] = []
    arrays: list[NDArray[Any]] = []

    def take(group: Any) -> None:
        nonlocal left
        variables, inner = held_in(group) if whole else ({}, [])
        for each in variables.values():
            left -= size_unpacked(each.shape, each.dtype.itemsize)
            require_left()
            values = values_in(each)
            if values.dtype == object:  # words, which are sent at the length of the longest
                left -= 4 * values.size * max(map(len, values.flat), default=0)
                require_left()
            arrays.append(values)
        told = [(name, dimensions_of(each), attributes_in(each)) for name, each in variables.items()]
        groups.append((group.name, attributes_in(group), told))
        for each in inner:
            take(each)

    def require_left() -> None:
        if left < 0:
            raise ValueError(f"more than {MOST_UNPACKED} times its size in numbers")

    try:
        with opened_hdf5(path, path) as file:
            take(file)
    except InputError:
        raise
    except Exception as error:  # h5py raises errors of many kinds on damaged files
        raise InputError(path, f"a damaged file ({reason(error)})", _ALLOWED, _AGAIN) from error
    return groups, arrays


def attributes_of(path: FilePath) -> dict[str, Any]:
    """Read what a result or a study says of all of itself: its case, for instance."""
    return {str(name): value for name, value in _opened_apart(Path(path), whole=False).attrs.items()}


def case_text(path: FilePath) -> str:
    """Read the case, in TOML, that a ``run.nc`` belongs to, and nothing else of it."""
    found = attributes_of(path)
    if provenance.CASE.name not in found:
        raise InputError(str(path), "a file without a case", _ALLOWED)
    return str(found[provenance.CASE.name])
