"""Beams that are rolled over, of one span or on further supports; and the preset of a ball on one."""

import math
from collections.abc import Iterator
from itertools import pairwise
from typing import TYPE_CHECKING, ClassVar

from asperity.case.body import Rolling
from asperity.case.form import section
from asperity.case.rolled_over import Liveliness, RolledOver, sensors_along
from asperity.case.scene import Case
from asperity.case.surface import OF_RAILS, Surface
from asperity.errors import InputError
from asperity.parameters import (
    FREQUENCY,
    LENGTH,
    LENGTH_OR_ZERO,
    Choice,
    ListOf,
    MaterialOrName,
    Number,
    Quantity,
    key,
    optional,
)
from asperity.reference.materials import Material
from asperity.units import written

if TYPE_CHECKING:
    from asperity.structures.beam import Support
    from asperity.structures.modal import Modal

LEAST_SPAN = 1e-3
"""Least distance of supports over the length of a beam: closer ones clamp it."""
MODES_BEYOND = 4.0
"""Modes of a beam are kept up to this multiple of the highest frequency, where the case says nothing."""


class BeamKeys(RolledOver):
    """A finite Euler–Bernoulli beam, held at its ends, or on further supports along it."""

    length: float = key(LENGTH, "1 m", "length, along the path", "1 mm to 1 km: beams lie between")
    width: float = key(LENGTH, "50 mm", "width of the cross-section", "1 um to 10 m: beams lie between")
    height: float = key(LENGTH, "10 mm", "height of the cross-section", "1 um to 10 m: beams lie between")
    material: Material = key(MaterialOrName(), "steel", "material")
    support: str = key(Choice(("simply-supported", "free", "clamped")), "simply-supported", "both ends")
    loss_factor: float = key(Number(at_least=0, at_most=0.5), 0.005, "loss factor of every bending mode")
    suspension_frequency: float = key(
        FREQUENCY,
        "5 Hz",
        "natural frequency of the rigid beam on its soft suspension",
        "1 mHz to 1 kHz: a suspension is softer than the beam",
        goes_with="support=free",
    )
    supports: tuple[float, ...] | None = optional(
        ListOf(LENGTH_OR_ZERO, least=1),
        ["0.4 m", "0.8 m"],
        "positions of supports beside those of the ends",
        "one span",
        "0 m to 1 km: beams lie between",
    )
    support_stiffness: float = key(
        Quantity("N/m", above=0, infinite=True),
        "inf",
        "stiffness of each of these supports",
        '1 mN/m to 1e15 N/m: stiffer ones are rigid: write "inf"',
        goes_with="supports",
    )
    support_loss_factor: float = key(
        Number(at_least=0, at_most=1), 0.0, "loss factor of these supports", goes_with="supports"
    )
    modes_up_to: float | None = optional(
        FREQUENCY,
        "20 kHz",
        "natural frequency up to which bending modes are kept",
        "four times the highest frequency of the spectra",
        "0.1 Hz to 100 MHz: rolling is slower than ultrasound",
    )
    sensors: tuple[float, ...] | None = sensors_along()

    @property
    def sides(self) -> dict[str, float]:
        """Sides of its section that a contact has to be smaller than, m, by their keys."""
        return {"width": self.width, "height": self.height}

    @property
    def extent(self) -> tuple[float, float]:
        """Where it begins and ends, m."""
        return 0.0, self.length

    def highest_mode(self, highest_frequency: float) -> float:
        """Frequency up to which modes are kept, Hz, for spectra up to a highest one, Hz."""
        return self.modes_up_to or MODES_BEYOND * highest_frequency

    def liveliest(self, highest_frequency: float) -> Liveliness:
        """Of bending modes up to a wavenumber k, some k L/π, none moves by more than twice 1/√mass."""
        highest = self.highest_mode(highest_frequency)
        material = self.material
        stiffness = material.youngs_modulus * self.height**2 / (12.0 * material.density)
        waves = math.sqrt(2.0 * math.pi * highest / math.sqrt(stiffness)) * self.length / math.pi
        mass = material.density * self.length * self.width * self.height
        return Liveliness(highest, 4.0 * (waves + 2.0) / mass)

    def model(self, highest_frequency: float) -> "Modal":
        """Build the beam: of one span, or on further supports."""
        from asperity.structures.beam import Beam, SupportedBeam

        section = (self.length, self.width, self.height, self.material)
        highest = self.highest_mode(highest_frequency)
        if self.supports is not None:
            return SupportedBeam.rectangular(
                *section, self.held, loss_factor=self.loss_factor, highest_frequency=highest
            )
        return Beam.rectangular(
            *section,
            support=self.support,
            loss_factor=self.loss_factor,
            highest_frequency=highest,
            suspension_frequency=self.suspension_frequency,
        )

    @property
    def held(self) -> "list[Support]":
        """All supports, those of the ends among them."""
        from asperity.structures.beam import Support

        ends = {"simply-supported": 0.0, "clamped": math.inf}.get(self.support)
        at_ends = [] if ends is None else [Support(x, rotational_stiffness=ends) for x in (0.0, self.length)]
        stiffness = self.support_stiffness
        loss = self.support_loss_factor
        return [*at_ends, *(Support(x, stiffness, loss_factor=loss) for x in self.supports or ())]

    def problems(self) -> Iterator[InputError]:
        """Sensors, and supports on the beam, in places of their own."""
        yield from self.problems_of_sensors(*self.extent)
        if self.supports is None:
            return
        ends = () if self.support == "free" else (0.0, self.length)
        places = [*ends, *self.supports]
        ordered = sorted(places)
        apart = min((b - a for a, b in pairwise(ordered)), default=self.length)
        if not apart > LEAST_SPAN * self.length or max(places, default=0.0) > self.length:
            received = ", ".join(f"{x:g} m" for x in self.supports)
            least = written(LEAST_SPAN * self.length, "m", "mm")
            on_it = f"different positions on the beam of {self.length:g} m"
            allowed = f"{on_it}, {least} or more apart, none where an end is held"
            yield InputError("supports", received, allowed)
        elif len(places) < 2:
            remedy = "A beam on one support rocks: add another."
            yield InputError("supports", f"{len(places)} of a free beam", "two supports or more", remedy)


class BallOnBeam(Case):
    """A ball rolls over a rough beam.

    Numbers are in SI, or text with its unit. ``asperity new ball-on-beam`` writes these keys as a case file;
    all keys of the body of `Bodies` may stand in the section of the ball.

    Examples
    --------
    >>> from asperity import BallOnBeam
    >>> case = BallOnBeam(speed=2, surface={"rms": "0.5 um"}, ball={"load": 5})  # SI, or with units
    >>> case
    BallOnBeam(speed='2 m/s', surface={'rms': '0.5 um'}, ball={'load': '5 N'})
    >>> other = case.with_(seed=7, contact={"spacing": 4e-6}, **{"ball.load": None})
    >>> print(other.to_toml())
    kind = "ball-on-beam"
    speed = "2 m/s"
    seed = 7
    <BLANKLINE>
    [surface]
    rms = "0.5 um"
    <BLANKLINE>
    [contact]
    spacing = "4 um"
    <BLANKLINE>

    A measured map, or any array of heights, may stand where a case file names a file:

    >>> import numpy as np
    >>> heights = 1e-7 * np.random.default_rng(1).normal(size=(400, 100))
    >>> BallOnBeam(surface={"file": heights, "pixel": "8 um"}).surface.file.shape
    (400, 100)
    """

    TITLE = "A ball rolls over a rough beam."
    ROLLING, OVER = "ball", "beam"
    DISPLACEMENTS = ("beam_displacement", "ball_displacement")
    WRITTEN_OUT: ClassVar = {
        "duration": '"0.12 s"',
        "settling": '"0.3 s"',
        "surface.rms": '"0.1 um"',
        "ball.load": '"50 N"',
    }
    SHOWN: ClassVar = {
        "surface": tuple(name for name in Surface.keys if name not in OF_RAILS),
        "ball": ("radius", "material", "mass", "load"),
        "numerics": ("highest_frequency", "time_step", "rtol", "force_accuracy"),
    }

    kind: str = key(Choice(("ball-on-beam",)), "ball-on-beam", "what rolls")
    ball: Rolling = section(Rolling, "the ball that rolls")
    beam: BeamKeys = section(BeamKeys, "the beam that is rolled over")

    @property
    def title(self) -> str:
        """Say what rolls over what in this case."""
        ball = self.ball.material.name
        beam = self.beam.material.name
        article = "an" if beam[0].lower() in "aeiou8" else "a"
        return f"{ball[0].upper()}{ball[1:]} ball on {article} {beam} beam"
