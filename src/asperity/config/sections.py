"""Sections that all kinds of case share: the surface, the contact, and how finely time is resolved."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from itertools import pairwise
from pathlib import Path
from typing import Annotated, Any

import numpy as np
from numpy.typing import NDArray
from pydantic import model_validator

from asperity.arguments import FORMS, MOST_PASSES, SHAKEDOWN, shown
from asperity.config import values
from asperity.config.content import holds_memory
from asperity.config.form import Section, key, optional
from asperity.config.tables import TABLE_OF_LEVELS, problems_of_table, read_levels
from asperity.errors import InputError
from asperity.surfaces.heightmap import HeightMap, Profile
from asperity.units import factor, written

LATERAL = '0.001 to 1000000.0: beyond that it is the same all across: write "inf"'
MOST_CELLS = 2048  # along one side of the window

Index = Annotated[int, values.Number(at_least=0, at_most=10**9, whole=True)]


class MeasuredMap(Section):
    """A measured map, or an ensemble of them, and what its file does not say."""

    file: values.MapFile | None = optional(
        "beam.x3p", "measured map: the samples, and the path where it is long enough"
    )
    array: values.Name | None = optional(
        "polished", "name of the array in a file that holds several", "the only one", goes_with="file"
    )
    height_unit: values.HeightUnit | None = optional(
        "um", "unit of heights that carry none", "from the file", goes_with="file"
    )
    pixel: values.Length | None = optional(
        "1.5625 um",
        "spacing of points that carry none",
        "from the file",
        "0.1 nm to 10 mm: atoms are 0.1 nm apart, and contacts are smaller than 10 mm",
        goes_with="file",
    )
    index: Index | None = optional(
        0, "which one of an ensemble of maps, from 0", "all of them", goes_with="file"
    )
    fill: values.YesNo = key(False, "fill points without a height", goes_with="file")
    spikes: values.YesNo = key(
        False,
        "take points that stand out of their neighbours by 8 standard deviations for points without a height",
        goes_with="file",
    )
    recipe: Annotated[Path, values.File()] | None = optional(
        "recipe.toml",
        "file that says how the map is read and prepared, before anything else; 'asperity surface FILE "
        "--store recipe.toml' writes it",
        goes_with="file",
    )
    form: Annotated[str, values.Choice(tuple(FORMS), tuple(FORMS.values()))] = key(
        "plane", "form that is removed from each measured map", goes_with="file"
    )
    direction: values.Angle = key(
        "0 deg",
        "direction of rolling on measured maps, from their x axis towards their y axis",
        "-360 deg to 360 deg: more is a full turn and a direction",
        goes_with="file",
    )

    @model_validator(mode="before")
    @classmethod
    def _maps_of_an_array(cls, data: Any) -> Any:
        """Take an array of heights with its pixel, (nx, ny) or (maps, nx, ny), for height maps."""
        return surfaces_from(data, "file", "pixel", "height_unit", (2, 3))

    def problems_of_maps(self) -> Iterator[InputError]:
        """A map in memory has its own points, and what a recipe says is not said twice."""
        yield from _foreign(self, "file", ("array", "height_unit", "pixel", "recipe"))
        if self.recipe is not None:
            for name in ("array", "height_unit", "pixel", "index", "fill", "spikes"):
                if (value := getattr(self, name)) not in (None, False):
                    remedy = f"Write it into {self.recipe.name}."
                    yield InputError(name, shown(value), "nothing beside a recipe, which says it", remedy)


class MeasuredLine(Section):
    """A measured line, and what its file does not say."""

    line: values.LineFile | None = optional(
        "line.csv",
        "measured long line for the path; without one, a path longer than the map is synthesised from it",
    )
    line_array: values.Name | None = optional(
        "lines", "name of the array in a file that holds several", "the only one", goes_with="line"
    )
    line_unit: values.HeightUnit | None = optional(
        "um", "unit of lines that carry none", "from the file", goes_with="line"
    )
    line_spacing: values.Length | None = optional(
        "1 mm",
        "spacing of points along lines that carry none",
        "from the file",
        "0.1 nm to 10 mm: atoms are 0.1 nm apart, and contacts are smaller than 10 mm",
        goes_with="line",
    )

    @model_validator(mode="before")
    @classmethod
    def _lines_of_an_array(cls, data: Any) -> Any:
        """Take an array of heights with its spacing, (n,) or lines side by side, for what was measured."""
        return surfaces_from(data, "line", "line_spacing", "line_unit", (1, 2))

    def problems_of_line(self) -> Iterator[InputError]:
        """A line in memory has its own points."""
        yield from _foreign(self, "line", ("line_array", "line_unit", "line_spacing"))


def surfaces_from(data: Any, name: str, spacing: str, unit: str, dimensions: tuple[int, ...]) -> Any:
    """Make height maps or a profile of the array that a key of a section holds, with its spacing and unit."""
    if not isinstance(data, Mapping) or not isinstance(heights := data.get(name), np.ndarray):
        return data
    keys = dict(data)
    errors = []
    if heights.ndim not in dimensions:
        shapes = " or ".join(f"{n} dimensions" if n > 1 else "one dimension" for n in dimensions)
        errors.append(InputError(name, f"an array of shape {heights.shape}", f"an array of {shapes}"))
    if heights.dtype.kind not in "fiu":
        errors.append(InputError(name, f"data of type {heights.dtype}", "an array of real numbers"))
    if keys.get(spacing) is None:
        remedy = f"Give {spacing} beside the array, or hand over a map or a line that knows it."
        errors.append(InputError(spacing, "nothing", "the distance of the points of an array", remedy))
    if errors:
        raise values.Problems(errors)
    try:
        step = values.Quantity("m", above=0)(keys.pop(spacing), None)
        scale = factor(values.LengthUnit()(keys.pop(unit, None) or "m"), "m")
        maps = heights if heights.ndim == 3 else [heights]
        made = tuple(
            HeightMap(each * scale, (step, step)) if each.ndim == 2 else Profile(each * scale, step)
            for each in maps
        )
    except InputError as error:
        raise values.Problems([InputError(name, error.received, error.allowed, error.remedy)]) from None
    return keys | {name: made if len(made) > 1 else made[0]}


def _foreign(section: Section, name: str, keys: tuple[str, ...]) -> Iterator[InputError]:
    if not holds_memory(getattr(section, name)):
        return
    for key_of_file in keys:
        if (value := getattr(section, key_of_file)) is not None:
            remedy = "What stands in memory has its own points."
            yield InputError(key_of_file, value, f"only together with a {name} on disk", remedy)


class Surface(MeasuredLine, MeasuredMap):
    """What is rolled over: samples (measured or synthesised), and the line of the path."""

    rms: values.Length | None = optional(
        "0.5 um",
        "rms height of synthesised samples, instead of a file",
        within="1 pm to 1 mm: less is smoother than atoms are, more is no roughness",
    )
    hurst: Annotated[float, values.Number(above=0, at_most=1)] = key(
        0.8, "Hurst exponent of the synthesised texture", "0.01 to 1: a spectrum has to fall", goes_with="rms"
    )
    longest: values.Length | None = optional(
        "0.4 mm",
        "longest wavelength of the samples",
        "with rms 20 half-widths of the smooth contact, else all they hold",
        "10 nm to 10 m: a texture is made of waves between atoms and bodies",
    )
    shortest: values.Length | None = optional(
        "16 um",
        "shortest wavelength of the samples",
        "with rms four times contact.spacing, else all they hold",
        "0.1 nm to 1 m: a texture is made of waves between atoms and bodies",
    )
    anisotropy: Annotated[float, values.Number(above=0, at_most=100)] = key(
        1.0,
        "ratio of the correlation lengths along and across the path",
        "0.01 to 100: a texture more drawn out than that is a line across",
        goes_with="rms",
    )
    lay: values.Angle = key(
        "0 deg",
        "angle by which a drawn-out texture is turned from the path towards its left",
        "-360 deg to 360 deg: more is a full turn and an angle",
        goes_with="rms",
    )
    spectrum: (
        Annotated[
            str | Path | NDArray[np.float64],
            values.ChoiceOrFile(("iso3095",), TABLE_OF_LEVELS, columns=2),
        ]
        | None
    ) = optional("iso3095", "one-third-octave wavelength spectrum of the line of the path")
    lateral: Annotated[float, values.Number(above=0, infinite=True)] | None = optional(
        1.0,
        "correlation length across over that along the path, at every wavelength of the spectrum, from which "
        "samples and path are then synthesised; inf: the same all across",
        "nothing is known beside the line",
        LATERAL,
        goes_with="spectrum",
    )
    level: values.Level = key(
        "+0 dB",
        "level added to the spectrum",
        "-120 dB to 120 dB: a million times is another texture",
        goes_with="spectrum",
    )

    continuation: Annotated[str, values.Choice(("mirror", "repeat"))] | None = optional(
        "mirror",
        "how a measured map or line that is shorter than the run goes on",
        "a path is synthesised in the likeness of a map; a line is refused",
        goes_with="file or line",
    )

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
        return self.line is not None or (self.spectrum is not None and not self.has_areal_spectrum)

    def problems(self) -> Iterator[InputError]:
        """Some texture, from sources that do not exclude one another."""
        yield from self.problems_of_sources()
        if not self.has_samples and not self.has_line:
            remedy = 'Name a measured map (file = "…") or synthesise one (rms = "0.5 um").'
            yield InputError("", "no texture", "file, rms, line or spectrum", remedy)
        if self.has_areal_spectrum and (self.file is not None or self.rms is not None):
            received = f"a number beside {'file' if self.rms is None else 'rms'}"
            remedy = "Remove one: samples have one source."
            yield InputError("lateral", received, "a spectrum alone", remedy)
        yield from problems_of_table(self, "spectrum", read_levels)

    def problems_of_sources(self) -> Iterator[InputError]:
        """At most one source of samples, at most one of the path, and wavelengths in order."""
        yield from self.problems_of_maps()
        yield from self.problems_of_line()
        if self.file is not None and self.rms is not None:
            remedy = "Remove one: samples are either measured or synthesised."
            yield InputError("", "both file and rms", "one of them", remedy)
        if self.line is not None and self.spectrum is not None:
            yield InputError(
                "", "both line and spectrum", "one of them", "Remove one: the path has one line."
            )
        longest, shortest = self.longest, self.shortest
        if longest is not None and shortest is not None and longest <= shortest:
            received = f"{written(longest, 'm', 'um')} with shortest {written(shortest, 'm', 'um')}"
            yield InputError("longest", received, "a wavelength greater than shortest")


class ContactCase(Section):
    """How the rough contact is solved and reduced."""

    spacing: values.ChosenLength = optional(
        "8 um",
        "grid spacing of the contact solution",
        "a ninth of the smooth contact's smaller half-width, or a quarter of surface.shortest",
        "1 nm to 10 mm: an elastic continuum is coarser than atoms, and contacts are smaller than 10 mm",
    )
    window: values.ChosenLength = optional(
        "0.5 mm",
        "side of the square window in which contact is solved; wider than the contact",
        "that of the smooth contact under three times the load, wider where the surface is rough",
        "10 nm to 1 m: contacts lie between atoms and bodies",
    )
    samples: Annotated[int, values.Number(at_least=1, at_most=10_000, whole=True)] = key(
        8, "number of surface samples for the stiffness and the filters"
    )
    sample_length: values.Length | None = optional(
        "2 mm",
        "length of the strips from which filters are estimated",
        "16 windows, or the length of the map",
        "10 nm to 100 m: samples lie between contacts and bodies",
    )
    approaches: tuple[values.Approach, ...] | None = optional(
        ["-0.5 um", "0 um", "1 um"],
        "increasing approaches at which the contact is reduced, from the plane that the nominal patch feels",
        "chosen from the load and the roughness",
        "-10 mm to 10 mm: contacts are closer than that",
    )
    damping: values.Damping = key(
        "0 N s/m", "damping of the contact", "1e-9 N s/m to 1e9 N s/m: less damps nothing, more is rigid"
    )
    hardness: values.Pressure | None = optional(
        "3 GPa", "largest pressure", "elastic contact", "1 kPa to 1 TPa: no solid is as soft, or as hard"
    )
    running_in: (
        Annotated[
            int | str,
            values.NumberOrWord(values.Number(at_least=1, at_most=MOST_PASSES, whole=True), SHAKEDOWN),
        ]
        | None
    ) = optional(
        "shakedown",
        "passes under the working load that samples and path have had before, in which asperities yielded, "
        "or until a pass changes nothing",
        "an untouched surface",
        goes_with="hardness",
    )
    datum: Annotated[str, values.Choice(("samples", "path"))] = key(
        "samples",
        "from whose first touch the state r = approach + d0 counts: that of the samples (as printed), or of "
        "samples and path",
    )
    normalise: Annotated[str, values.Choice(("low-wavenumber", "tangent"))] | None = optional(
        "tangent",
        "what the contact filter is 1 at: its own low wavenumbers (as printed), or the tangent stiffness",
        "as printed for the law printed, tangent for every other",
    )
    linearise: Annotated[str, values.Choice(("hertz", "rough", "secant"))] = key(
        "hertz",
        "stiffness of the linear laws under the load: dF/dr of smooth bodies, dF/dr of rough ones, or F/r",
    )
    filter_degree: Annotated[int, values.Number(at_least=1, at_most=20, whole=True)] | None = optional(
        6,
        "degree of a polynomial that is fitted to each filter, in dB over wavenumber",
        "the filter is averaged over a sixth of an octave",
    )
    filter_taps: Annotated[int, values.Number(at_least=2, at_most=4096, whole=True)] | None = optional(
        64,
        "order J of the filter (J + 1 taps), even, designed by window",
        "the first that meets the fitted filter within 0.3 dB down to -30 dB",
    )

    @property
    def cells(self) -> int:
        """Number of grid cells along one side of the window."""
        return round(self.window / self.spacing)

    def problems(self) -> Iterator[InputError]:
        """Approaches increase; the filter order is even."""
        if self.approaches is not None and len(self.approaches) < 2:
            yield InputError(
                "approaches", f"{len(self.approaches)} values", "at least 2", "Or remove the key."
            )
        if any(later <= earlier for earlier, later in pairwise(self.approaches or ())):
            received = ", ".join(written(value, "m", "um") for value in self.approaches or ())
            yield InputError("approaches", received, "increasing values", "Sort them, each once.")
        if self.filter_taps is not None and self.filter_taps % 2:
            remedy = "An odd order would shift the texture by half a step."
            yield InputError("filter_taps", self.filter_taps, "an even number", remedy)


class Numerics(Section):
    """How finely time is resolved."""

    highest_frequency: values.Frequency = key(
        "5 kHz", "upper end of the spectra", "0.1 Hz to 10 MHz: rolling is slower than ultrasound"
    )
    time_step: values.Duration | None = optional(
        "8 us",
        "time step",
        "near 1/20 of the highest frequency's period, a whole number or fraction of spacing/speed",
        "1 ns to 1 s: the spectra lie between",
    )
    rtol: Annotated[float, values.Number(above=0, at_most=0.01)] = key(
        1e-6,
        "tolerance of single contact solutions and of the law direct, relative to the largest overlap",
        "1e-12 to 0.01: double precision carries no more digits",
    )
    force_accuracy: Annotated[float, values.Number(above=0, at_most=0.01)] = key(
        1e-4,
        "relative accuracy of the forces of scans and loading curves; of scans for filters a tenth",
        "1e-07 to 0.01: the tables that are interpolated carry no more digits",
    )
