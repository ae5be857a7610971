"""Sections of a case with a railway wheel: rail surface, wheel, track, contact, numerics and noise."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Annotated, ClassVar

from pydantic import BeforeValidator

from asperity.config.keys import (
    Choice,
    ChoiceOrFile,
    Damping,
    Duration,
    ExistingFile,
    Force,
    HeightUnit,
    Length,
    LengthOrInfinite,
    Level,
    Mass,
    Name,
    Number,
    Position,
    Quantity,
    Section,
    Stiffness,
    YesNo,
    key,
)
from asperity.config.sections import ContactCase, Material, Numerics, Surface
from asperity.config.tables import read_levels, read_modes, read_receptance
from asperity.errors import InputError
from asperity.reference.tracks import TRACKS

RAIL_SPECTRA = ("iso3095", "cnossos-average")
WHEEL_ROUGHNESS = ("cast-iron", "composite", "disc")
PROCESSING = ("spikes", "curvature")
DEEPEST_FLAT = 0.01  # of the wheel's radius

_levels = "a table of wavelengths and levels"
Spectrum = Annotated[str | Path, BeforeValidator(ChoiceOrFile(RAIL_SPECTRA, _levels))]
WheelRoughness = Annotated[str | Path, BeforeValidator(ChoiceOrFile(WHEEL_ROUGHNESS, _levels))]
Step = Annotated[str, BeforeValidator(Choice(PROCESSING))]
LossFactor = Annotated[float, BeforeValidator(Number(at_least=0, at_most=5))]


class RailSurface(Surface):
    """Texture of the rail: measured or synthesised, with defects on top; or smooth."""

    synthesised_band: ClassVar = (20e-3, 1.25e-3)

    file: ExistingFile | None = key(
        None, "measured map: the samples, and the path where it is long enough", example='"rail.x3p"'
    )
    longest: Length | None = key(
        None,
        "longest wavelength of the samples",
        otherwise="with rms 20 mm, else all they hold",
        example='"20 mm"',
    )
    shortest: Length | None = key(
        None,
        "shortest wavelength of the samples",
        otherwise="with rms 1.25 mm, else all they hold",
        example='"1.25 mm"',
    )
    spectrum: Spectrum | None = key(
        None, "one-third-octave wavelength spectrum of the rail", example='"iso3095"'
    )
    lateral: Annotated[float, BeforeValidator(Number(above=0, infinite=True))] = key(
        1.0,
        "correlation length across over that along the rail, at every wavelength; inf: the same all across",
        goes_with="spectrum",
    )
    line: ExistingFile | None = key(
        None, "measured long line of the rail, or several side by side", example='"rail.csv"'
    )
    line_array: Name | None = key(
        None,
        "name of the lines in a file that holds several arrays",
        otherwise="the only one",
        example='"rail"',
        goes_with="line",
    )
    line_unit: HeightUnit | None = key(
        None,
        "unit of lines that carry none",
        otherwise="from the file",
        example='"um"',
        goes_with="line",
    )
    line_spacing: Length | None = key(
        None,
        "spacing of points along lines that carry none",
        otherwise="from the file",
        example='"1 mm"',
        goes_with="line",
    )
    line_distance: Length | None = key(
        None,
        "distance across between neighbouring lines; a single line holds all across",
        otherwise="for a single line",
        example='"5 mm"',
        goes_with="line",
    )
    processing: tuple[Step, ...] = key(
        (), "steps of EN 15610 that are applied to measured lines", goes_with="line"
    )
    continuation: Annotated[str, BeforeValidator(Choice(("refuse", "mirror", "repeat")))] = key(
        "refuse", "how a record that is shorter than the run goes on"
    )
    accept_levels: YesNo = key(False, "take levels beyond 60 dB re 1 um as they are")
    corrugation: Length | None = key(
        None, "amplitude of a corrugation on top of the rail's texture", example='"25 um"'
    )
    corrugation_wavelength: Length | None = key(
        None, "its wavelength", otherwise="must be given", example='"40 mm"', goes_with="corrugation"
    )
    corrugation_bandwidth: Annotated[float, BeforeValidator(Number(above=0, at_most=3))] | None = key(
        None, "its bandwidth in octaves", otherwise="a sine", example="0.3", goes_with="corrugation"
    )
    joint_depth: Length | None = key(None, "depth of a dipped joint", example='"1 mm"')
    joint_length: Length = key("1 m", "length of the dip", goes_with="joint_depth")
    joint_position: Position | None = key(
        None,
        "position of the joint, from the sleeper that start counts from",
        otherwise="the middle of the run",
        example='"10 m"',
        goes_with="joint_depth",
    )
    smooth: YesNo = key(False, "a rail without texture")

    @property
    def has_texture(self) -> bool:
        """Whether the rail has any texture or defect."""
        defects = self.corrugation is not None or self.joint_depth is not None
        return self.has_samples or self.has_line or defects

    def problems(self) -> Iterator[InputError]:
        """Sources and defects of the rail's texture that do not exclude one another."""
        yield from self.problems_of_sources()
        yield from _repeated(self.processing)
        if self.smooth and self.has_texture:
            yield InputError("smooth", "true beside a texture", "one of them", "Remove smooth.")
        if self.corrugation is not None and self.corrugation_wavelength is None:
            remedy = 'Add corrugation_wavelength = "40 mm", say.'
            yield InputError("corrugation", "no corrugation_wavelength", "both keys together", remedy)
        yield from _problems_of_table(self, "spectrum", read_levels)


class WheelCase(Section):
    """The wheel: a mass under a constant load, its shape, its resonances and its texture."""

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
    roughness: WheelRoughness | None = key(
        None, "one-third-octave wavelength spectrum of the tread", example='"disc"'
    )
    roughness_level: Level = key("+0 dB", "level added to it", goes_with="roughness")
    line: ExistingFile | None = key(
        None, "measured line around the tread, or several side by side", example='"wheel.csv"'
    )
    line_array: Name | None = key(
        None,
        "name of the lines in a file that holds several arrays",
        otherwise="the only one",
        example='"wheel"',
        goes_with="line",
    )
    line_unit: HeightUnit | None = key(
        None,
        "unit of lines that carry none",
        otherwise="from the file",
        example='"um"',
        goes_with="line",
    )
    line_spacing: Length | None = key(
        None,
        "spacing of points along lines that carry none",
        otherwise="from the file",
        example='"1 mm"',
        goes_with="line",
    )
    line_distance: Length | None = key(
        None,
        "distance across between neighbouring lines; a single line holds all across",
        otherwise="for a single line",
        example='"5 mm"',
        goes_with="line",
    )
    processing: tuple[Step, ...] = key(
        (), "steps of EN 15610 that are applied to measured lines", goes_with="line"
    )
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
    def circumference(self) -> float:
        """Length of the tread around the wheel in m."""
        return 2 * math.pi * self.radius

    @property
    def has_texture(self) -> bool:
        """Whether the tread has any texture or defect."""
        return self.roughness is not None or self.line is not None or self.flat_depth is not None

    def problems(self) -> Iterator[InputError]:
        """One shape, one set of resonances, one texture, and a flat that is small against the wheel."""
        yield from _repeated(self.processing)
        for one, other in (
            ("profile", "transverse_radius"),
            ("modes", "receptance"),
            ("roughness", "line"),
        ):
            if {one, other} <= self.model_fields_set:
                yield InputError("", f"both {one} and {other}", "one of them", "Remove one.")
        deepest = DEEPEST_FLAT * self.radius
        if self.flat_depth is not None and self.flat_depth > deepest:
            received = f"{self.flat_depth * 1e3:g} mm"
            allowed = f"at most {DEEPEST_FLAT:g} of the radius, {deepest * 1e3:g} mm"
            yield InputError("flat_depth", received, allowed)
        if self.flat_depth is not None and self.flat_position >= self.circumference:
            allowed = f"less than the circumference, {self.circumference:.4g} m"
            yield InputError("flat_position", f"{self.flat_position:g} m", allowed)
        yield from _problems_of_table(self, "roughness", read_levels)
        yield from _problems_of_table(self, "modes", read_modes)
        yield from _problems_of_table(self, "receptance", read_receptance)


_NAMED = "of the named set"


class TrackCase(Section):
    """The track: a named, cited set; each single key overrides it."""

    name: Annotated[str, BeforeValidator(Choice(tuple(TRACKS)))] = key("x2000", "named set of parameters")
    bending_stiffness: Annotated[float, BeforeValidator(Quantity("N m^2", above=0))] | None = key(
        None, "bending stiffness of the rail", otherwise=_NAMED, example='"4.7 MN m^2"'
    )
    mass_per_length: Annotated[float, BeforeValidator(Quantity("kg/m", above=0))] | None = key(
        None, "mass of the rail per length", otherwise=_NAMED, example='"60 kg/m"'
    )
    rail_loss_factor: LossFactor | None = key(
        None, "loss factor of the rail", otherwise=_NAMED, example="0.01"
    )
    shear_stiffness: Force | None = key(
        None,
        "shear stiffness of the rail; with it, the rail is a Timoshenko beam",
        otherwise=_NAMED,
        example='"243 MN"',
    )
    rotary_inertia: Annotated[float, BeforeValidator(Quantity("kg m", above=0))] | None = key(
        None, "rotary inertia of the rail per length", otherwise=_NAMED, example='"0.24 kg m"'
    )
    pad_stiffness: Stiffness | None = key(
        None, "stiffness of a rail pad", otherwise=_NAMED, example='"300 MN/m"'
    )
    pad_damping: Damping | None = key(
        None, "viscous damping of a pad", otherwise=_NAMED, example='"18 kN s/m"'
    )
    pad_loss_factor: LossFactor | None = key(
        None, "loss factor of a pad, instead of pad_damping", otherwise=_NAMED, example="0.15"
    )
    sleeper_mass: Mass | None = key(
        None, "mass of a sleeper under one rail: half a sleeper", otherwise=_NAMED, example='"150 kg"'
    )
    ballast_stiffness: Stiffness | None = key(
        None, "stiffness of the ballast under half a sleeper", otherwise=_NAMED, example='"150 MN/m"'
    )
    ballast_damping: Damping | None = key(
        None, "viscous damping of the ballast", otherwise=_NAMED, example='"48 kN s/m"'
    )
    ballast_loss_factor: LossFactor | None = key(
        None, "loss factor of the ballast, instead of ballast_damping", otherwise=_NAMED, example="0.4"
    )
    sleeper_spacing: Length | None = key(
        None, "distance of the sleepers", otherwise=_NAMED, example='"0.6 m"'
    )
    rail_head_radius: Length = key("0.3 m", "radius of the rail head across the rail")
    rail_profile: ExistingFile | None = key(
        None,
        "measured shape of the rail head across the rail, instead of rail_head_radius",
        example='"rail.csv"',
    )
    material: Material = key("steel", "material of the rail")
    points: tuple[Position, ...] | None = key(
        None,
        "positions at which the motion of the rail is recorded while it is passed, from the sleeper that "
        "start counts from",
        otherwise="over a sleeper and at mid-span in the middle of the run",
        example='["9 m", "9.3 m"]',
    )

    @property
    def overrides(self) -> dict[str, float]:
        """What the case says beside the name of its set, by the keywords of `Track`, in SI."""
        told = {name: getattr(self, name) for name in OVERRIDES}
        return {name: value for name, value in told.items() if value is not None}

    def problems(self) -> Iterator[InputError]:
        """Each damping either viscous or by a loss factor, one rail head, and at least one point."""
        told = self.overrides
        for part in ("pad", "ballast"):
            viscous, loss = f"{part}_damping", f"{part}_loss_factor"
            if viscous in told and loss in told:
                received = f"{told[viscous]:g} N s/m and {loss} = {told[loss]:g}"
                remedy = "Remove one: damping is either viscous or by a loss factor."
                yield InputError(viscous, received, "one of them", remedy)
        if {"rail_head_radius", "rail_profile"} <= self.model_fields_set:
            yield InputError("", "both rail_head_radius and rail_profile", "one of them", "Remove one.")
        if self.points == ():
            remedy = "Remove the key for the default."
            yield InputError("points", "an empty list", "at least one position", remedy)


OVERRIDES = (
    "bending_stiffness",
    "mass_per_length",
    "rail_loss_factor",
    "shear_stiffness",
    "rotary_inertia",
    "pad_stiffness",
    "pad_damping",
    "pad_loss_factor",
    "sleeper_mass",
    "ballast_stiffness",
    "ballast_damping",
    "ballast_loss_factor",
    "sleeper_spacing",
)


class RailContact(ContactCase):
    """How the contact of wheel and rail is solved and reduced."""

    spacing: Length = key("0.5 mm", "grid spacing of the contact solution")
    window: Length = key(
        "20 mm", "side of the square window in which contact is solved; wider than the contact"
    )


class RailNumerics(Numerics):
    """How finely time and the track are resolved."""

    time_step: Duration | None = key(
        None,
        "time step",
        otherwise="near 1/8 of the highest frequency's period, on the grid of the contact if that is near",
        example='"25 us"',
    )
    kernel: Annotated[str, BeforeValidator(Choice(("poles", "scatter")))] = key(
        "poles", "how the track's response is carried on in time: by fitted poles, or by its whole past"
    )
    poles: Annotated[int, BeforeValidator(Number(at_least=10, at_most=1000, whole=True))] = key(
        100, "number of poles, even", goes_with="kernel=poles"
    )

    def problems(self) -> Iterator[InputError]:
        """Poles come in pairs."""
        if self.poles % 2:
            yield InputError("poles", self.poles, "an even number", "Poles come in conjugate pairs.")


class NoiseCase(Section):
    """How force is turned into sound power, by the transfer functions of CNOSSOS-EU."""

    track_pad: Annotated[str, BeforeValidator(Choice(("soft", "medium", "hard")))] = key(
        "medium", "rail pads of the track's transfer to sound power, on mono-block sleepers"
    )
    wheel_transfer: Annotated[str, BeforeValidator(Choice(("920 mm",)))] = key(
        "920 mm", "diameter of the wheel's transfer to sound power"
    )
    axles: Annotated[int, BeforeValidator(Number(at_least=1, at_most=1000, whole=True))] = key(
        1, "number of axles whose sound power is added"
    )


def _repeated(processing: tuple[str, ...]) -> Iterator[InputError]:
    for step in sorted(set(processing)):
        if processing.count(step) > 1:
            yield InputError("processing", f'"{step}" more than once', "each step once")


def _problems_of_table(section: Section, name: str, read: Callable[[Path], object]) -> Iterator[InputError]:
    """Say what is wrong with the table that a key names."""
    path = getattr(section, name)
    if isinstance(path, Path):
        try:
            read(path)
        except InputError as error:
            yield InputError(name, f"{error.received} in {path.name}", error.allowed, error.remedy)
