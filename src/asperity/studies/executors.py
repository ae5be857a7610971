"""Where the members of a study are computed: local processes, a cluster, or any executor."""

from __future__ import annotations

import multiprocessing
import os
import signal
import threading
import time
import warnings
from collections import deque
from collections.abc import Collection, Generator, Iterator, Sequence
from concurrent.futures import (
    FIRST_COMPLETED,
    BrokenExecutor,
    Executor,
    Future,
    ProcessPoolExecutor,
    wait,
)
from contextlib import contextmanager
from typing import TYPE_CHECKING, Any

from asperity.errors import ComputationError
from asperity.interrupts import no_interrupt_for_children
from asperity.studies.cluster import Heart
from asperity.studies.member import Failure, compute_member
from asperity.threads import THREADS, processors

if TYPE_CHECKING:
    from multiprocessing.connection import Connection

    from asperity.studies.definition import Member

    Outcome = dict[str, Any] | Failure
    Outcomes = Generator[tuple[Member, Outcome], None, None]

ATTEMPTS = 3
"""How often a member is given to an executor that loses it."""
BEAT = 5.0
"""How often an executor is asked whether it lives, s."""


def through(executor: Executor, members: Sequence[Member]) -> Outcomes:
    """Compute members through any executor; yield each once, as they end, as `compute_member` returned it.

    A member whose worker is lost goes to another one.
    """
    lost: dict[Member, Exception] = dict.fromkeys(members, Exception())
    heart = Heart(executor, len(members))
    for _ in range(ATTEMPTS):
        futures: dict[Future[Outcome], Member] = {}
        try:
            for member in lost:
                futures[_submitted(executor, member)] = member
            lost = {}
            for future in _ended(futures, heart):
                try:
                    outcome = future.result()
                except Exception as error:
                    lost[futures[future]] = error
                    continue
                heart.finished += 1
                yield futures[future], outcome
        except RuntimeError as error:  # broken, or shut down
            what = f"the executor takes no more members ({error})"
            raise ComputationError(what, "the same study again: it goes on where it was") from error
        finally:
            for future in futures:
                future.cancel()
        if not lost:
            return
        while not heart.listen():
            time.sleep(BEAT)
    for member, reason in lost.items():
        yield member, Failure.of(reason)


def _ended(futures: Collection[Future[Outcome]], heart: Heart) -> Iterator[Future[Outcome]]:
    """Yield futures as they end, while there is life in the executor."""
    waiting = set(futures)
    while waiting:
        done, waiting = wait(waiting, BEAT, FIRST_COMPLETED)
        yield from done
        if not done:
            heart.listen()


def _submitted(executor: Executor, member: Member) -> Future[Outcome]:
    assert member.case is not None
    return executor.submit(compute_member, member.key, member.case)


def locally(members: Sequence[Member], workers: int | None = None) -> Outcomes:
    """Compute members in processes of this machine; yield each once, in the order in which they end.

    One process per processor by default. A member that ends its process, as one that needs too much memory
    does, fails alone: those that were computed beside it are computed again.
    """
    waiting = deque(members)
    while waiting:
        suspects: list[Member] = []
        count = min(workers or processors(), len(waiting))
        yield from _until_broken(waiting, count, suspects)
        for member in suspects:
            guilty: list[Member] = []
            yield from _until_broken(deque([member]), 1, guilty)
            if guilty:
                message = "The process ended without a word. Try: fewer workers; memory may be too small."
                yield member, Failure("ProcessEnded", message)


def _until_broken(waiting: deque[Member], workers: int, lost: list[Member]) -> Outcomes:
    """Compute members until none waits, or a process ends: `lost` then holds those under way."""
    with _pool(workers) as pool:
        under_way: dict[Future[Outcome], Member] = {}
        while waiting or under_way:
            try:
                while waiting and len(under_way) < workers:
                    with no_interrupt_for_children():  # a process may start here
                        future = _submitted(pool, waiting[0])
                    under_way[future] = waiting.popleft()
            except BrokenExecutor:
                lost += under_way.values()
                return
            for future in wait(under_way, return_when=FIRST_COMPLETED).done:
                member = under_way.pop(future)
                try:
                    outcome = future.result()
                except BrokenExecutor:
                    lost.append(member)
                    continue
                yield member, outcome
            if lost:
                lost += under_way.values()
                return


@contextmanager
def _pool(workers: int) -> Iterator[ProcessPoolExecutor]:
    """Processes that end with this one, however it ends."""
    context = multiprocessing.get_context("spawn")  # forked processes may hang in compiled threads
    watched, held = context.Pipe(duplex=False)
    with no_interrupt_for_children():  # one that keeps track of shared memory
        pool = ProcessPoolExecutor(
            workers, context, initializer=_begin, initargs=(watched, max(1, processors() // workers))
        )
    try:
        yield pool
        pool.shutdown()
    finally:
        held.close()
        pool.shutdown(cancel_futures=True)


def _begin(watched: Connection, threads: int) -> None:
    """Prepare a process: interrupts are left to the one that started it, and it ends with that one."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    warnings.simplefilter("ignore")  # what a member warns of stands in its result
    os.environ.setdefault(THREADS, str(threads))
    threading.Thread(target=_end_with, args=(watched,), daemon=True).start()


def _end_with(watched: Connection) -> None:
    """End this process when nobody holds the other end of a pipe any more."""
    try:
        watched.poll(None)
    finally:
        os._exit(1)
