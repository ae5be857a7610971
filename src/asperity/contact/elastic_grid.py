"""Elastic half-space on a grid of cells: how pressure displaces it, and how stiff a contact is."""

import math
from functools import lru_cache

import numpy as np

from asperity import arguments
from asperity.arguments import Array, ArrayLike, Flags, real, require, shown
from asperity.contact.edges import Softness, softness_at
from asperity.contact.periodic_influence import BOUNDARIES, lifted_table, stiffness_of_lifted
from asperity.errors import Outcome, UnconvergedWarning
from asperity.kernels import fourier, projected_cg, rims
from asperity.kernels.batched import (
    FEW,
    apply_stencil,
    between_cells,
    convolve_padded,
    padded_spectrum,
    unit_indentation,
)
from asperity.kernels.influence import Influence, influence, influence_table, means_table
from asperity.surfaces.edges import Edges
from asperity.units import written
from asperity.written_numbers import in_newtons, rounded

MAX_ITERATIONS = 2000
CELLS = ("covered", "whole")
"""What `cells` may be."""
MOST_ELONGATED = 6.0
"""Sides of covered cells over each other, at most: iterations rise from 11 to 21 up to there.

With eight a contact takes hundreds, and some none that suffices (``benchmarks/cell_rims.py --elongated``).
"""


def box_around(cells: Flags) -> tuple[slice, slice]:
    """Rows and columns of the smallest box around cells (nx, ny); all of them where there are none."""
    nx, ny = cells.shape
    rows, columns = (np.flatnonzero(cells.any(axis=axis)).tolist() for axis in (1, 0))
    if not rows:
        return slice(0, nx), slice(0, ny)
    return slice(rows[0], rows[-1] + 1), slice(columns[0], columns[-1] + 1)


class ElasticGrid:
    """Elastic half-space on a grid of rectangular cells, as `HalfSpace` describes it."""

    def __init__(
        self,
        shape: tuple[int, int],
        spacing: float | tuple[float, float],
        modulus: float,
        hardness: float | None = None,
        cells: str = "whole",
        boundary: str = "free",
    ) -> None:
        allowed = "two positive whole numbers (nx, ny)"
        sides = arguments.two("half-space shape", shape, allowed)
        nx, ny = (arguments.whole("half-space shape", n, allowed, at_least=1) for n in sides)
        self.shape = (nx, ny)
        self.spacing = arguments.two_lengths("half-space spacing", spacing)
        remedy = "Steel on steel has 115e9."
        self.modulus = real("contact modulus", modulus, "a positive number, Pa", above=0.0, remedy=remedy)
        allowed = "a positive number, Pa, or None"
        self.hardness = None if hardness is None else real("hardness", hardness, allowed, above=0.0)
        require(cells in CELLS, "cells of the half-space", repr(cells), " or ".join(map(repr, CELLS)))
        self.cells = cells
        known = isinstance(boundary, str) and boundary in BOUNDARIES
        require(known, "boundary", shown(boundary), " or ".join(map(repr, BOUNDARIES)))
        self.boundary = boundary
        covers = cells == "whole" or boundary == "free"
        remedy = "What the rim of a contact leaves is known of pressures on cells, and not of their waves."
        require(covers, "cells of a periodic half-space", repr(cells), "'whole'", remedy)
        elongation = max(self.spacing) / min(self.spacing)
        received = f"covered cells of {' × '.join(written(each, 'm', 'um') for each in self.spacing)}"
        allowed = f"sides up to 1 : {MOST_ELONGATED:g}"
        remedy = 'Refine the longer side, or take cells="whole".'
        covers = cells == "whole" or elongation <= MOST_ELONGATED
        require(covers, "spacing of the half-space", received, allowed, remedy)
        reach_x, reach_y = (fourier.smooth_length(max(n, 32)) for n in self.shape)
        dx, dy = self.spacing
        scale = math.pi * self.modulus
        if boundary == "periodic":
            table, self.lift = lifted_table(self.shape, self.spacing, self.modulus)
        else:
            make = influence_table if cells == "whole" else means_table
            table = make(reach_x, reach_y, dx, dy) / scale
            self.lift = 0.0
        taps = _unit_taps(dy / dx) * (scale / dx)
        self.sides = (dx / self.modulus, dy / self.modulus) if cells == "covered" else None
        self.known = {dtype: influence(table, taps, dtype) for dtype in (np.float64, np.float32)}

    def __repr__(self) -> str:
        spacing = " × ".join(written(each, "m", "um") for each in self.spacing)
        cells = f"{self.shape[0]} × {self.shape[1]} {self.cells} cells of {spacing}"
        yields = "elastic" if self.hardness is None else f"hardness {written(self.hardness, 'Pa', 'GPa')}"
        modulus = written(self.modulus, "Pa", "GPa")
        return f"<{type(self).__name__}: {cells}, E* {modulus}, {yields}, {self.boundary} boundary>"

    @property
    def influence(self) -> Influence:
        """Influence of pressure on displacement, in double precision."""
        return self.known[np.float64]

    @property
    def cell_area(self) -> float:
        """Area of one cell, m²."""
        return self.spacing[0] * self.spacing[1]

    def displacement(self, pressure: ArrayLike) -> Array:
        """Surface displacement under a pressure, m, positive into the material.

        Parameters
        ----------
        pressure : array_like, shape (nx, ny)
            Pressure, Pa.

        Returns
        -------
        ndarray, shape (nx, ny)
            Displacement, m; of a period without its mean.
        """
        p = self._field("pressure", pressure)
        spectrum = padded_spectrum(self.influence.table, *self.shape)
        return convolve_padded(p[None], spectrum, np)[0] - self.lift * p.sum()

    def tangent_stiffness(self, pressure: ArrayLike, rtol: float = 1e-9, edges: Edges | None = None) -> float:
        """Tangent stiffness dF/dδ of a contact whose pressure is known, N/m.

        Parameters
        ----------
        pressure : array_like, shape (nx, ny)
            A solved pressure, Pa. Cells at the hardness cap carry no further load.
        rtol : float
            Relative residual of the linear solution.
        edges : Edges, optional
            Sharp edges that the pressure was solved with.

        Returns
        -------
        float
            dA · 1ᵀ A⁻¹ 1 on the contact set, N/m; infinite where all of a period touches.
        """
        p = self._field("pressure", pressure)
        free = (p > 0.0) & (p < self.pressure_cap)
        if not free.any():
            return 0.0
        if self.boundary == "periodic" and free.all():
            return math.inf
        if self.cells == "covered":
            return self._stiffness_with_rims(p, free, rtol)
        inside = box_around(free)
        taps = tuple(self.influence.taps.tolist())
        soft = None if edges is None else self.softness(edges).compliance(p)[inside]
        rise, converged = unit_indentation(
            self.influence.table, taps, free[inside], rtol, MAX_ITERATIONS, soft
        )
        if not converged:
            warn_unconverged("tangent stiffness", Outcome.ITERATION_LIMIT)
        stiffness = float(rise.sum()) * self.cell_area
        return stiffness_of_lifted(stiffness, self.lift, self.cell_area) if self.lift else stiffness

    def _stiffness_with_rims(self, pressure: Array, free: Flags, rtol: float) -> float:
        """Tangent stiffness where the gap at rims falls with the pressure: its matrix is not symmetric."""
        from scipy.sparse.linalg import LinearOperator, gmres

        assert self.sides is not None
        slopes = np.zeros((3, *self.shape))
        rims.rim_slopes(contiguous(pressure), *self.sides, self.pressure_cap, slopes)
        own, along, across = slopes
        inside = np.flatnonzero(free)
        if len(inside) <= FEW:
            return self._stiffness_of_few(free, own, along, across)
        softer = 1.0 / np.sqrt(1.0 + rims.SHARED * np.maximum(-own, 0.0) * self.influence.taps[0])
        taps = tuple(self.influence.taps.tolist())
        spectrum = padded_spectrum(self.influence.table, *self.shape)
        field = np.zeros(self.shape)

        def spread(values: Array) -> Array:
            field.flat[inside] = values
            return field

        def displaced(values: Array) -> Array:
            p = np.pad(spread(values), 1)
            gap = (
                own * p[1:-1, 1:-1]
                + along * (p[2:, 1:-1] - p[:-2, 1:-1])
                + across * (p[1:-1, 2:] - p[1:-1, :-2])
            )
            return (convolve_padded(field[None], spectrum, np)[0] - gap).flat[inside]

        def preconditioned(values: Array) -> Array:
            return (softer * apply_stencil((softer * spread(values))[None], taps, np)[0]).flat[inside]

        size = (len(inside), len(inside))
        operator = LinearOperator(size, displaced, dtype=np.float64)
        inverse = LinearOperator(size, preconditioned, dtype=np.float64)
        rise, missed = gmres(
            operator, np.ones(len(inside)), rtol=rtol, atol=0.0, restart=60, maxiter=20, M=inverse
        )
        if missed:
            warn_unconverged("tangent stiffness", Outcome.ITERATION_LIMIT)
        return float(rise.sum()) * self.cell_area

    def _stiffness_of_few(self, free: Flags, own: Array, along: Array, across: Array) -> float:
        """The same by its matrix, of few cells, and derivatives of their gap at rims (nx, ny), m/Pa."""
        matrix = between_cells(self.influence.table, np.nonzero(free)) - np.diag(own[free])
        number = np.full([n + 2 for n in free.shape], -1)
        number[1:-1, 1:-1][free] = np.arange(len(matrix))
        beside = (number[2:, 1:-1], along), (number[:-2, 1:-1], -along)
        before = (number[1:-1, 2:], across), (number[1:-1, :-2], -across)
        for neighbour, slope in (*beside, *before):
            met = np.flatnonzero(neighbour[free] >= 0)
            matrix[met, neighbour[free][met]] -= slope[free][met]
        return float(np.linalg.solve(matrix, np.ones(len(matrix))).sum()) * self.cell_area

    @property
    def pressure_cap(self) -> float:
        """Largest pressure, Pa; infinite without hardness."""
        return math.inf if self.hardness is None else self.hardness

    def checked_load(self, load: float | None) -> float:
        """Check that a load, N, is one that the window carries."""
        load = real("load", load, "a force ≥ 0, N", at_least=0.0)
        largest = self.pressure_cap * self.cell_area * self.shape[0] * self.shape[1]
        allowed = f"less than hardness × window area = {in_newtons(largest)}"
        remedy = "Enlarge the window, raise the hardness or lower the load."
        require(load < largest, "load", in_newtons(load), allowed, remedy)
        return load

    def _field(self, name: str, values: ArrayLike) -> Array:
        allowed = f"finite numbers, an array of the half-space's shape {self.shape}"
        return contiguous(arguments.finite_array(name, values, allowed, shape=self.shape))

    def softness(self, edges: Edges) -> Softness:
        """Find how cells at edges give way."""
        return softness_at(edges, self.modulus, self.hardness)

    def covered_cells(self, pressure: Array, edges: Edges | None) -> float:
        """Number of cells in contact, those at rims as far as they are covered, at edges as far as sound."""
        if edges is not None:
            return self.softness(edges).covered_cells(pressure, edges.shares)
        if self.cells == "whole":
            return int(np.count_nonzero(pressure))
        assert self.sides is not None
        return rims.cells_covered(contiguous(pressure), *self.sides)


def check_edges(edges: Edges, grid: ElasticGrid, shape: tuple[int, int]) -> None:
    """Refuse edges that are on other cells than a surface of so many rows and lines, or on unfit ones."""
    what = "edges of a contact"
    remedy = "Lay them on the cells of the contact."
    own = edges.distance.shape
    given = grid.spacing
    require(own == shape, what, f"shape {own}", f"shape {shape}", remedy)
    received, allowed = (
        f"cells of {rounded(1e6 * x, 6)} × {rounded(1e6 * y, 6)} µm" for x, y in (edges.spacing, given)
    )
    require(np.allclose(edges.spacing, given, rtol=1e-9, atol=0.0), what, received, allowed, remedy)
    remedy = "How much cells at edges give way is known for whole cells and a free boundary."
    fit = (("cells", grid.cells, "whole"), ("boundary", grid.boundary, "free"))
    for name, value, wanted in fit:
        require(value == wanted, f"{name} of a contact with edges", repr(value), repr(wanted), remedy)


def warn_unconverged(what: str, outcome: Outcome) -> None:
    """Warn of a solution that did not converge, with advice."""
    UnconvergedWarning.warn(f"{what} did not converge: {outcome.value}")


@lru_cache
def _unit_taps(ratio: float) -> Array:
    """Preconditioning stencil of cells 1 × ratio, π E* being one."""
    return projected_cg.inverse_stencil(influence_table(32, 32, 1.0, ratio))


def contiguous(values: ArrayLike) -> Array:
    """Array of the one kind that kernels are compiled for: contiguous and writable."""
    return np.require(values, np.float64, ["C", "W"])
