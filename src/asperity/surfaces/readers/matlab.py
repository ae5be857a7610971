"""Arrays in files of MATLAB, ``.mat``, of version 7.3 (HDF5) and before (SciPy), in a sandbox."""

from collections.abc import Iterator, Sequence
from dataclasses import asdict
from pathlib import Path
from typing import Any

import numpy as np

from asperity.arguments import NDArray, listed, require, shown
from asperity.hdf5 import LEAST_ITEM, check_unpacked, is_hdf5, opened_hdf5
from asperity.sandbox import Answer, sandboxed
from asperity.surfaces.readers import arrays, guards
from asperity.surfaces.readers.hints import SPELLING, Hints, Spelling, spelled

HEAD = (b"MATLAB 5.0 MAT-file", b"MATLAB 7.3 MAT-file")
"""What files begin with, those of Octave too; older ones are known by their extension alone."""
DEEPEST = 5
"""Structures within structures that are looked into."""
REFERENCES = "#"
"""First letter of groups of version 7.3 in which cells keep what they hold."""


def read_mat(path: Path, hints: Hints) -> list[guards.Surface]:
    """Read the array of heights that the hints name, or the only one that is no scalar, as of ``.npy``."""
    name, heights, _ = array_of_matlab(path, hints.array)
    return arrays.surfaces_of_array(heights, hints, f"{path.name}:{name}")


def array_of_matlab(
    path: Path, name: str | None, what: str = "heights", words: Sequence[str] = ()
) -> tuple[str, NDArray[Any], dict[str, NDArray[Any]]]:
    """Name of an array of numbers, with dots within structures, and the array; the only one without a name.

    And those by their names that have one of some words for theirs, see `plain_word`. `what` the array should
    hold is for messages.
    """
    asked = [name, what, path.name, asdict(SPELLING.get()), list(words)]
    packages = ["scipy.io", "h5py"]
    (found, names), (array, *beside) = sandboxed(
        numbers_in_matlab, path, asked, source=path.name, kind="MATLAB", packages=packages
    )
    return str(found), array, dict(zip(names, beside, strict=True))


def numbers_in_matlab(
    path: str, name: str | None, what: str, source: str, spelling: dict[str, Any], words: list[str]
) -> Answer:
    """Read what `array_of_matlab` is asked for."""
    find = _in_hdf5 if is_hdf5(path) else _in_older
    with spelled(Spelling(**spelling)):
        return find(path, name, what, source, set(words))


def _chosen(names: list[str], name: str | None, what: str, source: str) -> str:
    if name is None:
        return arrays.only_one(names, source, what)
    require(name in names, f"array in {source}", shown(name), f"one of: {listed(names)}", "Choose one.")
    return name


def _in_hdf5(path: str, name: str | None, what: str, source: str, words: set[str]) -> Answer:
    with opened_hdf5(path, source) as file:
        found = dict(_datasets(file, ""))
        chosen = _chosen([each for each, data in found.items() if data.size > 1], name, what, source)
        beside = [each for each in found if each != chosen and arrays.plain_word(each) in words]
        for each in (chosen, *beside):
            check_unpacked(path, f"{source}:{each}", found[each].shape, found[each].dtype.itemsize)
        # columns follow one another in MATLAB
        return [chosen, beside], [np.asarray(found[each][...]).T for each in (chosen, *beside)]


def _datasets(group: Any, above: str, depth: int = 0) -> Iterator[tuple[str, Any]]:
    """Arrays of numbers in a group, and in those within; words are numbers of a class of their own."""
    for name, item in group.items():
        if name.startswith(REFERENCES):
            continue
        if hasattr(item, "shape"):
            of_class = item.attrs.get("MATLAB_class", b"double")
            if item.dtype.kind in "fiub" and item.size and of_class not in (b"char", b"cell"):
                yield f"{above}{name}", item
        elif depth < DEEPEST:
            yield from _datasets(item, f"{above}{name}.", depth + 1)


def _in_older(path: str, name: str | None, what: str, source: str, words: set[str]) -> Answer:
    from scipy.io import loadmat, whosmat

    kinds = {each: (shape, kind) for each, shape, kind in whosmat(path)}
    numbers = {each: shape for each, (shape, kind) in kinds.items() if kind in _NUMBERS and np.prod(shape)}
    whole = {each: shape for each, shape in numbers.items() if np.prod(shape) > 1}
    structures = [each for each, (_, kind) in kinds.items() if kind == "struct"]
    loaded = loadmat(path, variable_names=structures) if structures and name not in whole else {}
    within = dict(found for each in loaded.keys() & set(structures) for found in _fields(loaded[each], each))
    several = [each for each, array in within.items() if array.size > 1]
    chosen = _chosen([*whole, *several], name, what, source)
    beside = [each for each in (*numbers, *within) if each != chosen and arrays.plain_word(each) in words]
    wanted = [each for each in (chosen, *beside) if each in numbers]
    for each in wanted:
        check_unpacked(path, f"{source}:{each}", numbers[each], LEAST_ITEM)
    if chosen in within:
        check_unpacked(path, f"{source}:{chosen}", within[chosen].shape, within[chosen].dtype.itemsize)
    found = within | (loadmat(path, variable_names=wanted) if wanted else {})
    return [chosen, beside], [found[each] for each in (chosen, *beside)]


_NUMBERS = {"double", "single", "logical", *(f"{u}int{n}" for u in ("", "u") for n in (8, 16, 32, 64))}


def _fields(value: NDArray[Any], name: str, depth: int = 0) -> Iterator[tuple[str, NDArray[Any]]]:
    """Arrays of numbers in a structure, with dots in their names."""
    if value.dtype.names and value.size == 1 and depth < DEEPEST:
        for field in value.dtype.names:
            yield from _fields(np.asarray(value.flat[0][field]), f"{name}.{field}", depth + 1)
    elif value.dtype.kind in "fiub" and value.size:
        yield name, value
