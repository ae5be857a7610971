"""What is rolled over, as texture: measured maps and lines, synthesised roughness, defects on top."""

from collections.abc import Iterator, Mapping
from functools import partial
from pathlib import Path
from typing import Any, ClassVar, TypeVar, cast

import numpy as np

from asperity.arguments import FORMS, Array, FilePath, real_array, require, shown
from asperity.case import tables, toml
from asperity.case.form import Section
from asperity.case.in_memory import holds_memory
from asperity.errors import InputError
from asperity.parameters import (
    ANGLE,
    LENGTH,
    LENGTH_OR_ZERO,
    Choice,
    Either,
    File,
    Flag,
    LengthUnit,
    ListOf,
    Number,
    Origin,
    Problems,
    Quantity,
    Text,
    key,
    optional,
)
from asperity.surfaces.heightmap import HeightMap, Profile
from asperity.surfaces.readers import read_all
from asperity.surfaces.readers.hints import spell
from asperity.surfaces.rotation import rotated
from asperity.units import factor, written
from asperity.written_numbers import count_of

S = TypeVar("S", HeightMap, Profile, HeightMap | Profile)
INDEX = Number(at_least=0, at_most=10**9, whole=True)
LEVELS = tables.TableFile(read=tables.read_levels, columns=(2,), content="a table of wavelengths and levels")
LEVEL = Quantity("dB")
SPECTRA = ("iso3095", "cnossos-average")
_POINTS = "0.1 nm to 10 mm: atoms are 0.1 nm apart, and contacts are smaller than 10 mm"
_MORE_THAN_A_TURN = "-360 deg to 360 deg: more is a full turn and an angle"
of_line, of_file = partial(optional, goes_with="line"), partial(optional, goes_with="file")
ADDED_LEVEL = "-120 dB to 120 dB: a million times is another texture"


DEFECTS = (
    "corrugation",
    "corrugation_wavelength",
    "corrugation_bandwidth",
    "joint_depth",
    "joint_length",
    "joint_position",
)
"""Keys of what is on top of a texture."""
MAP_KEYS = {name: name for name in ("array", "height_unit", "pixel", "index", "fill", "spikes")}
"""Keys of a file with maps, by the hints to its reader that they are."""
OF_RAILS = ("line_distance", "processing", *DEFECTS)
"""Keys of a surface that rails have more often than beams."""


class MeasuredLine(Section):
    """A measured line, or several side by side, and what the file does not say."""

    line: Path | HeightMap | Profile | None = optional(
        File(held=(HeightMap, Profile)), "line.csv", "measured long line, or several side by side"
    )
    line_array: str | None = of_line(
        Text(), "lines", "name of the array in a file that holds several", "the only one"
    )
    line_unit: str | None = of_line(LengthUnit(), "um", "unit of lines that carry none", "from the file")
    line_spacing: float | None = of_line(
        LENGTH, "1 mm", "spacing of points along lines that carry none", "from the file", _POINTS
    )
    line_distance: float | None = of_line(
        LENGTH,
        "5 mm",
        "distance across between neighbouring lines; with it, a single line holds all across",
        "for a single line",
        "1 um to 1 m: lines lie beside each other on one body",
    )
    processing: tuple[str, ...] = key(
        ListOf(Choice(("fill", "spikes", "curvature")), once=True),
        (),
        "steps of EN 15610 that are applied to measured lines",
        goes_with="line",
    )

    @classmethod
    def prepared(cls, given: Mapping[str, Any]) -> Mapping[str, Any]:
        """Take an array of heights with its spacing, (n,) or lines side by side, for what was measured."""
        return surfaces_from(super().prepared(given), "line", "line_spacing", "line_unit", (1, 2))

    def problems(self) -> Iterator[InputError]:
        """A line in memory has its own points."""
        yield from super().problems()
        yield from _foreign(self, "line", ("line_array", "line_unit", "line_spacing"))


class MeasuredMap(Section):
    """A measured map, or an ensemble of them, and what its file does not say."""

    file: Path | HeightMap | tuple[HeightMap, ...] | None = optional(
        File(held=(HeightMap,), several=HeightMap),
        "beam.x3p",
        "measured map: the samples, and the path where it is long enough",
    )
    array: str | None = of_file(
        Text(), "polished", "name of the array in a file that holds several", "the only one"
    )
    height_unit: str | None = of_file(LengthUnit(), "um", "unit of heights that carry none", "from the file")
    pixel: float | None = of_file(
        LENGTH, "1.5625 um", "spacing of points that carry none", "from the file", _POINTS
    )
    index: int | None = of_file(INDEX, 0, "which one of an ensemble of maps, from 0", "all of them")
    fill: bool = key(Flag(), False, "fill points without a height", goes_with="file")
    spikes: bool = key(
        Flag(),
        False,
        "take points that stand out of their neighbours by 8 standard deviations for points without a height",
        goes_with="file",
    )
    recipe: Path | None = of_file(
        File(),
        "recipe.toml",
        "file that says how the map is read and prepared, before anything else; 'asperity surface FILE "
        "--store recipe.toml' writes it",
    )
    form: str = key(
        Choice(tuple(FORMS)),
        "plane",
        "form that is removed from each measured map",
        goes_with="file",
    )
    direction: float = key(
        ANGLE,
        "0 deg",
        "direction of rolling on measured maps, from their x axis towards their y axis",
        "-360 deg to 360 deg: more is a full turn and a direction",
        goes_with="file",
    )

    @classmethod
    def prepared(cls, given: Mapping[str, Any]) -> Mapping[str, Any]:
        """Take arrays of heights with their pixel, (nx, ny) or (maps, nx, ny), for height maps."""
        return surfaces_from(super().prepared(given), "file", "pixel", "height_unit", (2, 3))

    def problems(self) -> Iterator[InputError]:
        """A map in memory has its own points, and what a recipe says is not said twice."""
        yield from super().problems()
        yield from _foreign(self, "file", ("array", "height_unit", "pixel", "recipe"))
        if self.recipe is not None:
            for name in MAP_KEYS:
                if (value := getattr(self, name)) not in (None, False):
                    remedy = f"Write it into {self.recipe.name}."
                    yield InputError(name, shown(value), "nothing beside a recipe, which says it", remedy)


class Surface(MeasuredLine, MeasuredMap):
    """What is rolled over: samples (measured or synthesised), the line of the path, and defects on top."""

    ALTERNATIVES = (("file", "rms"), ("line", "spectrum"))
    IN_STRIPS: ClassVar[bool] = False
    """Whether spectra and lines are laid out as strips of any length, with the texture beside the line."""

    rms: float | None = optional(
        LENGTH,
        "0.5 um",
        "rms height of synthesised samples, instead of a file",
        within="1 pm to 1 mm: less is smoother than atoms are, more is no roughness",
    )
    hurst: float = key(
        Number(above=0, at_most=1),
        0.8,
        "Hurst exponent of the synthesised texture",
        "0.01 to 1: a spectrum has to fall",
        goes_with="rms",
    )
    longest: float | None = optional(
        LENGTH,
        "0.4 mm",
        "longest wavelength of the samples",
        "with rms 0.1 m of a track, 1.6 mm of all else, ten times as long where a contact is as large; else "
        "all they hold",
        "10 nm to 1 km: a texture is made of waves between atoms and tracks",
    )
    shortest: float | None = optional(
        LENGTH,
        "16 um",
        "shortest wavelength of the samples",
        "with rms four times contact.spacing, else all they hold",
        "0.1 nm to 10 m: a texture is made of waves between atoms and tracks",
    )
    anisotropy: float = key(
        Number(above=0, at_most=100),
        1.0,
        "ratio of the correlation lengths along and across the path",
        "0.01 to 100: a texture more drawn out than that is a line across",
        goes_with="rms",
    )
    lay: float = key(
        ANGLE,
        "0 deg",
        "angle by which a drawn-out texture is turned from the path towards its left",
        _MORE_THAN_A_TURN,
        goes_with="rms",
    )
    spectrum: str | Path | Array | None = optional(
        Either(SPECTRA, LEVELS), "iso3095", "one-third-octave wavelength spectrum of the line of the path"
    )
    lateral: float | None = optional(
        Number(above=0, infinite=True),
        1.0,
        "correlation length across over that along the path, at every wavelength of the spectrum, from which "
        "samples and path are then synthesised; inf: the same all across",
        "nothing is known beside the line",
        "0.1 to 1e6: less is no roughness that rolling leaves; beyond that it is the same all across: write "
        '"inf"',
        goes_with="spectrum",
    )
    level: float = key(LEVEL, "+0 dB", "level added to the spectrum", ADDED_LEVEL, goes_with="spectrum")
    continuation: str | None = optional(
        Choice(("refuse", "mirror", "repeat")),
        "mirror",
        "how a measured map or line that is shorter than the run goes on",
        "a path is synthesised in the likeness of a map; a line is refused",
        goes_with="file or line",
    )
    corrugation: float | None = optional(
        LENGTH,
        "25 um",
        "amplitude of a corrugation on top of the texture",
        within="1 nm to 10 mm: corrugation lies between",
    )
    corrugation_wavelength: float | None = optional(
        LENGTH, "40 mm", "its wavelength", "must be given", "10 um to 100 m: corrugation lies between",
        goes_with="corrugation",
    )  # fmt: skip
    corrugation_bandwidth: float | None = optional(
        Number(above=0, at_most=3),
        0.3,
        "its bandwidth in octaves; amplitude / 2^0.5 is the rms of a long rail, about which records scatter",
        "a sine",
        "0.001 to 3: a narrower one is a sine: leave it out",
        goes_with="corrugation",
    )
    joint_depth: float | None = optional(
        LENGTH,
        "1 mm",
        "depth of a dipped joint, which direct and table see",
        within="1 nm to 100 mm: dips lie between",
    )
    joint_length: float = key(
        LENGTH, "1 m", "length of the dip", "10 um to 100 m: dips lie between", goes_with="joint_depth"
    )
    joint_position: float | None = optional(
        LENGTH_OR_ZERO,
        "10 m",
        "position of the joint on the path",
        "the middle of the run",
        "0 m to 100 km: paths are shorter",
        goes_with="joint_depth",
    )
    smooth: bool = key(Flag(), False, "what is rolled over has no texture")

    @property
    def has_areal_spectrum(self) -> bool:
        """Whether the spectrum is that of a surface, from which samples are cut."""
        return self.spectrum is not None and self.lateral is not None

    @property
    def has_samples(self) -> bool:
        """Whether there is a 3-D texture, from which stiffness and filters are reduced."""
        return self.file is not None or self.rms is not None or self.has_areal_spectrum

    @property
    def has_line(self) -> bool:
        """Whether the path is given as a line, without the texture beside it."""
        lines = self.line is not None and not (self.IN_STRIPS or self.line_distance is not None)
        return lines or (self.spectrum is not None and self.lateral is None)

    @property
    def has_texture(self) -> bool:
        """Whether there is any texture or defect."""
        sources = (self.file, self.rms, self.line, self.spectrum, self.corrugation, self.joint_depth)
        return any(each is not None for each in sources)

    def problems(self) -> Iterator[InputError]:
        """One source of samples, and wavelengths in order."""
        yield from super().problems()
        beside = [name for name in ("rms", "file") if getattr(self, name) is not None]
        if beside and self.has_areal_spectrum and not self.IN_STRIPS:
            remedy = "Remove one: samples have one source."
            yield InputError("lateral", f"a number beside {beside[0]}", "a spectrum alone", remedy)
        longest = self.longest
        shortest = self.shortest
        if longest is not None and shortest is not None and longest <= shortest:
            received = f"{written(longest, 'm', 'um')} with shortest {written(shortest, 'm', 'um')}"
            yield InputError("longest", received, "a wavelength greater than shortest")
        if self.smooth and self.has_texture:
            yield InputError("smooth", "true beside a texture", "one of them", "Remove smooth.")
        if self.corrugation is not None and self.corrugation_wavelength is None:
            remedy = 'Add corrugation_wavelength = "40 mm", say.'
            yield InputError("corrugation", "no corrugation_wavelength", "both keys together", remedy)


def surfaces_from(
    given: Mapping[str, Any], name: str, spacing: str, unit: str, dimensions: tuple[int, ...]
) -> Mapping[str, Any]:
    """Make height maps or a profile of the array that a key of a section holds, with its spacing and unit."""
    if not isinstance(heights := given.get(name), np.ndarray):
        return given
    keys = dict(given)
    problems = []
    if heights.ndim not in dimensions:
        shapes = " or ".join(f"{n} dimensions" if n > 1 else "one dimension" for n in dimensions)
        problems.append(InputError(name, f"an array of shape {heights.shape}", f"an array of {shapes}"))
    if keys.get(spacing) is None:
        remedy = f"Give {spacing} beside the array, or hand over a map or a line that knows it."
        problems.append(InputError(spacing, "nothing", "the distance of the points of an array", remedy))
    if problems:
        raise Problems(problems)
    try:
        step = LENGTH(keys.pop(spacing))
        unit = LengthUnit()(keys.pop(unit, None) or "m")
        scaled = real_array(name, heights, "an array of real numbers") * factor(unit, "m")
        made = tuple(
            HeightMap(each, (step, step)) if each.ndim == 2 else Profile(each, step)
            for each in (scaled if scaled.ndim == 3 else [scaled])
        )
    except InputError as error:
        raise Problems([error.about(name)]) from None
    return keys | {name: made if len(made) > 1 else made[0]}


def _foreign(section: Section, name: str, keys: tuple[str, ...]) -> Iterator[InputError]:
    if not holds_memory(getattr(section, name)):
        return
    for key_of_file in keys:
        if (value := getattr(section, key_of_file)) is not None:
            remedy = "What stands in memory has its own points."
            yield InputError(key_of_file, value, f"only together with a {name} on disk", remedy)


# --- recipes: how a measured file is read and prepared, stored once and named in cases

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
        ListOf(LENGTH_OR_ZERO), None, "x, y and both lengths of the piece of a map that is kept"
    )
    form: str | None = key(Choice(tuple(FORMS)), None, "form that is removed")
    longest: float | None = key(LENGTH, None, "nesting index of the L-filter: longer waves are removed")
    shortest: float | None = key(LENGTH, None, "nesting index of the S-filter: shorter waves are removed")
    direction: float | None = key(ANGLE, None, "direction of rolling, from x towards y")

    @property
    def hints(self) -> dict[str, Any]:
        """What is said of the file, as `read_all` takes it."""
        found = {name: value for name, value in self.given().items() if name not in STEPS}
        if self.pixel is not None:
            found["pixel"] = f"{self.pixel!r} m"  # whatever the unit of coordinates
        return found

    def surfaces(self, file: Path) -> list[HeightMap | Profile]:
        """Read the map, the line, or all maps of an ensemble, and prepare them."""
        return [self.stepped(surface) for surface in read_all(file, **self.hints)]

    def stepped(self, surface: S) -> S:
        """Cut a piece, remove a form, filter, and turn into the direction of rolling."""
        is_map = isinstance(surface, HeightMap)
        done = cast(Any, surface)
        if self.crop is not None:
            of_map = "four of a map: x, y and both sides"
            of_line = "two of a line: where the piece begins, and its length"
            right = len(self.crop) == (4 if is_map else 2)
            count = count_of(len(self.crop), "length")
            require(right, spell("crop"), count, of_map if is_map else of_line)
            done = done.crop(self.crop[:2], self.crop[2:]) if is_map else done.crop(*self.crop)
        if self.form is not None:
            done = done.levelled(self.form)
        if self.longest is not None or self.shortest is not None:
            done = done.band_limited(self.longest, self.shortest)
        if self.direction is not None:
            require(is_map, spell("direction"), "a line", "a height map", "Leave it out.")
            done = rotated(done, self.direction)
        return done


def read_recipe(path: FilePath) -> Recipe:
    """Read a recipe from a TOML file, as ``asperity surface FILE --store recipe.toml`` writes it."""
    return Recipe.read(typed_recipe(path), Origin.file(path))


def typed_recipe(path: FilePath) -> dict[str, Any]:
    """Keys and values of a recipe as they stand in its file."""
    remedy = "Check the path, or store one with 'asperity surface FILE --store recipe.toml'."
    return toml.read_toml(toml.read_definition(path, "recipe", remedy), "recipe", path)


def recipe_text(typed: dict[str, Any]) -> str:
    """Write keys and values as the text of a file that `read_recipe` reads."""
    head = '# How a measured surface is read and prepared: recipe = "…" in [surface] of a case\n'
    return head + toml.toml_text(typed)
