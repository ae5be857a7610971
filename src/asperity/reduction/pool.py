"""Independent tasks on all processors, their results in order and few of them at a time."""

from __future__ import annotations

from collections import deque
from collections.abc import Callable, Generator, Iterable
from concurrent.futures import Future, ThreadPoolExecutor
from itertools import islice
from typing import TypeVar

from asperity.threads import thread_count

T = TypeVar("T")
R = TypeVar("R")

AHEAD = 2
"""Tasks begun for each worker before the first result is taken: no worker waits, and no results pile up."""


def in_order(task: Callable[[T], R], items: Iterable[T], workers: int | None = None) -> Generator[R]:
    """Run a task on each item, on threads, and yield the results in the order of the items.

    Parameters
    ----------
    task : callable
        Independent of the other items; compiled kernels in it release the interpreter.
    items : iterable
        What it is called with; taken one by one.
    workers : int, optional
        Threads; by default as many as `asperity.threads` says. One worker is the caller's own thread.

    Yields
    ------
    object
        Results. However many items there are, few results are held. If the consumer stops, tasks that run
        are finished and the others are not begun.
    """
    count = workers or thread_count()
    if count == 1:
        yield from map(task, items)
        return
    waiting, pending = iter(items), deque[Future[R]]()
    executor = ThreadPoolExecutor(count)
    try:
        pending.extend(executor.submit(task, item) for item in islice(waiting, AHEAD * count))
        while pending:
            result = pending.popleft().result()
            pending.extend(executor.submit(task, item) for item in islice(waiting, 1))
            yield result
            del result
    finally:
        executor.shutdown(wait=True, cancel_futures=True)
