"""The case of any scene: what rolls over what, by which laws, for how long; and what must fit together."""

import math
from collections.abc import Iterator, Sequence
from contextlib import suppress
from functools import cached_property
from typing import TYPE_CHECKING, Any, ClassVar, Self

from asperity.case.any_case import LAW, AnyCase
from asperity.case.body import Rolling
from asperity.case.chosen_lengths import chosen_lengths, shared_lengths
from asperity.case.creep import MOST_CREEPAGE, CreepKeys
from asperity.case.form import section
from asperity.case.measured_tables import MeasuredKeys
from asperity.case.ready_lists import NamedChanges
from asperity.case.rolled_over import RolledOver, TrackKeys
from asperity.case.sections import ContactKeys, NoiseKeys, NumericsKeys
from asperity.case.speed import Speed, refuse_course
from asperity.case.surface import INDEX, Surface
from asperity.case.time_steps import on_grid, resolving
from asperity.contact.hertz import Hertz, relative_radius
from asperity.errors import InputError
from asperity.laws import Need, Role, baselines, in_role, names, spec_of
from asperity.parameters import DURATION, DURATION_OR_ZERO, LENGTH_OR_ZERO, ListOf, key, optional
from asperity.reference.materials import contact_modulus
from asperity.speeds import SpeedCourse, covered, reached, slowest
from asperity.units import written
from asperity.written_numbers import rounded

if TYPE_CHECKING:
    from asperity.case.across import Meeting
    from asperity.case.sideways import SidewaysKeys
    from asperity.radiation.pass_by import Passage

MOST_STEPS = 10**8
SETTLED = 0.05
"""Run-in after which the force of a record varies as in a long run, within some per cent, s."""
LONGEST_SETTLING = 0.2
"""Longest run-in that is chosen, s: after it no one-third octave from 40 Hz on holds the start from rest."""
SETTLING_SHARE = 0.25
"""Share of a structure that a chosen run-in takes at most, where the record lasts until its end."""
RECORDED = 0.5
"""Record on what is endless, of a case that says nothing of it, s."""
STEPS_PER_PERIOD = 20  # of the highest frequency
STEPS_PER_RESONANCE = 12
"""Time steps in a period of the contact resonance, at least, where the case says nothing."""
SAMPLING = 2.5  # points per period of the highest frequency, at least

SMOOTH = "hertz-filtered"
"""Main law of those where there is no sample of the surface."""
RADIATES = {"rail_radiation", "sleeper_length", "sleeper_width", "wheel_width"}
"""Keys of [noise] of what radiates; all others are of levels beside the track."""
OF_A_TRACK = ("noise", "sideways", "numerics.kernel", "numerics.poles")
"""Sections and keys that mean nothing where no track is rolled over."""


class Case(AnyCase):
    """Bodies roll over a rough surface; a preset names its sections and has defaults of its own.

    Every length, time, force and so on is in SI here. A case does not change; `with_` makes another one.
    Cases are equal if all their keys are.
    """

    PREPARED_BY = "asperity.scenarios.preparing.prepare"
    COMPUTED_BY = "asperity.scenes.result.computed_result"
    PLANNED_BY = "asperity.scenes.planning.planned_scene"
    LAID_BY = "asperity.scenarios.laws.law_on_path"
    SCANNED_BY = "asperity.scenarios.preparing.scan_sizes"
    REFINED_BY = "asperity.scenarios.refining.settings_of_scene"
    PRESSED_BY = "asperity.serving.contact_preview.scene_surface"
    OPTIMISED_BY = "asperity.optimising.running.OF_BODIES"
    ROLLING: ClassVar[str]
    """Section of what rolls; of a contact of several, its name in messages."""
    OVER: ClassVar[str] = ""
    """Section of what is rolled over; empty where the key `over` names it."""
    DISPLACEMENTS: ClassVar[tuple[str, str]] = ("over_displacement", "rolling_displacement")
    """What displacements at a contact are called in a result: of what is rolled over, and of what rolls."""
    OFFERED: ClassVar[tuple[str, ...]] = (
        "contact_resonance",
        "record_start",
        "rolled_time",
        "smooth_contact",
        "time_step",
    )

    speed: float = key(
        Speed("m/s", above=0),
        "1 m/s",
        "rolling speed",
        "0.1 mm/s to 1 km/s: slower rolling is static, and nothing rolls faster",
    )
    laws: tuple[str, ...] = key(
        ListOf(LAW, least=1, once=True),
        ["areal", "shifted", "printed", "table", "linear-filtered", "linear"],
        "laws of the contact force that are computed, others once they are named here; the first is the main "
        "one, direct where a flat or a joint is rolled over",
    )
    seed: int = key(INDEX, 1, "seed of everything random")
    start: float | None = optional(
        LENGTH_OR_ZERO,
        "0.2 m",
        "where the record starts",
        "after the run-in, which begins where what is rolled over does",
        "0 m to 100 km: paths are shorter",
    )
    duration: float | None = optional(
        DURATION,
        "1 s",
        "time that is recorded",
        "until the foremost contact is at the end of what is rolled over, or of the line; on what is endless "
        "0.5 s",
        "1 us to 1 h: records lie between",
    )
    settling: float | None = optional(
        DURATION_OR_ZERO,
        "0.2 s",
        "time that is rolled before the record starts, so that the start from rest is forgotten",
        "as long as the record, 50 ms to 0.2 s, as far as there is room before it; on what is endless 50 ms",
        "1 us to 1 h: records lie between",
    )
    surface: Surface = section(Surface, "what is rolled over: a measured map, or synthesised roughness")
    contact: ContactKeys = section(ContactKeys, "how the rough contact is solved and reduced", last=True)
    numerics: NumericsKeys = section(NumericsKeys, "how finely time, and a track, are resolved", last=True)
    creep: CreepKeys = section(
        CreepKeys, "how what rolls creeps, and, of wheels on a rail, whether they squeal", last=True
    )
    measured: MeasuredKeys = section(
        MeasuredKeys,
        "tables of what was measured, beside which the report states what was computed",
        last=True,
    )

    if TYPE_CHECKING:  # where a track may be rolled over
        track: TrackKeys
        noise: NoiseKeys
        sideways: "SidewaysKeys"

    # --- what rolls over what

    @property
    def rolling(self) -> Rolling:
        """What rolls."""
        rolling: Rolling = getattr(self, self.ROLLING)
        return rolling

    @property
    def rolled_over(self) -> RolledOver:
        """What is rolled over."""
        over: RolledOver = getattr(self, self.OVER)
        return over

    @property
    def helping_changes(self) -> NamedChanges:
        """Changes that may make it quieter: those of what is rolled over, by its own names of sections."""
        own = {"wheel": self.ROLLING}
        listed = self.rolled_over.helping_changes
        return {name: {own.get(key, key): keys[key] for key in keys} for name, keys in listed.items()}

    @property
    def over_name(self) -> str:
        """What is rolled over, in a word."""
        return self.OVER

    @property
    def title(self) -> str:
        """Say what rolls over what in this case."""
        described = self.rolling.described
        return f"{described[0].upper()}{described[1:]} over a {self.over_name}"

    @cached_property
    def smooth_contact(self) -> Hertz:
        """Contact of the smooth bodies, by their relative curvatures along and across the path."""
        body = self.rolling
        over = self.rolled_over
        across = over.radius_across if body.groove_radius is None else -body.groove_radius
        named = "radius and {0}.raceway_radius (m)", "transverse_radius and {0}.groove_radius (m)"
        pairs = zip(named, ((body.radius, body.raceway_along), (body.across, across)), strict=True)
        radii = [
            relative_radius(*each, what=f"{self.ROLLING}.{what}".format(self.ROLLING)) for what, each in pairs
        ]
        return Hertz(contact_modulus(body.material, over.material), *radii)

    @property
    def upper_stiffness(self) -> float:
        """Stiffness, N/m, of the contact above each element of a carriage, which is shaped as that below."""
        if self.rolling.type != "carriage":
            return 0.0
        if self.rolling.springs:
            return self.rolling.springs[0]
        hertz = self.smooth_contact
        return hertz.tangent_stiffness(hertz.approach(self.rolling.upper_load))

    @property
    def contact_resonance(self) -> float:
        """Natural frequency, Hz, of the mass on a contact between smooth bodies at rest."""
        hertz = self.smooth_contact
        below = hertz.tangent_stiffness(hertz.approach(self.rolling.contact_load))
        return math.sqrt((below + self.upper_stiffness) / self.rolling.contact_mass) / (2.0 * math.pi)

    def rolled_in(self, time: float) -> float:
        """How far it rolls in a time from where the record starts, m; negative before it."""
        return covered(self.speed, time)

    @property
    def has_defect(self) -> bool:
        """Whether a flat or a joint is rolled over."""
        return self.rolling.flat is not None or self.surface.joint_depth is not None

    @property
    def defect_length(self) -> float:
        """Length in m of a defect that the window is to hold beside the contact; zero without one."""
        return 0.0 if self.rolling.flat is None else self.rolling.flat[1]

    @property
    def contacts_behind(self) -> tuple[float, ...]:
        """All contacts behind the foremost, m."""
        ahead = sorted(self.rolling.offsets, reverse=True)
        return tuple(ahead[0] - place for place in ahead)

    @cached_property
    def meeting(self) -> "Meeting | None":
        """Where the sections of wheel and rail touch as they lie; None where the case does not say how."""
        if "sideways" not in self.inner or self.sideways.rail_inclination is None:
            return None
        from asperity.case.across import meeting_of

        return meeting_of(self)

    @property
    def contact_places(self) -> tuple[float, float]:
        """Places of the contact on a tread and a rail head, m from their middle, to the field side."""
        given = self.sideways.contact_place if "sideways" in self.inner else 0.0
        if given is not None:
            return given, given
        return (0.0, 0.0) if self.meeting is None else self.meeting.places

    @property
    def passage(self) -> "Passage":
        """The axles that pass a receiver beside the track."""
        return self.noise.passage(self.contacts_behind, self.speed)

    # --- time and place

    @property
    def numbers_written(self) -> float:
        """How many numbers its result holds, at most."""
        return 50.0 * len(self.laws) * self.rolled_time / self.time_step

    @property
    def steps_taken(self) -> int:
        """Time steps of each law, those before the record among them."""
        return round((self.settled_time + self.rolled_time) / self.time_step)

    @property
    def forces_evaluated(self) -> int:
        """How many forces its laws evaluate, of all contacts in all time steps."""
        return self.steps_taken * len(self.rolling.offsets) * len(self.laws)

    @property
    def points_laid(self) -> float:
        """Points of texture that are laid out before anything is computed, at most: those of the path."""
        length = self.rolled_in(self.rolled_time) - self.rolled_in(-self.settled_time)
        return length * self.contact.window / self.contact.spacing**2

    @property
    def room(self) -> tuple[float, float] | None:
        """Positions of the run, m, at which the rearmost contact begins and the foremost is at the end."""
        extent = self.rolled_over.extent
        return None if extent is None else (extent[0], extent[1] - max(self.rolling.offsets))

    @property
    def coarsest_spacing(self) -> float:
        """Spacing of the contact grid in m on which the highest frequency is still resolved."""
        return slowest(self.speed) / (SAMPLING * self.numerics.highest_frequency)

    @property
    def time_step(self) -> float:
        """Time step in s: as given, or near 1/(20 f_max), of a wheel on a rail 1/(8 f_max).

        Shorter where a run could not resolve the contact resonance, modes, or the passing of sleepers:
        `asperity.case.time_steps`. The distance rolled in one step is then a whole multiple, or a whole
        fraction, of ``contact.spacing``.
        """
        return self.chosen_step if self.numerics.time_step is None else self.numerics.time_step

    @property
    def recorded_step(self) -> float:
        """Time between two samples of its records, s: every time step."""
        return self.time_step

    @property
    def highest_frequency(self) -> float:
        """Highest frequency that its spectra hold, Hz."""
        return self.numerics.highest_frequency

    @cached_property
    def chosen_step(self) -> float:
        """Time step in s of a case that gives none."""
        return resolving(self, self.usual_step)

    @property
    def usual_step(self) -> float:
        """Time step in s by the highest frequency, and by the resonance of what rolls."""
        per_cell = self.contact.spacing / self.speed
        usual = on_grid(1 / (STEPS_PER_PERIOD * self.numerics.highest_frequency), per_cell)
        finest = 1.0 / (STEPS_PER_RESONANCE * self.contact_resonance)
        return usual if usual <= finest else on_grid(finest, per_cell)

    def with_chosen(self, **chosen: Any) -> Self:
        """As of any section; what follows from what is chosen is found anew."""
        made = super().with_chosen(**chosen)
        made.__dict__.pop("chosen_step", None)
        return made

    @property
    def record_start(self) -> float:
        """Position in m where the record starts: as given, or after the run-in."""
        beginning = 0.0 if self.room is None else self.room[0]
        return self.start if self.start is not None else beginning - self.rolled_in(-self.settled_time)

    @property
    def settled_time(self) -> float:
        """Time in s that is rolled before the record starts.

        As given; else as long as the record, from `SETTLED` to `LONGEST_SETTLING`, as far as there is room,
        and `SETTLED` on what is endless.
        """
        if self.settling is not None:
            return self.settling
        if self.room is None:
            return SETTLED
        begin, end = self.room
        whole = reached(self.speed, max(end - begin, 0.0))
        before = whole if self.start is None else -reached(self.speed, -max(self.start - begin, 0.0))
        if self.duration is None:
            return min(LONGEST_SETTLING, before, SETTLING_SHARE * whole)
        wanted = min(max(self.duration, SETTLED), LONGEST_SETTLING)
        return max(min(wanted, before, whole - self.duration), 0.0)

    @property
    def rolled_time(self) -> float:
        """Time in s that is recorded: as given, or until the foremost contact is at the end."""
        if self.duration is not None:
            return self.duration
        if self.room is None:
            return self.speed.end if isinstance(self.speed, SpeedCourse) else RECORDED
        return reached(self.speed, self.room[1] - self.record_start)

    @property
    def rolled_range(self) -> tuple[float, float]:
        """First and last position of the contact in m, from the start of the run-in."""
        first = self.record_start + self.rolled_in(-self.settled_time)
        return first, self.record_start + self.rolled_in(self.rolled_time)

    @property
    def point_positions(self) -> tuple[float, ...]:
        """Positions in m at which the rail's motion is recorded."""
        return self.rolled_over.point_positions(self.record_start + self.rolled_in(self.rolled_time) / 2)

    # --- what is chosen, and what must fit together

    def default_of(self, name: str) -> Any:
        """Value of a key that is left out: laws as the surface and its defects ask for them."""
        return self._usual_laws() if name == "laws" else super().default_of(name)

    def _choose(self) -> None:
        with suppress(InputError):  # bodies that do not touch in a point: `problems` say so
            for title, lengths in chosen_lengths(self).items():
                self.__dict__[title] = getattr(self, title).with_chosen(**lengths)
        with suppress(InputError):  # of a track that does not exist
            if isinstance(over := self.rolled_over, TrackKeys):
                self.__dict__[self.OVER] = over.preloaded(self.rolling.contact_load)
        if "laws" not in self.given_names:
            self.__dict__["laws"] = self._usual_laws()

    def _usual_laws(self) -> tuple[str, ...]:
        """Laws of a case that names none."""
        usual: tuple[str, ...] = super().default_of("laws")
        if self.has_defect:
            solved = in_role(Role.REFERENCE, names())
            return (*([solved] if solved else []), *baselines(usual))
        if not self.surface.has_line:
            return usual
        allowed = _allowed(line=True, samples=self.surface.has_samples)
        smooth = () if self.surface.has_samples else (SMOOTH,)
        return (*smooth, *(law for law in usual if law in allowed))

    @property
    def cells_at_rims(self) -> tuple[str, ...]:
        """How cells at the rims of its contacts may count: both ways where that is chosen by its texture."""
        asked = self.contact.rim_cells
        if asked != "auto":
            return (asked,)
        return ("whole", "covered") if any(spec_of(law).sees_heights for law in self.laws) else ("whole",)

    @classmethod
    def shared_keys(cls, cases: Sequence[Self]) -> dict[str, float]:
        """Lengths that were chosen otherwise for some of several cases than for others, fit for all."""
        return shared_lengths(cases)

    def problems(self) -> Iterator[InputError]:
        """What must fit together across the sections: bodies that touch in a point first."""
        try:
            self.contact_resonance  # noqa: B018  of what it is made of, all is checked
        except InputError as error:
            yield error.about(f"{self.ROLLING}.{error.what}") if error.what == "load" else error
            return
        yield from self._problems_of_laws()
        yield from self._problems_of_texture()
        yield from self._problems_of_sampling()
        yield from self._problems_of_room()
        yield from self._problems_of_over()
        yield from self._problem_of_spin()
        yield from self.own_problems()

    def own_problems(self) -> Iterator[InputError]:
        """What must fit together in scenes of this kind alone."""
        yield from ()

    def _problems_of_laws(self) -> Iterator[InputError]:
        """Laws that need no more texture than there is."""
        smooth = self.surface.has_line and not self.surface.has_samples
        yield from self.problems_of_law_keys()
        for law in self.laws:
            if self.surface.has_line and spec_of(law).needs_areal_path:
                allowed = "laws that need no texture beside the line: " + _listed(line=True)
                yield InputError("laws", f'"{law}" with a path given as a line', allowed)
            elif smooth and Need.SAMPLES in spec_of(law).needs:
                remedy = 'Give samples as well: file = "…" or rms = "…" in [surface].'
                allowed = _listed(line=True, samples=False)
                yield InputError("laws", f'"{law}" without samples of the surface', allowed, remedy)
        if self.contact.linearise == "rough" and smooth:
            yield InputError("contact.linearise", '"rough" without samples of the surface', '"hertz"')

    def _problems_of_texture(self) -> Iterator[InputError]:
        """Some texture, and waves that the grid resolves."""
        surface = self.surface
        spacing = self.contact.spacing
        rolling = self.rolling.has_own_texture or self.rolling.flat is not None
        if not (surface.has_texture or rolling or surface.smooth):
            allowed = (
                f"file, rms, line, spectrum or a defect in [surface]; roughness, line or a flat in "
                f"[{self.ROLLING}]"
            )
            remedy = (
                'Name a measured map (file = "…"), synthesise one (rms = "0.5 um"), or set smooth = true.'
            )
            yield InputError("surface", "no texture", allowed, remedy)
        # a sine of two points a wave may be zero at each of them
        for name, unit, least in (("shortest", "um", 2), ("corrugation_wavelength", "mm", SAMPLING)):
            wave = getattr(surface, name)
            if wave is not None and wave < least * spacing * (1 - 1e-9):
                received = f"{written(wave, 'm', unit)} on a spacing of {written(spacing, 'm', unit)}"
                count = "two" if least == 2 else f"{least:g}"
                allowed = f"at least {count} spacings, {written(least * spacing, 'm', unit)}"
                yield InputError(f"surface.{name}", received, allowed)

    def _problems_of_sampling(self) -> Iterator[InputError]:
        """Grid and time step resolve the highest frequency; the window is no wider than the bodies."""
        yield from self.contact.problems_of_window()
        highest = self.numerics.highest_frequency
        coarsest = self.coarsest_spacing
        spacing = self.contact.spacing  # fmt: skip
        if spacing > coarsest:
            received = f"{written(spacing, 'm', 'um')} at {slowest(self.speed):g} m/s and {highest:g} Hz"
            allowed = f"at most speed / ({SAMPLING} highest_frequency) = {rounded(coarsest * 1e6, 4)} um"
            remedy = "Refine spacing, or lower highest_frequency."
            yield InputError("contact.spacing", received, allowed, remedy)
        if self.time_step > 1 / (SAMPLING * highest):
            allowed = (
                f"at most 1 / ({SAMPLING} highest_frequency) = {rounded(1e6 / (SAMPLING * highest), 4)} us"
            )
            yield InputError("numerics.time_step", f"{self.time_step * 1e6:g} us", allowed)
        widest = 2 * min(self.rolling.radius, self.rolling.across, self.rolled_over.radius_across)
        if self.contact.window > widest:
            allowed = f"at most the smallest diameter of the bodies, {written(widest, 'm', 'mm')}"
            yield InputError("contact.window", written(self.contact.window, "m", "mm"), allowed)

    def _problems_of_room(self) -> Iterator[InputError]:
        """The contacts stay on what they roll over for as long as they are rolled, in steps that are few."""
        start = self.record_start
        rolled = self.rolled_time
        first, last = self.rolled_range
        over = self.over_name
        time = self.settled_time + rolled
        begin, end = self.room or (-math.inf, math.inf)
        foremost = ", where the foremost contact is at its end" if len(self.contacts_behind) > 1 else ""
        if end <= begin:
            received = f"contacts over {self.contacts_behind[-1]:g} m"
            length = end - begin + max(self.rolling.offsets)
            allowed = f"less than the length of the {over}, {length:g} m"
            yield InputError(f"{self.ROLLING}.positions", received, allowed)
        elif start >= end:
            what = "start" if self.start is not None else "start, after settling"
            allowed = f"a position on the {over}, less than {end:g} m{foremost}"
            yield InputError(what, f"{start:g} m", allowed)
        elif first < begin - 1e-9 * max(start, 1.0):
            received = f"{self.settled_time:g} s, which begins at {first:g} m"
            before = -reached(self.speed, -max(start - begin, 0.0))
            allowed = f"at most {before:.6g} s, so that the run-in begins on the {over}"
            remedy = f"Shorten it, or start farther along the {over}."
            yield InputError("settling", received, allowed, remedy)
        elif last > end * (1 + 1e-9):
            received = f"{rolled:g} s, which ends at {last:g} m"
            allowed = (
                f"at most {reached(self.speed, end - start):.6g} s, up to {end:g} m on the {over}{foremost}"
            )
            yield InputError("duration", received, allowed)
        elif rolled < self.time_step:
            allowed = f"at least one time step, {self.time_step * 1e3:.4g} ms"
            yield InputError("duration", f"{rolled * 1e3:.4g} ms", allowed)
        elif time / self.time_step > MOST_STEPS:
            received = f"{rounded(time / self.time_step, 2)} time steps"
            allowed = f"at most {rounded(MOST_STEPS)} time steps"
            yield InputError("duration", received, allowed, "Roll faster or shorter.")

    def _problems_of_over(self) -> Iterator[InputError]:
        """What is rolled over suits the run; a joint is on the path; what a track alone has has a track."""
        first, last = self.rolled_range
        joint = self.surface.joint_position
        if joint is not None and not first <= joint <= last:
            allowed = f"a position that is rolled over, {first:g} m to {last:g} m"
            yield InputError("surface.joint_position", f"{joint:g} m", allowed)
        ahead = self.rolling.offsets
        start = self.record_start
        try:
            if any(self.creep.creepage):
                refuse_course(self.speed, "of what creeps")
        except InputError as error:
            yield error
            return
        yield from self.rolled_over.problems_of_run(self.speed, start + min(ahead), last + max(ahead))
        if isinstance(self.rolled_over, TrackKeys):
            yield from self.noise.problems_of_train(self.contacts_behind)
            yield from self._problems_of_levels()
            yield from self._problem_of_place()
            yield from self._problem_of_web()
            return
        for dotted in OF_A_TRACK:
            title, _, name = dotted.partition(".")
            for given in sorted(getattr(self, title).given() if title in self.inner else ()):
                if name in ("", given):
                    allowed = f"what a {self.over_name} has"
                    yield InputError(f"{title}.{given}", "a key of a track", allowed, "Remove it.")

    def _problems_of_levels(self) -> Iterator[InputError]:
        """Keys of levels beside the track, which are those of one speed."""
        of_levels = self.noise.given().keys() - RADIATES
        for name in sorted(of_levels) if isinstance(self.speed, SpeedCourse) else ():
            remedy = "Give a constant speed, or remove it."
            allowed = (
                "at a constant speed alone: no level beside the track is computed of a speed that changes"
            )
            yield InputError(f"noise.{name}", "a key of levels beside the track", allowed, remedy)

    def _problem_of_spin(self) -> Iterator[InputError]:
        """A spin that moves the rim of the smooth contact no faster than other creepages may."""
        load = self.rolling.contact_load
        semi_axes = self.smooth_contact.semi_axes(self.smooth_contact.approach(load))
        spin = self.creep.spin or 0.0
        most = MOST_CREEPAGE / max(semi_axes)
        if abs(spin) > most:
            allowed = f"at most {rounded(most)} rad/m, a creepage of {MOST_CREEPAGE:g} at the contact's rim"
            yield InputError("creep.spin", f"{rounded(abs(spin))} rad/m", allowed)

    def _problem_of_place(self) -> Iterator[InputError]:
        """A contact on the rail head."""
        half = 0.5 * self.track.rail_head_width
        try:
            _, place = self.contact_places
        except InputError as error:
            yield error
            return
        if abs(place) > half:
            received = written(place, "m", "mm")
            allowed = f"at most {written(half, 'm', 'mm')} off the middle"
            remedy = "The rail head, track.rail_head_width, is no wider."
            yield InputError("sideways.contact_place", received, allowed, remedy)

    def _problem_of_web(self) -> Iterator[InputError]:
        """A rail whose web bends, if one is told, has a section that can be."""
        if "sideways" in self.inner and self.sideways.is_active("web_height"):
            try:
                self.sideways.model(self.track.model().regular, self.track.rail_foot_width)
            except InputError as error:
                yield error.about(f"sideways: {error.what}")


def _allowed(*, line: bool, samples: bool = True) -> list[str]:
    """Laws that can be rolled over a line, without or with samples of the surface."""
    return [
        name
        for name in names()
        if not (line and spec_of(name).needs_areal_path)
        and (samples or Need.SAMPLES not in spec_of(name).needs)
    ]


def _listed(*, line: bool, samples: bool = True) -> str:
    return ", ".join(f'"{name}"' for name in _allowed(line=line, samples=samples))
