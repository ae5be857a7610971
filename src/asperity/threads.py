"""Threads: how many one computation takes, so that several beside each other do not take too many."""

import os
import threading
from collections import deque
from collections.abc import Callable, Generator, Iterable, Iterator
from concurrent.futures import Future, ThreadPoolExecutor
from contextlib import contextmanager
from functools import cache
from itertools import islice
from typing import Any, TypeVar

from asperity.errors import InputError

T = TypeVar("T")
R = TypeVar("R")

THREADS = "ASPERITY_THREADS"
AHEAD = 2
"""Tasks begun for each worker before the first result is taken: no worker waits, and no results pile up."""
_here = threading.local()  # in a thread of `in_order`: whether its task is to stop


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


def refuse_to_go_on() -> None:
    """Interrupt a long task of `in_order` between two pieces of its work, if nobody waits for it any more."""
    stopped: threading.Event | None = getattr(_here, "stopped", None)
    if stopped is not None and stopped.is_set():
        raise KeyboardInterrupt


@contextmanager
def one_thread_in_linear_algebra() -> Iterator[None]:
    """Keep BLAS and LAPACK to one thread, because the number of their threads changes the last digits."""
    with _libraries().limit(limits=1, user_api="blas"):
        yield


@cache
def _libraries() -> Any:
    """Libraries with threads that numpy and scipy have: to find them takes milliseconds."""
    import scipy.linalg  # noqa: F401  brings a library of its own, which must be there to be limited
    from threadpoolctl import ThreadpoolController

    return ThreadpoolController()


def in_order(task: Callable[[T], R], items: Iterable[T], workers: int | None = None) -> Generator[R]:
    """Run a task on each item, on threads, and yield the results in the order of the items.

    The task is independent of the other items; compiled kernels in it release the interpreter. Items are
    taken one by one. There are `thread_count` threads by default; one worker is the caller's own thread.
    However many items there are, few results are held. If the consumer stops, as by an interrupt, the tasks
    that run are asked to stop, see `refuse_to_go_on`, and the others are not begun.
    """
    with begun_in_order(task, items, workers) as results:
        yield from results


@contextmanager
def begun_in_order(
    task: Callable[[T], R], items: Iterable[T], workers: int | None = None
) -> Iterator[Iterator[R]]:
    """The results of `in_order`, whose tasks run while the caller does other work in a ``with`` statement.

    One worker, the caller's own thread, begins when they are taken.
    """
    count = workers or thread_count()
    if count == 1:
        yield map(task, items)
        return
    stopped = threading.Event()
    executor = ThreadPoolExecutor(count, initializer=setattr, initargs=(_here, "stopped", stopped))
    begun = (executor.submit(task, item) for item in items)
    try:
        pending = deque(islice(begun, AHEAD * count))
        yield _taken(pending, begun)
    finally:
        stopped.set()
        executor.shutdown(wait=True, cancel_futures=True)


def _taken(pending: deque[Future[R]], begun: Iterator[Future[R]]) -> Generator[R]:
    """Results of tasks that are begun, in their order; with each that is taken another task is begun."""
    while pending:
        result = pending.popleft().result()
        pending.extend(islice(begun, 1))
        yield result
        del result
