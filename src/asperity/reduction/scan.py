"""The quasi-static scan F_c(x, r): a body moved along a surface, the 3-D contact solved at each position."""

from __future__ import annotations

import warnings
from collections.abc import Callable, Generator, Sequence
from contextlib import closing
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, Generic, TypeVar

import numpy as np
from numpy.typing import ArrayLike, NDArray

from asperity.arguments import real, real_array, shown, two_lengths, whole
from asperity.contact.device import Device, find_device
from asperity.errors import Grade, InputError, TruncatedContactWarning, UnconvergedWarning, percent
from asperity.reduction import batched_scan
from asperity.reduction.accuracy import in_single
from asperity.reduction.blocks import TRUNCATED, Contacts, solve_block
from asperity.reduction.pool import in_order
from asperity.reduction.stored import StoredForces
from asperity.store import Cache, content_key
from asperity.surfaces.heightmap import HeightMap, Profile
from asperity.surfaces.strip import Rows, Strip
from asperity.threads import thread_count

if TYPE_CHECKING:
    import xarray

F = TypeVar("F", NDArray[np.float64], StoredForces)

BLOCK = 256
"""Positions solved in one go, from a cold start: the unit of parallel work and of what is kept on disk."""


@dataclass(frozen=True, eq=False)
class ScannedForces(Generic[F]):
    """Forces of a scan, with how well the solutions went.

    Attributes
    ----------
    forces : ndarray, or StoredForces from `scan_into`, shape (n_approaches, n_positions)
        F_c(x_m, r_i), N.
    solved : int
        Solutions in contact.
    iterations : int
        Conjugate-gradient iterations of all solutions.
    unconverged : int
        Solutions that missed the tolerance.
    truncated : int
        Solutions with a noticeable share of the force on the window's edge.
    single : bool
        Whether the iteration was in single precision.
    """

    forces: F
    solved: int
    iterations: int
    unconverged: int
    truncated: int
    single: bool = field(default=False, kw_only=True)


def scan(
    heights: ArrayLike | HeightMap,
    spacing: float | tuple[float, float] | None,
    body: ArrayLike,
    modulus: float,
    approaches: ArrayLike,
    hardness: float | None = None,
    *,
    stride: int = 1,
    rtol: float = 1e-6,
    workers: int | None = None,
    cache: Cache | None = None,
    progress: Callable[[int, int, str], None] | None = None,
    device: str | None = None,
) -> xarray.DataArray:
    """Move a body along a surface and record the contact force at fixed approaches.

    Parameters
    ----------
    heights : array_like, shape (n, ny), or HeightMap
        Heights of the surface, m, peaks positive; the first axis is the rolling direction.
    spacing : tuple of float, float or None
        (dx, dy), m; one number stands for both, None for the spacing of a `HeightMap`.
    body : array_like, shape (nx, ny)
        Shape of the smooth body, m, zero at its lowest point. Position m puts it on rows m … m + nx − 1.
    modulus : float
        Contact modulus E*, Pa.
    approaches : array_like, shape (k,)
        Approaches from the mean plane of the heights, m, positive closing, increasing; one number is one.
    hardness : float, optional
        Pressure cap, Pa.
    stride : int
        Rows between positions.
    rtol : float
        Tolerance of each solution, as in `HalfSpace.solve`.
    workers : int, optional
        Threads; by default as many as `asperity.threads` says. The result does not depend on it.
    cache : Cache, optional
        Keeps finished blocks, so that an interrupted scan goes on where it was.
    progress : callable, optional
        ``progress(done, total, message)``.
    device : str, optional
        ``"cpu"``, or ``"gpu"`` to solve in batches through CuPy; by default what ``$ASPERITY_DEVICE`` says,
        else ``"cpu"``. Forces agree within the tolerance.

    Returns
    -------
    xarray.DataArray, dims (approach, position)
        Force, N. The coordinate `position` is the offset of the body's window along x, m.

    Raises
    ------
    InputError
        For sizes that do not fit, or values that are not finite.
    """
    import xarray

    z, (dx, dy) = _surface(heights, spacing)
    delta = np.atleast_1d(real_array("approaches of the scan", approaches, "increasing lengths in m"))
    shape = real_array("body of the scan", body, "an array (nx, ny) of lengths in m")
    pressure = "a positive number, Pa"
    stiff = real("contact modulus", modulus, pressure, above=0.0)
    cap = None if hardness is None else real("hardness", hardness, f"{pressure}, or None", above=0.0)
    step = whole("stride of the scan", stride, "a whole number ≥ 1", at_least=1)
    _check_settings(rtol, workers, cache, progress)
    result = scan_forces(
        z - z.mean(), (dx, dy), shape, stiff, delta, cap,
        stride=step, rtol=rtol, workers=workers, cache=cache, progress=progress, device=device,
    )  # fmt: skip
    remedy = ""
    if result.truncated:
        overlap = delta[-1] - float(first_touch(z - z.mean(), shape, step).min())
        remedy = f"A window of {window_for(shape, (dx, dy), overlap) * 1e3:.3g} mm holds them."
    warn_of_scans([result], "the scan", remedy)
    position = np.arange(result.forces.shape[1]) * step * dx
    return xarray.DataArray(
        result.forces,
        dims=("approach", "position"),
        coords={
            "approach": ("approach", delta, {"units": "m", "long_name": "approach from the mean plane"}),
            "position": ("position", position, {"units": "m", "long_name": "offset of the window along x"}),
        },
        name="force",
        attrs={
            "units": "N",
            "long_name": "quasi-static contact force",
            "iterations": result.iterations,
            "unconverged": result.unconverged,
            "truncated": result.truncated,
        },
    )


def _surface(
    heights: ArrayLike | HeightMap, spacing: object
) -> tuple[NDArray[np.float64], tuple[float, float]]:
    """Heights and spacing of what is scanned, complete."""
    if isinstance(heights, Profile):
        raise InputError("heights of the scan", "a line of heights", "a map of heights")
    if isinstance(heights, HeightMap):
        if spacing is not None and not np.allclose(
            two_lengths("spacing of the scan", spacing), heights.spacing, rtol=1e-9, atol=0.0
        ):
            received = f"{shown(spacing)} beside a height map with {heights.spacing}"
            raise InputError("spacing of the scan", received, "None, or the spacing of the map, m")
        spacing, heights = heights.spacing, heights.heights
    allowed = "a height map, or an array (n, ny) of finite lengths in m"
    z = real_array("heights of the scan", heights, allowed)
    if z.ndim != 2 or not np.isfinite(z).all():
        missing = z.size - int(np.isfinite(z).sum())
        received = f"{missing} of {z.size} points without a height" if missing else f"an array {z.shape}"
        raise InputError("heights of the scan", received, allowed, "Fill missing points." * bool(missing))
    return z, two_lengths("spacing of the scan", spacing)


def _check_settings(rtol: object, workers: object, cache: object, progress: object) -> None:
    real("rtol", rtol, "a number between 0 and 1, as 1e-6", above=0.0, at_most=1.0)
    if workers is not None:
        whole("workers", workers, "a number of threads, 1 or more, or None", at_least=1)
    if cache is not None and not (hasattr(cache, "get") and hasattr(cache, "put")):
        raise InputError("cache", shown(cache), "an object with get and put, as Store(), or None")
    if progress is not None and not callable(progress):
        raise InputError("progress", shown(progress), "a callable (done, total, message), or None")


def scan_forces(
    heights: NDArray[np.float64] | Strip,
    spacing: tuple[float, float],
    body: ArrayLike,
    modulus: float,
    approaches: ArrayLike,
    hardness: float | None = None,
    *,
    stride: int = 1,
    rtol: float = 1e-6,
    workers: int | None = None,
    cache: Cache | None = None,
    progress: Callable[[int, int, str], None] | None = None,
    planes: ArrayLike | None = None,
    message: str = "scanning the contact",
    device: str | None = None,
) -> ScannedForces[NDArray[np.float64]]:
    """Scan as in `scan`, with approaches from given planes instead of the mean plane.

    Parameters
    ----------
    heights : ndarray, shape (n, ny), or Strip
        Heights of the surface, m, peaks positive.
    spacing, body, modulus, approaches, hardness, stride, rtol, workers, cache, progress, device
        As in `scan`.
    planes : array_like, shape (n_positions,), optional
        Height of the plane from which approaches count at each position, m; zero by default.
    message : str
        What the progress bar says.

    Returns
    -------
    ScannedForces
        Forces and counts; `warn_of_flaws` tells of what went wrong.

    Raises
    ------
    InputError
        For sizes that do not fit.
    """
    job = _job(heights, spacing, body, modulus, approaches, hardness, stride, rtol, planes, device)
    forces = np.empty((len(job.approaches), job.positions))
    counts, done = np.zeros(4, dtype=np.int64), 0
    for block in _blocks(job, workers, cache, progress, message):
        forces[:, done : done + block.forces.shape[1]] = block.forces
        done += block.forces.shape[1]
        counts += block.counts
    return ScannedForces(forces, *counts.tolist(), single=job.single)


def scan_into(
    cache: Cache,
    heights: NDArray[np.float64] | Strip,
    spacing: tuple[float, float],
    body: ArrayLike,
    modulus: float,
    approaches: ArrayLike,
    hardness: float | None = None,
    *,
    stride: int = 1,
    rtol: float = 1e-6,
    workers: int | None = None,
    progress: Callable[[int, int, str], None] | None = None,
    planes: ArrayLike | None = None,
    message: str = "scanning the contact",
    device: str | None = None,
) -> ScannedForces[StoredForces]:
    """Scan a path of any length: its forces stay in the cache, block by block.

    Parameters
    ----------
    cache : Cache
        Receives the blocks. A scan that was interrupted, or killed, goes on after the last block kept.
    heights, spacing, body, modulus, approaches, hardness
        As in `scan_forces`.
    stride, rtol, workers, progress, planes, message, device
        As in `scan_forces`.

    Returns
    -------
    ScannedForces
        Its forces are `StoredForces`. Memory holds the blocks in work and eight bytes a position.

    Raises
    ------
    InputError
        For sizes that do not fit.
    """
    job = _job(heights, spacing, body, modulus, approaches, hardness, stride, rtol, planes, device)
    keys, counts = [], np.zeros(4, dtype=np.int64)
    for block in _blocks(job, workers, cache, progress, message):
        keys.append(block.key)
        counts += block.counts
    forces = StoredForces(cache, tuple(keys), job.block, (len(job.approaches), job.positions))
    return ScannedForces(forces, *counts.tolist(), single=job.single)


@dataclass(frozen=True, eq=False)
class _Job:
    """A scan to be done: what every block of it needs."""

    strip: Strip
    spacing: tuple[float, float]
    body: NDArray[np.float64]
    modulus: float
    approaches: NDArray[np.float64]
    hardness: float | None
    stride: int
    rtol: float
    planes: NDArray[np.float64]
    device: Device | None

    @property
    def block(self) -> int:
        return BLOCK if self.device is None else batched_scan.BLOCK

    @property
    def positions(self) -> int:
        return len(self.planes)

    @property
    def single(self) -> bool:
        """Whether the processor iterates in single precision."""
        cells = self.positions * self.approaches.size * self.body.size
        return self.device is None and in_single(self.rtol, cells)


@dataclass(frozen=True, eq=False)
class _Block:
    """Solutions at the positions of a block: forces (k, positions), and the counts of `ScannedForces`."""

    key: str
    forces: NDArray[np.float64]
    counts: NDArray[np.int64]


def _job(
    heights: NDArray[np.float64] | Strip,
    spacing: tuple[float, float],
    body: ArrayLike,
    modulus: float,
    approaches: ArrayLike,
    hardness: float | None,
    stride: int,
    rtol: float,
    planes: ArrayLike | None,
    device: str | None,
) -> _Job:
    strip = Rows(heights) if isinstance(heights, np.ndarray) else heights
    shape = np.ascontiguousarray(body, dtype=np.float64)
    delta = np.atleast_1d(np.asarray(approaches, dtype=np.float64))
    _check(strip.shape, shape, delta, stride)
    positions = len(range(0, strip.shape[0] - shape.shape[0] + 1, stride))
    plane = np.broadcast_to(np.asarray(0.0 if planes is None else planes, dtype=np.float64), (positions,))
    return _Job(strip, spacing, shape, modulus, delta, hardness, stride, rtol, plane, find_device(device))


def _blocks(
    job: _Job,
    workers: int | None,
    cache: Cache | None,
    progress: Callable[[int, int, str], None] | None,
    message: str,
) -> Generator[_Block]:
    """Blocks of a scan in order, from the cache or solved, each from a cold start of its own."""
    report = progress or (lambda done, total, message: None)
    count = (workers or thread_count()) if job.device is None else 1  # one block fills a device
    count = min(count, -(-job.positions // job.block))
    parameters = [list(job.spacing), job.modulus, job.hardness, job.stride, job.rtol]
    parameters += ["batched"] if job.device else ["single"] if job.single else []
    contacts = Contacts(
        job.body, job.approaches, job.spacing, job.modulus, job.hardness, job.stride, job.rtol, job.single
    )

    def block(first: int) -> _Block:
        planes = np.ascontiguousarray(job.planes[first : first + job.block])
        stop = (first + len(planes) - 1) * job.stride + job.body.shape[0]
        rows = np.ascontiguousarray(job.strip.rows(first * job.stride, stop))
        if cache is None:
            return _Block("", *solve_block(contacts, rows, planes, job.device))
        key = content_key("scan", rows, job.body, job.approaches, planes, parameters)
        kept = cache.get(key)
        if kept is None:
            forces, counts = solve_block(contacts, rows, planes, job.device)
            kept = {"forces": forces, "counts": counts}
            cache.put(key, kept)
        return _Block(key, kept["forces"], kept["counts"])

    report(0, job.positions, message)
    done = 0
    with closing(in_order(block, range(0, job.positions, job.block), count)) as blocks:
        for found in blocks:
            done += found.forces.shape[1]
            report(done, job.positions, message)
            yield found


def _check(surface: tuple[int, int], body: NDArray, approaches: NDArray, stride: int) -> None:
    if body.ndim != 2 or not np.isfinite(body).all():
        raise InputError("body of the scan", f"shape {body.shape}", "a finite (nx, ny) array")
    if surface[1] != body.shape[1] or surface[0] < body.shape[0]:
        raise InputError(
            "window of the scan",
            f"{_cells(body.shape)} on a surface of {_cells(surface)}",
            "a window as wide as the surface and not longer",
            "Choose a smaller window or provide a larger map.",
        )
    if approaches.size == 0 or not np.isfinite(approaches).all() or np.any(np.diff(approaches) <= 0):
        raise InputError("approaches of the scan", approaches.tolist(), "finite, increasing lengths in m")
    if stride < 1:
        raise InputError("stride of the scan", stride, "a whole number ≥ 1")


def _cells(shape: tuple[int, ...]) -> str:
    return f"{shape[0]} × {shape[1]} cells"


def warn_of_scans(
    scans: Sequence[ScannedForces[Any]], what: str, remedy: str = "Enlarge the window."
) -> None:
    """Warn, once for all of them, of solutions that did not converge or were cut off.

    Parameters
    ----------
    scans : sequence of ScannedForces
        Scans.
    what : str
        What they were made for, as ``"the scan"``.
    remedy : str
        What to do about contacts that are cut off.
    """
    solved = sum(s.solved for s in scans)
    unconverged, truncated = sum(s.unconverged for s in scans), sum(s.truncated for s in scans)
    warn_of_flaws(solved, unconverged, truncated, what, remedy)


def warn_of_flaws(
    solved: int, unconverged: int, truncated: int, what: str, remedy: str = "Enlarge the window."
) -> None:
    """Warn of contact solutions that did not converge or were cut off, graded by their share.

    Parameters
    ----------
    solved, unconverged, truncated : int
        Number of solutions in contact, and of those that missed the tolerance or reached the edge.
    what : str
        What they were made for.
    remedy : str
        What to do about contacts that are cut off.
    """
    if unconverged:
        share = unconverged / max(solved, 1)
        warnings.warn(
            UnconvergedWarning(
                f"{unconverged} of {solved} contact solutions of {what} ({percent(share)}) missed their "
                "tolerance; their forces are approximate. Try a larger `rtol`, and check the surface for "
                "outliers.",
                Grade.of_share(share),
            ),
            stacklevel=4,
        )
    if truncated:
        share = truncated / max(solved, 1)
        warnings.warn(
            TruncatedContactWarning(
                f"in {truncated} of {solved} contact solutions of {what} ({percent(share)}) more than "
                f"{100 * TRUNCATED:.0f} % of the force acts on the window's edge: the contact is cut off and "
                f"its force too small{_MEANING[Grade.of_share(share)]}. {remedy}",
                Grade.of_share(share),
            ),
            stacklevel=4,
        )


_MEANING = {
    Grade.NOTE: ", too seldom to matter",
    Grade.WARNING: "",
    Grade.OUT: ", so often that levels are wrong",
}


def window_for(body: NDArray[np.float64], spacing: tuple[float, float], overlap: float) -> float:
    """Side of a square window that holds a contact.

    Parameters
    ----------
    body : ndarray, shape (nx, ny)
        Shape of the body, m, zero at its lowest point; it goes on outwards as a parabola.
    spacing : tuple of float
        (dx, dy), m.
    overlap : float
        Largest overlap of the undeformed bodies, with the highest peak, m.

    Returns
    -------
    float
        m: Hertz's patch of smooth bodies at that overlap, and a tenth more for peaks beyond it.
    """
    middle = [n // 2 for n in body.shape]
    edges = min(body[0, middle[1]], body[-1, middle[1]]), min(body[middle[0], 0], body[middle[0], -1])
    grown = [np.sqrt(max(0.5 * overlap / edge, 0.0)) if edge > 0.0 else 1.0 for edge in edges]
    return 1.1 * float(max(n * d * g for n, d, g in zip(body.shape, spacing, grown, strict=True)))


def first_touch(
    heights: NDArray[np.float64] | Strip, body: NDArray[np.float64], stride: int = 1
) -> NDArray[np.float64]:
    """Find the approach at which the body first touches the surface, at each position.

    Parameters
    ----------
    heights : ndarray, shape (n, ny), or Strip
        Heights from the plane z = 0, m.
    body : ndarray, shape (nx, ny)
        Shape of the body, m, zero at its lowest point.
    stride : int
        Rows between positions.

    Returns
    -------
    ndarray, shape (n_positions,)
        Approaches from that plane, m; usually negative: peaks touch before the planes meet.
    """
    strip, nx = Rows(heights) if isinstance(heights, np.ndarray) else heights, body.shape[0]
    starts = range(0, strip.shape[0] - nx + 1, stride)
    result = np.empty(len(starts))
    for first in range(0, len(starts), BLOCK):
        block = starts[first : first + BLOCK]
        rows = strip.rows(block[0], block[-1] + nx)
        for m, start in enumerate(block):
            at = start - block[0]
            result[first + m] = (body - rows[at : at + nx]).min()
    return result
