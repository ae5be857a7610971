"""One member of a study, as it is computed wherever the executor puts it."""

from __future__ import annotations

import threading
from contextlib import suppress
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from numpy.typing import NDArray

from asperity.errors import TOO_MUCH_MEMORY, AsperityError, ComputationError

if TYPE_CHECKING:
    from asperity.config.case import Case

_one_at_a_time = threading.Lock()
"""Warnings and threads of linear algebra belong to the whole process; a member has it for itself."""


@dataclass(frozen=True)
class Failure:
    """Why a member has no result."""

    error: str  # kind of error
    message: str  # what failed, and what to try

    @classmethod
    def of(cls, error: BaseException) -> Failure:
        """Describe an error."""
        if isinstance(error, MemoryError):
            return cls("MemoryError", f"{TOO_MUCH_MEMORY} Or fewer workers.")
        name = type(error).__name__
        return cls(name, str(error) if isinstance(error, AsperityError) else f"{name}: {error}")


def compute_member(key: str, case: Case) -> dict[str, NDArray[Any]] | Failure:
    """Compute a member, or take what an earlier study has kept of it under its key, `packed`."""
    from asperity.running import run
    from asperity.store import Store
    from asperity.studies.kept import kept, packed

    store = Store()
    with _one_at_a_time:
        found = store.get(key)
        if found is not None:
            return found
        try:
            found = packed(kept(run(case, brief=True)))
        except Exception as error:  # whatever it is, it is the failure of this member alone
            return Failure.of(error)
        with suppress(ComputationError):  # a full disk here loses nothing: the result goes back
            store.put(key, found)
    return found
