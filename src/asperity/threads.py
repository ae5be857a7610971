"""How many threads one computation takes, so that several beside each other do not take too many."""

from __future__ import annotations

import os
from collections.abc import Iterator
from contextlib import contextmanager

from asperity.errors import InputError

THREADS = "ASPERITY_THREADS"


def processors() -> int:
    """Return the number of processors that this process may use."""
    if hasattr(os, "sched_getaffinity"):
        return len(os.sched_getaffinity(0))
    return os.cpu_count() or 1


def thread_count() -> int:
    """Return the number of threads for one computation: ``$ASPERITY_THREADS``, else one per processor."""
    chosen = os.environ.get(THREADS)
    if not chosen:
        return processors()
    if not chosen.isdecimal() or int(chosen) < 1:
        raise InputError(f"${THREADS}", repr(chosen), "a whole number greater than 0")
    return int(chosen)


@contextmanager
def one_thread_in_linear_algebra() -> Iterator[None]:
    """Keep BLAS and LAPACK to one thread, because the number of their threads changes the last digits."""
    import scipy.linalg  # noqa: F401  brings a library of its own, which must be there to be limited
    from threadpoolctl import threadpool_limits

    with threadpool_limits(limits=1, user_api="blas"):
        yield
