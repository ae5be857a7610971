"""Defects that a case rolls over, on top of its texture: a dipped joint, and the flat of a contact's body."""

from dataclasses import dataclass
from typing import cast

import numpy as np

from asperity.arguments import Array
from asperity.case.scene import Case
from asperity.surfaces import measured_lines
from asperity.surfaces.defects import FlatShape, dipped_joint, flat_geometry, flat_trajectory
from asperity.surfaces.heightmap import Profile

PARTS = 16
"""Parts of a cell over which the mean height of a defect is taken: kinks may be anywhere in it."""


@dataclass(frozen=True, eq=False)
class Defects:
    """What a case has of defects under a contact."""

    case: Case
    contact: int

    def heights(self, positions: Array) -> Array:
        """Heights (n,), m, at positions along the path, m: the shape of defects."""
        return self._joint(positions) + self._flat(positions)

    def mean_heights(self, positions: Array, spacing: float) -> Array:
        """Mean heights (n,), m, over cells of a spacing, m, about positions along the path, m."""
        places = spacing * ((np.arange(PARTS) + 0.5) / PARTS - 0.5)
        return np.asarray(np.mean([self.heights(positions + place) for place in places], axis=0))

    def trajectory(self, rows: Array, spacing: float) -> Array:
        """Height (n,), m, of the centre of what rolls over them rigidly, at rows of the path, m."""
        centre = np.zeros(len(rows))
        if (joint := self._joint(rows)).any():
            centre += measured_lines.roll_over(Profile(joint, spacing), self.case.rolling.radius).heights
        if (flat := self._shape_of_flat) is not None:
            centre += flat_trajectory(self._from_flat(rows), *flat)
        return centre

    def _joint(self, positions: Array) -> Array:
        """Heights of the rail at a dipped joint, m."""
        case = self.case
        surface = case.surface
        if surface.joint_depth is None:
            return np.zeros(len(positions))
        joint = surface.joint_position
        if joint is None:
            joint = case.record_start + 0.5 * case.rolled_in(case.rolled_time)
        return dipped_joint(positions - joint, surface.joint_depth, surface.joint_length)

    def _flat(self, positions: Array) -> Array:
        """Heights of the body against a round one, m, zero or negative."""
        flat = self._shape_of_flat
        return np.zeros(len(positions)) if flat is None else flat_geometry(self._from_flat(positions), *flat)

    @property
    def _shape_of_flat(self) -> tuple[float, float, FlatShape, float | None] | None:
        """Depth, m, radius of the body, m, shape and length of a worn flat, m; None where there is none."""
        rolling = self.case.rolling
        if rolling.flat is None or self.contact + 1 not in rolling.flat_contacts:
            return None
        depth, length = rolling.flat
        shape = cast(FlatShape, rolling.flat_shape)
        return depth, rolling.radius, shape, length if shape == "worn" else None

    def _from_flat(self, positions: Array) -> Array:
        """How far positions, m, are from the nearest place where the middle of the flat touches, m."""
        case = self.case
        rolling = case.rolling
        spacing = case.contact.spacing
        around = round(rolling.circumference / spacing) * spacing
        first = rolling.flat_position
        if first is None:
            first = 0.5 * min(around, case.rolled_in(case.rolled_time))
        rolled = positions - case.record_start - rolling.offsets[self.contact]
        return np.mod(rolled - first + 0.5 * around, around) - 0.5 * around
