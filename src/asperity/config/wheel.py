"""The wheel of a case: its mass, load, shape, resonances and texture."""

from __future__ import annotations

import math
from collections.abc import Iterator
from pathlib import Path
from typing import Annotated

from pydantic import BeforeValidator

from asperity.config.keys import (
    Choice,
    ChoiceOrFile,
    ExistingFile,
    Force,
    Length,
    LengthOrInfinite,
    Level,
    Mass,
    Position,
    Section,
    key,
)
from asperity.config.railway_textures import TABLE_OF_LEVELS, MeasuredLines, problems_of_table
from asperity.config.sections import Material
from asperity.config.tables import read_levels, read_modes, read_receptance
from asperity.errors import InputError

WHEEL_ROUGHNESS = ("cast-iron", "composite", "disc")
DEEPEST_FLAT = 0.01  # of the wheel's radius

WheelRoughness = Annotated[str | Path, BeforeValidator(ChoiceOrFile(WHEEL_ROUGHNESS, TABLE_OF_LEVELS))]


class WheelBody(Section):
    """The wheel without its texture: a mass under a constant load, its shape and its resonances."""

    radius: Length = key("0.46 m", "rolling radius")
    mass: Mass = key("600 kg", "mass on the contact, unsprung")
    load: Force = key("65 kN", "static contact force, weight included")
    material: Material = key("steel", "material")
    transverse_radius: LengthOrInfinite = key("inf", "radius of the tread across the rail")
    profile: ExistingFile | None = key(
        None,
        "measured shape of the tread across the rail, instead of transverse_radius",
        example='"tread.csv"',
    )
    modes: ExistingFile | None = key(
        None,
        "table of the wheel's modes: frequency (Hz), damping ratio, modal mass (kg)",
        otherwise="a rigid wheel",
        example='"modes.csv"',
    )
    receptance: ExistingFile | None = key(
        None,
        "table of the wheel's receptance: frequency (Hz), real and imaginary part (m/N)",
        otherwise="a rigid wheel",
        example='"receptance.csv"',
    )

    @property
    def circumference(self) -> float:
        """Length of the tread around the wheel in m."""
        return 2 * math.pi * self.radius

    def problems_of_body(self) -> Iterator[InputError]:
        """One shape, and one set of resonances."""
        for one, other in (("profile", "transverse_radius"), ("modes", "receptance")):
            if {one, other} <= self.model_fields_set:
                yield InputError("", f"both {one} and {other}", "one of them", "Remove one.")
        yield from problems_of_table(self, "modes", read_modes)
        yield from problems_of_table(self, "receptance", read_receptance)


class WheelCase(MeasuredLines, WheelBody):
    """The wheel: a body, and the texture of its tread."""

    roughness: WheelRoughness | None = key(
        None, "one-third-octave wavelength spectrum of the tread", example='"disc"'
    )
    roughness_level: Level = key("+0 dB", "level added to it", goes_with="roughness")
    flat_depth: Length | None = key(None, "depth of a flat on the tread", example='"0.5 mm"')
    flat_shape: Annotated[str, BeforeValidator(Choice(("fresh", "worn")))] = key(
        "fresh", "a chord with sharp ends, or rounded", goes_with="flat_depth"
    )
    flat_position: Position = key(
        "0 m",
        "where the flat is on the tread, along the circumference from the point that touches at start",
        goes_with="flat_depth",
    )

    @property
    def has_texture(self) -> bool:
        """Whether the tread has any texture or defect."""
        return self.roughness is not None or self.line is not None or self.flat_depth is not None

    def problems(self) -> Iterator[InputError]:
        """A sound body, one source of texture, and a flat that is small against the wheel."""
        yield from self.problems_of_body()
        yield from self.problems_of_lines()
        if self.roughness is not None and self.line is not None:
            yield InputError("", "both roughness and line", "one of them", "Remove one.")
        deepest = DEEPEST_FLAT * self.radius
        if self.flat_depth is not None and self.flat_depth > deepest:
            received = f"{self.flat_depth * 1e3:g} mm"
            allowed = f"at most {DEEPEST_FLAT:g} of the radius, {deepest * 1e3:g} mm"
            yield InputError("flat_depth", received, allowed)
        if self.flat_depth is not None and self.flat_position >= self.circumference:
            allowed = f"less than the circumference, {self.circumference:.4g} m"
            yield InputError("flat_position", f"{self.flat_position:g} m", allowed)
        yield from problems_of_table(self, "roughness", read_levels)
