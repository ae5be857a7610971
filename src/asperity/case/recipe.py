"""A recipe: how a measured file is read and prepared, stored once and named in cases."""

from __future__ import annotations

import os
from pathlib import Path
from typing import Any

from asperity.case.form import Section
from asperity.case.surface import ANGLE, INDEX, LENGTH, POSITION
from asperity.case.toml import read_definition, read_toml, toml_text
from asperity.errors import InputError
from asperity.parameters import key
from asperity.surfaces.heightmap import HeightMap, Profile
from asperity.surfaces.readers import read_surface, read_surfaces
from asperity.surfaces.steps import FORMS, stepped
from asperity.values import Choice, Flag, LengthUnit, ListOf, Origin, Text

STEPS = ("crop", "form", "longest", "shortest", "direction")


class Recipe(Section):
    """How a measured file is read and prepared; steps are taken in the order of these keys."""

    array: str | None = key(Text(), None, "name of the array in a file that holds several")
    index: int | None = key(INDEX, None, "which one of an ensemble of maps, from 0")
    height_unit: str | None = key(LengthUnit(), None, "unit of heights that carry none")
    pixel: float | None = key(LENGTH, None, "spacing of points that carry none")
    pixel_unit: str | None = key(LengthUnit(), None, "unit of coordinates that carry none")
    decimal: str | None = key(Choice((".", ",")), None, "decimal mark of a text")
    spikes: bool = key(Flag(), False, "take spikes for points without a height")
    transpose: bool = key(Flag(), False, "exchange x and y")
    lines: bool | None = key(Flag(), None, "take an array for lines side by side, or for a map")
    fill: bool = key(Flag(), False, "fill points without a height")
    crop: tuple[float, ...] | None = key(
        ListOf(POSITION), None, "x, y and both lengths of the piece of a map that is kept"
    )
    form: str | None = key(Choice(FORMS), None, "form that is removed")
    longest: float | None = key(LENGTH, None, "nesting index of the L-filter: longer waves are removed")
    shortest: float | None = key(LENGTH, None, "nesting index of the S-filter: shorter waves are removed")
    direction: float | None = key(ANGLE, None, "direction of rolling, from x towards y")

    @property
    def steps(self) -> dict[str, Any]:
        """What is done after reading, as `surfaces.steps.stepped` takes it."""
        return {name: getattr(self, name) for name in STEPS}

    @property
    def hints(self) -> dict[str, Any]:
        """What is said of the file, as `read_measured` takes it."""
        found = {name: value for name, value in self.given().items() if name not in STEPS}
        if self.pixel is not None:
            found["pixel"] = f"{self.pixel!r} m"  # whatever the unit of coordinates
        return found

    def surfaces(self, file: Path) -> list[HeightMap | Profile]:
        """Read the map, the line, or all maps of an ensemble, and prepare them."""
        return [stepped(surface, **self.steps) for surface in read_measured(file, **self.hints)]


def read_measured(
    file: Path, *, index: int | None = None, lines: bool | None = None, **hints: Any
) -> list[HeightMap | Profile]:
    """Read the map, the line, or all maps of an ensemble; hints are as `read_surface` takes them."""
    if index is not None:
        return [read_surface(file, index=index, lines=lines, **hints)]
    try:
        return [read_surface(file, lines=lines, **hints)]
    except InputError as error:
        if error.allowed != "one sample":
            raise
    return list(read_surfaces(file, **hints))


def read_recipe(path: str | os.PathLike[str]) -> Recipe:
    """Read a recipe from a TOML file, as ``asperity surface FILE --store recipe.toml`` writes it."""
    return Recipe.read(typed_recipe(path), Origin.file(path))


def typed_recipe(path: str | os.PathLike[str]) -> dict[str, Any]:
    """Keys and values of a recipe as they stand in its file."""
    remedy = "Check the path, or store one with 'asperity surface FILE --store recipe.toml'."
    return read_toml(read_definition(path, "recipe", remedy), "recipe", path)


def recipe_text(typed: dict[str, Any]) -> str:
    """Write keys and values as the text of a file that `read_recipe` reads."""
    head = '# How a measured surface is read and prepared: recipe = "…" in [surface] of a case\n'
    return head + toml_text(typed)
