"""Stiffness of a contact that sticks, against Mindlin's closed form and Cerruti's integral off the middle."""

import math

import numpy as np
import pytest

from asperity.contact.hertz import stick_stiffness
from asperity.errors import InputError
from asperity.reference.materials import MATERIALS, Material

STEEL = MATERIALS["steel"]


def shear(material):
    return material.youngs_modulus / (2.0 * (1.0 + material.poisson_ratio))


@pytest.mark.parametrize("nu", [0.0, 0.28, 0.5])
def test_of_like_bodies_on_a_circle_it_is_mindlins_share_of_the_normal_stiffness(nu):
    body, a = Material("like", 200e9, nu, 7800.0, ""), 3e-3
    normal = 200e9 * a / (1.0 - nu**2)  # 2 E* a
    share = stick_stiffness((a, a), (body, body)) / normal
    assert share == pytest.approx(2.0 * (1.0 - nu) / (2.0 - nu), rel=1e-12, abs=0.0)


@pytest.mark.parametrize("axes", [(6e-3, 4e-3), (2e-3, 7e-3)])
@pytest.mark.parametrize("at", [(0.0, 0.0), (0.5, 0.4), (-0.3, 0.7)])
def test_the_contact_moves_sideways_as_a_whole(axes, at):
    """Cerruti's displacement under Mindlin's traction of 1 N across, anywhere inside the ellipse."""
    (a, b), nu, x, y = axes, STEEL.poisson_ratio, at[0] * axes[0], at[1] * axes[1]
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
    compliance = total / (2.0 * math.pi * shear(STEEL)) / (2.0 * math.pi * a * b)
    assert stick_stiffness(axes, (STEEL, STEEL)) == pytest.approx(0.5 / compliance, rel=1e-6)


def test_the_softer_body_gives_way():
    rubber = Material("rubber", 1e7, 0.5, 1000.0, "")
    soft = 8.0 * shear(rubber) * 1e-3 / 1.5
    assert stick_stiffness((1e-3, 1e-3), (STEEL, rubber)) == pytest.approx(soft, rel=1e-3)


def test_an_ellipse_without_size_is_refused():
    with pytest.raises(InputError, match=r"semi-axis of the contact \(m\): received 0"):
        stick_stiffness((0.0, 1e-3), (STEEL, STEEL))
