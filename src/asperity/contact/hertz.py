"""Smooth bodies in contact: Hertz in closed form, and bodies that conform, as a ball in its groove."""

import math
from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property, lru_cache

import numpy as np

from asperity.arguments import Array, ArrayLike, positive, require
from asperity.errors import HalfSpaceWarning, percent
from asperity.reference.materials import Material
from asperity.written_numbers import rounded

HALVINGS = 56
"""Of the interval that holds the logarithm of the axis ratio, until its ends are neighbours."""


class SmoothContact:
    """Contact of smooth bodies, whose approach under a force is known: what it has under a force."""

    approach: Callable[[float], float]
    tangent_stiffness: Callable[[float], float]
    semi_axes: Callable[[float], tuple[float, float]]
    peak_pressure: Callable[[float], float]

    def stiffness_under(self, force: float) -> float:
        """Tangent stiffness dF/dδ under a force, N; N/m."""
        return self.tangent_stiffness(self.approach(force))

    def semi_axes_under(self, force: float) -> tuple[float, float]:
        """Semi-axes in the rolling direction and across it under a force, N; m."""
        return self.semi_axes(self.approach(force))

    def pressure_under(self, force: float) -> float:
        """Largest pressure under a force, N; Pa."""
        return self.peak_pressure(self.approach(force))


@dataclass(frozen=True)
class Hertz(SmoothContact):
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
            positive(f"Hertz {name}", getattr(self, name))

    @property
    def _shape(self) -> tuple[float, float, float]:
        """Axis ratio b/a (≤ 1), K(e), and (K(e) − E(e))/e²."""
        return _shape_of(min(self.radius_x, self.radius_y) / max(self.radius_x, self.radius_y))

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


@lru_cache(maxsize=1024)
def _shape_of(ratio: float) -> tuple[float, float, float]:
    """Axis ratio b/a (≤ 1), K(e), and (K(e) − E(e))/e² of a ratio of radii (≤ 1)."""

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
        low = math.log(1e-9)
        high = 0.0
        for _ in range(HALVINGS):
            middle = 0.5 * (low + high)
            low, high = (low, middle) if mismatch(math.exp(middle)) > 0.0 else (middle, high)
        axis_ratio = math.exp(0.5 * (low + high))
    return (axis_ratio, *integrals(axis_ratio))


SLENDER = (0.1, 1.0 / 3.0)
"""Semi-axis over the radius of a convex body: warned of, and refused, above."""
HOLLOW = (0.3, 0.6)
"""Half the angle of a groove, rad, that the contact fills: warned of, and refused, above."""
FORCE_LOST = 0.32
"""Share of the force that the plane of the half-space adds in a groove, over the square of that angle."""
CONFORMITY = 0.985
"""Radius of what rolls over that of its groove, from which on the form of the groove decides."""


def relative_radius(*radii: float, what: str = "radii of the bodies (m)") -> float:
    """Radius of the gap between bodies: 1/R = Σ 1/Rᵢ.

    Parameters
    ----------
    *radii : float
        Of the surfaces in one direction, m: positive where a body bulges towards the other, negative where it
        is hollow, infinite where it is flat.
    what : str
        For messages.

    Returns
    -------
    float
        m; finite and positive.

    Raises
    ------
    InputError
        If a radius is zero or no number, or the bodies fit each other or touch at two ends: a gap that does
        not open.
    """
    for radius in radii:
        allowed = "numbers other than 0; infinite where a body is flat"
        require(not math.isnan(radius) and radius != 0.0, what, radius, allowed)
    curvatures = [1.0 / radius for radius in radii]
    curvature = sum(curvatures)
    opens = curvature > 1e-9 * max(map(abs, curvatures))
    received = " and ".join([f"{radius:.6g}" for radius in radii])
    remedy = "A hollow must be rounder than what lies in it: of a greater radius."
    require(opens, what, received, "bodies whose gap opens on both sides", remedy)
    return 1.0 / curvature


def in_groove(
    modulus: float, radius: float, groove_radius: float = math.inf, raceway_radius: float = math.inf
) -> Hertz:
    """Smooth contact of a ball in a groove that is straight, or curved along the path.

    Parameters
    ----------
    modulus : float
        Contact modulus E*, Pa.
    radius : float
        Of the ball, m.
    groove_radius : float
        Of the groove across the path, m, greater than that of the ball, as 0.52 ball diameters; infinite
        for a flat path.
    raceway_radius : float
        Along the path, where the contact is, m: positive of an inner ring, which the ball rolls around,
        negative of an outer ring, in which it rolls; infinite for a straight path.

    Returns
    -------
    Hertz
        With 1/R_x = 1/R + 1/R_raceway along the path and 1/R_y = 1/R − 1/r_groove across it.

    Raises
    ------
    InputError
        If the ball does not fit, or a radius is not positive that has to be.

    Examples
    --------
    >>> contact = in_groove(115e9, 6.35e-3, 6.6e-3, 26.15e-3)  # the inner ring of a bearing 6209
    >>> a, b = contact.semi_axes(contact.approach(1000.0))
    >>> f"{a * 1e3:.2f} mm along, {b * 1e3:.2f} mm across"
    '0.16 mm along, 1.54 mm across'
    """
    for what, value in (("radius of the ball (m)", radius), ("radius of the groove (m)", groove_radius)):
        require(value > 0.0, what, value, "a positive number")
    along = relative_radius(radius, raceway_radius, what="radii of ball and raceway (m)")
    across = relative_radius(radius, -groove_radius, what="radii of ball and groove (m)")
    return Hertz(modulus, along, across)


def groove_gap(across: ArrayLike, radius: float, groove_radius: float) -> Array:
    """Gap of a circle in a circle, exact, normal to the groove.

    Parameters
    ----------
    across : array_like (n,)
        Places along the arc of the groove from its lowest point, m.
    radius, groove_radius : float
        Of ball and groove, m.

    Returns
    -------
    ndarray (n,)
        m. It is the parabola s²/2R_y up to a share of about s²/12r²: 1 % at s = r/3.
    """
    angle = np.asarray(across, dtype=float) / groove_radius
    offset = groove_radius - radius
    # r − ρ with ρ = e cos θ + √(R² − e² sin² θ), without taking near numbers from each other
    sine = offset * np.sin(angle)
    chord = sine**2 / (radius + np.sqrt(radius**2 - sine**2))
    return 2.0 * offset * np.sin(0.5 * angle) ** 2 + chord


def check_half_space(
    semi_axes: tuple[float, float],
    radius: float,
    *,
    groove_radius: float = math.inf,
    raceway_radius: float = math.inf,
    cause: str = "the load",
    lighter: str = "Lower the load",
) -> None:
    """Refuse a contact that is none on a half-space, and warn of one that is nearly none.

    Parameters
    ----------
    semi_axes : (float, float)
        Of the contact along and across the path, m.
    radius, groove_radius, raceway_radius : float
        As in `in_groove`, m.
    cause : str
        What makes the contact so large, for messages.
    lighter : str
        What makes it smaller.

    Raises
    ------
    InputError
        If a semi-axis is above a third of the radius of a convex body, or fills more than 0.6 rad of a
        groove to either side.

    Warns
    -----
    HalfSpaceWarning
        Above a tenth, above 0.3 rad, or where ball and groove are so near that the groove's form decides.

    Notes
    -----
    In a groove the ball is pressed down, but surfaces give way at right angles. At an angle θ to the side the
    overlap of an approach δ is δ cos θ, and a pressure p carries p cos θ. On the plane of a half-space both
    are taken as one, and the force becomes too large by about 0.32 θ² for a contact that ends at θ: 3 % at
    0.3 rad, 11 % at 0.6.
    """
    along, across = semi_axes
    _slender(along, min(radius, abs(raceway_radius)), "along the path", cause, lighter)
    if math.isinf(groove_radius):
        _slender(across, radius, "across the path", cause, lighter)
        return
    if radius > CONFORMITY * groove_radius:
        HalfSpaceWarning.warn(
            f"The radius of the ball is {percent(1.0 - radius / groove_radius)} below that of the groove: "
            "the width of the contact follows from form errors of the groove as much as from its radius. "
            "Take the measured radius."
        )
    angle = across / groove_radius
    fills = f"fills {rounded(angle, 2)} rad of the groove to either side"
    allowed = f"at most {HOLLOW[1]:g} rad, where the groove is an elastic half-space"
    remedy = f"{lighter}, or take a groove of a greater radius."
    require(angle <= HOLLOW[1], "contact", f"{cause}, a contact that {fills}", allowed, remedy)
    if angle > HOLLOW[0]:
        HalfSpaceWarning.warn(
            f"Under {cause} the contact {fills}, more than {HOLLOW[0]:g}: the plane of the half-space makes "
            f"forces too large by about {percent(FORCE_LOST * angle**2)}. {lighter}."
        )


def _slender(a: float, radius: float, direction: str, cause: str, lighter: str) -> None:
    axis = f"a semi-axis of {rounded(a / radius, 2)} R {direction}"
    remedy = f"{lighter}, or take a larger body."
    allowed = "at most R/3, where the body is an elastic half-space"
    require(a <= SLENDER[1] * radius, "contact", f"{cause}, {axis}", allowed, remedy)
    if a > SLENDER[0] * radius:
        HalfSpaceWarning.warn(
            f"Under {cause} the contact has {axis}, above 0.1 R: the elastic half-space overestimates the "
            f"stiffness by some per cent. {lighter}."
        )


# --- a contact that sticks

ANGLES = 1024
"""Of the trapezoidal rule around the contact, which is exact for ellipses up to 1:50."""


def stick_stiffness(semi_axes: tuple[float, float], materials: tuple[Material, Material]) -> float:
    """Lateral force per lateral approach of two bodies that stick all over an elliptic contact, N/m.

    Parameters
    ----------
    semi_axes : (float, float)
        Along and across the path, m: the force acts across it.
    materials : (Material, Material)
        Of both bodies.

    Returns
    -------
    float
        1/Σ c of the compliances c = ∫₀^2π R(θ) (1 − ν cos²θ) dθ/(8π G a b) of both bodies, with the radius
        R of the ellipse at an angle θ from the path.

    Raises
    ------
    InputError
        If a semi-axis is not positive.

    Notes
    -----
    R. D. Mindlin, J. Appl. Mech. 16 (1949) 259: the traction T/(2πab √(1 − x²/a² − y²/b²)) moves the contact
    as a whole; here by Cerruti's solution in its middle. Of two like bodies on a circle it is
    2(1 − ν)/(2 − ν) of the normal stiffness. Without slip at the edge, where the traction is infinite, and
    without what rolling lets creep: stiffer than a contact that rolls on, most at low frequency.
    """
    along, across = (positive("semi-axis of the contact (m)", each) for each in semi_axes)
    angle = 2.0 * np.pi * np.arange(ANGLES) / ANGLES
    radius: Array = 1.0 / np.hypot(np.cos(angle) / along, np.sin(angle) / across)
    compliance = 0.0
    for material in materials:
        shear = 0.5 * material.youngs_modulus / (1.0 + material.poisson_ratio)
        mean = np.mean(radius * (1.0 - material.poisson_ratio * np.cos(angle) ** 2))
        compliance += float(mean) / (4.0 * shear * along * across)
    return 1.0 / compliance
