"""Friction: influence by quadrature, printed curves and coefficients, closed forms, Coulomb's law itself."""

import math

import numpy as np
import pytest

from asperity import Friction, FrictionalHalfSpace, HalfSpace, Hertz, Material
from asperity.contact import tangential
from asperity.contact.creep import kalker_coefficients
from asperity.errors import OutOfRangeWarning
from asperity.kernels.traction_influence import pressure_displacement, traction_displacement
from asperity.surfaces.synthesis import self_affine
from refusals import refusals


def body(shear, nu):
    return Material("body", 2.0 * shear * (1.0 + nu), nu, 7850.0)


def places(n, d):
    return d * (np.arange(n) - 0.5 * (n - 1))


def ellipse(ratio, nu, n, friction=0.3, scale=1.05, load=100.0, shear=1e9, bodies=None):
    """A contact of axis ratio a/b on n cells, its solver, and its semi-axes."""
    modulus = shear / (1.0 - nu)
    if bodies:
        modulus = 1.0 / sum((1.0 - m.poisson_ratio**2) / m.youngs_modulus for m in bodies)
    low, high = np.log(1e-3), np.log(1e3)  # of the ratio of the radii
    for _ in range(60):
        middle = 0.5 * (low + high)
        smooth = Hertz(modulus, 0.1, 0.1 * math.exp(middle))
        a, b = smooth.semi_axes(smooth.approach(load))
        low, high = (low, middle) if a < ratio * b else (middle, high)
    shape = n if isinstance(n, tuple) else (n, n)
    spacing = (2 * scale * a / shape[0], 2 * scale * b / shape[1])
    x, y = (places(m, d) for m, d in zip(shape, spacing, strict=True))
    gap = x[:, None] ** 2 / (2 * smooth.radius_x) + y**2 / (2 * smooth.radius_y)
    space = HalfSpace(shape, spacing, modulus)
    bodies = bodies or (body(shear, nu), body(shear, nu))
    return space.solve(gap, load=load), FrictionalHalfSpace(space, bodies, friction), a, b


@pytest.mark.parametrize("at", [(0.9e-3, 0.2e-3), (-2.2e-3, 1.1e-3), (0.0, -1.9e-3)])
def test_influence_is_that_of_a_quadrature(at):
    dx, dy, nu, (node, weight) = 1.0e-3, 0.6e-3, 0.3, np.polynomial.legendre.leggauss(24)
    x = at[0] - 0.5 * dx * node[:, None]
    y = at[1] - 0.5 * dy * node
    w, r = 0.25 * dx * dy * np.outer(weight, weight), np.hypot(x, y)
    expected = [np.sum(w * ((1 - nu) / r + nu * c / r**3)) for c in (x * x, y * y)]
    expected.append(np.sum(w * nu * x * y / r**3))
    point = [np.array(each) for each in at]
    assert traction_displacement(*point, dx, dy, nu) == pytest.approx(expected, rel=1e-5, abs=1e-14)
    tilted = pressure_displacement(*point, dx, dy)
    expected = [np.sum(w * x / r**2), np.sum(w * y / r**2)]
    assert [tilted.real, tilted.imag] == pytest.approx(expected, rel=1e-5, abs=1e-14)


def test_influence_in_the_loaded_square_is_its_closed_form():
    zero = np.zeros(())
    own = (1.0 - 0.15) * 4.0 * 2e-3 * math.asinh(1.0)
    assert traction_displacement(zero, zero, 2e-3, 2e-3, 0.3) == pytest.approx([own, own, 0.0], rel=1e-12)


def between_cells(solver, ahead):
    """From any cell to any other, or to places ahead of them, along and across, and their sides, m."""
    space = solver.half_space
    x, y = (d * np.arange(1 - n, n) for n, d in zip(space.shape, space.spacing, strict=True))
    return x[:, None] + ahead, y[None], *space.spacing


def displaced(solver, traction, ahead=0.0):
    """Displacement as a plain sum over cells, at the places of the grid or ahead."""
    nx, ny = solver.half_space.shape
    xx, yy, xy = traction_displacement(*between_cells(solver, ahead), solver.poisson_ratio)
    u = np.zeros((2, nx, ny))
    for i, j in np.argwhere(traction.any(axis=0)):
        part = np.s_[nx - 1 - i : 2 * nx - 1 - i, ny - 1 - j : 2 * ny - 1 - j]
        px, py = traction[:, i, j]
        u += np.array([xx[part] * px + xy[part] * py, xy[part] * px + yy[part] * py])
    return u / (math.pi * solver.shear_modulus)


def test_the_convolution_is_a_sum_over_cells():
    _, solver, *_ = ellipse(0.7, 0.3, (19, 26))
    traction = np.random.default_rng(1).normal(size=(2, 19, 26))
    for ahead in (0.0, 1.7 * solver.half_space.spacing[0]):
        found = solver.displacement(traction[0] + 1j * traction[1], np.zeros((19, 26)), ahead)
        assert np.array([found.real, found.imag]) == pytest.approx(
            displaced(solver, traction, ahead), rel=1e-11, abs=1e-20
        )


@pytest.mark.parametrize("load", [1e-19, 1e5])  # contacts of 0.3 nm and 30 mm
def test_neither_size_nor_precision_is_bound_by_the_single_precision_of_a_search(load):
    normal, solver, a, _ = ellipse(0.7, 0.3, (24, 20), load=load)
    creepage = 0.1 * normal.approach / a
    rolled = solver.roll(normal, (creepage, 0.0), 0.2 * creepage / a, rtol=1e-11)
    moved = solver.roll(normal, (1.2 * creepage, 0.0), before=rolled, rtol=1e-11)
    assert rolled.converged
    assert moved.converged
    assert 0.2 < -rolled.force[0] / rolled.limit < -moved.force[0] / moved.limit < 0.99


KALKER = {  # J. J. Kalker (1990), table E3: c11, c22, c23, printed with three digits
    (0.5, 0.25): (3.62, 3.01, 0.929),
    (1.0, 0.25): (4.12, 3.67, 1.47),
    (2.0, 0.25): (5.10, 4.90, 2.62),
    (1.0, 0.0): (3.40, 3.40, 1.33),
    (0.5, 0.5): (4.83, 3.14, 1.07),
}


@pytest.mark.parametrize(("shape", "printed"), KALKER.items())
def test_small_creepages_give_kalkers_coefficients(shape, printed):
    printing = 0.01 if shape[1] == 0.5 else 0.004
    assert kalker_coefficients(*shape) == pytest.approx(printed, rel=printing)


def test_a_ball_that_is_shifted_is_cattaneos_and_mindlins():
    """Exact without Poisson's ratio, where no traction arises across; the error falls with the grid."""
    errors = []
    for n in (16, 32, 64):
        contact, solver, a, _ = ellipse(1.0, 0.0, n)
        limit = 0.3 * contact.force
        found = solver.shift(contact, force=(-0.6 * limit, None))
        stick = a * 0.4 ** (1 / 3)
        shift = 3.0 * limit * 2.0 / (8.0 * 1e9 * a) * (1.0 - 0.4 ** (2 / 3))
        errors.append(found.creepage[0] / shift - 1.0)
        assert found.stick_area == pytest.approx(math.pi * stick**2, rel=5.0 / n)
        assert found.force == pytest.approx((-0.6 * limit, 0.0), abs=1e-5 * limit)
    assert abs(errors[2]) < min(2e-3, 0.4 * abs(errors[0]))


def test_a_load_that_turns_back_is_mindlins_and_deresiewiczs():
    contact, solver, a, _ = ellipse(1.0, 0.0, 48)
    limit = 0.3 * contact.force

    def virgin(share):
        return 6.0 * limit / (8.0 * 1e9 * a) * (1.0 - (1.0 - share) ** (2 / 3))

    state, place, work = None, 0.0, 0.0
    path = [(0.7, virgin(0.7)), (0.1, virgin(0.7) - 2 * virgin(0.3)), (-0.7, virgin(0.7) - 2 * virgin(0.7))]
    path += [(0.1, -virgin(0.7) + 2 * virgin(0.4)), (0.7, virgin(0.7))]
    tractions = []
    for share, expected in path:
        state = solver.shift(contact, force=(-share * limit, None), before=state)
        place += state.creepage[0]
        work += state.work if len(tractions) else 0.0
        tractions.append(state.traction)
        assert place == pytest.approx(expected, rel=4e-3, abs=4e-3 * virgin(0.7))
    assert tractions[-1] == pytest.approx(tractions[0], abs=2e-3 * np.abs(tractions[0]).max())
    share = np.linspace(0.0, 0.7, 4001)  # of the loop, twice the virgin curve about its corners
    area = 4.0 * limit * (0.7 * virgin(0.7) - 2.0 * np.trapezoid(virgin(share), share)) * -1.0
    assert work == pytest.approx(abs(area), rel=0.02)


@pytest.mark.parametrize("nu", [0.0, 0.3])
def test_a_long_roller_is_carters(nu):
    """Pressure of a cylinder, a = 1 mm, on one row of cells, a hundred times as long."""
    share, errors = 0.64, []
    for n in (33, 65):
        contact, solver, x = long_roller(n, nu)
        found = solver.roll(contact, (CREEPING * (1 - math.sqrt(1 - share)), 0.0))
        assert found.sticks.mean() * 1.05 == pytest.approx(0.6, abs=2.0 / n)
        assert found.sticks[np.argmax(x > 0.8e-3)]
        errors.append(-found.force[0] / found.limit / share - 1.0)
    assert abs(errors[1]) < min(0.01, 0.7 * abs(errors[0]))


CREEPING = 0.3 * 1e-3 / 0.25
"""Creepage at which a long roller slips all over, µ a/R."""


def long_roller(n, nu):
    """Its pressed contact, what solves for its tractions, and places along it (n, 1), m."""
    a, g, radius = 1e-3, 80e9, 0.25
    dx = 2.1 * a / n
    space, x = HalfSpace((n, 1), (dx, 200.0 * a), g / (1 - nu)), places(n, dx)[:, None]
    pressure = space.modulus * a / (2 * radius) * np.sqrt(np.maximum(1 - (x / a) ** 2, 0.0))
    contact = tangential.replace(space.solve(np.zeros(space.shape), load=1.0), pressure=pressure)
    return contact, FrictionalHalfSpace(space, (body(g, nu), body(g, nu)), 0.3), x


# --- Coulomb's law on rough and unlike contacts, in transients; friction that falls or differs by place


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


SOFT, HARD, UNIT = body(1e8, 0.1), body(1e10, 0.3), body(1e9, 0.3)


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


def test_a_punch_that_does_not_slip_is_mossakovskiis():
    """Stiffer than without friction by artanh(β)/β, that is ln 3 where it does not yield across at all."""
    errors = []
    for n in (16, 32):
        contact, solver, *_ = ellipse(1.0, 0.0, n, 40.0, bodies=(body(1e9, 0.0), body(1e15, 0.3)))
        x = places(n, 1.0 / (0.48 * n))
        gap = np.where(np.add.outer(x**2, x**2) < 1.0, 0.0, 1.0)
        flat = solver.half_space.solve(gap, load=contact.force)
        errors.append(flat.approach / solver.shift(flat).normal.approach / math.log(3.0) - 1.0)
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
    for creepage in ((0.2, 0.0), (0.0, -0.2)):
        with pytest.warns(OutOfRangeWarning, match=r"of 0\.2 is above 0\.05.*100 % of the contact slips"):
            solver.roll(contact, creepage)


def test_a_contact_pivots_where_its_slip_is_none():
    """At x = −η/φ and y = ξ/φ: told where that is inside of the contact, here off the middle of the grid."""
    middle, solver, a, _ = ellipse(1.0, 0.3, 32, scale=2.0)
    x0, y0 = (6 * d for d in solver.half_space.spacing)
    contact = solver.half_space.solve(np.roll(middle.undeformed_gap, (6, 6), (0, 1)), load=middle.force)
    assert math.hypot(x0, y0) > a
    with pytest.warns(OutOfRangeWarning, match="pivot on a place inside of it"):
        solver.shift(contact, (y0, -x0), 1.0)
    assert solver.shift(contact, (-y0, x0), 1.0).stick_area == 0.0  # as far off on the other side, untold
