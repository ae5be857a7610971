"""What differs between runs: keys of their cases, levels, stiffness, filters, in one dataset."""

import json
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import xarray

from asperity.arguments import Array
from asperity.reporting import data
from asperity.results import variable
from asperity.schema import Entry, bearing, contact, provenance, rolling, spectra
from asperity.spectra import a_weighted_total, level_of, third_octave_numbers

POINTS_PER_DECADE = 40
"""Wavenumbers at which filters are compared."""
NO_VALUE = "the run does not have it"
ALL_BANDS = ", all bands of the run"
HARD_TO_KNOW = ("wheel",)
"""Sources of a total of which it may be unknown how they radiate."""
UNLIKE, UNLIKE_RUNS = "the total of one of both is without its wheel", "without_wheel"
"""Why totals are not compared, and the attribute that names the runs."""
DEVIATION = "level_deviation"
MAIN = "main law"
"""Stands for the first law of each run where those differ."""
_WORKING = (contact.WORKING_LOAD, contact.WORKING_APPROACH, contact.WORKING_STIFFNESS)
OF_CONTACT = (*_WORKING, contact.CONTACT_AREA_RATIO)
"""Attributes of the reduced contact that are compared."""
RATIOS = (contact.WORKING_STIFFNESS.name, "stiffness", bearing.BAND_VELOCITY.name)
"""Quantities of which 20 lg of the ratio is told in place of the difference."""
CHOSEN_CELLS = "contact.rim_cells"
"""Key of which runs may differ where none gives it: `contact.RIM_CELLS` says what was chosen."""
Variables = dict[str, xarray.Variable]
Curve = tuple[Array, Array]


@dataclass(frozen=True, eq=False)
class NamedRun:
    """The result of a run, and what it is called beside the others."""

    name: str
    tree: xarray.DataTree

    @property
    def laws(self) -> list[str]:
        """Laws that have a force, or its levels, the main one first."""
        return data.laws(self.tree, rolling.CONTACT_FORCE) or data.laws(self.tree, spectra.FORCE_LEVEL)


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

    def another_texture(self, run: int) -> bool:
        """Whether another texture was drawn for a run than for the first: differences hold the chance of it.

        On a part that both have drawn; a run of a program that does not tell drew another one.
        """
        first, own = (data.json_attribute(self.runs[i].tree, provenance.DRAWN, {}) for i in (0, run))
        untold = [data.stated(self.runs[i].tree, provenance.DRAWN) is None for i in (0, run)]
        if untold[0] != untold[1]:
            return bool(first or own)
        return any(first[part] != own[part] for part in first.keys() & own.keys())

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
    pieces = [_of_run(run, levels, main=MAIN in laws) for run in runs]
    told = {str(name): values.attrs for piece in pieces for name, values in piece.data_vars.items()}
    table = xarray.concat(pieces, "run", data_vars="all", join="outer", combine_attrs="drop")
    found = _with_differences(table.reindex(law=laws)[list(told)].assign(run=[r.name for r in runs]), told)
    found = found.assign({n: each for entry in levels for n, each in _unlike(found, entry).items()})
    found.attrs["cases"] = json.dumps(_differing_keys(runs), ensure_ascii=False)
    own = {
        entry: [n for n in told if f"{n}_a" in told and (n == entry.name or n.startswith(f"{entry.name}_"))]
        for entry in levels
    }
    shown = {each[-1]: str(told[each[-1]]["long_name"]) for each in own.values() if each}
    return ComparedRuns(runs, found, {n: what.partition(", energy mean")[0] for n, what in shown.items()})


def _unlike(table: xarray.Dataset, entry: Entry) -> Variables:
    """Differences of a total of several sources without those of runs of which alone, or not, all is known.

    A total that lacks its wheel, say, is no quieter than one that has it: it is another quantity.
    """
    whole, *parts = (f"{entry.name}_{word}" for word in ("total", *HARD_TO_KNOW))
    known = [table[part].notnull().any(("law", "band")).values for part in parts if part in table]
    if whole not in table or not known:
        return {}
    all_known = np.all(known, axis=0)
    has_total = table[whole].notnull().any(("law", "band")).values
    unlike = has_total & (all_known != all_known[0])
    if not unlike.any():
        return {}
    found = {}
    without = ", ".join(table["run"].values[has_total & ~all_known].tolist())
    for name in (f"{whole}_difference", f"{whole}_a_difference"):
        kept = table[name].where(xarray.DataArray(~unlike, dims="run"))
        told = {"missing": f"{NO_VALUE}; or {UNLIKE}", UNLIKE_RUNS: without}
        found[name] = kept.transpose(*table[name].dims).variable.copy()
        found[name].attrs = table[name].attrs | told
    return found


def _differing_keys(runs: Sequence[NamedRun]) -> list[dict[str, Any]]:
    """Keys that differ; of different kinds of case those that all have, for the others say little."""
    held = [{str(i.get("key")): i for i in data.json_list(r.tree, provenance.PARAMETERS)} for r in runs]
    found = []
    for key in dict.fromkeys(key for items in held for key in items):
        written = [items[key].get("value") if key in items else None for items in held]
        if len(set(map(str, written))) > 1:
            note = next(str(items[key].get("note", "")) for items in held if key in items)
            found.append({"key": key, "note": note, "values": written})
    if not any(item["key"] == CHOSEN_CELLS for item in found):
        cells = [data.stated(run.tree, contact.RIM_CELLS) for run in runs]
        if len({*cells} - {None}) > 1:
            found.append({"key": CHOSEN_CELLS, "note": "chosen by the texture", "values": cells})
    of_kinds = any(item["key"] == provenance.KIND.name for item in found)
    return [item for item in found if not of_kinds or None not in item["values"]]


def _of_run(run: NamedRun, levels: Sequence[Entry], *, main: bool) -> xarray.Dataset:
    """Quantities of one run by law, place of a band, approach, and step of the wavenumber.

    The `main` law stands under this name as well, where runs differ in it.
    """
    tree = run.tree
    found = dict[str, xarray.DataArray]()

    def add(name: str, values: xarray.DataArray, units: str, meaning: str) -> None:
        found[name] = values.reset_coords(drop=True).assign_attrs(units=units, long_name=meaning)

    for entry in levels:
        for name, meaning, level in _pieces(tree, entry):
            add(name, level, entry.units, meaning)
            total = xarray.DataArray(a_weighted_total(level, _centres(level)), {"law": level["law"]})
            units = entry.units.replace("dB", "dB(A)")
            add(f"{name}_a", total, units, f"A-weighted {meaning}{ALL_BANDS}")
    if levels and data.present(tree, spectra.LEVEL_DEVIATION, spectra.BAND):
        meaning = "standard deviation of a level by the chance of one record"
        add(DEVIATION, _placed(data.variable_of(tree, spectra.LEVEL_DEVIATION)), "dB", meaning)
    for name, (numbers, units, meaning) in data.contact_numbers(tree).items():
        add(name, numbers, units, meaning)
    for of in OF_CONTACT:
        number = data.number(tree, of)
        add(of.name, xarray.DataArray(np.nan if number is None else number), of.units, of.meaning)
    if data.present(tree, bearing.BAND_VELOCITY):
        velocity = data.variable_of(tree, bearing.BAND_VELOCITY).isel({bearing.SENSOR.name: 0})
        meaning = f"{bearing.BAND_VELOCITY.long_name}, first sensor"
        add(bearing.BAND_VELOCITY.name, velocity, bearing.BAND_VELOCITY.units, meaning)
    if data.present(tree, contact.APPROACH, contact.STIFFNESS):
        stiffness = data.variable_of(tree, contact.STIFFNESS).dropna("approach")
        meaning = "contact stiffness F/r, mean of the samples"
        add("stiffness", stiffness, contact.STIFFNESS.units, meaning)
    if (curve := working_filter(tree)) is not None:
        wavenumber, magnitude = curve
        low, high = np.log10(wavenumber[[0, -1]]) * POINTS_PER_DECADE
        step = np.arange(np.ceil(low - 1e-9), np.floor(high + 1e-9) + 1)
        there = np.interp(np.log(10.0 ** (step / POINTS_PER_DECADE)), np.log(wavenumber), magnitude)
        meaning = "magnitude of the fitted contact filter at the working approach"
        add("filter", xarray.DataArray(there, {"step": step}), "dB", meaning)
    held = xarray.Dataset(found)
    if main and run.laws:
        held = xarray.concat([held.sel(law=run.laws[:1]).assign_coords(law=[MAIN]), held], "law", "minimal")
    return held


def _with_differences(table: xarray.Dataset, told: Mapping[str, Mapping[str, str]]) -> xarray.Dataset:
    """Quantities of all runs by band and wavenumber, and what they differ by from those of the first."""
    axes = {"run": ("run", "1", "run, the first the reference"), "law": ("law", "1", "contact law")}
    if "place" in table.dims:
        table = table.assign_coords(place=_centres(table))
        axes["place"] = ("band", "Hz", spectra.BAND.long_name)
    if "step" in table.dims:
        table = table.assign_coords(step=10.0 ** (table["step"] / POINTS_PER_DECADE))
        axes["step"] = ("wavenumber", "1/m", contact.WAVENUMBER.long_name)
    if bearing.JUDGED_BAND.name in table.dims:
        axes[bearing.JUDGED_BAND.name] = (bearing.JUDGED_BAND.name, "1", bearing.JUDGED_BAND.long_name)
    if "approach" in table.dims:
        table["stiffness"] = table["stiffness"].interpolate_na("approach")
        axes["approach"] = ("approach", "m", contact.APPROACH.long_name)
    found: Variables = {
        name: variable(name, table[dim].values, units, meaning)
        for dim, (name, units, meaning) in axes.items()
    }
    for name, attrs in told.items():
        values = table[name].values
        dims = [axes[str(dim)][0] for dim in table[name].dims]
        found[name] = _variable(dims, values, attrs["units"], attrs["long_name"])
        less = values - values[:1]
        how = f"{attrs['long_name']}, less that of the first run"
        if name in RATIOS:
            with np.errstate(divide="ignore", invalid="ignore"):
                less = 20.0 * np.log10(values / values[:1])
            how = f"{attrs['long_name']}: 20 lg of the ratio to the first run"
        elif (level := name.removesuffix("_a")) in told and level != name:
            by_band = table[level].values
            bands = table["place"].values
            shared = np.isfinite(by_band) & np.isfinite(by_band[:1])
            own, first = (np.where(shared, each, np.nan) for each in (by_band, by_band[:1]))
            less = a_weighted_total(own, bands) - a_weighted_total(first, bands)
            meaning = attrs["long_name"].removesuffix(ALL_BANDS)
            how = f"{meaning}, less that of the first run, over the bands of both"
        elif f"{name}_a" not in told and name != "filter":
            continue
        found[f"{name}_difference"] = _variable(dims, less, "dB", how)
    return xarray.Dataset(found)


def _variable(dims: Sequence[str], numbers: Array, units: str, meaning: str) -> xarray.Variable:
    finite = np.where(np.isfinite(numbers), numbers, np.nan)
    missing = {} if np.isfinite(finite).all() else {"missing": NO_VALUE}
    return variable(dims, finite, units, meaning, **missing)


def _centres(found: xarray.Dataset | xarray.DataArray) -> Array:
    """Centres of bands, Hz, by their places."""
    return np.array([10.0 ** (place / 10.0) for place in found["place"].values.tolist()])


def _placed(found: xarray.DataArray) -> xarray.DataArray:
    """Numbers by the places of their bands, in tenths of decades from 1 Hz."""
    band = found.dims[-1]
    return found.rename({band: "place"}).assign_coords(
        place=third_octave_numbers(found[band].values).astype(int)
    )


def _pieces(tree: xarray.DataTree, entry: Entry) -> Iterator[tuple[str, str, xarray.DataArray]]:
    """Levels of a run by law and place, with name and meaning: one, or one for each source that has words."""
    if not data.present(tree, entry):
        return
    found = _placed(data.variable_of(tree, entry))
    others = [dim for dim in found.dims if dim not in ("law", "place")]
    for dim in (dim for dim in others if found[dim].dtype.kind == "U"):
        for word in map(str, found[dim].values):
            name = f"{entry.name}_{word.replace(' ', '_')}"
            yield name, f"{entry.long_name}, {word}", found.sel({dim: word})
        return
    if others:
        mean = (10.0 ** (found / 10.0)).mean(others).transpose("law", "place")
        found = mean.copy(data=level_of(mean.values))
    yield entry.name, entry.long_name + (", energy mean of the places" if others else ""), found


def working_filter(tree: xarray.DataTree) -> Curve | None:
    """Wavenumbers and magnitude in dB of a run's filter at the working approach.

    Between the states around it the magnitude goes straight, as the filtered texture does when it is rolled
    over. None without a filter.
    """
    working = data.number(tree, contact.WORKING_APPROACH)
    if working is None or not data.present(tree, contact.FILTER, contact.APPROACH, contact.WAVENUMBER):
        return None
    magnitude = data.values(tree, contact.FILTER)
    wavenumber = data.values(tree, contact.WAVENUMBER)
    states = np.isfinite(magnitude).any(axis=1)
    approach = data.values(tree, contact.APPROACH)[states]
    at = np.array([np.interp(working, approach, column) for column in magnitude[states].T])
    kept = np.isfinite(at) & (at > 0.0) & (wavenumber > 0.0)
    return (wavenumber[kept], 20.0 * np.log10(at[kept])) if kept.any() else None
