"""One table of all members of a study: swept keys as dimensions, rows and columns, what is shown of it."""

import json
import re
from collections import Counter
from collections.abc import Iterable, Iterator, Mapping, Sequence
from itertools import product
from typing import Any

import numpy as np
import xarray

from asperity import __version__
from asperity.arguments import NDArray, nearest, shown
from asperity.case.in_memory import described_value
from asperity.errors import CoarseSamplingWarning, Grade, InputError
from asperity.reporting.data import typed_unit, typed_values
from asperity.results import variable
from asperity.scenes.schema import SHOWN, TOTALS
from asperity.schema import bearing, contact, rolling, spectra
from asperity.studies.definition import Member, Study
from asperity.studies.member import CHOSEN_CELLS, Failure, names_kept
from asperity.written_numbers import count_of


def tabulated(
    study: Study,
    members: Sequence[Member],
    results: Mapping[tuple[int, ...], xarray.Dataset],
    failures: Mapping[tuple[int, ...], Failure],
) -> xarray.Dataset:
    """Put results and failures of the members of a study together, by their places on the axes.

    The swept keys are the first dimensions of every variable; NaN where a member failed or has no such value.
    Attributes: version, case, swept values, citations, warnings and failures.
    """
    swept = [axis.name for axis in study.axes]
    ordered = [(member.index, results[member.index]) for member in members if member.index in results]
    coordinates = _coordinates([table for _, table in ordered])
    variables = {axis.name: axis.variable for axis in study.axes}
    variables |= coordinates
    completed = np.zeros(study.shape, dtype=np.int8)
    for index, _ in ordered:
        completed[index] = 1
    variables["completed"] = variable(swept, completed, "1", "whether the member was computed")
    variables |= _drawn(study, members)
    for name, first in _first_of_each([table for _, table in ordered]).items():
        sizes = [coordinates[str(dim)].size for dim in first.dims]
        values = np.full((*study.shape, *sizes), np.nan)
        for index, table in ordered:
            if name in table:
                places = [_places(coordinates[str(dim)], table[dim].values) for dim in first.dims]
                here: tuple[Any, ...] = (*index, ...)
                values[here][np.ix_(*places)] = table[name].values
        gaps = {} if np.isfinite(values).all() else {"missing": "the member failed, or has no such value"}
        variables[name] = xarray.Variable((*swept, *first.dims), values, first.attrs | gaps)
    return xarray.Dataset(variables, attrs=_attributes(study, members, ordered, failures))


def _drawn(study: Study, members: Sequence[Member]) -> dict[str, xarray.Variable]:
    """Numbers that were drawn for each member, in SI, the mean of a speed that wanders; words stand in its
    case."""
    swept = [axis.name for axis in study.axes]
    found = {}
    for draw in study.draws:
        values = np.full(study.shape, np.nan)
        for member in members:
            if draw.name in member.drawn:
                values[member.index] = draw.number(member.drawn[draw.name])
        if np.isfinite(values).any():
            gaps = {} if np.isfinite(values).all() else {"missing": "the case does not have it"}
            told = draw.entry.unit or "1", draw.entry.key.meaning
            found[draw.name] = variable(swept, values, *told, **gaps)
    return found


def _first_of_each(tables: Sequence[xarray.Dataset]) -> dict[str, xarray.Variable]:
    """Each quantity as the first member has it that has it at all."""
    found: dict[str, xarray.Variable] = {}
    for table in tables:
        for name in table.data_vars:
            found.setdefault(str(name), table[name].variable)
    return found


def _coordinates(tables: Sequence[xarray.Dataset]) -> dict[str, xarray.Variable]:
    """Coordinates that hold those of all members: numbers in order, words as they come."""
    found: dict[str, xarray.Variable] = {}
    for name in dict.fromkeys(str(dim) for table in tables for dim in table.dims):
        having = [table[name] for table in tables if name in table.dims]
        labels: dict[Any, Any] = {}
        for values in having:
            for value in values.values.tolist():
                labels.setdefault(_label(value), value)
        union = list(labels.values())
        if not isinstance(union[0], str):
            union.sort()
        found[name] = xarray.Variable(name, np.array(union), having[0].attrs)
    return found


def _label(value: Any) -> Any:
    """Tell coordinates apart, but for the rounding of numbers."""
    return float(f"{value:.9g}") if isinstance(value, float) else value


def _places(coordinate: xarray.Variable, values: NDArray[Any]) -> list[int]:
    order = {_label(value): place for place, value in enumerate(coordinate.values.tolist())}
    return [order[_label(value)] for value in values.tolist()]


def _attributes(
    study: Study,
    members: Sequence[Member],
    ordered: Sequence[tuple[tuple[int, ...], xarray.Dataset]],
    failures: Mapping[tuple[int, ...], Failure],
) -> dict[str, str]:
    citations = dict.fromkeys(c for _, table in ordered for c in json.loads(table.attrs["citations"]))
    return {
        "asperity_version": __version__,
        "case": study.text,
        "sweep": _json(study.sweep),
        "draw": _json(study.drawn),
        "citations": _json(list(citations)),
        "warnings": _json(_warnings([table for _, table in ordered])),
        "failures": _json(_grouped(members, failures)),
    }


def _json(value: object) -> str:
    return json.dumps(value, ensure_ascii=False, default=described_value)


def _warnings(tables: Sequence[xarray.Dataset]) -> list[dict[str, Any]]:
    """Warnings that differ in more than their numbers, with the number of members that have them."""
    groups: dict[tuple[str, str], dict[str, Any]] = {}
    for table in tables:
        met = {_kind(w["category"], w["message"]): w for w in json.loads(table.attrs["warnings"])}
        for kind, warning in met.items():
            start = {key: warning[key] for key in ("category", "message", "grade") if key in warning}
            groups.setdefault(kind, start | {"members": 0})["members"] += 1
    return [*_of_cells(tables), *groups.values()]


def _of_cells(tables: Sequence[xarray.Dataset]) -> Iterator[dict[str, Any]]:
    """A warning where cells at rims were chosen otherwise for some members than for others."""
    cells = Counter(table.attrs[CHOSEN_CELLS] for table in tables if CHOSEN_CELLS in table.attrs)
    if len(cells) > 1:
        covered = sum(cells.values()) - cells["whole"]
        message = (
            f"cells at rims are covered in {count_of(covered, 'member')} and whole in {cells['whole']}, as "
            "their textures are smooth within the contact or not: between these kinds "
            "levels differ by the grid, too, by some tenths of a dB. Set contact.rim_cells to one of both."
        )
        grade = {"category": CoarseSamplingWarning.__name__, "grade": Grade.WARNING.value}
        yield grade | {"message": message, "members": sum(cells.values())}


def _grouped(members: Sequence[Member], failures: Mapping[tuple[int, ...], Failure]) -> list[dict[str, Any]]:
    """Failures that differ in more than their numbers, with the members that have them."""
    groups: dict[tuple[str, str], dict[str, Any]] = {}
    for member in members:
        if (failure := failures.get(member.index)) is not None:
            kind = _kind(failure.error, failure.message)
            groups.setdefault(kind, vars(failure) | {"members": []})["members"].append(member.label)
    return list(groups.values())


def _kind(name: str, message: str) -> tuple[str, str]:
    return name, re.sub(r"[-+−]?\d[\d.]*(?:e[-+]?\d+)?", "#", message)


Rows = tuple[list[str], list[list[object]]]
"""Heading, and rows of numbers and words."""


def axes_of(table: xarray.Dataset) -> list[str]:
    """Swept keys that the table still has, and the law."""
    return [name for name in (*json.loads(table.attrs["sweep"]), "law") if name in table.dims]


def columns_of(table: xarray.Dataset, scatter: xarray.Dataset | None = None, *, bands: bool = True) -> Rows:
    """Heading and rows of a study, one for each member and law; with or without what has bands.

    Behind each mean stands its scatter, where there is any.
    """
    axes = axes_of(table)
    shown = list[tuple[str, xarray.DataArray]]()
    for name, values in table.data_vars.items():
        shown += [(str(name), values)] + ([] if scatter is None else [(f"± {name}", scatter[name])])
    shown = [each for each in shown if bands or not _has_bands(each[1])]
    held = [each for each in shown if len(set(each[1].dims) - {*axes}) <= 1]
    return _laid_out(table, axes, sorted(held, key=lambda each: _has_bands(each[1])))


def long_columns(table: xarray.Dataset, axes: Sequence[str]) -> Rows:
    """Heading and rows of what has all these axes, one row for each place on them."""
    held = [(str(name), values) for name, values in table.data_vars.items() if {*values.dims} == {*axes}]
    return _laid_out(table, axes, held)


def _laid_out(
    table: xarray.Dataset, axes: Sequence[str], shown: Sequence[tuple[str, xarray.DataArray]]
) -> Rows:
    """A row for each place on the axes; quantities have some of them, and at most one dimension beside."""
    heading = [key_title(table[axis]) for axis in axes]
    chosen: list[tuple[list[str], NDArray[Any]]] = []
    for name, values in shown:
        own = [axis for axis in axes if axis in values.dims]
        chosen.append((own, values.transpose(*own, ...).values))
        heading += _titles(name, values, [str(dim) for dim in values.dims if dim not in axes])
    labels = {axis: typed_values(table[axis]) for axis in axes}
    rows: list[list[object]] = []
    for places in product(*(range(table.sizes[axis]) for axis in axes)):
        here = dict(zip(axes, places, strict=True))
        row: list[object] = [labels[axis][place] for axis, place in here.items()]
        for own, numbers in chosen:
            row += np.atleast_1d(numbers[tuple(here[axis] for axis in own)]).tolist()
        rows.append(row)
    return heading, rows


def _has_bands(values: xarray.DataArray) -> bool:
    return any(str(dim).endswith("band") for dim in values.dims)


def _titles(name: str, values: xarray.DataArray, others: Sequence[str]) -> list[str]:
    units = values.attrs["units"]
    if not others:
        return [f"{name} [{units}]"]
    place = values[others[0]]
    unit = "" if place.attrs["units"] == "1" else str(place.attrs["units"])
    words = [
        each if isinstance(each, str) else f"{each:.6g} {unit}".strip() for each in place.values.tolist()
    ]
    return [f"{name} {word} [{units}]" for word in words]


def key_title(key: xarray.DataArray) -> str:
    """Heading of an axis, with the unit in which its values were typed."""
    unit = typed_unit(key)
    return f"{key.name} [{unit}]" if unit else str(key.name)


WEIGHTED = f"{spectra.FORCE_LEVEL.name}_a"
OVER = f"{WEIGHTED}_difference_to_"
"""Beginning of the names of differences, which are printed, and drawn where they are asked for."""
_FIRST = (WEIGHTED, f"{OVER}linear_filtered", f"{OVER}linear")
_THEN = (
    contact.TRACK_RMS.name,
    contact.YIELDED_SHARE.name,
    contact.RUNNING_IN_LOWERING.name,
    contact.TRACK_STIFFNESS.name,
    "rms_force",
    "peak_force",
    rolling.CONTACT_LOSS_SHARE.name,
)


USUAL = (*_FIRST, *SHOWN, *_THEN, *bearing.SHOWN)
"""Names of what a study shows unasked, where its table has it."""
LOUDNESS = (*(entry.name for entry in TOTALS), WEIGHTED)
"""Names of the levels of which a sentence says where they are lowest and highest, the first that there is."""
USUAL_IN_FIGURES = tuple(name for name in USUAL if not name.startswith((OVER, bearing.LINES_FOUND.name)))
"""Names of what its figures show unasked."""


def chosen(words: Iterable[str]) -> tuple[str, ...]:
    """Names that words of the command line ask for, each word with commas between names.

    Spaces may stand for underscores, as in the headings that are printed.
    """
    known = names_kept()
    names = ["_".join(name.split()) for word in words for name in word.split(",")]
    for name in names:
        if name not in known:
            raise InputError("--show", shown(name), _listed(sorted(known)), nearest(name, list(known)))
    return tuple(dict.fromkeys(names))


def _listed(names: Sequence[str]) -> str:
    return f"names of what a study keeps: {', '.join(names)}"
