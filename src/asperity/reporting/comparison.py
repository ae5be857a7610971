"""What differs between runs: keys of their cases, levels, stiffness, filters, in one dataset."""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import xarray
from numpy.typing import NDArray
from xarray import DataArray, DataTree

from asperity.arguments import nearest, shown
from asperity.errors import InputError
from asperity.reporting.data import json_list, laws, number, of_law, present, stored_variable, values
from asperity.results import variable
from asperity.schema import Attribute, Entry, contact, provenance, rolling, spectra
from asperity.spectra import a_weighted_total

POINTS_PER_DECADE = 40
"""Wavenumbers at which filters are compared."""
NO_VALUE = "the run does not have it"
DEVIATION = "level_deviation"
MAIN = "main law"
"""Stands for the first law of each run where those differ."""


@dataclass(frozen=True, eq=False)
class NamedRun:
    """The result of a run, and what it is called beside the others."""

    name: str
    tree: DataTree

    @property
    def laws(self) -> list[str]:
        """Laws that have a force, the main one first."""
        return laws(self.tree, rolling.CONTACT_FORCE)


def compared(runs: Sequence[NamedRun], levels: Sequence[Entry], chosen: Sequence[str] = ()) -> xarray.Dataset:
    """Lay quantities of runs side by side, with their differences to the first run.

    Of all their laws, or of those chosen alone.

    Levels are those of the schema that have laws and bands. Of several places on a body the energy mean is
    taken; of several sources each is a level of its own.
    """
    names = _chosen_laws(runs, chosen) if chosen else _law_names(runs)
    found: dict[str, xarray.Variable] = {
        "run": variable("run", np.array([run.name for run in runs]), "1", "run, the first the reference"),
        "law": variable("law", np.array(names), "1", "contact law"),
    }
    found |= _levels(runs, names, levels) | _by_law(runs, names) | _by_run(runs)
    found |= _stiffness(runs) | _filters(runs)
    attrs = {"cases": json.dumps(differing_keys(runs), ensure_ascii=False)}
    return xarray.Dataset(found, attrs=attrs)


def differing_keys(runs: Sequence[NamedRun]) -> list[dict[str, Any]]:
    """Keys of the cases whose values differ: key, note, and the value in each run, None where it has none."""
    held = [{str(item.get("key")): item for item in json_list(r.tree, provenance.PARAMETERS)} for r in runs]
    found = []
    for key in dict.fromkeys(key for items in held for key in items):
        written = [items[key].get("value") if key in items else None for items in held]
        if len(set(map(str, written))) > 1:
            note = next(str(items[key].get("note", "")) for items in held if key in items)
            found.append({"key": key, "note": note, "values": written})
    return found


def _law_names(runs: Sequence[NamedRun]) -> list[str]:
    """All laws of the runs; before them the main law, where it is not the same in all."""
    every = list(dict.fromkeys(law for run in runs for law in run.laws))
    mains = {run.laws[0] for run in runs if run.laws}
    return [MAIN, *every] if len(mains) > 1 else every


def _chosen_laws(runs: Sequence[NamedRun], chosen: Sequence[str]) -> list[str]:
    held = list(dict.fromkeys(law for run in runs for law in run.laws))
    for law in chosen:
        if law not in held:
            raise InputError("law", shown(law), f"a law of the runs: {', '.join(held)}", nearest(law, held))
    return list(dict.fromkeys(chosen))


def _own_name(run: NamedRun, law: str, held: Sequence[str]) -> str | None:
    """What a law of the comparison is called in a run; None where the run lacks it."""
    if law == MAIN:
        law = run.laws[0] if run.laws else ""
    return law if law in held else None


# --- levels


def _levels(
    runs: Sequence[NamedRun], names: Sequence[str], entries: Sequence[Entry]
) -> dict[str, xarray.Variable]:
    """Levels by run, law and band, A-weighted totals, and what chance makes of a level."""
    pieces = {label: held for entry in entries for label, held in _level_pieces(runs, entry).items()}
    places = sorted({place for held in pieces.values() for level in held if level for place in level.places})
    if not places:
        return {}
    band = np.array([10.0 ** (place / 10.0) for place in places])
    found = {"band": variable("band", band, "Hz", spectra.BAND.long_name)}
    for (name, meaning, units), held in pieces.items():
        numbers = np.full((len(runs), len(names), len(band)), np.nan)
        for r, (run, level) in enumerate(zip(runs, held, strict=True)):
            for k, law in enumerate(names):
                own = None if level is None else _own_name(run, law, level.laws)
                if level is not None and own is not None:
                    at = np.searchsorted(places, level.places)
                    numbers[r, k, at] = level.values[level.laws.index(own)]
        found |= _with_difference(name, ("run", "law", "band"), numbers, units, meaning)
        found |= _weighted(name, numbers, band, units, meaning)
    deviation = np.full((len(runs), len(band)), np.nan)
    for r, run in enumerate(runs):
        if present(run.tree, spectra.LEVEL_DEVIATION, spectra.BAND):
            at = np.searchsorted(places, _places(values(run.tree, spectra.BAND)))
            inside = at < len(band)
            deviation[r, at[inside]] = values(run.tree, spectra.LEVEL_DEVIATION)[inside]
    meaning = "standard deviation of a level by the chance of one record"
    return found | {DEVIATION: _variable(("run", "band"), deviation, "dB", meaning)}


@dataclass(frozen=True, eq=False)
class _Level:
    """A level of one run, laws over bands."""

    laws: list[str]
    places: list[int]  # tenths of decades, from 1 Hz
    values: NDArray[np.float64]  # (laws, bands)


def _places(centres: NDArray[np.float64]) -> list[int]:
    return [int(place) for place in np.rint(10.0 * np.log10(centres))]


def _level_pieces(runs: Sequence[NamedRun], entry: Entry) -> dict[tuple[str, str, str], list[_Level | None]]:
    """A level of all runs by name, meaning and units: one, or one for each source that has words."""
    held = [_pieces_of(run.tree, entry) for run in runs]
    names = dict.fromkeys(name for pieces in held for name in pieces)
    return {
        (name, meaning, entry.units): [pieces.get((name, meaning)) for pieces in held]
        for name, meaning in names
    }


def _pieces_of(tree: DataTree, entry: Entry) -> dict[tuple[str, str], _Level]:
    found = stored_variable(tree, entry)
    if found is None:
        return {}
    band = entry.dims[-1]
    places, names = _places(found[band].values), [str(law) for law in found["law"].values]
    others = [dim for dim in found.dims if dim not in ("law", band)]
    for dim in others:
        if found[dim].dtype.kind == "U":
            return {
                (f"{entry.name}_{word}", f"{entry.long_name}, {word}"): _Level(
                    names, places, found.sel({dim: word}).transpose("law", band).values
                )
                for word in map(str, found[dim].values)
            }
    meaning = entry.long_name + (", energy mean of the places" if others else "")
    return {(entry.name, meaning): _Level(names, places, _energy_mean(found, others, band))}


def _energy_mean(level: DataArray, dims: Sequence[Any], band: str) -> NDArray[np.float64]:
    power = 10.0 ** (level / 10.0)
    with np.errstate(divide="ignore"):
        mean = 10.0 * np.log10(power.mean(dims).transpose("law", band).values)
    return np.asarray(mean if dims else level.transpose("law", band).values, dtype=float)


def _weighted(
    name: str, level: NDArray[np.float64], band: NDArray[np.float64], units: str, meaning: str
) -> dict[str, xarray.Variable]:
    """A-weighted totals, and their differences over the bands that a run shares with the first."""
    total = a_weighted_total(level, band)
    shared = np.isfinite(level) & np.isfinite(level[:1])
    own, first = (
        a_weighted_total(np.where(shared, each, np.nan), band)
        for each in (level, np.broadcast_to(level[:1], level.shape))
    )
    weighted, what = units.replace("dB", "dB(A)"), f"A-weighted {meaning}"
    return {
        f"{name}_a": _variable(("run", "law"), total, weighted, f"{what}, all bands of the run"),
        f"{name}_a_difference": _variable(
            ("run", "law"), own - first, "dB", f"{what}, less that of the first run, over the bands of both"
        ),
    }


def _with_difference(
    name: str, dims: tuple[str, ...], numbers: NDArray[np.float64], units: str, meaning: str
) -> dict[str, xarray.Variable]:
    return {
        name: _variable(dims, numbers, units, meaning),
        f"{name}_difference": _variable(
            dims, numbers - numbers[:1], "dB", f"{meaning}, less that of the first run"
        ),
    }


def _variable(
    dims: tuple[str, ...], numbers: NDArray[np.float64], units: str, meaning: str
) -> xarray.Variable:
    finite = np.where(np.isfinite(numbers), numbers, np.nan)
    told = {} if np.isfinite(finite).all() else {"missing": NO_VALUE}
    return variable(dims, finite, units, meaning, **told)


# --- numbers by law and by run


def _by_law(runs: Sequence[NamedRun], names: Sequence[str]) -> dict[str, xarray.Variable]:
    """Mean, rms and peak of the force, and the loss of contact."""
    force = {
        "mean_force": ("mean contact force", np.nanmean),
        "rms_force": ("rms of the contact force about its mean", np.nanstd),
        "peak_force": ("largest contact force", np.nanmax),
    }
    lost = (rolling.CONTACT_LOSS_SHARE, rolling.CONTACT_LOSS_EVENTS, rolling.LONGEST_LOSS)
    found = {}
    for name, (meaning, reduce) in force.items():
        numbers = _collected(runs, names, rolling.CONTACT_FORCE, reduce)
        found[name] = _variable(("run", "law"), numbers, "N", meaning)
    for entry in lost:
        numbers = _collected(runs, names, entry, lambda value: value)
        found[entry.name] = _variable(("run", "law"), numbers, entry.units, entry.long_name)
    return found


def _collected(runs: Sequence[NamedRun], names: Sequence[str], entry: Entry, reduce: Any) -> Any:
    numbers = np.full((len(runs), len(names)), np.nan)
    for r, run in enumerate(runs):
        held = laws(run.tree, entry)
        for k, law in enumerate(names):
            own = _own_name(run, law, held)
            if own is not None:
                dims = [dim for dim in entry.dims[1:] if dim != rolling.CONTACT.name]
                numbers[r, k] = float(reduce(of_law(run.tree, entry, own, *dims)))
    return numbers


OF_CONTACT = (
    contact.WORKING_LOAD,
    contact.WORKING_APPROACH,
    contact.WORKING_STIFFNESS,
    contact.CONTACT_AREA_RATIO,
)
"""Attributes of the reduced contact that are compared."""


def _by_run(runs: Sequence[NamedRun]) -> dict[str, xarray.Variable]:
    """Numbers of the contact under the load; of the stiffness also 20 lg of the ratio."""
    found = {entry.name: _attribute_of(runs, entry) for entry in OF_CONTACT}
    stiffness = found[contact.WORKING_STIFFNESS.name].values
    ratio = 20.0 * np.log10(stiffness / stiffness[0])
    name = f"{contact.WORKING_STIFFNESS.name}_difference"
    meaning = f"{contact.WORKING_STIFFNESS.meaning}: 20 lg of the ratio to the first run"
    return {**found, name: _variable(("run",), ratio, "dB", meaning)}


def _attribute_of(runs: Sequence[NamedRun], entry: Attribute) -> xarray.Variable:
    held = [number(run.tree, entry) for run in runs]
    numbers = np.array([np.nan if value is None else value for value in held])
    return _variable(("run",), numbers, entry.units, entry.meaning)


# --- the contact over approach and wavenumber


def _stiffness(runs: Sequence[NamedRun]) -> dict[str, xarray.Variable]:
    """k_c of all runs at the approaches of all, straight between those of the run and missing beyond."""
    held = [
        _finite(values(run.tree, contact.APPROACH), values(run.tree, contact.STIFFNESS))
        if present(run.tree, contact.APPROACH, contact.STIFFNESS)
        else None
        for run in runs
    ]
    every = [pair[0] for pair in held if pair is not None and len(pair[0])]
    if not every:
        return {}
    approach = np.unique(np.concatenate(every))
    numbers = np.stack([_between(approach, pair) for pair in held])
    with np.errstate(divide="ignore", invalid="ignore"):
        ratio = 20.0 * np.log10(numbers / numbers[:1])
    meaning = "contact stiffness F/r, mean of the samples"
    return {
        "approach": variable("approach", approach, "m", contact.APPROACH.long_name),
        "stiffness": _variable(("run", "approach"), numbers, contact.STIFFNESS.units, meaning),
        "stiffness_difference": _variable(
            ("run", "approach"), ratio, "dB", f"{meaning}: 20 lg of the ratio to the first run"
        ),
    }


def _filters(runs: Sequence[NamedRun]) -> dict[str, xarray.Variable]:
    """Magnitude of the contact filter of all runs at the working approach, in dB."""
    held = [working_filter(run.tree) for run in runs]
    every = [pair[0] for pair in held if pair is not None and len(pair[0])]
    if not every:
        return {}
    low, high = (
        np.log10(edge) * POINTS_PER_DECADE for edge in (min(k[0] for k in every), max(k[-1] for k in every))
    )
    wavenumber = 10.0 ** (np.arange(np.ceil(low - 1e-9), np.floor(high + 1e-9) + 1) / POINTS_PER_DECADE)
    logs = [None if pair is None else (np.log(pair[0]), pair[1]) for pair in held]
    level = np.stack([_between(np.log(wavenumber), pair) for pair in logs])
    meaning = "magnitude of the fitted contact filter at the working approach"
    return {
        "wavenumber": variable("wavenumber", wavenumber, "1/m", contact.WAVENUMBER.long_name),
        **_with_difference("filter", ("run", "wavenumber"), level, "dB", meaning),
    }


def working_filter(tree: DataTree) -> tuple[NDArray[np.float64], NDArray[np.float64]] | None:
    """Wavenumbers and magnitude in dB of a run's filter at the working approach.

    Between the states around it the magnitude goes straight, as the filtered texture does when it is rolled
    over. None without a filter.
    """
    working = number(tree, contact.WORKING_APPROACH)
    if working is None or not present(tree, contact.FILTER, contact.APPROACH, contact.WAVENUMBER):
        return None
    magnitude = values(tree, contact.FILTER, "approach", "wavenumber")
    wavenumber = values(tree, contact.WAVENUMBER)
    states = np.isfinite(magnitude).any(axis=1)
    approach = values(tree, contact.APPROACH)[states]
    at = np.array([np.interp(working, approach, column) for column in magnitude[states].T])
    kept = np.isfinite(at) & (at > 0.0) & (wavenumber > 0.0)
    return wavenumber[kept], 20.0 * np.log10(at[kept])


def _finite(
    x: NDArray[np.float64], y: NDArray[np.float64]
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    kept = np.isfinite(y)
    return x[kept], y[kept]


def _between(
    x: NDArray[np.float64], pair: tuple[NDArray[np.float64], NDArray[np.float64]] | None
) -> NDArray[np.float64]:
    """Values of a run at other places, NaN beyond its own."""
    if pair is None or not len(pair[0]):
        return np.full(len(x), np.nan)
    return np.interp(x, *pair, left=np.nan, right=np.nan)
