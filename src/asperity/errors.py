"""What can go wrong, and what to do about it: errors, physics warnings, outcomes; and text fit to show."""

import sys
import threading
import unicodedata
import warnings
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from enum import Enum

from asperity.written_numbers import rounded

__all__ = [
    "AsperityError",
    "BandsWarning",
    "CaseError",
    "CoarseSamplingWarning",
    "ComputationError",
    "ContactFilterWarning",
    "EnergyWarning",
    "ExtrapolationWarning",
    "Finding",
    "Grade",
    "HalfSpaceWarning",
    "InhomogeneousWarning",
    "InputError",
    "LargeDeflectionWarning",
    "LossFactorWarning",
    "MeasuredTrackWarning",
    "MissingPointsWarning",
    "MissingSourceWarning",
    "OutOfRangeWarning",
    "Outcome",
    "PhysicsWarning",
    "ShortRecordWarning",
    "TruncatedContactWarning",
    "UnconvergedWarning",
]

LONGEST = 1000
"""Characters of a name or value that a message repeats: more than the paths that people use."""
TOO_MUCH_MEMORY = (
    "the case takes more memory than there is. Are all its lengths, times and files in the units that they "
    "are meant in? If so, try a smaller contact.window, a shorter duration or a coarser contact.spacing."
)
MOST_WORDS = 300
"""Characters of what a library says that a message repeats."""
MOST_ERRORS = 10
"""Errors of a case that are listed: who has more corrects these first."""
_here = threading.local()  # in a thread: whether physics warnings are left unsaid


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
        self.what = what
        self.received = received
        self.allowed = allowed
        self.remedy = remedy
        message = f"{_cut(what)}: received {_cut(received)}; allowed: {allowed}."
        super().__init__(printable(f"{message} {remedy}".strip()))

    def about(self, what: str, received: object = None) -> "InputError":
        """The same error, told of something else; what was received may be told in other words."""
        return InputError(what, self.received if received is None else received, self.allowed, self.remedy)


class CaseError(InputError):
    """One or more errors in a case, reported at once: the first ten, and how many there are.

    Parameters
    ----------
    source : str
        The case file.
    errors : list of str
        One clear message per error.
    """

    def __init__(self, source: str, errors: list[str]) -> None:
        self.source = source
        self.errors = list(errors)
        count = f"{len(errors)} error" + ("s" if len(errors) != 1 else "")
        listed = [f"  - {error}" for error in self.errors[:MOST_ERRORS]]
        if len(self.errors) > MOST_ERRORS:
            listed.append(f"  - and {len(self.errors) - MOST_ERRORS} more")
        Exception.__init__(self, "\n".join([f"{printable(_cut(source))}: {count}", *listed]))


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
        self.what = what
        self.remedy = remedy
        super().__init__(printable(f"{what}. Try: {remedy}."))


def _cut(received: object) -> str:
    """Write what was received, shortened where it is no name or value of a person."""
    text = str(received)
    return text if len(text) <= LONGEST else f"{text[:LONGEST]}…"


def reason(error: BaseException) -> str:
    """Name an error of a library and its words, but no page of raw bytes."""
    words = " ".join("".join(c if c.isprintable() else " " for c in str(error)).split())
    cut = f"{words[:MOST_WORDS]} …" if len(words) > MOST_WORDS else words
    return f"{type(error).__name__} ({cut})" if cut else type(error).__name__


class Grade(Enum):
    """How much a warning on the physics matters."""

    NOTE = "note"
    WARNING = "warning"
    OUT = "out of range"

    @classmethod
    def of_share(cls, share: float) -> "Grade":
        """Grade what befell a share of all contact solutions or time steps: from 1 % and from 10 % on."""
        return cls.OUT if share >= 0.1 else cls.WARNING if share >= 0.01 else cls.NOTE


def percent(share: float) -> str:
    """Write a share for a message, as ``"0.32 %"``."""
    return f"{100 * share:.0f} %" if share >= 0.0995 else f"{rounded(100 * share, 2)} %"


class PhysicsWarning(UserWarning):
    """Base of the warnings that are collected in the report: the result stands on doubtful ground.

    Parameters
    ----------
    message : str
        What was found, its limit, what it means and what to do.
    grade : Grade
        How much it matters.
    """

    def __init__(self, message: str, grade: Grade = Grade.WARNING) -> None:
        self.grade = grade
        super().__init__(message)

    @classmethod
    def warn(cls, message: str, grade: Grade = Grade.WARNING) -> None:
        """Warn, at the place outside this package from which it was called."""
        if getattr(_here, "unsaid", False):
            return
        frame = sys._getframe(1)
        level = 2
        while frame.f_back and frame.f_globals.get("__name__", "").startswith("asperity."):
            frame = frame.f_back
            level = level + 1
        warnings.warn(cls(message, grade), stacklevel=level)

    @classmethod
    def ignored(cls) -> "warnings.catch_warnings[None]":
        """Leave those of this class unsaid within a ``with`` statement."""
        return warnings.catch_warnings(action="ignore", category=cls)

    @staticmethod
    @contextmanager
    def unsaid_here() -> Iterator[None]:
        """Leave all unsaid in this thread alone: what `ignored` and `caught` change, all threads share."""
        _here.unsaid = True
        try:
            yield
        finally:
            _here.unsaid = False

    @classmethod
    def caught(cls) -> "warnings.catch_warnings[list[warnings.WarningMessage]]":
        """Collect those of this class within a ``with`` statement, instead of saying them."""
        return warnings.catch_warnings(record=True, action="always", category=cls)


@dataclass(frozen=True)
class Finding:
    """One quantity of a case, how far it may go, and what to make of it."""

    quantity: str  # what was found, or asked
    value: str  # its number
    limit: str  # where its range ends
    grade: Grade | None  # None where it is inside its range
    meaning: str  # of being outside; of a question the answer
    remedy: str  # what to do
    brief: str = ""  # quantity and number in a few words, for a headline
    laws: tuple[str, ...] = ()  # of the case that it concerns
    warned: bool = False  # whether it has been warned of where it was found
    effect: float | None = None  # on levels, dB, where that is what is judged
    category: type[PhysicsWarning] | None = None  # of its warning; that of what is out of its range

    def concerns(self, law: str) -> bool:
        """Whether it makes a law doubtful."""
        return self.grade in (Grade.WARNING, Grade.OUT) and law in self.laws

    @property
    def message(self) -> str:
        """All of it in one or two sentences."""
        return f"{self.quantity}: {self.number}, in range {self.limit}. {self.meaning} {self.remedy}"

    @property
    def number(self) -> str:
        """Its number, with its effect on levels if that is judged."""
        return self.value if self.effect is None else f"{self.value}: {self.effect:.1f} dB"

    def row(self) -> dict[str, str]:
        """Lay it out for a result file."""
        names = ("quantity", "number", "limit", "meaning", "remedy")
        words = {name.replace("number", "value"): getattr(self, name) for name in names}
        return words | {"grade": "" if self.grade is None else self.grade.value}


def warn_of_findings(findings: Iterable[Finding]) -> None:
    """Warn of what is outside its range and was not warned of where it was found."""
    for finding in findings:
        if finding.grade is not None and not finding.warned:
            (finding.category or OutOfRangeWarning).warn(finding.message, finding.grade)


class HalfSpaceWarning(PhysicsWarning):
    """The contact is not small against the bodies, as an elastic half-space needs."""


class TruncatedContactWarning(PhysicsWarning):
    """The contact reaches the edge of the window, so part of it is cut off."""


class CoarseSamplingWarning(PhysicsWarning):
    """A spacing or a time step is too coarse for the wavelengths or frequencies asked for."""


class LargeDeflectionWarning(PhysicsWarning):
    """A body leaves the small slopes of beam theory."""


class ExtrapolationWarning(PhysicsWarning):
    """A state left the range that was computed; the edge of the range was used beyond it."""


class OutOfRangeWarning(PhysicsWarning):
    """A contact law or the contact itself is used outside the range in which it is known to hold."""


class InhomogeneousWarning(PhysicsWarning):
    """A texture is not the same everywhere, so that samples of it do not stand for all of it."""


class MissingSourceWarning(PhysicsWarning):
    """Something that radiates sound is not described well enough to compute its part."""


class MeasuredTrackWarning(PhysicsWarning):
    """What was measured on a track contradicts the track that was computed."""


class MissingPointsWarning(PhysicsWarning):
    """A measured surface has points without a height."""


class ShortRecordWarning(PhysicsWarning):
    """A record is short for the wavelengths or statistics taken from it."""


class BandsWarning(PhysicsWarning):
    """Something that was measured lies where a case computes nothing."""


class LossFactorWarning(PhysicsWarning):
    """Constant loss factors are not causal; what stands for them in time changes the contact force."""


class ContactFilterWarning(PhysicsWarning):
    """A contact filter is normalised where the texture says little, or applied less exactly than fitted."""


class EnergyWarning(PhysicsWarning):
    """What was given for a passive structure creates energy."""


class UnconvergedWarning(PhysicsWarning):
    """An iterative solution stopped before it reached its tolerance."""


class Outcome(Enum):
    """How an iterative computation ended, with advice."""

    CONVERGED = "converged"
    ITERATION_LIMIT = "the iteration limit was reached; try a larger rtol, and check the gap for spikes"
    STALLED = "rounding allows no better solution; try a larger rtol, and check the gap for spikes"
    NO_CONTACT = "the bodies do not touch at this approach"
    STEPS_UNCONVERGED = (
        "the contact force missed its tolerance in some steps; try a smaller numerics.time_step"
    )

    @property
    def ok(self) -> bool:
        """Whether the result can be used as it is."""
        return self in (Outcome.CONVERGED, Outcome.NO_CONTACT)


_UNSEEN = ("Cc", "Cf", "Cs", "Zl", "Zp")
"""Classes of characters that are not seen but act: controls, directions of writing, half pairs, breaks."""


def printable(text: str, *, lines: bool = False) -> str:
    r"""Spell out the characters of a text by others that would act instead of being seen.

    ``\x1b`` for an escape, ``\u202e`` for a change of direction, ``\xff`` for a byte of a file name that is
    no UTF-8. `lines` says whether line ends and tabs may stay.
    """
    if text.isprintable():
        return text
    acting = {c for c in set(text) - set("\n\t" if lines else "") if unicodedata.category(c) in _UNSEEN}
    return text.translate({ord(character): _spelled(character) for character in acting})


def _spelled(character: str) -> str:
    byte = ord(character) - 0xDC00  # how Python carries bytes that are no UTF-8
    if 0x80 <= byte <= 0xFF:
        return f"\\x{byte:02x}"
    return character.encode("unicode_escape").decode("ascii")
