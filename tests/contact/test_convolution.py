"""What lies beneath the contact solver: transforms, and pressures to start from."""

import numpy as np
import pytest

from asperity.kernels.fourier import factors, roots, smooth_length, transform
from asperity.kernels.lanes import width
from asperity.kernels.scanning import continue_pressure, correct_start, misfits

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
