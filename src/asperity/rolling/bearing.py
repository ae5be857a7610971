"""A ball bearing turns: each ball between both rings, on raceways that it rolls over."""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from itertools import product
from typing import Self

import numpy as np

from asperity.arguments import Array, ArrayLike, finite_array, positive, require
from asperity.laws.linear import Linear
from asperity.laws.spec import Law
from asperity.progress import Progress
from asperity.rolling.driver import RolledMechanism, rests_of, roll_mechanism
from asperity.rolling.ledger import Ledger
from asperity.rolling.mechanism import Mechanism, RollingContact, Side
from asperity.rolling.soundness import STILL, without_rounding
from asperity.rolling.trajectory import Trajectory, Values, at_steps
from asperity.speeds import SpeedCourse
from asperity.store import Checkpoint
from asperity.structures.ball_bearing import BallBearing
from asperity.structures.body import Body
from asperity.structures.ring import Around, Direction, Ring
from asperity.structures.roller_bearing import AnyBearing, RollerBearing
from asperity.written_numbers import count_of

RINGS = ("inner", "outer")
INNER, OUTER = 0, 1
"""Places of the rigid rings among the structures; those that bend follow."""
INSTANTS = 12
"""Places of the cage, while a ball passes, over which the static displacement is averaged."""
HELD = 1e5
"""Hz, of an outer ring that is held while the inner one is looked at."""
TURN = 2.0 * math.pi
SOFT = 1.0
"""N/m, of the springs whose force is a load that rotates: where rings move by micrometres, it is constant."""

SHORT = 1e-3
"""Arm on which such a spring presses a ball: the time step has not to resolve it beside the contacts."""


@dataclass(frozen=True, eq=False)
class BearingRings:
    """The rings of a bearing and what holds them: rigid, and bending beside it.

    Parameters
    ----------
    inner, outer : Ring
        Rigid, see `Ring.rigid`, with the contact angle of the run.
    inner_bending, outer_bending : Ring or Around, optional
        See `Ring.bending`, or any modes, as of the housing; they turn with their ring.
    """

    inner: Ring
    outer: Ring
    inner_bending: Ring | Around | None = None
    outer_bending: Ring | Around | None = None

    @property
    def bending(self) -> dict[int, tuple[int, Ring | Around]]:
        """Rings that bend, and their places among the structures, by the places of the rigid ones."""
        given = ((INNER, self.inner_bending), (OUTER, self.outer_bending))
        there = [(ring, each) for ring, each in given if each is not None]
        return {ring: (place, each) for place, (ring, each) in enumerate(there, OUTER + 1)}

    @property
    def structures(self) -> list[Ring | Around]:
        """All of them: both rigid ones first."""
        return [self.inner, self.outer, *(each for _, each in self.bending.values())]


Sensor = tuple[str, float, Direction]
"""The ring that bears it, its angle, rad, and its direction."""
AXES: tuple[tuple[float, Direction], ...] = ((0.0, "radial"), (0.5 * math.pi, "radial"), (0.0, "axial"))
"""Angle and direction along the radial load, across it and along the axis."""


@dataclass(frozen=True, eq=False)
class RolledBearing:
    """A bearing has turned; n steps of the record, Z balls. Forces in N, angles in rad, motion in m."""

    time: Array  # (n,), s, from zero, after the run-in
    cage: Array  # (n,), angle of the first ball from the radial load
    inner_force: Array  # (Z, n), compression positive; of an arch both flanks together
    outer_force: Array  # (Z, n)
    ball_motion: Array  # (Z, n), outwards along the contacts' normal; between arches radially
    # (2 Z, n), of arches as of `contact_force` what the flanks against a negative axial load carry; else none
    flank_force: Array
    rib_force: Array  # (Z, n), of the rib on tapered rollers along their axis; without rows of all others
    inner_motion: Array  # (3, n), along the radial load, across it, along the axis
    outer_motion: Array  # (3, n)
    acceleration: Array  # (sensors, n), m/s²
    reached: Array  # (2, 2), least and largest force with inner and outer ring, in run-in and run
    softening: Array  # (2, Z), of the contacts with both rings, by the time step, m/N
    energy: Ledger
    unconverged_steps: int

    @property
    def contact_force(self) -> Array:
        """Forces of all contacts (2 Z, n), N: of all balls with the inner ring, then with the outer one."""
        return np.concatenate([self.inner_force, self.outer_force])

    @property
    def vibrates(self) -> bool:
        """Whether any force varies by more than its tolerance."""
        return any(
            bool((np.ptp(force, axis=1) > STILL * np.abs(force).max()).any())
            for force in (self.inner_force, self.outer_force)
        )

    def steadied(self) -> Self:
        """The same, where nothing vibrates without what rounding leaves of motion and forces."""
        if self.vibrates:
            return self
        names = "inner_motion", "outer_motion", "inner_force", "outer_force", "flank_force"
        return without_rounding(self, *names, "rib_force", "ball_motion", energy=self.energy.of_nothing)


def roll_bearing(
    bearing: AnyBearing,
    rings: BearingRings,
    inner_law: Law | Sequence[Law],
    outer_law: Law | Sequence[Law],
    *,
    speed: float,
    radial: float = 0.0,
    axial: float = 0.0,
    rotating: float = 0.0,
    duration: float,
    time_step: float,
    settling: float = 0.0,
    ball_heights: Sequence[ArrayLike] = (),
    slip: Callable[[Array], Array] | None = None,
    centrifugal: bool = True,
    tilt: float = 0.0,
    rotating_tilt: float = 0.0,
    sensors: Sequence[Sensor] = (),
    highest_frequency: float | None = None,
    progress: Progress | None = None,
    checkpoint: Checkpoint | None = None,
) -> RolledBearing:
    """Turn a bearing under a constant load, and keep what follows the run-in.

    Every ball is a mass between two contacts, one with each ring, along the normal at the contact angle of
    the rings. Forces act between the rings: on the inner one as given, on the outer one against it; springs
    of shaft and housing are free of force where the bearing carries its load, on average over the places of
    the cage. Nothing slides, so that balls and cage follow the kinematics, but for a slip of the cage.

    Parameters
    ----------
    bearing : BallBearing or RollerBearing
        Its geometry and speeds.
    rings : BearingRings
        At least one of them must be held, radially, and axially where contacts carry an axial load.
    inner_law, outer_law : Law, or sequence of Law
        Of the contact with each raceway, known for positions from 0 to the circumference 2πR,
        ``bearing.raceway_radii``; damping is theirs. Those of a sequence, one for each ball, are laid out on
        positions (n, 2): that one, and the angle of the spot of the ball that touches, rad.
    speed : float
        Of the ring that turns, turns per second; or an `asperity.speeds.SpeedCourse`.
    radial, axial : float
        Load, N; the preload of the bearing is added to the axial one.
    rotating : float
        Radial force on the ring that turns, N, which turns with it, as that of an unbalance; along the radial
        load at time zero. Where the speed changes, that at the fastest: it goes with the square of the speed.
    duration, time_step, settling : float
        s.
    ball_heights : sequence of array_like, optional
        Of each ball its heights along the circle that rolls, closed, at even angles, m, positive out of the
        material; averaged over the patch already.
    slip : callable, optional
        Share by which the cage is slower at times (n,), s, than in pure rolling.
    centrifugal : bool
        Whether balls press outwards as they run around.
    tilt, rotating_tilt : float
        Of the inner ring against the outer one, rad, as of `RollerBearing.loaded`: in the plane of the radial
        load; and one that turns with the ring that turns, in that plane at time zero. With either the laws
        are `asperity.laws.tilted.Tilted`, and a roller lies in the middle between the rings, which is where
        moments of two contacts alike are in balance.
    sensors : sequence of (ring, angle, direction)
        As ``("outer", 0.0, "radial")``, whose acceleration is recorded; of a ring that turns rigid motion.
    highest_frequency : float, optional
        Hz, against which the time step is checked.
    progress, checkpoint : optional
        As in `asperity.rolling.roll.roll_bodies`.

    Returns
    -------
    RolledBearing
    """
    total = round(settling / time_step) + round(duration / time_step)
    turning = _Turning(bearing, rings, speed, time_step, settling, total, slip, (tilt, rotating_tilt))
    mechanism = turning.mechanism((inner_law, outer_law), ball_heights, centrifugal=centrifugal)
    loads = radial, axial + bearing.preload
    contacts = len(mechanism.contacts)
    thrown = turning.thrown_on_ribs() if centrifugal else []
    mechanism = turning.loaded(replace(mechanism, contacts=[*mechanism.contacts, *thrown]), loads)
    mechanism = replace(mechanism, contacts=[*mechanism.contacts, *turning.driven_round(rotating)])
    run = roll_mechanism(
        mechanism,
        turning.usual_load(*loads),
        time_step=time_step,
        duration=duration,
        settling=settling,
        sensors=_rows_of(mechanism, rings, bearing, sensors),
        highest_frequency=highest_frequency,
        progress=progress,
        checkpoint=checkpoint,
    )
    return turning.recorded(run, contacts // bearing.balls, centrifugal=centrifugal)


@dataclass(eq=False)
class _Turning:
    """Angles of everything at every step, and how fast they grow.

    Angles are those of the speed, where it changes of the fastest, times what `_time` then is: the time in
    which that turns as far.
    """

    bearing: AnyBearing
    rings: BearingRings
    speed: float
    time_step: float
    settling: float
    total: int
    slip: Callable[[Array], Array] | None
    tilts: tuple[float, float] = (0.0, 0.0)

    def __post_init__(self) -> None:
        positive("speed (1/s)", self.speed)
        self.contact_angle = self.rings.inner.contact_angle
        pure = self.bearing.kinematics(self.speed, contact_angle=self.contact_angle)
        self.turns = pure.inner, pure.outer
        time = self._clock(range(self.total + 1))
        slips = np.zeros(time.size) if self.slip is None else self.slip(time)
        slips = finite_array("slip of the cage", slips, "below 1", count=time.size, below=1.0)
        self._rate = rate = TURN * pure.cage * (1.0 - slips) * self._share(range(self.total + 1))
        done = np.concatenate([[0.0], np.cumsum(0.5 * (rate[1:] + rate[:-1])) * self.time_step])
        self._cage = done - done[round(self.settling / self.time_step)]
        self._angles: dict[float, Array] = {}
        self._spin = TURN * pure.spin
        mass = self.bearing.ball_mass
        middle = 0.5 * self.bearing.pitch_diameter
        self.centrifugal_force = mass * middle * (TURN * pure.cage) ** 2
        self.centrifugal_force *= self.bearing.flung_outwards(self.contact_angle)

    def _clock(self, steps: range) -> Array:
        return np.asarray(self.time_step * np.arange(steps.start, steps.stop, steps.step) - self.settling)

    def _time(self, steps: range) -> Array:
        time = self._clock(steps)
        if isinstance(self.speed, SpeedCourse):
            return self.speed.covered(time) / float(self.speed)
        return time

    def _share(self, steps: range) -> Array:
        """Speed in shares of the fastest: how much longer `_time` grows in a second."""
        if isinstance(self.speed, SpeedCourse):
            return self.speed.at(self._clock(steps)) / float(self.speed)
        return np.ones(len(steps))

    def _beside_fastest(self, force: float) -> Values | None:
        """Heights of a soft spring whose force, N, falls with the square of the speed; none if constant."""
        if not isinstance(self.speed, SpeedCourse):
            return None
        return lambda steps: force / SOFT * (self._share(steps) ** 2 - 1.0)

    def cage(self, steps: range) -> Array:
        """Angle of the first ball."""
        return at_steps(self._cage, steps)

    def _first_ball(self, turned: float) -> Array:
        """Angle of the first ball at all steps, in a frame that turns by as much in a second, rad."""
        if turned not in self._angles:
            self._angles[turned] = self._cage - turned * self._time(range(self.total + 1))
        return self._angles[turned]

    def azimuth(self, ball: int, ring: int | None = None) -> Trajectory:
        """Angle of a ball, in the frame of a ring that turns if there is one."""
        ahead = TURN * ball / self.bearing.balls
        turned = 0.0 if ring is None else TURN * self.turns[ring]
        first = self._first_ball(turned)

        def places(steps: range) -> Array:
            return at_steps(first, steps) + ahead

        def rates(steps: range) -> Array:
            return at_steps(self._rate, steps) - turned * self._share(steps)

        even = bool(np.all(self._rate == self._rate[0])) and not isinstance(self.speed, SpeedCourse)
        return Trajectory(places, rates, self.time_step * (self._rate[0] - turned) if even else None)

    def on_raceway(self, ball: int, ring: int) -> Values:
        """Position of a ball along a raceway, m, from 0 to its circumference."""
        radius = self.bearing.raceway_radii[ring]
        azimuth = self.azimuth(ball, ring).places

        def along(steps: range) -> Array:
            turns = azimuth(steps) / TURN
            return radius * TURN * (turns - np.floor(turns))

        return along

    def spot(self, ring: int) -> Values:
        """Angle of the spot of a ball that touches a ring; the spots are opposite."""
        return lambda steps: self._spin * self._time(steps) + (0.0 if ring else math.pi)

    def beside(self, ball: int, ring: int, other: Values) -> Values:
        """The same beside what else a law is laid out on (n, 2)."""
        both = self.on_raceway(ball, ring), other
        return lambda steps: np.column_stack([each(steps) for each in both])

    def tilted(self, ball: int, factor: float) -> Values:
        """Tilt of the inner ring in the plane of a ball, rad, times a factor."""
        standing, turning = self.tilts
        still = self.azimuth(ball).places
        along = self.azimuth(ball, RINGS.index(self.bearing.turning)).places
        return lambda steps: factor * (standing * np.cos(still(steps)) + turning * np.cos(along(steps)))

    def usual_load(self, radial: float, axial: float) -> float:
        """Contact force by which tolerances are measured, N: that of the ball that carries most, about."""
        sine = math.sin(self.contact_angle)
        overlap = max(-self.bearing.apart(self.contact_angle), 0.0)
        shared = (5.0 * radial + (axial / sine if sine else 0.0)) / self.bearing.balls
        return shared + self.bearing.interference_force(overlap)

    def mechanism(
        self,
        laws: tuple[Law | Sequence[Law], Law | Sequence[Law]],
        ball_heights: Sequence[ArrayLike],
        *,
        centrifugal: bool,
    ) -> Mechanism:
        """Balls outwards along the normal, first on the inner ring, then on the outer one.

        Where the speed changes, a soft spring presses each ball outwards, by as much as it then runs around.
        """
        of = self.bearing
        bending = self.rings.bending
        allowed = f"{of.balls}, one line for each ball, or none"
        require(len(ball_heights) in (0, of.balls), "heights of the balls", len(ball_heights), allowed)
        arm = 0.5 * of.pitch_diameter * math.sin(self.contact_angle)
        outwards = self.centrifugal_force if centrifugal else 0.0
        easing = self._beside_fastest(outwards / SHORT) if centrifugal else None
        ball = self._ball(outwards, easing is not None)
        contacts: list[RollingContact] = []
        for j in range(of.balls):
            for flank, (ring, sign) in product(self.flanks, ((INNER, -1.0), (OUTER, 1.0))):
                sides = [Side(ring, self.azimuth(j), sign * self._seen(ring, flank))]
                if ring in bending:
                    sides.append(Side(bending[ring][0], self.azimuth(j, ring), sign))
                apart = 0.0 if ring else of.apart(self.contact_angle)
                heights = _heights(ball_heights[j] if ball_heights else None, self.spot(ring), -apart)
                law = laws[ring]
                along = self.on_raceway(j, ring)
                if isinstance(law, Sequence):
                    law = law[j]
                    along = self.beside(j, ring, self.spot(ring))
                elif any(self.tilts):  # half of it on either side, where the end along the axis opens
                    along = self.beside(j, ring, self.tilted(j, -0.5))
                    heights = heights if ring else _sum(heights, self.tilted(j, arm))
                contacts.append(RollingContact(law, along, tuple(sides), heights))
            if easing is not None:
                spring = Linear(outwards / SHORT, SOFT)
                contacts.append(RollingContact(spring, self.azimuth(j).places, heights=easing))
        return Mechanism(self.rings.structures, [ball] * of.balls, contacts)

    @property
    def flanks(self) -> tuple[float, ...]:
        """Sides of a groove on which a ball touches: both of an arch, against a positive axial load first."""
        return (1.0, -1.0) if isinstance(self.bearing, BallBearing) and self.bearing.arches else (1.0,)

    def _seen(self, ring: int, flank: float) -> Array:
        """How a contact on a flank sees the modes of a ring (m,): axial ones from its side."""
        axial = (self.rings.inner, self.rings.outer)[ring].axial
        return np.where(axial != 0.0, flank, 1.0)

    def _ball(self, outwards: float, easing: bool) -> Body:
        """A ball or roller along its normal; with its way along the axis between arches, or against a rib.

        It is pressed outwards by a force, N, along the normal, or by a spring of that force.
        """
        of = self.bearing
        rows = np.array([[1.0], [-1.0]])
        pulled = np.ones(1)
        held = np.zeros(1)
        if len(self.flanks) > 1:
            cosine = math.cos(self.contact_angle)
            sine = math.sin(self.contact_angle)
            normals = [(cosine, flank * sine) for flank in self.flanks]
            rows = np.array([(sign * out, sign * up) for out, up in normals for sign in (1.0, -1.0)])
            pulled = np.array([1.0 / cosine, 0.0])
            held = np.zeros(2)
        elif isinstance(of, RollerBearing) and of.rib_stiffness is not None:
            rows = np.column_stack([rows, np.full(2, of.pushed_along)])
            pulled = np.array([1.0, of.flung_along])
            held = np.array([0.0, of.rib_stiffness])
        pressing = -outwards * pulled * (not easing)
        rows = np.vstack([rows, SHORT * pulled[None]]) if easing else rows
        mass = of.ball_mass * np.eye(len(held))
        return Body(mass, np.zeros_like(mass), np.diag(held), rows, pressing, np.zeros(len(rows)))

    def rib_force(
        self, forces: tuple[Array, Array], moved: Array, steps: range, *, centrifugal: bool
    ) -> Array:
        """Forces of the rib (Z, n), N: of one that is a spring by ways along the axis (1, Z, n), m."""
        of = self.bearing
        if not isinstance(of, RollerBearing) or not of.taper:
            return np.zeros((0, len(steps)))
        if of.rib_stiffness is not None:
            return np.asarray(of.rib_stiffness * moved[0])
        lift = self.centrifugal_force * self._share(steps) ** 2 * centrifugal
        return of.rib_force(*forces, lift)

    def recorded(self, run: RolledMechanism, each: int, *, centrifugal: bool) -> RolledBearing:
        """What a run of balls with so many contacts each has recorded."""
        balls = self.bearing.balls
        flanks = len(self.flanks)
        count = run.contact_force.shape[1]
        steps = range(self.total + 1 - count, self.total + 1)

        def of_flanks(values: Array) -> Array:
            """Of all contacts (flanks, rings, Z, …), but of springs that ease centrifugal force."""
            by_ball = values[: each * balls].reshape(balls, each, -1)[:, : 2 * flanks]
            return by_ball.reshape(balls, flanks, 2, -1).transpose(1, 2, 0, 3)

        forces = of_flanks(run.contact_force)
        reached = of_flanks(run.reached)
        inner, outer = forces[0] if flanks == 1 else forces.sum(axis=0)
        moved = np.stack(run.degrees_of_freedom[:balls], axis=1)
        return RolledBearing(
            np.asarray(self.time_step * np.arange(count)),
            self.cage(steps),
            inner,
            outer,
            moved[0],
            forces[1:].reshape(-1, count),
            self.rib_force((inner, outer), moved[1:], steps, centrifugal=centrifugal),
            run.displacement[:3],
            run.displacement[3:6],
            run.acceleration[6:],
            np.stack([reached[..., 0].min(axis=(0, 2)), reached[..., 1].max(axis=(0, 2))], axis=1),
            of_flanks(run.softening)[..., 0].max(axis=0),
            run.energy,
            run.unconverged_steps,
        )

    def thrown_on_ribs(self) -> list[RollingContact]:
        """What rollers that are thrown on the ribs of the inner ring press it against an axial load.

        Springs that are pressed; of a ring whose contacts carry no axial load, or without ribs, none.
        """
        sine = math.sin(self.contact_angle)
        force = self.bearing.flung_axially(self.centrifugal_force)
        if not force:
            return []
        axially = -1.0 * (self.rings.inner.axial != 0.0)  # as all contacts see the ring, at their angle
        side = Side(INNER, self.azimuth(0), axially)
        size = force / sine
        return [
            RollingContact(Linear(size, SOFT), self.azimuth(0).places, (side,), self._beside_fastest(size))
        ]

    def driven_round(self, force: float) -> list[RollingContact]:
        """A radial force, N, on the ring that turns and with it, by two springs that are pressed and pulled.

        They stand opposite each other, so that what they would do along the axis cancels.
        """
        ring = RINGS.index(self.bearing.turning)
        rate = TURN * self.turns[ring]
        half = 0.5 * force / math.cos(self.contact_angle)
        spacing = None if isinstance(self.speed, SpeedCourse) else rate * self.time_step

        def at(angle: float) -> Trajectory:
            return Trajectory(
                lambda steps: rate * self._time(steps) + angle,
                lambda steps: rate * self._share(steps),
                spacing,
            )

        return [
            RollingContact(
                Linear(size, SOFT), at(0.0).places, (Side(ring, at(angle)),), self._beside_fastest(size)
            )
            for size, angle in ((half, 0.0), (-half, math.pi))
            if force
        ]

    def loaded(self, mechanism: Mechanism, loads: tuple[float, float]) -> Mechanism:
        """Press the rings together, with springs that are free of force where they then are."""
        inner = self.rings.inner
        outer = self.rings.outer
        pressed = [np.zeros(len(each.natural_frequencies)) for each in self.rings.structures]
        pressed[INNER] = inner.pressed(*loads)
        pressed[OUTER] = -outer.pressed(*loads)
        load = self.usual_load(*loads)
        require(load > 0.0, "load", "none", "a load, or a preload")
        held = np.maximum(inner.frequencies, outer.frequencies)
        what = "rings"
        remedy = "Give the shaft or the housing a stiffness."
        require(np.all(held > 0.0), what, "both free", "one that is held", remedy)
        loose = [
            replace(inner, frequencies=np.zeros(len(held))),
            replace(outer, frequencies=np.full(len(held), HELD)),
            *self.rings.structures[2:],
        ]
        trial = replace(mechanism, structures=loose, pressed=pressed)
        passing = self.bearing.balls * abs(self.bearing.kinematics(self.speed).cage) * self.time_step
        places = np.linspace(0.0, min(1.0 / passing, self.total), INSTANTS, endpoint=False).astype(int)
        rest = rests_of(trial, places.tolist(), load)[:, : len(held)].mean(axis=0)
        pressed[INNER] = pressed[INNER] + (TURN * inner.frequencies) ** 2 * rest
        return replace(mechanism, pressed=pressed)


def _heights(line: ArrayLike | None, spots: Values, raised: float) -> Values:
    """Heights of a closed line at the spots of a ball that touch, or none, all raised, m."""
    if line is None:
        return lambda steps: np.full(len(steps), raised)
    from scipy.interpolate import CubicSpline

    heights = finite_array("heights of a ball (m)", line, "finite numbers, four or more", shape=(None,))
    require(heights.size >= 4, "heights of a ball", count_of(heights.size, "number"), "four or more")
    angles = TURN * np.arange(heights.size + 1) / heights.size
    spline = CubicSpline(angles, np.append(heights, heights[0]), bc_type="periodic")
    return lambda steps: spline(spots(steps)) + raised


def _sum(first: Values, second: Values) -> Values:
    """Both together."""
    return lambda steps: first(steps) + second(steps)


def _rows_of(
    mechanism: Mechanism, rings: BearingRings, bearing: AnyBearing, sensors: Sequence[Sensor]
) -> Array:
    """What reads the motion of both rings, the inner one first, and then of sensors."""
    axes = [
        mechanism.row(place, ring.towards(angle, way))
        for place, ring in ((INNER, rings.inner), (OUTER, rings.outer))
        for angle, way in AXES
    ]
    return np.array([*axes, *(_row_of(mechanism, rings, bearing, sensor) for sensor in sensors)])


def _row_of(mechanism: Mechanism, rings: BearingRings, bearing: AnyBearing, sensor: Sensor) -> Array:
    name, angle, direction = sensor
    require(name in RINGS, "ring of a sensor", name, '"inner" or "outer"')
    ring = RINGS.index(name)
    row = mechanism.row(ring, rings.structures[ring].towards(angle, direction))
    if ring in rings.bending and bearing.turning != name:
        place, bending = rings.bending[ring]
        row = row + mechanism.row(place, bending.towards(angle, direction))
    return row
