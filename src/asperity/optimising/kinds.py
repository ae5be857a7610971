"""How a kind of case is optimised: what its aim is, and what finds it."""

from collections.abc import Callable
from typing import Any, NamedTuple

from asperity.case.any_case import AnyCase, function_named
from asperity.case.form import Section
from asperity.errors import InputError
from asperity.progress import Progress


class Optimisation(NamedTuple):
    """What may be asked of the texture of a kind of case, what finds it, and what tells of it."""

    aim: type[Section]
    find: Callable[..., Any]  # of the case, the aim and progress
    told_by: str  # function (what was found), by module and name: its tables and its page


def optimisation_of(case: AnyCase) -> Optimisation:
    """How a case is optimised; an `InputError` says that its kind does not have it."""
    if not case.OPTIMISED_BY:
        allowed = "a kind that has it: bodies that roll, or a ball bearing"
        raise InputError("optimisation", f"a {case.kind} case, for which it is not available", allowed)
    found: Optimisation = function_named(case.OPTIMISED_BY)
    return found


def searched(case: AnyCase, aim: Section, progress: Progress) -> Any:
    """What its kind of optimisation finds for a case and an aim."""
    return optimisation_of(case).find(case, aim, progress)
