"""What a study keeps of each member: force and motion in bands, and how contact was lost."""

from __future__ import annotations

import json
from collections.abc import Mapping
from typing import Any

import numpy as np
import xarray
from numpy.typing import NDArray

from asperity.results import variable

KEPT = {
    "force_level": "spectra",
    "band_time_product": "spectra",
    "force_level_difference_to_linear_filtered": "spectra",
    "force_level_difference_to_linear": "spectra",
    "force_level_difference_to_reference": "spectra",
    "acceleration_level": "spectra",
    "point_velocity_level": "spectra",
    "sound_power_level": "spectra",
    "contact_loss_share": "rolling",
    "contact_loss_events": "rolling",
    "longest_loss": "rolling",
}
"""Variables of a result that are kept as they are, and their groups."""
PLACES = ("sensor", "point")
"""Dimensions whose positions may differ between members: they are numbered, from 1."""


def kept(tree: xarray.DataTree) -> xarray.Dataset:
    """Choose what a study keeps of a result: quantities by law, and by band where they have bands.

    With citations and warnings as attributes.
    """
    found = {name: tree[group][name] for name, group in KEPT.items() if name in tree[group]}
    force = tree["rolling"].to_dataset()["contact_force"]
    found["mean_force"] = _described(force.mean("time"), "N", "mean contact force")
    found["rms_force"] = _described(force.std("time"), "N", "rms of the contact force about its mean")
    if "sound_power_level_a" in tree["spectra"]:
        total = tree["spectra/sound_power_level_a"]
        found["sound_power_level_a"] = total.sel(source="total", drop=True)
    table = xarray.Dataset(found).drop_attrs(deep=False)
    for place in set(PLACES) & set(map(str, table.dims)):
        table = _numbered(table, place)
    table["working_approach"] = variable(
        (), tree["contact"].attrs["working_approach"], "m", "approach under the static load"
    )
    return table.assign_attrs({name: tree.attrs[name] for name in ("citations", "warnings")})


def _described(values: xarray.DataArray, units: str, long_name: str) -> xarray.DataArray:
    return values.drop_attrs().assign_attrs(units=units, long_name=long_name)


def _numbered(table: xarray.Dataset, place: str) -> xarray.Dataset:
    positions = table[place]
    number = variable(place, np.arange(1, len(positions) + 1), "1", f"number of the {place}")
    table = table.assign_coords({place: number})
    table[f"{place}_position"] = variable(place, positions.values, "m", str(positions.attrs["long_name"]))
    return table


def packed(table: xarray.Dataset) -> dict[str, NDArray[Any]]:
    """Lay out a table from `kept` as a store keeps it: plain arrays, and their description as JSON."""
    layout = {
        str(name): {"dims": values.dims, "attrs": values.attrs} for name, values in table.variables.items()
    }
    description = json.dumps({"variables": layout, "attrs": table.attrs}, ensure_ascii=False)
    arrays = {str(name): values.values for name, values in table.variables.items()}
    return {"__description__": np.array(description), **arrays}


def unpacked(arrays: Mapping[str, NDArray[Any]]) -> xarray.Dataset:
    """Make the table that `packed` laid out."""
    description = json.loads(str(arrays["__description__"]))
    return xarray.Dataset(
        {
            name: xarray.Variable(item["dims"], arrays[name], item["attrs"])
            for name, item in description["variables"].items()
        },
        attrs=description["attrs"],
    )
