"""One table of all members of a study, with the swept keys as dimensions."""

from __future__ import annotations

import json
import re
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
import xarray
from numpy.typing import NDArray

from asperity import __version__
from asperity.config.content import described_value
from asperity.results import variable
from asperity.studies.definition import Member, Study
from asperity.studies.member import Failure


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
    variables: dict[str, xarray.Variable] = {
        axis.name: variable(
            axis.name, axis.coordinate, axis.units, str(axis.entry.field.description), **axis.typed
        )
        for axis in study.axes
    }
    variables |= coordinates
    completed = np.zeros(study.shape, dtype=np.int8)
    for index, _ in ordered:
        completed[index] = 1
    variables["completed"] = variable(swept, completed, "1", "whether the member was computed")
    for name, first in _first_of_each([table for _, table in ordered]).items():
        sizes = [coordinates[str(dim)].size for dim in first.dims]
        values = np.full((*study.shape, *sizes), np.nan)
        for index, table in ordered:
            if name in table:
                places = [_places(coordinates[str(dim)], table[dim].values) for dim in first.dims]
                here: tuple[Any, ...] = (*index, ...)
                values[here][np.ix_(*places)] = table[name].values
        variables[name] = xarray.Variable((*swept, *first.dims), values, first.attrs | _missing(values))
    return xarray.Dataset(variables, attrs=_attributes(study, members, ordered, failures))


def _missing(values: NDArray[Any]) -> dict[str, str]:
    """Say why values of a quantity are missing, where some are."""
    if values.dtype.kind != "f" or np.isfinite(values).all():
        return {}
    return {"missing": "the member failed, or has no such value"}


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
            start["members"] = 0
            groups.setdefault(kind, start)["members"] += 1
    return list(groups.values())


def _grouped(members: Sequence[Member], failures: Mapping[tuple[int, ...], Failure]) -> list[dict[str, Any]]:
    """Failures that differ in more than their numbers, with the members that have them."""
    groups: dict[tuple[str, str], dict[str, Any]] = {}
    for member in members:
        failure = failures.get(member.index)
        if failure is not None:
            start = {"error": failure.error, "message": failure.message, "members": []}
            groups.setdefault(_kind(failure.error, failure.message), start)["members"].append(member.label)
    return list(groups.values())


def _kind(name: str, message: str) -> tuple[str, str]:
    return name, re.sub(r"[-+−]?\d[\d.]*(?:e[-+]?\d+)?", "#", message)
