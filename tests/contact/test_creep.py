"""Creep: FASTSIM in closed forms, the linear theory, curves of smooth and rough contacts, loads that vary."""

import math

import numpy as np
import pytest
from test_friction import ellipse

from asperity import Friction
from asperity.contact.creep import (
    CreepingBodies,
    RollingEllipse,
    creep_curve,
    forces_of,
    kalker_coefficients,
    over_smooth,
    rolled_over,
)
from asperity.errors import InputError
from asperity.surfaces.synthesis import self_affine
from refusals import refusals

WHEEL = RollingEllipse((6e-3, 4e-3), 80e9, 0.3)


@pytest.mark.parametrize("motion", [((1e-7, 2e-7), 0.0), ((0.0, 0.0), 1e-5)])
def test_fastsim_begins_as_the_linear_theory(motion):
    """Of its own making: flexibilities are those that give the coefficients; strips miss half a per cent."""
    linear, fast = WHEEL.linear_force(*motion), WHEEL.fastsim_force(*motion, 20e3)
    assert fast == pytest.approx(linear, rel=0.01, abs=1e-6 * abs(linear[1]))
    c11, c22, c23 = kalker_coefficients(1.5, 0.3)
    (xi, eta), phi = motion
    assert linear[0] == pytest.approx(-80e9 * 24e-6 * c11 * xi, rel=1e-12)
    across = c22 * eta + c23 * math.sqrt(24e-6) * phi
    assert linear[1] == pytest.approx(-80e9 * 24e-6 * across, rel=1e-12)


def test_fastsim_ends_in_full_sliding_and_is_haines_and_ollertons_between():
    """A strip slips behind the point where bound and traction meet, as long as traction is alone along."""
    assert WHEEL.fastsim_force((0.05, 0.0), 0.0, 20e3) == pytest.approx((-20e3, 0.0), rel=2e-3)
    assert WHEEL.fastsim_force((0.0, -0.05), 0.0, 20e3) == pytest.approx((0.0, 20e3), rel=2e-3)
    xi, limit, (a, b) = 1.5e-3, 20e3, WHEEL.semi_axes
    rise = xi * 3.0 * 80e9 * WHEEL.coefficients[0] / (8.0 * a)  # traction over the distance from the edge
    node = np.linspace(-1.0, 1.0, 2001)
    edge, p0 = a * np.sqrt(1.0 - node**2), 2.0 * limit / (math.pi * a * b)
    stuck = np.clip(2.0 * edge - rise * a**2 / p0, 0.0, None)  # p0 (e² − x²)/a² = rise (e − x)
    slipping = p0 / a**2 * (edge**2 * (2.0 * edge - stuck) - (edge**3 + (edge - stuck) ** 3) / 3.0)
    force = np.trapezoid(0.5 * rise * stuck**2 + slipping, node) * b
    assert WHEEL.fastsim_force((xi, 0.0), 0.0, limit)[0] == pytest.approx(-force, rel=3e-3)


def test_a_curve_rises_from_the_linear_theory_to_full_sliding():
    contact, rolling, a, b = ellipse(1.4, 0.3, 40)
    for direction in ("longitudinal", "lateral"):
        curve = creep_curve(rolling, contact, (a, b), direction, count=8)
        assert curve.slopes == pytest.approx(1.0, abs=0.08)
        assert (np.diff(curve.force[0]) > -1e-5 * curve.limit).all()
        assert (curve.force[0] < curve.linear * 1.05).all()
        assert curve.force[0, -1] == pytest.approx(curve.limit, rel=2e-3)
        assert np.abs(curve.force[0] - curve.fastsim).max() < 0.06 * curve.limit
        assert curve.slip_share[0, -1] == 1.0


def test_spin_drives_sideways_and_then_pivots():
    contact, rolling, a, b = ellipse(1.4, 0.3, 24)
    curve = creep_curve(rolling, contact, (a, b), "spin", creepages=[1e-3, 0.02, 0.5])
    assert curve.force[0, 0] == pytest.approx(curve.linear[0], rel=0.1)
    assert curve.force[0, 1] > 3.0 * curve.force[0, 2] > 0.0


def long_sample(rows, ny, spacing, rms):
    waves = {"longest": 8 * max(spacing), "shortest": 8 / 3 * max(spacing)}
    return self_affine((rows, ny), spacing, rms=rms, hurst=0.8, seed=2, **waves).heights


def test_grooves_along_the_rolling_direction_stand_still_in_the_contact():
    """As they look the same wherever they are, they roll steadily: the one pattern that does."""
    smooth, rolling, *_ = ellipse(0.8, 0.3, (25, 27))
    grooves = np.tile(long_sample(25, 27, rolling.half_space.spacing, 0.2 * smooth.approach)[12], (140, 1))
    motions, distance = ((1e-3, 0.0, 0.0), (0.0, 2e-3, 0.1)), 4.0 * rolling.half_space.spacing[0]
    for axis, (steady, found) in enumerate(rolled_over(rolling, smooth, grooves, motions)):
        first, last, (*creepage, spin) = found[0].normal, found[-1].normal, motions[axis]
        assert last.pressure == pytest.approx(first.pressure, abs=1e-4 * first.pressure.max())
        still = rolling.roll(first, creepage, spin, distance=distance)
        force, slips = over_smooth(steady, found, axis)
        assert force == pytest.approx(still.force[axis] / steady.force[axis], rel=1e-3)
        assert slips == pytest.approx(still.slip_area / first.area, abs=0.02)


def test_an_asperity_that_rolls_through_is_sheared_as_in_a_shift():
    """A spike that carries all of the load sticks: its force grows with the distance, wherever it is."""
    smooth, rolling, *_ = ellipse(1.0, 0.3, 25, friction=1e6)
    spike = np.zeros((125, 25))
    spike[68, 12] = 1e3 * smooth.approach
    ((_, found),) = rolled_over(rolling, smooth, spike, [(1e-6, 0.0, 0.0)])
    touching = [each.normal for each in found if np.count_nonzero(each.normal.pressure) == 1]
    assert len(touching) > 3
    shift, distance = (
        rolling.shift(touching[0], (1e-9, 0.0)).force[0] / 1e-9,
        4 * rolling.half_space.spacing[0],
    )
    state, forces = rolling.shift(touching[0]), []
    for contact in touching[1:]:
        state = rolling.roll(contact, (1e-6, 0.0), before=state, distance=distance)
        forces.append(state.force[0])
    assert forces == pytest.approx(shift * 1e-6 * distance * np.arange(1, len(touching)), rel=1e-4)


def test_samples_follow_the_smooth_contact():
    """Their force begins with what a run comes to that starts from rest, and ends in full sliding."""
    smooth, rolling, a, b = ellipse(0.8, 0.3, (25, 27))
    heights = long_sample(260, 27, rolling.half_space.spacing, 0.15 * smooth.approach)
    xi, curve = (1e-4, 0.0), creep_curve(rolling, smooth, (a, b), creepages=[1e-4, 0.04], samples=[heights])
    begins = curve.force[1, 0] / curve.force[0, 0]
    assert curve.force[:, 1] == pytest.approx(curve.limit, rel=1e-2)
    assert curve.slip_share[:, 1] == pytest.approx(1.0, abs=1e-3)
    distance, state, found = 4.0 * rolling.half_space.spacing[0], None, []
    steady = rolling.roll(smooth, xi, distance=distance).force[0]
    for row in range(7, 168, 4):  # the sample is rolled over from 67 on, and counts from 115 on
        contact = rolling.half_space.solve(smooth.undeformed_gap - heights[row : row + 25], load=smooth.force)
        state = rolling.roll(contact, xi, before=state or rolling.shift(contact), distance=distance)
        found.append((state.force[0] / steady, state.slip_area / contact.area))
    force, slips = np.mean(found[27:], axis=0)
    assert force == pytest.approx(begins, abs=0.03 * (1.0 - begins))
    assert slips == pytest.approx(curve.slip_share[1, 0], abs=5e-4)
    assert rolling.roll(contact, xi, distance=distance).force[0] / steady < 0.9 * begins
    with pytest.raises(InputError, match=r"sample: received shape \(260, 26\); allowed: heights in m, 27"):
        creep_curve(rolling, smooth, (a, b), samples=[heights[:, 1:]])
    with pytest.raises(InputError, match="sample to roll over: received 80 rows; allowed: at least"):
        creep_curve(rolling, smooth, (a, b), samples=[heights[:80]])


def test_friction_that_falls_takes_the_speed():
    contact, rolling, a, b = ellipse(1.0, 0.3, 24, Friction(0.02, 0.4, 0.05))
    slow, fast = (
        creep_curve(rolling, contact, (a, b), creepages=[0.01, 0.05], speed=speed) for speed in (0.01, 20.0)
    )
    assert slow.force[0, 1] == pytest.approx(0.02 * contact.force, rel=0.02)
    assert fast.force[0, 1] == pytest.approx(0.008 * contact.force, rel=0.02)


def asked(ask):
    contact, rolling, a, b = ellipse(1.0, 0.3, 24)
    return ask(rolling, contact, (a, b))


test_what_is_no_curve_is_refused = refusals(
    (lambda *of: creep_curve(*of, "sideways"), "direction of creep: received 'sideways'"),
    (lambda *of: creep_curve(*of, creepages=[0.0, 0.1]), "creepages: received 0"),
    (lambda *of: creep_curve(*of, creepages=[0.2, 0.1]), "creepages: received numbers that do not rise"),
    (lambda *of: creep_curve(*of, count=0), "points of the curve: received 0"),
    (lambda *of: kalker_coefficients(30.0, 0.3), "ratio of the semi-axes: received 30"),
    (lambda *of: kalker_coefficients(1.0, "x"), "Poisson's ratio: received 'x'"),
    of=asked,
)


# --- friction that follows the load

NU, SHEAR, LOAD, SPEED = 0.3, 1e9, 100.0, 10.0
HALF = ellipse(1.0, NU, 8)[2]


def creeping(creepage, friction=0.3, cells=33):
    """A ball under loads up to half more than that."""
    contact, rolling, *_ = ellipse(1.0, NU, cells, friction, scale=1.25)
    return CreepingBodies(rolling, contact.undeformed_gap, creepage, SPEED, 1.5 * LOAD)


ALONG, ACROSS = (
    math.pi * 0.3 * 1.5 * LOAD / (math.pi * HALF**2) * (4.0 - n * NU) / (8.0 * SHEAR) for n in (3, 1)
)
"""Creepages of full slip: it begins where the traction µ p moves the leading edge back as fast as it creeps,
u = π µ p0/(16 G a) (… − (4 − 3ν) x²) along, of both bodies, and (4 − ν) across: Johnson, Contact Mechanics,
Eq. 3.91."""


def test_full_slip_begins_in_its_closed_form():
    """But for half a cell at the leading edge; the ratio of both directions has no such error."""
    along, across = (
        creeping(each, cells=65).full_slip_scale(LOAD) * 1e-3
        for each in ((1e-3, 0.0, 0.0), (0.0, -1e-3, 0.0))
    )
    assert along == pytest.approx(ALONG, rel=0.03)
    assert across / along == pytest.approx(ACROSS / ALONG, rel=5e-3)


def test_full_slip_ends_at_the_load_whose_creepage_it_is():
    """It is as the largest pressure, as the cube root of the load."""
    bodies = creeping((0.0, 0.8 * ACROSS, 0.0), cells=49)
    assert bodies.full_slip_load == pytest.approx(LOAD / bodies.full_slip_scale(LOAD) ** 3, rel=0.1)
    assert creeping((0.0, 0.04, 0.0)).full_slip_load == math.inf
    assert creeping((1e-6, 0.0, 0.0)).full_slip_load == pytest.approx(1.5 * LOAD * 0.2**3, rel=1e-2)
    assert creeping((1e-6, 0.0, 0.0)).full_slip_scale(LOAD) == math.inf


def test_what_follows_the_load_is_steady_rolling_under_it():
    """Forces and moment, zero out of contact."""
    bodies, loads = (
        creeping((1.7e-3, -3.3e-3, 1.7)),
        LOAD * np.array([[0.5, 0.95, 1.45], [-1e-4, 0.0, 0.015]]),
    )
    found = bodies.follow(loads)
    for k, load in enumerate(loads[0].tolist()):
        alone = bodies.at(load)
        assert found[:, 0, k] == pytest.approx([*alone.force, alone.moment], rel=0.02)
    assert not np.any(found[:, 1, :2])
    assert np.hypot(*found[:2, 1, 2]) == pytest.approx(0.3 * loads[1, 2], rel=0.01)


def test_what_drives_is_the_heat():
    """Of a contact as of forces; traction times slip comes to it as cells shrink. In full slip µ N V |ξ|."""
    missing = []
    for bodies in (creeping((1.7e-3, -3.3e-3, 1.7), cells=cells) for cells in (25, 49)):
        found = bodies.at(LOAD)
        power = -SPEED * float(np.dot(bodies.creepage, forces_of(found)))
        assert found.dissipated_power == pytest.approx(power, rel=1e-12)
        loads = np.array([LOAD, 0.0, -1.0])
        assert bodies.power(loads) == pytest.approx([power, 0.0, 0.0], rel=5e-3)
        missing.append(1.0 - found.work_of_slip * SPEED / power)
    assert 0.0 < 1.8 * missing[1] < missing[0] < 0.11
    sliding = creeping((0.02, 0.02, 0.0))
    heat = 0.3 * LOAD * SPEED * math.hypot(0.02, 0.02)
    assert sliding.power(np.array(LOAD)) == pytest.approx(heat, rel=2e-3)


def test_slopes_are_those_of_the_coefficient_in_full_slip_and_of_the_linear_theory_before():
    """F_y = −µ(|η| V) N to the other side, far above the creepage by which the bodies give way."""
    over_creepage, over_load = creeping((0.0, -0.04, 0.0), Friction(0.02, 0.4, 0.5)).slopes(LOAD)
    fallen = 0.6 * math.exp(-0.04 * SPEED / 0.5)
    assert over_load == pytest.approx(0.02 * (0.4 + fallen), rel=0.01)
    assert over_creepage == pytest.approx(LOAD * 0.02 * SPEED / 0.5 * fallen, rel=0.03)
    over_creepage, over_load = creeping((0.0, 1e-6, 0.0)).slopes(LOAD)
    _, force = RollingEllipse((HALF, HALF), SHEAR, NU).linear_force((0.0, 1.0), 0.0)
    assert over_creepage == pytest.approx(force, rel=0.05)
    assert over_load == pytest.approx(1e-6 * force * 2.0 / 3.0 / LOAD, rel=0.1)  # as the square of the size
