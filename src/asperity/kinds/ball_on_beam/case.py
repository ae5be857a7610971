"""The case of a ball that rolls over a beam: its keys, their defaults, and what must fit together."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Annotated

from asperity.config import values
from asperity.config.case import SETTLED, problem_of_steps, problems_of_sampling
from asperity.config.chosen import NominalPatch
from asperity.config.form import Section, key, optional
from asperity.config.sections import ContactCase, Numerics
from asperity.config.surface_laws import LawsOfSurface, problems_of_surface_laws
from asperity.errors import InputError
from asperity.reference.materials import contact_modulus
from asperity.scenarios.kind import Words
from asperity.structures.body import Ball
from asperity.units import written

LONGEST_SETTLING = 0.2
"""Longest run-in that is chosen, s: after it no one-third octave from 40 Hz on holds the start from rest."""
SETTLING_SHARE = 0.25
"""Share of the beam that a chosen run-in takes at most, where the record lasts until its end."""


class BallCase(Section):
    """The ball that rolls: a rigid mass with its weight, or a given load."""

    radius: values.Length = key("25 mm", "radius", "10 um to 10 m: balls that roll on beams lie between")
    material: values.OwnOrNamed = key("steel", "material")
    mass: values.Mass | None = optional(
        "0.51 kg",
        "mass",
        "from radius and density",
        "1e-12 kg to 1000 t: balls that roll on beams lie between",
    )
    load: values.Force | None = optional(
        "5 N",
        "constant force that presses the ball down",
        "its weight",
        "1 nN to 1 GN: adhesion governs smaller loads",
    )


class BeamCase(Section):
    """The beam that is rolled over: finite, Euler–Bernoulli."""

    length: values.Length = key("1 m", "length, along the path", "1 mm to 1 km: beams lie between")
    width: values.Length = key("50 mm", "width of the cross-section", "1 um to 10 m: beams lie between")
    height: values.Length = key("10 mm", "height of the cross-section", "1 um to 10 m: beams lie between")
    material: values.OwnOrNamed = key("steel", "material")
    support: Annotated[str, values.Choice(("simply-supported", "free", "clamped"))] = key(
        "simply-supported", "both ends"
    )
    loss_factor: Annotated[float, values.Number(at_least=0, at_most=0.5)] = key(
        0.005, "loss factor of every bending mode"
    )
    suspension_frequency: values.Frequency = key(
        "5 Hz",
        "natural frequency of the rigid beam on its soft suspension",
        "1 mHz to 1 kHz: a suspension is softer than the beam",
        goes_with="support=free",
    )
    modes_up_to: values.Frequency | None = optional(
        "20 kHz",
        "natural frequency up to which bending modes are kept",
        "four times the highest frequency of the spectra",
        "0.1 Hz to 100 MHz: rolling is slower than ultrasound",
    )
    sensors: tuple[values.Position, ...] | None = optional(
        ["0.2 m", "0.35 m", "0.5 m", "0.65 m", "0.8 m"],
        "positions of the accelerometers from the beam's start",
        "at 20, 35, 50, 65 and 80 % of the length",
        "0 m to 1 km: beams are shorter",
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


class BallOnBeam(LawsOfSurface):
    """A ball rolls over a rough beam.

    Every length, time, force and so on is in SI here; units stand in the case file alone. Each key's meaning,
    default and allowed values are printed by ``asperity new ball-on-beam``.

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

    kind: Annotated[str, values.Choice(("ball-on-beam",))] = key("ball-on-beam", "what rolls")
    start: values.Position | None = optional(
        "0.2 m",
        "where on the beam the record starts",
        "after the run-in, which begins at the beam's start",
        "0 m to 1 km: beams are shorter",
    )
    duration: values.Duration | None = optional(
        "1 s",
        "time that is recorded",
        "until the end of the beam, or of the line",
        "1 us to 1 h: records lie between",
    )
    settling: values.DurationOrZero | None = optional(
        "0.2 s",
        "time that is rolled before the record starts, so that the start from rest is forgotten",
        "as long as the record, 50 ms to 0.2 s, as far as there is room before it",
        "1 us to 1 h: records lie between",
    )
    ball: BallCase = key({}, "the ball that rolls")
    beam: BeamCase = key({}, "the beam that is rolled over")
    contact: ContactCase = key({}, "how the rough contact is solved and reduced")
    numerics: Numerics = key({}, "how finely time is resolved")

    @property
    def nominal_patch(self) -> NominalPatch:
        """Contact of the smooth ball, from which grid and window are chosen."""
        modulus = contact_modulus(self.ball.material, self.beam.material)
        ball = Ball(self.ball.radius, self.ball.material, self.ball.load, self.ball.mass)
        return NominalPatch.of(modulus, ball.radius, ball.radius, ball.static_load)

    @property
    def settled_time(self) -> float:
        """Time in s that is rolled before the record starts.

        As given; else as long as the record, from `SETTLED` to `LONGEST_SETTLING`, as far as there is room.
        """
        if self.settling is not None:
            return self.settling
        longest, whole = LONGEST_SETTLING, self.beam.length / self.speed
        before = whole if self.start is None else self.start / self.speed
        if self.duration is None:
            return min(longest, before, SETTLING_SHARE * whole)
        wanted = min(max(self.duration, SETTLED), longest)
        return max(min(wanted, before, whole - self.duration), 0.0)

    @property
    def rolled_time(self) -> float:
        """Time in s that is recorded: as given, or until the end of the beam."""
        if self.duration is not None:
            return self.duration
        return (self.beam.length - self.record_start) / self.speed

    def problems(self) -> Iterator[InputError]:
        """What must fit together across the sections."""
        yield from problems_of_surface_laws(self)
        yield from problems_of_sampling(self)
        yield from _problems_of_path(self)
        highest, modes = self.numerics.highest_frequency, self.beam.modes_up_to
        if modes is not None and modes < highest:
            allowed = f"at least numerics.highest_frequency, {written(highest, 'Hz', 'kHz')}"
            yield InputError("beam.modes_up_to", written(modes, "Hz", "kHz"), allowed)
        if self.contact.window > 2 * self.ball.radius:
            allowed = f"at most the ball's diameter, {2e3 * self.ball.radius:g} mm"
            yield InputError("contact.window", written(self.contact.window, "m", "mm"), allowed)


def _problems_of_path(case: BallOnBeam) -> Iterator[InputError]:
    length, start, rolled = case.beam.length, case.record_start, case.rolled_time
    if start >= length:
        what = "start" if case.start is not None else "start, after settling"
        yield InputError(what, f"{start:g} m", f"a position on the beam, less than {length:g} m")
    elif case.speed * case.settled_time > start * (1 + 1e-9):
        received = f"{case.settled_time:g} s, which begins at {case.rolled_range[0]:g} m"
        allowed = f"at most {start / case.speed:.6g} s, so that the run-in begins on the beam"
        yield InputError("settling", received, allowed, "Shorten it, or start farther along the beam.")
    elif start + case.speed * rolled > length * (1 + 1e-9):
        received = f"{rolled:g} s, which ends at {start + case.speed * rolled:g} m"
        allowed = f"at most {(length - start) / case.speed:.6g} s, where the beam of {length:g} m ends"
        yield InputError("duration", received, allowed)
    else:
        yield from problem_of_steps(case, case.settled_time + rolled)


CASE = BallOnBeam
ROLLING = "ball"
WORDS = Words(
    "A ball rolls over a rough beam.",
    " in [surface]: file, rms, line or spectrum",
    {"duration": '"0.12 s"', "settling": '"50 ms"', "surface.rms": '"0.1 um"', "ball.load": '"50 N"'},
)
