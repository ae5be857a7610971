"""A body moved along a surface: what is asked of the scan, its blocks on threads or a device, its flaws."""

import tempfile
import time
from collections import deque
from collections.abc import Generator, Iterable, Sequence
from contextlib import closing, suppress
from dataclasses import dataclass, field
from functools import partial
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numpy.lib.stride_tricks import sliding_window_view
from numpy.typing import NDArray

from asperity.arguments import Array, ArrayLike, finite_array, real, real_array, require, shown, whole
from asperity.contact.batched import Device, find_device, solve_batched
from asperity.contact.edges import KEPT
from asperity.contact.elastic_grid import box_around, check_edges
from asperity.contact.pressed import block_of, solve_block
from asperity.errors import Grade, TruncatedContactWarning, UnconvergedWarning, percent
from asperity.kernels.scanning import TRUNCATED
from asperity.progress import Progress, counted
from asperity.store import PATIENCE, Store, content_key, made
from asperity.surfaces.edges import Edges
from asperity.surfaces.heightmap import HeightMap, Profile
from asperity.surfaces.strip import Rows, Strip
from asperity.threads import in_order, thread_count
from asperity.written_numbers import rounded

if TYPE_CHECKING:
    import xarray

    from asperity.contact.elastic_grid import ElasticGrid

FORCE_ACCURACY = 1e-4
"""Largest relative error of a scanned force: at most 0.2 dB in a band of the force on a path, to ka = 16."""
FILTER_SHARE = 0.1
"""Accuracy of the scans for contact filters, relative to that: short waves are small parts of a force."""
SAFETY = 2.5
"""Residual asked for, below the accuracy of the force: see `rtol_for`."""

SINGLE_ENOUGH = 2e-6
"""`rtol` from which single precision reaches it in as many iterations as double."""
SINGLE_PAYS = 3e7
"""Cells of all contacts of a state from which single precision, faster by a third, soon saves the 10 s that
compiling it takes, once: nine states of six such scans."""


def rtol_for(force_accuracy: float) -> float:
    """`rtol` of a contact solution whose force shall have a relative accuracy, above 0 and at most 0.1.

    Notes
    -----
    A residual e on the contact set acts as an error of the approach: by reciprocity it changes the force by
    no more than k_t max|e|. Relative to the force, with F growing as the n-th power of the overlap, that is n
    times the relative residual: 1.5 for Hertz, 1 to 3 for rough contacts, if the residual had everywhere its
    largest value and one sign. It alternates: on smooth, rough and flowing contacts, from first touches to
    heavy loads, the largest error found is twice the relative residual; so it is where a scan, which knows
    what an approach adds to the pressure, stops at a residual six times as large
    (``benchmarks/force_accuracy.py``).
    """
    allowed = "a number above 0, at most 0.1, as 1e-4"
    return real("force_accuracy", force_accuracy, allowed, above=0.0, at_most=0.1) / SAFETY


class Counts(NamedTuple):
    """Contact solutions, and how they went."""

    solved: int = 0  # in contact
    iterations: int = 0  # of conjugate gradients, all solutions together
    unconverged: int = 0  # missed the tolerance
    truncated: int = 0  # with a noticeable share of the force on the window's edge


def total(counts: Iterable[Counts]) -> Counts:
    """Counts of several scans together."""
    return Counts(*(sum(column) for column in zip(*counts, strict=True)))


def warn_of_flaws(
    counts: Counts,
    what: str,
    tolerance: str,
    remedy: str = "Enlarge the window.",
    consequence: str = "its force too small",
) -> None:
    """Warn of contact solutions that did not converge or were cut off, graded by their share.

    They were made for `what`, as ``"the scan"``; `tolerance` is the key or argument that says how tightly
    they are solved, `remedy` what to do about contacts that are cut off, and `consequence` what becomes of
    them.
    """
    solved, _, unconverged, truncated = counts
    if unconverged:
        share = unconverged / max(solved, 1)
        UnconvergedWarning.warn(
            f"{unconverged} of {solved} contact solutions of {what} ({percent(share)}) missed their "
            f"tolerance; their forces are approximate. Try a larger {tolerance}, and check the surface for "
            "outliers.",
            Grade.of_share(share),
        )
    if truncated:
        share = truncated / max(solved, 1)
        grade = Grade.of_share(share)
        TruncatedContactWarning.warn(
            f"in {truncated} of {solved} contact solutions of {what} ({percent(share)}) more than "
            f"{100 * TRUNCATED:.0f} % of the force acts on the window's edge: the contact is cut off and "
            f"{consequence}{_MEANING[grade]}. {remedy}",
            grade,
        )


_MEANING = {
    Grade.NOTE: ", too seldom to matter",
    Grade.WARNING: "",
    Grade.OUT: ", so often that levels are wrong",
}


def window_for(body: Array, spacing: tuple[float, float], overlap: float) -> float:
    """Side of a square window, m, that holds the contact of a body (nx, ny), m, which goes on as a parabola.

    Hertz's patch of smooth bodies at the largest overlap, m, of the undeformed ones, with the highest peak,
    and a tenth more for peaks beyond it.
    """
    middle = [n // 2 for n in body.shape]
    edges = min(body[0, middle[1]], body[-1, middle[1]]), min(body[middle[0], 0], body[middle[0], -1])
    grown = [np.sqrt(max(0.5 * overlap / edge, 0.0)) if edge > 0.0 else 1.0 for edge in edges]
    return 1.1 * float(max(n * d * g for n, d, g in zip(body.shape, spacing, grown, strict=True)))


def heights_on(half_space: "ElasticGrid", surface: ArrayLike | HeightMap, what: str) -> Array:
    """Heights of a surface, complete and on the grid of a half-space, m; `what` names it in messages."""
    require(not isinstance(surface, Profile), what, "a line of heights", "a map of heights")
    if isinstance(surface, HeightMap):
        received, own = (f"{dx:.6g} × {dy:.6g} m" for dx, dy in (surface.spacing, half_space.spacing))
        require(
            np.allclose(surface.spacing, half_space.spacing, rtol=1e-9, atol=0.0),
            what,
            f"a height map with points {received} apart",
            f"{own} apart, as in the half-space",
            "Resample the map, or choose the half-space's spacing after it.",
        )
        surface = surface.heights
    allowed = "a height map, or an array (n, ny) of finite lengths in m"
    heights = real_array(what, surface, allowed)
    missing = heights.size - int(np.isfinite(heights).sum())
    received = f"{missing} of {heights.size} points without a height"
    require(not missing, what, received, allowed, "Fill missing points.")
    return finite_array(what, heights, allowed, shape=(None, None))


def check_window(what: str, cells: tuple[int, ...], surface: tuple[int, ...]) -> None:
    """Refuse a window whose cells do not fit on those of a surface."""
    require(
        surface[1] == cells[1] and surface[0] >= cells[0],
        f"window of {what}",
        f"{cells[0]} × {cells[1]} cells on a surface of {surface[0]} × {surface[1]} cells",
        "a window as wide as the surface and not longer",
        "Choose a smaller window or provide a larger map.",
    )


def check_settings(workers: object, cache: object, progress: object) -> None:
    """Refuse what is no number of threads, no cache, or no progress."""
    if workers is not None:
        whole("workers", workers, "a number of threads, 1 or more, or None", at_least=1)
    keeps = cache is None or (hasattr(cache, "get") and hasattr(cache, "put"))
    require(keeps, "cache", shown(cache), "an object with get and put, as Store(), or None")
    tells = progress is None or callable(progress)
    require(tells, "progress", shown(progress), "a callable (done, total, message), or None")


BLOCK = 256
"""Positions solved in one go, from a cold start: the unit of parallel work and of what is kept on disk."""
TOUCHED = 8192
"""Positions whose first touch is sought in one go."""
CELLS = 32
"""Cells of a body after which it is asked whether higher ones can be the first to touch."""
BESIDE = 2
"""Cells beside those that overlap: one may be in contact, the next is not."""
BATCH = 4096
"""Positions of a block on a device: enough to fill it, and few enough to be kept often."""
BLOCK_BYTES = 1200
"""What the file of a block holds beside its forces, bytes."""


@dataclass(frozen=True, eq=False)
class ScanJob:
    """A body to be moved along a surface, and how its contacts are solved: all that the forces depend on."""

    half_space: "ElasticGrid"  # grid of the window, (nx, ny) cells; modulus and hardness
    surface: Strip  # (n, ny) heights, m, peaks positive
    body: Array  # (nx, ny), shape of the smooth body, m, zero at its lowest point
    approaches: Array  # (k,), from the planes, m, increasing
    stride: int = 1  # rows between positions: the body stands on rows from `first`, first + stride, … on
    rtol: float = 1e-6  # tolerance of each solution, as in `HalfSpace.solve`
    planes: Array | float = 0.0  # (positions,), from which approaches count, m
    anchor: int = 0  # row from which positions and blocks count: surfaces alike from there on share them
    device: Device | None = field(default_factory=find_device)
    """Where contacts are solved in batches; None for the processor, which solves them one by one."""
    edges: Edges | None = None  # of the surface, on the same rows

    def __post_init__(self) -> None:
        cells = self.half_space.shape
        n, width = self.surface.shape
        allowed = f"a finite array of the half-space's shape {cells}"
        body = finite_array("body of the scan", self.body, allowed, shape=cells)
        check_window("the scan", cells, (n, width))
        what = "approaches of the scan"
        allowed = "finite, increasing lengths in m"
        approaches = finite_array(what, np.atleast_1d(self.approaches), allowed, rising=True)
        require(approaches.size, what, "none", allowed)
        if self.edges is not None:
            check_edges(self.edges, self.half_space, (n, width))
        whole("stride of the scan", self.stride, "a whole number ≥ 1", at_least=1)
        object.__setattr__(self, "body", body)
        object.__setattr__(self, "approaches", approaches)

    @property
    def positions(self) -> int:
        """Number of positions."""
        return len(range(self.first, self.surface.shape[0] - self.body.shape[0] + 1, self.stride))

    @property
    def first(self) -> int:
        """First row that the body stands on."""
        return self.anchor % self.stride

    @property
    def block(self) -> int:
        """Positions of a block; the last may have fewer."""
        return BLOCK if self.device is None else BATCH

    @property
    def ahead(self) -> int:
        """Positions that the first block lacks, so that one begins at the anchor."""
        return -(self.anchor // self.stride) % self.block

    @property
    def starts(self) -> list[int]:
        """First position of each block."""
        return [max(i, 0) for i in range(-self.ahead, self.positions, self.block)]

    @property
    def single(self) -> bool:
        """Whether the processor iterates in single precision: where it is enough, and pays.

        That a state is scanned with others changes no digit of it.
        """
        cells = self.positions * self.body.size
        enough = self.rtol >= SINGLE_ENOUGH
        return self.device is None and enough and cells >= SINGLE_PAYS

    @property
    def bytes(self) -> int:
        """What the kept blocks take on disk, about."""
        return 8 * self.positions * self.approaches.size + BLOCK_BYTES * len(self.starts)

    def under(self, start: int) -> tuple[Array, Array, Edges | None]:
        """Heights under a block, m, (rows, ny), the planes of its positions, m, and edges there, if any."""
        known = np.broadcast_to(np.asarray(self.planes, dtype=np.float64), (self.positions,))
        beyond = self.block * ((start + self.ahead) // self.block + 1) - self.ahead
        planes = np.ascontiguousarray(known[start:beyond])
        row = self.first + start * self.stride
        stop = row + (len(planes) - 1) * self.stride + self.body.shape[0]
        edges = None if self.edges is None else self.edges.rearranged(lambda field: field[row:stop])
        crossed = edges is not None and edges.crossed.any()
        return np.ascontiguousarray(self.surface.rows(row, stop)), planes, edges if crossed else None

    def key(self, rows: Array, planes: Array, edges: Edges | None = None) -> str:
        """Name in the store of the block on these heights, with these edges."""
        space = self.half_space
        parameters = [list(space.spacing), space.modulus, space.hardness, self.stride, self.rtol]
        parameters += ["batched"] if self.device else ["single"] if self.single else []
        parameters += [] if space.cells == "whole" else [space.cells]
        sharp = [] if edges is None else [edges.distance, edges.normal, edges.drop, KEPT]
        return content_key("scan", rows, self.body, self.approaches, planes, *sharp, parameters)

    def solve(self, rows: Array, planes: Array, edges: Edges | None = None) -> dict[str, NDArray[Any]]:
        """Forces of a block from a cold start, N, (k, positions), and its `Counts`, as a cache keeps them."""
        space = self.half_space
        body = self.body
        if self.device is None:
            along, across = self.touched(float(rows.max() - planes.min()))
            beneath = slice(along.start, len(rows) - len(body) + along.stop)
            rows, body = rows[beneath, across], body[along, across]
            edges = None if edges is None else edges.rearranged(lambda field: field[beneath, across])
        soft = None if edges is None else space.softness(edges)
        block = block_of(
            space, rows, body, planes, self.approaches, self.stride, self.rtol, self.single, soft=soft,
            forces_alone=True,
        )  # fmt: skip
        if self.device is None:
            solve_block(space, block)
        else:
            solve_batched(space, block, self.device)
        return {"forces": block.totals * space.cell_area, "counts": block.counts}

    def touched(self, highest: float) -> tuple[slice, slice]:
        """Rows and columns of the window that overlap where no height above its plane is higher, m.

        With cells around them, from which pressure moves in with the surface, or where the window ends.
        """
        overlaps = self.body - highest < self.approaches[-1]
        if not overlaps.any():
            return slice(0, 1), slice(0, 1)
        along, across = box_around(overlaps)
        nx, ny = self.body.shape
        return (
            slice(max(along.start - BESIDE, 0), min(along.stop + BESIDE + self.stride, nx)),
            slice(max(across.start - BESIDE, 0), min(across.stop + BESIDE, ny)),
        )

    @property
    def remedy(self) -> str:
        """What to do about contacts that are cut off."""
        overlap = self.approaches[-1] - float(first_touch(self.surface, self.body, self.stride).min())
        side = window_for(self.body, self.half_space.spacing, overlap)
        return f"A window of {rounded(side * 1e3)} mm holds them."


@dataclass(frozen=True, eq=False)
class ScannedForces:
    """Forces of a scan, with how well the solutions went."""

    forces: Array  # F_c(x_m, r_i), N, shape (n_approaches, n_positions)
    counts: Counts
    single: bool  # whether the iteration was in single precision


def solved_blocks(
    job: ScanJob,
    cache: Store | None = None,
    workers: int | None = None,
    progress: Progress | None = None,
    message: str = "scanning the contact",
    beside: Sequence[ScanJob] = (),
) -> Generator[tuple[Array, Counts]]:
    """Forces (k, positions), N, and counts of the blocks of a scan, in order, from the cache or solved.

    On so many threads, by default `thread_count`: their number changes no digit. A scan that was interrupted
    goes on after the last block kept. Processes that need the same scan share its work: while another one
    solves a block, the last one that nobody solves is solved here, of this scan or of those that are done
    `beside` it.
    """
    count = (workers or thread_count()) if job.device is None else 1  # one block fills a device
    spare = deque((other, start) for other in (beside or [job]) for start in other.starts)

    def help_along() -> None:
        while spare:
            other, start = spare.pop()
            under = other.under(start)
            key = other.key(*under)
            assert cache is not None
            with cache.claim(key) as free:
                if free and cache.get(key) is None:
                    cache.put(key, other.solve(*under))
                    return
        time.sleep(PATIENCE)

    def block(start: int) -> tuple[Array, Counts]:
        under = job.under(start)
        solve = partial(job.solve, *under)
        kept = made(cache, job.key(*under), solve, help_along)
        return kept["forces"], Counts(*kept["counts"].tolist())

    with closing(in_order(block, job.starts, min(count, len(job.starts)))) as blocks:
        yield from counted(blocks, job.positions, message, progress, lambda found: found[0].shape[1])


def scan_forces(job: ScanJob, *, mapped: bool = False, **how: Any) -> ScannedForces:
    """Scan, and hold the forces in memory, or mapped from a temporary file where one can be written.

    Memory then holds the blocks in work alone, whatever the path. Further arguments as in `solved_blocks`.
    """
    with suppress(OSError):
        if mapped:
            return _mapped(job, **how)
    forces, counts = zip(*solved_blocks(job, **how), strict=True)
    return ScannedForces(np.concatenate(forces, axis=1), total(counts), job.single)


def _mapped(job: ScanJob, **how: Any) -> ScannedForces:
    """Scan into a temporary file, position after position, which is gone with the forces."""
    counts = []
    with tempfile.TemporaryFile(prefix="asperity-") as file:
        for forces, found in solved_blocks(job, **how):
            file.write(np.ascontiguousarray(forces.T).data)
            counts.append(found)
        file.flush()
        held = np.memmap(file, np.float64, "r", shape=(job.positions, len(job.approaches)))
    return ScannedForces(held.T, total(counts), job.single)


def joined_states(scans: Sequence[ScannedForces]) -> ScannedForces:
    """Forces of scans of the same positions at states that follow one another, mapped as those are."""
    if len(scans) == 1:
        return scans[0]
    forces = [each.forces for each in scans]
    counts = total(each.counts for each in scans)
    single = any(each.single for each in scans)
    with suppress(OSError), tempfile.TemporaryFile(prefix="asperity-") as file:
        positions = forces[0].shape[1]
        states = sum(len(each) for each in forces)
        for first in range(0, positions, TOUCHED):
            piece = [each[:, first : first + TOUCHED].T for each in forces]
            file.write(np.concatenate(piece, axis=1).data)
        file.flush()
        held = np.memmap(file, np.float64, "r", shape=(positions, states))
        return ScannedForces(held.T, counts, single)
    return ScannedForces(np.concatenate(forces), counts, single)


def first_touch(surface: Array | Strip, body: Array, stride: int = 1, first: int = 0) -> Array:
    """Approach, m, at which the body first touches the surface at each position, shape (n_positions,).

    It counts from the plane z = 0, and is usually negative: peaks touch before the planes meet. Surface,
    body, stride and first row as in `ScanJob`.
    """
    strip = Rows(surface) if isinstance(surface, np.ndarray) else surface
    nx = body.shape[0]
    starts = range(first, strip.shape[0] - nx + 1, stride)
    lowest_first = np.argsort(body, axis=None, kind="stable")
    cells = list(zip(body.ravel()[lowest_first], *np.unravel_index(lowest_first, body.shape), strict=True))

    def touched(begin: int) -> Array:
        block = starts[begin : begin + TOUCHED]
        lines = np.ascontiguousarray(strip.rows(block[0], block[-1] + nx).T)
        highest = sliding_window_view(lines.max(axis=0), nx)[::stride].max(axis=1)
        nearest = np.full(len(block), np.inf)
        gap = np.empty(len(block))
        for tried, (height, offset, line) in enumerate(cells):  # a cell over all positions at once
            if tried % CELLS == 0 and (np.subtract(height, highest, out=gap) >= nearest).all():
                break  # this cell and all that are higher touch nothing first
            under = lines[line, offset : offset + (len(block) - 1) * stride + 1 : stride]
            np.minimum(nearest, np.subtract(height, under, out=gap), out=nearest)
        return nearest

    begins = range(0, len(starts), TOUCHED)
    return np.concatenate(list(in_order(touched, begins, min(thread_count(), len(begins)))))


def labelled(job: ScanJob, scanned: ScannedForces) -> "xarray.DataArray":
    """Forces as `HalfSpace.scan` returns them."""
    import xarray

    position = np.arange(job.positions) * job.stride * job.half_space.spacing[0]
    along = {"units": "m", "long_name": "offset of the window along x"}
    into = {"units": "m", "long_name": "approach from the mean plane"}
    _, iterations, unconverged, truncated = scanned.counts
    return xarray.DataArray(
        scanned.forces,
        dims=("approach", "position"),
        coords={"approach": ("approach", job.approaches, into), "position": ("position", position, along)},
        name="force",
        attrs={
            "units": "N",
            "long_name": "quasi-static contact force",
            "iterations": iterations,
            "unconverged": unconverged,
            "truncated": truncated,
        },
    )
