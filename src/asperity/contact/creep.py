"""Creep forces of a contact that rolls: Kalker's coefficients, FASTSIM, samples, curves, loads that vary."""

import math
import warnings
from abc import ABC, abstractmethod
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property, lru_cache, partial

import numpy as np

from asperity.arguments import Array, ArrayLike, finite_array, one_of, real, require, two_lengths, whole
from asperity.contact.friction import SlidingContact, cell_places
from asperity.contact.halfspace import HalfSpace
from asperity.contact.solved import Contact
from asperity.contact.tangential import FrictionalHalfSpace
from asperity.errors import OutOfRangeWarning
from asperity.progress import Progress, counted
from asperity.reference.materials import Material
from asperity.threads import in_order
from asperity.written_numbers import count_of

DIRECTIONS = {"longitudinal": (1.0, 0.0, 0.0), "lateral": (0.0, 1.0, 0.0), "spin": (0.0, 0.0, 1.0)}
"""Creepages that a curve may grow along; spin is counted in the inverse of the mean semi-axis √(ab)."""
GRIDS = (48, 96)
"""Cells across the ellipse on which coefficients are computed, before they are extrapolated."""
STRIPS = 50
"""Strips of FASTSIM, and steps along each."""
SMALL = 1e-3
"""Creepage for the coefficients, which are of a linear theory."""
FULL_SLIP = 4.0
"""Creepage at which a curve ends, in those at which the linear theory gives all that friction carries."""
LENGTHS, LEAST_LENGTHS, UNCOUNTED, STEPS = 4, 3, 2, 8
"""Lengths of the contact that a sample is rolled over, the fewest, and the first that do not count: the start
fades by a factor of four in each. On whole cells at most so many steps in one: their error is of first order
in any, and in part that of the smooth contact, too."""
ROLLED_RTOL = 1e-3
"""Of a step over a sample: it moves the mean force by 2e-4."""


@lru_cache
def kalker_coefficients(ratio: float, poisson: float) -> tuple[float, float, float]:
    """Creep coefficients c11, c22 and c23 of an ellipse of two like bodies.

    Parameters
    ----------
    ratio : float
        Semi-axis along the rolling direction over that across, a/b, from 0.05 to 20.
    poisson : float
        Poisson's ratio.

    Returns
    -------
    tuple of float
        ``F_x = −G ab c11 ξ`` and ``F_y = −G ab (c22 η + √(ab) c23 φ)`` for small creepages.

    Notes
    -----
    J. J. Kalker, Three-Dimensional Elastic Bodies in Rolling Contact (1990). Computed here: steady rolling
    without limit of friction on two grids, extrapolated; within 1 % of what is printed there.

    Examples
    --------
    >>> f"{kalker_coefficients(1.0, 0.25)[0]:.2f}"  # printed 4.12
    '4.11'
    """
    real("ratio of the semi-axes", ratio, "a ratio from 0.05 to 20", at_least=0.05, at_most=20.0)
    real("Poisson's ratio", poisson, "from 0 to 0.5", at_least=0.0, at_most=0.5)
    body = Material("body", 2.0 * (1.0 + poisson), poisson, 1.0)
    found = []
    for n in GRIDS:
        space = HalfSpace(
            (n, n), (2.0 * math.sqrt(ratio) / n, 2.0 / math.sqrt(ratio) / n), 1.0 / (1.0 - poisson)
        )
        x, y = cell_places(space)
        inside = (x**2 / ratio + y**2 * ratio < 1.0).astype(float)
        contact = replace(space.solve(np.zeros((n, n)), load=1.0), pressure=inside)
        rolling = FrictionalHalfSpace(space, (body, body), 1e9)
        motions = SMALL * np.array(list(DIRECTIONS.values()))
        along, across, spun = (rolling.roll(contact, (xi, eta), spin) for xi, eta, spin in motions)
        covered = inside.sum() * space.cell_area / math.pi  # that of the ellipse of as many cells, for one
        force = -np.array((along.force[0], across.force[1], spun.force[1])) / SMALL
        found.append(force / covered ** np.array((1.0, 1.0, 1.5)))
    c11, c22, c23 = (2.0 * found[1] - found[0]).tolist()
    return c11, c22, c23


@dataclass(frozen=True)
class RollingEllipse:
    """The smooth contact of a creep curve.

    Parameters
    ----------
    semi_axes : (float, float)
        Along and across the rolling direction, m.
    shear_modulus : float
        Of both bodies as one, Pa: 1/G is the mean of their 1/G.
    poisson_ratio : float
        Likewise, ν/G is the mean.
    """

    semi_axes: tuple[float, float]
    shear_modulus: float
    poisson_ratio: float

    @property
    def mean_axis(self) -> float:
        """√(ab), m."""
        return math.sqrt(self.semi_axes[0] * self.semi_axes[1])

    @property
    def coefficients(self) -> tuple[float, float, float]:
        """Kalker's c11, c22 and c23."""
        return kalker_coefficients(self.semi_axes[0] / self.semi_axes[1], self.poisson_ratio)

    def linear_force(self, creepage: tuple[float, float], spin: float) -> tuple[float, float]:
        """Force on the first body by Kalker's linear theory, N; for creepages as a contact rolls."""
        c11, c22, c23 = self.coefficients
        unit = self.shear_modulus * self.mean_axis**2
        return -unit * c11 * creepage[0], -unit * (c22 * creepage[1] + c23 * self.mean_axis * spin)

    def fastsim_force(self, creepage: tuple[float, float], spin: float, limit: float) -> tuple[float, float]:
        """Force on the first body by FASTSIM, N, of a contact whose friction carries `limit`, N.

        J. J. Kalker, Vehicle System Dynamics 11 (1982) 1: each cell is displaced by its own traction alone,
        with the flexibilities of the linear theory, under a parabolic bound.
        """
        a, b = self.semi_axes
        c11, c22, c23 = self.coefficients
        g = self.shear_modulus
        l1 = 8.0 * a / (3.0 * g * c11)
        l2 = 8.0 * a / (3.0 * g * c22)
        l3 = math.pi * a * math.sqrt(a / b) / (4.0 * g * c23)
        y = b * (2.0 * (np.arange(STRIPS) + 0.5) / STRIPS - 1.0)
        edge = a * np.sqrt(1.0 - (y / b) ** 2)
        step = 2.0 * edge / STRIPS
        traction = np.zeros(STRIPS, dtype=complex)
        total = 0.0j
        for k in range(STRIPS):
            x = edge - (k + 0.5) * step
            moved = step if k else 0.5 * step
            turning = spin / l3 * (1j * (x + 0.5 * moved) - y)
            traction = traction - moved * (creepage[0] / l1 + 1j * creepage[1] / l2 + turning)
            bound = 2.0 * limit / (math.pi * a * b) * (1.0 - (x / a) ** 2 - (y / b) ** 2)
            traction *= np.minimum(1.0, bound / np.maximum(np.abs(traction), np.finfo(float).tiny))
            total += complex(np.sum(traction * step)) * 2.0 * b / STRIPS
        return total.real, total.imag


def contact_rows(contact: Contact) -> int:
    """Rows of the grid in which there is contact."""
    return int(np.count_nonzero(contact.pressure.any(axis=1)))


def has_room(smooth: Contact, heights: Array) -> bool:
    """Whether a sample of heights (rows, ny) is long enough for a smooth contact to roll over it."""
    return len(heights) - len(smooth.pressure) >= LEAST_LENGTHS * contact_rows(smooth)


def rolled_over(
    rolling: FrictionalHalfSpace, smooth: Contact, heights: Array, motions: ArrayLike, speed: float = 1.0
) -> Iterator[tuple[SlidingContact, list[SlidingContact]]]:
    """Roll the body of a smooth contact over a sample of heights (rows, ny), m, under the same load.

    The rough surface moves through the contact with the material, as asperities do where bodies roll: each
    comes in without traction. Yields, for each of the motions (ξ, η, φ), the smooth contact in steady rolling
    and those over the sample that count in transient rolling, in steps of the same length: of a cell where
    it is covered, else longer ones.

    Raises
    ------
    InputError
        If the sample has no room for it.
    """
    space = rolling.half_space
    body = smooth.undeformed_gap
    length = contact_rows(smooth)
    rows = len(body)
    spare = len(heights) - len(body)
    stride = 1 if space.cells == "covered" else math.ceil(length / STEPS)
    allowed = f"at least {rows + LEAST_LENGTHS * length} rows, the window and {LEAST_LENGTHS} contacts"
    remedy = "Lengthen it, in a case by contact.sample_length."
    require(has_room(smooth, heights), "sample to roll over", count_of(len(heights), "row"), allowed, remedy)
    steps = min(LENGTHS * length, spare) // stride
    contacts = list[Contact]()
    pressure = None
    first = (spare - steps * stride) // 2
    for row in range(first, first + steps * stride + 1, stride):
        contacts.append(space.solve(body - heights[row : row + rows], load=smooth.force, start=pressure))
        pressure = np.roll(contacts[-1].pressure, -stride, axis=0)
    roll = partial(rolling.roll, distance=stride * space.spacing[0], speed=speed, rtol=ROLLED_RTOL)
    for xi, eta, spin in np.asarray(motions, dtype=float).tolist():
        steady = state = roll(smooth, (xi, eta), spin)
        found = []
        for contact in contacts:
            start = replace(state, traction=np.roll(state.traction, -stride, axis=1))
            state = roll(contact, (xi, eta), spin, before=state, start=start)
            found.append(state)
        yield steady, found[UNCOUNTED * length // stride :]


def over_smooth(steady: SlidingContact, found: list[SlidingContact], axis: int) -> tuple[float, float]:
    """Mean force of rough contacts along an axis over that of the smooth one, and the share that slips."""
    shares = [(each.force[axis] / steady.force[axis], each.slip_area / each.normal.area) for each in found]
    force, share = np.mean(shares, axis=0).tolist()
    return force, share


@dataclass(frozen=True, eq=False)
class CreepCurve:
    """Creep force over a creepage, against it, N.

    Attributes
    ----------
    direction : str
        ``"longitudinal"``, ``"lateral"`` or ``"spin"``, whose force is lateral.
    creepage : ndarray (n,)
        Of the direction; of spin times √(ab).
    limit : float
        What friction carries where all slips, N.
    force, slip_share : ndarray (1 + samples, n)
        Of the smooth contact, then of samples: the force, and the share of the contact that slips.
    linear, fastsim : ndarray (n,)
        Force by Kalker's linear theory and by FASTSIM, of the smooth contact.
    """

    direction: str
    creepage: Array
    limit: float
    force: Array
    slip_share: Array
    linear: Array
    fastsim: Array

    @property
    def slopes(self) -> Array:
        """Force of each contact over the linear theory's at the smallest creepage, (1 + samples,)."""
        return self.force[:, 0] / self.linear[0]


def creep_curve(
    rolling: FrictionalHalfSpace,
    smooth: Contact,
    semi_axes: tuple[float, float],
    direction: str = "longitudinal",
    creepages: ArrayLike | None = None,
    count: int = 16,
    samples: Sequence[Array] = (),
    speed: float = 1.0,
    progress: Progress | None = None,
) -> CreepCurve:
    """Creep force over creepage of contacts under one load, with the linear theory and FASTSIM beside it.

    Parameters
    ----------
    rolling : FrictionalHalfSpace
        Bodies and friction.
    smooth : Contact
        Without roughness, under the load.
    semi_axes : (float, float)
        Of the smooth contact, along and across, m.
    direction : str
        ``"longitudinal"``, ``"lateral"`` or ``"spin"``.
    creepages : array_like (n,), optional
        Above zero and rising, those of spin times √(ab); by default `count` up to full slip.
    count : int
        How many, where none are given.
    samples : sequence of ndarray (rows, ny)
        Heights of rough samples, m, peaks positive, on the grid, that are rolled over: rows of the window
        and of four contacts, at least of three.
    speed : float
        Rolling speed, m/s, for friction that falls with the slip velocity.
    progress : callable, optional
        ``progress(done, total, message)``.

    Returns
    -------
    CreepCurve
        The curve.

    Raises
    ------
    InputError
        For another direction, creepages that do not rise from above zero, or samples that are too short.

    Notes
    -----
    Force and slip of a sample are means along it: its asperities come in at the leading edge and move through
    the contact. A pattern that stood still in the contact would let each asperity begin anew.
    """
    unit = np.array(DIRECTIONS[one_of("direction of creep", direction, DIRECTIONS)])
    ny = smooth.half_space.shape[1]
    samples = [
        finite_array("sample", each, f"heights in m, {ny} columns", shape=(None, ny)) for each in samples
    ]
    ellipse = RollingEllipse(
        two_lengths("semi-axes", semi_axes), rolling.shear_modulus, rolling.poisson_ratio
    )
    unit[2] /= ellipse.mean_axis
    axis = 0 if direction == "longitudinal" else 1
    stuck = -ellipse.linear_force((unit[0], unit[1]), unit[2])[axis]
    full = rolling.roll(smooth).limit
    if creepages is None:
        whole("points of the curve", count, "a whole number of at least 1", at_least=1)
        creepages = FULL_SLIP * full / stuck * (np.arange(1, count + 1) / count) ** 1.5
    xi = finite_array("creepages", creepages, "rising numbers above 0", shape=(None,), rising=True, above=0.0)
    points = [(at * unit[0], at * unit[1], at * unit[2]) for at in xi]
    force, share = np.zeros((2, 1 + len(samples), len(xi)))

    def rolled(sample: Array) -> Array:
        found = rolled_over(rolling, smooth, sample, points, speed)
        return np.array([over_smooth(*each, axis) for each in found]).T

    with warnings.catch_warnings():  # that spin makes a contact pivot is what its curve shows
        warnings.filterwarnings("ignore", "A spin of", OutOfRangeWarning)
        last: SlidingContact | None = None
        for j, motion in enumerate(points):
            last = rolling.roll(smooth, motion[:2], motion[2], start=last, speed=speed)
            force[0, j] = -last.force[axis]
            share[0, j] = last.slip_area / smooth.area
        found = counted(in_order(rolled, samples), len(samples), "creep forces of rough samples", progress)
        for i, (ratio, slips) in enumerate(found, 1):
            force[i] = ratio * force[0]
            share[i] = slips
    fast = [-ellipse.fastsim_force(each[:2], each[2], full)[axis] for each in points]
    return CreepCurve(direction, xi, full, force, share, stuck * xi, np.array(fast))


# --- friction that follows the load, quasi-steady: at each as if it had always been there

SIZES = np.linspace(0.2, 1.0, 17)
"""Sizes of the contact, cube roots of the load over the largest one, at which it is solved."""
MOST, HALVINGS = 100.0, 12
"""Times the creepages, and part of them, between which full slip is sought; halvings of that interval."""
CREEP_CHANGE, LOAD_CHANGE = 0.05, 0.25
"""Shares by which creepage and load are changed for slopes of the force; less moves single cells."""
ROUNDING = 1e-7
"""Share of what friction carries below which a force is none: it would be opposite by symmetry."""


class SteadyRolling(ABC):
    """Friction of two smooth bodies that roll steadily, under any load up to the largest.

    Notes
    -----
    Quasi-steady: the load changes little while a place passes through the contact, so that waves of the force
    are long against it, v/f > 2a. The pressure is that of smooth bodies without friction.
    """

    speed: float
    largest_load: float

    @abstractmethod
    def at(self, load: float) -> SlidingContact:
        """The contact under a load, N."""

    @cached_property
    def _shares(self) -> Array:
        """Forces along and across, moment, and heat over the length rolled, over the load (4, k)."""
        loads = self.largest_load * SIZES**3
        found = [self.at(load) for load in loads.tolist()]
        return np.array([(*forces_of(each), each.work) for each in found]).T / loads

    def follow(self, force: Array) -> Array:
        """Forces on the first body along and across, N, and moment, N m (3, ...), of a normal force (...), N.

        Zero where there is none.
        """
        return np.stack([self._followed(force, shares) for shares in self._shares[:3]])

    def power(self, force: Array) -> Array:
        """What friction turns into heat under a normal force (...), N, in W."""
        return self.speed * self._followed(force, self._shares[3])

    def _followed(self, force: Array, shares: Array) -> Array:
        load = np.maximum(force, 0.0)
        return load * np.interp(np.cbrt(load / self.largest_load), SIZES, shares)


@dataclass(frozen=True, eq=False)
class CreepingBodies(SteadyRolling):
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
    """

    rolling: FrictionalHalfSpace
    gap: Array = field(repr=False)
    creepage: tuple[float, float, float]
    speed: float
    largest_load: float

    def at(self, load: float, scale: float = 1.0, across: float = 0.0) -> SlidingContact:
        """The contact under a load, N, with the creepages times a scale, and a lateral one added.

        Creepages that are out of range are not told of.
        """
        xi, eta, spin = (scale * each for each in self.creepage)
        contact = self.rolling.half_space.solve(self.gap, load=load)
        with OutOfRangeWarning.ignored():
            return self.rolling.roll(contact, (xi, eta + across), spin, speed=self.speed)

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


def forces_of(found: SlidingContact) -> Array:
    """Forces on the first body along and across, N, and moment about the normal, N m (3,)."""
    forces = np.array((*found.force, found.moment))
    arms = (1.0, 1.0, math.sqrt(found.normal.area))
    return np.where(np.abs(forces) > ROUNDING * found.limit * np.array(arms), forces, 0.0)


def _change(holds: Callable[[float], bool], low: float, high: float) -> float:
    """Where something begins to hold between two positive numbers; infinite if it does not."""
    if not holds(high):
        return math.inf
    for _ in range(HALVINGS):
        middle = math.sqrt(low * high)
        low, high = (low, middle) if holds(middle) else (middle, high)
    return math.sqrt(low * high)
