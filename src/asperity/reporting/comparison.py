"""What differs between runs: keys of their cases, levels, stiffness, filters, in one dataset."""

import json
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import xarray

from asperity.reporting import chart, data
from asperity.results import variable
from asperity.schema import Attribute, Entry, contact, provenance, rolling, spectra
from asperity.spectra import a_weighted_total, level_of

POINTS_PER_DECADE = 40
"""Wavenumbers at which filters are compared."""
NO_VALUE = "the run does not have it"
DEVIATION = "level_deviation"
MAIN = "main law"
"""Stands for the first law of each run where those differ."""
_REDUCED: tuple[Callable[[Any], Any], ...] = (np.nanmean, np.nanstd, np.nanmax)
OF_FORCE: Mapping[str, tuple[str, Entry, Callable[[Any], Any]]] = {
    name: (what, rolling.CONTACT_FORCE, reduce)
    for (name, what), reduce in zip(rolling.FORCES.items(), _REDUCED, strict=True)
} | {entry.name: (entry.long_name, entry, float) for entry in rolling.LOSSES}
"""Numbers of each law: what they are, what they are taken from, and how."""
_WORKING = (contact.WORKING_LOAD, contact.WORKING_APPROACH, contact.WORKING_STIFFNESS)
OF_CONTACT = (*_WORKING, contact.CONTACT_AREA_RATIO)
"""Attributes of the reduced contact that are compared."""
Variables = dict[str, xarray.Variable]
Curve = tuple[chart.Numbers, chart.Numbers]


@dataclass(frozen=True, eq=False)
class NamedRun:
    """The result of a run, and what it is called beside the others."""

    name: str
    tree: xarray.DataTree

    @property
    def laws(self) -> list[str]:
        """Laws that have a force, the main one first."""
        return data.laws(self.tree, rolling.CONTACT_FORCE)


@dataclass(frozen=True, eq=False)
class ComparedRuns:
    """Runs, the first of them the reference, and what was compared."""

    runs: Sequence[NamedRun]
    table: xarray.Dataset
    levels: Mapping[str, str]  # that a page shows: their names, and what they are

    @property
    def names(self) -> list[str]:
        """What the runs are called."""
        return [run.name for run in self.runs]

    @property
    def laws(self) -> list[str]:
        """Laws that are compared, the main one first."""
        return [str(law) for law in self.table["law"].values]

    @property
    def keys(self) -> list[dict[str, Any]]:
        """Keys that differ: key, note, and the value in each run, None where it has none."""
        found: list[dict[str, Any]] = json.loads(self.table.attrs["cases"])
        return found


def compared(runs: Sequence[NamedRun], levels: Sequence[Entry]) -> ComparedRuns:
    """Lay quantities of runs side by side, with their differences to the first run.

    Levels are those of the schema that have laws and bands. Of several places on a body the energy mean is
    taken; of several sources each is a level of its own, and the last of them, their sum, is shown.
    """
    every = list(dict.fromkeys(law for run in runs for law in run.laws))
    mains = {run.laws[0] for run in runs if run.laws}
    laws = [MAIN, *every] if len(mains) > 1 else every
    found = {
        "run": variable("run", np.array([run.name for run in runs]), "1", "run, the first the reference"),
        "law": variable("law", np.array(laws), "1", "contact law"),
    }
    found |= _levels(runs, laws, levels) | _of_laws(runs, laws) | _of_contacts(runs)
    found |= _stiffness(runs) | _filters(runs)
    attrs = {"cases": json.dumps(_differing_keys(runs), ensure_ascii=False)}
    table = xarray.Dataset(found, attrs=attrs)
    own = {
        entry: [n for n in found if f"{n}_a" in found and (n == entry.name or n.startswith(f"{entry.name}_"))]
        for entry in levels
    }
    told = {each[-1]: found[each[-1]].attrs["long_name"] for each in own.values() if each}
    return ComparedRuns(runs, table, {n: str(what).partition(", energy mean")[0] for n, what in told.items()})


def _differing_keys(runs: Sequence[NamedRun]) -> list[dict[str, Any]]:
    """Keys that differ; of different kinds of case those that all have, for the others say little."""
    held = [{str(i.get("key")): i for i in data.json_list(r.tree, provenance.PARAMETERS)} for r in runs]
    found = []
    for key in dict.fromkeys(key for items in held for key in items):
        written = [items[key].get("value") if key in items else None for items in held]
        if len(set(map(str, written))) > 1:
            note = next(str(items[key].get("note", "")) for items in held if key in items)
            found.append({"key": key, "note": note, "values": written})
    of_kinds = any(item["key"] == provenance.KIND.name for item in found)
    return [item for item in found if not of_kinds or None not in item["values"]]


def _by_law(
    runs: Sequence[NamedRun], laws: Sequence[str], held: Sequence[xarray.DataArray | None], **places: Any
) -> chart.Numbers:
    """Numbers of runs by the laws of the comparison, and at common places; NaN where a run lacks them."""
    rows = []
    for run, found in zip(runs, held, strict=True):
        own = [next(iter(run.laws), "") if law == MAIN else law for law in laws]
        empty = np.full((len(laws), *map(len, places.values())), np.nan)
        rows.append(empty if found is None else found.reindex(law=own, **places).values)
    return np.stack(rows)


def _variable(dims: Sequence[str], numbers: chart.Numbers, units: str, meaning: str) -> xarray.Variable:
    finite = np.where(np.isfinite(numbers), numbers, np.nan)
    told = {} if np.isfinite(finite).all() else {"missing": NO_VALUE}
    return variable(("run", *dims), finite, units, meaning, **told)


def _with_difference(
    name: str, dims: Sequence[str], numbers: chart.Numbers, units: str, meaning: str, *, ratio: bool = False
) -> Variables:
    """Numbers of runs, and their differences to the first, or 20 lg of their ratios to it."""
    with np.errstate(divide="ignore", invalid="ignore"):
        less = 20.0 * np.log10(numbers / numbers[:1]) if ratio else numbers - numbers[:1]
    how = ": 20 lg of the ratio to the first run" if ratio else ", less that of the first run"
    return {
        name: _variable(dims, numbers, units, meaning),
        f"{name}_difference": _variable(dims, less, "dB", f"{meaning}{how}"),
    }


# --- levels


def _levels(runs: Sequence[NamedRun], laws: Sequence[str], entries: Sequence[Entry]) -> Variables:
    """Levels by run, law and band, A-weighted totals, and what chance makes of a level."""
    pieces: dict[tuple[str, str, str], list[xarray.DataArray | None]] = {}
    for entry in entries:
        for r, run in enumerate(runs):
            for name, meaning, level in _pieces(run.tree, entry):
                pieces.setdefault((name, entry.units, meaning), [None] * len(runs))[r] = level
    every = (level for held in pieces.values() for level in held if level is not None)
    places = sorted({int(place) for level in every for place in level["place"]})
    if not places:
        return {}
    band = np.array([10.0 ** (place / 10.0) for place in places])
    found = {"band": variable("band", band, "Hz", spectra.BAND.long_name)}
    for (name, units, meaning), held in pieces.items():
        numbers = _by_law(runs, laws, held, place=places)
        found |= _with_difference(name, ("law", "band"), numbers, units, meaning)
        found |= _weighted(name, numbers, band, units, meaning)
    deviation = [
        _placed(data.variable_of(run.tree, spectra.LEVEL_DEVIATION)).reindex(place=places).values
        if data.present(run.tree, spectra.LEVEL_DEVIATION, spectra.BAND)
        else np.full(len(places), np.nan)
        for run in runs
    ]
    meaning = "standard deviation of a level by the chance of one record"
    return found | {DEVIATION: _variable(("band",), np.array(deviation), "dB", meaning)}


def _placed(found: xarray.DataArray) -> xarray.DataArray:
    """Numbers by the places of their bands, in tenths of decades from 1 Hz."""
    band = found.dims[-1]
    places = np.rint(10.0 * np.log10(found[band].values)).astype(int)
    return found.rename({band: "place"}).assign_coords(place=places)


def _pieces(tree: xarray.DataTree, entry: Entry) -> Iterator[tuple[str, str, xarray.DataArray]]:
    """Levels of a run by law and place, with name and meaning: one, or one for each source that has words."""
    if not data.present(tree, entry):
        return
    found = _placed(data.variable_of(tree, entry))
    others = [dim for dim in found.dims if dim not in ("law", "place")]
    for dim in (dim for dim in others if found[dim].dtype.kind == "U"):
        for word in map(str, found[dim].values):
            yield f"{entry.name}_{word}", f"{entry.long_name}, {word}", found.sel({dim: word})
        return
    if others:
        mean = (10.0 ** (found / 10.0)).mean(others).transpose("law", "place")
        found = mean.copy(data=level_of(mean.values))
    yield entry.name, entry.long_name + (", energy mean of the places" if others else ""), found


def _weighted(name: str, level: chart.Numbers, band: chart.Numbers, units: str, meaning: str) -> Variables:
    """A-weighted totals, and their differences over the bands that a run shares with the first."""
    shared = np.isfinite(level) & np.isfinite(level[:1])
    own, first = (a_weighted_total(np.where(shared, each, np.nan), band) for each in (level, level[:1]))
    what, total = f"A-weighted {meaning}", a_weighted_total(level, band)
    told = f"{what}, less that of the first run, over the bands of both"
    weighted = _variable(("law",), total, units.replace("dB", "dB(A)"), f"{what}, all bands of the run")
    return {f"{name}_a": weighted, f"{name}_a_difference": _variable(("law",), own - first, "dB", told)}


# --- numbers by law and by run


def _of_laws(runs: Sequence[NamedRun], laws: Sequence[str]) -> Variables:
    """Mean, rms and peak of the force, and the loss of contact."""

    def numbers(run: NamedRun, entry: Entry, reduce: Callable[[Any], Any]) -> xarray.DataArray | None:
        names = data.laws(run.tree, entry)
        found = [float(reduce(data.of_law(run.tree, entry, law))) for law in names]
        return xarray.DataArray(found, {"law": names}) if names else None

    found: Variables = {}
    for name, (meaning, entry, reduce) in OF_FORCE.items():
        by_law = _by_law(runs, laws, [numbers(run, entry, reduce) for run in runs])
        found[name] = _variable(("law",), by_law, entry.units, meaning)
    return found


def _of_contacts(runs: Sequence[NamedRun]) -> Variables:
    """Numbers of the contact under the load; of the stiffness also 20 lg of the ratio."""

    def held(of: Attribute) -> chart.Numbers:
        return np.array([np.nan if (n := data.number(r.tree, of)) is None else n for r in runs])

    found = {of.name: _variable((), held(of), of.units, of.meaning) for of in OF_CONTACT}
    of, name = contact.WORKING_STIFFNESS, f"{contact.WORKING_STIFFNESS.name}_difference"
    return found | {name: _with_difference(of.name, (), held(of), "", of.meaning, ratio=True)[name]}


# --- the contact over approach and wavenumber


def _between(x: chart.Numbers, curves: Sequence[Curve | None]) -> chart.Numbers:
    """Curves of all runs at common places (runs, n), straight between their own and NaN beyond."""
    nothing = np.full(len(x), np.nan)
    return np.stack([nothing if c is None else np.interp(x, *c, left=np.nan, right=np.nan) for c in curves])


def _stiffness(runs: Sequence[NamedRun]) -> Variables:
    """k_c of all runs at the approaches of all."""
    held: list[Curve | None] = [None] * len(runs)
    for r, run in enumerate(runs):
        if data.present(run.tree, contact.APPROACH, contact.STIFFNESS):
            x, y = data.values(run.tree, contact.APPROACH), data.values(run.tree, contact.STIFFNESS)
            held[r] = x[np.isfinite(y)], y[np.isfinite(y)]
    every = [curve[0] for curve in held if curve is not None]
    if not every:
        return {}
    approach = np.unique(np.concatenate(every))
    axis = variable("approach", approach, "m", contact.APPROACH.long_name)
    meaning, units = "contact stiffness F/r, mean of the samples", contact.STIFFNESS.units
    numbers = _between(approach, held)
    found = _with_difference("stiffness", ("approach",), numbers, units, meaning, ratio=True)
    return {"approach": axis} | found


def _filters(runs: Sequence[NamedRun]) -> Variables:
    """Magnitude of the contact filter of all runs at the working approach, in dB."""
    held = [working_filter(run.tree) for run in runs]
    every = np.concatenate([np.zeros(0), *(curve[0] for curve in held if curve is not None)])
    if not every.size:
        return {}
    low, high = (np.log10(edge) * POINTS_PER_DECADE for edge in (every.min(), every.max()))
    wavenumber = 10.0 ** (np.arange(np.ceil(low - 1e-9), np.floor(high + 1e-9) + 1) / POINTS_PER_DECADE)
    axis = variable("wavenumber", wavenumber, "1/m", contact.WAVENUMBER.long_name)
    level = _between(np.log(wavenumber), [None if c is None else (np.log(c[0]), c[1]) for c in held])
    meaning = "magnitude of the fitted contact filter at the working approach"
    return {"wavenumber": axis} | _with_difference("filter", ("wavenumber",), level, "dB", meaning)


def working_filter(tree: xarray.DataTree) -> Curve | None:
    """Wavenumbers and magnitude in dB of a run's filter at the working approach.

    Between the states around it the magnitude goes straight, as the filtered texture does when it is rolled
    over. None without a filter.
    """
    working = data.number(tree, contact.WORKING_APPROACH)
    if working is None or not data.present(tree, contact.FILTER, contact.APPROACH, contact.WAVENUMBER):
        return None
    magnitude, wavenumber = data.values(tree, contact.FILTER), data.values(tree, contact.WAVENUMBER)
    states = np.isfinite(magnitude).any(axis=1)
    approach = data.values(tree, contact.APPROACH)[states]
    at = np.array([np.interp(working, approach, column) for column in magnitude[states].T])
    kept = np.isfinite(at) & (at > 0.0) & (wavenumber > 0.0)
    return (wavenumber[kept], 20.0 * np.log10(at[kept])) if kept.any() else None
