"""Friction that follows the load: full slip in closed form, a table against single solutions, slopes."""

import math

import numpy as np
import pytest

from asperity import Friction, FrictionalHalfSpace, HalfSpace, Hertz, material
from asperity.contact.creep import CreepingBodies, RollingEllipse, forces_of

STEEL, RADIUS, LOAD, SPEED = material("steel"), 0.46, 65e3, 10.0
NU = STEEL.poisson_ratio
SHEAR = 0.5 * STEEL.youngs_modulus / (1.0 + NU)
SMOOTH = Hertz(0.5 * STEEL.youngs_modulus / (1.0 - NU**2), RADIUS, RADIUS)
HALF = SMOOTH.semi_axes(SMOOTH.approach(LOAD))[0]


def creeping(creepage, friction=0.3, cells=33, largest=1.5 * LOAD):
    spacing = 2.5 * HALF / cells
    x = spacing * (np.arange(cells) - 0.5 * (cells - 1))
    gap = np.add.outer(x**2, x**2) / (2.0 * RADIUS)
    bodies = FrictionalHalfSpace(HalfSpace(gap.shape, spacing, SMOOTH.modulus), (STEEL, STEEL), friction)
    return CreepingBodies(bodies, gap, creepage, SPEED, largest)


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
    bodies, loads = creeping((1e-3, -2e-3, 0.3)), np.array([[3e4, 6.1e4, 9.3e4], [-5.0, 0.0, 1e3]])
    found = bodies.follow(loads)
    for k, load in enumerate(loads[0].tolist()):
        alone = bodies.at(load)
        assert found[:, 0, k] == pytest.approx([*alone.force, alone.moment], rel=0.02)
    assert not np.any(found[:, 1, :2])
    assert np.hypot(*found[:2, 1, 2]) == pytest.approx(0.3 * 1e3, rel=0.01)


def test_what_drives_is_the_heat():
    """That of the slip in each cell comes to it as cells shrink; in full slip it is µ N V |ξ|."""
    missing = []
    for bodies in (creeping((1e-3, -2e-3, 0.3), cells=cells) for cells in (25, 49)):
        found = bodies.at(LOAD)
        missing.append(1.0 - found.dissipated_power / bodies.power(forces_of(found)))
    assert 0.0 < 1.8 * missing[1] < missing[0] < 0.11
    sliding = creeping((0.02, 0.02, 0.0))
    heat = 0.3 * LOAD * SPEED * math.hypot(0.02, 0.02)
    assert sliding.power(forces_of(sliding.at(LOAD))) == pytest.approx(heat, rel=2e-3)


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
