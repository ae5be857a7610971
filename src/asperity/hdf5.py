"""HDF5 files, netCDF-4 and MATLAB's among them, are read if they hold all of their data themselves."""

import math
import os
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from typing import TYPE_CHECKING, Any

from asperity.arguments import FilePath, require
from asperity.errors import InputError

if TYPE_CHECKING:
    import h5netcdf
    import h5py

SIGNATURE = b"\x89HDF\r\n\x1a\n"
MOST_UNPACKED = 100  # times its size that the numbers of a file may take, in memory
SMALL = 2**26  # bytes that any file may take
LEAST_ITEM = 8  # bytes: numbers are made floats of double precision
_USER_BLOCK = 512
"""Bytes after which the signature may stand as well, or after these doubled any number of times."""
_ALLOWED = "a file that holds all of its data itself"
_REMEDY = "Copy what it refers to into one file (h5repack, nccopy), if you trust it."


@contextmanager
def opened_netcdf(path: FilePath, source: str, **options: Any) -> "Iterator[h5netcdf.File]":
    """Open a netCDF-4 file to read it, if it holds all of its data itself."""
    import h5netcdf

    refuse_data_elsewhere(path, source)
    with _broken_links_named(path, source), h5netcdf.File(path, "r", **options) as opened:
        yield opened


@contextmanager
def opened_hdf5(path: FilePath, source: str) -> "Iterator[h5py.File]":
    """Open an HDF5 file of any kind to read it, if it holds all of its data itself."""
    import h5py

    refuse_data_elsewhere(path, source)
    with _broken_links_named(path, source), h5py.File(path, "r") as opened:
        yield opened


@contextmanager
def _broken_links_named(path: FilePath, source: str) -> Iterator[None]:
    """Name a soft link that leads nowhere where a library fails at one: the file is whole but for it."""
    import h5py

    try:
        yield
    except (AttributeError, KeyError, RuntimeError):
        with h5py.File(path, "r") as file:
            links = (name for name in file if file.get(name, getlink=True).__class__ is h5py.SoftLink)
            broken = [name for name in links if _leads_nowhere(file, name)]
        if not broken:
            raise
        received = f"a link {_word(broken[0].encode())} that leads nowhere"
        remedy = f"Remove it, as with h5py: del file[{_word(broken[0].encode())}]."
        raise InputError(source, received, "links to what the file holds", remedy) from None


def _leads_nowhere(file: "h5py.File", name: str) -> bool:
    try:
        file[name]
    except (KeyError, RuntimeError):  # nothing is there, or links lead round and round
        return True
    return False


def is_hdf5(path: FilePath) -> bool:
    """Whether a file is HDF5, by its signature, which other bytes may precede."""
    place = 0
    size = os.path.getsize(path)
    with open(path, "rb") as file:
        while place < size:
            file.seek(place)
            if file.read(len(SIGNATURE)) == SIGNATURE:
                return True
            place = 2 * place or _USER_BLOCK
    return False


def refuse_data_elsewhere(path: FilePath, source: str) -> None:
    """Refuse an HDF5 file with data, or parts of its tree, in other files, before any of it is read.

    These are external links, links of kinds that a program defines, external raw storage, and virtual data
    sets. Soft links lead nowhere else where there are none of these. Of what is linked more than once each is
    looked at once.
    """
    import h5py

    with h5py.File(path, "r") as file:
        groups = [file.id]
        seen = {h5py.h5o.get_info(file.id).addr}
        while groups:
            group = groups.pop()
            for name in group:
                kind = group.links.get_info(name).type
                if kind == h5py.h5l.TYPE_SOFT:
                    continue
                _require_inside(kind == h5py.h5l.TYPE_HARD, source, f"a link {_word(name)} to another file")
                held = h5py.h5o.open(group, name)
                address = h5py.h5o.get_info(held).addr
                if address in seen:
                    continue
                seen.add(address)
                if isinstance(held, h5py.h5g.GroupID):
                    groups.append(held)
                elif isinstance(held, h5py.h5d.DatasetID):
                    _refuse_dataset_elsewhere(held, source, name)


def _refuse_dataset_elsewhere(dataset: "h5py.h5d.DatasetID", source: str, name: bytes) -> None:
    import h5py

    created = dataset.get_create_plist()
    virtual = created.get_layout() == h5py.h5d.VIRTUAL
    _require_inside(not virtual, source, f"a virtual data set {_word(name)}, made of others")
    _require_inside(created.get_external_count() == 0, source, f"data of {_word(name)} in another file")


def _require_inside(inside: bool, source: str, received: str) -> None:
    require(inside, source, received, _ALLOWED, _REMEDY)


def _word(name: bytes) -> str:
    return repr(name[:40].decode(errors="replace"))


def size_unpacked(shape: Sequence[int], item_bytes: int) -> int:
    """Bytes that an array of so many items takes in memory."""
    return math.prod(shape) * max(item_bytes, LEAST_ITEM)


def most_unpacked(path: FilePath) -> int:
    """Bytes of numbers that a file may unpack to."""
    return max(SMALL, MOST_UNPACKED * os.path.getsize(path))


def check_unpacked(path: FilePath, source: str, shape: Sequence[int], item_bytes: int) -> None:
    """Refuse an array that would take much more memory than its file is long, before any of it is read."""
    size = size_unpacked(shape, item_bytes)
    most = most_unpacked(path)
    if size > most:
        points = " x ".join(map(str, shape))
        received = f"{points} points in {os.path.getsize(path)} bytes, which unpack to {size}"
        allowed = f"at most {MOST_UNPACKED} times the size of the file, or {SMALL} bytes"
        raise InputError(source, received, allowed, "Store the data uncompressed if it is genuine.")
