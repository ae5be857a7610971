"""One netCDF-4 file per run: groups with units, long names and provenance."""

from __future__ import annotations

import io
import os
import zlib
from collections.abc import Callable, Hashable, Sequence
from numbers import Integral
from pathlib import Path
from typing import TYPE_CHECKING, Any, BinaryIO

from asperity.apart import apart, reason
from asperity.arguments import file_path, no_file, shown
from asperity.errors import InputError
from asperity.files import is_sealed, write_bytes
from asperity.schema import VERSION
from asperity.schema.provenance import ASPERITY_VERSION, CASE, SCHEMA_VERSION

if TYPE_CHECKING:
    import xarray
    from numpy.typing import ArrayLike, NDArray

GROUPS = ("scenario", "surface", "contact", "rolling", "spectra")
TRIED = 4096  # numbers of a part on which compression is tried
WORTHWHILE = 0.75  # largest size, relative to that as they are, of numbers that are worth compressing
LARGEST_FILE = 16 * 2**30  # bytes


def variable(
    dims: str | Sequence[str], values: ArrayLike, units: str, long_name: str, **attrs: Any
) -> xarray.Variable:
    """Make a variable of a result, with its attributes.

    Units are in SI, ``"1"`` for a pure number, ``"dB re 1 N"`` for a level; `long_name` says what it is, in
    the words that a figure's axis carries.
    """
    import xarray

    return xarray.Variable(dims, values, {"units": units, "long_name": long_name, **attrs})


def checked(tree: xarray.DataTree) -> xarray.DataTree:
    """Return `tree` itself, once every variable and coordinate in it has units and a long name.

    A `ValueError` is a fault of the program, not of its input.
    """
    bare: list[Hashable] = [
        f"{node.path}/{name}".replace("//", "/")
        for node in tree.subtree
        for name, values in node.to_dataset(inherit=False).variables.items()
        if not {"units", "long_name"} <= values.attrs.keys()
    ]
    if bare:
        raise ValueError(f"results without units or long_name: {', '.join(map(str, bare))}")
    return tree


def save(tree: xarray.DataTree, path: str | os.PathLike[str]) -> Path:
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
    return save_after(lambda: None, tree, path)


def save_after(before: Callable[[], object], tree: xarray.DataTree, path: str | os.PathLike[str]) -> Path:
    """Write a result as `save` does, with something done between laying the file out and writing it."""
    checked(tree)
    encoding = {
        node.path: {
            name: _encoding(values.values)
            for name, values in node.to_dataset(inherit=False).variables.items()
            if values.dtype.kind in "iuf" and values.ndim
        }
        for node in tree.subtree
    }
    image = io.BytesIO()  # HDF5 itself ends the process where a disk is full
    _storable(tree).to_netcdf(image, engine="h5netcdf", encoding=encoding, write_inherited_coords=False)
    before()
    return write_bytes(path, image.getbuffer(), sealed=True)


def _encoding(values: NDArray[Any]) -> dict[str, Any]:
    """Say how numbers (...) are written: compressed where that saves much, always with a checksum.

    The last digits of what was computed look random, and to compress them takes longer than to write them.
    What can be saved is tried on three parts of the numbers, a byte of all after the other, as HDF5 shuffles.
    """
    import numpy as np

    numbers = values.reshape(-1)
    starts = {max(0, share * (numbers.size - TRIED) // 2) for share in range(3)}
    tried = np.concatenate([numbers[start : start + TRIED] for start in starts])
    shuffled = tried.view(np.uint8).reshape(-1, tried.itemsize).T.tobytes()
    pays = len(zlib.compress(shuffled, 1)) < WORTHWHILE * len(shuffled)
    return {"fletcher32": True} | ({"zlib": True, "complevel": 1, "shuffle": True} if pays else {})


def _storable(tree: xarray.DataTree) -> xarray.DataTree:
    """Spell out what UTF-8 does not have, as bytes in names of files, in the words of a tree."""
    tree = tree.copy()
    for node in tree.subtree:
        words = {name: value for name, value in node.attrs.items() if isinstance(value, str)}
        spelled = {name: word.encode(errors="backslashreplace").decode() for name, word in words.items()}
        node.attrs = node.attrs | spelled
    return tree


def read_result(path: str | os.PathLike[str]) -> xarray.DataTree:
    """Read a result that a run has written, a ``run.nc`` or the folder of one, to memory."""
    path = file_path("result", path, "the path of a run.nc, or of the folder that holds one")
    if no_file(path) == "a folder":
        path = path / "run.nc"
    allowed = "a result file that a run has written (run.nc)"
    if received := no_file(path):
        raise InputError(str(path), received, allowed, "Check the path.")
    if path.stat().st_size > LARGEST_FILE:
        raise InputError(str(path), f"{path.stat().st_size / 2**30:.0f} GiB", f"{allowed} of at most 16 GiB")
    with open(path, "rb") as file:
        signature, intact = file.read(8), is_sealed(file)
    if signature != b"\x89HDF\r\n\x1a\n":
        raise InputError(str(path), "a file that is not netCDF-4", allowed)
    if intact is None:  # of another program, which HDF5 may hang in
        apart(f"{__name__}:open_apart", [str(path.absolute())], str(path), path.stat().st_size, "netCDF-4")
    elif not intact:
        received = "a damaged file: its digest does not fit its contents"
        raise InputError(str(path), received, allowed, "Run its case again.")
    tree = _opened(path)
    if ASPERITY_VERSION.name not in tree.attrs or not set(GROUPS) <= set(tree.children):
        raise InputError(str(path), "a netCDF-4 file of another kind", allowed)
    _check_version(path, tree)
    return tree


def _check_version(path: Path, tree: xarray.DataTree) -> None:
    """Refuse a result whose names are those of another version: figures would vanish from its report."""
    stated = tree.attrs.get(SCHEMA_VERSION.name)
    found = int(stated) if isinstance(stated, Integral) else 0
    if found == VERSION:
        return
    writer = f"asperity {shown(tree.attrs[ASPERITY_VERSION.name])}"
    received = f"a result of schema version {found}, written by {writer}"
    remedy = "Update asperity." if found > VERSION else f"Run its case again, or read it with {writer}."
    raise InputError(str(path), received, f"schema version {VERSION}", remedy)


def _opened(path: Path) -> xarray.DataTree:
    import xarray

    try:
        with xarray.open_datatree(path, engine="h5netcdf") as opened:
            return opened.load()
    except Exception as error:  # h5py and xarray raise errors of many kinds on damaged files
        received = f"a damaged file ({reason(error)})"
        allowed = "a result file that a run has written (run.nc)"
        raise InputError(str(path), received, allowed, "Run its case again.") from error


def open_apart(path: str, answers: BinaryIO) -> None:
    """Open a result whose origin is not known, to see that it can be; nothing is answered."""
    _opened(Path(path))


def case_text(path: str | os.PathLike[str]) -> str:
    """Read the case, in TOML, that a ``run.nc`` belongs to, and nothing else of it."""
    import h5netcdf

    try:
        with open(path, "rb") as sealed:
            if not is_sealed(sealed):
                raise ValueError("its digest is missing, or does not fit")
        with h5netcdf.File(path, "r") as file:
            return str(file.attrs[CASE.name])
    except Exception as error:  # h5py raises errors of many kinds on damaged files
        received = f"a file without a readable case ({reason(error)})"
        raise InputError(str(path), received, "a result file that a run has written (run.nc)") from error
