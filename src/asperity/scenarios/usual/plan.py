"""What rolling takes, from a few steps of it."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray
from xarray import DataTree

from asperity.config.case import Case
from asperity.laws import HertzLaw
from asperity.progress import Progress
from asperity.rolling.pair import roll_pair
from asperity.scenarios.measure import A_WEIGHTED, Measure, a_weighted, density_of
from asperity.scenarios.preparing import PreparedCase
from asperity.scenarios.refining import Setting
from asperity.scenarios.trial import STEPS, timed
from asperity.schema import spectra

REPORT = 2.5
"""Time of starting the program, and of drawing and writing a report, s."""


def rows(case: Case) -> list[tuple[str, str]]:
    """What else will be computed, in words: nothing."""
    return []


def records(case: Case) -> int:
    """Histories that a law leaves behind."""
    return 4


def seconds(prepared: PreparedCase, progress: Progress, pace: float) -> dict[str, float]:
    """Time of what is computed once for all laws, s: nothing."""
    return {}


def step_seconds(prepared: PreparedCase) -> float:
    """Time of a step of smooth bodies over a smooth path, s."""
    case, bodies = prepared.case, prepared.bodies
    law = HertzLaw(prepared.shape.hertz.stiffness_constant)
    duration = min(STEPS * case.time_step, case.rolled_time)
    path: dict[str, Any] = {"speed": case.speed, "start": case.record_start, "time_step": case.time_step}
    _, taken = timed(lambda: roll_pair(bodies.over, bodies.rolls, law, duration=duration, **path))
    return taken / max(1.0, duration / case.time_step)


def settings_of(case: Case) -> list[Setting]:
    """List them."""
    return []


def _force(tree: DataTree, law: str) -> NDArray[np.float64]:
    return density_of(tree, spectra.FORCE_PSD, law)


MEASURES = {
    A_WEIGHTED: Measure("contact force level, A-weighted", "dB(A) re 1 N", a_weighted(_force)),
}
