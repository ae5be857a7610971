"""What rolling a ball over a beam takes, from a few steps of it."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray
from xarray import DataTree

from asperity.kinds.ball_on_beam import schema
from asperity.kinds.ball_on_beam.bodies import highest_mode
from asperity.kinds.ball_on_beam.case import BallOnBeam
from asperity.kinds.ball_on_beam.roll import roll_ball
from asperity.laws import HertzLaw
from asperity.reduction.texture import StateTexture
from asperity.scenarios.measure import A_WEIGHTED, ACCELERATION, Measure, a_weighted, density_of
from asperity.scenarios.preparing import PreparedCase
from asperity.scenarios.refining import Setting, Way
from asperity.scenarios.trial import STEPS, timed
from asperity.units import written


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


def settings_of(case: BallOnBeam) -> list[Setting]:
    """Modes up to twice the frequency."""
    before, after = highest_mode(case), 2.0 * highest_mode(case)
    words = f"up to {written(before, 'Hz', 'kHz')} → up to {written(after, 'Hz', 'kHz')}"
    return [Setting("modes", (Way(words, {"beam.modes_up_to": after}),), scans_kept=True)]


_MEANING = "acceleration level of the beam, energy mean over its sensors"


def _acceleration(tree: DataTree, law: str) -> NDArray[np.float64]:
    return density_of(tree, schema.ACCELERATION_PSD, law) / schema.ACCELERATION_REFERENCE**2


MEASURES = {
    A_WEIGHTED: Measure(f"{_MEANING}, A-weighted", "dB(A) re 1e-6 m/s²", a_weighted(_acceleration)),
    ACCELERATION: Measure(_MEANING, "dB re 1e-6 m/s²", _acceleration),
}
