"""Friction of bodies that creep as they roll, at each load as if it had always been there."""

import math
from collections.abc import Callable
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np

from asperity.arguments import Array
from asperity.contact import friction, tangential
from asperity.errors import OutOfRangeWarning

SIZES = np.linspace(0.2, 1.0, 17)
"""Sizes of the contact, cube roots of the load over the largest one, at which it is solved."""
MOST, HALVINGS = 100.0, 12
"""Times the creepages, and part of them, between which full slip is sought; halvings of that interval."""
CREEP_CHANGE, LOAD_CHANGE = 0.05, 0.25
"""Shares by which creepage and load are changed for slopes of the force; less moves single cells."""
ROUNDING = 1e-9
"""Share of what friction carries below which a force is none: it would be opposite by symmetry."""


@dataclass(frozen=True, eq=False)
class CreepingBodies:
    """Two smooth bodies that roll with creepages that are given.

    Parameters
    ----------
    rolling : FrictionalHalfSpace
        Bodies and friction.
    gap : ndarray (nx, ny)
        Of the bodies at zero approach, m.
    creepage : (float, float, float)
        ξ, η and spin φ, 1/m, of the first body as in `FrictionalHalfSpace.roll`; not all zero.
    speed : float
        Rolling speed, m/s.
    largest_load : float
        N.

    Notes
    -----
    Quasi-steady: the load changes little while a place passes through the contact, so that waves of the force
    are long against it, v/f > 2a. The pressure is that of smooth bodies without friction.
    """

    rolling: tangential.FrictionalHalfSpace
    gap: Array = field(repr=False)
    creepage: tuple[float, float, float]
    speed: float
    largest_load: float

    def at(self, load: float, scale: float = 1.0, across: float = 0.0) -> friction.SlidingContact:
        """The contact under a load, N, with the creepages times a scale, and a lateral one added.

        Creepages that are out of range are not told of.
        """
        xi, eta, spin = (scale * each for each in self.creepage)
        contact = self.rolling.half_space.solve(self.gap, load=load)
        with OutOfRangeWarning.ignored():
            return self.rolling.roll(contact, (xi, eta + across), spin, speed=self.speed)

    @cached_property
    def _shares(self) -> Array:
        """Forces along and across, and moment, over the load (3, k)."""
        loads = self.largest_load * SIZES**3
        return np.array([forces_of(self.at(load)) for load in loads.tolist()]).T / loads

    def follow(self, force: Array) -> Array:
        """Forces on the first body along and across, N, and moment, N m (3, ...), of a normal force (...), N.

        Zero where there is none.
        """
        load = np.maximum(force, 0.0)
        size = np.cbrt(load / self.largest_load)
        return np.stack([load * np.interp(size, SIZES, shares) for shares in self._shares])

    def power(self, forces: Array) -> Array:
        """What forces and moment (3, ...) of steady rolling turn into heat, W: −V (F·ξ + M φ).

        On a grid nearer than `SlidingContact.dissipated_power`, whose error is of first order.
        """
        return np.asarray(-self.speed * np.tensordot(self.creepage, forces, axes=1))

    @cached_property
    def full_slip_load(self) -> float:
        """Load up to which all slips, N; at least that of the smallest contact, infinite if of any."""
        least = float(self.largest_load * SIZES[0] ** 3)
        return _change(lambda load: self.at(load).stick_area > 0.0, least, self.largest_load)

    def full_slip_scale(self, load: float) -> float:
        """Share of the creepages from which on all slips under a load, N; infinite if that is not found."""
        return _change(lambda scale: self.at(load, scale).stick_area == 0.0, 1.0 / MOST, MOST)

    def slopes(self, load: float) -> tuple[float, float]:
        """Slopes of the lateral force on the first body under a load, N: over creepage, N, and over load."""
        radius = math.sqrt(self.at(load).normal.area / math.pi)
        step = CREEP_CHANGE * math.hypot(*self.creepage[:2], radius * self.creepage[2])
        less, more = (self.at(load, across=sign * step).force[1] for sign in (-1.0, 1.0))
        low, high = (self.at(load * (1.0 + sign * LOAD_CHANGE)).force[1] for sign in (-1.0, 1.0))
        return (more - less) / (2.0 * step), (high - low) / (2.0 * LOAD_CHANGE * load)


def forces_of(found: friction.SlidingContact) -> Array:
    """Forces on the first body along and across, N, and moment about the normal, N m (3,)."""
    forces, arms = np.array((*found.force, found.moment)), (1.0, 1.0, math.sqrt(found.normal.area))
    return np.where(np.abs(forces) > ROUNDING * found.limit * np.array(arms), forces, 0.0)


def _change(holds: Callable[[float], bool], low: float, high: float) -> float:
    """Where something begins to hold between two positive numbers; infinite if it does not."""
    if not holds(high):
        return math.inf
    for _ in range(HALVINGS):
        middle = math.sqrt(low * high)
        low, high = (low, middle) if holds(middle) else (middle, high)
    return math.sqrt(low * high)
