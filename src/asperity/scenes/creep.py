"""Friction of what rolls, bodies and balls: under the working load and in time; whether a wheel squeals."""

from collections.abc import Iterator
from dataclasses import replace
from operator import attrgetter

import numpy as np

from asperity.arguments import Array, Complex
from asperity.case.scene import Case
from asperity.contact import creep
from asperity.contact.friction import Friction, SlidingContact, cell_places
from asperity.contact.solved import Contact
from asperity.contact.tangential import FrictionalHalfSpace
from asperity.errors import Finding, Grade, InputError, OutOfRangeWarning, percent
from asperity.progress import Progress
from asperity.reduction import stiffness, texture
from asperity.reduction.traction import TractionStates, middle_of, traction_states
from asperity.scenarios.geometry import Geometry
from asperity.scenarios.reducing import LIGHTEST_STATE
from asperity.scenarios.scene import PreparedCase
from asperity.scenes import compute, schema
from asperity.scenes.along_rollers import has_rollers
from asperity.scenes.computed_bearing import ComputedBearing
from asperity.scenes.observer import DECLARED, Observer
from asperity.scenes.sideways import Sideways
from asperity.schema import Values, bearing
from asperity.speeds import speed_at
from asperity.structures.bearing_creepage import RINGS, creepage_of
from asperity.structures.bearing_friction import (
    BallOnRaceway,
    friction_of_balls,
    gyration_of,
    rolling_speed,
    torque_of,
)
from asperity.structures.squeal import (
    FREE_OF_AXLE,
    CreepingContact,
    poles_of,
    ringing_modes,
    standing_modes,
)
from asperity.surfaces.cell_means import pressed_heights

LEAST_CELLS = 4.0
"""Cells in the shorter semi-axis of the smooth contact in the lowest state."""
MOST_ELONGATED = 2.0
"""Longer side over the shorter of covered cells on which all contacts settle, whatever Poisson's ratio."""

GYRATING = 0.3
"""Share of what friction holds from which on it is told that balls gyrate."""
SOURCES = (
    "J. J. Kalker, Three-Dimensional Elastic Bodies in Rolling Contact (1990) (friction).",
    "squeal: the loop of F. G. de Beer, M. H. A. Janssens and P. P. Kooijman, J. Sound Vib. 267 (2003) 497, "
    "with a contact spring in line; O. Aberth, Math. Comput. 27 (1973) 339 (its roots).",
)


def friction_of(case: Case) -> Friction:
    """What a case says of friction."""
    return case.creep.law(case.contact.friction)


def shape_with_friction(of: PreparedCase) -> Geometry:
    """Geometry of a case on the cells that friction is solved on.

    Covered ones, whose error is of second order, unless whole ones are asked for, surfaces flow, or cells are
    too long for them.
    """
    shape = of.shape
    contact = of.case.contact
    too_long = max(shape.spacing) > MOST_ELONGATED * min(shape.spacing)
    if contact.rim_cells == "whole" or contact.hardness is not None or too_long:
        return replace(shape, cells="whole")
    return shape if shape.cells == "covered" else shape.over_cells()


def smooth_with_friction(of: PreparedCase, friction: Friction) -> tuple[FrictionalHalfSpace, Contact]:
    """What rolls, as the first body, on what it rolls over; and their smooth contact under the load."""
    case = of.case
    shape = shape_with_friction(of)
    space = shape.half_space(case.contact.hardness)
    bodies = case.rolling.material, case.rolled_over.material
    smooth = space.solve(shape.body, load=shape.load, rtol=case.numerics.rtol)
    return FrictionalHalfSpace(space, bodies, friction), smooth


def rough_strips(of: PreparedCase) -> list[Array]:
    """Rough strips (rows, ny) of a case about the plane that the patch feels in their middle, m.

    As the cells press them that friction is solved on.
    """
    weights = texture.punch_weights(of.shape.spacing, of.shape.class_axes)
    nx = len(of.shape.body)
    rough = [strip.heights for strip in of.textures.strips if strip.heights.any()]
    if of.shape.cells == "whole" and shape_with_friction(of).cells == "covered":
        rough = [pressed_heights(heights) for heights in rough]
    return [heights - stiffness.weighted_mean(middle_of(heights, nx), weights) for heights in rough]


def states_of(prepared: PreparedCase, count: int, progress: Progress | None) -> TractionStates:
    """State functions of tangential contact of a rough case, at `count` approaches.

    From where all samples carry a light load, and the smooth contact has some cells, to where one carries
    the largest that the window holds.
    """
    case = prepared.case
    shape = shape_with_friction(prepared)
    samples = rough_strips(prepared)
    if not samples:
        remedy = "Give it a file or rms, of a rail a spectrum."
        raise InputError("surface", "none, or as a line alone", "a rough surface with samples", remedy)
    space = shape.half_space(case.contact.hardness)
    resolved = (LEAST_CELLS * max(shape.spacing) / min(shape.axes(1.0))) ** 3
    loads = max(LIGHTEST_STATE * shape.class_load, resolved), shape.largest_force
    gaps = [shape.body - middle_of(sample, len(shape.body)) for sample in samples]
    low, high = np.array([[space.solve(gap, load=load).approach for load in loads] for gap in gaps]).T
    approaches = low.max() + (high.min() - low.max()) * np.linspace(0.0, 1.0, count) ** 2
    bodies = case.rolling.material, case.rolled_over.material
    return traction_states(space, bodies, shape.body, samples, approaches, progress)


def creep_group(computed: compute.Computed) -> Values:
    """Lay out friction under the working load and in time, and of a wheel its stability on the rail."""
    case = computed.case
    shape = computed.shape
    speed = computed.case.speed
    if not any(case.creep.creepage):
        return {}
    creepage = case.creep.creepage
    rolling, smooth = smooth_with_friction(computed, friction_of(case))
    first = shown = rolling.roll(smooth, creepage[:2], creepage[2], speed=speed)
    rows = [_facts(first)]
    for strip in rough_strips(computed):
        if creep.has_room(smooth, strip):
            with OutOfRangeWarning.ignored():  # what is out of it has been told of the smooth contact
                ((steady, states),) = creep.rolled_over(rolling, smooth, strip, [creepage], speed)
            missed = rows[0] - _facts(steady)  # by its long steps
            rows.append(np.mean([_facts(each) for each in states], axis=0) + missed)
            shown = states[-1] if shown is first else shown
    force = computed.stacked("contact_force")
    largest = max(float(force.max()), shape.load)
    bodies = creep.CreepingBodies(rolling, smooth.undeformed_gap, creepage, speed, largest)
    power = bodies.power(force)
    ways = schema.WAYS if "track" in computed.quantities else schema.WAYS_OFF_TRACK
    return {
        schema.ROLLING_WAY: ways,
        schema.FRICTION_FORCE: np.moveaxis(bodies.follow(force)[:2], 0, 2),
        schema.FRICTION_POWER: power,
        schema.FULL_SLIP_SHARE: np.mean((force > 0.0) & (force <= bodies.full_slip_load), axis=(1, 2)),
        schema.MEAN_FRICTION_POWER: power.mean(axis=(1, 2)),
        schema.CREEP_WAY: ways,
        **_under_load(np.array(rows), speed),
        **_seen(shown),
        schema.CREEPAGE: creepage,
        schema.FULL_SLIP_SCALE: bodies.full_slip_scale(shape.load),
        schema.FULL_SLIP_LOAD: bodies.full_slip_load,
        **_wear(computed, power),
        **_squeal(computed, bodies),
    }


def _wear(computed: compute.Computed, power: Array) -> Values:
    """What friction takes as all contacts pass once, by its power (laws, contacts, n), W; nothing unasked."""
    case = computed.case
    if case.creep.wear is None:
        return {}
    area = case.creep.wear * power.mean(axis=2).sum(axis=1) / case.speed
    return {schema.WORN_AREA: area, schema.WEAR_DEPTH: area / (2.0 * computed.shape.semi_axes[1])}


def _facts(found: SlidingContact) -> Array:
    """Areas that stick and slip, forces and moment, and heat over the length rolled (6,)."""
    return np.array((found.stick_area, found.slip_area, *creep.forces_of(found), found.work))


def _under_load(facts: Array, speed: float) -> Values:
    """Lay out `_facts` of contacts under the working load (n, 6)."""
    stick, slip, along, across, moment, work = facts.T
    return {
        schema.FRICTION_SAMPLE: np.arange(len(facts)),
        schema.STICK_AREA: np.maximum(stick, 0.0),
        schema.SLIP_AREA: slip,
        schema.SAMPLE_FRICTION: np.stack([along, across], axis=1),
        schema.SPIN_MOMENT: moment,
        schema.SAMPLE_HEAT: speed * work,
    }


def _seen(found: SlidingContact) -> Values:
    """Lay out the tractions of a contact, and how fast it slips where it does."""
    x, y = cell_places(found.normal.half_space)
    return {
        schema.CREEP_X: x[:, 0],
        schema.CREEP_Y: y[0],
        schema.TRACTION: np.hypot(*found.traction),
        schema.SLIP_VELOCITY: np.where(found.sticks, 0.0, found.speed * np.hypot(*found.slip)),
    }


def _squeal(computed: compute.Computed, bodies: creep.CreepingBodies) -> Values:
    """Free motions of the wheel on the rail at mid-span, of a wheel whose axial modes are known."""
    modes = computed.scene.modes
    if modes is None or not modes.axial.any():  # known over a track alone
        return {}
    side = Sideways(computed)
    place, _ = computed.case.contact_places

    def receptances(omega: Complex) -> Complex:
        frequency = omega / (2.0 * np.pi)
        middle = 0.5 * side.track.track.sleeper_spacing
        return side.wheel(frequency) + side.rail(frequency, middle)

    over_creepage, over_load = bodies.slopes(computed.shape.load)
    contact = CreepingContact(*side.stiffness, -over_creepage / bodies.speed, over_load)
    omega = contact.roots(receptances, poles_of(modes))
    which = np.arange(len(omega))
    known = np.isfinite(omega)
    forces = contact.force_ratio(receptances(omega[known]))
    which[known] = ringing_modes(modes, place, omega[known], forces)
    believed = known & (modes.nodal_diameters[which] >= FREE_OF_AXLE)
    radial, axial = (each[which] ** 2 for each in modes.at(place))
    return {
        schema.SQUEAL_MODE: 1 + np.arange(len(omega)),
        schema.SQUEAL_FREQUENCY: omega.real / (2.0 * np.pi),
        schema.GROWTH_RATE: -omega.imag,
        schema.SQUEAL_DIAMETERS: modes.nodal_diameters[which],
        schema.SQUEAL_SHAPE: standing_modes(modes)[which],
        schema.AXIAL_SHARE: axial / (radial + axial),
        schema.CREEP_DAMPING: contact.damping,
        schema.LOAD_SLOPE: over_load,
        schema.LARGEST_GROWTH: float(np.max(-omega.imag[known], initial=-np.inf)),
        schema.SQUEAL_GROWTH: float(np.max(-omega.imag[believed], initial=-np.inf)),
    }


# --- balls in their grooves, whose creepages are those of their rolling


def ball_group(computed: ComputedBearing) -> Values:
    """Lay out friction of balls under the static load and in time, and what torque it asks of the rings."""
    case = computed.case
    assert case.friction_law is not None
    creepage = creepage_of(case.static)
    at_rest = friction_of_balls(case.static, creepage, case.kinematics, case.friction_law)
    speed = rolling_speed(computed.bearing, case.kinematics)
    force = computed.stacked("contact_force").reshape(
        len(computed.runs), len(RINGS), -1, len(computed.first.time)
    )
    rolled = np.where(force[:, :1] > 0.0, force, 0.0)  # by the inner ring, too
    powers = list[Array]()
    heaviest = list[SlidingContact]()
    for number, ring in enumerate(RINGS):
        loads = (case.static.inner_load, case.static.outer_load)[number]
        spin = creepage.spin[number]
        touching = np.where(np.isfinite(spin), loads, 0.0)
        place = np.unravel_index(np.argmax(touching), touching.shape)
        most = max(float(rolled[:, number].max()), float(touching.max()))
        mean_spin = float((np.nan_to_num(spin) * touching).sum() / touching.sum())
        balls = BallOnRaceway.of(computed.bearing, ring, case.friction_law, most, mean_spin, speed)
        powers.append(balls.power(rolled[:, number]))
        heaviest.append(replace(balls, spin=float(spin[place])).at(float(loads[place])))
    facts = np.array([_facts(each) for each in heaviest])
    facts[:, 2] = 0.0  # which was asked for along the path
    fastest = np.concatenate(powers, axis=1)
    power = fastest * speed_at(case.speed, computed.first.time) / float(case.speed)
    return {
        bearing.FRICTION_HEAT: at_rest.heat,
        bearing.SLIPPING_SHARE: at_rest.slip_share,
        bearing.BALL_SPIN_MOMENT: at_rest.spin_moment,
        bearing.GYRATION: at_rest.gyration,
        bearing.FRICTION_TORQUE: torque_of(fastest.mean(axis=2).sum(axis=1), case.kinematics),
        schema.FRICTION_POWER: power,
        schema.MEAN_FRICTION_POWER: power.mean(axis=(1, 2)),
        schema.CREEP_WAY: schema.WAYS_OFF_TRACK,
        **_under_load(facts, speed),
        **_seen(max(heaviest, key=attrgetter("work"))),
    }


def _gyrating(computed: ComputedBearing) -> Iterator[Finding]:
    """How much of friction balls take that gyrate, which is left out of the tractions."""
    case = computed.case
    assert case.friction_law is not None
    found = gyration_of(case.static, creepage_of(case.static), case.kinematics, case.friction_law)
    most = float(np.nanmax(found))
    if most > GYRATING:
        yield Finding(
            "moment by which balls gyrate over what friction holds",
            percent(most),
            f"up to {percent(GYRATING)}",
            Grade.OUT if most >= 1.0 else Grade.WARNING,
            "The heat of friction leaves it out, which is up to a tenth more at 30 %, a third at 60 %; from "
            "100 % on balls pivot sideways.",
            "Lower the speed, or raise the load.",
        )


def _rubs(computed: ComputedBearing) -> bool:
    return computed.case.friction is not None and not has_rollers(computed)


OBSERVER = Observer(
    "creep",
    DECLARED,
    creep_group,
    sources=SOURCES,
)
OF_BALLS = Observer(
    "creep_of_balls",
    DECLARED,
    ball_group,
    needs=("bearing",),
    asked_of=_rubs,
    findings=lambda computed: list(_gyrating(computed)),
    sources=SOURCES[:1],
)
