"""Tables in netCDF-4 files: larger than text may be, and as they lie in the programs that write them."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any, BinaryIO

import numpy as np
from numpy.typing import NDArray

from asperity.apart import apart, received, send
from asperity.arguments import no_file
from asperity.errors import InputError
from asperity.files import amount
from asperity.structures.modal_files import LARGEST_FILE, netcdf_numbers
from asperity.surfaces.readers.guards import hostile

MOST_LINES = 2**22
"""Lines of a table that is laid out: 160 MiB of five columns."""
MOST_DIMENSIONS = 3


def read_columns(file: Path, columns: Sequence[tuple[str, str]]) -> NDArray[np.float64]:
    """Read a table (lines, columns), in SI, of columns by name and SI unit.

    Each column is a variable of that name, with _ for blanks, along one or more dimensions. Those of the
    table are all of these: a variable that lacks one is the same along it.
    """
    if found := no_file(file):
        raise InputError(str(file), found, "a netCDF-4 file with a table", "Check the path.")
    size = file.stat().st_size
    if size > LARGEST_FILE:
        raise InputError(file.name, amount(size), f"at most {amount(LARGEST_FILE)}")
    served = f"{serve_columns.__module__}:{serve_columns.__name__}"
    answer = apart(served, [str(file.absolute()), list(columns)], file.name, size, "netCDF-4")
    return received(answer)[1][0].copy()


def serve_columns(path: str, columns: list[tuple[str, str]], answers: BinaryIO) -> None:
    """Lay out the table of a netCDF-4 file and send it to the binary file `answers`."""
    import h5netcdf

    file = Path(path)
    with hostile(file.name, "netCDF-4"), h5netcdf.File(file, "r") as opened:
        found: list[tuple[tuple[str, ...], NDArray[np.float64]]] = []
        for heading, unit in columns:
            name = heading.replace(" ", "_")
            if name not in opened.variables:
                allowed = f"the variables {', '.join(each.replace(' ', '_') for each, _ in columns)}"
                raise InputError(file.name, f"no variable {name}", allowed)
            variable = opened.variables[name]
            numbers = netcdf_numbers(variable, name, unit, MOST_DIMENSIONS, file)
            found.append((tuple(variable.dimensions), numbers))
        send(answers, ["table"], [_laid_out(found, file)])


def _laid_out(found: list[tuple[tuple[str, ...], Any]], file: Path) -> NDArray[np.float64]:
    sizes = {name: size for along, numbers in found for name, size in zip(along, numbers.shape, strict=True)}
    lines = int(np.prod([float(size) for size in sizes.values()]))
    if lines > MOST_LINES:
        raise InputError(file.name, f"a table of {lines} lines", f"at most {MOST_LINES}")
    table = np.empty((*sizes.values(), len(found)))
    for column, (along, numbers) in enumerate(found):
        order = [along.index(name) for name in sizes if name in along]
        shape = [size if name in along else 1 for name, size in sizes.items()]
        table[..., column] = numbers.transpose(order).reshape(shape)
    table = table.reshape(-1, len(found))
    if not (len(table) and np.isfinite(table).all()):
        raise InputError(file.name, "no lines, or numbers that are not finite", "a table of finite numbers")
    return table
