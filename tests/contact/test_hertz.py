"""Hertz's closed forms against printed values and each other."""

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from asperity.contact import Hertz
from asperity.errors import InputError

STEEL = 210e9 / (2 * (1 - 0.3**2))


@pytest.mark.parametrize(
    ("load", "approach", "a", "b", "tangent"),
    [
        (50e3, 65.6e-6, 5.68e-3, 4.28e-3, 1.143e9),
        (65e3, 78.1e-6, 6.20e-3, 4.67e-3, 1.248e9),
        (100e3, 104.1e-6, 7.16e-3, 5.39e-3, 1.441e9),
    ],
)
def test_wheel_on_rail(load, approach, a, b, tangent):
    # wheel R = 0.46 m in the rolling direction, rail head R = 0.30 m across it
    hertz = Hertz(STEEL, 0.46, 0.30)
    assert hertz.stiffness_constant == pytest.approx(9.413e10, rel=1e-4)
    delta = hertz.approach(load)
    assert delta == pytest.approx(approach, rel=1e-3)
    assert hertz.semi_axes(delta) == pytest.approx((a, b), rel=1e-3)
    assert hertz.tangent_stiffness(delta) == pytest.approx(tangent, rel=1e-3)


def test_steel_ball_at_ten_newton():
    hertz = Hertz(STEEL, 12.5e-3, 12.5e-3)
    delta = hertz.approach(10.0)
    assert delta == pytest.approx(0.697e-6, rel=1e-3)
    assert hertz.tangent_stiffness(delta) == pytest.approx(21.5e6, rel=2e-3)


def test_sphere_is_exact():
    hertz = Hertz(2.0, 3.0, 3.0)
    delta = 0.01
    a = math.sqrt(3.0 * delta)
    assert hertz.semi_axes(delta) == pytest.approx((a, a), rel=1e-12)
    assert hertz.force(delta) == pytest.approx(4 / 3 * 2.0 * math.sqrt(3.0) * delta**1.5, rel=1e-12)
    assert hertz.tangent_stiffness(delta) == pytest.approx(2 * 2.0 * a, rel=1e-12)
    assert hertz.peak_pressure(delta) == pytest.approx(2 * 2.0 * a / (math.pi * 3.0), rel=1e-12)


@given(st.floats(0.02, 0.999999), st.floats(1e-6, 1e-3))
def test_turning_the_bodies_swaps_the_axes(ratio, delta):
    along, across = Hertz(1e11, 1.0, ratio), Hertz(1e11, ratio, 1.0)
    assert along.force(delta) == pytest.approx(across.force(delta), rel=1e-12)
    assert along.semi_axes(delta) == pytest.approx(across.semi_axes(delta)[::-1], rel=1e-12)
    assert along.semi_axes(delta)[0] > along.semi_axes(delta)[1]


@given(st.floats(0.02, 0.999))
def test_apart_is_free_and_approach_inverts_force(ratio):
    hertz = Hertz(1e11, 1.0, ratio)
    assert hertz.force(-1e-6) == 0.0
    assert hertz.approach(hertz.force(2e-5)) == pytest.approx(2e-5, rel=1e-12)
    assert hertz.peak_pressure(-1.0) == 0.0


def test_near_circular_is_continuous():
    values = [Hertz(1.0, 1.0, 1.0 - e).stiffness_constant for e in (0.0, 1e-9, 1e-8, 1e-7, 1e-6, 1e-5)]
    # K_H ∝ (Rx Ry)^(1/4) to first order in the ellipticity
    for e, value in zip((0.0, 1e-9, 1e-8, 1e-7, 1e-6, 1e-5), values, strict=True):
        assert value == pytest.approx(4 / 3 * (1 - e) ** 0.25, rel=1e-9)


@pytest.mark.parametrize("bad", [0.0, -1.0, math.nan, math.inf])
def test_bad_radius(bad):
    with pytest.raises(InputError, match="radius_y: received"):
        Hertz(1e11, 1.0, bad)
