"""One body rolls on one contact: a ball over a beam, a wheel along a track."""

from __future__ import annotations

from typing import Any

from numpy.typing import ArrayLike

from asperity.laws.base import Law
from asperity.rolling.roll import FirstContact, first_contact, roll_bodies
from asperity.structures.body import Ball, Body
from asperity.structures.modal import Modal
from asperity.structures.moving_kernel import MovingKernel
from asperity.structures.rail_poles import RailBetween, RailPoles
from asperity.structures.wheel import Wheel


def roll_ball(beam: Modal, ball: Ball, law: Law, *, sensors: ArrayLike, **path: Any) -> FirstContact:
    """Roll a ball over a beam at constant speed, and keep what follows the run-in.

    Sensors (k,) on the beam, m; all else as of `asperity.rolling.roll.roll_bodies`, of which this is one
    rigid body.
    """
    body = Body.rigid(ball.mass, ball.static_load)
    return first_contact(roll_bodies(beam, [body], [law], positions=[0.0], sensors=sensors, **path))


def roll_wheel(rail: RailPoles | MovingKernel, wheel: Wheel, law: Law, **path: Any) -> FirstContact:
    """Roll a wheel along a track at constant speed, and keep what follows the run-in.

    The track is given for one speed and time step, as poles, or scattered; the contact is at `start` at time
    zero, m from a sleeper. All else as of `asperity.rolling.roll.roll_bodies`, of which this is one body.
    """
    between = RailBetween(rail, {})
    kernel = between.kernel
    rolled = roll_bodies(
        between, [wheel.body], [law], positions=[0.0], speed=kernel.speed, time_step=kernel.time_step, **path
    )
    return first_contact(rolled)
