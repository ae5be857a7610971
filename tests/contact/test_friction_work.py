"""Heat of friction: against closed forms, sums over cells, and what is put in less what is stored."""

import math

import numpy as np
import pytest
import test_friction
from test_friction import HARD, SOFT, body, displaced, ellipse, places, rigid

from asperity import FrictionalHalfSpace, HalfSpace
from asperity.contact.wear import rubbing
from asperity.kernels.traction_influence import pressure_displacement

MOTIONS = [((1e-3, 0.0), 0.0), ((1e-5, 0.0), 0.0), ((4e-4, -3e-4), 0.3), ((0.0, 0.0), 0.6)]


@pytest.mark.parametrize(("creepage", "spin"), MOTIONS)
def test_steady_rolling_turns_what_drives_it_into_heat(creepage, spin):
    """−V (F·ξ + M φ), also where little slips; and cell by cell, of what slips under its mean traction."""
    contact, solver, *_ = ellipse(0.7, 0.3, (24, 20), scale=1.3)
    found, speed = solver.roll(contact, creepage, spin, speed=30.0), 30.0
    driven = found.force[0] * creepage[0] + found.force[1] * creepage[1] + found.moment * spin
    assert found.dissipated_power == pytest.approx(-speed * driven, rel=1e-12)
    dx = solver.half_space.spacing[0]
    slip = (
        rigid(solver, found, dx) + displaced(solver, found.traction) - displaced(solver, found.traction, dx)
    )
    slip[1] += dx * spin * dx / 3.0  # that of the middle of the step, not of a sixth
    assert found.work * dx == pytest.approx(in_cells(solver, found, found, slip), rel=1e-9)


def in_cells(solver, found, before, slip):
    """−½ ∫ (p + p')·s, J, at the same material."""
    mean = found.traction.copy()
    mean[:, :-1] += before.traction[:, 1:]
    return -0.5 * float((mean * slip).sum()) * solver.half_space.cell_area


def test_heat_of_a_long_roller_is_carters_at_any_creepage():
    """−F ξ of µ N (1 − (1 − ξ R/µ a)²). Traction times slip in each cell comes to it from below."""
    errors = {}
    for n in (33, 65):
        contact, solver, _ = test_friction.long_roller(n, 0.0)
        for share in (0.05, 0.64):
            creepage = test_friction.CREEPING * (1.0 - math.sqrt(1.0 - share))
            found = solver.roll(contact, (creepage, 0.0), speed=20.0)
            exact = share * found.limit * creepage * 20.0
            errors[n, share] = found.dissipated_power / exact - 1.0
            errors[n, -share] = found.work_of_slip * 20.0 / exact - 1.0
    for share in (0.05, 0.64):
        assert abs(errors[65, share]) < min(0.01, abs(errors[33, share]))
    assert -1.01 < errors[33, -0.05] < errors[65, -0.05] < -0.3
    assert errors[33, -0.64] < errors[65, -0.64] < -0.02


SHARE = 0.7


def test_a_closed_loop_takes_mindlins_and_deresiewiczs_energy_in_steps_of_any_length():
    """ΔW = 4 µ N (T δ − 2 ∫ δ dT) of the curve δ = k (1 − (1 − T)^⅔); the way there takes a quarter of it."""
    contact, solver, a, _ = ellipse(1.0, 0.0, 48)
    limit = 0.3 * contact.force
    k = 6.0 * limit / (8.0 * 1e9 * a)
    end, area = k * (1 - (1 - SHARE) ** (2 / 3)), k * (SHARE - 0.6 * (1 - (1 - SHARE) ** (5 / 3)))
    loop = 4.0 * limit * (SHARE * end - 2.0 * area)

    def along(shares, state=None):
        work, given, force = 0.0, 0.0, 0.0 if state is None else -state.force[0]
        for share in shares:
            state = solver.shift(contact, force=(-share * limit, None), before=state)
            given += 0.5 * (force - state.force[0]) * state.creepage[0]
            work, force = work + state.work, -state.force[0]
        return state, work, given

    state, way, _ = along([SHARE])
    assert way == pytest.approx(0.25 * loop, rel=4e-3)
    assert state.elastic_energy == pytest.approx(limit * (SHARE * end - area) - 0.25 * loop, rel=2e-3)
    in_steps, work, given = along(np.linspace(0.0, SHARE, 41)[1:])
    assert work == pytest.approx(way, rel=1e-3)
    assert given - in_steps.elastic_energy == pytest.approx(work, rel=4e-3)
    back, there, _ = along([-SHARE], state)
    again, here, _ = along([0.1, SHARE], back)
    assert there + here == pytest.approx(loop, rel=4e-3)
    assert again.elastic_energy == pytest.approx(state.elastic_energy, rel=1e-3)


def test_a_ball_that_is_lifted_off_turns_all_that_it_has_stored_into_heat():
    """It is not shifted on the way, so that nothing is put in; the error falls as the square of the steps."""
    contact, solver, *_ = ellipse(1.0, 0.0, 24)
    gap, limit, missing = contact.undeformed_gap, 0.3 * contact.force, []
    for steps in (8, 16):
        state, heat = solver.shift(contact, force=(-0.5 * limit, 0.0)), 0.0
        stored = state.elastic_energy
        for load in contact.force * np.linspace(1.0, 0.0, steps + 1)[1:-1] ** 2:
            state = solver.shift(solver.half_space.solve(gap, load=load), before=state)
            heat += state.work
        state = solver.shift(solver.half_space.solve(gap, approach=-1e-9), before=state)
        assert state.elastic_energy == 0.0
        missing.append((heat + state.work) / stored - 1.0)
    assert abs(missing[1]) < min(0.02, 0.5 * abs(missing[0]))


def test_cells_that_leave_the_contact_slip_by_the_whole_of_what_is_shifted():
    """Lifted off at once, shifted and turned meanwhile: under half of µ p, by all that it is moved."""
    contact, solver, a, _ = ellipse(1.0, 0.3, 16)
    state = solver.shift(contact, (2e-7, 1e-7), 2e-4)
    apart = solver.half_space.solve(contact.undeformed_gap, approach=-1e-9)
    off = solver.shift(apart, (1e-7, -3e-7), 5e-4, before=state)
    slip = np.hypot(*(rigid(solver, off) - displaced(solver, state.traction)))
    expected = float((0.5 * state.bound * slip).sum()) * solver.half_space.cell_area
    assert off.work == pytest.approx(expected, rel=1e-9)
    assert 5e-4 * a > 3e-7  # turning counts


def test_a_transient_keeps_its_energy_and_ends_in_the_heat_of_steady_rolling():
    """From a shift, under a load that changes, forth and back; each step as a sum over cells."""
    smooth, solver, *_ = ellipse(0.7, 0.3, (20, 14), scale=1.4)
    space, dx = solver.half_space, solver.half_space.spacing[0]
    before, heat, given = solver.shift(smooth, (4e-7, 0.0)), 0.0, 0.0
    stored = before.elastic_energy
    for step in range(12):
        contact = space.solve(smooth.undeformed_gap, load=smooth.force * (1.0 - 0.05 * (step % 4)))
        motion = (6e-4 if step < 6 else -8e-4, 2e-4)
        state = solver.roll(contact, motion, before=before)
        slip = rigid(solver, state, dx)
        slip += displaced(solver, state.traction) - displaced(solver, before.traction, dx)
        scale = state.limit * 1e-3 * dx
        assert state.work * dx == pytest.approx(in_cells(solver, state, before, slip), abs=1e-9 * scale)
        heat += state.work * dx
        given -= 0.5 * dx * float(np.add(state.force, before.force) @ motion)
        before = state
    assert heat == pytest.approx(given + stored - before.elastic_energy, rel=1e-9)
    assert stored > 0.1 * heat > 0.0
    for _ in range(160):
        before = solver.roll(smooth, (4e-4, -3e-4), 0.3, before=before)
    steady = solver.roll(smooth, (4e-4, -3e-4), 0.3)
    assert before.work == pytest.approx(steady.work, rel=1e-4)
    assert before.elastic_energy == pytest.approx(steady.elastic_energy, rel=1e-4)
    passed = rubbing(solver, steady, steady).work.sum() * space.cell_area
    assert passed == pytest.approx(steady.work + steady.force[1] * 0.3 * dx / 3.0, rel=1e-9)


def test_unlike_bodies_that_roll_freely_make_heat_without_a_force():
    """Their pressure drives them: a cylinder, and a ball cell by cell, in steady and transient rolling."""
    bodies = (body(23e9, 0.31), body(82e9, 0.28))
    modulus = 1.0 / sum((1.0 - b.poisson_ratio**2) / b.youngs_modulus for b in bodies)
    space, x = HalfSpace((108, 1), (2e-6, 1.0), modulus), places(108, 2e-6)[:, None]
    cylinder = FrictionalHalfSpace(space, bodies, 0.05)
    free = cylinder.roll(space.solve(20.0 * x**2, load=16201.9), force=(0.0, None))
    assert free.work == pytest.approx(free.work_of_slip, rel=0.02)
    assert abs(free.force[0] * free.creepage[0]) < 1e-3 * free.work
    contact, solver, *_ = ellipse(0.8, 0.1, (20, 16), 0.4, scale=1.4, bodies=(SOFT, HARD))
    dx, before = solver.half_space.spacing[0], solver.shift(contact, (1e-6, 0.0))
    for state, past in (
        (found := solver.roll(contact, (3e-3, 0.0)), found),
        (solver.roll(contact, (3e-3, 0.0), before=before), before),
    ):
        slip = rigid(solver, state, dx) + moved(solver, state) - moved(solver, past, dx)
        assert state.work * dx == pytest.approx(in_cells(solver, state, past, slip), rel=1e-6)


@pytest.mark.parametrize(("creepage", "spin"), [((1e-4, 0.0), 0.0), ((8e-3, 0.0), 0.0), ((2e-4, 5e-4), -0.3)])
def test_what_rolls_of_unlike_bodies_is_driven_by_the_moment_of_its_pressure_as_well(creepage, spin):
    """−V (F·ξ + M φ) + V ∫ p x dA/R: pressure that leans ahead resists rolling."""
    contact, solver, *_ = ellipse(0.8, 0.1, (60, 50), 0.3, scale=1.2, bodies=(SOFT, HARD))
    found = solver.roll(contact, creepage, spin, speed=17.0)
    space, pressed = solver.half_space, found.normal.pressure
    x = places(60, space.spacing[0])[:, None]
    radius = 0.5 * x[0] ** 2 / (contact.undeformed_gap[0] - contact.undeformed_gap[30]).mean()
    leans = float((pressed * x).sum()) * space.cell_area / float(radius[0])
    driven = -(found.force[0] * creepage[0] + found.force[1] * creepage[1] + found.moment * spin)
    scale = 17.0 * (abs(driven) + abs(leans))
    assert abs(leans) > 0.05 * abs(driven)
    assert found.dissipated_power == pytest.approx(17.0 * (driven + leans), abs=0.01 * scale)


def moved(solver, state, ahead=0.0):
    """Displacement by traction and pressure (2, nx, ny), m, summed over cells."""
    nx, ny = solver.half_space.shape
    spread = pressure_displacement(*test_friction.between_cells(solver, ahead))
    kernel = solver.unlikeness / math.pi * np.array([spread.real, spread.imag])
    drawn = sum(
        state.normal.pressure[i, j] * kernel[:, nx - 1 - i : 2 * nx - 1 - i, ny - 1 - j : 2 * ny - 1 - j]
        for i, j in np.argwhere(state.normal.pressure)
    )
    return displaced(solver, state.traction, ahead) - drawn
