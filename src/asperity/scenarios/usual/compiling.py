"""Compiles what steps any two bodies."""

from __future__ import annotations

import numpy as np

from asperity.kernels import modal, waves
from asperity.laws import HertzLaw
from asperity.progress import Progress
from asperity.reduction.texture import StateTexture
from asperity.reference.materials import material
from asperity.rolling.ball import RollingBall
from asperity.rolling.beam import RolledBeam
from asperity.rolling.pair import roll_pair
from asperity.scenarios import compiling
from asperity.structures.beam import Beam
from asperity.structures.body import Ball


def compile_kernels(progress: Progress) -> None:
    """Call every kernel once on next to nothing, see `asperity.scenarios.compiling`."""
    compiling.call_kernels(progress, (modal.solve_step, waves.turn_on), roll_a_pair)


def roll_a_pair() -> None:
    """Roll one body a few steps over another."""
    steel = material("steel")
    beam, ball = Beam.rectangular(1.0, 0.05, 0.01, steel, highest_frequency=100.0), Ball(0.025, steel)
    law = HertzLaw(1e10, StateTexture.unfiltered(np.zeros(8), 0.2))
    bodies = RolledBeam(beam), RollingBall(ball)
    roll_pair(*bodies, law, speed=1.0, start=0.5, duration=1e-4, time_step=1e-5)
