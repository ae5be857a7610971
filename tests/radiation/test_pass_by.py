"""Sound pressure beside the track: closed forms of what passes."""

import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy.integrate import quad
from scipy.special import sici

from asperity.errors import InputError
from asperity.radiation.pass_by import (
    AxleSource,
    Passage,
    Receiver,
    divergence,
    exposure,
    squared_pressure,
)
from asperity.radiation.track import IMPEDANCE

HERE = Receiver()
D = 7.5
FLAT = Receiver(D, 0.0)
WATT = np.array([1.0])


def test_a_source_at_rest_opposite_is_that_of_a_half_sphere():
    # 1 W through 2π d²: L_p = 120 dB − 10 lg(2π 7.5²) + 10 lg(413 · 1e-12/4e-10)
    found = squared_pressure(AxleSource(WATT), Passage([0.0], 1.0), FLAT, [0.0])
    expected = 120.0 - 10 * np.log10(2 * np.pi * D**2) + 10 * np.log10(413e-12 / 4e-10)
    assert_allclose(10 * np.log10(found[0, 0] / 4e-10), expected, atol=1e-6)


def test_height_is_that_above_the_rail_head():
    # a hub at 0.46 m: d² = 7.5² + 0.74²
    found = squared_pressure(AxleSource(WATT, height=0.46), Passage([0.0], 1.0), HERE, [0.0])
    assert_allclose(found[0, 0], IMPEDANCE / (2 * np.pi * (56.25 + 0.5476)), rtol=1e-9)


@pytest.mark.parametrize("length", [0.05, 0.5, 3.0, 30.0, 300.0])
def test_spread_opposite_the_receiver_against_the_auxiliary_function(length):
    # ∫_0^∞ exp(−aξ)/(d² + ξ²) dξ = f(ad)/d, f(x) = Ci(x) sin x + (π/2 − Si(x)) cos x
    x = 2.0 * D / length
    si, ci = sici(x)
    assert_allclose(
        divergence(length, D, 0.0),
        2.0 / (length * D) * (ci * np.sin(x) + (np.pi / 2 - si) * np.cos(x)),
        rtol=1e-9,
    )


@pytest.mark.parametrize("length", [0.3, 4.0, 60.0])
@pytest.mark.parametrize("along", [-90.0, -11.0, 2.0, 35.0])
def test_spread_elsewhere_against_quadrature(length, along):
    def integrand(xi):
        return np.exp(-2.0 * abs(xi) / length) / (D**2 + (along + xi) ** 2) / length

    pieces = [quad(integrand, *ends, limit=200, points=None)[0] for ends in (
        (-40 * length, -length), (-length, 0.0), (0.0, length), (length, 40 * length)
    )]  # fmt: skip
    assert_allclose(divergence(length, D, along), sum(pieces), rtol=1e-6)


def test_spread_is_continuous_where_its_series_takes_over():
    # 2 |s − id|/ℓ passes 40
    along = np.linspace(50.0, 70.0, 4001)
    second = np.diff(divergence(3.0, D, along), n=2)
    assert_allclose(second[0], 6.0 * 0.005**2 / 50.0**4, rtol=0.1)  # of about 1/s²
    assert np.abs(np.diff(second)).max() < 1e-13


def test_a_short_spread_is_a_point_and_a_long_one_a_line():
    along = np.linspace(-30.0, 30.0, 7)
    assert_allclose(divergence(1e-3, D, along), divergence(0.0, D, along), rtol=1e-6)
    assert_allclose(divergence(1e6, D, 0.0), np.pi / D / 1e6, rtol=2e-4)  # W/ℓ per length near the middle


@pytest.mark.parametrize("length", [0.0, 1.0, 10.0, 40.0])
def test_exposure_does_not_depend_on_the_spread(length):
    """∫ W ρc Q/(4π (d² + v² t²)) dt = W ρc Q/(4 d v), and a spread only delays parts of it."""
    passage, source = Passage([0.0], 20.0), AxleSource(WATT, length)
    closed = 1.0 * IMPEDANCE * 2.0 / (4.0 * D * 20.0)
    assert_allclose(exposure(source, passage, FLAT), closed, rtol=1e-12)
    half = 4000.0  # m: arctan leaves 2/π d/half beyond it
    time = np.linspace(-half, half, 400_001) / 20.0
    integral = np.trapezoid(squared_pressure(source, passage, FLAT, time)[0], time)
    assert_allclose(integral, closed * (1.0 - 2.0 / np.pi * D / half), rtol=2e-5)


def test_twice_the_speed_is_half_the_exposure_and_twice_the_distance_too():
    source = AxleSource(WATT, 5.0)
    one = exposure(source, Passage([0.0, 2.5], 20.0), FLAT)
    assert_allclose(
        10 * np.log10(exposure(source, Passage([0.0, 2.5], 40.0), FLAT) / one), -3.0103, atol=1e-4
    )
    assert_allclose(exposure(source, Passage([0.0, 2.5], 20.0), Receiver(2 * D, 0.0)) / one, 0.5)
    assert_allclose(exposure(source, Passage([0.0], 20.0), FLAT) / one, 0.5)


def test_it_is_the_same_before_and_after():
    time = np.linspace(-2.0, 2.0, 801)
    for length in (0.0, 8.0):
        found = squared_pressure(AxleSource(WATT, length), Passage([0.0], 50.0), HERE, time)[0]
        assert_allclose(found, found[::-1], rtol=1e-6)
        assert found.argmax() == 400


def test_axles_add_up_and_pass_one_after_the_other():
    source, time = AxleSource(np.array([1.0, 2.0]), np.array([0.0, 6.0])), np.linspace(-1.0, 2.0, 601)
    both = squared_pressure(source, Passage([0.0, 20.0], 40.0), HERE, time)
    first, second = (squared_pressure(source, Passage([0.0], 40.0), HERE, time - lag) for lag in (0.0, 0.5))
    assert both.shape == (2, 601)
    assert_allclose(both, first + second, rtol=1e-4)
    assert time[first[0].argmax()] == pytest.approx(0.0, abs=0.006)
    assert time[second[0].argmax()] == pytest.approx(0.5, abs=0.006)


def test_many_axles_are_a_line_source():
    """An infinite line of W' = 1 W/3 m: p² = W' ρc Q/(4 d)."""
    passage = Passage(3.0 * np.arange(3001), 30.0)
    middle = passage.axles[-1] / 2 / passage.speed
    found = squared_pressure(AxleSource(WATT, 4.0), passage, FLAT, middle + np.linspace(0.0, 0.1, 30))
    assert_allclose(found[0].mean(), IMPEDANCE * 2.0 / (4.0 * D) / 3.0, rtol=2e-3)  # 2/π d/4500 m is missing


def test_front_and_rear():
    assert Passage([0.0], 10.0).passed is None
    assert_allclose(Passage([0.0, 2.0, 4.0], 10.0).passed, (-0.1, 0.5))  # as long as 3 axles 2 m apart
    assert_allclose(Passage([0.0, 2.0], 10.0, length=20.0).passed, (-0.9, 1.1))
    assert_allclose(Passage([0.0], 10.0, length=20.0).passed, (-1.0, 1.0))


@pytest.mark.parametrize("length", [0.0, 3.0, 40.0])
@pytest.mark.parametrize(
    "passage",
    [Passage([0.0], 56.0), Passage([0.0], 56.0, 200.0), Passage([0.0, 2.5, 19.0, 21.5], 20.0, 26.4)],
)
def test_the_record_holds_the_whole_rise_and_fall(passage, length):
    time = passage.times(HERE, length)
    found = squared_pressure(AxleSource(WATT, length), passage, HERE, time)[0]
    assert max(found[0], found[-1]) < 0.1 * np.interp((passage.passed or (0.0, 0.0))[0], time, found)
    assert_allclose(np.diff(time), time[1] - time[0])


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda: AxleSource(np.array([-1.0])), r"sound power \(W\)"),
        (lambda: AxleSource(WATT, np.nan), "length of a source"),
        (lambda: AxleSource(WATT, 0.0, np.inf), "height of a source"),
        (lambda: Receiver(0.0), "distance of the receiver"),
        (lambda: Receiver(7.5, np.nan), "height of the receiver"),
        (lambda: Passage([], 10.0), "rise from 0 m"),
        (lambda: Passage([1.0], 10.0), "rise from 0 m"),
        (lambda: Passage([0.0, 3.0, 2.0], 10.0), "rise from 0 m"),
        (lambda: Passage([0.0], 0.0), "speed"),
        (lambda: Passage([0.0, 20.0], 10.0, 19.0), "at least that over its axles, 20"),
        (lambda: Passage([0.0], 10.0, -1.0), "length of the train"),
    ],
)
def test_bad_input(call, message):
    with pytest.raises(InputError, match=message):
        call()
