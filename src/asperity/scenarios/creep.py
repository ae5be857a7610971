"""Friction of a case: its bodies smooth and with its roughness, under the working load and over states."""

from __future__ import annotations

import numpy as np

from asperity.arguments import Array
from asperity.case.scene import Case
from asperity.contact import creep, halfspace, tangential
from asperity.contact.friction import Friction
from asperity.errors import InputError
from asperity.progress import Progress
from asperity.reduction import stiffness, texture
from asperity.reduction.traction import TractionStates, middle_of, traction_states
from asperity.scenarios.geometry import Geometry
from asperity.scenarios.preparing import PreparedCase
from asperity.scenarios.reducing import LIGHTEST_STATE
from asperity.scenarios.textures import Textures

LEAST_CELLS = 4.0
"""Cells in the shorter semi-axis of the smooth contact in the lowest state."""


def creep_of(
    prepared: PreparedCase,
    friction: float | Friction,
    direction: str = "longitudinal",
    count: int = 16,
    progress: Progress | None = None,
) -> creep.CreepCurve:
    """Creep curve of what rolls in a case under its working load.

    The smooth contact comes first, then the samples that the case is reduced by. The traction acts on what
    rolls.
    """
    case, shape = prepared.case, prepared.shape
    rolling, smooth = smooth_with_friction(case, shape, friction)
    return creep.creep_curve(
        rolling, smooth, shape.semi_axes, direction, count=count,
        samples=rough_strips(shape, prepared.textures), speed=case.speed, progress=progress,
    )  # fmt: skip


def states_of(prepared: PreparedCase, count: int, progress: Progress | None = None) -> TractionStates:
    """State functions of tangential contact of a rough case, at `count` approaches.

    From where all samples carry a light load, and the smooth contact has some cells, to where one carries
    the largest that the window holds.
    """
    case, shape = prepared.case, prepared.shape
    samples = rough_strips(shape, prepared.textures)
    bodies = case.rolling.material, case.rolled_over.material
    if not samples:
        remedy = "Give it a file or rms, of a rail a spectrum."
        raise InputError("surface", "none, or as a line alone", "a rough surface with samples", remedy)
    space = shape.half_space(case.contact.hardness)
    resolved = (LEAST_CELLS * max(shape.spacing) / min(shape.axes(1.0))) ** 3
    loads = max(LIGHTEST_STATE * shape.class_load, resolved), shape.largest_force
    gaps = [shape.body - middle_of(sample, len(shape.body)) for sample in samples]
    low, high = np.array([[space.solve(gap, load=load).approach for load in loads] for gap in gaps]).T
    approaches = low.max() + (high.min() - low.max()) * np.linspace(0.0, 1.0, count) ** 2
    return traction_states(space, bodies, shape.body, samples, approaches, progress)


def friction_of(case: Case) -> Friction:
    """What a case says of friction, or a coefficient of 0.3 where it says nothing of creep."""
    if "creep" not in case.inner:
        return Friction(0.3)
    return Friction(case.sideways.friction, case.creep.kinetic, case.creep.falling_velocity)


def smooth_with_friction(
    case: Case, shape: Geometry, friction: float | Friction
) -> tuple[tangential.FrictionalHalfSpace, halfspace.Contact]:
    """What rolls, as the first body, on what it rolls over; and their smooth contact under the load."""
    space = shape.half_space(case.contact.hardness)
    bodies = case.rolling.material, case.rolled_over.material
    smooth = space.solve(shape.body, load=shape.load, rtol=case.numerics.rtol)
    return tangential.FrictionalHalfSpace(space, bodies, friction), smooth


def rough_strips(shape: Geometry, textures: Textures) -> list[Array]:
    """Rough strips (rows, ny) of a case about the plane that the patch feels in their middle, m."""
    weights, nx = texture.punch_weights(shape.spacing, shape.class_axes), len(shape.body)
    rough = [strip.heights for strip in textures.strips if strip.heights.any()]
    return [heights - stiffness.weighted_mean(middle_of(heights, nx), weights) for heights in rough]
