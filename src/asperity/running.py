"""Running a case of any kind."""

from __future__ import annotations

import os
import warnings
from collections.abc import Iterable, Mapping
from typing import TYPE_CHECKING, Any

from asperity.arguments import shown
from asperity.errors import ComputationError, InputError

if TYPE_CHECKING:
    import xarray

    from asperity.config.case import Case
    from asperity.progress import Progress
    from asperity.scenarios.preparing import Prepared


def run(
    case: str | os.PathLike[str] | Mapping[str, Any] | Case | Prepared, progress: Progress | None = None
) -> xarray.DataTree:
    """Compute a case.

    Parameters
    ----------
    case : path, mapping or case object
        A TOML case file; its keys and values, sections as mappings; a case object; or what
        `prepare` made of one.
    progress : callable, optional
        ``progress(done, total, message)``, called during long work.

    Returns
    -------
    xarray.DataTree
        Groups scenario, surface, contact, rolling and spectra, and what its kind adds; see
        `asperity.results`.

    Raises
    ------
    InputError
        If the case, or a file it names, is wrong.
    ComputationError
        If a computation fails.
    """
    from asperity.errors import PhysicsWarning
    from asperity.kinds.cases import as_case
    from asperity.scenarios.preparing import Prepared
    from asperity.threads import one_thread_in_linear_algebra

    loaded = case if isinstance(case, Prepared) else as_case(case)
    if progress is not None and not callable(progress):
        raise InputError("progress", shown(progress), "a callable (done, total, message), or None")
    quiet = progress or (lambda done, total, message: None)
    try:
        with warnings.catch_warnings(record=True) as caught, one_thread_in_linear_algebra():
            warnings.simplefilter("always", PhysicsWarning)
            prepared = loaded if isinstance(loaded, Prepared) else prepare(loaded)
            caught += prepared.caught
            result = prepared.kind.computed(prepared, quiet, caught)
    except ComputationError:
        _warn_again(caught)  # they may say why
        raise
    _warn_again(message for message in caught if not issubclass(message.category, PhysicsWarning))
    return result


def _warn_again(caught: Iterable[warnings.WarningMessage]) -> None:
    for message in caught:
        warnings.warn_explicit(message.message, message.category, message.filename, message.lineno)


def open_result(path: str | os.PathLike[str]) -> xarray.DataTree:
    """Open the result of a run again.

    Parameters
    ----------
    path : path
        A ``run.nc``, or the folder that holds one.

    Returns
    -------
    xarray.DataTree
        The result, in memory; the file is closed.

    Raises
    ------
    InputError
        If the file is missing, damaged, too large or not a result of this program.
    """
    from asperity.results import read_result

    return read_result(path)


def prepare(case: Case) -> Prepared:
    """Prepare a case of any kind, see `asperity.scenarios.preparing.prepare`."""
    from asperity.kinds.cases import kind_of
    from asperity.scenarios import preparing

    return preparing.prepare(case, kind_of(case))
