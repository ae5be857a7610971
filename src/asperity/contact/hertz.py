"""Hertz's contact of smooth bodies with elliptic gap, in closed form."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property

from asperity.errors import InputError

HALVINGS = 56
"""Of the interval that holds the logarithm of the axis ratio, until its ends are neighbours."""


@dataclass(frozen=True)
class Hertz:
    """Smooth contact with the gap x²/(2 Rx) + y²/(2 Ry).

    Parameters
    ----------
    modulus : float
        Contact modulus E*, Pa.
    radius_x, radius_y : float
        Relative radii of curvature in the rolling direction and across it, m: 1/R = 1/R₁ + 1/R₂.

    Notes
    -----
    K. L. Johnson, Contact Mechanics (1985), with e² = 1 − (b/a)². F = K_H δ^1.5.

    Examples
    --------
    >>> from asperity import Hertz
    >>> contact = Hertz(115e9, 25e-3, 25e-3)  # a steel ball on steel
    >>> f"{contact.approach(5.0) * 1e6:.3f} um, {contact.semi_axes(contact.approach(5.0))[0] * 1e6:.1f} um"
    '0.349 um, 93.4 um'
    """

    modulus: float
    radius_x: float
    radius_y: float

    def __post_init__(self) -> None:
        for name in ("modulus", "radius_x", "radius_y"):
            value = getattr(self, name)
            if not (math.isfinite(value) and value > 0):
                raise InputError(f"Hertz {name}", value, "a positive finite number in SI units")

    @cached_property
    def _shape(self) -> tuple[float, float, float]:
        """Axis ratio b/a (≤ 1), K(e), and (K(e) − E(e))/e²."""
        ratio = min(self.radius_x, self.radius_y) / max(self.radius_x, self.radius_y)

        def integrals(axis_ratio: float) -> tuple[float, float]:
            m1 = axis_ratio**2
            m = 1.0 - m1
            if m < 1e-7:  # series: K and E cancel
                return 0.5 * math.pi * (1.0 + 0.25 * m), 0.25 * math.pi * (1.0 + 0.375 * m)
            # not where contacts are only compiled
            from scipy.special import ellipe, ellipkm1

            k = float(ellipkm1(m1))
            return k, (k - float(ellipe(m))) / m

        def mismatch(axis_ratio: float) -> float:
            # curvature ratio A/B = (K − E) / ((a/b)² E − K) in complete elliptic integrals
            m1 = axis_ratio**2
            k, d = integrals(axis_ratio)
            m = 1.0 - m1
            # (E − m1 K)/m = K − d
            return m1 * d / (k - d) - ratio if m > 0.0 else 1.0 - ratio

        axis_ratio = 1.0
        if ratio <= 1.0 - 1e-12:
            low, high = math.log(1e-9), 0.0
            for _ in range(HALVINGS):
                middle = 0.5 * (low + high)
                low, high = (low, middle) if mismatch(math.exp(middle)) > 0.0 else (middle, high)
            axis_ratio = math.exp(0.5 * (low + high))
        return (axis_ratio, *integrals(axis_ratio))

    @cached_property
    def stiffness_constant(self) -> float:
        """K_H = F / δ^1.5, N/m^1.5."""
        _, k, d = self._shape
        curvature = 0.5 / max(self.radius_x, self.radius_y)
        return (2.0 * math.pi / 3.0) * self.modulus * math.sqrt(d / curvature) / k**1.5

    def force(self, approach: float) -> float:
        """Force at an approach, N (zero while apart).

        Parameters
        ----------
        approach : float
            Approach, m.

        Returns
        -------
        float
            Force, N.
        """
        return self.stiffness_constant * max(approach, 0.0) ** 1.5

    def approach(self, force: float) -> float:
        """Approach under a force, m.

        Parameters
        ----------
        force : float
            Force ≥ 0, N.

        Returns
        -------
        float
            Approach, m.
        """
        return (force / self.stiffness_constant) ** (2.0 / 3.0)

    def tangent_stiffness(self, approach: float) -> float:
        """dF/dδ at an approach, N/m.

        Parameters
        ----------
        approach : float
            Approach, m.

        Returns
        -------
        float
            Tangent stiffness, N/m; 2 E* a for a circular contact.
        """
        return 1.5 * self.stiffness_constant * math.sqrt(max(approach, 0.0))

    def semi_axes(self, approach: float) -> tuple[float, float]:
        """Semi-axes (a_x, a_y) of the contact ellipse at an approach, m.

        Parameters
        ----------
        approach : float
            Approach, m.

        Returns
        -------
        a_x, a_y : float
            Semi-axes in the rolling direction and across it, m.
        """
        axis_ratio, k, d = self._shape
        curvature = 0.5 / max(self.radius_x, self.radius_y)
        major = math.sqrt(max(approach, 0.0) * d / (curvature * k))
        minor = axis_ratio * major
        return (major, minor) if self.radius_x >= self.radius_y else (minor, major)

    def peak_pressure(self, approach: float) -> float:
        """Largest pressure at an approach, Pa.

        Parameters
        ----------
        approach : float
            Approach, m.

        Returns
        -------
        float
            1.5 F / (π a_x a_y), Pa.
        """
        if approach <= 0.0:
            return 0.0
        a, b = self.semi_axes(approach)
        return 1.5 * self.force(approach) / (math.pi * a * b)
