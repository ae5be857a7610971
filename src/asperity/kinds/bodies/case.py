"""The case of bodies that roll over any structure: its keys, their defaults, and what must fit together."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING, Annotated

import numpy as np

from asperity.config import values
from asperity.config.case import SETTLED, problem_of_steps, problems_of_sampling, time_step_on_grid
from asperity.config.chosen import NominalPatch
from asperity.config.form import key, optional
from asperity.config.sections import ContactCase, Numerics
from asperity.config.surface_laws import LawsOfSurface, problems_of_surface_laws
from asperity.errors import InputError
from asperity.kinds.bodies.body_keys import BodyCase
from asperity.kinds.bodies.structure_keys import BeamOnSupports, StructureCase
from asperity.kinds.wheel_on_rail.noise_keys import NoiseOfBodies
from asperity.kinds.wheel_on_rail.track_keys import PassedTrack
from asperity.scenarios.kind import Words
from asperity.units import written

if TYPE_CHECKING:
    from asperity.radiation.pass_by import Passage
    from asperity.structures.track import Track

STRUCTURES = ("plane", "beam", "track", "structure")
"""What may be rolled over; but for the plane, each is a section of the case."""
STEPS_PER_RESONANCE = 12
"""Time steps in a period of the contact resonance, at least, where the case says nothing."""
RECORDED_ON_ENDLESS = 0.5
"""Record on a plane or a track where the case says nothing, s."""


class Bodies(LawsOfSurface):
    """Bodies roll, one or many, over a plane, a beam, a track, or any structure that is known by its modes.

    Every length, time, force and so on is in SI here; units stand in the case file alone. Each key's meaning,
    default and allowed values are printed by ``asperity new bodies``.

    Examples
    --------
    >>> from asperity import Bodies
    >>> bogie = {"type": "bogie", "masses": [3000], "springs": [1.2e6], "distance": 2.5, "mass": 600}
    >>> case = Bodies(over="track", speed=30, body=bogie, surface={"rms": "5 um"})
    >>> case.body.offsets
    (0.0, 2.5)
    """

    kind: Annotated[str, values.Choice(("bodies",))] = key("bodies", "what rolls")
    over: Annotated[str, values.Choice(STRUCTURES)] = key(
        "beam", "what is rolled over: a rigid plane, or what the section of this name describes"
    )
    start: values.Position | None = optional(
        "0.2 m",
        "where the record starts",
        "after the run-in, which begins at 0 m",
        "0 m to 100 km: paths are shorter",
    )
    duration: values.Duration | None = optional(
        "1 s",
        "time that is recorded",
        "until the foremost contact reaches the end of the structure; on a plane or a track 0.5 s",
        "1 us to 1 h: records lie between",
    )
    settling: values.DurationOrZero | None = optional(
        "0.2 s",
        "time that is rolled before the record starts, so that the start from rest is forgotten",
        "50 ms, or a quarter of what there is room for",
        "1 us to 1 h: records lie between",
    )
    body: BodyCase = key({}, "what rolls")
    beam: BeamOnSupports = key({}, "a beam that is rolled over")
    track: PassedTrack = key({}, "a track that is rolled over")
    structure: StructureCase = key({}, "any other structure that is rolled over, by its modes or receptances")
    contact: ContactCase = key({}, "how the rough contact is solved and reduced")
    numerics: Numerics = key({}, "how finely time is resolved")
    noise: NoiseOfBodies = key({}, "what radiates, where a track is rolled over")

    @property
    def nominal_patch(self) -> NominalPatch:
        """Smooth contact of each body, from which grid and window are chosen."""
        from asperity.kinds.bodies.bodies import load_of, smooth_contact

        hertz = smooth_contact(self)
        return NominalPatch.of(hertz.modulus, hertz.radius_x, hertz.radius_y, load_of(self))

    @property
    def tread(self) -> BodyCase:
        """What touches a rail."""
        return self.body

    @property
    def tread_name(self) -> str:
        """Section that describes what touches a rail."""
        return "body"

    @property
    def rolling_radius(self) -> float:
        """Radius of what rolls, m."""
        return self.body.radius

    @property
    def axles(self) -> int:
        """Number of axles whose sound power is added: the contacts."""
        return len(self.body.offsets)

    @property
    def axles_behind(self) -> tuple[float, ...]:
        """Places of all axles behind the foremost, m."""
        ahead = sorted(self.body.offsets, reverse=True)
        return tuple(ahead[0] - place for place in ahead)

    @property
    def passage(self) -> Passage:
        """The axles that pass a receiver beside the track."""
        return self.noise.passing(self.axles_behind, self.speed)

    def track_model(self) -> Track:
        """Build the track of this case."""
        return self.track.model()

    @property
    def room(self) -> float | None:
        """Position of the run in m at which the foremost contact is at the end; None where there is none."""
        end = self.beam.length if self.over == "beam" else None
        if self.over == "structure" and self.structure.is_known:
            end = self.structure.model.extent[1]
        return None if end is None else end - max(self.body.offsets)

    @property
    def beginning(self) -> float:
        """Position in m before which nothing can be rolled over."""
        known = self.over == "structure" and self.structure.is_known
        return self.structure.model.extent[0] if known else 0.0

    @property
    def record_start(self) -> float:
        """Position in m where the record starts: as given, or after the run-in."""
        return self.start if self.start is not None else self.beginning + self.speed * self.settled_time

    @property
    def settled_time(self) -> float:
        """Time in s that is rolled before the record starts: as given, or `SETTLED` where there is room."""
        if self.settling is not None:
            return self.settling
        if self.room is None:
            return SETTLED
        return min(SETTLED, 0.25 * max(self.room - self.beginning, 0.0) / self.speed)

    @property
    def rolled_time(self) -> float:
        """Time in s that is recorded: as given, or until the foremost contact is at the end."""
        if self.duration is not None:
            return self.duration
        return RECORDED_ON_ENDLESS if self.room is None else (self.room - self.record_start) / self.speed

    @property
    def contact_resonance(self) -> float:
        """Natural frequency, Hz, of the mass on a contact between smooth bodies at rest."""
        from asperity.kinds.bodies.bodies import static_stiffness

        return float(np.sqrt(static_stiffness(self) / self.body.contact_mass) / (2.0 * np.pi))

    @property
    def time_step(self) -> float:
        """Time step in s: as given, or as of all cases with 12 steps in a period of the contact resonance.

        The latter governs light rolling elements alone. Positions are on the grid of the contact solution.
        """
        usual = super().time_step
        if self.numerics.time_step is not None:
            return usual
        finest = 1.0 / (STEPS_PER_RESONANCE * self.contact_resonance)
        return usual if usual <= finest else time_step_on_grid(finest, self.contact.spacing / self.speed)

    def problems(self) -> Iterator[InputError]:
        """What must fit together across the sections: bodies that touch in a point first."""
        from asperity.kinds.bodies.bodies import static_stiffness

        try:
            static_stiffness(self)
        except InputError as error:
            yield error
            return
        yield from problems_of_surface_laws(self)
        yield from problems_of_sampling(self)
        yield from _problems_of_structure(self)
        yield from _problems_of_room(self)


def _problems_of_structure(case: Bodies) -> Iterator[InputError]:
    """Only what is rolled over is described, and it is."""
    for name in STRUCTURES[1:]:
        section = getattr(case, name)
        named = section.given().keys() - (
            {"material"} if (name, case.over) == ("structure", "plane") else set()
        )
        if name != case.over and named:
            received = f"a [{name}] that is not rolled over: {', '.join(sorted(named))}"
            yield InputError(
                "over", f'"{case.over}"', f'"{name}", where it is described', f"Remove {received}."
            )
    if case.over == "structure" and not case.structure.is_known:
        remedy = 'As file = "guide.csv".'
        yield InputError("structure.file", "nothing", "the file of its modes, or receptances", remedy)
    if case.over != "track":
        if given := case.noise.given():
            received = f"a [noise] of what is rolled over a {case.over}: {', '.join(sorted(given))}"
            yield InputError("noise", received, 'over = "track"', "Remove it: a track alone sounds here.")
        return
    yield from case.track.problems_at(case.speed)
    ahead, rolled = case.record_start + min(case.body.offsets), case.speed * case.rolled_time
    yield from case.track.problems_of_points(ahead, ahead + rolled + max(case.body.offsets))
    yield from case.noise.problem_of_length(case.axles_behind, "noise.vehicle_length")


def _problems_of_room(case: Bodies) -> Iterator[InputError]:
    """The contacts stay on the structure for as long as they are rolled."""
    room, start, rolled = case.room, case.record_start, case.rolled_time
    farthest = max(case.body.offsets)
    if room is not None and room <= case.beginning:
        received = f"contacts over {farthest:g} m"
        allowed = f"less than the length of what they roll over, {room + farthest - case.beginning:g} m"
        yield InputError("body.positions", received, allowed)
    elif room is not None and start >= room:
        yield InputError(
            "start", f"{start:g} m", f"less than {room:g} m, where the foremost contact is at the end"
        )
    elif case.rolled_range[0] < case.beginning - 1e-9 * max(start, 1.0):
        received = f"{case.settled_time:g} s, which begins at {case.rolled_range[0]:g} m"
        before = max(start - case.beginning, 0.0) / case.speed
        allowed = f"at most {before:.6g} s, so that the run-in begins at {case.beginning:g} m or later"
        yield InputError("settling", received, allowed, "Shorten it, or start farther on.")
    elif room is not None and start + case.speed * rolled > room * (1 + 1e-9):
        received = f"{rolled:g} s, in which the foremost contact leaves the structure"
        allowed = f"at most {(room - start) / case.speed:.6g} s"
        yield InputError("duration", received, allowed)
    else:
        yield from problem_of_steps(case, case.settled_time + rolled)
    widest = 2 * min(case.body.radius, case.body.across)
    if case.contact.window > widest:
        allowed = f"at most the smaller diameter of what rolls, {written(widest, 'm', 'mm')}"
        yield InputError("contact.window", written(case.contact.window, "m", "mm"), allowed)


CASE = Bodies
ROLLING = "body"
WORDS = Words(
    "Bodies roll over a structure.",
    " in [surface]: file, rms, line or spectrum",
    {"duration": '"0.12 s"', "surface.rms": '"0.1 um"', "body.load": '"50 N"'},
)
