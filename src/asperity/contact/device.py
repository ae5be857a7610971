"""Where batches of contacts are solved: on a GPU through CuPy, or on the processor through numpy."""

from __future__ import annotations

import os
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from asperity.arguments import shown
from asperity.errors import InputError

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
