"""Compare two run.nc to the last bit, and say where they differ.

Groups, variables, dimensions, values and attributes are compared. Names that have changed on purpose are
given as OLD=NEW: a path as ``rolling/speed``, of a variable or a group; or a single word, which is then
renamed wherever it names a variable, a dimension or an attribute. What only the second run has is listed,
and no difference. The exit code is 0 if nothing differs, else 1.

    python benchmarks/compare_runs.py before/run.nc after/run.nc roughness_level=texture_level
"""

from __future__ import annotations

import argparse
import sys
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import xarray

PASSING = ("created", "asperity_version")
"""Attributes that say when and by which version a run was made."""


@dataclass(frozen=True)
class Difference:
    """One place where two runs differ: its path, and what differs there."""

    path: str
    what: str

    def __str__(self) -> str:
        return f"{self.path}: {self.what}"


class Names:
    """New names of what was renamed."""

    def __init__(self, renamed: Mapping[str, str]) -> None:
        self.paths = {old: new for old, new in renamed.items() if "/" in old}
        self.words = {old: new for old, new in renamed.items() if "/" not in old}

    def of_path(self, path: str) -> str:
        """New path of a group, a variable or an attribute."""
        if path in self.paths:
            return self.paths[path]
        folder, stroke, name = path.rpartition("/")
        name = self.word(name)
        return f"{self.of_path(folder)}{stroke}{name}" if folder else f"{stroke}{name}"

    def word(self, name: str) -> str:
        """New name of a variable, a dimension or an attribute, wherever it stands."""
        return self.words.get(name, name)


def parts(path: Path) -> tuple[dict[str, xarray.Variable], dict[str, Any]]:
    """Return all variables and all attributes of groups of a run, by path."""
    variables, attributes = {}, {}
    with xarray.open_datatree(path, engine="h5netcdf", decode_timedelta=False) as tree:
        for node in tree.subtree:
            group = node.path.strip("/")
            for name, values in node.to_dataset(inherit=False).variables.items():
                variables[f"{group}/{name}"] = values.load()
            for name, value in node.attrs.items():
                attributes[f"{group}/@{name}"] = value
    return variables, attributes


def same(first: Any, second: Any) -> bool:
    """Whether two values are the same to the last bit; NaN is NaN."""
    one, other = np.asarray(first), np.asarray(second)
    if one.shape != other.shape or one.dtype.kind != other.dtype.kind:
        return False
    if one.dtype.kind == "f":
        return bool(
            np.array_equal(one, other, equal_nan=True) and (np.signbit(one) == np.signbit(other)).all()
        )
    return bool(np.array_equal(one, other))


def how_far(first: np.ndarray, second: np.ndarray) -> str:
    """How many numbers differ, and by how much at most."""
    if first.shape != second.shape:
        return f"shape {first.shape}, now {second.shape}"
    if first.dtype.kind not in "fiu" or second.dtype.kind not in "fiu":
        differing = np.ravel(first != second)
        at = int(np.argmax(differing))
        return f"{differing.sum()} of {first.size} differ, first {first.flat[at]!r}, now {second.flat[at]!r}"
    one, other = first.astype(float), second.astype(float)
    differing = ~((one == other) | (np.isnan(one) & np.isnan(other)))
    off = np.abs(one - other)[differing & np.isfinite(one) & np.isfinite(other)]
    scale = np.abs(one[np.isfinite(one)]).max(initial=0.0)
    largest = off.max(initial=0.0)
    share = f", {largest / scale:.1e} of the largest" if scale else ""
    return f"{differing.sum()} of {one.size} differ, by up to {largest:.3g}{share}"


def compare(first: Path, second: Path, renamed: Mapping[str, str]) -> tuple[list[Difference], list[str]]:
    """Return where two runs differ, and the paths of what only the second has."""
    names = Names(renamed)
    (variables, attributes), (others, other_attributes) = parts(first), parts(second)
    found = [
        *_differences_of_variables(variables, others, names),
        *_differences_of_attributes("", attributes, other_attributes, names),
    ]
    known = {names.of_path(path) for path in variables} | {_renamed(path, names) for path in attributes}
    added = [path for path in (*others, *other_attributes) if path not in known]
    return found, added


def _renamed(path: str, names: Names) -> str:
    """New path of an attribute, as ``spectra/@marks``."""
    group, _, name = path.rpartition("/@")
    return f"{names.of_path(group) if group else ''}/@{names.word(name)}"


def _differences_of_variables(
    variables: Mapping[str, xarray.Variable], others: Mapping[str, xarray.Variable], names: Names
) -> Iterator[Difference]:
    for path, values in variables.items():
        other = others.get(names.of_path(path))
        if other is None:
            yield Difference(path, "missing")
            continue
        dims = tuple(names.word(str(dim)) for dim in values.dims)
        if dims != other.dims:
            yield Difference(path, f"dimensions {dims}, now {other.dims}")
        if not same(values.values, other.values):
            yield Difference(path, how_far(values.values, other.values))
        yield from _differences_of_attributes(f"{path}/", values.attrs, other.attrs, names)


def _differences_of_attributes(
    where: str, attributes: Mapping[str, Any], others: Mapping[str, Any], names: Names
) -> Iterator[Difference]:
    for name, value in attributes.items():
        new = _renamed(name, names) if "/@" in name else names.word(name)
        if name.rpartition("@")[2] in PASSING:
            continue
        if new not in others:
            yield Difference(f"{where}{name}", "missing")
        elif not same(value, others[new]):
            yield Difference(f"{where}{name}", _told(value, others[new]))


def _told(value: Any, other: Any) -> str:
    """Two values of an attribute, from shortly before they part."""
    one, two = str(value), str(other)
    start = next(
        (n for n, (a, b) in enumerate(zip(one, two, strict=False)) if a != b), min(len(one), len(two))
    )
    cut = slice(max(start - 20, 0), start + 60)
    return f"…{one[cut]!r}, now …{two[cut]!r}" if cut.start else f"{one[cut]!r}, now {two[cut]!r}"


def main(arguments: list[str] | None = None) -> int:
    """Compare the two runs of a command line."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").partition("\n")[0])
    parser.add_argument("first", type=Path)
    parser.add_argument("second", type=Path)
    parser.add_argument("renamed", nargs="*", metavar="OLD=NEW", help="names that have changed on purpose")
    asked = parser.parse_args(arguments)
    found, added = compare(asked.first, asked.second, dict(pair.split("=", 1) for pair in asked.renamed))
    for difference in found:
        print(difference)
    for path in added:
        print(f"{path}: new")
    print(f"{len(found)} differences, {len(added)} new names")
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main())
