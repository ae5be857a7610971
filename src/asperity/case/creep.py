"""How what rolls creeps over what it rolls over, and how friction falls where it slips."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import TYPE_CHECKING, Any

from asperity.case.form import Section
from asperity.errors import InputError
from asperity.parameters import ANGLE, Number, Quantity, key, optional

if TYPE_CHECKING:
    from asperity.contact.friction import Friction

_ANY = "angle_of_attack or longitudinal or lateral or spin"
MOST_CREEPAGE = 0.1
"""Creepages are small."""
_CREEPAGE = Number(at_least=-MOST_CREEPAGE, at_most=MOST_CREEPAGE)
_NONE = "none"


def _kinetic(coefficient: str, goes_with: str = "") -> Any:
    meaning = f"share of {coefficient} that is left in slip"
    return key(Number(at_least=0, at_most=1), 1.0, meaning, goes_with=goes_with)


def _falling_velocity(goes_with: str = "") -> Any:
    return optional(
        Quantity("m/s", above=0),
        "0.5 m/s",
        "slip velocity over which friction falls to that share, by exp(-v/falling_velocity)",
        "it falls at once",
        "1 mm/s to 100 m/s: nothing else is known",
        goes_with=goes_with,
    )


class FallingFriction(Section):
    """How friction falls where a contact slips."""

    if TYPE_CHECKING:
        kinetic: float
        falling_velocity: float | None

    def law(self, coefficient: float) -> Friction:
        """Friction of a coefficient up to which a contact sticks."""
        from asperity.contact.friction import Friction

        return Friction(coefficient, self.kinetic, self.falling_velocity)

    def problems(self) -> Iterator[InputError]:
        """Friction that falls over a velocity falls."""
        if self.falling_velocity is not None and self.kinetic == 1.0:
            yield InputError(
                "falling_velocity", "friction that stays", "kinetic below 1", "As kinetic = 0.5."
            )


class BallCreepKeys(FallingFriction):
    """Friction of balls that creep in their grooves, as their rolling has it; they stick up to friction."""

    kinetic: float = _kinetic("friction")
    falling_velocity: float | None = _falling_velocity()


class CreepKeys(FallingFriction):
    """Creepages of what rolls over what it rolls over; the contact sticks up to contact.friction."""

    angle_of_attack: float | None = optional(
        ANGLE,
        "8 mrad",
        "angle from the path to where what rolls heads, to the field side; minus its tangent adds to lateral",
        _NONE,
        "-100 mrad to 100 mrad: creepages are small",
    )
    longitudinal: float | None = optional(
        _CREEPAGE,
        0.001,
        "velocity over the surface over that of rolling, along; positive: it brakes",
        _NONE,
    )
    lateral: float | None = optional(
        _CREEPAGE, -0.002, "the same across, to the field side, beside that of an angle of attack", _NONE
    )
    spin: float | None = optional(
        Quantity("rad/m"),
        "0.1 rad/m",
        "turning about the normal, from along to the field side, per length rolled",
        _NONE,
        "-1e4 rad/m to 1e4 rad/m: what rolls does not pivot",
    )
    kinetic: float = _kinetic("contact.friction", _ANY)
    falling_velocity: float | None = _falling_velocity(_ANY)
    wear: float | None = optional(
        Quantity("m^3/J", above=0),
        "7e-4 mm^3/J",
        "volume that friction takes from what is rolled over, over its work",
        "nothing wears",
        "1e-9 mm^3/J to 1 mm^3/J: materials lie between",
        goes_with=_ANY,
    )

    @property
    def creepage(self) -> tuple[float, float, float]:
        """Of what rolls along, to the field side, and spin, rad/m; all zero where the case gives none."""
        across = (self.lateral or 0.0) - math.tan(self.angle_of_attack or 0.0)
        return self.longitudinal or 0.0, across, self.spin or 0.0
