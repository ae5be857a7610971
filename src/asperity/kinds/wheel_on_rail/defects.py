"""Defects of rail and wheel along the path: corrugation, a dipped joint, a wheel flat."""

from __future__ import annotations

from typing import cast

import numpy as np
from numpy.typing import NDArray

from asperity.kinds.wheel_on_rail.case import WheelOnRail
from asperity.kinds.wheel_on_rail.wheel_keys import FlatKeys
from asperity.surfaces.defects import FlatShape, corrugation, dipped_joint, flat_geometry, flat_trajectory
from asperity.surfaces.heightmap import Profile
from asperity.surfaces.measured_lines import roll_over


def corrugated(case: WheelOnRail, rows: int, seed: int) -> NDArray[np.float64]:
    """Corrugation of the rail along the path: heights (rows,), m, the same all across; zero without one.

    The seed is that of a corrugation with a bandwidth.
    """
    surface = case.surface
    if surface.corrugation is None or surface.corrugation_wavelength is None:
        return np.zeros(rows)
    made = corrugation(
        rows,
        case.contact.spacing,
        wavelength=surface.corrugation_wavelength,
        amplitude=surface.corrugation,
        bandwidth=surface.corrugation_bandwidth,
        seed=seed,
    )
    return made.heights


def defects(
    case: WheelOnRail, position: NDArray[np.float64], turn: int
) -> tuple[NDArray[np.float64] | None, NDArray[np.float64] | None]:
    """Heights of wheel flat and dipped joint, and of the wheel's centre rolling over them, (rows,), m.

    At positions (rows,) of the path, m from a sleeper, for `turn` cells of one turn of the wheel; None
    without defects.
    """
    geometry, trajectory = np.zeros(len(position)), np.zeros(len(position))
    surface, wheel, spacing = case.surface, case.wheel, case.contact.spacing
    if surface.joint_depth is not None:
        joint = surface.joint_position
        if joint is None:
            joint = case.start + 0.5 * case.speed * case.duration
        dip = dipped_joint(position - joint, surface.joint_depth, surface.joint_length)
        geometry += dip
        trajectory += roll_over(Profile(dip, spacing), wheel.radius).heights
    if wheel.flat is not None:
        heights, centre = flat_along(wheel, position - case.start, turn * spacing, case.speed * case.duration)
        geometry += heights
        trajectory += centre
    return (geometry, trajectory) if geometry.any() else (None, None)


def flat_along(
    tread: FlatKeys, rolled: NDArray[np.float64], around: float, recorded: float
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Heights of a flat, and of the centre of what rolls over it (rows,), m, once in each turn.

    At distances rolled since the record began (rows,), m, of a circumference and a record of so many metres.
    """
    assert tread.flat is not None
    (depth, length), first = tread.flat, tread.flat_position
    if first is None:
        first = 0.5 * min(around, recorded)
    along = np.mod(rolled - first + 0.5 * around, around) - 0.5 * around
    shape = cast(FlatShape, tread.flat_shape)
    worn = length if shape == "worn" else None
    return (
        flat_geometry(along, depth, tread.radius, shape, worn),
        flat_trajectory(along, depth, tread.radius, shape, worn),
    )
