"""`direct`: the 3-D contact solved in every time step; the reference for the other laws."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from asperity.errors import InputError
from asperity.laws.base import check_damping
from asperity.laws.spec import LawSpec, Look, Need, Role

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray
    from scipy.interpolate import BSpline

    from asperity.contact.in_place import ContactInPlace
    from asperity.laws.materials import Materials

AT_REST = 1e-6
"""Largest tolerance of contacts at rest, before anything rolls: they must carry the load to five digits."""


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
        from asperity.contact.in_place import ContactInPlace

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
        half_space = HalfSpace(shape, self.spacing, self.modulus, self.hardness)
        return DirectOnPath(self, ContactInPlace(half_space, self.body, self.rtol), index - half)


@dataclass(eq=False)
class DirectOnPath:
    """The law on a path, with the pressures that the next solution starts from.

    Attributes
    ----------
    law : Direct
        The law.
    contact : ContactInPlace
        The solver.
    offsets : ndarray, shape (n,)
        First row of the window at each position; between rows the texture is interpolated.
    iterations, solves, unconverged, truncated : int
        Counts so far.
    """

    law: Direct
    contact: ContactInPlace
    offsets: NDArray[np.float64]
    iterations: int = 0
    solves: int = 0
    unconverged: int = 0
    truncated: int = 0
    overlap: float = 0.0
    _under: tuple[int, NDArray[np.float64]] | None = None
    _tried: bool = False
    _spline: BSpline | None = None
    _last: _Accepted | None = None
    _before: _Accepted | None = None

    def evaluate(self, step: int, approach: float) -> tuple[float, float]:
        """Elastic force, N, and its exact tangent dF/dδ, N/m, at a step of the path."""
        force = self.settle(step, approach, 0.0)
        contact = self.contact
        return force, contact.half_space.tangent_stiffness(contact.pressure) if force > 0.0 else 0.0

    def settle(self, step: int, approach: float, compliance: float) -> float:
        """Elastic force, N, of bodies that yield to it by a compliance, m/N; approach without force, m."""
        heights = self._heights_at(step)
        if self._tried:
            self.contact.start_again()
        else:
            self._start(step)
        rtol = min(self.law.rtol, AT_REST) if self._last is None else self.law.rtol
        found = self.contact.solve(heights, approach, compliance, rtol)
        self._tried = True
        self.truncated += found.truncated
        self.overlap = max(self.overlap, found.overlap)
        self.iterations += found.iterations
        self.solves += found.force > 0.0
        self.unconverged += not found.converged
        return found.force

    def accept(self, step: int) -> None:
        """Keep the last solution of this step: shifted against the motion, it starts the next."""
        if self._tried:
            kept = self._before.pressure if self._before else np.empty_like(self.contact.pressure)
            kept[:] = self.contact.pressure
            self._before, self._last = self._last, _Accepted(kept, round(self.offsets[step]))
        self._tried = False

    def state(self) -> dict[str, NDArray[Any]]:
        """What `restore` needs to go on from here exactly."""
        held = [a for a in (self._last, self._before) if a is not None]
        return {
            "counts": np.array([self.iterations, self.solves, self.unconverged, self.truncated]),
            "overlap": np.array(self.overlap),
            "pressures": np.array([a.pressure for a in held]),
            "rows": np.array([a.row for a in held], dtype=np.int64),
        }

    def restore(self, state: dict[str, NDArray[Any]]) -> None:
        """Go on from a saved state."""
        self.iterations, self.solves, self.unconverged, self.truncated = state["counts"].tolist()
        self.overlap = float(state["overlap"])
        held = [_Accepted(p.copy(), int(r)) for p, r in zip(state["pressures"], state["rows"], strict=True)]
        self._last, self._before = [*held, None, None][:2]
        self._under, self._tried = None, False

    def warn_of_flaws(self) -> None:
        """Warn of contacts that did not converge or were cut off."""
        from asperity.contact.scan import Counts, warn_of_flaws, window_for

        window = window_for(self.law.body, self.law.spacing, self.overlap)
        remedy = f'contact.window = "{window * 1e3:.3g} mm" holds them.'
        counts = Counts(self.solves, self.iterations, self.unconverged, self.truncated)
        warn_of_flaws(counts, "the direct law", "numerics.rtol", remedy)

    def _heights_at(self, step: int) -> NDArray[np.float64]:
        if self._under is None or self._under[0] != step:
            self._under, self._tried = (step, self._rows_at(float(self.offsets[step]))), False
        return self._under[1]

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

    def _start(self, step: int) -> None:
        """Let a step start from the accepted pressures."""
        last, before = self._last, self._before
        if last is None or not 0 <= (rows := round(self.offsets[step]) - last.row) < len(last.pressure):
            self.contact.forget()
            return
        if before is None or not 0 <= last.row - before.row < len(last.pressure):
            before = last
        self.contact.start_from(last.pressure, before.pressure, rows, last.row - before.row)


class _Accepted(NamedTuple):
    """A pressure (nx, ny), Pa, and the first row of its window."""

    pressure: NDArray[np.float64]
    row: int


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
    look=Look("#1c2126", (0, (16, 2)), "v"),
)
