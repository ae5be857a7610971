"""The quasi-static scan F_c(x, r): a body moved along a surface, the 3-D contact solved at each position."""

from __future__ import annotations

import warnings
from collections.abc import Callable, Iterable, Sequence
from concurrent.futures import FIRST_COMPLETED, Future, ThreadPoolExecutor, wait
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike, NDArray

from asperity.contact.device import find_device
from asperity.contact.halfspace import HalfSpace
from asperity.errors import InputError, TruncatedContactWarning, UnconvergedWarning
from asperity.reduction import batched_scan
from asperity.store import Cache, content_key
from asperity.threads import thread_count

if TYPE_CHECKING:
    import xarray

BLOCK = 256
"""Positions solved in one go, from a cold start: the unit of parallel work and of what is kept on disk."""


TRUNCATED = 0.01
"""Share of the force on the window's edge from which a contact counts as cut off."""


@dataclass(frozen=True, eq=False)
class ScannedForces:
    """Forces of a scan, with how well the solutions went.

    Attributes
    ----------
    forces : ndarray, shape (n_approaches, n_positions)
        F_c(x_m, r_i), N.
    iterations : int
        Conjugate-gradient iterations of all solutions.
    unconverged : int
        Solutions that missed the tolerance.
    truncated : int
        Solutions with a noticeable share of the force on the window's edge.
    """

    forces: NDArray[np.float64]
    iterations: int
    unconverged: int
    truncated: int


def scan(
    heights: ArrayLike,
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
    device: str | None = None,
) -> xarray.DataArray:
    """Move a body along a surface and record the contact force at fixed approaches.

    Parameters
    ----------
    heights : array_like, shape (n, ny)
        Heights of the surface, m, peaks positive; the first axis is the rolling direction.
    spacing : tuple of float
        (dx, dy), m.
    body : array_like, shape (nx, ny)
        Shape of the smooth body, m, zero at its lowest point. Position m puts it on rows m … m + nx − 1.
    modulus : float
        Contact modulus E*, Pa.
    approaches : array_like, shape (k,)
        Approaches from the mean plane of `heights`, m, positive closing, increasing.
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

    z = np.ascontiguousarray(heights, dtype=np.float64)
    if z.ndim != 2 or not np.isfinite(z).all():
        raise InputError(
            "heights of the scan", f"shape {z.shape}", "a finite (n, ny) array", "Fill missing points."
        )
    delta = np.asarray(approaches, dtype=np.float64)
    result = scan_forces(
        z - z.mean(), spacing, body, modulus, delta, hardness,
        stride=stride, rtol=rtol, workers=workers, cache=cache, progress=progress, device=device,
    )  # fmt: skip
    warn_of_scans([result], "the scan")
    position = np.arange(result.forces.shape[1]) * stride * spacing[0]
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


def scan_forces(
    heights: NDArray[np.float64],
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
) -> ScannedForces:
    """Scan as in `scan`, with approaches from given planes instead of the mean plane.

    Parameters
    ----------
    heights, spacing, body, modulus, approaches, hardness, stride, rtol, workers, cache, progress, device
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
    shape = np.ascontiguousarray(body, dtype=np.float64)
    delta = np.atleast_1d(np.asarray(approaches, dtype=np.float64))
    _check(heights, shape, delta, stride)
    positions = np.arange(0, heights.shape[0] - shape.shape[0] + 1, stride)
    plane = np.broadcast_to(np.asarray(0.0 if planes is None else planes, dtype=np.float64), positions.shape)
    batches = find_device(device)
    length = BLOCK if batches is None else batched_scan.BLOCK

    def solve_block(first: int) -> NDArray[np.float64]:
        block = positions[first : first + length]
        rows = np.ascontiguousarray(heights[block[0] : block[-1] + shape.shape[0]])
        parameters = [list(spacing), modulus, hardness, stride, rtol, *(["batched"] if batches else [])]
        planes = np.ascontiguousarray(plane[first : first + length])
        key = content_key("scan", rows, shape, delta, planes, parameters) if cache is not None else ""
        kept = cache.get(key) if cache is not None else None
        if kept is not None:
            return kept["block"]
        half_space = HalfSpace((shape.shape[0], shape.shape[1]), spacing, modulus, hardness)
        if batches is None:
            solved = _solve_block(half_space, rows, shape, delta, planes, stride, rtol)
        else:
            solved = batched_scan.solve_rows(
                half_space, rows, shape, delta, planes, stride, rtol, batches, TRUNCATED
            )
        if cache is not None:
            cache.put(key, {"block": solved})
        return solved

    firsts = range(0, len(positions), length)
    # a device is filled by one block
    threads = workers if batches is None else 1
    blocks = _in_threads(solve_block, firsts, len(positions), threads, progress, message)
    stacked = np.concatenate(blocks, axis=2)
    forces, iterations, unconverged, truncated = stacked
    return ScannedForces(
        np.ascontiguousarray(forces), int(iterations.sum()), int(unconverged.sum()), int(truncated.sum())
    )


def _check(heights: NDArray, body: NDArray, approaches: NDArray, stride: int) -> None:
    if body.ndim != 2 or not np.isfinite(body).all():
        raise InputError("body of the scan", f"shape {body.shape}", "a finite (nx, ny) array")
    if heights.shape[1] != body.shape[1] or heights.shape[0] < body.shape[0]:
        raise InputError(
            "window of the scan",
            f"{_cells(body)} on a surface of {_cells(heights)}",
            "a window as wide as the surface and not longer",
            "Choose a smaller window or provide a larger map.",
        )
    if approaches.size == 0 or not np.isfinite(approaches).all() or np.any(np.diff(approaches) <= 0):
        raise InputError("approaches of the scan", approaches.tolist(), "finite, increasing lengths in m")
    if stride < 1:
        raise InputError("stride of the scan", stride, "a whole number ≥ 1")


def _cells(field: NDArray) -> str:
    return f"{field.shape[0]} × {field.shape[1]} cells"


def _solve_block(
    half_space: HalfSpace,
    rows: NDArray,
    body: NDArray,
    approaches: NDArray,
    planes: NDArray,
    stride: int,
    rtol: float,
) -> NDArray[np.float64]:
    """Forces, iterations, unconverged and truncated of each approach and position, (4, k, positions)."""
    nx = body.shape[0]
    result = np.zeros((4, len(approaches), len(planes)))
    previous: list[NDArray | None] = [None] * len(approaches)
    for m, plane in enumerate(planes):
        gap = body + plane - rows[m * stride : m * stride + nx]
        touch = gap.min()
        below: NDArray | None = None
        for i, approach in enumerate(approaches):
            if approach <= touch:
                previous[i] = None
                continue
            start = previous[i]
            if start is None:
                start = below
            elif stride < nx:  # the surface moved against the body: so did the pressure on its asperities
                start = np.vstack([start[stride:], np.zeros((stride, start.shape[1]))])
            contact = half_space.at_approach(gap, float(approach), start, rtol)
            previous[i] = below = contact.pressure
            result[:, i, m] = (
                contact.force,
                contact.iterations,
                not contact.converged,
                contact.edge_share > TRUNCATED,
            )
    return result


def _in_threads(
    task: Callable[[int], NDArray],
    firsts: Iterable[int],
    total: int,
    workers: int | None,
    progress: Callable[[int, int, str], None] | None,
    message: str,
) -> list[NDArray]:
    """Run independent blocks on threads (transforms and kernels release the interpreter)."""
    report = progress or (lambda done, total, message: None)
    report(0, total, message)
    done = 0
    executor = ThreadPoolExecutor(workers or thread_count())
    try:
        futures = [executor.submit(task, first) for first in firsts]
        pending: set[Future[NDArray]] = set(futures)
        while pending:
            finished, pending = wait(pending, return_when=FIRST_COMPLETED)
            done += sum(future.result().shape[2] for future in finished)
            report(done, total, message)
        return [future.result() for future in futures]
    finally:
        # on an interrupt: blocks that run are finished and kept, the others are not begun
        executor.shutdown(wait=True, cancel_futures=True)


def warn_of_scans(scans: Sequence[ScannedForces], what: str) -> None:
    """Warn, once for all of them, of solutions that did not converge or were cut off.

    Parameters
    ----------
    scans : sequence of ScannedForces
        Scans.
    what : str
        What they were made for, as ``"the scan"``.
    """
    solved = sum(int(np.count_nonzero(s.forces)) for s in scans)
    warn_of_flaws(solved, sum(s.unconverged for s in scans), sum(s.truncated for s in scans), what)


def warn_of_flaws(solved: int, unconverged: int, truncated: int, what: str) -> None:
    """Warn of contact solutions that did not converge or were cut off.

    Parameters
    ----------
    solved, unconverged, truncated : int
        Number of solutions in contact, and of those that missed the tolerance or reached the edge.
    what : str
        What they were made for.
    """
    if unconverged:
        warnings.warn(
            f"{unconverged} of {solved} contact solutions of {what} missed their tolerance; their "
            "forces are approximate. Try a larger `rtol`, and check the surface for outliers.",
            UnconvergedWarning,
            stacklevel=4,
        )
    if truncated:
        warnings.warn(
            f"in {truncated} of {solved} contact solutions of {what} more than {100 * TRUNCATED:.0f} % of "
            "the force acts on the window's edge: the contact is cut off and its force too small. Enlarge "
            "the window.",
            TruncatedContactWarning,
            stacklevel=4,
        )


def first_touch(
    heights: NDArray[np.float64], body: NDArray[np.float64], stride: int = 1
) -> NDArray[np.float64]:
    """Find the approach at which the body first touches the surface, at each position.

    Parameters
    ----------
    heights : ndarray, shape (n, ny)
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
    nx = body.shape[0]
    starts = range(0, heights.shape[0] - nx + 1, stride)
    return np.array([float((body - heights[m : m + nx]).min()) for m in starts])
