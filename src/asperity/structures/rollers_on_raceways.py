"""Rollers between the raceways of two rings: sizes, crowning, contacts along lines, tones of their faults."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, ClassVar, Literal

import numpy as np

from asperity.arguments import Array, ArrayLike, require
from asperity.contact.crowning import FORMS, OF_DIAMETER, Crowning, Form
from asperity.contact.hertz import relative_radius
from asperity.contact.slices import FEWEST, SLICES, SlicedContact
from asperity.parameters import (
    LENGTH,
    LENGTH_OR_ZERO,
    PRESSURE,
    STIFFNESS,
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
from asperity.units import written
from asperity.written_numbers import rounded

if TYPE_CHECKING:
    from asperity.diagnostics import Tone

STEEPEST_TILT = 0.1
"""Of a ring, rad, below which it is."""
_LEFT_OUT = (
    "no friction in the motion, and no rib but that of tapered rollers; while it turns rings are held at "
    "their tilt, rollers at half of it; slices of a roller do not know of each other, nor of sharp ends"
)


@dataclass(frozen=True)
class RollersOnRaceways(RollingBearing):
    """Geometry and contacts of a `RollerBearing`, whose parameters these are."""

    ELEMENT = "roller"
    LEFT_OUT: ClassVar = f"There is no film of lubricant, {_LEFT_OUT}."
    """What no computation of it has."""
    LEFT_OUT_OILED: ClassVar = (
        f"Contacts are full of oil; there is {_LEFT_OUT}; static loads are those without oil, and all "
        "contacts with a ring have one damping, that under its heaviest load."
    )
    """What none with oil has."""
    SOURCE: ClassVar = "ISO/TS 16281:2008 (load and stiffness of rollers by slices)."
    """Of its contacts."""

    rollers: int = parameter(
        Number(at_least=3, whole=True), 13, "number of rollers", "3 to 500: bearings lie between"
    )
    roller_diameter: float = parameter(
        LENGTH, "7.5 mm", "diameter of a roller", "0.1 mm to 1 m: rollers lie between"
    )
    roller_length: float = parameter(
        LENGTH, "7.8 mm", "length along which a roller carries", "0.1 mm to 2 m: rollers lie between"
    )
    pitch_diameter: float = parameter(
        LENGTH,
        "39 mm",
        "diameter of the circle of the rollers' centres",
        "1 mm to 10 m: bearings lie between",
    )
    contact_angle: float = usual_parameter(
        Quantity("rad", at_least=0, at_most=1.4),
        "0 deg",
        "angle of the raceways to the axis; 0 of cylindrical rollers",
        "0 deg to 80 deg: radial bearings lie between",
    )
    taper: float = parameter(
        Quantity("rad", at_least=0, at_most=0.35),
        "4 deg",
        "angle between opposite sides of tapered rollers",
        "0 deg to 20 deg: tapered rollers lie between",
        default=0.0,
    )
    rib_stiffness: float | None = optional_parameter(
        STIFFNESS,
        "300 MN/m",
        "stiffness of the end of a tapered roller on the rib",
        "1 N/m to 1 TN/m: softer holds nothing, harder is rigid",
        otherwise="the rib is rigid",
        goes_with="taper",
    )
    rib_height: float | None = optional_parameter(
        LENGTH,
        "1 mm",
        "how far above the inner raceway the rib touches the end of a tapered roller",
        "10 um to 0.1 m: ribs lie between",
        otherwise="friction on the rib is not looked at",
        goes_with="taper",
    )
    clearance: float = parameter(
        Quantity("m"), "20 um", "diametral clearance; below zero the rollers are pressed", GAP, default=0.0
    )
    crowning: Form = usual_parameter(  # noqa: RUF009
        Choice(FORMS), "logarithmic", "form of the rollers along their length"
    )
    crowning_drop: float | None = optional_parameter(
        LENGTH_OR_ZERO,
        "2.6 um",
        "how far they fall back at the ends; of logarithmic ones the factor of the logarithm",
        "1 nm to 1 mm: crownings lie between",
        otherwise="0 of cylindrical rollers, and 0.00035 diameters of others",
    )
    crowning_straight: float = usual_parameter(
        LENGTH_OR_ZERO,
        "0 mm",
        "length of the straight middle of a partial crowning",
        "0 mm to 1 m: rollers lie between",
    )
    slices: int = usual_parameter(
        Number(at_least=FEWEST, at_most=1000, whole=True),
        SLICES,
        "slices along a roller",
    )
    # of hardened rings about 700 HV, chosen here
    hardness: float = usual_parameter(PRESSURE, "7 GPa", "hardness of the rings", HARD)
    material: Material = usual_parameter(  # noqa: RUF009
        MaterialOrName(), "steel", "material of the rings"
    )
    roller_material: Material = usual_parameter(  # noqa: RUF009
        MaterialOrName(), "steel", "material of the rollers"
    )
    turning: Literal["inner", "outer"] = usual_parameter(
        Choice(("inner", "outer")), "inner", "the ring that turns"
    )

    def __post_init__(self) -> None:
        checked_parameters(self)
        self.check_room()
        D = self.roller_diameter
        received = f"{rounded(self.clearance * 1e6, 4)} µm"
        allowed = f"less than {rounded(D * 1e5)} µm, a tenth of the roller's diameter, to either side"
        require(abs(self.clearance) < 0.1 * D, "clearance", received, allowed, "Is the unit right?")
        received = f"{rounded(math.degrees(self.contact_angle), 4)}° of rollers that taper"
        allowed = (
            f"more than their taper, {rounded(math.degrees(self.taper), 4)}°: the inner raceway is a cone"
        )
        cone = not self.taper or self.contact_angle > self.taper
        require(cone, "contact_angle", received, allowed, "Give both, or no taper.")
        for name in ("rib_stiffness", "rib_height"):
            held = getattr(self, name) is None or self.taper > 0.0
            received = "one of rollers that do not taper"
            remedy = "Give a taper, or leave it out."
            require(held, name, received, "none", remedy)
        height = self.rib_height or 0.0
        received = f"{rounded(1e3 * height, 4)} mm"
        allowed = f"less than half a roller's {D * 1e3:.4g} mm"
        require(height < 0.5 * D, "rib_height", received, allowed, "It counts from the inner raceway.")
        _ = self.profile  # checks the crowning

    @cached_property
    def profile(self) -> Crowning:
        """How far the rollers fall back along their length."""
        drop = self.crowning_drop
        if drop is None:
            drop = 0.0 if self.crowning == "cylindrical" else OF_DIAMETER * self.roller_diameter
        return Crowning(self.crowning, self.roller_length, drop, self.crowning_straight)

    @cached_property
    def inner_contact(self) -> SlicedContact:
        """Contact of a roller and the inner ring."""
        return self._contact(self.raceway_radii[0])

    @cached_property
    def outer_contact(self) -> SlicedContact:
        """Contact of a roller and the outer ring, in which it lies."""
        return self._contact(-self.raceway_radii[1])

    def _contact(self, raceway: float) -> SlicedContact:
        """Contact on a raceway: normal to its surface one of radius R has R/cos α along the path."""
        modulus = contact_modulus(self.material, self.roller_material)
        along = raceway / math.cos(self.contact_angle)
        radius = relative_radius(0.5 * self.roller_diameter, along, what="radii of roller and raceway (m)")
        return SlicedContact(modulus, radius, self.profile, self.slices)

    @property
    def roller_mass(self) -> float:
        """Mass of a roller of its effective length, kg."""
        return 0.25 * math.pi * self.roller_diameter**2 * self.roller_length * self.roller_material.density

    @property
    def half_taper(self) -> float:
        """Angle β of a roller's sides to its axis, rad: half the taper."""
        return 0.5 * self.taper

    @property
    def pushed_along(self) -> float:
        """Share sin β of a contact's force that pushes a roller along its axis, β half its taper."""
        return math.sin(self.half_taper)

    @property
    def flung_along(self) -> float:
        """Centrifugal force along the axis of a tapered roller over that along its normal."""
        along = math.sin(self.contact_angle - self.half_taper) / self.flung_outwards(self.contact_angle)
        return along if self.taper else 0.0

    @property
    def rib(self) -> str:
        """What holds tapered rollers along their axes, and at which height, in words."""
        stiffness = self.rib_stiffness
        told = "rigid" if stiffness is None else f"a spring of {written(stiffness, 'N/m', 'MN/m')}"
        height = self.rib_height
        return told if height is None else f"{told}, {written(height, 'm', 'mm')} above the inner raceway"

    def rib_force(self, inner: Array, outer: Array, lift: ArrayLike = 0.0) -> Array:
        """Force of the rib on tapered rollers along their axis.

        Parameters
        ----------
        inner, outer : ndarray (…,)
            Forces of the contacts of rollers, N.
        lift : array_like
            Centrifugal force along their normal, N.

        Returns
        -------
        ndarray (…,)
            N; zero of rollers that do not taper.
        """
        return self.pushed_along * (inner + outer) + self.flung_along * np.asarray(lift)

    @property
    def rib_lever(self) -> float:
        """How far a roller's end slides on the rib as one ring turns against the other, m/rad, or NaN.

        So much torque on the rings balances the friction of an end. Rollers turn against the inner ring about
        the line of their contact, from which the rib is h away: by f_i − f_c about the axis of the bearing
        and by their spin f_s about their own. With magnitudes of the differences together they are
        h ((f_i − f_c) cos(α − β) + f_s)/(f_i − f_o), which is h sin α/(2 sin β) of cones with one apex.
        """
        if self.rib_height is None:
            return math.nan
        turning = self.kinematics(1.0)
        about_bearing = abs(turning.inner - turning.cage) * math.cos(self.contact_angle - 0.5 * self.taper)
        return self.rib_height * (about_bearing + turning.spin)

    def interference_force(self, overlap: float) -> float:
        """Force of a roller between raceways that overlap along its normal, m; N."""
        return self.inner_contact.force(0.5 * overlap)

    # --- by the names that whatever rolls in a bearing has

    @property
    def balls(self) -> int:  # type: ignore[override]
        """Number of rollers."""
        return self.rollers

    @property
    def ball_diameter(self) -> float:  # type: ignore[override]
        """Diameter of a roller, m."""
        return self.roller_diameter

    @property
    def ball_mass(self) -> float:  # type: ignore[override]
        """Mass of a roller, kg."""
        return self.roller_mass

    @property
    def free_angle(self) -> float:  # type: ignore[override]
        """Contact angle, rad: that of the raceways."""
        return self.contact_angle

    @property
    def radial_clearance(self) -> float:
        """Diametral clearance, m."""
        return self.clearance

    @property
    def preload(self) -> float:
        """Constant axial force, N: none."""
        return 0.0

    def apart(self, contact_angle: float) -> float:
        """Gap of both contacts of a roller, rings centred, along their normal at an angle, rad; m."""
        return 0.5 * self.clearance * math.cos(contact_angle)

    def tones(self, axial: bool = False) -> dict[str, Tone]:
        """Tones of faults of its parts per turn, and how far slip may move them.

        Parameters
        ----------
        axial : bool
            Whether it carries an axial load, which leaves the angle of its contacts as it is.

        Returns
        -------
        dict
            As of `BallBearing.tones`, of raceways whose angle stays: for a cage that lags by up to 1 %.
        """
        return self.tones_between(*[self.contact_angle] * 3)
