"""A ball rolls over a rough beam: the whole chain from texture to spectra."""

from __future__ import annotations

import time
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from asperity.config import BallOnBeamCase
from asperity.pointforce import Law
from asperity.progress import Progress
from asperity.reduction.scan import ScannedForces
from asperity.reference.materials import contact_modulus, material
from asperity.rolling.ball_on_beam import Rolling, roll
from asperity.scenarios.compiling import compile_kernels
from asperity.scenarios.laws import Workshop
from asperity.scenarios.reducing import Geometry, Reduction, geometry, patch_planes, reduce
from asperity.scenarios.textures import Textures, gather, window_cells
from asperity.store import Store, content_key
from asperity.structures.ball import Ball
from asperity.structures.beam import Beam

MODES_BEYOND = 4.0
"""Beam modes are kept up to this multiple of the highest frequency."""


@dataclass(frozen=True, eq=False)
class Computed:
    """Everything that was computed for a case, before it is laid out as a result.

    Attributes
    ----------
    case, textures, shape, ball, beam
        What was rolled.
    reduction : Reduction or None
        State functions; None without samples.
    laws, runs : dict
        Laws and their time histories, by name, in the order of the case.
    scan : ScannedForces or None
        Scan of the path.
    duration : float
        Time rolled, s.
    seconds : dict
        Wall time of each part, s.
    """

    case: BallOnBeamCase
    textures: Textures
    shape: Geometry
    ball: Ball
    beam: Beam
    reduction: Reduction | None
    laws: dict[str, Law]
    runs: dict[str, Rolling]
    scan: ScannedForces | None
    duration: float
    seconds: dict[str, float]


class Checkpoint:
    """State of an interrupted run in the store, so that the same case goes on where it was."""

    def __init__(self, store: Store, key: str) -> None:
        self.store, self.key = store, key

    def load(self) -> dict[str, NDArray] | None:
        """What was saved last, or None."""
        return self.store.get(self.key)

    def save(self, state: dict[str, NDArray]) -> None:
        """Keep a state."""
        self.store.put(self.key, state)


def compute(case: BallOnBeamCase, progress: Progress) -> Computed:
    """Gather, reduce and roll.

    Parameters
    ----------
    case : BallOnBeamCase
        The case.
    progress : Progress
        Called during long work.

    Returns
    -------
    Computed
        All that was computed.
    """
    compile_kernels(progress)
    store, seconds = Store(), dict[str, float]()
    began = time.perf_counter()
    ball_material, beam_material = material(case.ball.material), material(case.beam.material)
    ball = Ball(case.ball.radius, ball_material, case.ball.load, case.ball.mass)
    beam = _beam(case)
    shape = geometry(case, ball.static_load, contact_modulus(ball_material, beam_material))
    textures = gather(case, window_cells(case))
    planes = None if textures.path is None else patch_planes(textures.path.heights, shape)
    seconds["textures"] = time.perf_counter() - began
    reduction = reduce(case, textures, shape, planes, store, progress) if textures.maps else None
    seconds["reduction"] = time.perf_counter() - began - sum(seconds.values())
    travel = (len(textures.line) - 1 - 2 * textures.margin) * case.contact.spacing
    duration = min(case.rolled_time, travel / case.speed)
    workshop = Workshop(case, textures, shape, reduction, planes, store, progress)
    laws: dict[str, Law] = {}
    runs: dict[str, Rolling] = {}
    scan = None
    for name in case.laws:
        laws[name], scanned = workshop.build(name)
        scan = scanned or scan
        runs[name] = roll(
            beam,
            ball,
            laws[name],
            speed=case.speed,
            start=case.start,
            duration=duration,
            time_step=case.time_step,
            sensors=case.beam.sensor_positions,
            highest_frequency=case.numerics.highest_frequency,
            progress=progress,
            checkpoint=Checkpoint(store, _run_key(case, textures, duration)) if name == "direct" else None,
        )
        seconds[f"law {name}"] = time.perf_counter() - began - sum(seconds.values())
    return Computed(case, textures, shape, ball, beam, reduction, laws, runs, scan, duration, seconds)


def _beam(case: BallOnBeamCase) -> Beam:
    return Beam.rectangular(
        case.beam.length,
        case.beam.width,
        case.beam.height,
        material(case.beam.material),
        support=case.beam.support,
        loss_factor=case.beam.loss_factor,
        highest_frequency=MODES_BEYOND * case.numerics.highest_frequency,
        suspension_frequency=case.beam.suspension_frequency,
    )


def _run_key(case: BallOnBeamCase, textures: Textures, duration: float) -> str:
    """Name of a direct run: everything that its motion depends on."""
    assert textures.path is not None
    scalars = [
        case.speed, case.start, duration, case.time_step, case.numerics.rtol,
        case.numerics.highest_frequency, case.contact.hardness, case.contact.damping,
        list(case.beam.sensor_positions),
    ]  # fmt: skip
    sections = [case.ball.model_dump(mode="json"), case.beam.model_dump(mode="json")]
    return content_key("direct", np.asarray(textures.path.heights), scalars, sections)
