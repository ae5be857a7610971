"""Coulomb's law on rough and unlike contacts, in transients, and friction that falls or differs by place."""

import math

import numpy as np
import pytest
from scipy.optimize import brentq
from scipy.special import ellipk, hyp2f1
from test_friction import body, displaced, ellipse, places

from asperity import Friction, FrictionalHalfSpace
from asperity.contact import tangential
from asperity.errors import OutOfRangeWarning
from asperity.kernels.traction import pressure_displacement
from asperity.surfaces.synthesis import self_affine
from refusals import refusals


def rough(nu=0.3, friction=0.3, bodies=None, shape=(40, 28)):
    smooth, solver, *_ = ellipse(0.8, nu, shape, friction, bodies=bodies)
    space = solver.half_space
    waves = {"longest": 12 * max(space.spacing), "shortest": 4 * max(space.spacing)}
    heights = self_affine(shape, space.spacing, rms=0.3 * smooth.approach, hurst=0.8, seed=2, **waves)
    return space.solve(smooth.undeformed_gap - heights.heights, load=smooth.force), solver


def rigid(solver, found, by=None):
    """Over a shift, or rolled by a distance, whose spin is that a sixth of the distance ahead."""
    space, (xi, eta, spin) = solver.half_space, found.creepage
    x, y = (places(n, d) for n, d in zip(space.shape, space.spacing, strict=True))
    across = eta + spin * (x[:, None] + (by or 0.0) / 6)
    return (by or 1.0) * np.array(np.broadcast_arrays(xi - spin * y[None], across))


def check_coulomb(found, slip, largest):
    """Tractions within their discs; no slip inside, and slip opposite to the traction on their edges."""
    contact, size = found.normal.pressure > 0.0, np.hypot(*found.traction)
    assert (size <= found.bound * (1 + 1e-12)).all()
    inside = contact & (size < found.bound * (1 - 1e-9))
    assert 0.02 < inside.sum() / contact.sum() < 0.98
    assert np.hypot(*slip)[inside].max() < 2e-6 * largest
    sliding = contact & ~inside
    along = -(slip * found.traction).sum(axis=0)[sliding] / size[sliding]
    assert np.hypot(*slip)[sliding] - along == pytest.approx(0.0, abs=2e-6 * largest)
    assert found.stick_area == pytest.approx(inside.sum() * found.normal.half_space.cell_area, rel=0.02)


def test_a_rough_contact_obeys_coulombs_law_in_steps_and_in_steady_rolling():
    """The slip is summed cell by cell, from the closed forms of a cell."""
    contact, solver = rough()
    dx = solver.half_space.spacing[0]
    turned = solver.shift(contact, (3e-7, -2e-7), 4e-4)
    slip = rigid(solver, turned) + displaced(solver, turned.traction)
    check_coulomb(turned, slip, np.hypot(*rigid(solver, turned)).max())
    after = solver.roll(contact, (2e-4, 1e-4), 0.3, before=turned, distance=1.5 * dx)
    past = displaced(solver, turned.traction, 1.5 * dx)
    without = rigid(solver, after, 1.5 * dx) - past
    slip = without + displaced(solver, after.traction)
    check_coulomb(after, slip, np.hypot(*without)[contact.pressure > 0].max())
    touching = np.s_[:, contact.pressure > 0]
    assert after.slip[touching] * 1.5 * dx == pytest.approx(slip[touching], abs=1e-17)
    steady = solver.roll(contact, (2e-4, 3e-4), 0.5)
    moved = displaced(solver, steady.traction) - displaced(solver, steady.traction, dx)
    slip = rigid(solver, steady, dx) + moved
    check_coulomb(steady, slip, np.hypot(*rigid(solver, steady, dx)).max())


def test_a_transient_ends_in_steady_rolling():
    contact, solver, *_ = ellipse(0.7, 0.3, (20, 14))
    state, motion = solver.shift(contact), ((4e-4, -3e-4), 0.3)
    steady = solver.roll(contact, *motion)
    for _ in range(160):
        state = solver.roll(contact, *motion, before=state)
    assert state.traction == pytest.approx(steady.traction, abs=5e-5 * steady.bound.max())
    power = solver.roll(contact, *motion, speed=3.0).dissipated_power
    assert power == pytest.approx(3.0 * steady.work, rel=1e-9)


def test_what_drives_steady_rolling_becomes_heat():
    """Nothing is stored; what steps of a distance store falls with the distance."""
    missing = []
    for n in (24, 48, 96):
        contact, solver, *_ = ellipse(0.7, 0.3, n)
        found = solver.roll(contact, (4e-3, -3e-3), 0.3)
        driven = -(np.dot(found.force, found.creepage[:2]) + found.moment * found.creepage[2])
        missing.append(1.0 - found.work / driven)
    assert missing[2] < 0.02
    assert missing == sorted(missing, reverse=True)
    assert missing[2] < 0.6 * missing[1] < 0.36 * missing[0]


@pytest.mark.filterwarnings("ignore::asperity.errors.UnconvergedWarning")
def test_no_step_raises_the_energy(monkeypatch):
    """Of a contact that turns back, with friction so uneven that a projected step would."""
    friction, motion, energies = np.random.default_rng(1).uniform(0.0, 0.6, (32, 13)), (1e-3, 2e-4), []
    contact, solver, a, _ = ellipse(0.5, 0.0, (32, 13), friction)
    before, dx = solver.shift(contact, (-3e-3 * a, -6e-4 * a)), solver.half_space.spacing[0]
    for most in (*range(12), 300):
        monkeypatch.setattr(tangential, "MAX_ITERATIONS", most)
        found = solver.roll(contact, motion, before=before)
        without = rigid(solver, found, dx) - displaced(solver, before.traction, dx)
        energies.append(float((found.traction * (dx * found.slip + without)).sum()))
    assert (np.diff(energies) <= 1e-12 * abs(energies[-1])).all()
    assert 4 < found.iterations < 12


def test_spin_alone_is_symmetric():
    """Against the reflection y → −y: no force along, tractions along odd, those across even."""
    contact, solver, *_ = ellipse(1.3, 0.3, (30, 24))
    found = solver.roll(contact, spin=0.6)
    scale = found.bound.max()
    assert found.traction[0] == pytest.approx(-found.traction[0, :, ::-1], abs=1e-4 * scale)
    assert found.traction[1] == pytest.approx(found.traction[1, :, ::-1], abs=1e-4 * scale)
    assert found.force[1] < -0.01 * found.limit
    assert found.moment < 0.0
    with pytest.warns(OutOfRangeWarning, match="pivot on a place inside of it: 100 %"):
        turned = solver.shift(contact, rotation=1.0)
    x, y = (places(n, d) for n, d in zip((30, 24), solver.half_space.spacing, strict=True))
    pivots = -(turned.bound * np.hypot(x[:, None], y)).sum() * solver.half_space.cell_area
    assert turned.moment == pytest.approx(pivots, rel=1e-3)


def test_full_sliding_carries_the_friction_of_the_law_and_of_the_map():
    contact, solver, *_ = ellipse(1.0, 0.3, (24, 24))
    space, bodies, xi = solver.half_space, (body(1e9, 0.3),) * 2, 0.04

    def force(friction, **more):
        return FrictionalHalfSpace(space, bodies, friction).roll(contact, (-0.6 * xi, 0.8 * xi), **more).force

    full = np.array((0.6, -0.8)) * contact.force
    assert force(0.02) == pytest.approx(0.02 * full, rel=1e-4)
    assert force(Friction(0.02, 0.7)) == pytest.approx(0.014 * full, rel=1e-4)
    falling = 0.02 * (0.25 + 0.75 * math.exp(-xi * 2.0 / 0.1))
    assert force(Friction(0.02, 0.25, 0.1), speed=2.0) == pytest.approx(falling * full, rel=3e-3)
    half = np.where(np.arange(24) < 12, 0.02, 0.0)[:, None] * np.ones(24)
    assert force(half) == pytest.approx(0.01 * full, rel=5e-4)


def test_falling_friction_drops_behind_its_peak_only_where_it_slips():
    contact, solver, *_ = ellipse(1.0, 0.3, (24, 24))
    law = FrictionalHalfSpace(solver.half_space, (body(1e9, 0.3),) * 2, Friction(0.3, 0.5, 1e-3))
    small, large = (law.roll(contact, (xi, 0.0)) for xi in (3e-4, 3e-3))
    assert large.limit < small.limit < 0.3 * contact.force
    stuck = small.sticks
    assert small.bound[stuck] == pytest.approx(0.3 * contact.pressure[stuck], rel=1e-3)
    slip = np.hypot(*small.slip)[small.bound > 0]
    expected = 0.3 * contact.pressure[small.bound > 0] * (0.5 + 0.5 * np.exp(-slip / 1e-3))
    assert small.bound[small.bound > 0] == pytest.approx(expected, rel=2e-3)


SOFT, HARD, UNIT = body(1e8, 0.1), body(1e10, 0.3), body(1e9, 0.3)


def test_pressure_draws_the_surface_of_the_more_compressible_body_in():
    """Boussinesq's point force on the softer body: −(1 − 2ν) P/(4πG) x/r²."""
    rigid_body = body(1e14, 0.3)
    _, solver, *_ = ellipse(1.0, 0.1, (21, 21), bodies=(SOFT, rigid_body))
    pressure = np.zeros((21, 21))
    pressure[10, 10] = 1.0
    dx = solver.half_space.spacing[0]
    u = solver.displacement(np.zeros((21, 21)), pressure)
    expected = -0.8 * dx**2 / (4 * math.pi * 1e8 * 8 * dx)
    found = [u[18, 10].real, u[18, 10].imag]
    assert found == pytest.approx([expected, 0.0], rel=5e-3, abs=1e-3 * abs(expected))


def test_unlike_bodies_settle_with_the_pressure():
    """Normal and tangential laws hold at once, with the coupling summed from the closed form of a cell."""
    contact, solver = rough(0.1, 0.4, (SOFT, HARD))
    found = solver.shift(contact, (1e-6, 0.0))
    space, (nx, ny) = solver.half_space, solver.half_space.shape
    x, y = (d * np.arange(1 - n, n) for n, d in zip(space.shape, space.spacing, strict=True))

    def summed(part, values, ahead=0.0):
        spread = pressure_displacement(x[:, None] + ahead, y[None], *space.spacing)
        kernel = solver.unlikeness / math.pi * getattr(spread, part)
        return sum(
            values[i, j] * kernel[nx - 1 - i : 2 * nx - 1 - i, ny - 1 - j : 2 * ny - 1 - j]
            for i, j in np.argwhere(values)
        )

    def moved(state, ahead=0.0):
        drawn = np.array([summed(part, state.normal.pressure, ahead) for part in ("real", "imag")])
        return displaced(solver, state.traction, ahead) - drawn

    pressure = found.normal.pressure
    gap = contact.undeformed_gap + sum(map(summed, ("real", "imag"), found.traction))
    gap += space.displacement(pressure) - found.normal.approach
    assert np.abs(gap[pressure > 0]).max() < 1e-3 * found.normal.approach
    assert gap.min() > -1e-3 * found.normal.approach
    assert found.normal.force == pytest.approx(contact.force, rel=1e-9)
    dx = space.spacing[0]
    steady, after = solver.roll(contact, (3e-3, 0.0)), solver.roll(contact, (3e-3, 0.0), before=found)
    for state, past in ((found, 0.0), (steady, moved(steady, dx)), (after, moved(found, dx))):
        slip = rigid(solver, state, 1.0 if state is found else dx) + moved(state) - past
        stuck = state.sticks
        assert 0.02 < stuck.sum() / (pressure > 0).sum() < 0.98
        assert np.hypot(*slip)[stuck].max() < 2e-3 * 1e-6
    uncoupled = FrictionalHalfSpace(space, (SOFT, HARD), 0.4, coupled=False)
    with pytest.warns(OutOfRangeWarning, match=r"unlike, and that is neglected: .* about 44 %"):
        uncoupled.shift(contact, (1e-6, 0.0))


def pressed_punch(beta, friction, n):
    """Stick radius, share of friction that is used, and gain in stiffness of a rigid punch of unit radius.

    On n rings, each of even pressure and of radial traction that grows with the radius, by integrals of
    Weber and Schafheitlin. The traction goes over into the friction µ p at the stick radius.
    """

    def solved(c):
        angle = np.linspace(0.0, 0.5 * math.pi, n // 2 + 1)
        edge = np.concatenate([c * np.sin(angle), 0.5 * (1 + c) - 0.5 * (1 - c) * np.cos(2 * angle[1:])])
        r, b = 0.5 * (edge[1:] + edge[:-1])[:, None], np.maximum(edge, 1e-9)
        inner, outer = np.minimum(r / b, 1.0) ** 2, np.minimum(b / r, 1.0) ** 2
        press = np.where(r < b, b * hyp2f1(0.5, -0.5, 1, inner), b**2 / (2 * r) * hyp2f1(0.5, 0.5, 2, outer))
        within, beyond = 0.5 * b * r * hyp2f1(1.5, -0.5, 2, inner), hyp2f1(1.5, 0.5, 3, outer)
        rub = np.where(r < b, within, b**4 / (8 * r**2) * beyond)
        area = 0.5 * np.diff(edge**2)
        drawn = np.diff(0.5 * np.minimum(edge, r) ** 2, axis=1) / r  # what lies inside a place
        lifted = np.diff(0.5 * np.maximum(edge, r) ** 2, axis=1)  # traction outside of it, over its radius
        stick = np.arange(n) < n // 2
        slide = np.diag(np.where(stick, 0.0, friction / r[:, 0]))
        down, out = np.diff(press, axis=1), np.diff(rub, axis=1)
        upper = [down - beta * lifted @ slide, -beta * lifted[:, stick]]
        lower = [(out @ slide - beta * drawn)[stick], out[np.ix_(stick, stick)]]
        found = np.linalg.solve(np.block([upper, lower]), np.concatenate([np.ones(n), np.zeros(n // 2)]))
        p, q = found[:n], friction * found[:n]
        q[stick] = found[n:] * r[stick, 0]
        return p, q, area

    def jump(c):
        p, q, _ = solved(c)
        return q[n // 2 - 1] - friction * p[n // 2 - 1]

    c = brentq(jump, 0.05, 0.99, xtol=1e-6)
    p, q, area = solved(c)
    return c, q @ area / (friction * p @ area), p @ area * math.pi / 2


def test_the_stick_radius_of_a_punch_is_spences_where_the_coupling_is_weak():
    """D. A. Spence, J. Elasticity 5 (1975) 297: (a/2c) ln((a + c)/(a − c)) = (µ/β) K'(c/a), for β → 0."""
    c = pressed_punch(0.01, 0.006, 60)[0]
    assert math.log((1 + c) / (1 - c)) / (2 * c) == pytest.approx(0.6 * ellipk(1 - c * c), rel=2e-3)


def flat_punch(n, nu, friction):
    """A rigid punch on n cells, pressed in one step, by how much friction stiffens it, and the ball's."""
    contact, solver, *_ = ellipse(1.0, nu, n, friction, bodies=(body(1e9, nu), body(1e15, 0.3)))
    x = (np.arange(n) - 0.5 * (n - 1)) / (0.48 * n)
    gap = np.where(np.add.outer(x**2, x**2) < 1.0, 0.0, 1.0)
    flat = solver.half_space.solve(gap, load=contact.force)
    punch = solver.shift(flat)
    return punch, flat.approach / punch.normal.approach, contact, solver


@pytest.mark.parametrize(("nu", "ratio"), [(0.0, 0.6), (0.3, 0.9)])
def test_what_is_pressed_on_an_unlike_body_sticks_as_an_axisymmetric_solution(nu, ratio):
    """Strongly coupled, a punch in one step, and a ball, that grows like itself, by equal ratios of load.

    In both the stick radius is the same share of the contact (Spence), and so is the friction that is used.
    """
    beta = 0.5 * (1 - 2 * nu) / (1 - nu)
    radius, share, gain = pressed_punch(beta, ratio * beta, 60)
    errors = []
    for n in (16, 32):
        punch, stiffer, contact, solver = flat_punch(n, nu, ratio * beta)
        assert stiffer == pytest.approx(gain, rel=1e-3)
        ball = None
        for step in range(-18, 1):
            loaded = solver.half_space.solve(contact.undeformed_gap, load=contact.force * 1.2**step)
            ball = solver.shift(loaded, before=ball)
        for found in (punch, ball):
            assert math.sqrt(found.stick_area / found.normal.area) == pytest.approx(radius, abs=1.2 / n)
            assert found.force == pytest.approx((0.0, 0.0), abs=1e-6 * found.limit)
            errors.append(np.hypot(*found.traction).sum() / found.bound.sum() - share)
    assert abs(errors[2]) < min(1.5e-3, 0.5 * abs(errors[0]))
    assert abs(errors[3]) < min(7e-3, 0.6 * abs(errors[1]))


def test_a_punch_that_does_not_slip_is_mossakovskiis():
    """Stiffer than without friction by artanh(β)/β, that is ln 3 where it does not yield across at all."""
    errors = [flat_punch(n, 0.0, 40.0)[1] / math.log(3.0) - 1.0 for n in (16, 32)]
    assert abs(errors[1]) < min(2e-3, 0.6 * abs(errors[0]))


def test_forces_that_are_given_are_found():
    contact, solver, *_ = ellipse(0.8, 0.3, (24, 24))
    limit = 0.3 * contact.force
    both = solver.roll(contact, spin=0.2, force=(-0.5 * limit, 0.3 * limit))
    assert both.force == pytest.approx((-0.5 * limit, 0.3 * limit), abs=2e-6 * limit)
    again = solver.roll(contact, both.creepage[:2], 0.2)
    assert again.force == pytest.approx(both.force, abs=1e-4 * limit)
    near = solver.roll(contact, (0.0, 2e-4), force=(0.97 * limit, None))
    assert near.force[0] == pytest.approx(0.97 * limit, abs=2e-6 * limit)
    assert near.creepage[1] == 2e-4
    apart = solver.half_space.solve(contact.undeformed_gap, approach=-1e-6)
    assert solver.roll(apart, (1e-3, 0.0)).force == (0.0, 0.0)
    assert solver.roll(apart, force=(0.0, None)).force == (0.0, 0.0)


def on_fewer_cells():
    contact, solver, *_ = ellipse(1.0, 0.3, 20)
    return solver.shift(contact)


test_what_has_no_meaning_is_refused = refusals(
    (lambda s, c: Friction(-0.1), "friction: received -0.1; allowed: coefficients of friction of at least 0"),
    (lambda s, c: Friction([[0.1, math.nan]]), "friction: received nan"),
    (lambda s, c: Friction(0.3, 1.2), "kinetic share of friction: received 1.2; allowed: from 0 to 1"),
    (lambda s, c: Friction(0.3, 0.5, 0.0), "slip velocity of friction: received 0"),
    (lambda s, c: FrictionalHalfSpace(s.half_space, (SOFT, SOFT), 0.3), "modulus of the bodies: received"),
    (lambda s, c: FrictionalHalfSpace(s.half_space, (UNIT,) * 2, np.ones(3)), "a map of shape (3,)"),
    (lambda s, c: s.roll(c, (math.inf, 0.0)), "creepage or shift: received inf"),
    (lambda s, c: s.roll(c, distance=0.0), "rolled distance: received 0"),
    (lambda s, c: s.roll(c, speed=-1.0), "rolling speed: received -1"),
    (lambda s, c: s.roll(c, rtol=1.0), "rtol: received 1"),
    (lambda s, c: s.roll(c, force=(31.0, None)), "force: received 31 N; allowed: less than 30 N of friction"),
    (lambda s, c: s.roll(c, force=(1.0,)), "force: received"),
    (lambda s, c: s.roll(c, (0.0, 0.0, 0.1)), "creepage: received"),
    (lambda s, c: s.shift(c, (1e-6,)), "shift: received"),
    (lambda s, c: s.roll(c, start=c), "state before: received one on another grid"),
    (lambda s, c: s.roll(c, before=on_fewer_cells()), "state before: received one on another grid"),
    (lambda s, c: s.roll(None), "contact: received one on another half-space, or none"),
    (lambda s, c: FrictionalHalfSpace(s.half_space, ("steel",) * 2, 0.3), "('steel', 'steel'); allowed: two"),
    (lambda s, c: FrictionalHalfSpace(s.half_space, (SOFT,), 0.3), "bodies: received ("),
    (lambda s, c: ellipse(1.0, 0.3, 24)[1].roll(c), "contact: received one on another half-space"),
    of=lambda ask: ask(*ellipse(1.0, 0.3, 24)[1::-1]),
)


def test_large_creepages_are_warned_of_with_the_share_that_slips():
    contact, solver, *_ = ellipse(1.0, 0.3, 24)
    with pytest.warns(OutOfRangeWarning, match=r"of 0\.2 is above 0\.05.*100 % of the contact slips"):
        solver.roll(contact, (0.2, 0.0))
