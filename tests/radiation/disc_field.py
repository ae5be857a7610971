"""Sound of a thin disc in free air whose axial velocity goes as r^n cos(nθ), exact.

The jump of pressure is r^n √(1 − r²) P_m(r²) with Jacobi's polynomials, whose Hankel transforms are ζ^(-3/2)
J_{n+2m+3/2}(ζ); Galerkin's equations with the admittance √(ζ² − k²) of the half-space. ρ c = 1, radius one.
"""

import itertools

import numpy as np
from scipy.special import gamma, jv, rgamma

_FARTHEST = 4000.0


def axial_ratio(order, ka, terms=12):
    """Sound power over ρ c 2πa² ⟨v²⟩."""
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
    shapes = np.array([zeta**-1.5 * jv(order + 2 * m + 1.5, zeta) for m in number])
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
