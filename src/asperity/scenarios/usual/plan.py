"""What rolling takes, from a few steps of it."""

from __future__ import annotations

from typing import Any

from asperity.config.case import Case
from asperity.laws import HertzLaw
from asperity.progress import Progress
from asperity.rolling.pair import roll_pair
from asperity.scenarios.preparing import PreparedCase
from asperity.scenarios.trial import STEPS, timed

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
