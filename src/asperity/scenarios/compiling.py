"""Compilation of the kernels ahead of the work, so that the first run says what it waits for."""

from __future__ import annotations

import warnings

import numpy as np

from asperity.contact import HalfSpace
from asperity.errors import PhysicsWarning
from asperity.pointforce import Hertz
from asperity.progress import Progress
from asperity.reference.materials import material
from asperity.rolling.ball_on_beam import roll
from asperity.structures.ball import Ball
from asperity.structures.beam import Beam

MESSAGE = "compiled functions (the first run compiles them, some 15 s)"


def compile_kernels(progress: Progress) -> None:
    """Call every compiled kernel once on next to nothing: they are compiled now, or loaded from disk.

    Parameters
    ----------
    progress : Progress
        Called between the pieces.
    """
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", PhysicsWarning)
        progress(0, 3, MESSAGE)
        x = np.arange(-4.0, 5.0) ** 2
        contact = HalfSpace((9, 9), (1.0, 1.0), 1.0).solve(np.add.outer(x, x), approach=5.0)
        progress(1, 3, MESSAGE)
        assert contact.stiffness > 0.0
        progress(2, 3, MESSAGE)
        steel = material("steel")
        beam, ball = Beam.rectangular(1.0, 0.05, 0.01, steel, highest_frequency=100.0), Ball(0.025, steel)
        roll(beam, ball, Hertz(1e10), speed=1.0, start=0.5, duration=1e-4, time_step=1e-5, sensors=[0.5])
        progress(3, 3, MESSAGE)


def compile_rail_kernels(progress: Progress) -> None:
    """Call the kernels of a wheel on a rail once on next to nothing, too.

    Parameters
    ----------
    progress : Progress
        Called between the pieces.
    """
    from asperity.rolling import wheel_on_rail
    from asperity.structures.moving_kernel import MovingKernel
    from asperity.structures.rail_poles import RailPoles
    from asperity.structures.track import Track
    from asperity.structures.wheel import Wheel

    compile_kernels(progress)
    wheel = Wheel.rigid(600.0, 65e3)
    kernel = MovingKernel(Track.named("nordborg"), 1.0, 1e-6, np.full((4, 4), 1e-12), 0.0)
    poles = RailPoles(kernel, np.array([0.5 + 0.1j]), np.full((4, 1), 1e-12 + 0j), 0.0, 0.0)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", PhysicsWarning)
        rails: list[RailPoles | MovingKernel] = [kernel, poles]
        for done, rail in enumerate(rails):
            progress(done, len(rails), MESSAGE)
            wheel_on_rail.roll(rail, wheel, Hertz(1e11), start=0.0, duration=4e-6, settling=0.0)
        progress(len(rails), len(rails), MESSAGE)
