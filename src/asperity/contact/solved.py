"""A contact of a half-space, solved: pressure and force, and what follows from them."""

import math
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np

from asperity.arguments import Array
from asperity.errors import Outcome
from asperity.units import written

if TYPE_CHECKING:
    from asperity.contact.elastic_grid import ElasticGrid
    from asperity.surfaces.edges import Edges

BEYOND_RIM = (math.pi - 1.0 + math.log(2.0)) / 24.0
"""Of a cell, for each of its sides at a rim: V. A. Yastrebov, G. Anciaux, J.-F. Molinari, Tribol. Int. 114
(2017) 161."""


@dataclass(frozen=True, eq=False)
class Contact:
    """A solved contact.

    Attributes
    ----------
    pressure : ndarray, shape (nx, ny)
        Contact pressure, Pa.
    force : float
        Resultant, N.
    approach : float
        Approach of the bodies, m, positive closing.
    area : float
        Of the cells under pressure, m²: whole ones are counted, and stand out beyond rims, which `real_area`
        takes off; those that are covered, or sound at sharp edges, in part count as far as they are.
    iterations : int
        Conjugate-gradient iterations, all inner solutions together.
    residual : float
        Largest complementarity residual relative to the largest overlap of the undeformed bodies. Of cells
        that are covered in part it counts as far as it moves pressure.
    outcome : Outcome
        How the solution ended, with advice.

    Examples
    --------
    >>> import numpy as np
    >>> from asperity import HalfSpace
    >>> x = 5e-6 * np.arange(-20, 21)
    >>> ball = np.add.outer(x**2, x**2) / (2 * 10e-3)  # R = 10 mm
    >>> contact = HalfSpace(ball.shape, (5e-6, 5e-6), 115e9).solve(ball, load=1.0)
    >>> contact.pressure.shape, bool(contact.pressure.argmax() == contact.pressure.size // 2)
    ((41, 41), True)
    """

    pressure: Array
    force: float
    approach: float
    area: float
    iterations: int
    residual: float
    outcome: Outcome
    half_space: "ElasticGrid"
    undeformed_gap: Array
    edges: "Edges | None" = None

    def __repr__(self) -> str:
        force, pressure, approach = (
            written(float(f"{value:.4g}"), unit, usual)
            for value, unit, usual in (
                (self.force, "N", "N"),
                (np.max(self.pressure, initial=0.0), "Pa", "GPa"),
                (self.approach, "m", "um"),
            )
        )
        cells = f"{np.count_nonzero(self.pressure)} of {self.pressure.size} cells"
        solved = f"converged in {self.iterations} iterations" if self.converged else f"{self.outcome.name}"
        return (
            f"<Contact: {force} at an approach of {approach}, pressure up to {pressure} "
            f"on {cells} ({self.area * 1e6:.4g} mm²), {solved}>"
        )

    @property
    def real_area(self) -> float:
        """Real area of contact, m²: of whole cells less what they stand out beyond rims on average.

        That is `BEYOND_RIM` of a cell for each side between one in contact and one that is not.
        """
        space = self.half_space
        if space.cells != "whole" or self.edges is not None:
            return self.area
        beyond = 0 if space.boundary == "periodic" else 1  # cells that touch nothing
        touching = np.pad(self.pressure > 0.0, beyond)
        sides = sum(np.count_nonzero(touching != np.roll(touching, 1, axis)) for axis in (0, 1))
        return self.area - BEYOND_RIM * sides * space.cell_area

    @property
    def converged(self) -> bool:
        """Whether the tolerance was met."""
        return self.outcome.ok

    @cached_property
    def gap(self) -> Array:
        """Gap after elastic deformation, m, shape (nx, ny).

        Below zero only where the hardness caps the pressure.
        """
        gap = self.undeformed_gap + self.half_space.displacement(self.pressure) - self.approach
        return gap if self.edges is None else gap + self.half_space.softness(self.edges).sunk(self.pressure)

    @cached_property
    def plastic_indentation(self) -> Array:
        """Depth by which the surface has yielded for good, m ≥ 0, shape (nx, ny).

        The overlap that the capped pressure leaves. Heights less this depth carry the same pressure without
        yielding: a second loading is elastic.
        """
        capped = self.pressure >= self.half_space.pressure_cap
        return np.where(capped, np.maximum(-self.gap, 0.0), 0.0)

    @property
    def yielded_share(self) -> float:
        """Share of the real contact area whose pressure is at the hardness; one in full plasticity."""
        capped = np.count_nonzero(self.pressure >= self.half_space.pressure_cap)
        return float(capped / max(int(np.count_nonzero(self.pressure)), 1))

    @cached_property
    def stiffness(self) -> float:
        """Tangent stiffness dF/dδ of this contact, N/m: one linear solution on the contact set, exact."""
        return self.half_space.tangent_stiffness(self.pressure, edges=self.edges)

    @property
    def edge_share(self) -> float:
        """Share of the force that acts on the window's outermost cells: above zero, some may be cut off.

        Zero for a period, which has no edge.
        """
        return 0.0 if self.half_space.boundary == "periodic" else float(edge_share(self.pressure))


def edge_share(pressure: Any) -> Any:
    """Share of the force of pressures (..., nx, ny) that acts on the window's outermost cells."""
    nx, ny = pressure.shape[-2:]
    edge = pressure[..., :: max(1, nx - 1), :].sum(axis=(-2, -1))
    edge += pressure[..., 1:-1, :: max(1, ny - 1)].sum(axis=(-2, -1))
    total = pressure.sum(axis=(-2, -1))
    return edge / (total + (total == 0.0))
