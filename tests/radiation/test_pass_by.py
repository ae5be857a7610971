"""Sound pressure beside the track, and single numbers of a pass-by, against closed forms.

Others stand in the ledger of conformance.
"""

import numpy as np
import pytest
from numpy.testing import assert_allclose

from asperity.errors import ComputationError
from asperity.radiation import pass_by
from asperity.radiation.pass_by import FAST, AxleSource, Passage, Receiver, divergence, squared_pressure
from asperity.radiation.track import IMPEDANCE

D = 7.5
HERE, FLAT = Receiver(), Receiver(D, 0.0)
WATT, MILLIWATT = np.array([1.0]), AxleSource(np.array([1e-3]))
ONE = Passage([0.0], 1.0)


def decibels(ratio):
    return 10 * np.log10(ratio)


def levels(source, passage):
    time = passage.times(FLAT, float(np.max(source.length)))
    return pass_by.pass_by_levels(time, squared_pressure(source, passage, FLAT, time), passage.passed)


def test_a_hub_is_as_far_as_its_height_makes_it():
    # d² = 7.5² + 0.74² from 0.46 m to 1.2 m
    found = squared_pressure(AxleSource(WATT, height=0.46), ONE, HERE, [0.0])[0, 0]
    assert_allclose(found, IMPEDANCE / (2 * np.pi * (56.25 + 0.5476)), rtol=1e-9)


def test_limits_of_the_spread():
    # continuous where its series takes over: 2 |s − id|/ℓ passes 40
    second = np.diff(divergence(3.0, D, np.linspace(50.0, 70.0, 4001)), n=2)
    assert_allclose(second[0], 6.0 * 0.005**2 / 50.0**4, rtol=0.1)  # of about 1/s²
    assert np.abs(np.diff(second)).max() < 1e-13
    along = np.linspace(-30.0, 30.0, 7)
    assert_allclose(divergence(1e-3, D, along), divergence(0.0, D, along), rtol=1e-6)
    assert_allclose(divergence(1e6, D, 0.0), np.pi / D / 1e6, rtol=2e-4)  # W/ℓ per length near the middle


@pytest.mark.parametrize("length", [0.0, 10.0, 40.0])
def test_exposure_does_not_depend_on_the_spread(length):
    """∫ W ρc Q/(4π (d² + v² t²)) dt = W ρc Q/(4 d v), and a spread only delays parts of it."""
    source, closed = AxleSource(WATT, length), 1.0 * IMPEDANCE * 2.0 / (4.0 * D * 20.0)
    for axles, speed, distance, share in (([0.0], 20.0, D, 1.0), ([0.0, 2.5], 40.0, 2 * D, 0.5)):
        found = pass_by.exposure(source, Passage(axles, speed), Receiver(distance, 0.0))
        assert_allclose(found, share * closed, rtol=1e-12)
    half = 4000.0  # m: arctan leaves 2/π d/half beyond it
    time = np.linspace(-half, half, 400_001) / 20.0
    integral = np.trapezoid(squared_pressure(source, Passage([0.0], 20.0), FLAT, time)[0], time)
    assert_allclose(integral, closed * (1.0 - 2.0 / np.pi * D / half), rtol=2e-5)


def test_axles_pass_one_after_the_other_the_same_before_and_after():
    source, time = AxleSource(np.array([1.0, 2.0]), np.array([0.0, 6.0])), np.linspace(-1.0, 2.0, 601)
    both = squared_pressure(source, Passage([0.0, 20.0], 40.0), HERE, time)
    first, second = (squared_pressure(source, Passage([0.0], 40.0), HERE, time - lag) for lag in (0.0, 0.5))
    assert_allclose(both, first + second, rtol=1e-4)
    for passed, lag in ((first, 0.0), (second, 0.5)):
        assert time[passed.argmax(axis=1)] == pytest.approx(lag, abs=0.006)
    assert_allclose(first[:, :401], first[:, 400::-1], rtol=1e-6)


def test_front_and_rear():
    assert Passage([0.0], 10.0).passed is None
    assert_allclose(Passage([0.0, 2.0, 4.0], 10.0).passed, (-0.1, 0.5))  # as long as 3 axles 2 m apart
    assert_allclose(Passage([0.0, 2.0], 10.0, length=20.0).passed, (-0.9, 1.1))
    assert_allclose(Passage([0.0], 10.0, length=20.0).passed, (-1.0, 1.0))


@pytest.mark.parametrize("length", [0.0, 3.0, 40.0])
@pytest.mark.parametrize("passage", [ONE, Passage([0.0, 2.5, 19.0, 21.5], 20.0, 26.4)])
def test_the_record_holds_the_whole_rise_and_fall(passage, length):
    time = passage.times(HERE, length)
    found = squared_pressure(AxleSource(WATT, length), passage, HERE, time)[0]
    assert max(found[0], found[-1]) < 0.1 * np.interp((passage.passed or (0.0, 0.0))[0], time, found)
    assert_allclose(np.diff(time), time[1] - time[0])


def test_time_weighting_of_steps():
    """1 − exp(−t/τ) from the step on."""
    step = 1e-3
    time = step * np.arange(-100, 600)
    found = pass_by.time_weighted((time > -step / 2).astype(float), step)
    after = time > -step / 2
    # the ramp of one sample before the step: its middle lies half a sample before zero
    assert_allclose(found[after], 1.0 - np.exp(-(time[after] + step / 2) / FAST), atol=1e-5)
    assert (found[time < -1.5 * step] == 0.0).all()
    assert_allclose(pass_by.time_weighted(np.ones((2, 9)), step), 1.0, rtol=1e-12)


def test_levels_of_a_point_source_with_a_train_of_known_length():
    """p² = A/(d² + v² t²): over |t| < T/2 the integral is 2A/(dv) arctan(vT/2d)."""
    v, length = 25.0, 30.0
    found = levels(MILLIWATT, Passage([0.0], v, length))
    a, duration, half = 1e-3 * IMPEDANCE / (2 * np.pi), length / v, length / 2
    far = np.sqrt(10 * (D**2 + half**2) - D**2)  # a tenth of what it is when the front is opposite
    for level, reach in ((found.equivalent, half), (found.transit_exposure, far)):
        mean = 2 * a / (D * v) * np.arctan(reach / D) / duration
        assert_allclose(level, decibels(mean / 4e-10), atol=1e-2)


@pytest.mark.parametrize("speed", [0.5, 20.0, 100.0])
def test_the_maximum_is_that_of_the_weighted_pressure(speed):
    """Against quadrature of ∫ exp(−(t − u)/τ) p²(u) du/τ at its maximum."""
    lags = np.linspace(0.0, 60.0 * FAST, 40_001)
    t = np.linspace(0.0, 2.0, 41)[:, None] * min(D / speed, FAST)
    weighted = np.exp(-lags / FAST) / FAST / (D**2 + (speed * (t - lags)) ** 2)
    largest = 1e-3 * IMPEDANCE / (2 * np.pi) * np.trapezoid(weighted, lags).max()
    found = levels(MILLIWATT, Passage([0.0], speed)).maximum[0]
    assert found == pytest.approx(pass_by.pressure_level(largest), abs=0.02)


TIME = np.linspace(-1.0, 1.0, 101)


def test_sources_share_the_measured_time_and_add_up():
    passage = Passage([0.0, 2.5], 30.0)
    time = passage.times(FLAT, 20.0)
    parts = [squared_pressure(AxleSource(np.array([1e-3]), s), passage, FLAT, time)[0] for s in (0.0, 20.0)]
    found = pass_by.pass_by_levels(time, [*parts, sum(parts)], passage.passed)
    for one in (found.equivalent, found.transit_exposure):
        assert decibels(np.sum(10 ** (one[:2] / 10))) == pytest.approx(one[2], abs=1e-9)
    without = pass_by.pass_by_levels(TIME, 1.0 / (1.0 + TIME[None] ** 2), None)
    assert np.isfinite(without.maximum).all()
    assert np.isnan([without.equivalent, without.transit_exposure]).all()


def test_a_level_that_does_not_fall_is_refused():
    message = "does not fall by 10 dB before and after the train between -1"
    with pytest.raises(ComputationError, match=message):
        pass_by.pass_by_levels(TIME, np.ones((1, 101)), (-0.5, 0.5))
