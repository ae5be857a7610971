"""Friction of the balls of a bearing: heat and torque where contacts stick and slip in their grooves."""

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from asperity.arguments import Array, ArrayLike
from asperity.contact.creep import SteadyRolling
from asperity.contact.friction import Friction, SlidingContact, cell_places
from asperity.contact.groove_creepage import contact_curvature
from asperity.contact.halfspace import HalfSpace
from asperity.contact.hertz import Hertz
from asperity.contact.tangential import FrictionalHalfSpace
from asperity.errors import OutOfRangeWarning
from asperity.reference.materials import Material
from asperity.structures.balls_in_grooves import BallsInGrooves
from asperity.structures.bearing_creepage import RINGS, BearingCreepage, Ring
from asperity.structures.bearing_statics import LoadedBearing
from asperity.structures.rolling_bearing import Kinematics

CELLS = (24, 48)
"""Along and across a contact: heat to half a percent."""
ROOM = 1.1
"""Size of the grid over that of the contact."""
DIGITS = 6
"""To which loads and spins of contacts, rad/m, are told apart."""


@dataclass(frozen=True, eq=False)
class BallOnRaceway(SteadyRolling):
    """A ball that rolls steadily in a groove, which drives or brakes it by no force along the path.

    Parameters
    ----------
    contact : Hertz
        Of ball and raceway.
    curvature : float
        Of the surface that both share across, 1/m, see `asperity.contact.groove_creepage.contact_curvature`.
    bodies : (Material, Material)
        Ball and ring.
    friction : Friction
        Coefficient of friction.
    largest_load : float
        N.
    spin : float
        Spin creepage, rad/m.
    speed : float
        Rolling speed, m/s.
    """

    contact: Hertz
    curvature: float
    bodies: tuple[Material, Material]
    friction: Friction
    largest_load: float
    spin: float = 0.0
    speed: float = 1.0

    @classmethod
    def of(
        cls,
        bearing: BallsInGrooves,
        ring: Ring,
        friction: Friction,
        largest_load: float,
        spin: float = 0.0,
        speed: float = 1.0,
    ) -> "BallOnRaceway":
        """The balls of a bearing on one of its rings."""
        inner = ring == "inner"
        conformity = bearing.inner_conformity if inner else bearing.outer_conformity
        curvature = contact_curvature(0.5 * bearing.ball_diameter, conformity * bearing.ball_diameter)
        contact = bearing.inner_contact if inner else bearing.outer_contact
        bodies = bearing.ball_material, bearing.material
        return cls(contact, curvature, bodies, friction, largest_load, spin, speed)

    def at(self, load: float) -> SlidingContact:
        """The contact under a load, N; the ball is the first body.

        Its creepage is that in the middle: √(ξ/χ) across are the lines of pure rolling.
        """
        along, across = self.contact.semi_axes_under(load)
        spacing = 2.0 * ROOM * along / CELLS[0], 2.0 * ROOM * across / CELLS[1]
        space = HalfSpace(CELLS, spacing, self.contact.modulus)
        x, y = cell_places(space)
        gap = x**2 / (2.0 * self.contact.radius_x) + y**2 / (2.0 * self.contact.radius_y)
        rolling = FrictionalHalfSpace(space, self.bodies, self.friction)
        # surfaces run against the path: a ball that is ahead in the middle has a creepage below zero there
        bow = -self.curvature / (2.0 * self.contact.radius_x)
        with OutOfRangeWarning.ignored():  # that a ball pivots in its groove is what is asked for
            return rolling.roll(
                space.solve(gap, load=load),
                spin=self.spin,
                creepage_curvature=bow,
                force=(0.0, None),
                speed=self.speed,
            )


@dataclass(frozen=True, eq=False)
class BearingFriction:
    """Friction of balls on both raceways (2, m, Z), the inner one first; NaN of those that do not touch both.

    Attributes
    ----------
    heat : ndarray
        What friction turns into heat, W.
    slip_share : ndarray
        Share of a contact that slips.
    spin_moment : ndarray
        Moment of friction about the normal, N m, without sign.
    gyration : ndarray (m, Z)
        Moment by which a ball gyrates over what friction holds at most; from 1 on the ball pivots sideways.
    """

    heat: Array
    slip_share: Array
    spin_moment: Array
    gyration: Array


def friction_of_balls(
    loaded: LoadedBearing, found: BearingCreepage, turning: Kinematics, friction: Friction
) -> BearingFriction:
    """Find what friction does between the balls of a loaded bearing and its rings, in steady rolling.

    Parameters
    ----------
    loaded : LoadedBearing
        The bearing under its load.
    found : BearingCreepage
        How its balls slide, as `asperity.structures.bearing_creepage.creepage_of` has it.
    turning : Kinematics
        What turns how fast.
    friction : Friction
        Coefficient of friction.

    Returns
    -------
    BearingFriction

    Notes
    -----
    Spin is that of the ring in control, so that a ball that spins on one raceway is held by the other one.
    Moments of the groove about the axis of a ball are balanced by forces along the path of κ a²/4R of what
    friction carries, which are left out of the tractions, as are forces across by which a ball gyrates.
    """
    speed = rolling_speed(loaded.bearing, turning)
    solved = [facts_of_contacts(loaded, found, ring, friction, speed, _facts) for ring in RINGS]
    work, slip_share, moment = np.moveaxis(np.array(solved), -1, 0)
    gyration = gyration_of(loaded, found, turning, friction)
    return BearingFriction(speed * work, slip_share, moment, gyration)


def gyration_of(
    loaded: LoadedBearing, found: BearingCreepage, turning: Kinematics, friction: Friction
) -> Array:
    """Moment by which balls gyrate over what friction holds at most (m, Z), as of `BearingFriction`."""
    of = loaded.bearing
    radius = 0.5 * of.ball_diameter
    momentum = 0.4 * of.ball_mass * radius**2 * 2.0 * math.pi * turning.spin
    gyrating = momentum * 2.0 * math.pi * abs(turning.cage) * np.sin(np.abs(found.axis))
    held = np.asarray(friction.static) * (loaded.inner_load + loaded.outer_load) * radius
    gyration = np.where(np.isnan(found.axis), np.nan, np.inf)
    return np.divide(gyrating, held, out=gyration, where=held > 0.0)


def rolling_speed(bearing: BallsInGrooves, turning: Kinematics) -> float:
    """Speed of a ball on both raceways, m/s."""
    return math.pi * bearing.ball_diameter * turning.spin


def torque_of(heat: Array, turning: Kinematics) -> Array:
    """Torque that turns one ring against the other, N m, by the heat of all contacts (...), W.

    Balls and cage neither gain nor lose: what turns into heat is what drives the rings.
    """
    return heat / (2.0 * math.pi * abs(turning.inner - turning.outer))


def facts_of_contacts(
    loaded: LoadedBearing,
    found: BearingCreepage,
    ring: Ring,
    friction: Friction,
    speed: float,
    facts: Callable[[SlidingContact], ArrayLike],
) -> Array:
    """What a function says of all contacts with a ring in steady rolling (m, Z, ...), each solved once.

    NaN of balls that do not touch both rings.
    """
    number = RINGS.index(ring)
    loads = (loaded.inner_load, loaded.outer_load)[number]
    known: dict[tuple[float, float], Array] = {}
    places = list(zip(*np.nonzero(np.isfinite(found.sliding[number])), strict=True))
    told = list[Array]()
    for place in places:
        load = float(f"{loads[place]:.{DIGITS}g}")
        spin = round(float(found.spin[number][place]), DIGITS)
        if (load, spin) not in known:
            balls = BallOnRaceway.of(loaded.bearing, ring, friction, load, spin, speed)
            known[load, spin] = np.asarray(facts(balls.at(load)), dtype=float)
        told.append(known[load, spin])
    rows = np.full((*loads.shape, *np.shape(told[0])), np.nan)
    for place, each in zip(places, told, strict=True):
        rows[place] = each
    return rows


def _facts(found: SlidingContact) -> tuple[float, float, float]:
    """Heat over the length rolled, N, share that slips, and moment, N m, without sign."""
    return found.work, found.slip_area / found.normal.area, abs(found.moment)
