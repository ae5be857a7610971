"""Compilation of the kernels ahead of the work, so that the first run says what it waits for."""

from __future__ import annotations

import math
import time
import warnings
from collections.abc import Callable, Iterable
from typing import Any

import numba
import numpy as np

from asperity.contact import HalfSpace
from asperity.errors import PhysicsWarning
from asperity.kernels import along, overlap, pointforce, projected_cg, scanning
from asperity.kernels.box import Box
from asperity.kernels.census import Census
from asperity.kernels.convolution import Convolution
from asperity.kernels.projected_cg import Task
from asperity.laws import HertzLaw
from asperity.progress import COMPILATION, COMPILED, Progress
from asperity.reduction.texture import StateTexture
from asperity.scenarios.second_process import contact_compiled_beside

CONTACT = (
    scanning.solve_positions,
    overlap.foundation_approach,
)
LAWS = pointforce.evaluate_all, along.splines_along
FIRST = 0.07
"""Share of the time that passes before the first kernel is there: the compiler gets ready."""
INTERVAL = 0.1  # s between looks at what is compiled


def call_kernels(progress: Progress, stepping: Iterable[Any], rolling: Callable[[], None]) -> None:
    """Call every kernel of a kind of case once on next to nothing: it is compiled now, or loaded from disk.

    `stepping` are the kernels by which `rolling` rolls a few steps. A second process takes its share.
    """
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", PhysicsWarning)
        with COMPILATION.heard_by(Telling(progress, stepping)), contact_compiled_beside():
            iterate_never()  # the second process needs it as the last but one
            rolling()
            evaluate_once()
            estimate_once()
            press_once()
        progress(100, 100, COMPILED)


class Telling:
    """Tells in percent how far compilation is, whoever compiles; nothing where all is on disk."""

    def __init__(self, progress: Progress, stepping: Iterable[Any]) -> None:
        self.progress, self.stepping = progress, stepping
        self.census: Census | None = None
        self.before, self.told = 0.0, -math.inf  # share that was there before, time of the last look, s

    def __call__(self) -> None:
        """Look what is there, unless that was done just now."""
        if time.monotonic() - self.told < INTERVAL:
            return
        if self.census is None:
            self.census = Census((*CONTACT, *LAWS, *self.stepping))
            self.before = self.census.done()
        share = (self.census.done() - self.before) / max(1.0 - self.before, 1e-9)
        percent = 100.0 * (FIRST + (1.0 - FIRST) * share) if share > 0.0 else 0.0
        self.progress(int(percent), 100, COMPILED)
        self.told = time.monotonic()


def compile_beside() -> None:
    """What the second process compiles; where it comes to the iteration, the first one has done that."""
    evaluate_once()
    press_once()
    estimate_once()


def press_once() -> None:
    """Press a body, to an approach and under a load."""
    half_space, x = HalfSpace((9, 9), (1.0, 1.0), 1.0), np.arange(-4.0, 5.0) ** 2
    half_space.solve(np.add.outer(x, x), approach=5.0)
    half_space.solve(np.add.outer(x, x), load=5.0)


def iterate_never() -> None:
    """Compile the iteration of a contact for a process that compiles all around it meanwhile.

    Python never calls it: that would take an entry of its own. Types are those with which the contact does.
    """
    whole, field = np.zeros(1, np.int64), np.zeros(1)
    convolved = Convolution(whole, whole, field, field, field, field, field)
    box, task = Box(1, 1, 1, *[field] * 11), Task(1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 1)
    projected_cg.solve.compile(tuple(map(numba.typeof, (convolved, field, box, task, 1))))


def estimate_once() -> None:
    """Estimate an approach."""
    overlap.foundation_approach(np.zeros((9, 9)), 1.0, 1.0, 1.0, np.inf)


def evaluate_once() -> None:
    """Evaluate a law."""
    law = HertzLaw(1e10, StateTexture.unfiltered(np.zeros(8), 0.2)).prepare(np.zeros(2))
    pointforce.evaluate_all(law, np.zeros(2), 0)
