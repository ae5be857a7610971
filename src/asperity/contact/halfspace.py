"""Frictionless contact of an elastic half-space with a rough or smooth body, at given approach or load."""

import math
from dataclasses import replace
from functools import lru_cache
from typing import TYPE_CHECKING, Any

import numpy as np

from asperity import arguments
from asperity.arguments import Array, ArrayLike, NDArray, real, require, shown
from asperity.contact import periodic
from asperity.contact.edges import Softness, check_edges, softness_at
from asperity.contact.solved import Contact, warn_unconverged
from asperity.errors import Outcome
from asperity.kernels import fourier, projected_cg, rims, scanning
from asperity.kernels.batched import apply_stencil, convolve_padded, padded_spectrum, unit_indentation
from asperity.kernels.box import foundation_approach
from asperity.kernels.influence import Influence, influence, influence_table, means_table, prepared
from asperity.progress import Progress
from asperity.store import Store
from asperity.surfaces.edges import Edges
from asperity.surfaces.heightmap import HeightMap
from asperity.surfaces.strip import Rows
from asperity.threads import refuse_to_go_on
from asperity.units import written
from asperity.written_numbers import count_of, in_newtons, rounded

if TYPE_CHECKING:
    import xarray

MAX_ITERATIONS = 2000
CELLS = ("covered", "whole")
"""What `cells` may be."""
BELOW_ONE = math.nextafter(1.0, 0.0)
AT_ONCE = 16
"""Positions between two looks at whether the user wants to stop."""


class HalfSpace:
    """Elastic half-space on a grid of rectangular cells, with a free or a periodic boundary.

    Parameters
    ----------
    shape : tuple of int
        (nx, ny) cells.
    spacing : tuple of float
        (dx, dy), m; one number stands for both.
    modulus : float
        Contact modulus E*, Pa: 1/E* = (1 − ν₁²)/E₁ + (1 − ν₂²)/E₂.
    hardness : float, optional
        Pressure cap, Pa: asperities flow at this pressure.
    cells : str
        ``"whole"``: each cell is in contact or not, as in the program CONTACT. ``"covered"``: cells at the
        rim of a contact count as far as they are covered, so that force, stiffness and area grow evenly with
        the approach; gaps are then means over the cells.
    boundary : str
        ``"free"``: nothing presses outside of the grid. ``"periodic"``: the grid is one period, along and
        across, of a surface without end; of (nx, 1) cells, of a line contact in plane strain.

    Notes
    -----
    Pressure is constant on each cell (Love 1929); valid while the contact is small against the bodies and
    slopes are small. Solved as 0 ≤ p ⟂ (K p + gap − approach) ≥ 0 by preconditioned projected conjugate
    gradients on the bounding box of the overlap, outside of which no pressure can act.

    Where cells are whole, each that enters makes the stiffness jump: that of a smooth ball is up to 4 % off
    with 6 cells in the half-width of the contact. Covered cells keep the gap that a rim leaves in them, which
    follows from the pressure beside them (`kernels.rims`): 0.4 %, and 0.2 % with 9 cells. What is solved then
    has no energy of its own; given that gap it has, and each iteration takes it anew. Pressures and
    displacements are means over cells there.

    Without end, bodies under a mean pressure would sink without limit, so a periodic displacement is counted
    from its mean: û(k) = 2 p̂(k)/(E* abs(k)) for each wave that the grid holds, zero for k = 0. An approach
    then is that of the mean planes of the surfaces, whether in contact or not: elastic surfaces touch
    everywhere when it is the mean gap, and any more load leaves it there. Contacts are solved one by one:
    `scan`, `run_in` and friction need a free boundary.

    Examples
    --------
    >>> import numpy as np
    >>> from asperity import HalfSpace
    >>> x = 5e-6 * np.arange(-20, 21)
    >>> ball = np.add.outer(x**2, x**2) / (2 * 10e-3)  # R = 10 mm
    >>> contact = HalfSpace(ball.shape, (5e-6, 5e-6), 115e9).solve(ball, load=1.0)
    >>> contact.converged, f"{contact.force:.3f} N", f"{contact.approach * 1e6:.2f} um"  # by Hertz 0.16 um
    (True, '1.000 N', '0.16 um')
    """

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
        known = isinstance(boundary, str) and boundary in periodic.BOUNDARIES
        require(known, "boundary", shown(boundary), " or ".join(map(repr, periodic.BOUNDARIES)))
        self.boundary = boundary
        covers = cells == "whole" or boundary == "free"
        remedy = "What the rim of a contact leaves is known of pressures on cells, and not of their waves."
        require(covers, "cells of a periodic half-space", repr(cells), "'whole'", remedy)
        reach_x, reach_y = (fourier.smooth_length(max(n, 32)) for n in self.shape)
        dx, dy = self.spacing
        scale = math.pi * self.modulus
        if boundary == "periodic":
            table, self.lift = periodic.lifted_table(self.shape, self.spacing, self.modulus)
        else:
            make = influence_table if cells == "whole" else means_table
            table, self.lift = make(reach_x, reach_y, dx, dy) / scale, 0.0
        taps = _unit_taps(dy / dx) * (scale / dx)
        self._sides = (dx / self.modulus, dy / self.modulus) if cells == "covered" else None
        self._known = {dtype: influence(table, taps, dtype) for dtype in (np.float64, np.float32)}

    def __repr__(self) -> str:
        spacing = " × ".join(written(each, "m", "um") for each in self.spacing)
        cells = f"{self.shape[0]} × {self.shape[1]} {self.cells} cells of {spacing}"
        yields = "elastic" if self.hardness is None else f"hardness {written(self.hardness, 'Pa', 'GPa')}"
        modulus = written(self.modulus, "Pa", "GPa")
        return f"<{type(self).__name__}: {cells}, E* {modulus}, {yields}, {self.boundary} boundary>"

    @property
    def influence(self) -> Influence:
        """Influence of pressure on displacement, in double precision."""
        return self._known[np.float64]

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
        p, spectrum = self._field("pressure", pressure), padded_spectrum(self.influence.table, *self.shape)
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
        rows, columns = (np.flatnonzero(free.any(axis=axis)) for axis in (1, 0))
        inside = free[rows[0] : rows[-1] + 1, columns[0] : columns[-1] + 1]
        taps = tuple(self.influence.taps.tolist())
        soft = None
        if edges is not None:
            giving = self.softness(edges).compliance(p)
            soft = giving[rows[0] : rows[-1] + 1, columns[0] : columns[-1] + 1]
        rise, converged = unit_indentation(self.influence.table, taps, inside, rtol, MAX_ITERATIONS, soft)
        if not converged:
            warn_unconverged("tangent stiffness", Outcome.ITERATION_LIMIT)
        stiffness = float(rise.sum()) * self.cell_area
        return periodic.stiffness_of_lifted(stiffness, self) if self.lift else stiffness

    def _stiffness_with_rims(self, pressure: Array, free: NDArray[np.bool_], rtol: float) -> float:
        """Tangent stiffness where the gap at rims falls with the pressure: its matrix is not symmetric."""
        from scipy.sparse.linalg import LinearOperator, gmres

        own, along, across = self._rims_of(pressure)[0]
        inside = np.flatnonzero(free)
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

    def solve(
        self,
        gap: ArrayLike,
        approach: float | None = None,
        load: float | None = None,
        start: ArrayLike | None = None,
        rtol: float = 1e-6,
        edges: Edges | None = None,
    ) -> Contact:
        """Solve the contact at a prescribed approach or load.

        Parameters
        ----------
        gap : array_like, shape (nx, ny)
            Separation of the undeformed bodies at zero approach, m.
        approach : float, optional
            Approach, m, positive closing. Exactly one of `approach` and `load` is given. On a period that of
            the mean planes: without hardness less than the mean gap.
        load : float, optional
            Resultant force, N.
        start : array_like, shape (nx, ny), optional
            Pressure to start from, Pa.
        rtol : float
            Largest complementarity residual relative to the largest overlap of the undeformed bodies.
        edges : Edges, optional
            Sharp edges on the grid: in cells that they cross, the gap is that of the sound surface.

        Returns
        -------
        Contact
            The solution; one that did not converge says so in `converged` and `outcome`, and warns.

        Raises
        ------
        InputError
            For input that has no meaning.
        """
        g = self._field("gap", gap)
        given = "both" if approach is not None else "neither"
        one = (approach is None) != (load is None)
        require(one, "approach and load", given, "exactly one of them", "Give one of the two.")
        rtol = _tolerance(rtol)
        p = None if start is None else np.clip(self._field("start pressure", start), 0.0, self.pressure_cap)
        if edges is not None:
            check_edges(edges, self, self.shape)
        solver = periodic if self.boundary == "periodic" else HalfSpace
        known: dict[str, Any] = {} if edges is None else {"edges": edges}
        if approach is not None:
            at = real("approach", approach, "a finite length, m")
            contact = solver.at_approach(self, g, at, p, rtol, **known)
        else:
            contact = solver.at_load(self, g, self.checked_load(load), p, rtol, **known)
        if not contact.converged:
            warn_unconverged(f"contact at approach {rounded(contact.approach, 4)} m", contact.outcome)
        return contact

    def scan(
        self,
        surface: ArrayLike | HeightMap,
        body: ArrayLike,
        approaches: ArrayLike,
        stride: int = 1,
        *,
        rtol: float | None = None,
        force_accuracy: float | None = None,
        workers: int | None = None,
        cache: Store | None = None,
        progress: Progress | None = None,
        device: str | None = None,
        edges: Edges | None = None,
    ) -> "xarray.DataArray":
        """Move a body along a surface and record the contact force at fixed approaches.

        Parameters
        ----------
        surface : HeightMap, or array_like, shape (n, ny)
            Heights, m, peaks positive, on the half-space's spacing; the first axis is the rolling direction.
        body : array_like, shape (nx, ny)
            Shape of the smooth body, m, zero at its lowest point. Position m puts it on rows m … m + nx − 1.
        approaches : array_like, shape (k,)
            Approaches from the mean plane of the heights, m, positive closing, increasing; one number is one.
        stride : int
            Rows between positions.
        rtol : float, optional
            Tolerance of each solution, as in `solve`; by default 1e-6.
        force_accuracy : float, optional
            Instead of it, the largest relative error of a force: `numerics.force_accuracy` of a case.
        workers : int, optional
            Threads; by default one per processor, or ``$ASPERITY_THREADS``. The result does not depend on it.
        cache : Store, optional
            Keeps finished blocks, so that an interrupted scan goes on where it was: `Store()`, as in a run.
        progress : callable, optional
            ``progress(done, total, message)``.
        device : str, optional
            ``"cpu"``, or ``"gpu"`` to solve in batches through CuPy; by default what ``$ASPERITY_DEVICE``
            says, else ``"cpu"``. Forces agree within the tolerance; written, not yet run on a device.
        edges : Edges, optional
            Sharp edges of the surface: in cells that they cross, its heights are those of the sound surface.

        Returns
        -------
        xarray.DataArray, dims (approach, position)
            Force, N. The coordinate `position` is the offset of the body's window along x, m.

        Raises
        ------
        InputError
            For sizes that do not fit, or values that are not finite.

        Examples
        --------
        >>> x = 5e-6 * np.arange(-20, 21)
        >>> ball = np.add.outer(x**2, x**2) / (2 * 10e-3)
        >>> wave = 50e-9 * np.cos(2 * np.pi * np.arange(80) / 40)
        >>> surface = np.repeat(wave[:, None], 41, axis=1)
        >>> forces = HalfSpace((41, 41), 5e-6, 115e9).scan(surface, ball, [0.1e-6, 0.2e-6], stride=10)
        >>> forces.sel(approach=0.2e-6).values.round(2)  # a crest is under the ball at the third position
        array([1.03, 1.44, 1.75, 1.44])
        """
        from asperity.contact import batched, scan

        periodic.refuse_period(self, "the scan")
        one, remedy = rtol is None or force_accuracy is None, "Give one of the two, or neither."
        require(one, "rtol and force_accuracy", "both", "one of them", remedy)
        key, tolerance = ("rtol", 1e-6) if rtol is None else ("rtol", _tolerance(rtol))
        if force_accuracy is not None:
            key, tolerance = "force_accuracy", scan.rtol_for(force_accuracy)
        heights = scan.heights_on(self, surface, "surface of the scan")
        job = scan.ScanJob(
            self,
            Rows(heights - heights.mean()),
            arguments.real_array("body of the scan", body, "an array (nx, ny) of lengths in m"),
            arguments.real_array("approaches of the scan", approaches, "increasing lengths in m"),
            stride,
            tolerance,
            device=batched.find_device(device),
            edges=edges,
        )
        scan.check_settings(workers, cache, progress)
        found = scan.scan_forces(job, cache=cache, workers=workers, progress=progress)
        scan.warn_of_flaws(found.counts, "the scan", key, job.remedy if found.counts.truncated else "")
        return scan.labelled(job, found)

    def run_in(
        self,
        surface: ArrayLike | HeightMap,
        body: ArrayLike,
        load: float,
        passes: int | str = "shakedown",
        stride: int = 1,
        *,
        workers: int | None = None,
        cache: Store | None = None,
        progress: Progress | None = None,
    ) -> HeightMap:
        """Roll a body over a surface whose asperities flow at the hardness, and return what is left of it.

        Parameters
        ----------
        surface : HeightMap, or array_like, shape (n, ny)
            Heights, m, peaks positive, on the half-space's spacing; the first axis is the rolling direction.
        body : array_like, shape (nx, ny)
            Shape of the smooth body, m, zero at its lowest point.
        load : float
            Constant load, N.
        passes : int or str
            Number of passes; ``"shakedown"`` rolls until a pass lowers no place by more
            than 1/1000 of the smooth bodies' approach.
        stride : int
            Rows between positions: at most about an eighth of the contact's half width.
        workers, cache, progress : optional
            As in `scan`.

        Returns
        -------
        HeightMap
            The surface after the passes; its heights are nowhere above those before.

        Raises
        ------
        InputError
            Without hardness, or for sizes that do not fit.

        Notes
        -----
        Elastic–perfectly plastic: 0 ≤ p ≤ H; where the cap leaves an overlap, the surface is lowered by it.
        Volume is not kept (no pile-up), and the body stays smooth: the surface takes all that yields.
        The first and last half windows, over which the body's middle does not pass, are not run in.

        Examples
        --------
        >>> x = 5e-6 * np.arange(-20, 21)
        >>> ball = np.add.outer(x**2, x**2) / (2 * 10e-3)
        >>> wave = 50e-9 * np.cos(2 * np.pi * np.arange(80) / 8)
        >>> rough = np.repeat(wave[:, None], 41, axis=1)
        >>> smoother = HalfSpace((41, 41), 5e-6, 115e9, hardness=0.4e9).run_in(rough, ball, load=0.5)
        >>> f"crests {(rough - smoother.heights).max() * 1e9:.0f} nm lower"
        'crests 23 nm lower'
        """
        from asperity.contact import running_in, scan

        periodic.refuse_period(self, "running-in")
        allowed, remedy = "a pressure at which asperities flow", "An elastic surface keeps no mark."
        require(self.hardness is not None, "hardness of the half-space", "None", allowed, remedy)
        heights = scan.heights_on(self, surface, "surface to be run in")
        shape = self._field("body that runs in", body)
        scan.check_window("running-in", self.shape, heights.shape)
        scan.check_settings(workers, cache, progress)
        load, most = self.checked_load(load), max(self.shape[0] - 1, 1)
        allowed = f"a whole number from 1 to {most}"
        step = arguments.whole("stride of running-in", stride, allowed, at_least=1, at_most=most)
        job = running_in.RunningIn(self, shape, load, arguments.passes_of(passes), step)
        found = running_in.run_in(heights, job, cache=cache, workers=workers, progress=progress)
        running_in.warn_of_running_in(found, job, "rtol", "Enlarge the window.")
        number = count_of(len(found.largest), "pass")
        words = f"run in by {number} under {in_newtons(load)}, {rounded(100 * found.yielded_share)} % yielded"
        origin = f"{surface.source}; " if isinstance(surface, HeightMap) and surface.source else ""
        return HeightMap(found.heights, self.spacing, origin + words)

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
        return _array(arguments.finite_array(name, values, allowed, shape=self.shape))

    def softness(self, edges: Edges) -> Softness:
        """Find how cells at edges give way."""
        return softness_at(edges, self.modulus, self.hardness)

    def at_approach(
        self,
        gap: Array,
        approach: float,
        start: Array | None,
        rtol: float,
        total: float = -1.0,
        edges: Edges | None = None,
    ) -> Contact:
        """Solve at an approach, unchecked and silent; a sum of the pressure, Pa, is negative if not given.

        On a period the approach is the lifted one of `asperity.contact.periodic`, there and in `at_load`.
        """
        soft = None if edges is None else self.softness(edges)
        rows, at = np.zeros(self.shape), np.array([approach])
        block = self.block(rows, gap, np.zeros(1), at, 0, rtol, load=total, soft=soft)
        if start is not None:
            block.pressures[1, 0], block.solved[0] = start, 1
        self.solve_block(block)
        pressure, (solved, iterations, unconverged, _) = block.pressures[0, 0], block.counts.tolist()
        outcome = Outcome.CONVERGED if solved else Outcome.NO_CONTACT
        if unconverged:
            outcome = Outcome.ITERATION_LIMIT if iterations >= MAX_ITERATIONS else Outcome.STALLED
        return Contact(
            pressure, float(block.totals[0, 0]) * self.cell_area, approach + float(block.levels[0, 0]),
            self._covered_cells(pressure, edges) * self.cell_area, iterations, float(block.residuals[0, 0]),
            outcome, self, gap, edges,
        )  # fmt: skip

    def _covered_cells(self, pressure: Array, edges: Edges | None) -> float:
        """Number of cells in contact, those at rims as far as they are covered, at edges as far as sound."""
        if edges is not None:
            return self.softness(edges).covered_cells(pressure, edges.shares)
        if self.cells == "whole":
            return int(np.count_nonzero(pressure))
        return float(self._rims_of(pressure)[1].sum())

    def _rims_of(self, pressure: Array) -> tuple[Array, Array]:
        """Derivatives of the gap at rims (3, nx, ny), m/Pa, and covered shares of cells (nx, ny)."""
        slopes, covered = np.zeros((3, *self.shape)), np.zeros(self.shape)
        assert self._sides is not None
        rims.rim_slopes(_array(pressure), *self._sides, slopes, covered)
        return slopes, covered

    def block(
        self,
        rows: Array,
        body: Array,
        planes: Array,
        approaches: Array,
        stride: int,
        rtol: float,
        single: bool = False,
        load: float = -1.0,
        soft: Softness | None = None,
    ) -> scanning.Block:
        """Lay out contacts to be solved, with nothing known of them; arguments as in `scanning.Block`.

        In single precision the iteration is half again as fast, down to a tolerance of about 1e-6.
        """
        rows, body, planes, approaches = map(_array, (rows, body, planes, approaches))
        if soft is not None:
            softness, drop, flow = map(_array, (soft.softness, soft.drop, soft.flow))
            soft = Softness(softness, drop, flow, soft.yielding)
        k, shape, size = len(approaches), self.shape, (len(approaches), len(planes))
        known = self._known[np.float32 if single else np.float64]
        return scanning.Block(
            rows, body, planes, approaches, stride, load, 0.0, self.pressure_cap, rtol, MAX_ITERATIONS,
            scanning.room(known, *shape, self._sides, soft), np.empty(shape), np.empty(shape),
            np.zeros((2, *shape)),
            np.zeros((2, k, *shape)), np.zeros(k, dtype=np.int64), np.zeros(size), np.zeros(size),
            np.zeros(size), np.zeros(4, dtype=np.int64),
        )  # fmt: skip

    def solve_block(self, block: scanning.Block) -> scanning.Block:
        """Solve the contacts of a block, each from what is known of those before; unchecked and silent.

        Threads share the convolutions that are prepared: at worst one overwrites what another has prepared,
        which then comes again.
        """
        position, level, count, precision = 0, 0, len(block.planes), block.room.outer.dtype.type
        while position < count:
            refuse_to_go_on()
            end, known = min(position + AT_ONCE, count), self._known[precision]
            position, level, nx, ny = scanning.solve_positions(known, block, position, level, end)
            if position < end:
                self._known[precision] = prepared(self._known[precision], nx, ny)
        return block

    def at_load(
        self, gap: Array, load: float, start: Array | None, rtol: float, edges: Edges | None = None
    ) -> Contact:
        """Solve at a given load as `solve` does, unchecked and silent: look at `converged`.

        The overlap at an estimated approach is all that needs a grid.
        """
        lowest = float(gap.min())
        if load == 0.0:
            return self.at_approach(gap, lowest, None, rtol, edges=edges)
        estimate = foundation_approach(gap, load, self.modulus, self.cell_area, self.pressure_cap)
        iterations = 0
        while True:
            reach = lowest + scanning.REACH * (estimate - lowest)
            contact = self.at_approach(gap, reach, start, rtol, load / self.cell_area, edges)
            iterations += contact.iterations
            if contact.approach <= reach:
                return replace(contact, iterations=iterations)
            estimate, start = contact.approach, contact.pressure


@lru_cache
def _unit_taps(ratio: float) -> Array:
    """Preconditioning stencil of cells 1 × ratio, π E* being one."""
    return projected_cg.inverse_stencil(influence_table(32, 32, 1.0, ratio))


def _tolerance(rtol: float) -> float:
    return real("rtol", rtol, "a number between 0 and 1, as 1e-6", above=0.0, at_most=BELOW_ONE)


def _array(values: ArrayLike) -> Array:
    """Array of the one kind that kernels are compiled for: contiguous and writable."""
    return np.require(values, np.float64, ["C", "W"])
