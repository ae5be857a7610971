"""Radiation of cylinders and pistons, against their limits and their far fields."""

import math

import numpy as np
import pytest
from scipy.special import hankel2, j1

from asperity.errors import InputError
from asperity.radiation.track import baffled_piston, cylinder


@pytest.mark.parametrize("ka", [0.2, 1.0, 3.0])
@pytest.mark.parametrize("order", [0, 1, 3])
def test_a_cylinder_radiates_what_passes_a_circle_around_it(ka, order):
    """Power through a circle, from pressure and its slope, over that of a plane wave; ρc = 1, a = 1."""
    step = 1e-6
    slope = (hankel2(order, ka + step) - hankel2(order, ka - step)) / (2.0 * step)
    amplitude = -1j / slope  # -dp/dr = i k v on the surface
    r = 5.0
    pressure = amplitude * hankel2(order, ka * r)
    outwards = 1j * amplitude * (hankel2(order, (r + step) * ka) - hankel2(order, (r - step) * ka))
    velocity = outwards / (2.0 * step * ka)
    around = 2.0 * math.pi if order == 0 else math.pi  # of cos² nθ
    power = (pressure * np.conj(velocity)).real * around * r
    assert cylinder(ka, order) == pytest.approx(power / around, rel=1e-6)


def test_limits_of_cylinders():
    """(π/2) ka of the line monopole, (π/2)(ka)³ of the line dipole; one where ka is large."""
    assert cylinder(1e-3, 0) == pytest.approx(0.5 * math.pi * 1e-3, rel=1e-4)
    assert cylinder(1e-3) == pytest.approx(0.5 * math.pi * 1e-9, rel=1e-4)
    assert cylinder(300.0) == pytest.approx(1.0, abs=1e-4)


@pytest.mark.parametrize("ka", [0.05, 1.0, 4.0])
def test_a_piston_radiates_what_arrives_far_away(ka):
    """Rayleigh's integral: |p| = k a² v |2 J₁(ka sin ϑ)/(ka sin ϑ)|/(2R), integrated over the half-space."""
    node, weight = np.polynomial.legendre.leggauss(200)
    angle = 0.25 * math.pi * (node + 1.0)
    beam = 2.0 * j1(ka * np.sin(angle)) / (ka * np.sin(angle))
    power = 2.0 * math.pi * 0.25 * math.pi * np.sum(weight * (0.5 * ka * beam) ** 2 * np.sin(angle))
    assert baffled_piston(ka) == pytest.approx(power / math.pi, rel=1e-9)


def test_the_piston_at_small_arguments_goes_over_into_its_series():
    ka = np.array([1e-4, 0.00999, 0.01001])
    exact = 0.5 * ka**2 - ka**4 / 12.0 + ka**6 / 144.0
    np.testing.assert_allclose(baffled_piston(ka), exact, rtol=1e-9)


@pytest.mark.parametrize("ratio", [cylinder, baffled_piston])
@pytest.mark.parametrize("ka", [0.0, -1.0, math.nan, math.inf])
def test_an_argument_that_is_not_positive_is_refused(ratio, ka):
    with pytest.raises(InputError, match="wavenumber times radius"):
        ratio(ka)


def test_a_negative_order_is_refused():
    with pytest.raises(InputError, match="order of the motion around a cylinder"):
        cylinder(1.0, -1)
