"""Transforms, convolutions and boxes beneath the contact solver, against sums and numpy."""

import numpy as np
import pytest

from asperity.kernels.box import empty_box
from asperity.kernels.contact import room
from asperity.kernels.continuation import continue_pressure, correct_start, misfits
from asperity.kernels.convolution import convolve
from asperity.kernels.fourier import factors, roots, smooth_length, transform
from asperity.kernels.influence import convolution, influence, is_prepared, prepared
from asperity.kernels.lanes import width
from asperity.kernels.options import compiled
from asperity.kernels.overlap import overlap_box

PRECISIONS = {np.float64: 1e-14, np.float32: 1e-6}


@pytest.mark.parametrize("dtype", PRECISIONS)
@pytest.mark.parametrize("n", [4, 8, 12, 20, 36, 60, 100, 128, 270])
def test_transform_is_the_discrete_fourier_transform_of_every_column(n: int, dtype: type) -> None:
    rng, lanes = np.random.default_rng(n), width(dtype)
    z = rng.standard_normal((n, lanes)) + 1j * rng.standard_normal((n, lanes))
    x = np.stack([z.real, z.imag], axis=1).ravel().astype(dtype)
    y = np.empty_like(x)
    swapped = transform(x, y, np.array(factors(n)), roots(n).astype(dtype))
    result = (y if swapped else x).reshape(n, 2, lanes)
    expected = np.fft.fft(z, axis=0)
    error = np.abs(result[:, 0] + 1j * result[:, 1] - expected).max()
    assert error < PRECISIONS[dtype] * np.abs(expected).max()


def test_lengths_are_the_smallest_that_transform_fast() -> None:
    lengths = [smooth_length(n) for n in range(1, 400)]
    fast = [n for n in range(8, 500, 8) if factors(n)[-1] <= 5]
    assert lengths == [next(m for m in fast if m >= n) for n in range(1, 400)]
    assert all(int(np.prod(factors(n))) == n for n in range(1, 400))
    assert factors(44)[-1] == 11
    assert factors(1) == [1]


@compiled(_nrt=False)
def convolved(known, field, room, out):
    """Displacement under a pressure on a box."""
    nx, ny = field.shape
    b = empty_box(nx, ny, room.outer)
    for i in range(nx):
        for j in range(ny):
            b.pressure[i * b.pitch + j] = field[i, j]
    convolve(convolution(known, nx, ny), b.pressure, nx, ny, b.pitch, b.work, b.response)
    for i in range(nx):
        for j in range(ny):
            out[i, j] = b.response[i * b.pitch + j]


@pytest.mark.parametrize("dtype", PRECISIONS)
@pytest.mark.parametrize(("nx", "ny"), [(1, 1), (3, 17), (16, 16), (17, 5), (30, 41)])
def test_convolution_is_the_sum_over_cells_in_the_box(nx: int, ny: int, dtype: type) -> None:
    rng = np.random.default_rng(nx + 100 * ny)
    mx, my = smooth_length(nx), smooth_length(ny)
    table, field = rng.standard_normal((mx, my)), rng.standard_normal((nx, ny))
    i, j = np.arange(nx), np.arange(ny)
    rows, columns = np.abs(i[:, None] - i), np.abs(j[:, None] - j)
    expected = np.einsum("ikjl,kl->ij", table[rows[:, :, None, None], columns], field)
    known = prepared(prepared(influence(table, np.zeros(6), dtype), 1, 1), nx, ny)
    assert is_prepared(known, mx, my)
    assert is_prepared(known, 1, 1)
    assert is_prepared(known, mx, 1) == (8 in (mx, my))
    own, out = room(known, nx, ny), np.full((nx, ny), np.nan)
    own.outer[:] = np.nan
    for _ in range(2):  # the second time in used room
        convolved(known, field, own, out)
        assert np.abs(out - expected).max() < 10 * PRECISIONS[dtype] * np.abs(expected).max()


def test_boxes_hold_what_they_should_and_no_more() -> None:
    gap, lowest = np.ones((9, 7)), np.empty(7)
    assert overlap_box(gap, 0.5, lowest) == (-0.5, 0, 0, 0, 0)
    gap[2, 5], gap[6, 1] = 0.25, 0.0
    assert overlap_box(gap, 0.5, lowest) == (0.5, 2, 7, 1, 6)
    assert overlap_box(gap, 0.25, lowest) == (0.25, 6, 7, 1, 2)
    assert overlap_box(gap, 2.0, lowest) == (2.0, 0, 9, 0, 7)


def test_continuation_is_straight_at_points_of_the_surface_and_stays_within_bounds() -> None:
    surface = np.arange(30.0)[:, None] * np.ones((1, 4))

    def at(first: int, time: float) -> np.ndarray:
        """Pressure on ten rows of the surface, straight in time."""
        return np.ascontiguousarray(surface[first : first + 10] * time)

    def continued(*given) -> np.ndarray:
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


def test_start_is_corrected_by_what_was_wrong_before() -> None:
    rng = np.random.default_rng(5)
    surface, wrong = 1.0 + rng.random((6, 4)), 0.1 * rng.standard_normal((6, 4))
    start = np.full((6, 4), np.nan)
    correct_start(surface, 0.5 * surface, 0.5 * surface + wrong, 10.0, start)
    assert np.allclose(start, surface + wrong)
    correct_start(surface, surface, surface - 100.0, 10.0, start)
    assert not start.any()
    correct_start(surface, surface, surface + 100.0, 10.0, start)
    assert np.array_equal(start, np.full((6, 4), 10.0))


def test_misfits_are_sums_of_squares() -> None:
    found, last, before = np.full((2, 3), 5.0), np.full((2, 3), 3.0), np.full((2, 3), 2.0)
    assert misfits(found, last, last, before, 2.0) == (24.0, 0.0)
    assert misfits(found, found, before, last, 4.0) == (0.0, 150.0)  # a line ends where pressure does
