"""A comparison of runs in words and as one table."""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping, Sequence
from typing import Any

import numpy as np
import xarray
from numpy.typing import NDArray

from asperity.reporting.comparison import DEVIATION, NamedRun
from asperity.reporting.data import stated
from asperity.reporting.tables import signed
from asperity.schema import provenance
from asperity.spectra import nominal_frequency

KIND = "kind"
"""Key that names the kind of a case."""
SURE = 2.0
"""Standard deviation of a difference by chance, dB, from which a band says little."""


def table_rows(runs: Sequence[NamedRun], table: xarray.Dataset) -> tuple[list[str], list[list[object]]]:
    """Heading and rows of everything that is compared: a column for each run and each difference."""
    names = [run.name for run in runs]
    heading = ["what", "quantity", "law", "at", "unit", *names]
    heading += ["unit of the difference", *(f"{name} - {names[0]}" for name in names[1:])]
    blank = [""] * len(runs)
    rows: list[list[object]] = []
    for item in json.loads(table.attrs["cases"]):
        written = ["" if value is None else str(value) for value in item["values"]]
        rows.append(["case", item["key"], "", "", "", *written, *blank])
    for attribute in (provenance.VERDICT, provenance.ASPERITY_VERSION, provenance.CREATED):
        rows.append(
            ["run", attribute.name, "", "", "", *(str(stated(r.tree, attribute) or "") for r in runs), *blank]
        )
    for name in map(str, table.data_vars):
        if not name.endswith("_difference"):
            rows += _rows_of(table, name)
    return heading, rows


def _rows_of(table: xarray.Dataset, name: str) -> Iterator[list[object]]:
    """A quantity at each place, in all runs, and its differences: those kept, or plain ones."""
    held = table[name]
    kept = table.get(f"{name}_difference")
    what = {"approach": "contact", "wavenumber": "filter", "band": "level"}
    place = next((str(dim) for dim in held.dims if dim not in ("run", "law")), "")
    own = [dim for dim in held.dims if dim != "run"]
    for index in np.ndindex(*(held.sizes[dim] for dim in own)):
        at = dict(zip(own, index, strict=True))
        numbers = held.isel(at).values
        if not np.isfinite(numbers).any():
            continue
        less = (numbers - numbers[0] if kept is None else kept.isel(at).values)[1:].tolist()
        own_units = str(held.attrs["units"]) if kept is None else str(kept.attrs["units"])
        if name == DEVIATION:
            own_units, less = "", [""] * len(less)
        law = str(table["law"].values[at["law"]]) if "law" in at else ""
        where = f"{float(table[place][at[place]]):.6g} {table[place].attrs['units']}" if place else ""
        kind = what.get(place, "contact" if not law else "level" if name.endswith("_a") else "force")
        units = str(held.attrs["units"])
        yield [kind, name, law, where, units, *numbers.tolist(), own_units, *less]


def listed_keys(table: xarray.Dataset) -> list[dict[str, Any]]:
    """Keys that differ; of cases of different kinds only those that all have, for the others say little."""
    items: list[dict[str, Any]] = json.loads(table.attrs["cases"])
    if not any(item["key"] == KIND for item in items):
        return items
    return [item for item in items if None not in item["values"]]


def summary(runs: Sequence[NamedRun], table: xarray.Dataset, levels: Mapping[str, str]) -> str:
    """Say in a few sentences how the runs after the first differ from it, by their first law.

    Of the levels, by name with what they are, the first and the last: the force, and what it makes.
    """
    names = list(dict.fromkeys([*list(levels)[:1], *list(levels)[-1:]]))
    first = runs[0].name
    keys = [str(item["key"]) for item in listed_keys(table)]
    sentences = [_keys_sentence(keys)]
    law = str(table["law"].values[0]) if table.sizes["law"] else ""
    for r, run in enumerate(runs[1:], 1):
        told = [words for name in names if (words := _level_words(table, name, levels[name], r))]
        if told:
            sentences.append(f"{run.name} against {first}, {law}: {'; '.join(told)}")
    return ". ".join(sentences) + "."


def _keys_sentence(keys: Sequence[str]) -> str:
    if not keys:
        return "The cases are the same"
    shown = ", ".join(keys[:4]) + (f" and {len(keys) - 4} more" if len(keys) > 4 else "")
    return f"The cases differ in {shown}"


def _level_words(table: xarray.Dataset, name: str, title: str, run: int) -> str:
    """Range of the differences of a level over the bands that say something, and dB(A)."""
    difference = table[f"{name}_difference"][run, 0].values
    told = np.isfinite(difference) & sure(table, run)
    weighted = float(table[f"{name}_a_difference"][run, 0])
    if not told.any():
        return f"{title} {signed(weighted)} dB(A)" if np.isfinite(weighted) else ""
    band, change = table["band"].values[told], difference[told]
    ends = [
        f"{signed(float(change[i]))} dB ({nominal_frequency(float(band[i]))})"
        for i in (int(change.argmin()), int(change.argmax()))
    ]
    return f"{title} {' to '.join(ends)}, {signed(weighted)} dB(A)"


def chance(table: xarray.Dataset, run: int) -> NDArray[np.float64]:
    """Standard deviation of the level differences of a run to the first by chance, dB (bands,).

    Of records that know nothing of each other; runs over the same texture differ by less.
    """
    deviation = table[DEVIATION].values
    return np.asarray(np.sqrt(deviation[0] ** 2 + deviation[run] ** 2))


def sure(table: xarray.Dataset, run: int) -> NDArray[np.bool_]:
    """Bands whose difference to the first run says something; all where no chance is known."""
    return ~(chance(table, run) >= SURE)
