"""Compilation of the kernels ahead of the work, so that the first run says what it waits for."""

from __future__ import annotations

import os
import subprocess
import sys
import warnings
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from typing import Any

import numpy as np

from asperity.contact import HalfSpace
from asperity.errors import PhysicsWarning
from asperity.kernels import overlap, pointforce
from asperity.kernels.options import is_kept
from asperity.laws import HertzLaw
from asperity.progress import COMPILED, Progress
from asperity.reduction.texture import StateTexture
from asperity.reference.materials import material
from asperity.rolling.roll import roll_bodies
from asperity.structures.beam import Beam
from asperity.structures.body import Body
from asperity.threads import processors

CONTACT = "asperity.kernels.scanning.solve_positions"
BESIDE = (
    "from asperity.sandbox import end_with_parent; end_with_parent(); "
    "from asperity.scenarios.compiling import press_once; press_once()"
)
"""What a second process does."""
PATIENCE = 300.0  # s that it is waited for


def compile_kernels(progress: Progress) -> None:
    """Call every kernel once on next to nothing: it is compiled now, or loaded from disk.

    On more than one processor a second process compiles the contact meanwhile: a third of the time less.
    """
    parts = (roll_once, evaluate_once, estimate_once, press_once)
    with warnings.catch_warnings(), _contact_compiled_beside() as wait:
        warnings.simplefilter("ignore", PhysicsWarning)
        for done, part in enumerate(parts):
            progress(done, len(parts), COMPILED)
            if part is press_once:
                wait()
            part()
    progress(len(parts), len(parts), COMPILED)


@contextmanager
def _contact_compiled_beside() -> Iterator[Callable[[], None]]:
    """Compile the contact in a second process, unless it is on disk; yields what waits for its end."""
    other = _started() if processors() > 1 and not is_kept(CONTACT) else None
    if other is None:
        yield lambda: None
        return

    def wait() -> None:
        with suppress(subprocess.TimeoutExpired):
            other.wait(PATIENCE)

    with other:
        try:
            yield wait
        finally:
            other.kill()


def _started() -> subprocess.Popen[bytes] | None:
    """Start it; None where no process can be started, as inside another program."""
    environment = os.environ | {"PYTHONPATH": os.pathsep.join(filter(None, sys.path))}
    streams: dict[str, Any] = {"stdin": subprocess.PIPE}
    streams |= {"stdout": subprocess.DEVNULL, "stderr": subprocess.DEVNULL}
    try:
        return subprocess.Popen([sys.executable, "-W", "ignore", "-c", BESIDE], env=environment, **streams)
    except OSError:
        return None


def roll_once() -> None:
    """Roll two masses a few steps over a beam."""
    beam = Beam.rectangular(1.0, 0.05, 0.01, material("steel"), highest_frequency=100.0)
    law = HertzLaw(1e10, StateTexture.unfiltered(np.zeros(8), 0.2))
    bodies, laws = [Body.rigid(0.5, 5.0)] * 2, [law] * 2
    where = {"start": 0.2, "positions": [0.0, 0.1]}
    roll_bodies(beam, bodies, laws, speed=1.0, duration=1e-4, time_step=1e-5, **where)  # type: ignore[arg-type]


def press_once() -> None:
    """Press a body, to an approach and under a load."""
    half_space, x = HalfSpace((9, 9), (1.0, 1.0), 1.0), np.arange(-4.0, 5.0) ** 2
    half_space.solve(np.add.outer(x, x), approach=5.0)
    half_space.solve(np.add.outer(x, x), load=5.0)


def estimate_once() -> None:
    """Estimate an approach."""
    overlap.foundation_approach(np.zeros((9, 9)), 1.0, 1.0, 1.0, np.inf)


def evaluate_once() -> None:
    """Evaluate a law."""
    law = HertzLaw(1e10, StateTexture.unfiltered(np.zeros(8), 0.2)).prepare(np.zeros(2))
    pointforce.evaluate_all(law, np.zeros(2), 0)
