"""Maps of the force of any contact, F(δ, position), in files that other programs read."""

from __future__ import annotations

import os
from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from asperity.arguments import Array, ArrayLike, FilePath, as_row, finite_array, one_of, require
from asperity.case.any_case import AnyCase, function_named
from asperity.case.cases import as_case
from asperity.errors import InputError
from asperity.laws import Law
from asperity.laws.layout import force
from asperity.results import save, variable
from asperity.text_files import write_csv
from asperity.written_numbers import count_of

if TYPE_CHECKING:
    from xarray import DataArray

MOST = 10**7
"""Forces of a map."""
ENDINGS = (".nc", ".csv")
HEADING = "first row: positions (m); first column: approaches (m) positive closing; else: forces (N) pressing"
"""First line of a CSV file, without commas; a matrix of numbers follows, with 0 in its corner."""


def law_of(case: AnyCase, name: str | None = None, *, ring: str = "outer") -> Law:
    """A law of a case, laid on its path; of a bearing on the inner or the outer raceway, without a ball's.

    By default the main one. `ring` is ``"inner"`` or ``"outer"``.
    """
    name = one_of("law", case.laws[0] if name is None else name, case.laws)
    prepared = function_named(case.PREPARED_BY)(case, "case")
    built: Law = function_named(case.LAID_BY)(prepared, name, ring)
    return built


def force_map(
    contact: Law | AnyCase | Mapping[str, Any] | FilePath,
    positions: ArrayLike,
    approaches: ArrayLike,
    *,
    law: str | None = None,
    ring: str = "outer",
) -> DataArray:
    """Elastic force of a contact at positions of its path and approaches.

    Parameters
    ----------
    contact : Law, case object, mapping or path
        A law, as `asperity.laws` has them, or a case, whose surface is read and reduced.
    positions : array_like (p,)
        Of the contact along the path, m, rising.
    approaches : array_like (s,)
        Of the mean surfaces, m, positive closing, rising.
    law : str, optional
        Of a case: one of its laws; by default the main one.
    ring : {"inner", "outer"}
        Of a ball bearing: the raceway that a ball rolls on.

    Returns
    -------
    xarray.DataArray
        N, pressing, negative of a linear law alone, without damping, over ``approach`` and ``position``.

    Raises
    ------
    InputError
        If axes do not rise, or a case or its law is wrong.

    Examples
    --------
    >>> from asperity.laws import HertzLaw
    >>> found = force_map(HertzLaw(1e9, None), [0.0, 1e-3], [0.0, 1e-6, 4e-6])
    >>> found.values[:, 0].round(6).tolist()
    [0.0, 1.0, 8.0]
    """
    from xarray import DataArray

    along = _rising("positions (m)", positions)
    across = _rising("approaches (m)", approaches)
    count = along.size * across.size
    require(count <= MOST, "map", count_of(count, "force"), f"at most {MOST} of both together")
    told = ""
    if isinstance(contact, AnyCase | Mapping | str | os.PathLike):
        case = as_case(contact)
        told = law or case.laws[0]
        contact = law_of(case, law, ring=ring)
    where = np.repeat(along, across.size)
    found = force(contact, where, np.tile(across, along.size)).reshape(along.size, across.size).T
    coordinates = {
        "approach": variable("approach", across, "m", "approach of the mean surfaces, positive closing"),
        "position": variable("position", along, "m", "position of the contact along the path"),
    }
    named = {"units": "N", "long_name": "contact force, pressing"} | ({"law": told} if told else {})
    return DataArray(found, coordinates, ("approach", "position"), "force", named)


def _rising(what: str, values: ArrayLike) -> Array:
    found = finite_array(what, as_row(values), shape=(None,))
    require(bool((np.diff(found) > 0.0).all()), what, "values that do not rise", "values that rise")
    return found


def write_force_map(found: DataArray, path: FilePath) -> Path:
    """Write a map as netCDF, or as a CSV file of one heading and a matrix; completely or not at all.

    Parameters
    ----------
    found : xarray.DataArray
        From `force_map`.
    path : path
        Ends in .nc or .csv.

    Returns
    -------
    Path
        The file.
    """
    path = Path(path)
    if path.suffix.lower() == ".csv":
        matrix = np.block(
            [[np.zeros((1, 1)), found["position"].values], [found["approach"].values[:, None], found.values]]
        )
        return write_csv(path, [HEADING], matrix.tolist())
    if path.suffix.lower() != ".nc":
        raise InputError("file of a map", f"'{path.name}'", f"a name that ends in {' or '.join(ENDINGS)}")
    from xarray import DataTree

    return save(DataTree(found.to_dataset()), path)
