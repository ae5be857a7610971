"""Running a case of any kind."""

from __future__ import annotations

import warnings
from collections.abc import Iterable, Mapping
from typing import TYPE_CHECKING, Any, TypeVar

from asperity.arguments import FilePath, shown
from asperity.errors import ComputationError, InputError

if TYPE_CHECKING:
    from xarray import DataTree

    from asperity.case.any_case import AnyCase, ReadyCase
    from asperity.progress import Progress
    from asperity.scenes.report import Result

C = TypeVar("C", bound="AnyCase")


def run(
    case: FilePath | Mapping[str, Any] | AnyCase | ReadyCase,
    progress: Progress | None = None,
    *,
    converge: bool = False,
    brief: bool = False,
) -> Result:
    """Compute a case.

    Parameters
    ----------
    case : path, mapping or case object
        A TOML case file; its keys and values, sections as mappings; a case object; or what
        `prepare_case` made of one.
    progress : callable, optional
        ``progress(done, total, message)``, called during long work. In a notebook a bar is shown by default.
    converge : bool
        Whether the case is computed again with each of its settings made finer in turn: the result then has
        the group convergence, which says how far it depends on them.
    brief : bool
        Whether what only a report shows is left out: statistics and spectra of the path, the expected
        errors of the laws, and what was measured beside it. Everything else has the same digits.

    Returns
    -------
    Result
        An `xarray.DataTree` with the groups scenario, surface, contact, rolling and spectra, and what its
        kind adds. A notebook shows its verdict, its numbers and its force.

    Raises
    ------
    InputError
        If the case, or a file it names, is wrong.
    ComputationError
        If a computation fails.

    Examples
    --------
    >>> import asperity
    >>> result = asperity.run(case)
    >>> result["rolling/contact_force"].dims
    ('law', 'contact', 'time')
    >>> asperity.run(case.with_(speed=2.0)).attrs["seed"]  # a case does not change: with_ makes another one
    1
    """
    from asperity.case.any_case import ReadyCase, function_named
    from asperity.case.cases import as_case
    from asperity.errors import PhysicsWarning
    from asperity.observables.beside_result import with_tables_beside
    from asperity.progress import shown_progress
    from asperity.scenarios.compiling import compiled_ahead
    from asperity.scenes.report import Result
    from asperity.threads import one_thread_in_linear_algebra

    loaded = case if isinstance(case, ReadyCase) else as_case(case)
    if progress is not None and not callable(progress):
        raise InputError("progress", shown(progress), "a callable (done, total, message), or None")
    try:
        with (
            PhysicsWarning.caught() as caught,
            one_thread_in_linear_algebra(),
            shown_progress(progress) as told,
        ):
            with compiled_ahead(loaded.case if isinstance(loaded, ReadyCase) else loaded):
                prepared = loaded if isinstance(loaded, ReadyCase) else prepare_case(loaded)
                caught += prepared.caught
                compute = function_named(prepared.case.COMPUTED_BY)
                result: DataTree = compute(prepared, told, caught, brief=brief)
            if converge:
                from asperity.convergence import with_convergence

                result = with_convergence(prepared, result, told)
            if not brief:
                result = with_tables_beside(prepared.case, result)
    except ComputationError:
        _warn_again(caught)  # they may say why
        raise
    _warn_again(message for message in caught if not issubclass(message.category, PhysicsWarning))
    return Result.of(result)


def _warn_again(caught: Iterable[warnings.WarningMessage]) -> None:
    for message in caught:
        warnings.warn_explicit(message.message, message.category, message.filename, message.lineno)


def open_result(path: FilePath) -> Result:
    """Open the result of a run again.

    Parameters
    ----------
    path : path
        A ``run.nc``, or the folder that holds one.

    Returns
    -------
    Result
        The result as `run` returned it, in memory; the file is closed.

    Raises
    ------
    InputError
        If the file is missing, damaged, too large or not a result of this program.

    Examples
    --------
    >>> import asperity
    >>> result = asperity.run(case)
    >>> path = asperity.save(result, "run.nc")
    >>> asperity.open_result(path).identical(result)
    True
    """
    from asperity.results import read_result
    from asperity.scenes.report import Result

    return Result.of(read_result(path))


def prepare_case(case: AnyCase, source: str = "case") -> ReadyCase:
    """Lay a case of any kind ready to be run or announced; messages call it `source`."""
    from asperity.case.any_case import function_named
    from asperity.observables.reading import tables_beside

    tables_beside(case)  # refuses what it cannot be held against
    prepared: ReadyCase = function_named(case.PREPARED_BY)(case, source)
    return prepared


def with_choices_fixed(case: C, laws: tuple[str, ...]) -> C:
    """A case that is searched about by laws: what is chosen for these stays, whatever is tried."""
    asked = case.with_(laws=laws)
    return case.with_(**prepare_case(asked).chosen) if len(asked.cells_at_rims) > 1 else case
