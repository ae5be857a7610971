"""What commands say to programs: one JSON document on standard output, whatever happens.

``docs/json.md`` describes it; `FORMAT` is raised where a name or meaning in it changes or goes.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from asperity import __version__
from asperity.errors import AsperityError, CaseError, ComputationError, InputError
from asperity.terminal import say_document

FORMAT = 1


def say_outcome(command: str, content: Mapping[str, Any]) -> None:
    """Print the document of a command that has done its work."""
    say_document({**_head(command, 0), **content})


def say_failure(command: str, code: int, message: str, error: BaseException | None = None) -> None:
    """Print the document of a command that has failed."""
    say_document({**_head(command, code), "error": {"message": message, **_parts(error)}})


def _head(command: str, code: int) -> dict[str, Any]:
    return {"format": FORMAT, "asperity": __version__, "command": command, "exit_code": code}


def _parts(error: BaseException | None) -> dict[str, Any]:
    """What an error says in parts: what is wrong, what was received, what is allowed, what to do."""
    kind = "UsageError" if error is None else type(error).__name__
    parts: dict[str, Any] = {"kind": kind if isinstance(error, AsperityError | None) else "ProgramError"}
    if isinstance(error, CaseError):
        parts["errors"] = error.errors
    elif isinstance(error, InputError):
        parts |= {
            "what": error.what,
            "received": str(error.received),
            "allowed": error.allowed,
            "remedy": error.remedy,
        }
    elif isinstance(error, ComputationError):
        parts |= {"what": error.what, "remedy": error.remedy}
    return parts
