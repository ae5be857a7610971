"""Smooth bodies: Hertz's closed forms, balls in grooves, and where the half-space ends."""

import math
import warnings

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from asperity import HalfSpace, Hertz
from asperity.contact.hertz import FORCE_LOST, check_half_space, groove_gap, in_groove, relative_radius
from asperity.errors import HalfSpaceWarning, InputError

STEEL = 115e9
RADIUS, GROOVE = 6.35e-3, 0.52 * 12.7e-3  # ball and groove of a bearing 209
INNER, OUTER = 26.15e-3, -38.85e-3  # its raceways: pitch radius 32.5 mm less and plus the ball's


@given(st.floats(0.02, 0.999999), st.floats(1e-6, 1e-3))
def test_turning_the_bodies_swaps_the_axes_and_approach_inverts_force(ratio, delta):
    along, across = Hertz(1e11, 1.0, ratio), Hertz(1e11, ratio, 1.0)
    assert along.force(delta) == pytest.approx(across.force(delta), rel=1e-12)
    assert along.semi_axes(delta) == pytest.approx(across.semi_axes(delta)[::-1], rel=1e-12)
    assert along.semi_axes(delta)[0] > along.semi_axes(delta)[1]
    assert along.approach(along.force(delta)) == pytest.approx(delta, rel=1e-12, abs=0.0)
    assert along.force(-delta) == along.peak_pressure(-delta) == 0.0


@pytest.mark.parametrize("e", [0.0, 1e-9, 1e-8, 1e-7, 1e-6, 1e-5])
def test_near_circular_is_continuous(e):
    """K_H ∝ (Rx Ry)^(1/4) to first order in the ellipticity."""
    assert Hertz(1.0, 1.0, 1.0 - e).stiffness_constant == pytest.approx(4 / 3 * (1 - e) ** 0.25, rel=1e-9)


def test_signs_of_curvatures():
    assert relative_radius(2.0) == relative_radius(2.0, math.inf) == 2.0
    assert relative_radius(2.0, 2.0) == 1.0
    assert relative_radius(2.0, -4.0) == pytest.approx(4.0)
    flat, inner, outer = (in_groove(STEEL, RADIUS, GROOVE, r) for r in (math.inf, INNER, OUTER))
    assert 1.0 / inner.radius_x == pytest.approx(1.0 / RADIUS + 1.0 / INNER)
    assert 1.0 / outer.radius_x == pytest.approx(1.0 / RADIUS + 1.0 / OUTER)
    assert inner.radius_y == flat.radius_y == outer.radius_y
    assert 1.0 / flat.radius_y == pytest.approx(1.0 / RADIUS - 1.0 / GROOVE)


def test_the_gap_of_circles_is_the_parabola_near_its_middle():
    contact = in_groove(STEEL, RADIUS, GROOVE)
    for angle, share in ((0.1, 1e-3), (1.0 / 3.0, 1.1e-2), (0.6, 4e-2)):
        s = angle * GROOVE
        assert groove_gap(s, RADIUS, GROOVE) == pytest.approx(s**2 / (2.0 * contact.radius_y), rel=share)
    # from coordinates of the two circles: the ball touches the bottom, the normal of the groove at 40°
    normal, middle = np.array([np.sin(0.7), -np.cos(0.7)]), np.array([0.0, -(GROOVE - RADIUS)])
    t = normal @ middle + np.sqrt((normal @ middle) ** 2 - middle @ middle + RADIUS**2)
    np.testing.assert_allclose(groove_gap([0.7 * GROOVE], RADIUS, GROOVE), GROOVE - t, rtol=1e-9)


@pytest.mark.parametrize("load", [500.0, 5000.0])
def test_what_the_plane_adds_in_a_groove(load):
    """Overlap δ cos θ − gap and load p cos θ against the plane: the estimate that warnings state."""
    contact = in_groove(STEEL, RADIUS, GROOVE, INNER)
    approach = contact.approach(load)
    along, across = contact.semi_axes(approach)
    spacing = along / 8
    x, y = (spacing * np.arange(-round(9.2 * a / along), round(9.2 * a / along) + 1) for a in (along, across))
    rolling, turned = x[:, None] ** 2 / (2.0 * contact.radius_x), np.cos(y / GROOVE)
    half_space = HalfSpace((len(x), len(y)), spacing, STEEL)
    flat = half_space.solve(rolling + y**2 / (2.0 * contact.radius_y), approach=approach).force
    bent = rolling + groove_gap(y, RADIUS, GROOVE) + approach * (1.0 - turned)
    carried = (half_space.solve(bent, approach=approach).pressure * turned).sum() * spacing**2
    assert flat / carried - 1.0 == pytest.approx(FORCE_LOST * (across / GROOVE) ** 2, rel=0.1)


GROOVED = {"groove_radius": GROOVE, "raceway_radius": INNER, "cause": "3 kN"}


@pytest.mark.parametrize(
    ("along", "across", "keywords", "kind", "message"),
    [
        (0.02, 0.29, GROOVED, None, ""),
        (0.09, 0.09 * RADIUS / GROOVE, {}, None, ""),
        (0.02, 0.4, GROOVED, HalfSpaceWarning, r"3 kN the contact fills 0.4 rad.*too large by about 5.1 %"),
        (0.02, 0.61, GROOVED, InputError, r"fills 0.61 rad of the groove .*; allowed: at most 0.6"),
        (0.2, 0.2, GROOVED, HalfSpaceWarning, r"a semi-axis of 0.2 R along the path, above 0.1 R"),
        (0.01, 0.4 * RADIUS / GROOVE, {}, InputError, r"0.4 R across the path; allowed: at most R/3"),
        (
            0.02, 0.2, {"groove_radius": RADIUS / 0.99}, HalfSpaceWarning,
            r"The radius of the ball is 1 % below that of the groove",
        ),
    ],
)  # fmt: skip
def test_where_the_half_space_ends(along, across, keywords, kind, message):
    axes = along * RADIUS, across * GROOVE
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        if kind is None:
            check_half_space(axes, RADIUS, **keywords)
        else:
            with pytest.raises(kind, match=message):
                check_half_space(axes, RADIUS, **keywords)
