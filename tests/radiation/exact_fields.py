"""Exact sound of a thin disc and, by boundary elements, of a rigid section, in free air."""

import itertools
import math

import numpy as np
from scipy.special import gamma, hankel2, rgamma, spherical_jn

_FARTHEST = 4000.0


def axial_ratio(order, ka, terms=12):
    """Sound power over ρ c 2πa² ⟨v²⟩ of a disc whose axial velocity goes as r^n cos(nθ), of radius one.

    The jump of pressure is r^n √(1 − r²) P_m(r²) with Jacobi's polynomials, whose Hankel transforms are
    ζ^(-3/2) J_{n+2m+3/2}(ζ), by spherical functions √(2/π)/ζ j_{n+2m+1}(ζ); Galerkin's equations with the
    admittance √(ζ² − k²) of the half-space.
    """
    node, weight = np.polynomial.legendre.leggauss(60)
    angle = 0.25 * np.pi * (node + 1.0)
    zeta, share = [ka * np.sin(angle)], [0.25 * np.pi * weight * ka * np.cos(angle)]
    root = [1j * ka * np.cos(angle)]
    edges = np.concatenate([[0.0], np.geomspace(1.0, np.sqrt(_FARTHEST**2 - ka**2), 60)])
    for first, last in itertools.pairwise(edges):
        u = 0.5 * (last - first) * (node + 1.0) + first
        zeta.append(np.hypot(u, ka))
        share.append(0.5 * (last - first) * weight * u / zeta[-1])
        root.append(u + 0j)
    zeta, share, root = (np.concatenate(each) for each in (zeta, share, root))
    number = np.arange(terms)
    shapes = np.sqrt(2.0 / np.pi) / zeta * spherical_jn(order + 2 * number[:, None] + 1, zeta)
    sign = (-1.0) ** number
    stiffness = (shapes * (share * zeta * root)) @ shapes.T + np.outer(sign, sign) / (np.pi * _FARTHEST)
    moved = np.array([_both(order + 1.0, order + 2 * m + 1.5, 1.5) for m in number])
    jump = np.linalg.solve(stiffness, 2j * ka * moved)
    return float(np.real(jump @ moved) * (order + 1.0))


def _both(mu, nu, power):
    """Integral of J_mu J_nu t^-power from zero on (Weber and Schafheitlin)."""
    return (
        gamma(power) * gamma(0.5 * (mu + nu - power + 1.0)) * 2.0**-power
        * rgamma(0.5 * (nu - mu + power + 1.0)) * rgamma(0.5 * (mu + nu + power + 1.0))
        * rgamma(0.5 * (mu - nu + power + 1.0))
    )  # fmt: skip


SECTION_60E1 = 1e-3 * np.array(
    [
        (0.0, 0.0), (75.0, 0.0), (75.0, 11.5), (50.0, 17.0), (20.0, 27.0), (11.0, 38.0), (8.25, 55.0),
        (8.25, 100.0), (11.0, 118.0), (20.0, 124.0), (36.0, 129.0), (35.5, 160.0), (30.0, 168.0),
        (15.0, 171.5), (0.0, 172.0),
    ]
)  # fmt: skip
"""Right half of a 60E1 rail, m, drawn from the main dimensions of EN 13674-1: 172 mm high, foot 150 mm, head
72 mm wide and 51 mm high, web 16.5 mm, foot 31.5 mm."""

INSIDE_60E1 = np.array([(0.0, 0.015), (0.003, 0.15), (-0.002, 0.08), (0.01, 0.145), (0.03, 0.01)])


def mirrored(half):
    """Whole outline (n, 2), against the clock, of its right half from bottom to top."""
    return np.concatenate([half, (half * [-1.0, 1.0])[1:-1][::-1]])


def power_per_length(outline, inside, wavenumber, size=5e-3):
    """Sound power per length over ρ c ⟨v²⟩, m, of an outline (n, 2), m, at a wavenumber, rad/m.

    It moves up and down. Collocation with constant elements, e^{+iωt}; points inside at which the pressure
    has to be zero make the solution unique (H. A. Schenck, J. Acoust. Soc. Am. 44 (1968) 41-58). Checked in
    `test_radiators.py` against the oscillating cylinder.
    """
    nodes = np.concatenate(
        [
            a + (b - a) * np.arange(n)[:, None] / n
            for a, b in zip(outline, np.roll(outline, -1, axis=0), strict=True)
            for n in [max(1, math.ceil(np.linalg.norm(b - a) / size))]
        ]
    )
    along = np.roll(nodes, -1, axis=0) - nodes
    middle, length = nodes + 0.5 * along, np.hypot(*along.T)
    normal = np.stack([along[:, 1], -along[:, 0]], axis=1) / length[:, None]
    node, weight = np.polynomial.legendre.leggauss(4)
    sources = middle[:, None] + 0.5 * along[:, None] * node[:, None]
    offset = np.concatenate([middle, inside])[:, None, None] - sources
    distance = np.hypot(offset[..., 0], offset[..., 1])
    share = 0.5 * length[:, None] * weight
    single = np.sum(-0.25j * hankel2(0, wavenumber * distance) * share, axis=-1)
    facing = np.einsum("tnqi,ni->tnq", offset, normal) / distance
    double = np.sum(-0.25j * wavenumber * hankel2(1, wavenumber * distance) * facing * share, axis=-1)
    own = np.arange(len(middle))
    euler = 0.5772156649015329
    single[own, own] = (
        -0.25j * length * (1.0 - 2j / math.pi * (np.log(0.25 * wavenumber * length) + euler - 1.0))
    )  # of a short straight element on itself
    double[own, own] = 0.0
    jump = np.zeros(double.shape)
    jump[own, own] = 0.5
    velocity = normal[:, 1]
    pressure = np.linalg.lstsq(jump - double, single @ (1j * wavenumber * velocity), rcond=None)[0]
    return float(np.sum((pressure * velocity).real * length))
