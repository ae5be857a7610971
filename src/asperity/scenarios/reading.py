"""Reading the measured files that a case names, with messages that speak of its keys."""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial
from pathlib import Path

from asperity.config.recipe import read_recipe
from asperity.config.sections import MeasuredLine, Surface
from asperity.errors import InputError
from asperity.surfaces.heightmap import HeightMap, Profile
from asperity.surfaces.readers import read_surface, read_surfaces
from asperity.surfaces.readers.spelling import in_case, spelled

_MAP_KEYS = {name: name for name in ("array", "height_unit", "pixel", "index", "fill", "spikes")}
_LINE_KEYS = {"array": "line_array", "height_unit": "line_unit", "pixel": "line_spacing"}


def read_maps(surface: Surface) -> Sequence[HeightMap | Profile]:
    """Read the map, or all maps of an ensemble, that the surface section names, as they lie in the file."""
    assert surface.file is not None
    if not isinstance(surface.file, Path):
        maps = surface.file if isinstance(surface.file, tuple) else (surface.file,)
        if surface.index is not None and surface.index >= len(maps):
            allowed = f"0 to {len(maps) - 1}, of the maps in memory"
            raise InputError("surface.index", surface.index, allowed)
        chosen = maps if surface.index is None else (maps[surface.index],)
        if surface.spikes:
            chosen = tuple(each.without_spikes() for each in chosen)
        return [each.filled() if surface.fill else each for each in chosen]
    if surface.recipe is not None:
        return read_recipe(surface.recipe).read(surface.file)
    with spelled(in_case("surface", _MAP_KEYS)):
        read = read_surfaces if surface.index is None else partial(read_surface, index=surface.index)
        found = read(
            surface.file,
            array=surface.array,
            height_unit=surface.height_unit,
            pixel=surface.pixel,
            fill=surface.fill,
            spikes=surface.spikes,
        )
    return found if isinstance(found, list) else [found]


def read_lines(section: MeasuredLine, name: str) -> HeightMap | Profile:
    """Read the measured line, or lines side by side, that a section of a name has.

    Lines side by side are a map; the distance across is not known to it.
    """
    assert section.line is not None
    if not isinstance(section.line, Path):
        return section.line
    with spelled(in_case(name, _LINE_KEYS)):
        return read_surface(
            section.line, array=section.line_array, height_unit=section.line_unit, pixel=section.line_spacing
        )


def read_section(measured: Path | Profile, key: str) -> Profile:
    """Read a measured section of a body across the path.

    Parameters
    ----------
    measured : Path or Profile
        Its file, or itself.
    key : str
        The key that names it, for messages.

    Returns
    -------
    Profile
        Heights, complete.

    Raises
    ------
    InputError
        If the file does not hold one complete line.
    """
    with spelled(in_case(key.partition(".")[0], {})):
        section = read_surface(measured) if isinstance(measured, Path) else measured
    if not isinstance(section, Profile):
        raise InputError(key, "a map of heights", "one line across the path")
    if section.missing_share > 0.0:
        raise InputError(key, "points without a height", "a complete line", "Interpolate them in the file.")
    return section
