"""Compiles what steps a wheel on a rail."""

from __future__ import annotations

import numpy as np

from asperity.kernels import rail, several
from asperity.kinds.wheel_on_rail.roll import roll_wheel
from asperity.laws import HertzLaw
from asperity.progress import Progress
from asperity.reduction.texture import StateTexture
from asperity.scenarios import compiling
from asperity.structures.moving_kernel import MovingKernel
from asperity.structures.rail_poles import RailPoles
from asperity.structures.track import Track
from asperity.structures.wheel import Wheel


def compile_kernels(progress: Progress) -> None:
    """Call every kernel once on next to nothing, see `asperity.scenarios.compiling`."""
    compiling.call_kernels(progress, (several.roll_contacts, rail.preload_channels), roll_a_wheel)


def roll_a_wheel() -> None:
    """Roll a wheel a few steps, on a scattered rail and on one of poles."""

    wheel = Wheel.rigid(600.0, 65e3)
    kernel = MovingKernel(Track.named("nordborg"), 1.0, 1e-6, np.full((4, 4), 1e-12))
    poles = RailPoles(kernel, np.array([0.5 + 0.1j]), np.full((4, 1), 1e-12 + 0j), 0.0, 0.0)
    rails: list[RailPoles | MovingKernel] = [kernel, poles]
    for each in rails:
        law = HertzLaw(1e11, StateTexture.unfiltered(np.zeros(8), 0.2))
        roll_wheel(each, wheel, law, start=0.0, duration=4e-6, settling=0.0)
