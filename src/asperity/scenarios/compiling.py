"""Compilation of the kernels ahead of the work, so that the first run says what it waits for."""

from __future__ import annotations

import os
import subprocess
import sys
import warnings
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any

import numpy as np

from asperity.contact import HalfSpace
from asperity.errors import PhysicsWarning
from asperity.kernels import modal, rail
from asperity.kernels.options import is_kept
from asperity.pointforce import Hertz
from asperity.progress import Progress
from asperity.reduction.texture import StateTexture
from asperity.reference.materials import material
from asperity.rolling.ball_on_beam import roll
from asperity.structures.ball import Ball
from asperity.structures.beam import Beam
from asperity.threads import processors

MESSAGE = "compiled functions (the first run compiles them, some 10 s)"


def compile_kernels(progress: Progress) -> None:
    """Call every kernel of a ball once on next to nothing: it is compiled now, or loaded from disk.

    Parameters
    ----------
    progress : Progress
        Called between the pieces.
    """
    _compile(progress, modal.roll_steps, roll_a_ball)


def compile_rail_kernels(progress: Progress) -> None:
    """Call the kernels of a wheel on a rail once on next to nothing.

    Parameters
    ----------
    progress : Progress
        Called between the pieces.
    """
    _compile(progress, rail.roll_steps, roll_a_wheel)


def _compile(progress: Progress, stepping: Any, rolling: Callable[[], None]) -> None:
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", PhysicsWarning)
        progress(0, 2, MESSAGE)
        with _beside(stepping, rolling.__name__):
            x = np.arange(-4.0, 5.0) ** 2
            HalfSpace((9, 9), (1.0, 1.0), 1.0).solve(np.add.outer(x, x), approach=5.0)
        progress(1, 2, MESSAGE)
        rolling()
        indent()
        progress(2, 2, MESSAGE)


@contextmanager
def _beside(stepping: Any, name: str) -> Iterator[None]:
    """Compile the rolling in a second process beside the contact, where it is not on disk yet.

    The compiler takes one function at a time in a process; what the second one compiles, the first loads.
    """
    if processors() < 2 or is_kept(stepping):
        yield
        return
    code = f"from asperity.scenarios import compiling; compiling.{name}(); compiling.indent()"
    environment = os.environ | {"PYTHONPATH": os.pathsep.join(filter(None, sys.path))}
    quiet: dict[str, Any] = {"stdout": subprocess.DEVNULL, "stderr": subprocess.DEVNULL}
    with subprocess.Popen([sys.executable, "-W", "ignore", "-c", code], env=environment, **quiet) as other:
        try:
            yield
        except BaseException:
            other.kill()
            raise


def indent() -> None:
    """Find the stiffness of a contact, and what a pressure displaces."""
    half_space = HalfSpace((9, 9), (1.0, 1.0), 1.0)
    half_space.tangent_stiffness(np.ones((9, 9)))
    half_space.displacement(np.ones((9, 9)))


def roll_a_ball() -> None:
    """Roll a ball a few steps over a line."""
    steel = material("steel")
    beam, ball = Beam.rectangular(1.0, 0.05, 0.01, steel, highest_frequency=100.0), Ball(0.025, steel)
    law = Hertz(1e10, StateTexture.unfiltered(np.zeros(8), 0.2))
    roll(beam, ball, law, speed=1.0, start=0.5, duration=1e-4, time_step=1e-5, sensors=[0.5])


def roll_a_wheel() -> None:
    """Roll a wheel a few steps, on a scattered rail and on one of poles."""
    from asperity.rolling import wheel_on_rail
    from asperity.structures.moving_kernel import MovingKernel
    from asperity.structures.rail_poles import RailPoles
    from asperity.structures.track import Track
    from asperity.structures.wheel import Wheel

    wheel = Wheel.rigid(600.0, 65e3)
    kernel = MovingKernel(Track.named("nordborg"), 1.0, 1e-6, np.full((4, 4), 1e-12))
    poles = RailPoles(kernel, np.array([0.5 + 0.1j]), np.full((4, 1), 1e-12 + 0j), 0.0, 0.0)
    rails: list[RailPoles | MovingKernel] = [kernel, poles]
    for each in rails:
        law = Hertz(1e11, StateTexture.unfiltered(np.zeros(8), 0.2))
        wheel_on_rail.roll(each, wheel, law, start=0.0, duration=4e-6, settling=0.0)
    rail.add_passing(np.zeros((1, 4)), np.zeros((1, 4)), np.zeros((4, 2)), np.zeros(1), 0)
