"""The wheel of a case: its mass, load, shape, resonances and texture."""

from __future__ import annotations

import math
from collections.abc import Iterator
from pathlib import Path
from typing import Annotated

import numpy as np
from numpy.typing import NDArray

from asperity.config import values
from asperity.config.form import Section, key, optional
from asperity.config.tables import TABLE_OF_LEVELS, problems_of_table, read_levels
from asperity.errors import InputError
from asperity.kinds.wheel_on_rail.surface_keys import MeasuredLines
from asperity.scenes.tables import read_modes, read_receptance
from asperity.structures.body import GRAVITY
from asperity.units import written

WHEEL_ROUGHNESS = ("cast-iron", "composite", "disc")
DEEPEST_FLAT = 0.01  # of the wheel's radius
CLOSE_LENGTH = 0.05  # by which a measured length may differ from that of the chord

WheelRoughness = Annotated[
    str | Path | NDArray[np.float64],
    values.ChoiceOrFile(WHEEL_ROUGHNESS, TABLE_OF_LEVELS, columns=2),
]
TableFile = Annotated[Path | NDArray[np.float64], values.File(columns=3)]
ModesFile = Annotated[Path | NDArray[np.float64], values.File(columns=3, further=3)]


class FlatKeys(Section):
    """What rolls on its tread, and a flat on it."""

    radius: values.Length

    flat_depth: values.Length | None = optional(
        "0.5 mm",
        "depth of a flat on the tread, which direct and table see; with flat_length alone, that of its chord",
        within="10 nm to 100 mm: flats lie between",
    )
    flat_length: values.Length | None = optional(
        "43 mm",
        "length of the flat: that of its chord, sqrt(8 radius flat_depth); a worn one may be longer",
        within="10 um to 1 m: flats lie between",
    )
    flat_shape: Annotated[str, values.Choice(("fresh", "worn"))] = key(
        "fresh", "a chord with sharp ends, or rounded", goes_with="flat_depth or flat_length"
    )
    flat_position: values.Position | None = optional(
        "1 m",
        "where the flat is on the tread, along the circumference from the point that touches at start",
        "half a turn on, or half of the record if that is shorter, so that no impact is cut",
        "0 m to 100 m: wheels are smaller",
        goes_with="flat_depth or flat_length",
    )

    @property
    def circumference(self) -> float:
        """Length of the tread around the wheel in m."""
        return 2 * math.pi * self.radius

    @property
    def flat(self) -> tuple[float, float] | None:
        """Depth and length of the flat in m; None without one."""
        depth, length = self.flat_depth, self.flat_length
        if depth is None:
            return None if length is None else (self._chord_depth(length), length)
        chord = math.sqrt(8.0 * self.radius * depth)
        return depth, chord if length is None or self.flat_shape == "fresh" else max(length, chord)

    def _chord_depth(self, length: float) -> float:
        return length**2 / (8.0 * self.radius)

    def problems_of_flat(self) -> Iterator[InputError]:
        """A flat that is small against the wheel, and whose length belongs to its depth."""
        if self.flat is None:
            return
        deepest = DEEPEST_FLAT * self.radius
        allowed = f"at most {DEEPEST_FLAT:g} of the radius, {written(deepest, 'm', 'mm')}"
        if self.flat_depth is None:
            longest = math.sqrt(8.0 * self.radius * deepest)
            if self.flat[1] > longest:
                allowed = f"at most {longest * 1e3:.4g} mm, where the depth of its chord is {allowed}"
                yield InputError("flat_length", written(self.flat[1], "m", "mm"), allowed)
        elif self.flat_depth > deepest:
            yield InputError("flat_depth", written(self.flat_depth, "m", "mm"), allowed)
        elif self.flat_length is not None:
            yield from self._problem_of_both(self.flat_depth, self.flat_length)
        if self.flat_position is not None and self.flat_position >= self.circumference:
            allowed = f"less than the circumference, {self.circumference:.4g} m"
            yield InputError("flat_position", f"{self.flat_position:g} m", allowed)

    def _problem_of_both(self, depth: float, length: float) -> Iterator[InputError]:
        """A fresh flat is a chord; a worn one is at least as long, and at most as the wheel's radius."""
        chord = math.sqrt(8.0 * self.radius * depth)
        worn = self.flat_shape == "worn"
        longest = self.radius if worn else chord * (1.0 + CLOSE_LENGTH)
        if chord * (1.0 - CLOSE_LENGTH) <= length <= longest:
            return
        allowed = f"{chord * 1e3:.4g} mm, the chord sqrt(8 radius flat_depth), within {CLOSE_LENGTH:.0%}"
        remedy = f"The chord of this length is {self._chord_depth(length) * 1e3:.3g} mm deep."
        if worn:
            allowed = f"{chord * 1e3:.4g} mm, the chord sqrt(8 radius flat_depth), to the wheel's radius"
        elif length > chord:
            remedy += ' A worn flat may be longer: flat_shape = "worn".'
        received = f"{written(length, 'm', 'mm')} beside a depth of {written(depth, 'm', 'mm')}"
        yield InputError("flat_length", received, allowed, remedy)


class WheelBody(Section):
    """The wheel without its texture: a mass under a constant load, its shape and its resonances."""

    radius: values.Length = key("0.46 m", "rolling radius", "10 mm to 10 m: wheels lie between")
    mass: values.Mass = key("600 kg", "mass on the contact, unsprung", "1 kg to 100 t: wheels lie between")
    load: values.Force = key(
        "65 kN", "static contact force, weight included", "1 N to 10 MN: wheels on rails carry as much"
    )
    material: values.OwnOrNamed = key("steel", "material")
    transverse_radius: values.LengthOrInfinite = key(
        "inf", "radius of the tread across the rail", '1 mm to 100 km: beyond that it is flat: write "inf"'
    )
    profile: values.SectionFile | None = optional(
        "tread.csv", "measured shape of the tread across the rail, instead of transverse_radius"
    )
    modes: ModesFile | None = optional(
        "modes.csv",
        "table of the wheel's modes: frequency (Hz), damping ratio, modal mass (kg); its sound needs three "
        "columns more: number of nodal diameters, and rms axial velocity of the disc and rms radial velocity "
        "of the tread, both per radial velocity at the contact",
        "a rigid wheel",
    )
    receptance: TableFile | None = optional(
        "receptance.csv",
        "table of the wheel's receptance: frequency (Hz), real and imaginary part (m/N)",
        "a rigid wheel",
    )

    def problems_of_body(self) -> Iterator[InputError]:
        """One shape, one set of resonances, and a load that holds the wheel's own weight."""
        if self.load < (weight := GRAVITY * self.mass) * (1.0 - 1e-9):
            allowed = f"at least {written(weight, 'N', 'kN')}, the weight of {self.mass:g} kg on the contact"
            remedy = "Loads include the wheel's own weight: give the load in kN, or a lighter wheel."
            yield InputError("load", written(self.load, "N", "kN"), allowed, remedy)
        for one, other in (("profile", "transverse_radius"), ("modes", "receptance")):
            if {one, other} <= self.model_fields_set:
                yield InputError("", f"both {one} and {other}", "one of them", "Remove one.")
        yield from problems_of_table(self, "modes", read_modes)
        yield from problems_of_table(self, "receptance", read_receptance)


class WheelCase(MeasuredLines, WheelBody, FlatKeys):
    """The wheel: a body, and the texture of its tread."""

    roughness: WheelRoughness | None = optional("disc", "one-third-octave wavelength spectrum of the tread")
    roughness_level: values.Level = key(
        "+0 dB",
        "level added to it",
        "-120 dB to 120 dB: a million times is another texture",
        goes_with="roughness",
    )

    @property
    def has_texture(self) -> bool:
        """Whether the tread has any texture or defect."""
        return self.roughness is not None or self.line is not None or self.flat is not None

    def problems(self) -> Iterator[InputError]:
        """A sound body, one source of texture, and a flat that is small against the wheel."""
        yield from self.problems_of_body()
        yield from self.problems_of_line()
        yield from self.problems_of_processing()
        if self.roughness is not None and self.line is not None:
            yield InputError("", "both roughness and line", "one of them", "Remove one.")
        yield from self.problems_of_flat()
        yield from problems_of_table(self, "roughness", read_levels)
