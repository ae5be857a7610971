"""A ball bearing that runs under a load: its rings, what they carry, and how it is computed."""

from __future__ import annotations

import math
from collections.abc import Iterator
from functools import cached_property
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np

from asperity.case.any_case import LAW, AnyCase
from asperity.case.bearing_sections import (
    DAMPED,
    LOAD,
    LOADS,
    AroundKeys,
    BearingGeometry,
    FaultKeys,
    HousingKeys,
    ShaftKeys,
)
from asperity.case.creep import BallCreepKeys
from asperity.case.form import section
from asperity.case.lubricant import LubricantKeys
from asperity.case.measured_tables import MeasuredBearingKeys
from asperity.case.ready_lists import IN_BEARINGS, NamedChanges, listed_changes
from asperity.case.speed import Speed, span_of
from asperity.case.surface import INDEX
from asperity.errors import InputError, PhysicsWarning
from asperity.laws import spec_of
from asperity.parameters import (
    ANGLE,
    DAMPING,
    DURATION,
    DURATION_OR_ZERO,
    FREQUENCY,
    Choice,
    Flag,
    ListOf,
    Number,
    Quantity,
    key,
    optional,
)
from asperity.rolling.resolution import PER_MODE
from asperity.speeds import FEWEST_TURNS, SpeedCourse, covered, reached
from asperity.structures.ball_bearing import BallBearing
from asperity.structures.modal import HIGHEST
from asperity.structures.rolling_bearing import PARTS, Kinematics
from asperity.units import written
from asperity.written_numbers import in_newtons, rounded

if TYPE_CHECKING:
    from asperity.contact.film import Film
    from asperity.contact.friction import Friction
    from asperity.contact.hertz import Hertz
    from asperity.structures.bearing_statics import LoadedBearing
    from asperity.structures.ring import Around, Ring

SAMPLING = 2.56
"""Samples per period of the highest frequency that a record holds, as analysers have it."""
STEPS_PER_PERIOD = 10
"""Time steps per period of that frequency, and of a ball's resonance between the rings, at least: a contact
that becomes stiffer by four under impacts would be softened by fewer."""
MOST_STEPS = 10**8
"""Time steps of all balls: 4 GB while they roll."""
FEWEST = 5.0
"""Periods of the slowest tone in a record, at least."""
_SPEED = Speed("Hz", "1/min", above=0)
_BAND = ListOf(Quantity("Hz", at_least=0), least=2)
_ANGLES = ListOf(ANGLE, least=1)
_SLIPS = ListOf(Number(at_least=0, at_most=0.2), least=2)


class BearingUnderLoad(AnyCase):
    """A ball bearing runs under a constant load.

    Numbers are in SI, or text with its unit. ``asperity new ball-bearing`` writes these keys as a case file.

    Examples
    --------
    >>> from asperity import BearingUnderLoad
    >>> case = BearingUnderLoad(speed="1797 1/min", radial=100, bearing={"name": "6205"})
    >>> f"{case.kinematics.ball_pass_outer:.1f} Hz"
    '107.4 Hz'
    """

    TITLE = "A ball bearing runs under a load."
    NEEDED = "a bearing and its load"
    PREPARED_BY = "asperity.scenarios.prepared_bearing.prepare_bearing"
    COMPUTED_BY = "asperity.scenes.bearing.bearing_result"
    PLANNED_BY = "asperity.scenarios.prepared_bearing.planned_bearing"
    LAID_BY = "asperity.scenarios.prepared_bearing.law_on_raceway"
    REFINED_BY = "asperity.scenes.bearing_refining.settings_of_bearing"
    PRESSED_BY = "asperity.serving.contact_preview.raceway_surface"
    OPTIMISED_BY = "asperity.optimising.bearing.OF_BEARINGS"
    WRITTEN_OUT: ClassVar = {
        "bearing.name": '"6205"', "axial": '"100 N"', "inner_raceway.waviness": '"0.5 um"',
        "outer_raceway.waviness": '"0.5 um"',
    }  # fmt: skip

    kind: str = key(Choice(("ball-bearing",)), "ball-bearing", "what rolls")
    speed: float = key(
        _SPEED, "1800 1/min", "speed of the ring that turns", "0.001 Hz to 10 kHz: bearings turn slower"
    )
    radial: float = key(LOAD, "0 N", "radial load of the inner on the outer ring", LOADS)
    axial: float = key(LOAD, "0 N", "axial load of the inner on the outer ring", LOADS)
    rotating: float = key(
        LOAD,
        "0 N",
        "radial load that turns with the ring that turns: 100 g mm of unbalance are 3.6 N at 1800 1/min",
        LOADS,
    )
    laws: tuple[str, ...] = key(
        ListOf(LAW, least=1, once=True),
        ["table", "hertz"],
        "laws of the contact force; the first is the main one, direct for a few turns at most",
    )
    seed: int = key(INDEX, 1, "seed of everything random")
    duration: float = key(DURATION, "1 s", "time that is recorded", "1 ms to 1 h: records lie between")
    settling: float = key(
        DURATION_OR_ZERO,
        "0.1 s",
        "time that it runs before the record, so that the start is forgotten",
        "1 us to 1 h: records lie between",
    )
    time_step: float | None = optional(
        DURATION,
        "4 us",
        "time step",
        "a tenth of a ball's period, or of the highest frequency; a quarter of a ring's highest mode",
        "1 ns to 1 ms: bearings ring between",
    )
    sampling_rate: float = key(
        FREQUENCY,
        "51.2 kHz",
        "samples per second of what is written",
        "1 kHz to 1 MHz: bearings are measured between",
    )
    sensors: tuple[float, ...] = key(
        _ANGLES,
        ["0 deg"],
        "angles of accelerometers on the outer ring",
        "-360 deg to 360 deg: a turn ends there",
    )
    envelope_band: tuple[float, ...] | None = optional(
        _BAND,
        ["2 kHz", "6 kHz"],
        "band of the envelope",
        "the most impulsive one",
        "1 Hz to 500 kHz: bearings ring between",
    )
    contact_damping: float = key(DAMPING, "20 N s/m", "damping of each contact without oil", DAMPED)
    centrifugal: bool = key(Flag(), True, "whether balls press the outer ring as they go round")
    cage_slip: tuple[float, ...] = key(
        _SLIPS, [0.0, 0.0], "least and largest share by which the cage lags, drawn anew at each turn"
    )
    friction: float | None = optional(
        Number(at_least=0.001, at_most=1),
        0.1,
        "coefficient of friction of balls on raceways, up to which a contact sticks",
        "friction is not looked at",
        "0.01 to 0.5: balls in oil and dry ones lie between",
    )
    wear_coefficient: float | None = optional(
        Number(above=0, at_most=1),
        1e-8,
        "Archard's k: volume that wears off a raceway, times its hardness, over load times sliding",
        "nothing wears",
        "1e-12 to 0.1: surfaces in full films and dry ones lie between",
    )
    bearing: BearingGeometry = section(BearingGeometry, "the bearing: named, or by its dimensions")
    shaft: ShaftKeys = section(ShaftKeys, "what the inner ring carries, and what holds it")
    housing: HousingKeys = section(
        HousingKeys,
        "what the outer ring carries, and what holds it",
        mass="0.06 kg",
        radial_stiffness="0 N/m",
        axial_stiffness="0 N/m",
    )

    lubricant: LubricantKeys = section(LubricantKeys, "the oil: a film in each contact, dry without it")
    inner_raceway: AroundKeys = section(AroundKeys, "what is on the inner raceway all around")
    outer_raceway: AroundKeys = section(AroundKeys, "what is on the outer raceway all around")
    balls: AroundKeys = section(AroundKeys, "what is on each ball all around")
    fault: FaultKeys = section(
        FaultKeys, "a fault of a raceway or of a ball; of several each below [[fault]]", repeated=True
    )
    creep: BallCreepKeys = section(BallCreepKeys, "how friction of balls falls where they slip", last=True)
    measured: MeasuredBearingKeys = section(
        MeasuredBearingKeys,
        "tables of what was measured, beside which the report states what was computed",
        last=True,
    )

    # --- what follows from the keys

    def default_of(self, name: str) -> Any:
        """Value of a key that is left out: a run-up is recorded until it ends."""
        if name == "duration" and isinstance(self.speed, SpeedCourse):
            return self.speed.end
        return super().default_of(name)

    def _choose(self) -> None:
        if "duration" not in self.given_names:
            self.__dict__["duration"] = self.default_of("duration")

    @property
    def helping_changes(self) -> NamedChanges:
        """Changes that may make it quieter: clearance, preload, grooves, waves of each part, …."""
        return listed_changes(IN_BEARINGS)

    @property
    def title(self) -> str:
        """Say what runs."""
        name = f" {self.bearing.name}" if self.bearing.name else ""
        element = self.bearing.bearing.ELEMENT.capitalize()
        return f"{element} bearing{name} at {span_of(self.speed, 'Hz', '1/min')}"

    @cached_property
    def static(self) -> LoadedBearing:
        """The bearing under its load while it turns, at angles of the cage over the passing of a ball."""
        with PhysicsWarning.ignored():  # told when it is prepared
            return self.loaded()

    def loaded(self) -> LoadedBearing:
        """The same with its warnings."""
        speed = self.speed if self.centrifugal else 0.0
        return self.bearing.bearing.loaded(self.radial, self.axial, speed=speed, **self.held)

    @property
    def tilts(self) -> dict[str, float]:
        """Tilts of the inner ring, rad, by the names of their keys, where there are any: balls have none."""
        return {}

    @property
    def held(self) -> dict[str, float]:
        """How the inner ring is held at rest beside its load."""
        return {}

    @property
    def faults(self) -> dict[str, FaultKeys]:
        """All faults by the names of their sections, ``fault``, ``fault[2]`` …; none where there are none."""
        numbers = (name for name in self.section_names if name.startswith("fault["))
        sections = {name: getattr(self, name) for name in ("fault", *numbers)}
        return {name: each for name, each in sections.items() if each.on or len(sections) > 1}

    @property
    def has_smooth_balls(self) -> bool:
        """Whether nothing is on any ball."""
        return not (self.elements.given() or any(each.part == "ball" for each in self.faults.values()))

    @property
    def elements(self) -> AroundKeys:
        """What is on each ball, or on each roller."""
        on_each: AroundKeys = getattr(self, self.called("balls"))
        return on_each

    def _problems_of_speed(self, leaving: float | None) -> Iterator[InputError]:
        """Balls that leave the inner ring at a speed, turns per second, or push the outer one off."""
        if leaving is not None:
            upto = "up to " * isinstance(self.speed, SpeedCourse)
            received = f"{upto}{rounded(60.0 * self.speed, 5)} 1/min, which lifts balls off the inner ring"
            allowed = (
                f"less than {rounded(60.0 * leaving, 5)} 1/min, or a larger axial load or bearing.preload"
            )
            yield InputError("speed", received, allowed)
        elif (share := self._thrown_share()) >= 1.0:
            pushed = in_newtons(share * (self.axial + self.bearing.bearing.preload))
            received = f"{rounded(60.0 * self.speed, 5)} 1/min, by which balls push the outer ring off with "
            slower = f"less than {rounded(60.0 * self.speed / math.sqrt(share), 3)} 1/min"
            allowed = f"{slower}, a larger axial load, or a housing.axial_stiffness"
            remedy = "Both contacts of a ball keep one angle as it rolls."
            if self.speed > self.bearing.bearing.fastest:
                remedy += f' Is the speed in 1/min? Then write "{rounded(self.speed, 5)} 1/min".'
            yield InputError("speed", f"{received}{pushed} along the axis", allowed, remedy)

    def _thrown_share(self) -> float:
        """Axial force of balls that are thrown against a free outer ring, over the load that holds it.

        In rolling both contacts of a ball have one angle, so that its force along them moves no ball aside.
        """
        of = self.bearing.bearing
        angle = self.static.contact_angle
        load = self.axial + of.preload
        if self.housing.axial_stiffness or not (angle and load and self.centrifugal):
            return 0.0
        return 0.5 * math.sin(2.0 * angle) * of.balls * of.centrifugal_force(self.speed) / load

    @cached_property
    def kinematics(self) -> Kinematics:
        """What turns how fast, without slip, at the contact angle of the load."""
        return self.bearing.bearing.kinematics(self.speed, contact_angle=self.static.contact_angle)

    @cached_property
    def contacts(self) -> tuple[tuple[Hertz, float], tuple[Hertz, float]]:
        """Smooth contacts of a ball with the inner and the outer ring, and their largest static loads, N."""
        of = self.bearing.bearing
        found = self.static
        loads = float(found.inner_load.max()), float(found.outer_load.max())
        return (of.inner_contact, loads[0]), (of.outer_contact, loads[1])

    @property
    def passing_speeds(self) -> tuple[float, float]:
        """Speeds with which contacts move along the inner and the outer raceway, m/s."""
        return self.kinematics.passing_speeds(self.bearing.bearing.raceway_radii)

    @cached_property
    def films(self) -> tuple[Film, Film] | None:
        """Films of oil in the contacts with the inner and the outer ring, if there is oil."""
        inner, outer = (
            self.lubricant.film(contact, speed)
            for (contact, _), speed in zip(self.contacts, self.passing_speeds, strict=True)
        )
        return None if inner is None or outer is None else (inner, outer)

    @property
    def dampings(self) -> tuple[float, float]:
        """Damping of a contact with the inner and with the outer ring, N s/m."""
        if self.films is None:
            return self.contact_damping, self.contact_damping
        inner, outer = (
            self.lubricant.damping(film, load)
            for film, (_, load) in zip(self.films, self.contacts, strict=True)
        )
        return inner, outer

    @cached_property
    def ball_resonance(self) -> float:
        """Natural frequency, Hz, of the most loaded ball between both rings at rest."""
        stiffness = sum(each.stiffness_under(load) for each, load in self.contacts)
        return math.sqrt(stiffness / self.bearing.bearing.ball_mass) / (2.0 * math.pi)

    def bending_rings(self) -> tuple[Around | None, Ring | Around | None]:
        """How the inner and the outer ring bend, where they do: by modes, or the outer one by its lobes."""
        from asperity.structures.ring import Ring

        angle = self.static.contact_angle
        outer = self.housing
        of = self.bearing.bearing
        if outer.lobes is None:
            return self.shaft.bending(angle), outer.bending(angle)
        radius = of.raceway_radii[1] + 0.5 * outer.thickness
        mass = of.material.density * 2.0 * np.pi * radius * outer.width * outer.thickness
        stiffness = of.material.youngs_modulus * outer.width * outer.thickness**3 / 12.0
        lobes: dict[str, Any] = {"most_lobes": outer.lobes, "damping_ratio": outer.damping_ratio}
        return self.shaft.bending(angle), Ring.bending(mass, radius, stiffness, angle, **lobes)

    @cached_property
    def resolved_rate(self) -> float:
        """Time steps in a second, 1/s, by which the contacts of balls and the modes of rings are resolved.

        Contacts ring against balls and against a ring that moves on those of all balls together.
        """
        from asperity.structures.ring import Ring

        of = self.bearing.bearing
        angle = self.static.contact_angle
        at_balls = 2.0 * np.pi / of.balls * np.arange(of.balls)
        found = self.resolving(self.ball_resonance)
        rings = zip((self.shaft, self.housing), self.bending_rings(), self.contacts, strict=True)
        for ring, bending, (contact, load) in rings:
            shapes = Ring.rigid(ring.mass, angle).shapes(at_balls)[0]
            if bending is not None:
                shapes = np.hstack([shapes, bending.shapes(at_balls)[0]])
                modes = bending.natural_frequencies
                found = max(found, PER_MODE * float(modes[modes <= HIGHEST].max(initial=0.0)))
            moved = 1.0 / of.ball_mass + np.linalg.norm(shapes, 2) ** 2
            resonance = math.sqrt(contact.stiffness_under(load) * moved) / (2.0 * math.pi)
            found = max(found, self.resolving(resonance))
        return found

    def resolving(self, resonance: float) -> float:
        """Time steps in a second, 1/s, that a resonance of contacts, Hz, takes."""
        return STEPS_PER_PERIOD * resonance

    @property
    def highest_frequency(self) -> float:
        """Highest frequency that the record holds, Hz."""
        return self.sampling_rate / SAMPLING

    @property
    def recorded_step(self) -> float:
        """Time between two samples that are written, s."""
        return 1.0 / self.sampling_rate

    @cached_property
    def steps_per_sample(self) -> int:
        """Time steps between two samples that are written."""
        wanted = 1.0 / max(self.resolved_rate, STEPS_PER_PERIOD * self.highest_frequency)
        return max(1, math.ceil(1.0 / (self.sampling_rate * (self.time_step or wanted)) * (1.0 - 1e-9)))

    @property
    def step(self) -> float:
        """Time step, s, of which a whole number lies between two samples."""
        return 1.0 / (self.sampling_rate * self.steps_per_sample)

    @property
    def numbers_written(self) -> float:
        """How many numbers its result holds, at most."""
        of_a_ball = 5 if self.friction is None else 7
        each = of_a_ball * self.bearing.bearing.balls + 10
        return len(self.laws) * each * self.duration * self.sampling_rate

    @property
    def steps_taken(self) -> int:
        """Time steps of each law, those before the record among them."""
        return round((self.settling + self.duration) / self.step)

    @property
    def forces_evaluated(self) -> int:
        """How many forces its laws evaluate, of all contacts in all time steps."""
        return self.steps_taken * self.bearing.bearing.balls * len(self.laws)

    def _problems_of_films(self) -> Iterator[InputError]:
        """Laws with which a film may be in series."""
        for number, law in enumerate(self.laws if self.films else (), 1):
            if spec_of(law).solved_every_step:
                allowed = "laws that are not solved in every step, where a film of oil is in series"
                yield InputError(f"laws[{number}]", f'"{law}"', allowed, "Take it out, or leave out the oil.")

    def _problems_of_creep(self) -> Iterator[InputError]:
        """Friction that falls is there, and falls at one speed of slip."""
        for name, given in self.creep.given().items():
            received = rounded(given)
            if self.friction is None:
                yield InputError(f"creep.{name}", received, "only together with friction")
            elif isinstance(self.speed, SpeedCourse):
                allowed = "friction that stays where the speed changes"
                yield InputError(f"creep.{name}", received, allowed, "Give a constant speed, or remove it.")

    @property
    def friction_law(self) -> Friction | None:
        """Friction of balls on raceways, if it is looked at."""
        return None if self.friction is None else self.creep.law(self.friction)

    def problems(self) -> Iterator[InputError]:
        """A load that is carried, at a speed at which balls stay between the rings; and a record of it."""
        yield from self.problems_of_law_keys()
        try:
            leaving = self.static.leaving_speed
        except InputError as error:
            heavier = "radial" if self.radial >= self.axial else "axial"
            keys = {"load": heavier, "contact": heavier, "axial load": "axial"}
            yield error.about(keys.get(error.what, error.what))
            return
        yield from self._problems_of_speed(leaving)
        yield from self._problems_of_films()
        yield from self._problems_of_creep()
        yield from self._problems_of_grooves()
        yield from self._problems_of_faults()
        yield from self._problems_of_envelope()
        yield from self._problems_of_record()
        for way in ("radial", "axial") if self.static.contact_angle else ("radial",):
            if not any(getattr(keys, f"{way}_stiffness") for keys in (self.shaft, self.housing)):
                received = "0 N/m of [shaft] and of [housing]"
                allowed = "one of them that holds its ring"
                yield InputError(f"shaft.{way}_stiffness", received, allowed)

    def _problems_of_grooves(self) -> Iterator[InputError]:
        """What grooves of one arc alone have."""
        of = self.bearing.bearing
        if isinstance(of, BallBearing) and of.arches:
            for name in ("friction", "wear_coefficient"):
                if (given := getattr(self, name)) is not None:
                    allowed = "none of gothic arches: on two flanks a ball spins on both rings"
                    yield InputError(name, f"{given:g}", allowed, "Leave it out.")

    def _problems_of_faults(self) -> Iterator[InputError]:
        """Faults on parts that are there."""
        balls = self.bearing.bearing.balls
        for name, fault in self.faults.items():
            if fault.on is None:
                allowed = fault.keys["on"].kind.allowed
                yield InputError(f"{name}.on", "nothing", allowed, "Or remove the section.")
            if fault.number > balls:
                element = fault.ELEMENT
                allowed = f"1 to {balls}, as many {element}s as there are"
                yield InputError(f"{name}.{element}", f"{fault.number}", allowed)

    def _problems_of_envelope(self) -> Iterator[InputError]:
        """A band of the envelope that is sampled, and wider than the fastest tone; pairs that do not fall."""
        for name in ("cage_slip", "envelope_band"):
            pair = getattr(self, name)
            if pair is not None and (len(pair) != 2 or pair[0] > pair[1]):
                yield InputError(name, ", ".join(f"{each:g}" for each in pair), "two values that do not fall")
        if self.envelope_band is not None and self.envelope_band[-1] > 0.5 * self.sampling_rate:
            received = f"up to {self.envelope_band[-1]:g} Hz"
            allowed = f"{0.5 * self.sampling_rate:g} Hz"
            yield InputError("envelope_band", received, f"at most half the sampling_rate, {allowed}")
        tones = [self.kinematics.tone(part) for part in PARTS]
        if self.envelope_band is not None and np.ptp(self.envelope_band) < 1.1 * max(tones):
            received = f"a width of {np.ptp(self.envelope_band):g} Hz"
            allowed = f"more than the fastest tone, {rounded(max(tones), 4)} Hz, and a tenth"
            yield InputError("envelope_band", received, allowed, "Take a wider band.")

    def _problems_of_record(self) -> Iterator[InputError]:
        """A record in which every tone comes some times, and which can be computed."""
        tones = [self.kinematics.tone(part) for part in PARTS]
        turns = FEWEST * self.speed / min(tones)
        if covered(self.speed, self.duration) < turns:
            least = f"{1e3 * reached(self.speed, turns):.4g} ms"
            allowed = f"at least {least}, in which the slowest tone comes {FEWEST:g} times"
            yield InputError("duration", written(self.duration, "s", "ms"), allowed)
        if isinstance(self.speed, SpeedCourse) and self.speed.covered(self.duration) < FEWEST_TURNS:
            least = f"{1e3 * self.speed.reached(FEWEST_TURNS):.4g} ms"
            allowed = f"at least {least}, in which a run-up turns {FEWEST_TURNS:g} times"
            yield InputError("duration", written(self.duration, "s", "ms"), allowed)
        steps = (self.duration + self.settling) / self.step * self.bearing.bearing.balls
        if steps > MOST_STEPS:
            received = f"{rounded(steps, 2)} time steps of balls"
            allowed = f"at most {rounded(MOST_STEPS)}"
            yield InputError("duration", received, allowed, "Record several shorter times.")
