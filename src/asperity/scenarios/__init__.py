"""From a case to its result: one file per kind of case."""

from __future__ import annotations

import os
import warnings
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

from asperity.arguments import shown
from asperity.errors import InputError

if TYPE_CHECKING:
    import xarray

    from asperity.config import Case
    from asperity.progress import Progress
    from asperity.scenarios.preparing import Prepared


def run(
    case: str | os.PathLike[str] | Mapping[str, Any] | Case | Prepared, progress: Progress | None = None
) -> xarray.DataTree:
    """Compute a case.

    Parameters
    ----------
    case : path, mapping or case object
        A TOML case file; its keys and values, sections as mappings; or what `asperity.config.load_case`, or
        `asperity.scenarios.preparing.prepare`, made of one.
    progress : callable, optional
        ``progress(done, total, message)``, called during long work.

    Returns
    -------
    xarray.DataTree
        Groups scenario, surface, contact, rolling and spectra, and track for a wheel on rail; see
        `asperity.results`.

    Raises
    ------
    InputError
        If the case, or a file it names, is wrong.
    ComputationError
        If a computation fails.
    """
    from asperity.config import as_case
    from asperity.errors import PhysicsWarning
    from asperity.scenarios.preparing import Prepared, prepare
    from asperity.threads import one_thread_in_linear_algebra

    loaded = case if isinstance(case, Prepared) else as_case(case)
    if progress is not None and not callable(progress):
        raise InputError("progress", shown(progress), "a callable (done, total, message), or None")
    with warnings.catch_warnings(record=True) as caught, one_thread_in_linear_algebra():
        warnings.simplefilter("always", PhysicsWarning)
        prepared = loaded if isinstance(loaded, Prepared) else prepare(loaded)
        caught += prepared.caught
        result = _computed(prepared, progress or (lambda done, total, message: None), caught)
    for message in caught:
        if not issubclass(message.category, PhysicsWarning):
            warnings.warn_explicit(message.message, message.category, message.filename, message.lineno)
    return result


def _computed(
    prepared: Prepared, progress: Progress, caught: list[warnings.WarningMessage]
) -> xarray.DataTree:
    from asperity.config import WheelOnRailCase

    if isinstance(prepared.case, WheelOnRailCase):
        from asperity.scenarios import rail_tree, wheel_on_rail

        return rail_tree.layout(wheel_on_rail.compute(prepared, progress), caught)
    from asperity.scenarios import ball_on_beam, beam_tree

    return beam_tree.layout(ball_on_beam.compute(prepared, progress), caught)
