"""What the user says about a file that does not say it itself; and building surfaces from bare arrays."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, fields
from typing import Any

import numpy as np
from numpy.typing import NDArray

from asperity.arguments import real, shown
from asperity.errors import InputError
from asperity.surfaces.heightmap import HeightMap, Profile
from asperity.surfaces.readers.spelling import advice, spell
from asperity.units import factor, quantity

Surface = HeightMap | Profile
_GIVEN = {"height_factor": "height_unit", "spacing": "pixel", "lateral_factor": "pixel_unit"}
_HEADING = 'Save it as text with a heading, as "{}".'
Length = str | float


@dataclass(frozen=True)
class Hints:
    """Checked hints in SI; None where nothing was said."""

    array: str | None = None  # name of the array, variable or channel to read
    height_factor: float | None = None  # length in m of one unit of the heights
    spacing: tuple[float, float] | None = None  # (dx, dy), m
    lateral_factor: float | None = None  # length in m of one unit of the coordinates
    decimal: str | None = None  # mark of a text file

    def heights_in(self, source: str, stated: float | None = None) -> float:
        """Return the factor of the heights: the hint, else what the file states, else an `InputError`."""
        chosen = self.height_factor or stated
        if chosen is None:
            allowed = "a unit of the heights"
            remedy = advice("height_unit", "um", "Give it, as in", _HEADING.format("z (um)"))
            raise InputError(source, "heights without a unit", allowed, remedy)
        return chosen

    def spacing_in(self, source: str, stated: tuple[float, float] | None = None) -> tuple[float, float]:
        """Return the spacing: the hint, else what the file states, else an `InputError`."""
        chosen = self.spacing or stated
        if chosen is None:
            allowed = "the distance of neighbouring points"
            remedy = advice("pixel", "1.5 um", "Give it, as in", _HEADING.format("# pixel: 1.5 um"))
            raise InputError(source, "heights without a pixel size", allowed, remedy)
        return chosen

    def refuse(self, source: str, kind: str) -> None:
        """Raise an `InputError` if anything was said about a format that states everything itself."""
        said = [field.name for field in fields(self) if getattr(self, field.name) is not None]
        if said:
            allowed = f"no hints, because {kind} files state their lengths and have one array"
            names = ", ".join(spell(_GIVEN.get(name, name)) for name in said)
            raise InputError(f"hints for {source}", names, allowed, "Leave them out.")


def checked_hints(
    array: str | None = None,
    height_unit: Length | None = None,
    pixel: Length | Sequence[Length] | None = None,
    pixel_unit: Length | None = None,
    decimal: str | None = None,
) -> Hints:
    """Convert hints as a user writes them, see `read_surface`, to SI.

    A unit may be given as its length in m; a bare pixel size is in `pixel_unit`, else in m.
    """
    if decimal is not None and decimal not in (".", ","):
        raise InputError("decimal", shown(decimal), '"." or ","', "Give one of these.")
    if array is not None and not isinstance(array, str):
        raise InputError("array", shown(array), "the name of an array", "Write it in quotes.")
    lateral = _unit("pixel_unit", pixel_unit)
    spacing = None if pixel is None else _pair(pixel, lateral or 1.0)
    return Hints(array, _unit("height_unit", height_unit), spacing, lateral, decimal)


def _unit(name: str, unit: Length | None) -> float | None:
    if unit is None:
        return None
    return _positive(name, factor(unit, "m") if isinstance(unit, str) else unit)


def _pair(pixel: Length | Sequence[Length], unit: float) -> tuple[float, float]:
    sizes = list(pixel) if isinstance(pixel, list | tuple | np.ndarray) and np.ndim(pixel) == 1 else [pixel]
    if len(sizes) not in (1, 2):
        raise InputError("pixel", shown(pixel), "one length, or two (dx, dy)", 'Write it as "1.5 um".')
    metres = [quantity(s, "m") if isinstance(s, str) else _positive("pixel", s) * unit for s in sizes]
    return _positive("pixel", metres[0]), _positive("pixel", metres[-1])


def _positive(name: str, value: object) -> float:
    remedy = "Check the number and its unit."
    return real(name, value, "a finite length above zero", above=0.0, remedy=remedy)


def surfaces_of(array: NDArray[Any], spacing: tuple[float, float], source: str) -> list[Surface]:
    """Wrap a bare array of heights, m: one axis is a line, two are a map, x first, three are maps.

    A 2-D array with a single row or column is a line, too: of the spacing (dx, dy), m, one along x takes dx,
    one along y dy.
    """
    if array.ndim == 3 and len(array):
        return [HeightMap(sample, spacing, f"{source}[{i}]") for i, sample in enumerate(array)]
    if array.ndim == 2 and array.shape[0] == 1:
        return [Profile(array[0], spacing[1], source)]
    if array.ndim == 1 or (array.ndim == 2 and array.shape[1] == 1):
        return [Profile(array.ravel(), spacing[0], source)]
    if array.ndim != 2:
        allowed = "1 (a line), 2 (a map) or 3 (an ensemble of maps) axes, none empty"
        remedy = advice("array", "name", "Select one, as in", "Keep one map or line in the file.")
        raise InputError(source, f"an array of shape {array.shape}", allowed, remedy)
    return [HeightMap(array, spacing, source)]


def scaled(array: NDArray[Any], unit: float, source: str) -> NDArray[np.float64]:
    """Return real numbers times the length of their unit, m, as float64."""
    if array.dtype.kind not in "fiu":
        raise InputError(
            source,
            f"data of type {array.dtype}",
            "real numbers",
            advice("array", "name", "Select another one, as in", "Keep numbers alone in the file."),
        )
    with np.errstate(over="ignore", invalid="ignore"):  # infinite heights are refused by name afterwards
        return np.asarray(array.astype(np.float64) * unit)
