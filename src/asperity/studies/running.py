"""From the definition of a study to its table: members computed by processes, a cluster, or any executor."""

import multiprocessing
import os
import signal
import threading
import time
import warnings
from collections.abc import Callable, Generator, Iterator, Mapping, Sequence
from concurrent import futures
from concurrent.futures.process import BrokenProcessPool
from contextlib import closing, contextmanager, nullcontext, suppress
from multiprocessing.connection import Connection
from typing import TYPE_CHECKING, Any

from asperity.arguments import FilePath, require, shown, whole
from asperity.case.any_case import AnyCase
from asperity.errors import ComputationError, InputError
from asperity.garbage import seek_seldom
from asperity.interrupts import no_interrupt_for_children
from asperity.laws import comes_with_the_program
from asperity.progress import Progress, shown_progress
from asperity.studies.cluster import Heart
from asperity.studies.definition import Member, Study, load_study, study_of
from asperity.studies.member import Failure, compute_member
from asperity.threads import THREADS, processors
from asperity.written_numbers import count_of

if TYPE_CHECKING:
    import xarray

    from asperity.studies.signals import SignalSet

Outcome = dict[str, Any] | Failure
Outcomes = Generator[tuple[Member, Outcome], None, None]

BEAT = 5.0
"""How often an executor is asked whether it lives, s."""


def through(executor: futures.Executor, members: Sequence[Member]) -> Outcomes:
    """Compute members through any executor; yield each once, as they end, as `compute_member` returned it.

    A cluster gives members whose worker is lost to another one itself; elsewhere they fail.
    """
    heart = Heart(executor, len(members))
    given = dict[futures.Future[Outcome], Member]()
    starts = isinstance(executor, futures.ProcessPoolExecutor)  # a process, where members are submitted
    try:
        for member in members:
            assert member.case is not None
            with no_interrupt_for_children() if starts else nullcontext():
                given[executor.submit(compute_member, member.key, member.case)] = member
        waiting = set(given)
        while waiting:
            done, waiting = futures.wait(waiting, BEAT, futures.FIRST_COMPLETED)
            if not done:
                heart.listen()
            for future in done:
                try:
                    outcome = future.result()
                except Exception as error:
                    while not heart.listen():  # a scheduler that is gone has lost them all
                        time.sleep(BEAT)
                    outcome = Failure.of(error)
                else:
                    heart.finished += 1
                yield given.pop(future), outcome
    except RuntimeError as error:  # broken, or shut down
        what = f"the executor takes no more members ({error})"
        raise ComputationError(what, "the same study again: it goes on where it was") from error
    finally:
        for future in given:
            future.cancel()


def _in_this_process(members: Sequence[Member]) -> Outcomes:
    """Compute members one by one where their laws are registered."""
    with futures.ThreadPoolExecutor(1) as here:
        yield from through(here, members)


def locally(members: Sequence[Member], workers: int | None = None) -> Outcomes:
    """Compute members in processes of this machine; yield each once, in the order in which they end.

    One process per processor by default. A member that ends its process, as one that needs too much memory
    does, fails alone: those that were computed beside it are computed again.
    """
    waiting = list(members)
    while waiting:
        count = min(workers or processors(), len(waiting))
        lost = yield from _in_processes(waiting, count)
        suspects = lost[:count]
        waiting = lost[count:]  # they are begun in their order
        for member in suspects:
            if (yield from _in_processes([member], 1)):
                message = "The process ended without a word. Try: fewer workers; memory may be too small."
                yield member, Failure("ProcessEnded", message)


def _in_processes(
    members: Sequence[Member], workers: int
) -> Generator[tuple[Member, Outcome], None, list[Member]]:
    """Compute members until all are, or a process ends; return those that are not, in their order."""
    missing = dict.fromkeys(members)
    with _pool(workers) as pool, suppress(ComputationError):  # broken before all were submitted
        for member, outcome in through(pool, members):
            if not (isinstance(outcome, Failure) and outcome.error == BrokenProcessPool.__name__):
                del missing[member]
                yield member, outcome
    return list(missing)


@contextmanager
def _pool(workers: int) -> Iterator[futures.ProcessPoolExecutor]:
    """Processes that end with this one, however it ends."""
    context = multiprocessing.get_context("spawn")  # forked processes may hang in compiled threads
    watched, held = context.Pipe(duplex=False)
    with no_interrupt_for_children():  # one that keeps track of shared memory
        pool = futures.ProcessPoolExecutor(
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
    seek_seldom()
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


def study(
    definition: FilePath | Mapping[str, Any] | Study | AnyCase,
    sweep: Mapping[str, Any] | None = None,
    *,
    draw: Mapping[str, Any] | None = None,
    executor: futures.Executor | None = None,
    workers: int | None = None,
    progress: Progress | None = None,
    signals: "FilePath | SignalSet | None" = None,
) -> "xarray.Dataset":
    """Compute a case for every combination of the values of some keys.

    Parameters
    ----------
    definition : path, Study, or with `sweep` a mapping or a case object
        A study file; with `sweep`, a case as `asperity.run` takes it.
    sweep : mapping of str to list, optional
        Keys with lists of values as they stand in TOML, as ``{"contact.spacing": ["4 um", "8 um"]}``, or with
        a range, as ``{"speed": "80..300 km/h, 6 steps"}``: six values, both ends among them.
    draw : mapping of str, optional
        With `sweep`, keys of which each member gets a value by chance: between ends, as ``{"radial": "50..500
        N"}``, or one of a list. See `asperity.studies.definition.study_of`.
    executor : concurrent.futures.Executor, optional
        Where the members are computed: for instance the executor of a Dask client. By default processes of
        this machine; a script then needs ``if __name__ == "__main__":`` around the call. Laws registered from
        Python are rolled in this process.
    workers : int, optional
        Number of these processes; one per processor by default.
    progress : callable, optional
        ``progress(done, total, message)``, called whenever a member has ended.
    signals : path or SignalSet, optional
        Folder into which the acceleration of each ball bearing is written with its labels; a
        `asperity.studies.signals.SignalSet` says in which format, behind which path, with which noise.

    Returns
    -------
    xarray.Dataset
        The swept keys are the first dimensions of every variable. `completed` tells which members have
        results. By law: `mean_force`, `rms_force`, `contact_loss_share`, `contact_loss_events`,
        `longest_loss`; by law and band: `force_level`, `force_level_difference_to_linear_filtered`,
        `force_level_difference_to_linear`, `force_level_difference_to_reference`, and of what its
        kind computes `acceleration_level`, `point_velocity_level` or `sound_power_level`; by band:
        `band_time_product`, below 10, and `start_share`, above 0.2, where a level says little. NaN where a
        member failed or has no such value. The attributes ``failures`` and ``warnings`` are JSON lists of
        what members met, grouped.

    Raises
    ------
    InputError
        If keys or values are wrong, or no member is a valid case.
    ComputationError
        If all members fail, or the executor takes no more of them.

    Notes
    -----
    Results of members are kept in the store by all that they depend on: the same study again goes on
    where it was, and computes failed members again. Their digits do not depend on the executor or on the
    number of workers.

    Examples
    --------
    >>> import asperity
    >>> from concurrent.futures import ThreadPoolExecutor
    >>> with ThreadPoolExecutor(1) as here:  # by default processes of this machine
    ...     table = asperity.study(case, {"speed": [1.0, "2 m/s"]}, executor=here)
    >>> table["rms_force"].dims, table["speed"].values.tolist()
    (('speed', 'law'), [1.0, 2.0])
    """
    plan = _planned(definition, sweep, draw)
    if workers is not None:
        workers = whole("workers", workers, "a whole number greater than 0, or None", at_least=1)
    from asperity.scenarios.compiling import compile_kernels
    from asperity.studies.table import tabulated

    members = plan.members()
    if signals is not None:
        from asperity.studies.signals import SignalSet

        signals = SignalSet.of(signals, members)

    def compute(waiting: Sequence[Member]) -> Outcomes:
        if executor is not None:
            return through(executor, waiting)
        laws = {law for member in waiting if member.case is not None for law in member.case.laws}
        if not all(map(comes_with_the_program, laws)):
            return _in_this_process(waiting)
        if waiting and (case := waiting[0].case) is not None:  # once here, and not in every process
            compile_kernels(told, *case.cells_at_rims)
        return locally(waiting, workers)

    with shown_progress(progress) as told:
        results, failures = _outcomes(members, compute, told, signals)
    if not results:
        computed = (failures[member.index] for member in members if member.case is not None)
        first = next(computed, next(iter(failures.values())))  # what has no case is left out, and no failure
        all_of_them = "the only member" if len(members) == 1 else f"all {len(members)} members"
        what = f"{all_of_them} failed, the first one so: {first.message.rstrip('.')}"
        raise ComputationError(what, "one of them with 'asperity run'")
    return tabulated(plan, members, results, failures)


def _planned(
    definition: FilePath | Mapping[str, Any] | Study | AnyCase,
    sweep: Mapping[str, Any] | None,
    draw: Mapping[str, Any] | None,
) -> Study:
    require(draw is None or sweep is not None, "draw", "keys without sweep", "keys beside those of sweep")
    if isinstance(definition, Study):
        allowed = "a case with keys, or a study alone"
        require(sweep is None, "sweep", "keys for a study that has its own", allowed)
        return definition
    if sweep is not None:
        return study_of(definition, sweep, draw)
    if isinstance(definition, str | os.PathLike):
        return load_study(definition)
    a_case = isinstance(definition, AnyCase | Mapping)
    require(not a_case, "sweep", "nothing", "keys of the case, each with a list of values")
    allowed = "the path of a study file, or with keys to sweep a case"
    raise InputError("definition of the study", shown(definition), allowed)


def _outcomes(
    members: Sequence[Member],
    compute: Callable[[Sequence[Member]], Outcomes],
    report: Progress,
    signals: "SignalSet | None",
) -> "tuple[dict[tuple[int, ...], xarray.Dataset], dict[tuple[int, ...], Failure]]":
    """Results and failures of all members by their places; every result is kept as soon as it is there.

    So is its signal, in a file, where they are asked for.
    """
    from asperity.store import Store
    from asperity.studies.member import SIGNAL, unpacked

    store = Store()
    results: dict[tuple[int, ...], xarray.Dataset] = {}
    failures: dict[tuple[int, ...], Failure] = {}
    waiting: list[Member] = []
    labels: dict[tuple[int, ...], dict[str, Any]] = {}

    def take(member: Member, found: dict[str, Any]) -> None:
        table = unpacked(found)
        if signals is not None:
            labels[member.index] = signals.write(member, table)
        results[member.index] = table.drop_vars(SIGNAL, errors="ignore")

    for member in members:
        if member.error is not None:
            failures[member.index] = Failure("CaseError", "; ".join(member.error.errors))
        elif (found := store.get(member.key)) is not None:
            take(member, found)
        else:
            waiting.append(member)
    what = f"study of {count_of(len(members), 'member')}"
    report(len(results) + len(failures), len(members), what)
    with closing(compute(waiting)) as outcomes:
        for member, outcome in outcomes:
            if isinstance(outcome, Failure):
                failures[member.index] = outcome
            else:
                if not store.path(member.key).exists():  # computed where this store is not
                    store.put(member.key, outcome)
                take(member, outcome)
            report(len(results) + len(failures), len(members), what)
    if signals is not None:
        signals.label(labels)
    return results, failures
