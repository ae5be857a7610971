"""Compilation of the kernels ahead of the work, so that the first run says what it waits for."""

import os
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager, nullcontext, suppress
from contextvars import ContextVar
from functools import cache

import numpy as np

from asperity.case.any_case import AnyCase
from asperity.contact.pressed_once import press_once
from asperity.errors import PhysicsWarning
from asperity.kernels import pointforce
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
    "from asperity.sandbox import end_with_parent; end_with_parent(); import gc, os; gc.disable(); "
    "from asperity.contact.pressed_once import press_once; press_once(*{}); os._exit(0)"
)
"""What a second process does: half of all compilation, so that a first demo takes two thirds of the time.

It leaves its garbage where it is, and ends without taking Python apart: that would be an eighth of its time.
"""
PATIENCE = 300.0  # s that it is waited for
_BESIDE: ContextVar[subprocess.Popen[bytes] | None] = ContextVar("contact compiled beside", default=None)
ROLLING = "asperity.kernels.stepping.roll_prepared"
ROLLING_TIME = 6.5
"""Processor time of compiling what rolls, s, at a pace of one."""
CONTACT_TIME = 4.5
"""That of what contacts on all kinds of cells share."""
CELLS_TIME = {"whole": 5.0, "covered": 7.5}
"""That of what each kind of cells has for itself."""


def compile_kernels(progress: Progress, *kinds: str) -> None:
    """Call every kernel once on next to nothing: it is compiled now, or loaded from disk.

    Contacts are those of kinds of cells, as in `HalfSpace`; whole ones where none are named.
    """
    cells = kinds or ("whole",)
    with PhysicsWarning.ignored(), _contact_compiled_beside(cells) as other:
        progress(0, 2, COMPILED)
        roll_once()
        progress(1, 2, COMPILED)
        if other is not None:
            with suppress(subprocess.TimeoutExpired):
                other.wait(PATIENCE)
        press_once(*cells)
        progress(2, 2, COMPILED)


def time_to_compile(*kinds: str) -> float:
    """Processor time, s, of compiling what is not kept from an earlier run, at a pace of one.

    For contacts on kinds of cells, as in `HalfSpace`; of these one that is kept stands for all.
    """
    contact = CONTACT_TIME + sum(CELLS_TIME[cells] for cells in kinds)
    kernels = ((ROLLING, ROLLING_TIME), (CONTACT, contact))
    return sum(seconds for kernel, seconds in kernels if not is_kept(kernel))


@contextmanager
def compiled_ahead(case: AnyCase) -> Iterator[None]:
    """Compile the contact of a case while it is laid out, where its kind of cells is known before."""
    cells = case.cells_at_rims
    with _contact_compiled_beside(cells) if len(cells) == 1 else nullcontext():
        yield


@contextmanager
def _contact_compiled_beside(cells: tuple[str, ...]) -> Iterator[subprocess.Popen[bytes] | None]:
    """Compile the contact in a second process, unless it is on disk or no process can be started.

    Within another such context that process serves, which was started ahead.
    """
    if (ahead := _BESIDE.get()) is not None:
        yield ahead
        return
    other = None
    null = subprocess.DEVNULL
    if processors() > 1 and not is_kept(CONTACT):
        environment = os.environ | {"PYTHONPATH": os.pathsep.join(filter(None, sys.path))}
        command = [sys.executable, "-W", "ignore", "-c", BESIDE.format(cells)]
        with suppress(OSError):  # as inside another program
            other = subprocess.Popen(
                command, env=environment, stdin=subprocess.PIPE, stdout=null, stderr=null
            )
    outside = _BESIDE.set(other)
    try:
        yield other
    finally:
        _BESIDE.reset(outside)
        if other is not None:
            with other:
                other.kill()


@cache
def roll_once() -> None:
    """Roll two masses a few steps over a beam, and evaluate a law by itself: once in a process."""
    beam = Beam.rectangular(1.0, 0.05, 0.01, material("steel"), highest_frequency=100.0)
    law = HertzLaw(1e10, StateTexture.unfiltered(np.zeros(8), 0.2))
    bodies = [Body.rigid(0.5, 5.0)] * 2
    where = {"start": 0.2, "positions": [0.0, 0.1]}
    roll_bodies(beam, bodies, [law] * 2, speed=1.0, duration=1e-4, time_step=1e-5, **where)  # type: ignore[arg-type]
    pointforce.evaluate_all(law.prepare(np.zeros(2)), np.zeros(2), 0)
