"""What rolling a ball over a beam takes, from a few steps of it."""

from __future__ import annotations

from typing import Any

import numpy as np

from asperity.kinds.ball_on_beam.roll import roll_ball
from asperity.laws import HertzLaw
from asperity.reduction.texture import StateTexture
from asperity.scenarios.preparing import PreparedCase
from asperity.scenarios.trial import STEPS, timed


def records(case: Any) -> int:
    """Histories that a law leaves behind."""
    return 4 + len(case.beam.sensor_positions)


def step_seconds(prepared: PreparedCase) -> float:
    """Time of a step of smooth bodies over a smooth path, s."""
    case: Any = prepared.case
    beam, ball = prepared.bodies.beam, prepared.bodies.ball
    law = HertzLaw(prepared.shape.hertz.stiffness_constant, StateTexture.unfiltered(np.zeros(8), 1e3, -4e3))
    middle, duration = 0.5 * beam.length, min(STEPS * case.time_step, 0.4 * beam.length / case.speed)
    _, taken = timed(
        lambda: roll_ball(
            beam, ball, law, speed=case.speed, start=middle, duration=duration,
            time_step=case.time_step, sensors=[middle] * len(case.beam.sensor_positions),
        )
    )  # fmt: skip
    return taken / max(1.0, duration / case.time_step)
