"""The case of any scene: what is chosen where it says nothing, and what must fit together."""

import math
from collections.abc import Iterator, Sequence
from contextlib import suppress
from functools import cached_property
from typing import TYPE_CHECKING, Any, ClassVar, Self

from asperity.case.chosen_lengths import chosen_lengths, shared_lengths
from asperity.case.creep import MOST_CREEPAGE
from asperity.case.rolled_over import TrackKeys
from asperity.case.rolling_case import SAMPLING, RollingCase
from asperity.case.speed import refuse_course
from asperity.case.time_steps import on_grid, resolving
from asperity.errors import InputError
from asperity.laws import Need, Role, baselines, in_role, names, spec_of
from asperity.speeds import SpeedCourse, reached, slowest
from asperity.units import written
from asperity.written_numbers import rounded

if TYPE_CHECKING:
    from asperity.case.across import Meeting

MOST_STEPS = 10**8
STEPS_PER_PERIOD = 20  # of the highest frequency
STEPS_PER_RESONANCE = 12
"""Time steps in a period of the contact resonance, at least, where the case says nothing."""
SHIFTED = "shifted"
"""Main law of those over a line beside samples of the surface."""
SMOOTH = "hertz-filtered"
"""Main law of those over a line where there is no sample of the surface."""
RADIATES = {"rail_radiation", "sleeper_length", "sleeper_width", "wheel_width"}
"""Keys of [noise] of what radiates; all others are of levels beside the track."""
OF_A_TRACK = ("noise", "sideways", "numerics.kernel", "numerics.poles")
"""Sections and keys that mean nothing where no track is rolled over."""


class Case(RollingCase):
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
    DISPLACEMENTS: ClassVar[tuple[str, str]] = ("over_displacement", "rolling_displacement")
    """What displacements at a contact are called in a result: of what is rolled over, and of what rolls."""
    OFFERED: ClassVar[tuple[str, ...]] = (
        "contact_resonance",
        "record_start",
        "rolled_time",
        "smooth_contact",
        "time_step",
    )

    # --- contact and time step

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
        main = SHIFTED if self.surface.has_samples else SMOOTH
        return (main, *(law for law in usual if law in allowed))

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
        line = self.surface.has_line
        smooth = line and not self.surface.has_samples
        yield from self.problems_of_law_keys()
        for law in self.laws:
            if line and spec_of(law).needs_areal_path:
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
        body = self.rolling
        rolling = body.has_own_texture or body.flat is not None
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
        body = self.rolling
        widest = 2 * min(body.radius, body.across, self.rolled_over.radius_across)
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
        semi_axes = self.smooth_contact.semi_axes_under(load)
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


def _allowed(*, line: bool, samples: bool) -> list[str]:
    """Laws that can be rolled over a line, without or with samples of the surface."""
    return [
        name
        for name in names()
        if not (line and spec_of(name).needs_areal_path)
        and (samples or Need.SAMPLES not in spec_of(name).needs)
    ]


def _listed(*, line: bool, samples: bool = True) -> str:
    return ", ".join(f'"{name}"' for name in _allowed(line=line, samples=samples))
