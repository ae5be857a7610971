"""Smooth contact along a line of finite length, as of a roller on its raceway: closed forms."""

import math
from dataclasses import dataclass

from asperity.arguments import not_negative, positive, require
from asperity.written_numbers import rounded

WIDEST = 0.125
"""Half width over the length, above which a contact is no line."""


@dataclass(frozen=True)
class LineContact:
    """Contact of two smooth cylinders that presses alike along a line of a length.

    Parameters
    ----------
    modulus : float
        Contact modulus E*, Pa.
    radius : float
        Relative radius R of curvature across the line, m: 1/R = 1/R₁ + 1/R₂.
    length : float
        Of the line, L, m.

    Notes
    -----
    Across the line the pressure is that of H. Hertz (1882), of half width b = √(4FR/πE*L). G. Lundberg,
    Forsch. Ing.-Wes. 10 (1939) 201: it is alike along the line where the bodies part by
    F/(πE*L) ln 1/(1 − (2x/L)²), see `Crowning.lundberg`. The middle of the half-spaces then gives way by
    δ = 2F/(πE*L) (ln(2L/b) + 1/2), up to shares of about (b/L)², seen from far away: a line without an end
    has no approach, and bodies that are thin against its length are stiffer.

    Examples
    --------
    >>> from asperity import LineContact
    >>> contact = LineContact(113.7e9, 3.25e-3, 6e-3)  # a roller of a bearing NU 205 on its inner ring
    >>> approach = contact.approach(500.0)
    >>> f"{approach * 1e6:.2f} um, {contact.peak_pressure(approach) / 1e9:.2f} GPa"
    '2.75 um, 0.96 GPa'
    """

    modulus: float
    radius: float
    length: float

    def __post_init__(self) -> None:
        for name in ("modulus", "radius", "length"):
            positive(f"{name} of the line contact", getattr(self, name))

    @property
    def largest_force(self) -> float:
        """Force at which half the width is an eighth of the length, N: above it the contact is no line."""
        return 0.25 * math.pi * self.modulus * self.length * (WIDEST * self.length) ** 2 / self.radius

    def half_width(self, approach: float) -> float:
        """Half the width b of the contact at an approach, m.

        Parameters
        ----------
        approach : float
            m.

        Returns
        -------
        float
            √(4FR/πE*L), m; zero while apart.
        """
        along = self.force(approach) / (math.pi * self.modulus * self.length)
        return 2.0 * math.sqrt(along * self.radius)

    def peak_pressure(self, approach: float) -> float:
        """Pressure on the line at an approach, Pa.

        Parameters
        ----------
        approach : float
            m.

        Returns
        -------
        float
            √(FE*/πRL), Pa; zero while apart.
        """
        return math.sqrt(self.force(approach) * self.modulus / (math.pi * self.radius * self.length))

    def approach(self, force: float) -> float:
        """Approach of the bodies in the middle of the line under a force, m.

        Parameters
        ----------
        force : float
            From 0 to `largest_force`, N.

        Returns
        -------
        float
            F/(πE*L) (1 + ln(πE*L³/FR)), m.
        """
        force = not_negative("force (N)", force)
        most = self.largest_force
        allowed = f"at most {rounded(most)} N, where half the width is {WIDEST:g} of the length"
        require(force <= most * (1.0 + 1e-9), "force on the line contact", f"{rounded(force, 4)} N", allowed)
        along = force / (math.pi * self.modulus * self.length)
        return along * (1.0 + math.log(self.length**2 / (self.radius * along))) if along else 0.0

    def force(self, approach: float) -> float:
        """Force at an approach, N (zero while apart).

        Parameters
        ----------
        approach : float
            Up to that of `largest_force`, m.

        Returns
        -------
        float
            The inverse of `approach`, by the lower branch of Lambert's W, N.
        """
        if approach <= 0.0:
            return 0.0
        most = self.approach(self.largest_force)
        allowed = f"at most {rounded(most * 1e6)} µm, where the contact is a line"
        received = f"{rounded(approach * 1e6, 4)} µm"
        require(approach <= most * (1.0 + 1e-9), "approach of the line contact", received, allowed)
        # not where contacts are only compiled
        from scipy.special import lambertw

        scale = math.e * self.length**2 / self.radius
        logarithm = -float(lambertw(-approach / scale, k=-1).real)
        return math.pi * self.modulus * self.length * approach / logarithm

    def tangent_stiffness(self, approach: float) -> float:
        """dF/dδ at an approach, N/m.

        Parameters
        ----------
        approach : float
            m.

        Returns
        -------
        float
            πE*L/ln(πE*L³/FR), N/m; zero while apart.
        """
        along = self.force(approach) / (math.pi * self.modulus * self.length)
        if along == 0.0:
            return 0.0
        return math.pi * self.modulus * self.length / math.log(self.length**2 / (self.radius * along))


def palmgren_approach(force: float, length: float) -> float:
    """Approach of a steel roller and a steel raceway by Palmgren's fit, m.

    Parameters
    ----------
    force : float
        N.
    length : float
        Of the roller, m.

    Returns
    -------
    float
        3.84·10⁻⁵ Q^0.9/L^0.8 in mm, of newtons and millimetres, whatever the radii; here in m.

    Notes
    -----
    A. Palmgren, Ball and Roller Bearing Engineering, 3rd ed. (1959). It is 3 % less than the approach that
    ISO/TS 16281 has, whose slices are in `asperity.contact.slices`.
    """
    force = not_negative("force (N)", force)
    return 1e-3 * 3.84e-5 * force**0.9 / (1e3 * positive("length of the roller (m)", length)) ** 0.8
