"""A ball rolls over a beam."""

from __future__ import annotations

from typing import Any

from numpy.typing import ArrayLike

from asperity.laws.base import Law
from asperity.rolling.roll import FirstContact, first_contact, roll_bodies
from asperity.structures.beam import Beam
from asperity.structures.body import Ball, Body


def roll_ball(beam: Beam, ball: Ball, law: Law, *, sensors: ArrayLike, **path: Any) -> FirstContact:
    """Roll a ball over a beam at constant speed, and keep what follows the run-in.

    Sensors (k,) on the beam, m; all else as of `asperity.rolling.roll.roll_bodies`, of which this is one
    rigid body.
    """
    body = Body.rigid(ball.mass, ball.static_load)
    return first_contact(roll_bodies(beam, [body], [law], positions=[0.0], sensors=sensors, **path))
