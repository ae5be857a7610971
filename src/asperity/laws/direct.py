"""`direct`: the 3-D contact solved in every time step; the reference for the other laws."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import numpy as np

from asperity.errors import InputError
from asperity.laws.base import check_damping
from asperity.laws.spec import LawSpec, Look, Need, Role

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray
    from scipy.interpolate import BSpline

    from asperity.contact.halfspace import Contact, HalfSpace
    from asperity.laws.materials import Materials


@dataclass(frozen=True, eq=False)
class Direct:
    """F = resultant of the solved contact of the body with the path under it; never pulls.

    Parameters
    ----------
    heights : ndarray, shape (rows, ny)
        Texture of the path, m, peaks positive.
    body : ndarray, shape (nx, ny)
        Shape of the smooth body, m, zero at its lowest point, the middle cell; nx odd.
    spacing : tuple of float
        (dx, dy), m.
    modulus : float
        Contact modulus E*, Pa.
    start : float
        Position of the first row of `heights`, m.
    hardness : float, optional
        Pressure cap, Pa.
    rtol : float
        Tolerance of each solution, as in `HalfSpace.solve`.
    damping : float
        c, N s/m.

    Raises
    ------
    InputError
        If the sizes do not fit or the damping is negative.
    """

    heights: NDArray[np.float64]
    body: NDArray[np.float64]
    spacing: tuple[float, float]
    modulus: float
    start: float
    hardness: float | None = None
    rtol: float = 1e-6
    damping: float = 0.0
    name: str = "direct"

    def __post_init__(self) -> None:
        check_damping(self.damping)
        rows, ny = self.heights.shape
        if self.body.shape[1] != ny or self.body.shape[0] % 2 == 0 or rows < self.body.shape[0]:
            raise InputError(
                "direct contact",
                f"a body of {self.body.shape} cells on a path of {self.heights.shape}",
                "a body as wide as the path, not longer, with an odd number of rows",
            )

    def prepare(self, positions: ArrayLike) -> DirectOnPath:
        """Lay the law out on positions (n,) of the contact, m."""
        from asperity.contact.halfspace import HalfSpace

        index = (np.atleast_1d(np.asarray(positions, dtype=np.float64)) - self.start) / self.spacing[0]
        half = self.body.shape[0] // 2
        last = self.heights.shape[0] - 1 - half
        if index.min() < half - 1e-6 or index.max() > last + 1e-6:
            first, end = (self.start + self.spacing[0] * i for i in (half, last))
            raise InputError(
                "path (m)",
                f"{self.start + self.spacing[0] * index.min():.6g} to "
                f"{self.start + self.spacing[0] * index.max():.6g}",
                f"{first:.6g} to {end:.6g}, where the texture fills the contact window",
                "Shorten the duration or provide a longer texture.",
            )
        shape = (self.body.shape[0], self.body.shape[1])
        return DirectOnPath(self, HalfSpace(shape, self.spacing, self.modulus, self.hardness), index - half)


@dataclass(eq=False)
class DirectOnPath:
    """The law on a path, with the pressure that the next solution starts from.

    Attributes
    ----------
    law : Direct
        The law.
    half_space : HalfSpace
        The solver.
    offsets : ndarray, shape (n,)
        First row of the window at each position; between rows the texture is interpolated.
    iterations, solves, unconverged, truncated : int
        Counts so far.
    """

    law: Direct
    half_space: HalfSpace
    offsets: NDArray[np.float64]
    iterations: int = 0
    solves: int = 0
    unconverged: int = 0
    truncated: int = 0
    overlap: float = 0.0
    _gap: tuple[int, NDArray[np.float64]] | None = None
    _trial: Contact | None = None
    _pressure: NDArray[np.float64] | None = None
    _row: int = 0
    _spline: BSpline | None = None
    _start: tuple[int, NDArray[np.float64] | None] = field(default=(-1, None))

    def evaluate(self, step: int, approach: float) -> tuple[float, float]:
        """Elastic force, N, and its exact tangent dF/dδ, N/m, at a step of the path."""
        from asperity.kernels.scanning import TRUNCATED

        contact = self.half_space.at_approach(
            self._gap_at(step), approach, self._start_at(step), self.law.rtol
        )
        self._trial = contact
        self.truncated += contact.edge_share > TRUNCATED
        self.overlap = max(self.overlap, approach - float(self._gap_at(step).min()))
        self.iterations += contact.iterations
        self.solves += contact.force > 0.0
        self.unconverged += not contact.converged
        return contact.force, contact.stiffness

    def accept(self, step: int) -> None:
        """Keep the last solution of this step: shifted against the motion, it starts the next."""
        if self._trial is not None:
            self._pressure = self._trial.pressure
            self._row = round(self.offsets[step])
        self._trial = None

    def state(self) -> dict[str, NDArray[Any]]:
        """What `restore` needs to go on from here exactly."""
        counts = [self.iterations, self.solves, self.unconverged, self.truncated, self._row]
        pressure = np.zeros((0, 0)) if self._pressure is None else self._pressure
        return {"counts": np.array(counts), "pressure": pressure, "overlap": np.array(self.overlap)}

    def restore(self, state: dict[str, NDArray[Any]]) -> None:
        """Go on from a saved state."""
        counts = (int(c) for c in state["counts"])
        self.iterations, self.solves, self.unconverged, self.truncated, self._row = counts
        self.overlap = float(state["overlap"])
        self._pressure = state["pressure"] if state["pressure"].size else None
        self._gap, self._trial, self._start = None, None, (-1, None)

    def warn_of_flaws(self) -> None:
        """Warn of contacts that did not converge or were cut off."""
        from asperity.contact.flaws import Counts, warn_of_flaws, window_for

        window = window_for(self.law.body, self.law.spacing, self.overlap)
        remedy = f'contact.window = "{window * 1e3:.3g} mm" holds them.'
        counts = Counts(self.solves, self.iterations, self.unconverged, self.truncated)
        warn_of_flaws(counts, "the direct law", "numerics.rtol", remedy)

    def _gap_at(self, step: int) -> NDArray[np.float64]:
        if self._gap is None or self._gap[0] != step:
            self._gap = (step, self.law.body - self._rows_at(float(self.offsets[step])))
        return self._gap[1]

    def _rows_at(self, offset: float) -> NDArray[np.float64]:
        """Rows of the texture from an offset on; between rows by quintic splines, which keep short waves."""
        first, count = round(offset), self.law.body.shape[0]
        if abs(offset - first) < 1e-6:
            return self.law.heights[first : first + count]
        if self._spline is None:
            from scipy.interpolate import make_interp_spline

            rows = np.arange(len(self.law.heights))
            self._spline = make_interp_spline(rows, self.law.heights, k=5)
        return np.asarray(self._spline(offset + np.arange(count)))

    def _start_at(self, step: int) -> NDArray[np.float64] | None:
        """Start of the step: its last trial, else the accepted pressure moved with the surface."""
        if self._trial is not None and self._gap is not None and self._start[0] == step:
            return self._trial.pressure
        pressure = self._pressure
        if pressure is not None:
            shift = round(self.offsets[step]) - self._row
            if shift >= len(pressure) or shift < 0:
                pressure = None
            elif shift:
                pressure = np.vstack([pressure[shift:], np.zeros((shift, pressure.shape[1]))])
        self._start = (step, pressure)
        return pressure


def _build(materials: Materials) -> Direct:
    """Build the law from the materials of a case."""
    return Direct(
        materials.heights,
        materials.body,
        materials.spacing,
        materials.modulus,
        materials.start,
        materials.hardness,
        materials.rtol,
        materials.damping,
        materials.name,
    )


LAW = LawSpec(
    "direct",
    "The three-dimensional contact, solved in every time step: the reference.",
    _build,
    frozenset({Need.SURFACE}),
    solved_every_step=True,
    role=Role.REFERENCE,
    look=Look("#1c2126", "-", "v"),
)
