"""From the definition of a study to its table: what is kept is taken, the rest is computed."""

from __future__ import annotations

import os
from collections.abc import Callable, Mapping, Sequence
from concurrent.futures import Executor
from contextlib import closing
from typing import TYPE_CHECKING, Any

from asperity.arguments import shown, whole
from asperity.config.case import Case
from asperity.errors import ComputationError, InputError
from asperity.kinds.cases import kind_of
from asperity.progress import shown_progress
from asperity.studies.definition import Member, Study, load_study, study_of
from asperity.studies.executors import locally, through
from asperity.studies.member import Failure

if TYPE_CHECKING:
    import xarray

    from asperity.progress import Progress
    from asperity.studies.executors import Outcomes


def study(
    definition: str | os.PathLike[str] | Mapping[str, Any] | Study | Case,
    sweep: Mapping[str, Any] | None = None,
    *,
    executor: Executor | None = None,
    workers: int | None = None,
    progress: Progress | None = None,
) -> xarray.Dataset:
    """Compute a case for every combination of the values of some keys.

    Parameters
    ----------
    definition : path, Study, or with `sweep` a mapping or a case object
        A study file; with `sweep`, a case as `asperity.run` takes it.
    sweep : mapping of str to list, optional
        Keys with lists of values as they stand in TOML, as ``{"contact.spacing": ["4 um", "8 um"]}``, or with
        a range, as ``{"speed": "80..300 km/h, 6 steps"}``: six values, both ends among them.
    executor : concurrent.futures.Executor, optional
        Where the members are computed: for instance the executor of a Dask client. By default processes of
        this machine; a script then needs ``if __name__ == "__main__":`` around the call.
    workers : int, optional
        Number of these processes; one per processor by default.
    progress : callable, optional
        ``progress(done, total, message)``, called whenever a member has ended.

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
    plan = _planned(definition, sweep)
    if workers is not None:
        workers = whole("workers", workers, "a whole number greater than 0, or None", at_least=1)
    from asperity.studies.table import tabulated

    members = plan.members()

    def compute(waiting: Sequence[Member]) -> Outcomes:
        if executor is not None:
            return through(executor, waiting)
        if waiting and waiting[0].case is not None:  # once here, and not in every process
            kind_of(waiting[0].case).compile_kernels(told)
        return locally(waiting, workers)

    with shown_progress(progress) as told:
        results, failures = _outcomes(members, compute, told)
    if not results:
        first = next(iter(failures.values()))
        what = f"all {len(members)} members failed, the first one so: {first.message.rstrip('.')}"
        raise ComputationError(what, "one of them with 'asperity run'")
    return tabulated(plan, members, results, failures)


def _planned(
    definition: str | os.PathLike[str] | Mapping[str, Any] | Study | Case, sweep: Mapping[str, Any] | None
) -> Study:
    if isinstance(definition, Study):
        if sweep is not None:
            raise InputError(
                "sweep", "keys for a study that has its own", "a case with keys, or a study alone"
            )
        return definition
    if sweep is not None:
        return study_of(definition, sweep)
    if isinstance(definition, str | os.PathLike):
        return load_study(definition)
    if isinstance(definition, Case | Mapping):
        raise InputError("sweep", "nothing", "keys of the case, each with a list of values")
    allowed = "the path of a study file, or with keys to sweep a case"
    raise InputError("definition of the study", shown(definition), allowed)


def _outcomes(
    members: Sequence[Member],
    compute: Callable[[Sequence[Member]], Outcomes],
    report: Progress,
) -> tuple[dict[tuple[int, ...], xarray.Dataset], dict[tuple[int, ...], Failure]]:
    """Results and failures of all members by their places; every result is kept as soon as it is there."""
    from asperity.store import Store
    from asperity.studies.kept import unpacked

    store = Store()
    results: dict[tuple[int, ...], xarray.Dataset] = {}
    failures: dict[tuple[int, ...], Failure] = {}
    waiting: list[Member] = []
    for member in members:
        if member.error is not None:
            failures[member.index] = Failure("CaseError", "; ".join(member.error.errors))
        elif (found := store.get(member.key)) is not None:
            results[member.index] = unpacked(found)
        else:
            waiting.append(member)
    what = f"study of {len(members)} members"
    report(len(results) + len(failures), len(members), what)
    with closing(compute(waiting)) as outcomes:
        for member, outcome in outcomes:
            if isinstance(outcome, Failure):
                failures[member.index] = outcome
            else:
                if not store.path(member.key).exists():  # computed where this store is not
                    store.put(member.key, outcome)
                results[member.index] = unpacked(outcome)
            report(len(results) + len(failures), len(members), what)
    return results, failures
