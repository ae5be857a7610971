"""What can go wrong, and what to do about it: errors, physics warnings and solver outcomes."""

from __future__ import annotations

from enum import Enum


class AsperityError(Exception):
    """Base of all errors that a user can meet; ``exit_code`` is what the command line returns."""

    exit_code = 3


class InputError(AsperityError, ValueError):
    """The input is wrong: says what was received, what is allowed and what to do.

    Parameters
    ----------
    what : str
        The quantity, file or key that is wrong, in the user's words.
    received : object
        What was found there.
    allowed : str
        What may stand there.
    remedy : str, optional
        What to do.
    """

    exit_code = 2

    def __init__(self, what: str, received: object, allowed: str, remedy: str = "") -> None:
        self.what, self.received, self.allowed, self.remedy = what, received, allowed, remedy
        message = f"{what}: received {received}; allowed: {allowed}."
        super().__init__(f"{message} {remedy}".strip())


class CaseError(InputError):
    """One or more errors in a case, all reported at once.

    Parameters
    ----------
    source : str
        The case file.
    errors : list of str
        One clear message per error.
    """

    def __init__(self, source: str, errors: list[str]) -> None:
        self.source, self.errors = source, list(errors)
        count = f"{len(errors)} error" + ("s" if len(errors) != 1 else "")
        Exception.__init__(self, "\n".join([f"{source}: {count}", *(f"  - {e}" for e in errors)]))


class ComputationError(AsperityError):
    """A computation failed: says what, where and what to try.

    Parameters
    ----------
    what : str
        What failed, and where (position, step, time).
    remedy : str
        What to try.
    """

    def __init__(self, what: str, remedy: str) -> None:
        self.what, self.remedy = what, remedy
        super().__init__(f"{what}. Try: {remedy}.")


class PhysicsWarning(UserWarning):
    """Base of the warnings that are collected in the report: the result stands on doubtful ground."""


class HalfSpaceWarning(PhysicsWarning):
    """The contact is not small against the bodies, as an elastic half-space needs."""


class TruncatedContactWarning(PhysicsWarning):
    """The contact reaches the edge of the window, so part of it is cut off."""


class CoarseSamplingWarning(PhysicsWarning):
    """A spacing or a time step is too coarse for the wavelengths or frequencies asked for."""


class LargeDeflectionWarning(PhysicsWarning):
    """A beam leaves the small slopes of beam theory."""


class ExtrapolationWarning(PhysicsWarning):
    """A state left the range that was computed; the edge of the range was used beyond it."""


class MissingPointsWarning(PhysicsWarning):
    """A measured surface has points without a height."""


class ShortRecordWarning(PhysicsWarning):
    """A record is short for the wavelengths or statistics taken from it."""


class UnconvergedWarning(PhysicsWarning):
    """An iterative solution stopped before it reached its tolerance."""


class Outcome(Enum):
    """How an iterative computation ended, with advice."""

    CONVERGED = "converged"
    ITERATION_LIMIT = "the iteration limit was reached; try a larger `rtol`, and check the gap for spikes"
    STALLED = "rounding allows no better solution; try a larger `rtol`, and check the gap for spikes"
    NO_CONTACT = "the bodies do not touch at this approach"
    STEPS_UNCONVERGED = "the contact force did not converge in some time steps; try a smaller time step"

    @property
    def ok(self) -> bool:
        """Whether the result can be used as it is."""
        return self in (Outcome.CONVERGED, Outcome.NO_CONTACT)
