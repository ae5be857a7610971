"""Compiles what steps bodies on several contacts."""

from __future__ import annotations

import numpy as np

from asperity.kernels import several, waves
from asperity.laws import HertzLaw
from asperity.progress import Progress
from asperity.reduction.texture import StateTexture
from asperity.reference.materials import material
from asperity.rolling.several import roll_bodies
from asperity.scenarios import compiling
from asperity.structures.beam import Beam
from asperity.structures.body import Body


def compile_kernels(progress: Progress) -> None:
    """Call every kernel once on next to nothing, see `asperity.scenarios.compiling`."""
    compiling.call_kernels(progress, (several.roll_contacts, waves.turn_on), roll_two)


def roll_two() -> None:
    """Roll two masses a few steps over a beam."""
    beam = Beam.rectangular(1.0, 0.05, 0.01, material("steel"), highest_frequency=100.0)
    law = HertzLaw(1e10, StateTexture.unfiltered(np.zeros(8), 0.2))
    bodies = [Body.rigid(0.5, 5.0)] * 2
    laws, apart = [law] * 2, [0.0, 0.1]
    roll_bodies(beam, bodies, laws, speed=1.0, start=0.2, duration=1e-4, time_step=1e-5, positions=apart)
