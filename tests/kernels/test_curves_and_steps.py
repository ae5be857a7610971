"""Splines, cubic pieces, steps of modes and transforms, against other programs; pressures to start from."""

import ast
from pathlib import Path

import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy.interpolate import CubicSpline, PchipInterpolator
from scipy.linalg import expm

from asperity import HalfSpace
from asperity.kernels import stepping
from asperity.kernels.curves import monotone_slopes, shape_preserving, splines_along
from asperity.kernels.fourier import factors, roots, smooth_length, transform
from asperity.kernels.influence import (
    Convolution,
    convolve,
    influence_table,
    prepared,
    quarter_turn,
    spectrum,
)
from asperity.kernels.lanes import width
from asperity.kernels.scanning import continue_pressure, correct_start, misfits, room
from asperity.kernels.stepping import refine
from asperity.rolling.steps import modal_coefficients


@pytest.mark.parametrize("points", [2, 30, 2000])
def test_splines_are_natural_in_blocks_at_places_in_any_order(points):
    random = np.random.default_rng(3)
    values, index = random.normal(size=(3, points)), random.uniform(0.0, points - 1.0, 500)
    index[:2] = 0.0, points - 1.0
    expected = CubicSpline(np.arange(points), values.T, bc_type="natural")
    for places in (index, np.sort(index), np.sort(index)[::-1]):
        np.testing.assert_allclose(splines_along(values, places), expected(places), atol=1e-12)


@pytest.mark.parametrize("count", [3, 4, 10, 60])
def test_pieces_of_any_shape_are_those_of_scipy(count):
    rng = np.random.default_rng(count)
    knots, rows = np.sort(rng.normal(size=count)), rng.normal(size=(6, count))
    rows[0].sort()
    rows[1], rows[2, :], rows[3, 1] = -rows[0], 1.0, rows[3, 0]
    places = np.concatenate([knots, rng.uniform(knots[0], knots[-1], 500)])
    expected = PchipInterpolator(knots, rows, axis=1)(places)
    np.testing.assert_allclose(shape_preserving(knots, rows, places), expected, atol=1e-13)


H = 2e-3


def coefficients(omega, zeta):
    """Displacement and velocity (2) from displacement, velocity, and force at both ends (4)."""
    return modal_coefficients(np.array([omega]), np.array([zeta]), H).reshape(2, 4)


@pytest.mark.parametrize("zeta", [0.0, 0.0025, 0.3, 1.0, 1.7])
@pytest.mark.parametrize("phase", [2e-6, 0.06, 1.4, 10.0])
def test_the_step_is_the_exponential_of_an_oscillator_under_a_linear_force(phase, zeta):
    generator = np.zeros((4, 4))  # in times of the step: displacement, velocity, force and its rise
    generator[0, 1] = generator[1, 2] = generator[2, 3] = 1.0
    generator[1, :2] = -(phase**2), -2.0 * zeta * phase
    exact = expm(generator)[:2] * [[1.0], [1.0 / H]]
    q, v, force, rise = exact.T * np.array([[1.0], [H], [H**2], [H**2]])
    found = coefficients(phase / H, zeta)
    assert_allclose(found, np.transpose([q, v, force - rise, rise]), rtol=1e-9, atol=1e-13)


@pytest.mark.parametrize("phase", [0.0, 1e-9, 1e-4, 0.3, 3.0, 40.0, 400.0])
def test_the_undamped_step_rotates_and_follows_a_ramp(phase):
    """From rest q = (t − sin(ωt)/ω)/ω² per unit slope of the force; a free mode moves as a mass."""
    omega, found = phase / H, coefficients(phase / H, 0.0)
    sine = np.sinc(phase / np.pi)
    rotation = [[np.cos(phase), H * sine], [-omega * np.sin(phase), np.cos(phase)]]
    scale = np.array([[1.0, H], [max(omega, 1.0 / H), 1.0]])
    assert_allclose(found[:, :2] / scale, np.array(rotation) / scale, atol=1e-12)
    if phase < 1e-3:
        assert_allclose(found[:, 2:], [[H**2 / 3, H**2 / 6], [H / 2, H / 2]], rtol=1e-8)
    else:
        assert_allclose(found[0, 3], (1.0 - sine) / omega**2, rtol=1e-8)
        assert_allclose(found[1, 3], (1.0 - np.cos(phase)) / omega**2 / H, rtol=1e-8)


@pytest.mark.parametrize(("zero", "found"), [(1.0, 1.0), (3.0, 2.0)])
def test_refine_brackets_and_bisects_a_kinked_function(zero, found):
    """It jumps at two: beside its zero, or across zero."""
    low, high, x = -np.inf, np.inf, 5.0
    for iteration in range(120):
        low, high, x = refine(low, high, x, x - zero + (10.0 if x > 2.0 else 0.0), 1.0, iteration)
    assert_allclose(x, found, rtol=1e-12)


PRECISIONS = {np.float64: 1e-14, np.float32: 1e-6}


@pytest.mark.parametrize("dtype", PRECISIONS)
@pytest.mark.parametrize("n", [4, 8, 12, 20, 60, 128, 270])
def test_transform_is_the_discrete_fourier_transform_of_every_column(n, dtype):
    rng, lanes = np.random.default_rng(n), width(dtype)
    z = rng.standard_normal((n, lanes)) + 1j * rng.standard_normal((n, lanes))
    x = np.stack([z.real, z.imag], axis=1).ravel().astype(dtype)
    y = np.empty_like(x)
    swapped = transform(x, y, np.array(factors(n)), roots(n).astype(dtype))
    result = (y if swapped else x).reshape(n, 2, lanes)
    expected = np.fft.fft(z, axis=0)
    error = np.abs(result[:, 0] + 1j * result[:, 1] - expected).max()
    assert error < PRECISIONS[dtype] * np.abs(expected).max()


@pytest.mark.parametrize("dtype", PRECISIONS)
@pytest.mark.parametrize("summed", [False, True])
@pytest.mark.parametrize("shape", [(1, 1), (5, 2), (7, 5), (16, 16), (19, 33), (40, 95)])
def test_a_convolution_is_a_sum_over_cells_however_it_is_taken_across(shape, summed, dtype):
    count, (nx, ny) = width(dtype), shape
    mx, my = (smooth_length(n) for n in shape)
    pitch = count * -(-ny // count)
    table = influence_table(mx, my, 1.0, 1.5)
    parts = roots(mx), roots(my), quarter_turn(mx), quarter_turn(my)
    parts = [*parts, spectrum(table, mx, my, count, summed=summed)]
    radices = np.array(factors(mx)), np.array([] if summed else factors(my), dtype=np.int64)
    plan = Convolution(*radices, *(each.astype(dtype) for each in parts))
    field, found = np.zeros((2, nx, pitch), dtype=dtype)
    field[:, :ny] = np.random.default_rng(1).normal(size=shape)
    work = np.full(8 * count * (mx + count) * (my + count), np.nan, dtype=dtype)
    convolve(plan, field.ravel(), nx, ny, pitch, work, found.ravel())
    i, j = (np.abs(np.subtract.outer(np.arange(n), np.arange(n))) for n in shape)
    expected = np.einsum("ikjl,kl->ij", table[i[:, :, None, None], j], field[:, :ny].astype(np.float64))
    assert_allclose(found[:, :ny], expected, atol=PRECISIONS[dtype] * np.abs(expected).max(), rtol=0.0)


@pytest.mark.parametrize("shape", [(6, 6), (17, 33), (40, 25)])
def test_vectors_of_a_convolution_lie_on_whole_lines_of_the_cache(shape):
    known = HalfSpace(shape, 1e-5, 1e11).influence
    for n in (8, 16, 24):
        known = prepared(known, n, n)
        assert known.spectra.ctypes.data % 64 == 0
    rooms = [getattr(room(known, *shape), name) for name in ("outer", "inner") for _ in range(8)]
    assert {each.ctypes.data % 64 for each in rooms} == {0}


def test_lengths_are_the_smallest_that_transform_fast():
    lengths = [smooth_length(n) for n in range(1, 400)]
    fast = [n for n in range(8, 500, 8) if factors(n)[-1] <= 5]
    assert lengths == [next(m for m in fast if m >= n) for n in range(1, 400)]
    assert all(int(np.prod(factors(n))) == n for n in range(1, 400))


def test_starts_go_on_straight_at_points_of_the_surface_within_bounds():
    surface = np.arange(30.0)[:, None] * np.ones((1, 4))

    def at(first, time):
        """Pressure on ten rows of the surface, straight in time."""
        return np.ascontiguousarray(surface[first : first + 10] * time)

    def continued(*given):
        start = np.full((10, 4), np.nan)
        continue_pressure(*given, start)
        return start

    moved = continued(at(2, 2.0), at(0, 1.0), 2, 1.0, np.inf)
    assert np.allclose(moved[:6], at(4, 3.0)[:6])
    assert np.allclose(moved[6:8], at(4, 2.0)[6:8])  # these rows were not in the window before
    assert not moved[8:].any()
    assert np.allclose(continued(at(0, 2.0), at(0, 1.0), 0, 0.5, np.inf), at(0, 2.5))
    assert continued(at(0, 2.0), at(0, 1.0), 0, 1.0, 10.0).max() == 10.0
    assert not continued(at(0, 1.0), at(0, 3.0), 0, 1.0, np.inf).any()


def test_starts_are_corrected_by_what_was_wrong_before():
    wrong, start = np.array([[1.0, -2.0, -9.0, 50.0]]), np.empty((1, 4))
    correct_start(np.full((1, 4), 5.0), np.full((1, 4), 3.0), 3.0 + wrong, 10.0, start)
    assert start.tolist() == [[6.0, 3.0, 0.0, 10.0]]
    found, last, before = np.full((2, 3), 5.0), np.full((2, 3), 3.0), np.full((2, 3), 2.0)
    assert misfits(found, last, last, before, 2.0) == (24.0, 0.0)
    assert misfits(found, found, before, last, 4.0) == (0.0, 150.0)  # a line ends where pressure does


def test_kernels_call_others_with_arguments_one_by_one():
    """Beside a tuple that is unpacked numba hands functions on by address, and says so at a first run."""
    unpacking = [
        f"{source.name}: {ast.unparse(each)}"
        for source in Path(stepping.__file__).parent.glob("*.py")
        for function in ast.parse(source.read_text(encoding="utf-8")).body
        if isinstance(function, ast.FunctionDef)
        and any(ast.unparse(each).startswith("compiled(") for each in function.decorator_list)
        for each in ast.walk(function)
        if isinstance(each, ast.Call) and any(isinstance(given, ast.Starred) for given in each.args)
    ]
    assert not unpacking


def test_slopes_at_the_ends_are_those_of_a_parabola_between_half_and_twice_the_secant():
    knots = np.array([1.0, 1.3, 1.9, 2.2])
    slopes = monotone_slopes(knots, np.array([knots**2, 0.0 * knots]))
    np.testing.assert_allclose(slopes[0, [0, -1]], 2.0 * knots[[0, -1]], rtol=1e-12)
    held = monotone_slopes(np.arange(3.0), np.array([[0.0, 1.0, 9.0], [0.0, 8.0, 8.0]]))
    assert held[0, 0] == 0.5  # of a secant of 1, where the parabola falls
    assert held[1, 2] == 0.0  # of one of 0
    assert held[0, 2] == pytest.approx(11.5)
    np.testing.assert_array_equal(slopes[1], 0.0)
