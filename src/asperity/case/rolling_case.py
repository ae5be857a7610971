"""What rolls over what, how fast and for how long: the keys of a scene, and what follows of these alone."""

import math
from functools import cached_property
from typing import TYPE_CHECKING, ClassVar

from asperity.case.any_case import LAW, AnyCase
from asperity.case.body import Rolling
from asperity.case.creep import CreepKeys
from asperity.case.form import section
from asperity.case.measured_tables import MeasuredKeys
from asperity.case.ready_lists import NamedChanges
from asperity.case.rolled_over import RolledOver, TrackKeys
from asperity.case.sections import ContactKeys, NoiseKeys, NumericsKeys
from asperity.case.speed import Speed
from asperity.case.surface import INDEX, Surface
from asperity.contact.hertz import Hertz, relative_radius
from asperity.parameters import DURATION, DURATION_OR_ZERO, LENGTH_OR_ZERO, ListOf, key, optional
from asperity.reference.materials import contact_modulus
from asperity.speeds import SpeedCourse, covered, reached, slowest

if TYPE_CHECKING:
    from asperity.case.sideways import SidewaysKeys
    from asperity.radiation.pass_by import Passage

SETTLED = 0.05
"""Run-in after which the force of a record varies as in a long run, within some per cent, s."""
LONGEST_SETTLING = 0.2
"""Longest run-in that is chosen, s: after it no one-third octave from 40 Hz on holds the start from rest."""
SETTLING_SHARE = 0.25
"""Share of a structure that a chosen run-in takes at most, where the record lasts until its end."""
RECORDED = 0.5
"""Record on what is endless, of a case that says nothing of it, s."""
SAMPLING = 2.5  # points per period of the highest frequency, at least


class RollingCase(AnyCase):
    """Bodies roll over a rough surface: grid and time step may still be chosen."""

    ROLLING: ClassVar[str]
    """Section of what rolls; of a contact of several, its name in messages."""
    OVER: ClassVar[str] = ""
    """Section of what is rolled over; empty where the key `over` names it."""

    speed: float = key(
        Speed("m/s", above=0),
        "1 m/s",
        "rolling speed",
        "0.1 mm/s to 1 km/s: slower rolling is static, and nothing rolls faster",
    )
    laws: tuple[str, ...] = key(
        ListOf(LAW, least=1, once=True),
        ["areal", "linear-filtered"],
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

    @cached_property
    def resting_stiffness(self) -> float:
        """Stiffness, N/m, of each contact between smooth bodies at rest."""
        return self.smooth_contact.stiffness_under(self.rolling.contact_load)

    @cached_property
    def upper_stiffness(self) -> float:
        """Stiffness, N/m, of the contact above each element of a carriage, which is shaped as that below."""
        rolling = self.rolling
        if rolling.type != "carriage":
            return 0.0
        if rolling.springs:
            return rolling.springs[0]
        return self.smooth_contact.stiffness_under(rolling.upper_load)

    @cached_property
    def contact_resonance(self) -> float:
        """Natural frequency, Hz, of the mass on a contact between smooth bodies at rest."""
        stiffness = self.resting_stiffness + self.upper_stiffness
        return math.sqrt(stiffness / self.rolling.contact_mass) / (2.0 * math.pi)

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

    @property
    def passage(self) -> "Passage":
        """The axles that pass a receiver beside the track."""
        return self.noise.passage(self.contacts_behind, self.speed)

    # --- time and place

    @cached_property
    def room(self) -> tuple[float, float] | None:
        """Positions of the run, m, at which the rearmost contact begins and the foremost is at the end."""
        extent = self.rolled_over.extent
        return None if extent is None else (extent[0], extent[1] - max(self.rolling.offsets))

    @property
    def coarsest_spacing(self) -> float:
        """Spacing of the contact grid in m on which the highest frequency is still resolved."""
        return slowest(self.speed) / (SAMPLING * self.numerics.highest_frequency)

    @property
    def points_laid(self) -> float:
        """Points of texture that are laid out before anything is computed, at most: those of the path."""
        length = self.rolled_in(self.rolled_time) - self.rolled_in(-self.settled_time)
        return length * self.contact.window / self.contact.spacing**2

    @property
    def highest_frequency(self) -> float:
        """Highest frequency that its spectra hold, Hz."""
        return self.numerics.highest_frequency

    @cached_property
    def record_start(self) -> float:
        """Position in m where the record starts: as given, or after the run-in."""
        beginning = 0.0 if self.room is None else self.room[0]
        return self.start if self.start is not None else beginning - self.rolled_in(-self.settled_time)

    @cached_property
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

    @cached_property
    def rolled_time(self) -> float:
        """Time in s that is recorded: as given, or until the foremost contact is at the end."""
        if self.duration is not None:
            return self.duration
        if self.room is None:
            return self.speed.end if isinstance(self.speed, SpeedCourse) else RECORDED
        return reached(self.speed, self.room[1] - self.record_start)

    @cached_property
    def rolled_range(self) -> tuple[float, float]:
        """First and last position of the contact in m, from the start of the run-in."""
        first = self.record_start + self.rolled_in(-self.settled_time)
        return first, self.record_start + self.rolled_in(self.rolled_time)

    @property
    def point_positions(self) -> tuple[float, ...]:
        """Positions in m at which the rail's motion is recorded."""
        return self.rolled_over.point_positions(self.record_start + self.rolled_in(self.rolled_time) / 2)
