"""Creep forces of a case: its bodies under the working load, smooth and with its own roughness."""

from __future__ import annotations

import numpy as np

from asperity.contact.creep import CreepCurve, creep_curve
from asperity.contact.friction import Friction
from asperity.contact.tangential import FrictionalHalfSpace
from asperity.progress import Progress
from asperity.scenarios.preparing import PreparedCase
from asperity.scenarios.reducing import samples_of


def creep_of(
    prepared: PreparedCase,
    friction: float | Friction,
    direction: str = "longitudinal",
    count: int = 16,
    progress: Progress | None = None,
) -> CreepCurve:
    """Creep curve of what rolls in a case under its working load.

    The smooth contact comes first, then the samples that the case is reduced by. The traction acts on what
    rolls.
    """
    case, shape, maps = prepared.case, prepared.shape, prepared.textures.maps
    space = shape.half_space(case.contact.hardness)
    samples = samples_of(case, shape, maps, shape.class_axes) if maps else []
    contacts = [
        space.solve(shape.body - heights, load=shape.load, rtol=case.numerics.rtol)
        for heights in (np.zeros_like(shape.body), *samples)
    ]
    bodies = case.rolling.material, case.rolled_over.material
    rolling = FrictionalHalfSpace(space, bodies, friction)
    return creep_curve(
        rolling, contacts, shape.semi_axes, direction, count=count, speed=case.speed, progress=progress
    )
