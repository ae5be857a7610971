"""Wear of the raceways of a ball bearing by place: Archard's law where balls slip in their grooves."""

import math
from dataclasses import dataclass

import numpy as np

from asperity.arguments import Array, Indices, positive
from asperity.contact.friction import Friction, SlidingContact, cell_places
from asperity.contact.groove_creepage import contact_curvature, sliding_across
from asperity.structures.bearing_creepage import RINGS, BearingCreepage, Ring, creepage_of
from asperity.structures.bearing_friction import ROOM, facts_of_contacts, rolling_speed
from asperity.structures.bearing_statics import LoadedBearing
from asperity.structures.rolling_bearing import Kinematics

ACROSS = 81
"""Places across a contact at which depths are found."""
SHARES = np.linspace(-1.0, 1.0, ACROSS)
"""These places over its half axis."""
IN_GROOVE = 241
"""Places across a groove, from end to end of what balls touch of it."""


@dataclass(frozen=True, eq=False)
class RacewayWear:
    """How fast both raceways wear, the inner one first, at n places around them.

    Attributes
    ----------
    angle : ndarray (n,)
        Places around, from the radial load on, rad.
    across : ndarray (2, k)
        Places across the groove along its arc, from where a contact angle of 0 is, m.
    depth : ndarray (2, n, k)
        Depth that is worn in a second there, m/s.
    area : ndarray (2, n)
        Area of the section that is worn in a second, m²/s.
    volume : ndarray (2,)
        Volume that is worn in a second, m³/s.
    """

    angle: Array
    across: Array
    depth: Array
    area: Array
    volume: Array


def raceway_wear(
    loaded: LoadedBearing, turning: Kinematics, coefficient: float, friction: Friction | None = None
) -> RacewayWear:
    """Wear of both raceways of a loaded bearing that turns.

    Parameters
    ----------
    loaded : LoadedBearing
        The bearing under its load, at angles of the cage over the passing of a ball.
    turning : Kinematics
        What turns how fast.
    coefficient : float
        Archard's k: volume that is worn times hardness, over load times sliding.
    friction : Friction, optional
        By which parts of a contact stick, and do not wear; without it all of each slips: the most there is.

    Returns
    -------
    RacewayWear

    Notes
    -----
    A contact that passes wears k/H ∫ p s dx off the raceway, with Hertz's pressure p, the size s of the slip,
    without friction that of the creepage of `asperity.structures.bearing_creepage`, and the hardness H of the
    rings; under one coefficient of friction µ its volume is k/(µ H) of the heat. A ring that stands
    still meets each ball at one place under the load of that place; one that turns meets it everywhere, and
    wears alike all around. Balls that do not touch both rings are left out. Spin is taken without sign: on
    which side of a contact it adds to sliding is not said.
    """
    over_hardness = positive("wear coefficient", coefficient) / loaded.bearing.hardness
    azimuth = np.mod(loaded.azimuth, 2.0 * np.pi).reshape(-1)
    order = np.argsort(azimuth)
    found = creepage_of(loaded)
    rings = [
        _worn(loaded, turning, ring, order, _slid(loaded, found, turning, ring, friction)) for ring in RINGS
    ]
    across, depth, area, volume = (np.array(each) for each in zip(*rings, strict=True))
    return RacewayWear(
        azimuth[order], across, over_hardness * depth, over_hardness * area, over_hardness * volume
    )


def _slid(
    loaded: LoadedBearing, found: BearingCreepage, turning: Kinematics, ring: Ring, friction: Friction | None
) -> tuple[Array, Array]:
    """∫ p s dx at places across (m, Z, ACROSS), N/m, and ∫ p s dA (m, Z), N; NaN without contact."""
    number = RINGS.index(ring)
    if friction is not None:
        speed = rolling_speed(loaded.bearing, turning)
        solved = facts_of_contacts(loaded, found, ring, friction, speed, _slid_of)
        return solved[..., 1:], solved[..., 0]
    of = loaded.bearing
    contact = (of.inner_contact, of.outer_contact)[number]
    groove = (of.inner_conformity, of.outer_conformity)[number] * of.ball_diameter
    touching = np.isfinite(found.sliding[number])
    loads = (loaded.inner_load, loaded.outer_load)[number]
    load, spin = (np.where(touching, each, 0.0) for each in (loads, found.spin[number]))
    along, across = (np.where(touching, each, 1.0) for each in loaded.semi_axes(ring))
    curvature = contact_curvature(0.5 * of.ball_diameter, groove)
    lines = sliding_across(load, (along, across), spin, curvature, contact.radius_x, SHARES)
    return lines, found.sliding[number]


def _slid_of(contact: SlidingContact) -> Array:
    """∫ p s dA, N, and then ∫ p s dx at places across, N/m, of a contact that sticks and slips.

    Slip of cells misses a part of the work, and is scaled to it; places are scaled to what all cells have.
    """
    space = contact.normal.half_space
    cells = contact.normal.pressure * np.hypot(*contact.slip) * ~contact.sticks
    if not cells.any():
        return np.zeros(1 + ACROSS)
    whole = float(cells.sum()) * space.cell_area * contact.work / contact.work_of_slip
    _, y = cell_places(space)
    places = 0.5 * space.shape[1] * space.spacing[1] / ROOM * SHARES
    # its surfaces run against the path, so that spin adds on the other side than to `sliding_across`
    line = np.interp(places, y[0], cells.sum(axis=0)[::-1])
    line[[0, -1]] = 0.0  # of the rim, whose cells reach beyond it
    return np.array([whole, *(line * whole / np.trapezoid(line, places))])


def _worn(
    loaded: LoadedBearing,
    turning: Kinematics,
    ring: Ring,
    order: Indices,
    slid: tuple[Array, Array],
) -> tuple[Array, Array, Array, float]:
    """Places across, and depth, area and volume of one ring over k/H, at places around in an order."""
    of = loaded.bearing
    number = RINGS.index(ring)
    groove = (of.inner_conformity, of.outer_conformity)[number] * of.ball_diameter
    angles = (loaded.inner_angle, loaded.outer_angle)[number]
    turns = (turning.inner, turning.outer)[number]
    lines, sliding = slid
    touching = np.isfinite(sliding)
    angle = np.where(touching, angles, 0.0)
    across = np.where(touching, loaded.semi_axes(ring)[1], 1.0)
    places = groove * angle[..., None] + across[..., None] * SHARES
    arc = np.linspace(places[touching].min(), places[touching].max(), IN_GROOVE)
    lines = np.where(touching[..., None], lines, 0.0)
    contacts = zip(places.reshape(-1, ACROSS)[order], lines.reshape(-1, ACROSS)[order], strict=True)
    depth = np.array([np.interp(arc, at, line) for at, line in contacts])
    area = np.nan_to_num(sliding).reshape(-1)[order]
    if turns:
        depth = np.broadcast_to(depth.mean(axis=0), depth.shape)
        area = np.full(area.shape, area.mean())
    passing = of.balls * abs(turning.cage - turns)
    side = -1.0 if ring == "inner" else 1.0
    around = math.pi * (of.pitch_diameter + side * of.ball_diameter * math.cos(loaded.contact_angle))
    return arc, passing * depth, passing * area, passing * around * float(area.mean())
