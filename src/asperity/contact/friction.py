"""Coulomb's law, and what is known of a contact with friction once it is solved."""

import math
from dataclasses import dataclass, field

import numpy as np

from asperity.arguments import Array, ArrayLike, Flags, finite_array, real
from asperity.contact.elastic_grid import ElasticGrid
from asperity.contact.solved import Contact
from asperity.errors import Outcome, percent
from asperity.kernels.rims import cells_covered
from asperity.written_numbers import rounded

PIVOTING = 0.99
"""Share of slip from which on spin may say more than creepage."""


@dataclass(frozen=True, eq=False)
class Friction:
    """Coefficient of friction: one number, or one for each cell.

    Parameters
    ----------
    static : float or array_like (nx, ny)
        Of a cell that sticks.
    kinetic : float, optional
        Share of it that is left to a cell that slips, from 0 to 1; by default all of it.
    velocity : float, optional
        Slip velocity, m/s, over which the coefficient falls: µ(v) = µ_s (k + (1 − k) exp(−v/velocity)). By
        default it falls at once.

    Raises
    ------
    InputError
        If a coefficient is below zero or no number.

    Notes
    -----
    The exponential is that of O. Polach, Wear 258 (2005) 992, here at each cell. Where the coefficient falls
    at once, a cell that has slipped in a solution keeps the lower one in it, and on covered cells all of its
    patch: slip runs on from its rims, as nothing takes up what is released there.

    Examples
    --------
    >>> import numpy as np
    >>> from asperity import Friction
    >>> falling = Friction(0.4, kinetic=0.5, velocity=1.0)
    >>> falling.coefficient(np.array([0.0, 1.0]), np.array([False, True])).round(3).tolist()
    [0.4, 0.274]
    """

    static: float | ArrayLike
    kinetic: float = 1.0
    velocity: float | None = None

    def __post_init__(self) -> None:
        allowed = "coefficients of friction of at least 0"
        finite_array("friction", self.static, allowed, at_least=0.0)
        real("kinetic share of friction", self.kinetic, "from 0 to 1", at_least=0.0, at_most=1.0)
        if self.velocity is not None:
            real("slip velocity of friction", self.velocity, "a velocity above 0, m/s", above=0.0)

    @property
    def falls(self) -> bool:
        """Whether the coefficient depends on the slip; of a subclass it may."""
        return self.kinetic < 1.0 or type(self) is not Friction

    def coefficient(self, velocity: Array, slipped: Array) -> Array:
        """Coefficient of cells (nx, ny) at a slip velocity, m/s, that have slipped or not."""
        fallen = slipped if self.velocity is None else -np.expm1(-velocity / self.velocity)
        return np.asarray(self.static, dtype=float) * (1.0 - (1.0 - self.kinetic) * fallen)


@dataclass(frozen=True, eq=False)
class SlidingContact:
    """A contact with friction.

    Attributes
    ----------
    normal : Contact
        The contact under its load, with what tractions of unlike bodies change in it.
    traction : ndarray, shape (2, nx, ny)
        On the first body, along and across the rolling direction, Pa.
    slip : ndarray, shape (2, nx, ny)
        Of the first body against the second, zero out of contact: over the rolled distance; of a shift m.
    sticks : ndarray of bool, shape (nx, ny)
        Cells in contact that stick.
    bound : ndarray, shape (nx, ny)
        Largest traction, µ p, Pa.
    creepage : tuple of float
        ξ, η (a shift: m) and spin φ, 1/m (a shift: rad).
    speed : float
        Rolling speed, m/s; zero for a shift.
    work : float
        What friction turns into heat over a rolled distance, J/m; of a shift J. Taken from forces and
        creepages: see the notes.
    elastic_energy : float
        What the tractions store in both bodies, ½ ∫ traction · displacement, J.
    iterations, convolutions : int
        Of Newton's method, all solutions together.
    residual : float
        Largest slip against Coulomb's law, over the largest rigid slip.
    outcome : Outcome
        How the solution ended.
    creepage_curvature : float
        χ, by which the creepage along is less at y across, over y², 1/m².
    distance : float
        Rolled distance over which slip is counted, m; zero for a shift.
    left : ndarray, shape (2, nx, ny), optional
        What rims leave in cells, m, once shifts on covered cells have turned: see `contact.traction_rims`.

    Notes
    -----
    `work` in steady rolling is what drives it, −(F_x ξ + F_y η + M φ − C χ), C being `second_moment`, since
    what it stores stays the same; in a step of a transient it is the mean of that before and after, less the
    growth of the elastic energy over the distance, which may be below zero in a single step where the slip
    turns back; in a shift, each cell slips under the mean of its bounds before and after. Where pressures
    stay as they are and slip goes one way that is ∫ F · d(shift) less the growth of the elastic energy,
    however long the shift. In rolling of unlike bodies the displacement by their pressure is counted, too:
    they need no force to slip, and a pressure that leans ahead, with the moment that it has, drives it.

    Examples
    --------
    >>> import numpy as np
    >>> from asperity import FrictionalHalfSpace, HalfSpace, material
    >>> steel, x = material("steel"), 0.4e-3 * (np.arange(32) - 15.5)
    >>> wheel = np.add.outer(x**2, x**2) / (2 * 0.4)
    >>> space = HalfSpace(wheel.shape, 0.4e-3, 0.5 * 210e9 / (1 - 0.3**2))
    >>> braked = FrictionalHalfSpace(space, (steel, steel), 0.3)
    >>> found = braked.roll(space.solve(wheel, load=50e3), creepage=(0.05, 0.0))  # locked, nearly
    >>> f"{found.force[0]:.0f} N", found.stick_area
    ('-15000 N', 0.0)
    """

    normal: Contact = field(repr=False)
    traction: Array = field(repr=False)
    slip: Array = field(repr=False)
    sticks: Flags = field(repr=False)
    bound: Array = field(repr=False)
    creepage: tuple[float, float, float]
    speed: float
    work: float
    elastic_energy: float
    iterations: int
    convolutions: int
    residual: float
    outcome: Outcome
    creepage_curvature: float = 0.0
    distance: float = 0.0
    left: Array | None = field(default=None, repr=False)

    @property
    def converged(self) -> bool:
        """Whether the tolerance was met."""
        return self.outcome.ok

    @property
    def force(self) -> tuple[float, float]:
        """Resultant on the first body, along and across, N."""
        fx, fy = (float(each.sum()) * self.normal.half_space.cell_area for each in self.traction)
        return fx, fy

    @property
    def moment(self) -> float:
        """Moment on the first body about the normal through the middle of the grid, N m."""
        x, y = cell_places(self.normal.half_space)
        arms = x * self.traction[1] - y * self.traction[0]
        return float(arms.sum()) * self.normal.half_space.cell_area

    @property
    def second_moment(self) -> float:
        """∫ y² · traction along, on the first body, N m²: what a curvature of the creepage works against."""
        _, y = cell_places(self.normal.half_space)
        return float((y**2 * self.traction[0]).sum()) * self.normal.half_space.cell_area

    @property
    def limit(self) -> float:
        """Largest force that friction carries, N."""
        return float(self.bound.sum()) * self.normal.half_space.cell_area

    @property
    def stick_area(self) -> float:
        """Area that sticks, m²: on covered cells that inside the rims of what is missing of the bound."""
        space = self.normal.half_space
        if space.sides is None:
            return float(self.sticks.sum()) * space.cell_area
        missing = np.where(self.sticks, np.maximum(self.bound - np.hypot(*self.traction), 0.0), 0.0)
        return min(cells_covered(missing, *space.sides) * space.cell_area, self.normal.area)

    @property
    def slip_area(self) -> float:
        """Area that slips, m²."""
        return self.normal.area - self.stick_area

    @property
    def dissipated_power(self) -> float:
        """What friction turns into heat at the rolling speed, W: `work` times it.

        In steady rolling of like bodies exactly −V (F_x ξ + F_y η + M φ − C χ), from `force`, `creepage`,
        `moment` and `second_moment`; of unlike ones with V ∫ p x/R of the pressure, but for what cells miss.
        """
        return self.work * self.speed

    @property
    def work_of_slip(self) -> float:
        """Traction after a step times slip in it, as the program CONTACT counts work, J/m; of a shift J.

        In rolling it misses a part of `work`, of first order in the cells: most where little slips.
        """
        return -float((self.traction * self.slip).sum()) * self.normal.half_space.cell_area


def cell_places(space: ElasticGrid) -> tuple[Array, Array]:
    """Places of the cells from the middle of the grid, (nx, 1) and (1, ny), m."""
    x, y = (
        d * (np.arange(float(n)) - 0.5 * (n - 1)) for n, d in zip(space.shape, space.spacing, strict=True)
    )
    return x[:, None], y[None, :]


def doubts(found: SlidingContact, largest: float) -> list[str]:
    """What makes a solution doubtful, in words: a creepage beyond the largest that is small, a pivot."""
    words = []
    creepage = math.hypot(*found.creepage[:2])
    slips = found.slip_area
    area = found.normal.area
    slipping = percent(slips / area) if area else "nothing"
    if creepage > largest:
        words.append(
            f"A creepage of {rounded(creepage)} is above {largest:g}: strains and paths are those of small "
            f"creepages, and {slipping} of the contact slips. Lower it."
        )
    xi, eta, spin = found.creepage
    if spin and slips > PIVOTING * area:
        x, y = cell_places(found.normal.half_space)
        away = np.hypot(x + eta / spin, y - xi / spin)[found.normal.pressure > 0.0]
        if away.min(initial=math.inf) < math.hypot(*found.normal.half_space.spacing):
            words.append(
                f"A spin of {rounded(spin)} /m makes the contact pivot on a place inside of it: "
                f"{slipping} of it slips, and the force says little of the creepage. Lower the spin."
            )
    return words
