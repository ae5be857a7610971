"""`direct`: the 3-D contact solved in every time step; the reference for the other laws."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from asperity.arguments import Array, ArrayLike, Flags, NDArray, as_row
from asperity.laws import spec
from asperity.surfaces.edges import FAR, Edges

if TYPE_CHECKING:
    from scipy.interpolate import BSpline

    from asperity.contact.halfspace import HalfSpace

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
    faults : ndarray, shape (rows, ny), optional
        Further heights that have edges, m: straight between rows, and where they differ by more than `drop`,
        m, those of the nearer row.
    drop : float
        That.
    edges : Edges, optional
        Sharp edges of these, which lie between rows as they do.
    cells : str
        How cells at the rim of a contact count, as in `HalfSpace`; covered ones have means as heights.
    remedies : tuple of str
        What is made smaller if solutions miss their tolerance, and what to do if the window cuts them off.
    """

    heights: Array
    body: Array
    spacing: tuple[float, float]
    modulus: float
    start: float
    hardness: float | None = None
    rtol: float = 1e-6
    damping: float = 0.0
    name: str = "direct"
    faults: Array | None = None
    drop: float = 0.0
    edges: Edges | None = None
    cells: str = "whole"
    remedies: tuple[str, str] = "numerics.rtol", 'contact.window = "{:.3g} mm" holds them.'

    @cached_property
    def between_rows(self) -> BSpline:
        """Quintic splines along the rows of the texture, over their numbers."""
        from scipy.interpolate import make_interp_spline

        return make_interp_spline(np.arange(len(self.heights)), self.heights, k=5)

    @cached_property
    def sound(self) -> Flags:
        """Where heights of faults are those of the sound surface beside their edges (rows, ny)."""
        assert self.edges is not None
        return self.edges.sound

    def prepare(self, positions: ArrayLike, other: DirectOnPath | None = None) -> DirectOnPath:
        """Lay the law out on positions (n,) of the contact, m, with what rolls on it where that is rough."""
        from asperity.contact.halfspace import HalfSpace
        from asperity.reduction.texture import grid_index

        dx, _ = self.spacing
        half = self.body.shape[0] // 2
        rows = len(self.heights) - 2 * half
        grid_index("texture under the contact window", rows, self.start + half * dx, dx, positions)
        index = (as_row(positions) - self.start) / dx
        half_space = HalfSpace(self.body.shape, self.spacing, self.modulus, self.hardness, self.cells)
        return DirectOnPath(self, half_space, index - half, other)

    def prepare_pair(self, positions: ArrayLike, other: Direct, other_positions: ArrayLike) -> DirectOnPath:
        """Lay the law out with another surface, on the same cells, that rolls on it."""
        return self.prepare(positions, other.prepare(other_positions))


class Accepted(NamedTuple):
    """A pressure (nx, ny), Pa, and the first row of its window."""

    pressure: Array
    row: int


class DirectOnPath:
    """The law on a path, with the pressures that the next solution starts from.

    Parameters
    ----------
    law : Direct
        The law.
    half_space : HalfSpace
        On which its contacts are solved, one after the other, without making anything anew.
    offsets : ndarray, shape (n,)
        First row of the window at each position; between rows the texture is interpolated.
    other : DirectOnPath, optional
        What rolls on it, where that is rough, too.

    Attributes
    ----------
    counts : ndarray, shape (4,)
        Solutions in contact so far, iterations, solutions that missed the tolerance, and those cut off.
    pressure : ndarray, shape (nx, ny)
        Of the last solution, Pa.
    """

    def __init__(
        self, law: Direct, half_space: HalfSpace, offsets: Array, other: DirectOnPath | None = None
    ) -> None:
        from asperity.contact.pressed import block_of

        self.law = law
        self.half_space = half_space
        self.offsets = offsets
        self.other = other
        self._sharp = law.edges is not None or (other is not None and other.law.edges is not None)
        heights = np.zeros(half_space.shape)
        none = np.zeros(half_space.shape)
        self._without = Edges(none + FAR, none, none, half_space.spacing)
        soft = half_space.softness(self._without) if self._sharp else None
        self.block = block_of(half_space, heights, law.body, np.zeros(1), np.zeros(1), 0, law.rtol, soft=soft)
        self.pressure, self.start = self.block.pressures[:, 0]
        self.counts = self.block.counts
        self.overlap = 0.0
        self._step = -1
        self._heights = np.zeros(0)
        self._edges: Edges | None = None
        self._laid: tuple[float, Edges | None] = (math.nan, None)  # own edges at an offset
        self._tried = False  # whether there is a solution of this step
        self._last: Accepted | None = None
        self._before: Accepted | None = None

    def evaluate(self, step: int, approach: float) -> tuple[float, float]:
        """Elastic force, N, and its exact tangent dF/dδ, N/m, at a step of the path."""
        force = self.settle(step, approach, 0.0)
        space = self.half_space
        return force, space.tangent_stiffness(self.pressure, edges=self._edges) if force > 0.0 else 0.0

    def settle(self, step: int, approach: float, compliance: float) -> float:
        """Elastic force, N, of bodies that yield to it by a compliance, m/N; approach without force, m."""
        from asperity.contact.pressed import solve_block

        if self._step != step:
            self._heights = self._under(step)
            self._step = step
            self._tried = False
            self._set_edges(step)
        if self._tried:
            self.start[:] = self.pressure
            self.block.solved[0] = 1
        else:
            self._start(step)
        self.block.approaches[0] = approach
        self.block.rows[:] = self._heights
        space = self.half_space
        solved = int(self.counts[0])
        rtol = min(self.law.rtol, AT_REST) if self._last is None else self.law.rtol
        solve_block(space, self.block._replace(compliance=compliance * space.cell_area, rtol=rtol))
        self._tried = True
        overlap = approach - float(self.block.room.lowest.min())
        if self.counts[0] == solved:
            self.pressure[:] = 0.0
            return 0.0
        self.overlap = max(self.overlap, overlap + float(self.block.levels[0, 0]))
        return float(self.block.totals[0, 0]) * space.cell_area

    def accept(self, step: int) -> None:
        """Keep the last solution of this step: shifted against the motion, it starts the next."""
        if self._tried:
            kept = self._before.pressure if self._before else np.empty_like(self.pressure)
            kept[:] = self.pressure
            self._before = self._last
            self._last = Accepted(kept, round(self.offsets[step]))
        self._tried = False

    def state(self) -> dict[str, NDArray[Any]]:
        """What `restore` needs to go on from here exactly."""
        held = [each for each in (self._last, self._before) if each is not None]
        return {
            "counts": self.counts.copy(),
            "overlap": np.array(self.overlap),
            "pressures": np.array([each.pressure for each in held]),
            "rows": np.array([each.row for each in held], dtype=np.int64),
        }

    def restore(self, state: dict[str, NDArray[Any]]) -> None:
        """Go on from a saved state."""
        self.counts[:] = state["counts"]
        self.overlap = float(state["overlap"])
        held = [Accepted(p.copy(), int(r)) for p, r in zip(state["pressures"], state["rows"], strict=True)]
        self._last, self._before = [*held, None, None][:2]
        self._step = -1
        self._tried = False

    def warn_of_flaws(self) -> None:
        """Warn of contacts that did not converge or were cut off."""
        from asperity.contact.scan import Counts, warn_of_flaws, window_for

        window = window_for(self.law.body, self.law.spacing, self.overlap)
        tolerance, remedy = self.law.remedies
        counts = Counts(*self.counts.tolist())
        warn_of_flaws(counts, "the direct law", tolerance, remedy.format(window * 1e3))

    def _under(self, step: int) -> Array:
        """Heights in the window at a step, of both surfaces if there are two."""
        own = self._rows_at(float(self.offsets[step]))
        return own if self.other is None else own + self.other._under(step)

    def _set_edges(self, step: int) -> None:
        """Find the edges in the window at a step, of both surfaces if there are two."""
        self._edges = self._edges_at(step)
        if self._sharp:
            soft = self.half_space.softness(self._edges or self._without)
            for each, values in zip(self.block.room.edges[: len(soft)], soft, strict=True):
                each[:] = values

    def _edges_at(self, step: int) -> Edges | None:
        own = self._own_edges(float(self.offsets[step]))
        other = None if self.other is None else self.other._edges_at(step)
        return own if other is None else other if own is None else own.with_others(other)

    def _own_edges(self, offset: float) -> Edges | None:
        """Edges in the window from an offset on, if any."""
        if self._laid[0] != offset:
            self._laid = offset, self._edges_between(offset)
        return self._laid[1]

    def _edges_between(self, offset: float) -> Edges | None:
        """Edges in the window from an offset on: distances are straight between rows."""
        first = round(offset)
        count = self.law.body.shape[0]
        edges = self.law.edges
        if edges is None or (edges.distance[first - 1 : first + count + 1] == FAR).all():
            return None
        whole = abs(offset - first) < 1e-6
        low = math.floor(offset)
        low, share = (first, 0.0) if whole else (low, offset - low)
        return edges.rearranged(
            lambda field: (
                (1.0 - share) * field[low : low + count] + share * field[low + 1 : low + 1 + count]
                if share
                else field[low : low + count]
            )
        )

    def _rows_at(self, offset: float) -> Array:
        """Rows of the texture from an offset on; between rows by quintic splines, which keep short waves."""
        first = round(offset)
        count = self.law.body.shape[0]
        whole = abs(offset - first) < 1e-6
        rows = self.law.heights[first : first + count] if whole else self._between(offset)
        faults = self.law.faults
        if faults is None or not faults[first - 1 : first + count + 1].any():
            return rows
        nearer = faults[first : first + count]
        if whole:
            return rows + nearer
        low = math.floor(offset)
        share = offset % 1.0
        before = faults[low : low + count]
        after = faults[low + 1 : low + 1 + count]
        straight = before + share * (after - before)
        found = np.where(np.abs(after - before) > self.law.drop, nearer, straight)
        edges = self._own_edges(offset)
        if edges is not None:
            was = self.law.sound[low : low + count]
            will_be = self.law.sound[low + 1 : low + 1 + count]
            sound = np.where(was & will_be, found, np.maximum(before, after))
            found = np.where(edges.sound, sound, np.where(was | will_be, np.minimum(before, after), found))
        return rows + found

    def _between(self, offset: float) -> Array:
        return self.law.between_rows(offset + np.arange(self.law.body.shape[0]))

    def _start(self, step: int) -> None:
        """Let a step start from the accepted pressures, else from nothing."""
        from asperity.kernels.scanning import continue_rolling

        last = self._last
        before = self._before
        size = len(self.pressure)
        self.block.solved[0] = 0
        if last is None or not 0 <= (rows := round(self.offsets[step]) - last.row) < size:
            return
        if before is None or not 0 <= last.row - before.row < size:
            before = last
        moved = last.row - before.row
        cap = self.half_space.pressure_cap
        continue_rolling(last.pressure, before.pressure, rows, moved, cap, self.start)
        self.block.solved[0] = 1


LAW = spec.LawSpec(
    "direct",
    "The three-dimensional contact, solved in every time step: the reference.",
    spec.from_materials(Direct, heights="sound_heights", drop="working_approach"),
    {spec.Need.SURFACE},
    solved_every_step=True,
    both_surfaces=True,
    role=spec.Role.REFERENCE,
    look=spec.Look("#1c2126", (0, (16, 2)), "v"),
)
