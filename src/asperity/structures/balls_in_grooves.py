"""Balls between the grooves of two rings: sizes, gaps, contacts, and tones of their faults."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, ClassVar, Literal

from asperity.arguments import real, require
from asperity.contact.gothic_arch import GothicArch
from asperity.contact.hertz import Hertz, in_groove
from asperity.parameters import (
    LENGTH,
    PRESSURE,
    Choice,
    MaterialOrName,
    Number,
    Quantity,
    checked_parameters,
    optional_parameter,
    parameter,
    usual_parameter,
)
from asperity.reference.materials import Material, contact_modulus
from asperity.structures.rolling_bearing import GAP, HARD, RollingBearing
from asperity.written_numbers import rounded

if TYPE_CHECKING:
    from asperity.diagnostics import Tone

STATIC_PRESSURE = 4.2e9
"""Peak pressure, Pa, from which on a dent of about 1/10 000 of the ball's diameter remains (ISO 76:2006)."""
_CONFORMITY = Number(above=0.5, at_most=1.0)
_USUAL = "0.505 to 0.7: grooves lie between"
_LOADS = "0 N to 100 MN: bearings carry less"
_ANGLE = Quantity("rad", at_least=0)
_ANGLES = "0 deg to 80 deg: balls touch both grooves between"


@dataclass(frozen=True)
class BallsInGrooves(RollingBearing):
    """Geometry and contacts of a `BallBearing`, whose parameters these are."""

    ELEMENT = "ball"
    LEFT_OUT: ClassVar = (
        "There is no film of lubricant, no friction in the motion, no shoulder of a groove, and no tilt of a "
        "ring; the contact angle is that of the static load."
    )
    """What no computation of it has."""
    LEFT_OUT_OILED: ClassVar = (
        "Contacts are full of oil; there is no friction in the motion, no shoulder of a groove, and no tilt "
        "of a ring; contact angle and static loads are those without oil."
    )
    """What none with oil has."""
    SOURCE: ClassVar = "H. Hertz, J. reine angew. Math. 92 (1882) 156 (contact of smooth bodies)."
    """Of its contacts."""

    balls: int = parameter(
        Number(at_least=3, whole=True), 9, "number of balls", "3 to 500: bearings lie between"
    )
    ball_diameter: float = parameter(
        LENGTH, "7.94 mm", "diameter of a ball", "0.1 mm to 1 m: balls lie between"
    )
    pitch_diameter: float = parameter(
        LENGTH,
        "39.04 mm",
        "diameter of the circle of the balls' centres",
        "1 mm to 10 m: bearings lie between",
    )
    # where none is printed; 0.515 to 0.53 is usual
    inner_conformity: float = usual_parameter(
        _CONFORMITY, 0.52, "groove radius of the inner ring over ball diameter", _USUAL
    )
    outer_conformity: float = usual_parameter(
        _CONFORMITY, 0.52, "groove radius of the outer ring over ball diameter", _USUAL
    )
    clearance: float | None = optional_parameter(
        Quantity("m"), "10 um", "diametral clearance; below zero the balls are pressed", GAP
    )
    contact_angle: float | None = optional_parameter(
        _ANGLE, "15 deg", "free contact angle, instead of the clearance", _ANGLES
    )
    arch_angle: float | None = optional_parameter(
        Quantity("rad", above=0),
        "35 deg",
        "angle at which a ball touches both flanks of each groove, a gothic arch",
        _ANGLES,
        otherwise="grooves of one arc",
    )
    preload: float = usual_parameter(
        Quantity("N", at_least=0), "0 N", "constant axial force, as of a spring", _LOADS
    )
    # of hardened rings about 700 HV, chosen here
    hardness: float = usual_parameter(PRESSURE, "7 GPa", "hardness of the rings", HARD)
    material: Material = usual_parameter(  # noqa: RUF009
        MaterialOrName(), "steel", "material of the rings"
    )
    ball_material: Material = usual_parameter(  # noqa: RUF009
        MaterialOrName(), "steel", "material of the balls"
    )
    turning: Literal["inner", "outer"] = usual_parameter(
        Choice(("inner", "outer")), "inner", "the ring that turns"
    )

    def __post_init__(self) -> None:
        checked_parameters(self)
        self.check_room()
        for other in ("clearance", "arch_angle"):
            both = getattr(self, other) is not None and self.contact_angle is not None
            require(not both, "bearing", f"both {other} and contact_angle", "one of them", "Remove one.")
        if self.arch_angle is not None:
            allowed = "an angle above 0, up to 1.4 rad (80 deg)"
            real("arch_angle (rad)", self.arch_angle, allowed, above=0.0, at_most=1.4)
        if self.contact_angle is not None:
            allowed = "an angle from 0 to 1.4 rad (80 deg)"
            real("contact_angle (rad)", self.contact_angle, allowed, at_least=0.0, at_most=1.4)
            return
        most = 0.5 * self.groove_distance
        remedy = "Is the unit right? Or give larger conformities."
        clearance = self.radial_clearance
        allowed = f"less than {rounded(most * 1e6, 4)} µm, where the balls touch at 41 deg"
        require(clearance < most, "clearance", f"{rounded(clearance * 1e6, 4)} µm", allowed, remedy)
        if clearance < 0.0:
            load = self.series_stiffness * (-0.5 * clearance) ** 1.5
            contacts = self.inner_contact, self.outer_contact
            peak = max(each.pressure_under(load) for each in contacts)
            # it grows with the root of the overlap
            elastic = -1e6 * clearance * (STATIC_PRESSURE / peak) ** 2
            received = (
                f"{rounded(clearance * 1e6, 4)} µm, which presses the balls with "
                f"{rounded(peak / 1e9)} GPa unloaded"
            )
            allowed = (
                f"-{rounded(elastic)} µm or more, {STATIC_PRESSURE / 1e9:g} GPa, where dents begin (ISO 76)"
            )
            require(peak <= STATIC_PRESSURE, "clearance", received, allowed, "Take a looser fit.")

    @property
    def groove_distance(self) -> float:
        """Distance of the centres of both grooves where the ball touches both, A = r_i + r_o − D, m."""
        return (self.inner_conformity + self.outer_conformity - 1.0) * self.ball_diameter

    @property
    def radial_clearance(self) -> float:
        """Diametral clearance P_d, m; that of the free contact angle is 2A (1 − cos α)."""
        if self.contact_angle is not None:
            return 2.0 * self.groove_distance * (1.0 - math.cos(self.contact_angle))
        return 0.0 if self.clearance is None else self.clearance

    @property
    def free_angle(self) -> float:  # type: ignore[override]
        """Contact angle without load, rad: cos α = 1 − P_d/2A, zero of one without clearance.

        Of arches cos α = cos α_g − P_d/2A, with that of the flanks, α_g: of a ball that an axial load presses
        between two of them.
        """
        return math.acos(min(1.0, self.centres_apart / self.groove_distance))

    @property
    def centres_apart(self) -> float:
        """Radial distance of the centres of both grooves, rings centred, m: A cos α_g − P_d/2."""
        touching = self.groove_distance * math.cos(self.arch_angle or 0.0)
        return touching - 0.5 * self.radial_clearance

    @cached_property
    def arches(self) -> tuple[GothicArch, ...]:
        """Sections of the inner and the outer groove, where they have two arcs; else none."""
        if self.arch_angle is None:
            return ()
        D = self.ball_diameter
        radii = self.inner_conformity * D, self.outer_conformity * D
        return tuple(GothicArch.at_angle(self.arch_angle, 0.5 * D, each) for each in radii)

    def apart(self, contact_angle: float) -> float:
        """Gap of both contacts of a ball together, rings centred, along their normal at an angle, rad; m.

        A − (A − P_d/2) cos α: half the diametral clearance of balls that touch at 0, and none axially. Of
        arches, with centres A sin α_g apart along the axis, A − (A cos α_g − P_d/2) cos α − A sin α_g sin α.
        """
        distance = self.groove_distance
        along = distance * math.sin(self.arch_angle or 0.0)
        return distance - self.centres_apart * math.cos(contact_angle) - along * math.sin(contact_angle)

    @cached_property
    def inner_contact(self) -> Hertz:
        """Contact of a ball and the inner ring."""
        return self._contact(self.inner_conformity, self.raceway_radii[0])

    @cached_property
    def outer_contact(self) -> Hertz:
        """Contact of a ball and the outer ring, in which it lies."""
        return self._contact(self.outer_conformity, -self.raceway_radii[1])

    def _contact(self, conformity: float, raceway: float) -> Hertz:
        """Contact in a groove: normal to its surface a raceway of radius R has R/cos α along the path."""
        modulus = contact_modulus(self.material, self.ball_material)
        D = self.ball_diameter
        return in_groove(modulus, 0.5 * D, conformity * D, raceway / math.cos(self.free_angle))

    @property
    def series_stiffness(self) -> float:
        """Q/δ^1.5 of both contacts of a ball in series, N/m^1.5."""
        both = (self.inner_contact, self.outer_contact)
        return float(sum(each.stiffness_constant ** (-2.0 / 3.0) for each in both) ** -1.5)

    def interference_force(self, overlap: float) -> float:
        """Force of a ball between rings that overlap along its normal, m; N."""
        return float(self.series_stiffness * overlap**1.5)

    @property
    def ball_mass(self) -> float:  # type: ignore[override]
        """Mass of a ball, kg."""
        return math.pi / 6.0 * self.ball_diameter**3 * self.ball_material.density

    def tones(self, axial: bool = False) -> dict[str, Tone]:
        """Tones of faults of its parts per turn, and how far contact angle and slip may move them.

        Parameters
        ----------
        axial : bool
            Whether it carries an axial load, so that the balls touch at the free angle. It does where it has
            a preload, or is described by a contact angle.

        Returns
        -------
        dict
            `asperity.diagnostics.Tone` of ``"outer"``, ``"inner"`` and ``"ball"``: in pure rolling at that
            angle, or of a radial load at 0 or that of the flanks, with limits from 10 degrees less to 5 more
            than the free angle, 15 degrees at least, and for a cage that lags by up to 1 %.
        """
        pressed = axial or self.preload > 0.0 or self.contact_angle is not None
        angle = self.free_angle if pressed else (self.arch_angle or 0.0)
        least = max(angle - math.radians(10.0), 0.0)
        most = max(self.free_angle + math.radians(5.0), math.radians(15.0))
        return self.tones_between(angle, least, most)
