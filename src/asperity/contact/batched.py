"""Scans in batches on a GPU: the array module, and the iteration on it."""

from __future__ import annotations

import os
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from asperity.arguments import Array, shown
from asperity.contact.halfspace import MAX_ITERATIONS, HalfSpace
from asperity.errors import ComputationError, InputError
from asperity.kernels.batched_cg import first_guess, solve_batch
from asperity.kernels.convolution import padded_length, padded_spectrum

DEVICES = ("cpu", "gpu")
"""What `device` may be."""
CHOSEN = "ASPERITY_DEVICE"
"""The environment's choice, which the processes of a study inherit."""


@dataclass(frozen=True, eq=False)
class Device:
    """An array module and what batches need to know of its memory."""

    name: str  # what it is, in words
    xp: Any  # numpy or CuPy
    free_memory: Callable[[], int]  # bytes that a batch may take
    to_host: Callable[[Any], NDArray[Any]]  # array on the device to a numpy array
    release: Callable[[], None]  # gives memory that is kept for reuse back
    exhausted: tuple[type[Exception], ...]  # what an allocation raises when memory has run out


def processor(memory: int = 2**28) -> Device:
    """Make a device of the processor: batches in numpy of so many bytes, for checks of the batched solver."""
    return Device("processor, numpy", np, lambda: memory, np.asarray, lambda: None, (MemoryError,))


def gpu() -> Device:
    """Find the current CUDA device and try it; an `InputError` tells what is missing."""
    allowed = "a CUDA device and CuPy"
    try:
        import cupy
    except ImportError as error:
        remedy = "Install it with pip install 'asperity[gpu]', or compute on the device cpu."
        raise InputError('device "gpu"', f"no CuPy ({error})", allowed, remedy) from None
    try:
        count = cupy.cuda.runtime.getDeviceCount()
        # compiles a kernel and plans a transform: what is missing shows here, not in the middle of a run
        float(cupy.fft.irfft(cupy.fft.rfft(cupy.ones(4)))[0])
        name = cupy.cuda.runtime.getDeviceProperties(cupy.cuda.Device().id)["name"].decode()
    except (
        Exception
    ) as error:  # whatever driver, runtime, compiler and loader raise: there is no usable device
        reason = str(error).strip().splitlines()[0] if str(error).strip() else type(error).__name__
        remedy = "Check the driver with nvidia-smi and the CUDA libraries, or compute on the device cpu."
        raise InputError('device "gpu"', f"no usable CUDA device ({reason})", allowed, remedy) from None
    return _cuda_device(cupy, f"{name} ({count} found), CuPy {cupy.__version__}")


def _cuda_device(cupy: Any, name: str) -> Device:
    pool = cupy.get_default_memory_pool()

    def free_memory() -> int:
        return int(cupy.cuda.runtime.memGetInfo()[0]) + int(pool.free_bytes())

    def release() -> None:
        cupy.fft.config.get_plan_cache().clear()  # each plan holds a work area
        pool.free_all_blocks()

    exhausted = (cupy.cuda.memory.OutOfMemoryError, cupy.cuda.cufft.CuFFTError)
    return Device(name, cupy, free_memory, cupy.asnumpy, release, exhausted)


def find_device(name: str | None = None) -> Device | None:
    """Find the device for batches; None for ``"cpu"``, where contacts are solved one by one.

    The name is ``"cpu"`` or ``"gpu"``; by default what ``$ASPERITY_DEVICE`` says, else ``"cpu"``.
    """
    what = "device" if name is not None else f"${CHOSEN}"
    name = (os.environ.get(CHOSEN) or "cpu") if name is None else name
    if not isinstance(name, str) or name not in DEVICES:
        raise InputError(what, shown(name), " or ".join(map(repr, DEVICES)))
    return gpu() if name == "gpu" else None


def choose_device(name: str) -> None:
    """Choose the device of all scans of this process, and of those that it starts."""
    find_device(name)
    os.environ[CHOSEN] = name


DeviceArray = Any
"""An array on the device."""

MEMORY_SHARE = 0.6
"""Share of the free memory that a batch may take."""
LARGEST_TRANSFORM = 2**30
"""Points of one batch of transforms: the index of a point must fit into 31 bits."""
SMALLEST_BOX = 8
"""Cells along a box, at least: smaller transforms take no less time."""


@dataclass(frozen=True, eq=False)
class SolvedContacts:
    """Contacts by approach and position, all of shape (n_approaches, n_positions)."""

    force: Array  # N; zero without contact
    iterations: NDArray[np.int64]  # of conjugate gradients
    converged: NDArray[np.bool_]  # whether the tolerance was met; true without contact
    edge_share: Array  # share of the force on the window's outermost cells


@dataclass(frozen=True, eq=False)
class _Boxes:
    """Bounding boxes of the overlaps: one size per approach, an origin for each position."""

    sizes: NDArray[np.int64]  # (k, 2)
    origins: NDArray[np.int64]  # (k, n, 2)
    touching: NDArray[np.bool_]  # (k, n)


def solve_batched(
    half_space: HalfSpace,
    gaps: Callable[[int, int], DeviceArray],
    count: int,
    approaches: Array,
    rtol: float,
    device: Device,
) -> SolvedContacts:
    """Solve many contacts at increasing approaches (k,), m, each from the pressure at the approach before.

    ``gaps(first, last)`` gives the gaps at zero approach of these of the `count` positions, on the device, m,
    shape (last − first, nx, ny); `rtol` is as in `HalfSpace.solve`. A `ComputationError` comes if a single
    contact does not fit into the device's memory.

    All positions share the size of the box they are solved on, the largest of them; as nothing outside of
    an overlap can carry pressure, the solution does not depend on it, nor on how many fit into a batch.
    """
    boxes = _bounding_boxes(half_space.shape, gaps, count, approaches, device)
    k = len(approaches)
    found = SolvedContacts(
        np.zeros((k, count)), np.zeros((k, count), np.int64), np.ones((k, count), bool), np.zeros((k, count))
    )

    def solve_some(first: int, last: int) -> None:
        _solve_batch(half_space, gaps(first, last), approaches, boxes, (first, last), rtol, device, found)

    cells, points = half_space.shape[0] * half_space.shape[1], _padded_points(boxes.sizes[-1])
    box_cells = int(boxes.sizes[-1].prod())
    # the window's gap and pressure; some fifteen fields on the box; padded fields, spectra and work areas
    _in_batches(solve_some, count, 8 * (2 * cells + 15 * box_cells + 8 * points), points, device)
    return found


def _padded_points(size: NDArray[np.int64]) -> int:
    return padded_length(int(size[0])) * padded_length(int(size[1]))


def _in_batches(
    task: Callable[[int, int], None], count: int, bytes_each: int, points_each: int, device: Device
) -> None:
    """Do a task for all positions, as many at once as fit; fewer, if memory runs out all the same."""
    size = max(1, int(MEMORY_SHARE * device.free_memory()) // bytes_each)
    size = min(count, size, max(1, LARGEST_TRANSFORM // points_each))
    first = 0
    while first < count:
        last = min(first + size, count)
        try:
            task(first, last)
        except device.exhausted as error:
            if size == 1:
                raise ComputationError(
                    f"one contact of {bytes_each / 2**20:.0f} MiB on {device.name} ran out of memory",
                    "a smaller window, a coarser grid or the device cpu",
                ) from error
        else:
            first = last
            continue
        # outside of the handler, whose traceback keeps the arrays of the failed batch
        device.release()
        size = (size + 1) // 2


def _bounding_boxes(
    shape: tuple[int, int],
    gaps: Callable[[int, int], DeviceArray],
    count: int,
    approaches: Array,
    device: Device,
) -> _Boxes:
    """Bounding boxes of the overlaps of all positions, moved into the window."""
    k = len(approaches)
    low, high = np.zeros((k, count, 2), np.int64), np.zeros((k, count, 2), np.int64)
    touching = np.zeros((k, count), bool)

    def measure(first: int, last: int) -> None:
        gap = gaps(first, last)
        for i, approach in enumerate(approaches):
            overlapping = gap < float(approach)
            for axis in (0, 1):
                reached = overlapping.any(axis=2 - axis)
                low[i, first:last, axis] = device.to_host(reached.argmax(axis=1))
                high[i, first:last, axis] = shape[axis] - device.to_host(reached[:, ::-1].argmax(axis=1))
                touching[i, first:last] = device.to_host(reached.any(axis=1))

    _in_batches(measure, count, 32 * shape[0] * shape[1], shape[0] * shape[1], device)
    extent = np.where(touching[..., None], high - low, 1)
    sizes = np.maximum(extent.max(axis=1), np.minimum(shape, SMALLEST_BOX))
    origins = np.minimum(np.where(touching[..., None], low, 0), np.array(shape) - sizes[:, None])
    return _Boxes(sizes, origins, touching)


def _solve_batch(
    half_space: HalfSpace,
    gap: DeviceArray,
    approaches: Array,
    boxes: _Boxes,
    span: tuple[int, int],
    rtol: float,
    device: Device,
    found: SolvedContacts,
) -> None:
    """Solve positions first … last at all approaches, and write what was found."""
    xp, cap, taps = device.xp, half_space.pressure_cap, tuple(half_space.influence.taps.tolist())
    pressure, softest = xp.zeros_like(gap), half_space.influence.softest
    for i, approach in enumerate(approaches):
        members = np.flatnonzero(boxes.touching[i, span[0] : span[1]])
        if not len(members):
            continue
        nx, ny = (int(n) for n in boxes.sizes[i])
        rows, columns = _box_cells(boxes.origins[i, span[0] + members], nx, ny, xp)
        cells = (xp.asarray(members)[:, None, None], rows, columns)
        overlap = float(approach) - gap[cells]
        largest = overlap.max(axis=(1, 2))
        p = pressure[cells]
        spectrum, my = xp.asarray(padded_spectrum(half_space.influence.table, nx, ny)), padded_length(ny)
        fresh = ~p.any(axis=(1, 2))
        if bool(fresh.any()):
            guess = first_guess(overlap, spectrum, my, cap, xp)
            p = xp.where(fresh[:, None, None], guess, p)
        iterations, worst = solve_batch(
            overlap, spectrum, my, taps, p, cap, softest, rtol * largest, MAX_ITERATIONS, xp
        )
        pressure[cells] = p
        at = span[0] + members
        force = p.sum(axis=(1, 2))
        on_edge = (rows == 0) | (rows == gap.shape[1] - 1) | (columns == 0) | (columns == gap.shape[2] - 1)
        edge = (p * on_edge).sum(axis=(1, 2)) / xp.where(force > 0.0, force, 1.0)
        found.force[i, at] = device.to_host(force) * half_space.cell_area
        found.iterations[i, at] = device.to_host(iterations)
        found.converged[i, at] = device.to_host(worst <= rtol * largest)
        found.edge_share[i, at] = device.to_host(edge)


def _box_cells(origins: NDArray[np.int64], nx: int, ny: int, xp: Any) -> tuple[DeviceArray, DeviceArray]:
    """Rows (b, nx, 1) and columns (b, 1, ny) of the window's cells in each box."""
    corner = xp.asarray(origins)
    rows = corner[:, 0, None, None] + xp.arange(nx)[None, :, None]
    return rows, corner[:, 1, None, None] + xp.arange(ny)[None, None, :]
