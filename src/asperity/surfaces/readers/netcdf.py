"""NetCDF-4 through h5netcdf."""

from pathlib import Path
from typing import Any

import numpy as np

from asperity.arguments import Array, listed, require, shown
from asperity.surfaces.readers import arrays, guards
from asperity.surfaces.readers.hints import Hints
from asperity.units import factor

MAX_COMPRESSION = 1000  # deflate reaches 1032; more is an array that was never written


def read(path: Path, hints: Hints) -> list[guards.Surface]:
    """Read the variable of a netCDF-4 file that the hints name (``group/variable`` in a group).

    Without a name it is ``heights`` or the only variable with dimensions that is no coordinate. The dimension
    called ``x`` becomes the first axis of the map, whatever their order in the file; without that name,
    dimensions are taken as (x, y), or (sample, x, y). Spacing is taken from coordinate variables, units from
    the ``units`` attributes; points are put in the order of rising coordinates. The other hints stand for
    what is not stated.
    """
    import h5netcdf

    with h5netcdf.File(path, "r") as opened:
        variable = _chosen(opened, hints.array, path.name)
        source, item_bytes = f"{path.name}:{variable.name.lstrip('/')}", variable.dtype.itemsize
        guards.check_claim(source, variable.shape, item_bytes / MAX_COMPRESSION, path.stat().st_size)
        heights = _decoded(variable, hints.heights_in(source, _unit(variable)), source)
        names = [name.rpartition("/")[2] for name in variable.dimensions]
        within = variable.name.strip("/").rpartition("/")[0]
        group, steps = opened[within] if within else opened, []
        for axis, name in enumerate(names[-2:], -len(names[-2:])):
            if hints.pixel is None and name in group.variables:
                index, step = _placed(group.variables[name], hints, source, name)
                heights = np.take(heights, np.argsort(index), axis)
                steps.append(step)
        if len(names) > 1 and names[-1].lower() == "x":
            heights, steps = np.swapaxes(heights, -1, -2), steps[::-1]
        spacing = (steps[0], steps[-1]) if len(steps) == len(names[-2:]) else None
        return guards.surfaces_of(heights, hints.spacing_in(source, spacing), source)


def _chosen(opened: Any, name: str | None, source: str) -> Any:
    candidates = [n for n, v in opened.variables.items() if v.ndim and n not in opened.dimensions]
    if name is None:
        name = "heights" if "heights" in candidates else arrays.only_one(candidates, source)
    try:
        variable = opened[name]
    except KeyError:
        variable = None
    is_variable = hasattr(variable, "dimensions") and hasattr(variable, "dtype")
    allowed = f"one of: {listed(candidates)}, or group/variable"
    require(is_variable, f"array in {source}", shown(name), allowed, "Choose one.")
    return variable


def _unit(variable: Any) -> float | None:
    unit = variable.attrs.get("units")
    return factor(unit, "m") if isinstance(unit, str) else None


def _decoded(variable: Any, unit: float, source: str) -> Array:
    """Apply the conventional attributes for missing values, scale and offset."""
    raw, attributes = np.asarray(variable[...]), variable.attrs
    heights = guards.scaled(raw, 1.0, source)
    for name in ("_FillValue", "missing_value"):
        if name in attributes:
            heights[np.isin(raw, attributes[name])] = np.nan
    scale, offset = attributes.get("scale_factor", 1.0), attributes.get("add_offset", 0.0)
    return (heights * float(np.ravel(scale)[0]) + float(np.ravel(offset)[0])) * unit


def _placed(coordinate: Any, hints: Hints, source: str, name: str) -> tuple[arrays.Index, float]:
    """Places of points along one axis, none left out, and their distance, m."""
    what = f"{name} of {source}"
    unit = hints.lateral_in(what, _unit(coordinate), "um", "Give it, as in", "Add the units attribute.")
    values = np.asarray(coordinate[...], dtype=np.float64)
    index, step = arrays.places(values, what, np.diff(np.sort(values)))
    require(len(values) == index.max() + 1, what, arrays.UNEVEN, "a point at each place", arrays.RESAMPLE)
    return index, step * unit
