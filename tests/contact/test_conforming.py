"""Balls in grooves: signs of curvatures, printed numbers of bearings, the grid, the half-space's end."""

import math
import warnings

import numpy as np
import pytest
from numpy.testing import assert_allclose

from asperity.contact import HalfSpace, Hertz
from asperity.contact.hertz import FORCE_LOST, check_half_space, groove_gap, in_groove, relative_radius
from asperity.errors import HalfSpaceWarning, InputError

STEEL = 115e9
RADIUS, GROOVE = 6.35e-3, 0.52 * 12.7e-3  # ball and groove of a bearing 209
INNER, OUTER = 26.15e-3, -38.85e-3  # its raceways: pitch radius 32.5 mm less and plus the ball's


def sum_and_difference(contact):
    """Curvature sum, 1/m, and difference of bearing engineers."""
    along, across = 1.0 / contact.radius_x, 1.0 / contact.radius_y
    return along + across, (along - across) / (along + across)


@pytest.mark.parametrize("raceway", [INNER, OUTER])
def test_curvatures_add_up_and_the_hollow_ones_count_less_than_nothing(raceway):
    found = sum_and_difference(in_groove(STEEL, RADIUS, GROOVE, raceway))
    along, across = 1.0 / RADIUS + 1.0 / raceway, 1.0 / RADIUS - 1.0 / GROOVE
    assert found == pytest.approx((along + across, (along - across) / (along + across)))


def test_signs_of_curvatures():
    assert relative_radius(2.0) == 2.0
    assert relative_radius(2.0, math.inf) == 2.0
    assert relative_radius(2.0, 2.0) == 1.0
    assert relative_radius(2.0, -4.0) == pytest.approx(4.0)
    flat, inner, outer = (in_groove(STEEL, RADIUS, GROOVE, r) for r in (math.inf, INNER, OUTER))
    assert inner.radius_x < flat.radius_x < outer.radius_x
    assert inner.radius_y == flat.radius_y == outer.radius_y > 20.0 * RADIUS
    # a hollow carries more at the same approach
    assert outer.force(1e-6) > flat.force(1e-6) > inner.force(1e-6) > Hertz(STEEL, RADIUS, RADIUS).force(1e-6)


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ((RADIUS, RADIUS), r"radii of ball and groove \(m\): received 0.00635 and -0.00635; allowed: bodies"),
        ((RADIUS, 0.9 * RADIUS), "A hollow must be rounder than what lies in it"),
        ((RADIUS, -GROOVE), r"radius of the groove \(m\): received -0.0066"),
        ((0.0, GROOVE), r"radius of the ball \(m\): received 0.0"),
        ((RADIUS, GROOVE, -5e-3), "radii of ball and raceway"),
        ((RADIUS, GROOVE, 0.0), "radii of ball and raceway.*received 0.0; allowed: numbers other than 0"),
    ],
)
def test_balls_that_do_not_fit_are_refused(arguments, message):
    with pytest.raises(InputError, match=message):
        in_groove(STEEL, *arguments)


def windowed(contact, approach, cells=8):
    """Grid of cells of an eighth of the minor semi-axis, as cases are warned below, and the smooth gap."""
    along, across = contact.semi_axes(approach)
    spacing = along / cells
    x, y = (
        spacing * np.arange(-round(1.15 * half / spacing), round(1.15 * half / spacing) + 1)
        for half in (along, across)
    )
    return spacing, y, x[:, None] ** 2 / (2.0 * contact.radius_x), y**2 / (2.0 * contact.radius_y)


@pytest.mark.parametrize("raceway", [math.inf, INNER, OUTER])
def test_slender_ellipses_on_the_grid_are_those_of_hertz(raceway):
    """Axis ratios of 7 to 9, cells of an eighth of the minor semi-axis."""
    contact = in_groove(STEEL, RADIUS, GROOVE, raceway)
    approach = contact.approach(200.0)
    along, across = contact.semi_axes(approach)
    assert 7.0 < across / along < 10.0
    spacing, _, rolling, section = windowed(contact, approach)
    gap = rolling + section
    solved = HalfSpace(gap.shape, (spacing, spacing), STEEL).solve(gap, approach=approach)
    assert solved.force == pytest.approx(200.0, rel=3e-4)
    assert solved.pressure.max() == pytest.approx(contact.peak_pressure(approach), rel=1e-3)


def test_the_gap_of_circles_is_the_parabola_near_its_middle():
    contact = in_groove(STEEL, RADIUS, GROOVE)
    for angle, share in ((0.1, 1e-3), (1.0 / 3.0, 1.1e-2), (0.6, 4e-2)):
        s = angle * GROOVE
        assert groove_gap(s, RADIUS, GROOVE) == pytest.approx(s**2 / (2.0 * contact.radius_y), rel=share)
    # from coordinates of the two circles: the ball touches the bottom, the normal of the groove at 40°
    normal = np.array([np.sin(0.7), -np.cos(0.7)])
    middle = np.array([0.0, -(GROOVE - RADIUS)])
    t = normal @ middle + np.sqrt((normal @ middle) ** 2 - middle @ middle + RADIUS**2)
    assert_allclose(groove_gap([0.7 * GROOVE], RADIUS, GROOVE), GROOVE - t, rtol=1e-9)


@pytest.mark.parametrize("load", [500.0, 5000.0])
def test_what_the_plane_adds_in_a_groove(load):
    """Overlap δ cos θ − gap and load p cos θ against the plane: the estimate that warnings state."""
    contact = in_groove(STEEL, RADIUS, GROOVE, INNER)
    approach = contact.approach(load)
    spacing, y, rolling, section = windowed(contact, approach)
    turned, half = np.cos(y / GROOVE), HalfSpace((len(rolling), len(y)), (spacing, spacing), STEEL)
    flat = half.solve(rolling + section, approach=approach).force
    bent = rolling + groove_gap(y, RADIUS, GROOVE) + approach * (1.0 - turned)
    carried = (half.solve(bent, approach=approach).pressure * turned).sum() * spacing**2
    angle = contact.semi_axes(approach)[1] / GROOVE
    assert flat / carried - 1.0 == pytest.approx(FORCE_LOST * angle**2, rel=0.1)


GROOVED = {"groove_radius": GROOVE, "raceway_radius": INNER, "cause": "3 kN"}


def test_where_the_half_space_ends():
    def axes(along, across):
        return along * RADIUS, across * GROOVE

    with warnings.catch_warnings():
        warnings.simplefilter("error")
        check_half_space(axes(0.02, 0.29), RADIUS, groove_width=6e-3, **GROOVED)
        check_half_space((0.09 * RADIUS, 0.09 * RADIUS), RADIUS)
    with pytest.warns(HalfSpaceWarning, match=r"3 kN the contact fills 0.4 rad.*too large by about 5.1 %"):
        check_half_space(axes(0.02, 0.4), RADIUS, **GROOVED)
    with pytest.raises(
        InputError, match=r"fills 0.61 rad of the groove to either side; allowed: at most 0.6"
    ):
        check_half_space(axes(0.02, 0.61), RADIUS, **GROOVED)
    with pytest.raises(InputError, match=r"width of the groove: received 3 mm, and a contact of 3.962 mm"):
        check_half_space(axes(0.02, 0.3), RADIUS, groove_width=3e-3, **GROOVED)
    with pytest.warns(HalfSpaceWarning, match=r"a semi-axis of 0.2 R along the path, above 0.1 R"):
        check_half_space(axes(0.2, 0.2), RADIUS, **GROOVED)
    with pytest.raises(InputError, match=r"a semi-axis of 0.4 R across the path; allowed: at most R/3"):
        check_half_space((0.01 * RADIUS, 0.4 * RADIUS), RADIUS)
    with pytest.warns(HalfSpaceWarning, match=r"The radius of the ball is 1 % below that of the groove"):
        check_half_space(axes(0.02, 0.2), RADIUS, groove_radius=RADIUS / 0.99)
