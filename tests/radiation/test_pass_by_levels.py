"""Single numbers of a pass-by: time weighting F, the maximum, L_pAeq,Tp and TEL."""

import numpy as np
import pytest
from numpy.testing import assert_allclose

from asperity.errors import ComputationError, InputError
from asperity.radiation.pass_by import (
    FAST,
    AxleSource,
    Passage,
    Receiver,
    exposure,
    pass_by_levels,
    pressure_level,
    squared_pressure,
    time_weighted,
)
from asperity.radiation.track import IMPEDANCE

FLAT = Receiver(7.5, 0.0)


def test_time_weighting_of_a_step():
    """1 − exp(−t/τ) from the step on; 87 % after two time constants."""
    step = 1e-3
    time = step * np.arange(-100, 600)
    found = time_weighted((time > -step / 2).astype(float), step)
    after = time > step / 2
    # the ramp of one sample before the step: its middle lies half a sample before zero
    assert_allclose(found[after], 1.0 - np.exp(-(time[after] + step / 2) / FAST), atol=1e-5)
    assert (found[time < -1.5 * step] == 0.0).all()


def test_time_weighting_falls_by_34_7_dB_per_second():
    """IEC 61672-1: 34.7 dB/s with F, 10 lg(e)/0.125 s; and it keeps a steady level from its first sample."""
    step = 5e-3
    values = np.ones((2, 400))
    values[1, 100:] = 0.0
    found = time_weighted(values, step)
    assert_allclose(found[0], 1.0, rtol=1e-12)
    assert_allclose(np.diff(pressure_level(found[1, 110:])) / step, -34.7, atol=0.05)


def test_time_weighting_does_not_depend_on_the_step():
    time = np.linspace(-2.0, 2.0, 16_001)
    fine = time_weighted(1.0 / (1.0 + (time / 0.1) ** 2), time[1] - time[0])
    coarse = time_weighted((1.0 / (1.0 + (time / 0.1) ** 2))[::40], 40 * (time[1] - time[0]))
    assert_allclose(coarse, fine[::40], rtol=2e-3)


def test_levels_of_a_point_source_with_a_train_of_known_length():
    """p² = A/(d² + v² t²): over |t| < T/2 the integral is 2A/(dv) arctan(vT/2d)."""
    d, v, length = 7.5, 25.0, 30.0
    passage, source = Passage([0.0], v, length), AxleSource(np.array([1e-3]))
    time = passage.times(FLAT)
    found = pass_by_levels(time, squared_pressure(source, passage, FLAT, time), passage.passed)
    a = 1e-3 * IMPEDANCE / (2 * np.pi)
    duration, half = length / v, length / 2
    equivalent = 2 * a / (d * v) * np.arctan(half / d) / duration
    assert_allclose(found.equivalent, 10 * np.log10(equivalent / 4e-10), atol=1e-2)
    far = np.sqrt(10 * (d**2 + half**2) - d**2)  # a tenth of what it is when the front is opposite
    exposed = 2 * a / (d * v) * np.arctan(far / d) / duration
    assert_allclose(found.transit_exposure, 10 * np.log10(exposed / 4e-10), atol=1e-2)


@pytest.mark.parametrize("speed", [0.5, 20.0, 56.0, 100.0])
def test_the_maximum_is_that_of_the_weighted_pressure(speed):
    """Against quadrature of ∫ exp(−(t − u)/τ) p²(u) du/τ at its maximum; slowly, the level at rest."""

    def weighted(t):
        lags = np.linspace(0.0, 60.0 * FAST, 40_001)
        held = np.exp(-lags / FAST) / FAST / (7.5**2 + (speed * (t - lags)) ** 2)
        return np.trapezoid(held, lags)

    largest = max(weighted(t) for t in np.linspace(0.0, 2.0, 41) * min(7.5 / speed, FAST))
    passage = Passage([0.0], speed)
    time = passage.times(FLAT)
    pressure = squared_pressure(AxleSource(np.array([1e-3])), passage, FLAT, time)
    found = pass_by_levels(time, pressure, None).maximum[0]
    assert found == pytest.approx(pressure_level(1e-3 * IMPEDANCE / (2 * np.pi) * largest), abs=0.02)
    if speed == 0.5:
        assert found == pytest.approx(pressure_level(1e-3 * IMPEDANCE / (2 * np.pi * 7.5**2)), abs=0.01)


def test_a_long_train_has_the_level_of_its_line_of_axles():
    """L_pAeq,Tp, TEL and SEL − 10 lg Tp of W' = W/a: p² = W' ρc Q/(4 d)."""
    source, apart = AxleSource(np.array([1e-3]), 5.0), 6.0
    passage = Passage(apart * np.arange(400), 40.0)
    time = passage.times(FLAT, 5.0)
    found = pass_by_levels(time, squared_pressure(source, passage, FLAT, time), passage.passed)
    line = 10 * np.log10(1e-3 / apart * IMPEDANCE * 2 / (4 * 7.5) / 4e-10)
    duration = 400 * apart / 40.0
    assert pressure_level(exposure(source, passage, FLAT) / duration) == pytest.approx(line, abs=1e-9)
    # a finite line of length L, mean over its own length: (2/π) (arctan L/d − (d/2L) ln(1 + L²/d²))
    over = 400 * apart / 7.5
    ends = 2 / np.pi * (np.arctan(over) - np.log1p(over**2) / (2 * over))
    assert found.equivalent[0] == pytest.approx(line + 10 * np.log10(ends), abs=2e-3)
    assert found.transit_exposure[0] == pytest.approx(line, abs=0.05)
    assert found.equivalent[0] < found.transit_exposure[0] < line
    assert found.maximum[0] == pytest.approx(line, abs=0.3)


def test_sources_share_the_measured_time_and_add_up():
    passage = Passage([0.0, 2.5], 30.0)
    time = passage.times(FLAT, 20.0)
    parts = [squared_pressure(AxleSource(np.array([1e-3]), s), passage, FLAT, time)[0] for s in (0.0, 20.0)]
    found = pass_by_levels(time, [*parts, sum(parts)], passage.passed)
    for levels in (found.equivalent, found.transit_exposure):
        assert 10 * np.log10(np.sum(10 ** (levels[:2] / 10))) == pytest.approx(levels[2], abs=1e-9)
    assert found.maximum[2] < 10 * np.log10(np.sum(10 ** (found.maximum[:2] / 10))) + 1e-9


def test_without_a_length_there_is_a_maximum_only():
    time = np.linspace(-1.0, 1.0, 101)
    found = pass_by_levels(time, 1.0 / (1.0 + time[None] ** 2), None)
    assert np.isfinite(found.maximum).all()
    assert np.isnan(found.equivalent).all()
    assert np.isnan(found.transit_exposure).all()


def test_a_record_that_is_too_short_is_told():
    time = np.linspace(-1.0, 1.0, 101)
    with pytest.raises(
        ComputationError, match="does not fall by 10 dB before and after the train between -1 s"
    ):
        pass_by_levels(time, np.ones((1, 101)), (-0.5, 0.5))
    with pytest.raises(InputError, match="time step"):
        time_weighted([1.0, 2.0], 0.0)
