"""Smooth bodies: Hertz's closed forms, balls in grooves, where the half-space ends; contacts that stick."""

import math
import warnings

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from asperity import HalfSpace, Hertz
from asperity.contact import hertz
from asperity.errors import HalfSpaceWarning, InputError
from asperity.reference.materials import MATERIALS, Material

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
    assert hertz.relative_radius(2.0) == hertz.relative_radius(2.0, math.inf) == 2.0
    assert hertz.relative_radius(2.0, 2.0) == 1.0
    assert hertz.relative_radius(2.0, -4.0) == pytest.approx(4.0)
    flat, inner, outer = (hertz.in_groove(STEEL, RADIUS, GROOVE, r) for r in (math.inf, INNER, OUTER))
    assert 1.0 / inner.radius_x == pytest.approx(1.0 / RADIUS + 1.0 / INNER)
    assert 1.0 / outer.radius_x == pytest.approx(1.0 / RADIUS + 1.0 / OUTER)
    assert inner.radius_y == flat.radius_y == outer.radius_y
    assert 1.0 / flat.radius_y == pytest.approx(1.0 / RADIUS - 1.0 / GROOVE)


def test_the_gap_of_circles_is_the_parabola_near_its_middle():
    contact = hertz.in_groove(STEEL, RADIUS, GROOVE)
    for angle, share in ((0.1, 1e-3), (1.0 / 3.0, 1.1e-2), (0.6, 4e-2)):
        s = angle * GROOVE
        assert hertz.groove_gap(s, RADIUS, GROOVE) == pytest.approx(
            s**2 / (2.0 * contact.radius_y), rel=share
        )
    # from coordinates of the two circles: the ball touches the bottom, the normal of the groove at 40°
    normal, middle = np.array([np.sin(0.7), -np.cos(0.7)]), np.array([0.0, -(GROOVE - RADIUS)])
    t = normal @ middle + np.sqrt((normal @ middle) ** 2 - middle @ middle + RADIUS**2)
    np.testing.assert_allclose(hertz.groove_gap([0.7 * GROOVE], RADIUS, GROOVE), GROOVE - t, rtol=1e-9)


@pytest.mark.parametrize("load", [500.0, 5000.0])
def test_what_the_plane_adds_in_a_groove(load):
    """Overlap δ cos θ − gap and load p cos θ against the plane: the estimate that warnings state."""
    contact = hertz.in_groove(STEEL, RADIUS, GROOVE, INNER)
    approach = contact.approach(load)
    along, across = contact.semi_axes(approach)
    spacing = along / 8
    x, y = (spacing * np.arange(-round(9.2 * a / along), round(9.2 * a / along) + 1) for a in (along, across))
    rolling, turned = x[:, None] ** 2 / (2.0 * contact.radius_x), np.cos(y / GROOVE)
    half_space = HalfSpace((len(x), len(y)), spacing, STEEL)
    flat = half_space.solve(rolling + y**2 / (2.0 * contact.radius_y), approach=approach).force
    bent = rolling + hertz.groove_gap(y, RADIUS, GROOVE) + approach * (1.0 - turned)
    carried = (half_space.solve(bent, approach=approach).pressure * turned).sum() * spacing**2
    assert flat / carried - 1.0 == pytest.approx(hertz.FORCE_LOST * (across / GROOVE) ** 2, rel=0.1)


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
            hertz.check_half_space(axes, RADIUS, **keywords)
        else:
            with pytest.raises(kind, match=message):
                hertz.check_half_space(axes, RADIUS, **keywords)


BODY = MATERIALS["steel"]


def shear(material):
    return material.youngs_modulus / (2.0 * (1.0 + material.poisson_ratio))


@pytest.mark.parametrize("nu", [0.0, 0.28, 0.5])
def test_of_like_bodies_on_a_circle_it_is_mindlins_share_of_the_normal_stiffness(nu):
    body, a = Material("like", 200e9, nu, 7800.0, ""), 3e-3
    normal = 200e9 * a / (1.0 - nu**2)  # 2 E* a
    share = hertz.stick_stiffness((a, a), (body, body)) / normal
    assert share == pytest.approx(2.0 * (1.0 - nu) / (2.0 - nu), rel=1e-12, abs=0.0)


@pytest.mark.parametrize("axes", [(6e-3, 4e-3), (2e-3, 7e-3)])
@pytest.mark.parametrize("at", [(0.0, 0.0), (0.5, 0.4), (-0.3, 0.7)])
def test_the_contact_moves_sideways_as_a_whole(axes, at):
    """Cerruti's displacement under Mindlin's traction of 1 N across, anywhere inside the ellipse."""
    (a, b), nu, x, y = axes, BODY.poisson_ratio, at[0] * axes[0], at[1] * axes[1]
    node, weight = np.polynomial.legendre.leggauss(60)
    total = 0.0
    for angle in 2.0 * math.pi * (np.arange(400) + 0.5) / 400:
        c, s = math.cos(angle), math.sin(angle)
        # 1 − ((x + rc)/a)² − ((y + rs)/b)² = p + 2 q r − m r²; the root at its far end by r = r₁ − (r₁ u²)
        p = 1.0 - (x / a) ** 2 - (y / b) ** 2
        q, m = -(x * c / a**2 + y * s / b**2), (c / a) ** 2 + (s / b) ** 2
        reach = (q + math.sqrt(q**2 + m * p)) / m
        u = 0.5 * (node + 1.0)
        r = reach * (1.0 - u**2)
        inside = np.sum(0.5 * weight * 2.0 * u * reach / np.sqrt(p + 2.0 * q * r - m * r**2))
        total += inside * ((1.0 - nu) + nu * s**2) * 2.0 * math.pi / 400
    compliance = total / (2.0 * math.pi * shear(BODY)) / (2.0 * math.pi * a * b)
    assert hertz.stick_stiffness(axes, (BODY, BODY)) == pytest.approx(0.5 / compliance, rel=1e-6)


def test_the_softer_body_gives_way():
    rubber = Material("rubber", 1e7, 0.5, 1000.0, "")
    soft = 8.0 * shear(rubber) * 1e-3 / 1.5
    assert hertz.stick_stiffness((1e-3, 1e-3), (BODY, rubber)) == pytest.approx(soft, rel=1e-3)


def test_an_ellipse_without_size_is_refused():
    with pytest.raises(InputError, match=r"semi-axis of the contact \(m\): received 0"):
        hertz.stick_stiffness((0.0, 1e-3), (BODY, BODY))
