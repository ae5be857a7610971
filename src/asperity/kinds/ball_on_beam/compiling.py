"""Compiles what steps a ball over a beam."""

from __future__ import annotations

import numpy as np

from asperity.kernels import several, waves
from asperity.kinds.ball_on_beam.roll import roll_ball
from asperity.laws import HertzLaw
from asperity.progress import Progress
from asperity.reduction.texture import StateTexture
from asperity.reference.materials import material
from asperity.scenarios import compiling
from asperity.structures.beam import Beam
from asperity.structures.body import Ball


def compile_kernels(progress: Progress) -> None:
    """Call every kernel once on next to nothing, see `asperity.scenarios.compiling`."""
    compiling.call_kernels(progress, (several.roll_contacts, waves.turn_on), roll_a_ball)


def roll_a_ball() -> None:
    """Roll a ball a few steps over a line."""
    steel = material("steel")
    beam, ball = Beam.rectangular(1.0, 0.05, 0.01, steel, highest_frequency=100.0), Ball(0.025, steel)
    law = HertzLaw(1e10, StateTexture.unfiltered(np.zeros(8), 0.2))
    roll_ball(beam, ball, law, speed=1.0, start=0.5, duration=1e-4, time_step=1e-5, sensors=[0.5])
