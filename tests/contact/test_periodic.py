"""One period of a surface without end: each wave, images, mean planes, full contact, hardness, refusals."""

import math

import numpy as np
import pytest

from asperity import FrictionalHalfSpace, HalfSpace, material
from refusals import refusals

MODULUS = 1e11


def rough(shape=(30, 21), hardness=None):
    """A rough periodic gap with a mean of zero, and its half-space of oblong cells."""
    noise = np.fft.rfft2(np.random.default_rng(3).standard_normal(shape))
    k = np.hypot(np.fft.fftfreq(shape[0])[:, None], np.fft.rfftfreq(shape[1]))
    k[0, 0] = np.inf
    gap = 1e-8 * np.fft.irfft2(noise * k**-1.8, s=shape)
    return gap, HalfSpace(shape, (4e-6, 5e-6), MODULUS, hardness, boundary="periodic")


def mean_load(half_space, pressure):
    return pressure * half_space.shape[0] * half_space.shape[1] * half_space.cell_area


@pytest.mark.parametrize("shape", [(30, 21), (37, 8), (33, 1)])
def test_every_wave_of_pressure_is_answered_by_its_own(shape):
    """û = 2 p̂/(E* abs(k)), up to the shortest wave, and the mean plane stays."""
    (nx, ny), spacing = shape, (4e-6, 5e-6)
    half_space = HalfSpace(shape, spacing, MODULUS, boundary="periodic")
    for m, n in ((1, 0), (nx // 2, 0), (3, ny // 2), (-2, ny // 3)):
        phase = np.add.outer(2 * np.pi * m * np.arange(nx) / nx, 2 * np.pi * n * np.arange(ny) / ny)
        wave = np.cos(phase)
        k = 2 * np.pi * math.hypot(m / (nx * spacing[0]), n / (ny * spacing[1]))
        expected = 2e6 / (MODULUS * k) * wave
        np.testing.assert_allclose(half_space.displacement(1e6 * wave + 5e6), expected, atol=1e-12 * 1e-6)


@pytest.mark.parametrize("pressure", [1e6, 30e6, 300e6, 5e9])
def test_solutions_are_complementary_and_meet_load_and_tolerance(pressure):
    gap, half_space = rough()
    contact = half_space.solve(gap, load=mean_load(half_space, pressure), rtol=1e-8)
    overlap = contact.approach - gap.min()
    assert contact.force == pytest.approx(mean_load(half_space, pressure), rel=1e-12)
    assert contact.converged
    assert contact.residual <= 1e-8
    assert contact.gap.min() >= -1e-8 * overlap
    assert np.abs(contact.gap[contact.pressure > 0]).max() <= 1e-8 * overlap
    assert contact.gap.mean() == pytest.approx(gap.mean() - contact.approach, abs=1e-12 * overlap)
    assert contact.edge_share == 0.0


def test_a_contact_does_not_care_where_the_period_begins():
    gap, half_space = rough()
    contact = half_space.solve(gap, load=mean_load(half_space, 50e6), rtol=1e-10)
    moved = half_space.solve(np.roll(gap, (11, -7), (0, 1)), load=contact.force, rtol=1e-10)
    back = np.roll(moved.pressure, (-11, 7), (0, 1))
    np.testing.assert_allclose(back, contact.pressure, atol=1e-7 * contact.pressure.max())
    twice = HalfSpace((60, 21), half_space.spacing, MODULUS, boundary="periodic")
    both = twice.solve(np.tile(gap, (2, 1)), load=2 * contact.force, rtol=1e-10)
    np.testing.assert_allclose(both.pressure[30:], contact.pressure, atol=1e-7 * contact.pressure.max())
    assert both.approach == pytest.approx(contact.approach, rel=1e-9)


@pytest.mark.parametrize("hardness", [None, 0.9e9])
@pytest.mark.parametrize("pressure", [1e6, 100e6, 500e6])
def test_the_approach_under_a_load_gives_the_load_again(pressure, hardness):
    gap, half_space = rough(hardness=hardness)
    under_load = half_space.solve(gap, load=mean_load(half_space, pressure), rtol=1e-9)
    again = half_space.solve(gap, approach=under_load.approach, rtol=1e-9)
    assert again.converged
    assert again.residual <= 1e-9
    assert again.approach == under_load.approach
    assert again.force == pytest.approx(under_load.force, rel=1e-5)
    assert half_space.solve(gap, approach=gap.min() - 1e-9).force == 0.0


def test_the_tangent_is_the_central_difference_and_infinite_in_full_contact():
    gap, half_space = rough()
    contact = half_space.solve(gap, load=mean_load(half_space, 80e6), rtol=1e-12)
    step = 1e-5 * contact.force
    plus, minus = (half_space.solve(gap, load=contact.force + s, rtol=1e-13) for s in (step, -step))
    assert np.array_equal(plus.pressure > 0, minus.pressure > 0)
    assert contact.stiffness == pytest.approx(2 * step / (plus.approach - minus.approach), rel=1e-6)
    full = half_space.solve(gap, load=mean_load(half_space, 10e9))
    assert full.area == full.real_area == pytest.approx(mean_load(half_space, 1.0))  # no cell is at a rim
    assert full.approach == pytest.approx(gap.mean(), abs=1e-6 * np.ptp(gap))
    assert full.stiffness == math.inf


def test_full_contact_has_the_pressure_that_flattens_each_wave():
    gap, half_space = rough()
    full = half_space.solve(gap, load=mean_load(half_space, 10e9), rtol=1e-10)
    flattened = half_space.displacement(full.pressure)
    np.testing.assert_allclose(flattened, gap.mean() - gap, atol=1e-9 * np.ptp(gap))


def test_a_small_contact_on_a_large_period_is_the_one_on_a_half_space():
    """Images press back like a plane: at equal load they change a pressure by (a/λ)³ of it."""
    x = 5e-6 * (np.arange(96) - 48)
    ball = np.add.outer(x**2, x**2) / (2 * 10e-3)
    periodic, free = (HalfSpace(ball.shape, 5e-6, MODULUS, boundary=b) for b in ("periodic", "free"))
    one, other = periodic.solve(ball, load=0.5), free.solve(ball, load=0.5)
    assert np.abs(one.pressure - other.pressure).max() < 0.03 * other.pressure.max()
    assert one.pressure.max() == pytest.approx(other.pressure.max(), rel=3e-3)


def test_errors_against_westergaard_fall_at_the_expected_order():
    """Pressure ends like a square root: order 3/2 for the approach, wherever the edge cuts the cells."""
    length, amplitude, cells = 1e-3, 1e-7, (16, 32, 64, 128, 256)
    full = np.pi * MODULUS * amplitude / length
    errors = []
    for n in cells:
        half_space, found = HalfSpace((n, 1), length / n, MODULUS, boundary="periodic"), []
        for share in (0.1, 0.37, 0.5, 0.8):
            for offset in np.linspace(0.0, 0.5, 5):
                x = (np.arange(n) + offset) * length / n
                gap = amplitude * (1 - np.cos(2 * np.pi * x[:, None] / length))
                approach = half_space.solve(gap, load=mean_load(half_space, share * full)).approach
                found.append(approach / amplitude - share * (1 - np.log(share)))
        errors.append(np.sqrt(np.mean(np.square(found))))
    assert -np.polyfit(np.log(cells), np.log(errors), 1)[0] > 1.5
    assert errors[-1] < 1e-4


def test_hardness_caps_the_pressure_and_lets_mean_planes_pass():
    gap, half_space = rough(hardness=0.5e9)
    contact = half_space.solve(gap, load=mean_load(half_space, 0.45e9))
    assert contact.converged
    assert contact.pressure.max() == 0.5e9
    assert contact.approach > gap.mean()
    assert contact.plastic_indentation.max() > 0.0
    assert half_space.solve(gap, approach=contact.approach).force == pytest.approx(contact.force, rel=1e-5)
    flat = half_space.solve(gap, approach=gap.max() + 1e-9)
    assert flat.force == pytest.approx(mean_load(half_space, 0.5e9))


@pytest.mark.parametrize("shape", [(8, 6), (1, 1)])
def test_planes_touch_everywhere_at_once(shape):
    half_space = HalfSpace(shape, 1e-5, MODULUS, boundary="periodic")
    contact = half_space.solve(np.full(shape, 2e-6), load=1e-3)
    np.testing.assert_allclose(contact.pressure, 1e-3 / (1e-10 * math.prod(shape)))
    assert (contact.approach, contact.stiffness) == (2e-6, math.inf)
    assert contact.converged


STEEL = material("steel")
PERIOD = HalfSpace((8, 8), 1e-5, 0.5 * 210e9 / (1 - 0.3**2), 1e9, boundary="periodic")
WAVE = np.repeat(1e-8 * np.cos(2 * np.pi * np.arange(8) / 8)[:, None], 8, axis=1)

test_messages = refusals(
    (lambda: HalfSpace((8, 8), 1e-5, 1e11, boundary="cyclic"), "boundary: .*cyclic.*'free' or 'periodic'"),
    (lambda: HalfSpace((8, 8), 1e-5, 1e11, boundary=True), "boundary: .*True.*'free' or 'periodic'"),
    (
        lambda: HalfSpace((8, 8), 1e-5, 1e11, cells="covered", boundary="periodic"),
        "cells of a periodic half-space: received 'covered'; allowed: 'whole'",
    ),
    (
        lambda: HalfSpace((8, 8), 1e-5, 1e11, boundary="periodic").solve(WAVE, approach=2e-9),
        "approach of a periodic contact",
    ),
    (lambda: PERIOD.scan(np.zeros((9, 8)), WAVE, [1e-9]), "boundary of the half-space of the scan"),
    (lambda: PERIOD.run_in(np.zeros((9, 8)), WAVE, 1e-3), "boundary of the half-space of running-in"),
    (
        lambda: FrictionalHalfSpace(PERIOD, (STEEL, STEEL), 0.3),
        "boundary of the half-space of a contact with friction",
    ),
)  # fmt: skip
