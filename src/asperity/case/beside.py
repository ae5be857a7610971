"""A case file with its measured maps and lines beside it, where these stand in memory."""

import io
from typing import Any, NoReturn

import numpy as np

from asperity.case.form import Section, in_toml
from asperity.case.in_memory import described_value
from asperity.errors import InputError
from asperity.surfaces.heightmap import HeightMap, Profile
from asperity.units import written

OF_ARRAYS = {"file": ("pixel", "height_unit"), "line": ("line_spacing", "line_unit")}
"""Keys that a section has for the distance of the points of a bare array, and its unit."""


def arrays_and_keys(case: Section, stem: str) -> tuple[dict[str, bytes], dict[str, Any]]:
    """Files of the heights of each surface in memory, by name, and the keys of a case that name them.

    Their names begin with the stem of the case file. An `InputError` names what no array of heights holds:
    a table, say, or points of a map that are not as far apart along as across.
    """
    found: dict[str, bytes] = {}
    spacings: dict[str, float] = {}

    def put_beside(dotted: str, value: Any) -> str:
        heights, spacings[dotted] = _array_of(dotted, value)
        np.save(stream := io.BytesIO(), heights)
        found[name := f"{stem}_{dotted.replace('.', '_')}.npy"] = stream.getvalue()
        return name

    keys = in_toml(case, in_memory=put_beside)
    for dotted, spacing in spacings.items():
        *sections, name = dotted.split(".")
        section = keys
        for title in sections:
            section = section[title]
        of_points, unit = OF_ARRAYS[name]
        section |= {of_points: written(spacing, "m", "um", exactly=True), unit: "m"}
    return found, keys


def _array_of(dotted: str, value: Any) -> tuple[np.ndarray, float]:
    """Heights, m, of a map, of maps of one size or of a line, and the distance of their points, m."""
    surfaces = value if isinstance(value, tuple) else (value,)
    if dotted.rpartition(".")[2] not in OF_ARRAYS:
        refused(dotted, value)
    if not all(isinstance(each, HeightMap | Profile) for each in surfaces):
        refused(dotted, value)
    spacings = {float(step) for each in surfaces for step in np.atleast_1d(each.spacing)}
    if len(spacings) > 1 or len({each.shape for each in surfaces}) > 1:
        refused(dotted, value)
    heights = [each.heights for each in surfaces]
    return np.stack(heights) if len(heights) > 1 else heights[0], spacings.pop()


def refused(dotted: str, value: object) -> NoReturn:
    """Refuse to write a case of something that stands in memory."""
    remedy = 'Save it first, as np.save("map.npy", heights), and name the file in the case.'
    if isinstance(value, HeightMap | Profile):
        remedy += ' case.save("case.toml") does both of a map or a line whose points are equally far apart.'
    raise InputError(dotted, described_value(value), "a file, where a case shall be written", remedy)
