"""Frictionless contact of an elastic half-space with a rough or smooth body, at given approach or load."""

import math
from collections.abc import Callable
from typing import TYPE_CHECKING, Any

import numpy as np

from asperity import arguments
from asperity.arguments import ArrayLike, real, require
from asperity.contact import periodic
from asperity.contact.elastic_grid import ElasticGrid, check_edges, warn_unconverged
from asperity.contact.pressed import at_approach, at_load
from asperity.contact.solved import Contact
from asperity.progress import Progress
from asperity.store import Store
from asperity.surfaces.edges import Edges
from asperity.surfaces.heightmap import HeightMap
from asperity.surfaces.strip import Rows
from asperity.written_numbers import count_of, in_newtons, rounded

if TYPE_CHECKING:
    import xarray

BELOW_ONE = math.nextafter(1.0, 0.0)


class HalfSpace(ElasticGrid):
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
        free = self.boundary == "free"
        known: dict[str, Any] = {} if edges is None else {"edges": edges}
        solve: Callable[..., Contact]
        if approach is not None:
            at = real("approach", approach, "a finite length, m")
            solve = at_approach if free else periodic.period_at_approach
            contact = solve(self, g, at, p, rtol, **known)
        else:
            solve = at_load if free else periodic.period_at_load
            contact = solve(self, g, self.checked_load(load), p, rtol, **known)
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
            key = "force_accuracy"
            tolerance = scan.rtol_for(force_accuracy)
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
        allowed = "a pressure at which asperities flow"
        remedy = "An elastic surface keeps no mark."
        require(self.hardness is not None, "hardness of the half-space", "None", allowed, remedy)
        heights = scan.heights_on(self, surface, "surface to be run in")
        shape = self._field("body that runs in", body)
        scan.check_window("running-in", self.shape, heights.shape)
        scan.check_settings(workers, cache, progress)
        load = self.checked_load(load)
        most = max(self.shape[0] - 1, 1)
        allowed = f"a whole number from 1 to {most}"
        step = arguments.whole("stride of running-in", stride, allowed, at_least=1, at_most=most)
        job = running_in.RunningIn(self, shape, load, arguments.passes_of(passes), step)
        found = running_in.run_in(heights, job, cache=cache, workers=workers, progress=progress)
        running_in.warn_of_running_in(found, job, "rtol", "Enlarge the window.")
        number = count_of(len(found.largest), "pass")
        words = f"run in by {number} under {in_newtons(load)}, {rounded(100 * found.yielded_share)} % yielded"
        origin = f"{surface.source}; " if isinstance(surface, HeightMap) and surface.source else ""
        return HeightMap(found.heights, self.spacing, origin + words)


def _tolerance(rtol: float) -> float:
    return real("rtol", rtol, "a number between 0 and 1, as 1e-6", above=0.0, at_most=BELOW_ONE)
