"""Rollers on raceways that are closed around: what their slices feel, and the law that follows it."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from scipy import fft

from asperity.arguments import Array, ArrayLike, Indices, positive
from asperity.contact.hertz import Hertz
from asperity.contact.slices import EXPONENT, SlicedContact
from asperity.reduction.stiffness import ForceCurve
from asperity.reduction.texture import StateTexture
from asperity.scenarios import raceway_grids, reducing
from asperity.scenarios.geometry import HIGHEST_FORCE, Geometry
from asperity.scenarios.raceway_grids import AnyContact
from asperity.scenarios.raceway_laws import OnRaceway
from asperity.surfaces.raceway import Raceway

STATES = 48
"""Approaches of the force curve of a roller: closest at first touch."""
LEAST_STATE = 1e-3
"""Least of them over the largest."""
STRAIGHT = 1e-5
"""Share of its largest height by which a texture between its states may lie beside itself."""
STEPS = 30
"""Of Newton's method for the approach over a fault."""


def on_surface(contact: AnyContact, surface: Raceway, load: float, **others: Any) -> OnRaceway:
    """A ball or a roller on a raceway: what its contact feels, and laws made of it."""
    kind: Any = OnRaceway if isinstance(contact, Hertz) else OnRollerRaceway
    made: OnRaceway = kind(contact, surface, load, **others)
    return made


def on_cells(on: OnRaceway, heights: Array) -> Array:
    """Heights (rows, lines) of a surface, m, on the cells of its contacts: those of rollers are slices."""
    return on.in_slices(heights) if isinstance(on, OnRollerRaceway) else heights


def felt_by(contact: AnyContact, surface: Raceway, load: float) -> Array:
    """Heights (rows,), m, closed, that the contact of a ball or roller under a load, N, feels around it.

    Roughness and waves are averaged under the patch, and a fault has the height by which it changes the
    approach under the load on a smooth raceway.
    """
    return on_surface(contact, surface, positive("load of a ball or roller (N)", load)).felt


class RollerGap(Geometry):
    """The gap of a roller and its raceway, whose contact is as wide as the window across at any load."""

    @property
    def filling_force(self) -> float:
        """Force whose contact is as long as the window along the path, N: as the square of its width."""
        window = 0.5 * self.body.shape[0] * self.spacing[0]
        return float(self.load * (window / self.semi_axes[0]) ** 2)


@dataclass(frozen=True, eq=False)
class OnRollerRaceway(OnRaceway):
    """A roller on a raceway: heights as its slices feel them, and the law that follows their mean.

    Notes
    -----
    A slice feels heights along the path by the pressure of a flat punch of its half width b, whose transform
    is J₀(kb): what a small wave changes. All slices together give way by one approach; each counts by its
    stiffness under the load. Of a fault, where it is deeper than a slice is pressed in, the slice loses as
    large a share of its force as the fault covers of its width; elsewhere the fault is a height. The roller
    then sinks until all slices carry the load.
    """

    contact: SlicedContact  # type: ignore[assignment]

    @cached_property
    def shape(self) -> RollerGap:
        """The gap of the smooth bodies along the path and by slices."""
        step = self.surface.spacing[0]
        half = math.ceil(raceway_grids.HALF_WINDOW * self.axes[0] / step)
        path = (np.arange(2 * half + 1) - half) * step
        gap = np.add.outer(path**2 / (2.0 * self.contact.radius), self.contact.drops)
        width = self.contact.length / self.contact.slices
        contact: Any = self.contact
        largest = HIGHEST_FORCE * self.load
        return RollerGap(gap, (step, width), self.contact.modulus, contact, self.load, largest)

    @property
    def seen(self) -> RollerGap:
        """The same: slices are in contact or not."""
        return self.shape

    @cached_property
    def approaches(self) -> Array:
        """Approaches of the force curve, m, up to that of eight times the load."""
        largest = self.contact.approach(HIGHEST_FORCE * self.load)
        return largest * np.geomspace(LEAST_STATE, 1.0, STATES)

    @cached_property
    def curve(self) -> ForceCurve:
        """Force of all slices over the approach, without tilt."""
        found = self.contact.pressed(self.approaches)
        return ForceCurve.from_samples(self.approaches, found.force, EXPONENT, found.stiffness[:, 0, 0])

    @property
    def datum(self) -> float:
        """d₀, m, with which all states are positive in contact."""
        return -min(self.curve.first_touch, -reducing.LEAST_DATUM)

    def in_slices(self, heights: Array) -> Array:
        """Mean heights (rows, slices) of the lines of each slice."""
        return heights.reshape(len(heights), self.contact.slices, -1).mean(axis=-1)

    def _under_widths(self, heights: Array, half_width: float) -> Array:
        """Heights (rows, …), closed around, under a flat punch of a half width, m."""
        # not where contacts are only compiled
        from scipy.special import j0

        waves = 2.0 * np.pi * np.arange(self.rows // 2 + 1) / self.surface.circumference
        passed = j0(waves * half_width).reshape(-1, *[1] * (heights.ndim - 1))
        return fft.irfft(passed * fft.rfft(heights, axis=0), self.rows, axis=0)

    @cached_property
    def weights(self) -> Array:
        """Shares (slices,) of the stiffness of the contact under the load."""
        overlap = np.maximum(self.contact.approach(self.load) - self.contact.drops, 0.0)
        stiffness = np.where(overlap > 0.0, overlap ** (EXPONENT - 1.0), 0.0)
        return stiffness / stiffness.sum()

    def averaged(self, heights: Array, axes: ArrayLike) -> Array:
        """Heights (rows, lines), m, averaged under half widths (k, 2), m, with `over_faults`: (k, rows)."""
        along = self.in_slices(heights) @ self.weights
        widths = np.atleast_2d(axes)[:, 0]
        return self.over_faults + np.stack([self._under_widths(along, float(each)) for each in widths])

    @cached_property
    def over_faults(self) -> Array:
        """Height (rows,) that faults have for a roller under the load, m: by so much less is its approach."""
        felt = np.zeros(self.rows)
        if not self.surface.damaged.any():
            return felt
        near = self._near_faults()
        pressed_in = np.maximum(self.contact.approach(self.load) - self.contact.drops, 0.0)
        covered, heights = self._hollow(
            np.repeat(pressed_in, self.surface.faults.shape[1] // self.contact.slices)
        )
        half_width = self.axes[0]
        lost = self._under_widths(self.in_slices(covered), half_width)[near]
        met = self._under_widths(self.in_slices(heights), half_width)[near]
        constant = self.contact.stiffness_constant / self.contact.slices * np.clip(1.0 - lost, 0.0, 1.0)
        smooth = self.contact.approach(self.load)
        deepest = 2.0 * smooth + self._sinks()  # on the edges of what nothing carries in
        approach = np.full(near.size, deepest)
        for _ in range(STEPS):  # from above, where Newton's steps on a convex force do not overshoot
            overlap = np.maximum(approach[:, None] - self.contact.drops + met, 0.0)
            root = np.where(overlap > 0.0, overlap ** (EXPONENT - 1.0), 0.0)
            missing = self.load - (constant * root * overlap).sum(axis=1)
            slope = EXPONENT * (constant * root).sum(axis=1)
            approach = np.minimum(approach + missing / np.maximum(slope, self.load / deepest), deepest)
        felt[near] = smooth - approach
        return felt

    def _hollow(self, pressed_in: Array) -> tuple[Array, Array]:
        """Shares of cells (rows, lines) over faults deeper than lines are pressed in, m; other heights, m.

        Of cells that an edge crosses the share behind it, or the mean depth where that is less deep.
        """
        heights = self.surface.faults
        covered = (heights < -pressed_in).astype(float)
        heights = np.where(covered > 0.0, 0.0, heights)
        edges = self.surface.edges
        if edges is not None:
            behind = 1.0 - edges.shares
            deep = edges.drop > behind * pressed_in
            covered = np.where(edges.crossed & deep, behind, covered)
            heights = np.where(edges.crossed & ~deep, -edges.drop, heights)
        return covered, heights

    def _areal(self) -> StateTexture:
        """Heights averaged under each state, of those states that no straight line replaces."""
        return super()._areal().with_fewer_states(STRAIGHT)

    def _sinks(self) -> float:
        """How far a roller sinks, m, until it lies on both edges of the longest fault, or on its bottom."""
        sound = np.flatnonzero(~self.surface.damaged.any(axis=1))
        rows = np.diff(np.append(sound, sound[:1] + self.rows)).max(initial=1)
        length = float(rows) * self.surface.spacing[0]
        return min(-float(self.surface.faults.min()), length**2 / (8.0 * self.contact.radius))

    def _near_faults(self) -> Indices:
        """Rows where the contact reaches a fault."""
        damaged = np.asarray(self.surface.damaged.any(axis=1))
        reach = math.ceil(self.axes[0] / self.surface.spacing[0]) + 1
        around = self._around(damaged, reach).astype(float)
        return np.flatnonzero(np.convolve(around, np.ones(2 * reach + 1), mode="valid") > 0.5)

    def warn_of_faults(self, laws: Sequence[str]) -> None:
        """Nothing: slices know a fault only as they know it here."""

    @property
    def cells_over_faults(self) -> float:
        """How many cells its contacts have over faults: none is solved."""
        return 0.0
