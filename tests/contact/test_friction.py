"""Friction: influence by quadrature, printed curves and coefficients, closed forms, Coulomb's law itself."""

import math

import numpy as np
import pytest

from asperity import FrictionalHalfSpace, HalfSpace, Hertz, Material
from asperity.contact import tangential
from asperity.contact.creep import kalker_coefficients
from asperity.kernels.traction import pressure_displacement, traction_displacement


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


def displaced(solver, traction, ahead=0.0):
    """Displacement as a plain sum over cells, at the places of the grid or ahead."""
    space, (nx, ny) = solver.half_space, solver.half_space.shape
    x, y = (d * np.arange(1 - n, n) for n, d in zip(space.shape, space.spacing, strict=True))
    xx, yy, xy = traction_displacement(x[:, None] + ahead, y[None], *space.spacing, solver.poisson_ratio)
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
    """Pressure of a cylinder, a = 1 mm, on a strip ten times as long; the middle is plane."""
    a, share, g, errors = 1e-3, 0.64, 80e9, []
    for n in (33, 65):
        dx = 2.1 * a / n
        space = HalfSpace((n, 41), (dx, 0.5 * a), g / (1 - nu))
        radius = 0.25
        p0 = space.modulus * a / (2 * radius)
        x = places(n, dx)
        pressure = np.repeat(p0 * np.sqrt(np.maximum(1 - (x / a) ** 2, 0.0))[:, None], 41, axis=1)
        contact = tangential.replace(space.solve(np.zeros(space.shape), load=1.0), pressure=pressure)
        solver = FrictionalHalfSpace(space, (body(g, nu), body(g, nu)), 0.3)
        creepage = 0.3 * a / radius * (1 - math.sqrt(1 - share))
        found = solver.roll(contact, (creepage, 0.0))
        middle = found.traction[0, :, 20].sum() / found.bound[:, 20].sum()
        stick = found.sticks[:, 20].sum() * dx / (2 * a)
        assert stick == pytest.approx(0.6, abs=2.0 / n)
        assert found.sticks[np.argmax(x > 0.8 * a), 20]
        errors.append(-middle / share - 1.0)
    assert abs(errors[1]) < min(0.01, 0.7 * abs(errors[0]))
