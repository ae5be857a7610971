"""The case of a ball that rolls over a beam: its keys, their defaults, and what must fit together."""

from __future__ import annotations

import math
from collections.abc import Iterator
from itertools import pairwise
from typing import Annotated, Any

from pydantic import BeforeValidator, PrivateAttr, model_validator

from asperity.config.describing import parameters
from asperity.config.keys import (
    Approach,
    Choice,
    Damping,
    Duration,
    ExistingFile,
    Force,
    Frequency,
    HeightUnit,
    Length,
    Level,
    Mass,
    Name,
    Number,
    Position,
    Pressure,
    Section,
    Speed,
    YesNo,
    key,
)
from asperity.errors import InputError
from asperity.reference.materials import MATERIALS

LAWS = (
    "areal",
    "shifted",
    "printed",
    "table",
    "direct",
    "hertz",
    "linear",
    "hertz-filtered",
    "linear-filtered",
)
NEED_AREAL_PATH = ("areal", "table", "direct")  # laws that look at the texture beside the line, too
NEED_NO_SAMPLES = ("hertz", "linear", "hertz-filtered", "linear-filtered")  # smooth bodies over the line
MOST_CELLS = 2048  # along one side of the window
MOST_STEPS = 10**8
LONGEST, SHORTEST = 0.4e-3, 16e-6  # m, of synthesised samples where the case names no wavelengths
SAMPLING = 2.5  # points per period of the highest frequency, at least


Law = Annotated[str, BeforeValidator(Choice(LAWS))]
Material = Annotated[str, BeforeValidator(Choice(tuple(MATERIALS)))]
_Index = Annotated[int, BeforeValidator(Number(at_least=0, at_most=10**9, whole=True))]


class Surface(Section):
    """What is rolled over: samples (measured or synthesised), and the line of the path."""

    file: ExistingFile | None = key(
        None, "measured map: the samples, and the path where it is long enough", example='"beam.x3p"'
    )
    array: Name | None = key(
        None,
        "name of the array in a file that holds several",
        otherwise="the only one",
        example='"polished"',
        goes_with="file",
    )
    height_unit: HeightUnit | None = key(
        None, "unit of heights that carry none", otherwise="from the file", example='"um"', goes_with="file"
    )
    pixel: Length | None = key(
        None,
        "spacing of points that carry none",
        otherwise="from the file",
        example='"1.5625 um"',
        goes_with="file",
    )
    index: _Index | None = key(
        None,
        "which one of an ensemble of maps, from 0",
        otherwise="all of them",
        example="0",
        goes_with="file",
    )
    fill: YesNo = key(False, "fill points without a height", goes_with="file")
    form: Annotated[str, BeforeValidator(Choice(("plane", "quadratic")))] = key(
        "plane", "form that is removed from each measured map", goes_with="file"
    )
    line: ExistingFile | None = key(
        None,
        "measured long line for the path; without one, a path longer than the map is synthesised from it",
        example='"line.csv"',
    )
    rms: Length | None = key(None, "rms height of synthesised samples, instead of a file", example='"0.5 um"')
    hurst: Annotated[float, BeforeValidator(Number(above=0, at_most=1))] = key(
        0.8, "Hurst exponent of the synthesised texture", goes_with="rms"
    )
    longest: Length | None = key(
        None,
        "longest wavelength of the samples",
        otherwise="with rms 0.4 mm, else all they hold",
        example='"0.4 mm"',
    )
    shortest: Length | None = key(
        None,
        "shortest wavelength of the samples",
        otherwise="with rms 16 um, else all they hold",
        example='"16 um"',
    )
    anisotropy: Annotated[float, BeforeValidator(Number(above=0, at_most=100))] = key(
        1.0, "ratio of the correlation lengths along and across the path", goes_with="rms"
    )
    spectrum: Annotated[str, BeforeValidator(Choice(("iso3095",)))] | None = key(
        None, "one-third-octave wavelength spectrum of the line of the path", example='"iso3095"'
    )
    level: Level = key("+0 dB", "level added to the spectrum", goes_with="spectrum")

    @property
    def has_samples(self) -> bool:
        """Whether there is a 3-D texture, from which stiffness and filters are reduced."""
        return self.file is not None or self.rms is not None

    @property
    def has_line(self) -> bool:
        """Whether the path is given as a line, without the texture beside it."""
        return self.line is not None or self.spectrum is not None

    @property
    def band(self) -> tuple[float | None, float | None]:
        """Longest and shortest wavelength of the samples in m; None where a file decides."""
        if self.rms is None:
            return self.longest, self.shortest
        return self.longest or LONGEST, self.shortest or SHORTEST

    def problems(self) -> Iterator[InputError]:
        """Exactly one source of samples, at most one line, and wavelengths in order."""
        if self.file is not None and self.rms is not None:
            remedy = "Remove one: samples are either measured or synthesised."
            yield InputError("", "both file and rms", "one of them", remedy)
        if self.line is not None and self.spectrum is not None:
            yield InputError(
                "", "both line and spectrum", "one of them", "Remove one: the path has one line."
            )
        if not self.has_samples and not self.has_line:
            remedy = 'Name a measured map (file = "…") or synthesise one (rms = "0.5 um").'
            yield InputError("", "no texture", "file, rms, line or spectrum", remedy)
        longest, shortest = self.band
        if longest is not None and shortest is not None and longest <= shortest:
            received = f"{longest * 1e6:g} um with shortest {shortest * 1e6:g} um"
            yield InputError("longest", received, "a wavelength greater than shortest")


class Ball(Section):
    """The ball that rolls: a rigid mass with its weight, or a given load."""

    radius: Length = key("25 mm", "radius")
    material: Material = key("steel", "material")
    mass: Mass | None = key(None, "mass", otherwise="from radius and density", example='"0.51 kg"')
    load: Force | None = key(
        None, "constant force that presses the ball down", otherwise="its weight", example='"5 N"'
    )


class Beam(Section):
    """The beam that is rolled over: finite, Euler–Bernoulli."""

    length: Length = key("1 m", "length, along the path")
    width: Length = key("50 mm", "width of the cross-section")
    height: Length = key("10 mm", "height of the cross-section")
    material: Material = key("steel", "material")
    support: Annotated[str, BeforeValidator(Choice(("simply-supported", "free", "clamped")))] = key(
        "simply-supported", "both ends"
    )
    loss_factor: Annotated[float, BeforeValidator(Number(at_least=0, at_most=0.5))] = key(
        0.005, "loss factor of every bending mode"
    )
    suspension_frequency: Frequency = key(
        "5 Hz", "natural frequency of the rigid beam on its soft suspension", goes_with="support=free"
    )
    sensors: tuple[Position, ...] | None = key(
        None,
        "positions of the accelerometers from the beam's start",
        otherwise="at 20, 35, 50, 65 and 80 % of the length",
        example='["0.2 m", "0.35 m", "0.5 m", "0.65 m", "0.8 m"]',
    )

    @property
    def sensor_positions(self) -> tuple[float, ...]:
        """Positions of the accelerometers in m, with the default filled in."""
        if self.sensors is not None:
            return self.sensors
        return tuple(share * self.length for share in (0.2, 0.35, 0.5, 0.65, 0.8))

    def problems(self) -> Iterator[InputError]:
        """At least one sensor, and all on the beam."""
        if self.sensors == ():
            yield InputError(
                "sensors", "an empty list", "at least one position", "Remove the key for the default."
            )
        for position in self.sensors or ():
            if position > self.length:
                allowed = f"positions on the beam, 0 to {self.length:g} m"
                yield InputError("sensors", f"{position:g} m", allowed)


class ContactCase(Section):
    """How the rough contact is solved and reduced."""

    spacing: Length = key("8 um", "grid spacing of the contact solution")
    window: Length = key(
        "0.5 mm", "side of the square window in which contact is solved; wider than the contact"
    )
    samples: Annotated[int, BeforeValidator(Number(at_least=1, at_most=10_000, whole=True))] = key(
        8, "number of surface samples for the stiffness and the filters"
    )
    sample_length: Length | None = key(
        None,
        "length of the strips from which filters are estimated",
        otherwise="eight windows, or the length of the map",
        example='"2 mm"',
    )
    approaches: tuple[Approach, ...] | None = key(
        None,
        "approaches of the mean surfaces, increasing, at which the contact is reduced",
        otherwise="chosen from the load and the roughness",
        example='["-0.5 um", "0 um", "1 um"]',
    )
    damping: Damping = key("0 N s/m", "damping of the contact")
    hardness: Pressure | None = key(None, "largest pressure", otherwise="elastic contact", example='"3 GPa"')
    normalise: Annotated[str, BeforeValidator(Choice(("low-wavenumber", "tangent")))] = key(
        "low-wavenumber",
        "what the filter is 1 at: its own low wavenumbers (as printed), or the tangent stiffness",
    )
    linearise: Annotated[str, BeforeValidator(Choice(("hertz", "rough")))] = key(
        "hertz", "which stiffness at the load the linear law has"
    )
    filter_degree: Annotated[int, BeforeValidator(Number(at_least=1, at_most=20, whole=True))] = key(
        6, "degree of the polynomial fitted to each filter, in dB over wavenumber"
    )
    filter_taps: Annotated[int, BeforeValidator(Number(at_least=2, at_most=4096, whole=True))] | None = key(
        None, "order J of the filter (J + 1 taps), even", otherwise="four contact radii long", example="64"
    )

    @property
    def cells(self) -> int:
        """Number of grid cells along one side of the window."""
        return round(self.window / self.spacing)

    def problems(self) -> Iterator[InputError]:
        """The window holds a sensible number of cells; approaches increase; the filter order is even."""
        if not 8 <= self.cells <= MOST_CELLS:
            received = f"{self.window * 1e6:g} um, {self.cells} cells of {self.spacing * 1e6:g} um"
            remedy = "Change window or spacing."
            yield InputError("window", received, f"8 to {MOST_CELLS} cells of the spacing", remedy)
        if self.approaches is not None and len(self.approaches) < 2:
            yield InputError(
                "approaches", f"{len(self.approaches)} values", "at least 2", "Or remove the key."
            )
        if any(later <= earlier for earlier, later in pairwise(self.approaches or ())):
            received = ", ".join(f"{value * 1e6:g} um" for value in self.approaches or ())
            yield InputError("approaches", received, "increasing values", "Sort them, each once.")
        if self.filter_taps is not None and self.filter_taps % 2:
            remedy = "An odd order would shift the texture by half a step."
            yield InputError("filter_taps", self.filter_taps, "an even number", remedy)
        if self.sample_length is not None and self.sample_length < 2 * self.window:
            allowed = f"at least two windows, {2e6 * self.window:g} um"
            yield InputError("sample_length", f"{self.sample_length * 1e6:g} um", allowed)


class Numerics(Section):
    """How finely time is resolved."""

    highest_frequency: Frequency = key("5 kHz", "upper end of the spectra")
    time_step: Duration | None = key(
        None,
        "time step",
        otherwise="near 1/20 of the highest frequency's period, a whole number or fraction of spacing/speed",
        example='"8 us"',
    )
    rtol: Annotated[float, BeforeValidator(Number(above=0, at_most=0.01))] = key(
        1e-6, "tolerance of the contact solution, relative to the largest overlap"
    )


class BallOnBeamCase(Section):
    """A ball rolls over a rough beam.

    Every length, time, force and so on is in SI here; units stand in the case file alone. Each key's meaning,
    default and allowed values are printed by ``asperity new ball-on-beam``.
    """

    kind: Annotated[str, BeforeValidator(Choice(("ball-on-beam",)))] = key("ball-on-beam", "what rolls")
    speed: Speed = key("1 m/s", "rolling speed")
    laws: tuple[Law, ...] = key(
        ("areal", "shifted", "printed", "table", "linear"),
        "laws of the contact force; the first is the main one",
    )
    seed: _Index = key(1, "seed of everything random")
    start: Position = key("0 m", "where on the beam the ball starts")
    duration: Duration | None = key(
        None, "time that is computed", otherwise="until the end of the beam, or of the line", example='"1 s"'
    )
    surface: Surface = key({}, "what is rolled over: a measured map, or synthesised roughness")
    ball: Ball = key({}, "the ball that rolls")
    beam: Beam = key({}, "the beam that is rolled over")
    contact: ContactCase = key({}, "how the rough contact is solved and reduced")
    numerics: Numerics = key({}, "how finely time is resolved")

    _text: str = PrivateAttr("")
    _given: dict[str, Any] = PrivateAttr(default_factory=dict)

    @model_validator(mode="before")
    @classmethod
    def _laws_that_the_surface_allows(cls, data: Any) -> Any:
        """Leave out of the default laws those that need more texture than a line has."""
        if not isinstance(data, dict) or "laws" in data or not isinstance(data.get("surface"), dict):
            return data
        surface = data["surface"]
        if not {"line", "spectrum"} & surface.keys():
            return data
        reduced = ["shifted", "printed", "linear"]
        return {**data, "laws": reduced if {"file", "rms"} & surface.keys() else ["hertz", "linear"]}

    @property
    def text(self) -> str:
        """The TOML text that this case was read from."""
        return self._text

    def parameters(self) -> list[dict[str, Any]]:
        """List the keys that matter in this case, for people.

        Returns
        -------
        list of dict
            For each key: ``key`` (dotted), ``value`` and ``default`` (text with units), ``is_default`` and
            ``note`` (what the key is).
        """
        given = dict(self._given)
        given.setdefault("laws", list(self.laws))
        return parameters(self, given)

    @property
    def time_step(self) -> float:
        """Time step in s: as given, or near 1/(20 f_max) with positions on the grid of the contact solution.

        The distance rolled in one step is then a whole multiple, or a whole fraction, of ``contact.spacing``.
        """
        if self.numerics.time_step is not None:
            return self.numerics.time_step
        per_cell = self.contact.spacing / self.speed
        wanted = 1 / (20 * self.numerics.highest_frequency)
        if wanted >= per_cell:
            return per_cell * math.floor(wanted / per_cell * (1 + 1e-9))
        parts = math.ceil(per_cell / wanted * (1 - 1e-9))
        # on the grid the texture needs no interpolation: rather a slightly longer step than a finer one
        nearest = min((parts, max(parts - 1, 1)), key=lambda n: abs(math.log(per_cell / n / wanted)))
        return per_cell / nearest

    @property
    def rolled_time(self) -> float:
        """Time in s that is computed: as given, or until the end of the beam."""
        return self.duration if self.duration is not None else (self.beam.length - self.start) / self.speed

    def problems(self) -> Iterator[InputError]:
        """What must fit together across the sections."""
        yield from _problems_of_laws(self)
        yield from _problems_of_sampling(self)
        yield from _problems_of_path(self)
        if self.contact.window > 2 * self.ball.radius:
            allowed = f"at most the ball's diameter, {2e3 * self.ball.radius:g} mm"
            yield InputError("contact.window", f"{self.contact.window * 1e3:g} mm", allowed)


def _problems_of_laws(case: BallOnBeamCase) -> Iterator[InputError]:
    if not case.laws:
        yield InputError("laws", "an empty list", "at least one law", 'Take laws = ["areal", "linear"].')
    for law in sorted(set(case.laws)):
        if case.laws.count(law) > 1:
            yield InputError("laws", f'"{law}" more than once', "each law once")
        if case.surface.has_line and law in NEED_AREAL_PATH:
            allowed = "laws that need no texture beside the line: " + _listed(
                set(LAWS) - set(NEED_AREAL_PATH)
            )
            yield InputError("laws", f'"{law}" with a path given as a line', allowed)
        elif not case.surface.has_samples and law not in NEED_NO_SAMPLES:
            remedy = 'Give samples as well: file = "…" or rms = "…" in [surface].'
            yield InputError(
                "laws", f'"{law}" without samples of the surface', _listed(NEED_NO_SAMPLES), remedy
            )

    if case.contact.linearise == "rough" and not case.surface.has_samples:
        yield InputError("contact.linearise", '"rough" without samples of the surface', '"hertz"')


def _problems_of_sampling(case: BallOnBeamCase) -> Iterator[InputError]:
    highest = case.numerics.highest_frequency
    coarsest = case.speed / (SAMPLING * highest)
    spacing, surface = case.contact.spacing, case.surface
    if spacing > coarsest:
        received = f"{spacing * 1e6:g} um at {case.speed:g} m/s and {highest:g} Hz"
        allowed = f"at most speed / ({SAMPLING} highest_frequency) = {coarsest * 1e6:.4g} um"
        yield InputError("contact.spacing", received, allowed, "Refine spacing, or lower highest_frequency.")
    if case.time_step > 1 / (SAMPLING * highest):
        allowed = f"at most 1 / ({SAMPLING} highest_frequency) = {1e6 / (SAMPLING * highest):.4g} us"
        yield InputError("numerics.time_step", f"{case.time_step * 1e6:g} us", allowed)
    shortest = surface.band[1]
    if shortest is not None and shortest < 2 * spacing * (1 - 1e-9):
        received = f"{shortest * 1e6:g} um on a spacing of {spacing * 1e6:g} um"
        yield InputError("surface.shortest", received, f"at least two spacings, {2e6 * spacing:g} um")


def _problems_of_path(case: BallOnBeamCase) -> Iterator[InputError]:
    length = case.beam.length
    if case.start >= length:
        yield InputError("start", f"{case.start:g} m", f"a position on the beam, less than {length:g} m")
    elif case.duration is not None and case.start + case.speed * case.duration > length * (1 + 1e-9):
        received = f"{case.duration:g} s, which ends at {case.start + case.speed * case.duration:g} m"
        allowed = f"at most {(length - case.start) / case.speed:.6g} s, where the beam of {length:g} m ends"
        yield InputError("duration", received, allowed)
    elif case.rolled_time / case.time_step > MOST_STEPS:
        received = f"{case.rolled_time / case.time_step:.2g} time steps"
        yield InputError(
            "duration", received, f"at most {MOST_STEPS:g} time steps", "Roll faster or shorter."
        )


def _listed(words: set[str] | tuple[str, ...]) -> str:
    return ", ".join(f'"{word}"' for word in LAWS if word in words)
