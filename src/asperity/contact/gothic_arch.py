"""A groove of two arcs, and a ball between two of them: two inclined contacts of Hertz on each, or one."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from asperity.arguments import Array, positive, require
from asperity.contact.hertz import Hertz, in_groove
from asperity.written_numbers import rounded

FARTHEST = 0.1
"""Displacement over the distance of the centres of ball and arc, up to which contact angles stay."""


@dataclass(frozen=True)
class GothicArch:
    """Section of a groove of two equal arcs whose centres lie on either side of its middle.

    Each flank is the arc whose centre lies beyond the middle, so that the groove is narrower than one of a
    single arc, and a ball touches both flanks and not the bottom.

    Parameters
    ----------
    ball_radius : float
        R, m.
    groove_radius : float
        Of each arc, r, m: greater than that of the ball, as 0.52 to 0.55 ball diameters.
    offset : float
        Of the centre of each arc from the middle, e, m.

    Raises
    ------
    InputError
        If a number is out of range, or the ball does not touch both flanks.

    Notes
    -----
    The centres of ball and arc are r − R apart where the ball touches, e of that across: the contacts are at
    sin α = e/(r − R) on either side of the middle.

    Examples
    --------
    >>> import math
    >>> from asperity import GothicArch
    >>> arch = GothicArch.at_angle(math.radians(45), ball_radius=2e-3, groove_radius=2.1e-3)
    >>> f"{arch.offset * 1e6:.1f} um, {arch.bottom_gap * 1e6:.1f} um below the ball"
    '70.7 um, 28.1 um below the ball'
    """

    ball_radius: float
    groove_radius: float
    offset: float

    def __post_init__(self) -> None:
        radius = positive("radius of the ball (m)", self.ball_radius)
        groove = positive("radius of the groove (m)", self.groove_radius)
        received = f"{rounded(1e3 * groove, 4)} mm"
        allowed = f"more than that of the ball, {rounded(1e3 * radius, 4)} mm"
        require(groove > radius, "radius of the groove", received, allowed)
        offset = positive("offset of the arcs (m)", self.offset)
        most = groove - radius
        allowed = f"less than {rounded(1e6 * most, 4)} µm, where the ball touches the edges of the groove"
        received = f"{rounded(1e6 * offset, 4)} µm"
        require(offset < most, "offset of the arcs", received, allowed, "Is the unit right?")

    @classmethod
    def at_angle(cls, contact_angle: float, ball_radius: float, groove_radius: float) -> GothicArch:
        """The arch on which a ball touches at an angle, rad, from the middle."""
        inside = 0.0 < contact_angle < 0.5 * math.pi
        require(inside, "contact_angle of the arch (rad)", contact_angle, "more than 0, less than π/2")
        return cls(ball_radius, groove_radius, math.sin(contact_angle) * (groove_radius - ball_radius))

    @property
    def contact_angle(self) -> float:
        """Angle α of both contacts from the middle, rad: sin α = e/(r − R)."""
        return math.asin(self.offset / (self.groove_radius - self.ball_radius))

    @property
    def bottom_gap(self) -> float:
        """How far the ball is from the bottom, where the arcs meet, m."""
        apart = math.cos(self.contact_angle) * (self.groove_radius - self.ball_radius)
        return math.sqrt(self.groove_radius**2 - self.offset**2) - apart - self.ball_radius

    @property
    def flank(self) -> float:
        """Length of the arc from the bottom to the middle of a contact, m."""
        return self.groove_radius * (self.contact_angle - math.asin(self.offset / self.groove_radius))

    def contact(self, modulus: float, raceway_radius: float = math.inf) -> Hertz:
        """Smooth contact of the ball with one flank.

        Parameters
        ----------
        modulus : float
            Contact modulus E*, Pa.
        raceway_radius : float
            Along the path, as of `asperity.contact.hertz.in_groove`, m; infinite for a guide.

        Returns
        -------
        Hertz
            Along its normal a raceway of radius R_r has R_r/cos α.
        """
        along = raceway_radius / math.cos(self.contact_angle)
        return in_groove(modulus, self.ball_radius, self.groove_radius, along)


@dataclass(frozen=True)
class FourPointBall:
    """A ball between two gothic arches that face each other, as of a rail and its carriage.

    Parameters
    ----------
    arch : GothicArch
        Of both grooves.
    lower, upper : Hertz
        Contacts with one flank of each, from `GothicArch.contact`.
    oversize : float
        By how much the ball is thicker than the room between opposite flanks, m; negative for a gap.

    Raises
    ------
    InputError
        If a number is out of range.

    Notes
    -----
    The normals of opposite flanks lie on one line through the ball, and both lines cross there: the ball is
    in balance only if both contacts of a line carry alike. Each line is two contacts of Hertz in series,
    F = K δ^1.5 with K^(−2/3) = K_l^(−2/3) + K_u^(−2/3), and where the arches come nearer by u and shift by v
    δ = oversize + u cos α ± v sin α. Four contacts carry, or two where one line is open. Angles stay as they
    are: displacements are small against r − R. There is no friction, by which such a ball slides.

    Examples
    --------
    >>> import math
    >>> from asperity import FourPointBall, GothicArch
    >>> arch = GothicArch.at_angle(math.radians(45), ball_radius=2e-3, groove_radius=2.1e-3)
    >>> ball = FourPointBall(arch, arch.contact(115e9), arch.contact(115e9), oversize=2e-6)
    >>> f"{ball.line_forces(0.0, 0.0)[0]:.1f} N, {ball.stiffness(0.0, 0.0)[0, 0] / 1e6:.1f} MN/m"
    '17.5 N, 13.1 MN/m'
    """

    arch: GothicArch
    lower: Hertz
    upper: Hertz
    oversize: float = 0.0

    @cached_property
    def line_stiffness(self) -> float:
        """K of both contacts of a line in series, N/m^1.5."""
        both = self.lower.stiffness_constant, self.upper.stiffness_constant
        return float(sum(each ** (-2.0 / 3.0) for each in both) ** -1.5)

    @cached_property
    def _lines(self) -> Array:
        """How each line is pressed by nearing and by shifting, (2, 2)."""
        sine = math.sin(self.arch.contact_angle)
        cosine = math.cos(self.arch.contact_angle)
        return np.array([[cosine, sine], [cosine, -sine]])

    def approaches(self, nearer: float, shifted: float) -> Array:
        """Approaches of both contacts of each line together, (2,), m; below zero where it is open.

        Parameters
        ----------
        nearer, shifted : float
            How far the arches come nearer, and shift across, m.

        Returns
        -------
        ndarray (2,)

        Raises
        ------
        InputError
            Of displacements by which contact angles change.
        """
        most = FARTHEST * (self.arch.groove_radius - self.arch.ball_radius)
        moved = math.hypot(nearer, shifted)
        received = f"{rounded(1e6 * moved, 4)} µm"
        allowed = (
            f"at most {rounded(1e6 * most)} µm, {FARTHEST:g} of what groove and ball differ by in radius"
        )
        require(moved <= most, "displacement of the arches", received, allowed, "Angles change beyond that.")
        return self.oversize + self._lines @ [nearer, shifted]

    def line_forces(self, nearer: float, shifted: float) -> Array:
        """Forces of both contacts of each line, (2,), N, at displacements as of `approaches`.

        Raises
        ------
        InputError
            Of contacts so wide that they reach the bottom of the arch, where the arcs meet.
        """
        forces = self.line_stiffness * np.maximum(self.approaches(nearer, shifted), 0.0) ** 1.5
        most = self.largest_force
        allowed = f"at most {rounded(most)} N, whose ellipse reaches the bottom of the arch"
        received = f"{rounded(forces.max(), 4)} N"
        require(forces.max() <= most, "force of a contact", received, allowed, "Take a wider contact angle.")
        return forces

    def forces(self, nearer: float, shifted: float) -> Array:
        """Forces against nearing and against shifting, (2,), N, at displacements as of `approaches`."""
        return self.line_forces(nearer, shifted) @ self._lines

    def stiffness(self, nearer: float, shifted: float) -> Array:
        """Derivative of `forces` by both displacements, (2, 2), N/m."""
        root = np.sqrt(np.maximum(self.approaches(nearer, shifted), 0.0))
        return self._lines.T @ (1.5 * self.line_stiffness * root[:, None] * self._lines)

    def contacts(self, nearer: float, shifted: float) -> int:
        """How many contacts carry: four, two, or none."""
        return 2 * int(np.count_nonzero(self.approaches(nearer, shifted) > 0.0))

    def opening_shift(self, nearer: float = 0.0) -> float:
        """Shift from which on one line is open and two contacts carry, m; 0 where both are."""
        closed = self.oversize + nearer * math.cos(self.arch.contact_angle)
        return max(closed, 0.0) / math.sin(self.arch.contact_angle)

    @property
    def largest_force(self) -> float:
        """Force of a contact at which its ellipse reaches the bottom of the arch, N."""
        axis = max(each.semi_axes_under(1.0)[1] for each in (self.lower, self.upper))
        return (self.arch.flank / axis) ** 3  # it grows with the third root of the force
