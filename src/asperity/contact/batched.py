"""Scans in batches on a GPU: the device, its memory, and the contacts that share it."""

import os
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from asperity.arguments import Array, NDArray, require, shown
from asperity.contact.elastic_grid import ElasticGrid
from asperity.contact.solved import edge_share
from asperity.errors import ComputationError, InputError
from asperity.kernels import batched
from asperity.kernels.edges import GIVEN
from asperity.kernels.scanning import TRUNCATED, Block

DEVICES = ("cpu", "gpu")
"""What `device` may be."""
CHOSEN = "ASPERITY_DEVICE"
"""The environment's choice, which the processes of a study inherit."""
UNTRIED = "written, not yet run on a device"
"""What is so of the device ``"gpu"``: only the arithmetic of its batches was tried, on the processor."""


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
    except Exception as error:  # whatever driver, runtime, compiler and loader raise
        reason = (str(error).strip() or type(error).__name__).splitlines()[0]
        remedy = "Check the driver with nvidia-smi and the CUDA libraries, or compute on the device cpu."
        raise InputError('device "gpu"', f"no usable CUDA device ({reason})", allowed, remedy) from None
    pool = cupy.get_default_memory_pool()

    def free_memory() -> int:
        return int(cupy.cuda.runtime.memGetInfo()[0]) + int(pool.free_bytes())

    def release() -> None:
        cupy.fft.config.get_plan_cache().clear()  # each plan holds a work area
        pool.free_all_blocks()

    exhausted = (cupy.cuda.memory.OutOfMemoryError, cupy.cuda.cufft.CuFFTError)
    words = f"{name} ({count} found), CuPy {cupy.__version__}"
    return Device(words, cupy, free_memory, cupy.asnumpy, release, exhausted)


def find_device(name: str | None = None) -> Device | None:
    """Find the device for batches; None for ``"cpu"``, where contacts are solved one by one.

    The name is ``"cpu"`` or ``"gpu"``; by default what ``$ASPERITY_DEVICE`` says, else ``"cpu"``. What is
    ``"gpu"`` was written and tried on the processor, not yet run on a device.
    """
    what = "device" if name is not None else f"${CHOSEN}"
    name = (os.environ.get(CHOSEN) or "cpu") if name is None else name
    known = isinstance(name, str) and name in DEVICES
    require(known, what, shown(name), " or ".join(map(repr, DEVICES)))
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
PADDED = 4
"""Points of a transform, in cells: twice as many along and across."""
FIELDS = 17 + 8 * PADDED
"""Numbers a cell at once: gap, pressure, some fifteen fields; padded fields, spectra and work areas."""
SMALLEST_BOX = 8
"""Cells along a box, at least: smaller transforms take no less time."""


def solve_batched(half_space: ElasticGrid, block: Block, device: Device) -> None:
    """Solve the contacts of a block at their approaches, each from the pressure at the approach before.

    As many are solved at once as fit into the device's memory, fewer if that runs out all the same; a
    `ComputationError` comes if a single contact does not fit.
    """
    remedy = "Take whole cells, or compute on the device cpu."
    require(
        half_space.cells == "whole", "cells of a scan on a device", repr(half_space.cells), "'whole'", remedy
    )
    cells = half_space.shape[0] * half_space.shape[1]
    count = len(block.planes)
    first = 0
    size = min(int(MEMORY_SHARE * device.free_memory()) // (8 * FIELDS), LARGEST_TRANSFORM // PADDED) // cells
    size = min(count, max(1, size))
    while first < count:
        last = min(first + size, count)
        try:
            found = _solved(half_space, block, slice(first, last), device)
        except device.exhausted as error:
            if size == 1:
                raise ComputationError(
                    f"one contact of {8 * FIELDS * cells / 2**20:.0f} MiB on {device.name} ran out of memory",
                    "a smaller window, a coarser grid or the device cpu",
                ) from error
        else:
            block.totals[:, first:last], counts = found
            block.counts[:] += counts
            first = last
            continue
        # outside of the handler, whose traceback keeps the arrays of the failed batch
        device.release()
        size = (size + 1) // 2


def _solved(half_space: ElasticGrid, b: Block, positions: slice, device: Device) -> tuple[Array, Any]:
    """Solve contacts on boxes as large as the largest overlap; return totals and counts as of a block.

    Nothing outside of an overlap can carry pressure, so that no solution depends on the size of the box.
    """
    xp = device.xp
    influence = half_space.influence
    rows = xp.arange(positions.start, positions.stop)[:, None] * b.stride + xp.arange(len(b.body))
    gap = xp.asarray(b.body) + xp.asarray(b.planes[positions])[:, None, None] - xp.asarray(b.rows)[rows]
    pressure = xp.zeros_like(gap)
    taps = tuple(influence.taps.tolist())
    edges = b.room.edges
    fields = edges[:GIVEN] if len(edges.softness) else ()
    at_edges = [xp.asarray(each)[rows] for each in fields]
    softest = influence.softest + float((edges.softness + edges.yielding).max(initial=0.0))
    totals = []
    counts = np.zeros(4, dtype=np.int64)
    for approach in b.approaches.tolist():
        overlapping = gap < approach
        along, across = (_cells(overlapping.any(axis=axis), xp) for axis in (2, 1))
        box = (xp.arange(len(gap))[:, None, None], along[:, :, None], across[:, None, :])
        overlap = approach - gap[box]
        p = pressure[box]
        spectrum = xp.asarray(batched.padded_spectrum(influence.table, *p.shape[1:]))
        task = batched.BatchTask(spectrum, taps, b.hardness, softest, b.max_iterations)
        fresh = ~p.any(axis=(1, 2))
        if bool(fresh.any()):
            p = xp.where(fresh[:, None, None], batched.first_guess(overlap, task, xp), p)
        tolerance = b.rtol * xp.maximum(overlap.max(axis=(1, 2)), 0.0)
        soft = tuple(each[box] for each in at_edges)
        iterations, worst = batched.solve_batch(overlap, p, tolerance, task, xp, soft)
        pressure[box] = p
        total = p.sum(axis=(1, 2))
        missed = worst > tolerance
        cut_off = edge_share(pressure) > TRUNCATED
        totals.append(device.to_host(total))
        counts += [int(each.sum()) for each in (total > 0.0, iterations, missed, cut_off)]
    return np.array(totals), counts


def _cells(reached: DeviceArray, xp: Any) -> DeviceArray:
    """Cells (b, size) along a side of the window: from the first reached (b, n) on, as many as any takes."""
    n = reached.shape[1]
    first = reached.argmax(axis=1)
    end = n - reached[:, ::-1].argmax(axis=1)
    longest = int(xp.where(reached.any(axis=1), end - first, 0).max())
    size = min(n, max(longest, SMALLEST_BOX))
    return xp.minimum(first, n - size)[:, None] + xp.arange(size)
