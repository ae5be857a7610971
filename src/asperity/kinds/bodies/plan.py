"""What rolling bodies on several contacts takes, from a few steps of it."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray
from xarray import DataTree

from asperity.config.case import Case
from asperity.kinds.bodies import schema
from asperity.kinds.bodies.bodies import highest_beam_mode
from asperity.kinds.bodies.case import Bodies
from asperity.laws import HertzLaw
from asperity.progress import Progress
from asperity.reduction.texture import StateTexture
from asperity.rolling.roll import roll_bodies
from asperity.scenarios.measure import A_WEIGHTED, Measure, a_weighted, density_of
from asperity.scenarios.preparing import PreparedCase
from asperity.scenarios.refining import Setting, Way
from asperity.scenarios.trial import STEPS, timed
from asperity.scenarios.trial_track import POLE_TIME, try_track
from asperity.structures.moving_kernel import SHORTEST, STARTS, MovingKernel
from asperity.structures.rail_poles import DECIMALS, POLES, RailBetween, RailPoles
from asperity.structures.track import Track
from asperity.threads import thread_count
from asperity.units import written


def rows(case: Any) -> list[tuple[str, str]]:
    """The contacts, in words."""
    offsets = case.body.offsets
    if len(offsets) == 1:
        return []
    return [("contacts", f"{len(offsets)}, {min(offsets):g} to {max(offsets):g} m ahead of the position")]


def records(case: Any) -> int:
    """Histories that a law leaves behind."""
    return 6 * len(case.body.offsets) + 2


def seconds(prepared: PreparedCase, progress: Progress, pace: float) -> dict[str, float]:
    """Time of the moving kernels of a track, under each contact and between them, and of their poles, s."""
    case, over = prepared.case, prepared.bodies.over
    if not isinstance(over, Track):
        return {}
    trial = try_track(over, case.speed, case.time_step, progress)
    offsets: tuple[float, ...] = case.body.offsets  # type: ignore[attr-defined]
    apart = {round(abs(one - other), DECIMALS) for one in offsets for other in offsets} - {0.0}
    kernels, poles = 2 * len(apart), POLES * POLE_TIME * pace
    return {
        "moving kernel": trial.kernel / thread_count() + poles,
        "rail between contacts": kernels * (trial.last / thread_count() + poles),
    }


def step_seconds(prepared: PreparedCase) -> float:
    """Time of a step of smooth bodies over a smooth path, s."""
    case: Any = prepared.case
    law = HertzLaw(prepared.shape.hertz.stiffness_constant, StateTexture.unfiltered(np.zeros(8), 1e4, -4e4))
    duration = min(STEPS * case.time_step, case.rolled_time)
    _, taken = timed(lambda: _roll(prepared, law, duration))
    return taken / max(1.0, duration / case.time_step)


def _roll(prepared: PreparedCase, law: HertzLaw, duration: float) -> None:
    case: Case = prepared.case
    bodies = prepared.bodies
    over = _rail_like(prepared, bodies.over) if isinstance(bodies.over, Track) else bodies.over
    contacts = sum(len(body.places) for body in bodies.rolling)
    roll_bodies(
        over,
        bodies.rolling,
        [law] * contacts,
        positions=prepared.case.body.positions,  # type: ignore[attr-defined]
        speed=case.speed,
        start=case.record_start,
        duration=duration,
        time_step=case.time_step,
        sensors=bodies.sensors,
    )


def _rail_like(prepared: PreparedCase, track: Track) -> RailBetween:
    """A rail that costs as much as that of a case under each wheel, and hardly moves."""
    case = prepared.case
    lags = round(SHORTEST / case.time_step)
    kernel = MovingKernel(track, case.speed, case.time_step, np.full((STARTS, lags), 1e-20))
    poles = 0.5 * np.exp(1j * np.linspace(0.1, 3.0, POLES // 2))
    return RailBetween(
        RailPoles(kernel, poles, np.full((STARTS, len(poles)), 1e-20 + 0j), 0.0, 0.0), {}, reach=0.0
    )


def settings_of(case: Bodies) -> list[Setting]:
    """Modes up to twice the frequency, where there are any."""
    if case.over != "beam":
        return []
    before, after = highest_beam_mode(case), 2.0 * highest_beam_mode(case)
    words = f"up to {written(before, 'Hz', 'kHz')} → up to {written(after, 'Hz', 'kHz')}"
    return [Setting("modes", (Way(words, {"beam.modes_up_to": after}),), scans_kept=True)]


def _force(tree: DataTree, law: str) -> NDArray[np.float64]:
    return density_of(tree, schema.FORCE_PSDS, law)


MEASURES = {
    A_WEIGHTED: Measure(
        "contact force level, energy mean over the contacts, A-weighted", "dB(A) re 1 N", a_weighted(_force)
    ),
}
