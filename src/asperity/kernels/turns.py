"""One process at a time compiles a kernel: the others wait for it, and load what it has kept."""

from __future__ import annotations

import hashlib
import os
import time
from collections.abc import Callable
from contextlib import suppress
from functools import cache
from pathlib import Path

try:
    import fcntl
except ImportError:  # Windows: each process compiles for itself
    fcntl = None  # type: ignore[assignment]

FILE = ".turns"
"""File of a folder of kernels; each kernel has a byte of it, which the process locks that compiles it."""
WAITING = 2**31
"""Byte that a process locks which waits while it has a turn: one does, so that no two wait for each other."""
PATIENCE = 60.0
"""Longest time to wait for another process, s; then the kernel is compiled here, too."""
POLL = 0.01
"""Time between looks, s."""


_HAD: set[str] = set()
"""Kernels whose turn this process has."""


def take_turn(folder: Path, kernel: str, meanwhile: Callable[[], None]) -> None:
    """Wait until no other process compiles a kernel; where that may not be waited for, have no turn.

    A process waits for `PATIENCE` at most, and not at all where nothing can be locked, or where it has the
    turn of a kernel that calls this one, while another such process waits. A process that ends, however it
    does, gives its turns back. `meanwhile` is called again and again.
    """
    file, begun = _opened(folder), time.monotonic()
    if file is None:
        return
    try:
        while not _locked(file, _place(kernel)):
            if time.monotonic() - begun > PATIENCE or (_HAD and not _locked(file, WAITING)):
                return
            meanwhile()
            time.sleep(POLL)
    finally:
        _unlock(file, WAITING)
    _HAD.add(kernel)


def end_turn(folder: Path, kernel: str) -> None:
    """Let other processes have it."""
    _HAD.discard(kernel)
    file = _opened(folder)
    if file is not None:
        _unlock(file, _place(kernel))


@cache
def _opened(folder: Path) -> int | None:
    """Descriptor of the file, which stays open: closing any descriptor of it would give all turns back."""
    if fcntl is None:
        return None
    with suppress(OSError):
        return os.open(folder / FILE, os.O_RDWR | os.O_CREAT | os.O_CLOEXEC, 0o600)
    return None


def _locked(file: int, place: int) -> bool:
    try:
        fcntl.lockf(file, fcntl.LOCK_EX | fcntl.LOCK_NB, 1, place)
    except (BlockingIOError, PermissionError):
        return False
    except OSError:  # a file system without locks
        return True
    return True


def _unlock(file: int, place: int) -> None:
    with suppress(OSError):
        fcntl.lockf(file, fcntl.LOCK_UN, 1, place)


def _place(kernel: str) -> int:
    return int.from_bytes(hashlib.sha256(kernel.encode()).digest()[:4]) // 2
