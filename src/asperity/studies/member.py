"""One member of a study: computed wherever the executor puts it, and what is kept of it."""

import json
import threading
from collections.abc import Mapping
from contextlib import suppress
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
import xarray
from numpy.typing import NDArray

from asperity.errors import TOO_MUCH_MEMORY, AsperityError, ComputationError
from asperity.reporting.data import contact_numbers
from asperity.results import variable
from asperity.scenes import schema as scene
from asperity.schema import Entry, bearing, contact, provenance, rolling, spectra
from asperity.spectra import a_weighted_total, level_of

if TYPE_CHECKING:
    from asperity.case.any_case import AnyCase

KEPT = (
    spectra.FORCE_LEVEL,
    spectra.BAND_TIME_PRODUCT,
    spectra.START_SHARE,
    *spectra.FORCE_LEVEL_DIFFERENCES.values(),
    spectra.FORCE_LEVEL_DIFFERENCE_TO_REFERENCE,
    contact.TRACK_RMS,
    contact.TRACK_STIFFNESS,
)
"""What is kept of all results, beside what the schema of a scene says."""
OF_CONTACTS = spectra.CONTACT_FORCE_LEVEL
"""What is kept of every contact, where there are several.

Numbers of forces and of losses of contact are those of all of them, all else by contact is that of the first.
"""
FACTS = (
    contact.WORKING_APPROACH,
    contact.WORKING_STIFFNESS,
    contact.YIELDED_SHARE,
    scene.LARGEST_GROWTH,
    scene.SQUEAL_GROWTH,
)
"""Attributes of a result that are kept."""
CHOSEN_CELLS = contact.RIM_CELLS.name
"""Attribute of what is kept: cells at rims, where the texture of the member chose them."""
LEVEL = "dB re"
"""Beginning of the units of levels."""
PLACES = ("sensor", "point")
"""Dimensions whose positions may differ between members: they are numbered, from 1."""

SIGNAL = "signal"
"""Acceleration (sensors, n), m/s2, of a bearing by its main law: kept of every member, and in no table."""


def kept(tree: xarray.DataTree) -> xarray.Dataset:
    """Choose what a study keeps of a result: quantities by law, and by band where they have bands.

    With citations and warnings as attributes.
    """
    found = _of_bearing(tree) if bearing.TONE.group in tree.children else _of_bodies(tree)
    table = xarray.Dataset(found).drop_attrs(deep=False)
    for place in set(PLACES) & set(map(str, table.dims)):
        table = _numbered(table, place)
    for fact in FACTS:
        if fact.group in tree.children and (value := tree[fact.group].attrs.get(fact.name)) is not None:
            table[fact.name] = variable((), value, fact.units, fact.meaning)
    told = (provenance.CITATIONS.name, provenance.WARNINGS.name)
    about = tree["contact"].attrs if "contact" in tree.children else {}
    if contact.RIM_CELLS_CHOSEN.name in about:
        table = table.assign_attrs({CHOSEN_CELLS: about[contact.RIM_CELLS.name]})
    return table.assign_attrs({name: tree.attrs[name] for name in told})


def _of_bearing(tree: xarray.DataTree) -> dict[str, Any]:
    """What is kept of a bearing, at its first sensor; ranges of its velocities are told apart by words."""
    found: dict[str, Any] = {
        entry.name: tree[entry.path]
        .sel(at, drop=True)
        .isel({bearing.SENSOR.name: 0}, missing_dims="ignore", drop=True)
        for entry, at in bearing.KEPT.items()
        if entry.name in tree[entry.group]
    }
    for entry in (bearing.BAND_VELOCITY, bearing.BAND_DEVIATION):
        found[entry.name] = found[entry.name].rename(judged_band="range")
    load = tree["bearing"].to_dataset()[bearing.BALL_LOAD.name].max(("cage_angle", "ball"))
    motion = tree["rolling"].to_dataset()
    largest = motion[rolling.CONTACT_FORCE.name].max("time")
    of_rings = motion[bearing.CONTACT_RING.name].rename("ring")
    peak = largest.groupby(of_rings).max().sel(ring=load["ring"]).transpose("law", "ring")
    found[VELOCITY_LEVEL] = _velocity_levels(found[bearing.BAND_VELOCITY.name])
    found["largest_load"] = _described(load, "N", LOADS["largest_load"])
    found["peak_force"] = _described(peak, "N", LOADS["peak_force"])
    found[SIGNAL] = motion[bearing.RING_ACCELERATION.name][0].variable
    return found


JUDGED = "judged"
"""Bands in which a bearing is judged."""
TOTAL = "total"
"""All of them together."""
VELOCITY_LEVEL = "velocity_level"
"""Levels of its velocities in these."""
VELOCITY_REFERENCE = 1e-9
"""Of levels of velocities, m/s (ISO 1683)."""


def _velocity_levels(velocity: xarray.DataArray) -> xarray.DataArray:
    """Levels of velocities by range, and of all ranges together."""
    total = (velocity**2).sum("range") ** 0.5  # without ranges that the sampling does not reach
    names = np.array([*velocity["range"].values.tolist(), TOTAL])
    every = np.concatenate([velocity.values, total.values[:, None]], axis=1)
    found = level_of((every / VELOCITY_REFERENCE) ** 2)
    judged = variable(JUDGED, names, "1", "band in which bearings are judged, or all together")
    level = xarray.DataArray(
        np.where(np.isfinite(found), found, np.nan), {"law": velocity["law"], JUDGED: judged}, ("law", JUDGED)
    )
    return _described(level, "dB re 1 nm/s", "radial velocity level, first sensor").assign_attrs(
        missing=bearing.BAND_VELOCITY.missing
    )


LOADS = {
    "largest_load": "largest static load of a contact",
    "peak_force": "largest contact force",
}
"""What is kept of the forces of a bearing."""


def _of_bodies(tree: xarray.DataTree) -> dict[str, Any]:
    """What is kept of bodies that roll."""
    own = scene.KEPT
    first = {rolling.CONTACT.name: 0}
    found = {
        entry.name: tree[entry.path]
        .sel(own.get(entry, {}), drop=True)
        .isel(first, missing_dims="ignore", drop=True)
        for entry in (*KEPT, *own)
        if entry.group in tree.children and entry.name in tree[entry.group]
    }
    every = tree[OF_CONTACTS.path]
    if every.sizes[rolling.CONTACT.name] > 1:
        found[OF_CONTACTS.name] = every
    for name, (numbers, units, what) in contact_numbers(tree).items():
        found[name] = _described(numbers, units, what)
    lowering = contact.RUNNING_IN_LOWERING
    if lowering.name in tree[lowering.group]:
        most = tree[lowering.group].to_dataset()[lowering.name].max(contact.RUNNING_IN_PASS.name)
        found[lowering.name] = _described(most, "m", "largest lowering of a place in a pass of running-in")
    return found | _weighted(
        {name: values for name, values in found.items() if isinstance(values, xarray.DataArray)}
    )


def names_kept() -> set[str]:
    """Names that the table of a study may have."""
    entries = (*KEPT, OF_CONTACTS, contact.RUNNING_IN_LOWERING, *scene.KEPT, *bearing.KEPT)
    bands = (each for each in entries if each.units.startswith(LEVEL) and each.dims[-1].endswith("band"))
    found = {
        *LOADS,
        VELOCITY_LEVEL,
        *rolling.FORCES,
        *(entry.name for entry in rolling.LOSSES),
        *(each.name for each in entries),
        *(fact.name for fact in FACTS),
    }
    found |= {f"{entry.name}_a" for entry in bands}
    return found | {_weighted_name(entry) for entry in spectra.FORCE_LEVEL_DIFFERENCES.values()}


def _weighted_name(difference: Entry) -> str:
    return difference.name.replace(spectra.FORCE_LEVEL.name, f"{spectra.FORCE_LEVEL.name}_a")


def _weighted(found: Mapping[str, xarray.DataArray]) -> dict[str, xarray.DataArray]:
    """A-weighted totals of levels, where the result has none, and of the force over the linear laws."""
    totals: dict[str, xarray.DataArray] = {}
    for name, level in found.items():
        units = str(level.attrs["units"])
        band = str(level.dims[-1]) if level.dims else ""
        if units.startswith(LEVEL) and band.endswith("band") and f"{name}_a" not in found:
            long_name = f"A-weighted {level.attrs['long_name']}, over the bands computed"
            total = _total(level, band)
            totals[f"{name}_a"] = _described(total, units.replace("dB", "dB(A)", 1), long_name)
    force = found.get(spectra.FORCE_LEVEL.name)
    for entry in spectra.FORCE_LEVEL_DIFFERENCES.values():
        if force is not None and entry.name in found:
            law = str(found[entry.name].attrs["reference"])
            band = str(force.dims[-1])
            both = np.isfinite(force) & np.isfinite(force.sel(law=law, drop=True))
            change = _total(force.where(both), band) - _total(force.sel(law=law, drop=True).where(both), band)
            totals[_weighted_name(entry)] = _described(
                change, "dB", f"A-weighted {entry.long_name}, over the bands of both"
            )
    return totals


def _total(level: xarray.DataArray, band: str) -> xarray.DataArray:
    numbers = a_weighted_total(level.transpose(..., band).values, level[band].values)
    return (
        level.isel({band: 0}, drop=True).transpose(*[d for d in level.dims if d != band]).copy(data=numbers)
    )


def _described(values: xarray.DataArray, units: str, long_name: str) -> xarray.DataArray:
    return values.drop_attrs(deep=False).assign_attrs(units=units, long_name=long_name)


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


_one_at_a_time = threading.Lock()
"""Warnings and threads of linear algebra belong to the whole process; a member has it for itself."""


@dataclass(frozen=True)
class Failure:
    """Why a member has no result."""

    error: str  # kind of error
    message: str  # what failed, and what to try

    @classmethod
    def of(cls, error: BaseException) -> "Failure":
        """Describe an error."""
        if isinstance(error, MemoryError):
            return cls("MemoryError", f"{TOO_MUCH_MEMORY} Or fewer workers.")
        name = type(error).__name__
        return cls(name, str(error) if isinstance(error, AsperityError) else f"{name}: {error}")


def compute_member(key: str, case: "AnyCase") -> dict[str, NDArray[Any]] | Failure:
    """Compute a member, or take what an earlier study has kept of it under its key, `packed`."""
    from asperity.running import run
    from asperity.store import Store

    store = Store()
    with _one_at_a_time:
        found = store.get(key)
        if found is not None:
            return found
        try:
            found = packed(kept(run(case, brief=True)))
        except Exception as error:  # whatever it is, it is the failure of this member alone
            return Failure.of(error)
        with suppress(ComputationError):  # a full disk here loses nothing: the result goes back
            store.put(key, found)
    return found
