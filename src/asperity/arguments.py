"""What Python callers may hand over: numbers, arrays and paths, or a message that says what came instead."""

import difflib
import math
import numbers
import os
import stat
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any, NewType, TypeVar

import numpy as np
from numpy.typing import NDArray as NDArray

from asperity.errors import InputError
from asperity.written_numbers import count_of

LONGEST = 60  # characters of a received value that a message repeats
LONGEST_WORD = 100  # characters of a word for which one like it is sought
MOST_NAMES = 10  # of what is in a file, that a message lists
SHAKEDOWN = "shakedown"  # stands for a number of passes: until one changes nothing any more
FORMS = {"plane": 1, "quadratic": 2, "quartic": 4}  # words for polynomials of these degrees
MOST_PASSES = 100  # of running-in

FilePath = str | os.PathLike[str]
"""A path as people name it."""

if TYPE_CHECKING:
    from numpy.typing import ArrayLike as ArrayLike

    Array = NDArray[np.float64]
    Complex = NDArray[np.complex128]
    Flags = NDArray[np.bool_]
    Indices = NDArray[np.intp]
    Integers = NDArray[np.int64]
    Numbers = NDArray[np.inexact]
else:  # names alone: help() would spell out what NumPy makes of them, in a hundred words
    ArrayLike = NewType("ArrayLike", object)
    Array = NewType("Array", np.ndarray)
    Complex = NewType("Complex", np.ndarray)
    Flags = NewType("Flags", np.ndarray)
    Indices = NewType("Indices", np.ndarray)
    Integers = NewType("Integers", np.ndarray)
    Numbers = NewType("Numbers", np.ndarray)


def as_row(values: "ArrayLike") -> "Array":
    """Numbers as an array of one dimension or more."""
    return np.atleast_1d(np.asarray(values, dtype=float))


def given_options(options: Mapping[str, Any]) -> dict[str, Any]:
    """Those options that are given."""
    return {name: value for name, value in options.items() if value is not None}


def require(right: object, what: str, received: object, allowed: str, remedy: str = "") -> None:
    """Raise an `InputError` of what was received, what is allowed and what to do, unless all is right."""
    if not right:
        raise InputError(what, received, allowed, remedy)


def shown(value: object) -> str:
    """Write a received value for a message, shortened to what a person needs to find it again."""
    if isinstance(value, np.ndarray) and value.ndim:
        return f"an array of {value.dtype} of shape {value.shape}"
    text = _written(value)
    return text if len(text) <= LONGEST else text[: LONGEST - 3] + "…"


def _written(value: object) -> str:
    if isinstance(value, str) and value.isprintable():
        return f"'{value}'"  # without the double backslashes of Python
    try:
        return repr(value.item() if isinstance(value, np.generic) else value)
    except ValueError:  # Python does not write out integers of many thousand digits
        return "a huge number"
    except RecursionError:
        return "lists or sections inside one another without end"


def nearest(word: object, words: Sequence[str]) -> str:
    """Sentence that names the nearest of `words`; empty if none is near."""
    if len(str(word)) > LONGEST_WORD:
        return ""
    found = difflib.get_close_matches(str(word).lower(), words, n=1, cutoff=0.6)
    return f'Did you mean "{found[0]}"?' if found else ""


def real(
    what: str,
    value: object,
    allowed: str,
    *,
    above: float = -math.inf,
    at_least: float = -math.inf,
    at_most: float = math.inf,
    below: float = math.inf,
    remedy: str = "",
) -> float:
    """Take one finite real number of Python or numpy; truth values are none.

    `what` and `allowed` are for the message, with `remedy`, what to do: text gets the advice to leave units
    and quotes away. An `InputError` says what is no such number, or beyond the limits.
    """
    number = _number(value)
    if not (math.isfinite(number) and above < number < below and at_least <= number <= at_most):
        if isinstance(value, str):
            remedy = "Python takes numbers in SI, without unit and quotes."
        raise InputError(what, shown(value), allowed, remedy)
    return number


def positive(what: str, value: object) -> float:
    """Take one finite number above zero, as `real` does."""
    return real(what, value, "a finite positive number", above=0.0)


def not_negative(what: str, value: object) -> float:
    """Take one finite number that is not below zero, as `real` does."""
    return real(what, value, "a finite number, zero or more", at_least=0.0)


def whole(what: str, value: object, allowed: str, *, at_least: int, at_most: float = math.inf) -> int:
    """Take one whole number within limits, as `real` does; one such as 8.0 counts as whole."""
    number = real(what, value, allowed, at_least=at_least, at_most=at_most)
    if number != int(number):
        raise InputError(what, shown(value), allowed)
    return int(number)


W = TypeVar("W", bound=str)


def one_of(what: str, value: object, words: Iterable[W], remedy: str = "") -> W:
    """Take one of some words; an `InputError` lists them, and names the nearest."""
    known = list(words)
    if not isinstance(value, str) or value not in known:
        allowed = "one of " + ", ".join(known)
        raise InputError(what, shown(value), allowed, remedy or nearest(value, known))
    return known[known.index(value)]


def passes_of(value: object) -> int | None:
    """Check a number of passes of running-in; None stands for as many as it takes to shakedown."""
    if isinstance(value, str) and value == SHAKEDOWN:
        return None
    allowed = f'a whole number from 1 to {MOST_PASSES}, or "{SHAKEDOWN}"'
    return whole("passes", value, allowed, at_least=1, at_most=MOST_PASSES)


def two(what: str, value: object, allowed: str) -> tuple[Any, Any]:
    """Take two things, whatever they are, from a list, a tuple or an array."""
    several = isinstance(value, list | tuple) or (isinstance(value, np.ndarray) and value.ndim == 1)
    if not several or len(value) != 2:  # type: ignore[arg-type]
        raise InputError(what, shown(value), allowed)
    return value[0], value[1]  # type: ignore[index]


def two_lengths(what: str, value: object) -> tuple[float, float]:
    """Take two lengths (dx, dy), m, finite and above zero; a single one stands for both."""
    allowed = "two positive lengths (dx, dy) in m, or one for both"
    if isinstance(value, str) or math.isfinite(_number(value)):
        value = (value, value)
    dx, dy = (real(what, each, allowed, above=0.0) for each in two(what, value, allowed))
    return dx, dy


SMALL = 4  # bytes of a number at most that float64 has to the last bit, whatever its type


def kept_small(array: NDArray[Any]) -> NDArray[Any]:
    """Real numbers as they are where their type is a small one, else as float64."""
    return array if array.dtype.itemsize <= SMALL else np.asarray(array, dtype=np.float64)


def floats(values: NDArray[Any]) -> NDArray[np.float64]:
    """Real numbers as float64: whole numbers of few bytes would overflow, and small floats round."""
    return np.asarray(values, dtype=np.float64)


def real_array(what: str, values: object, allowed: str) -> NDArray[np.float64]:
    """Take a contiguous array of real numbers from all that numpy makes one of; masked points become NaN."""
    return np.asarray(real_numbers(what, values, allowed), dtype=np.float64, order="C")


def real_numbers(what: str, values: object, allowed: str) -> NDArray[Any]:
    """Take real numbers of any type, as `real_array` does."""
    if isinstance(values, np.ma.MaskedArray):
        values = np.ma.filled(values.astype(np.float64), np.nan)
    try:
        array = np.asarray(values)
    except ValueError:  # lists of unequal lengths
        raise InputError(what, "rows of unequal length", allowed) from None
    if array.dtype.kind not in "fiu":
        received = shown(values) if array.ndim == 0 else f"data of type {array.dtype}"
        raise InputError(what, received, allowed)
    return array


def finite_array(
    what: str,
    values: object,
    allowed: str = "finite numbers",
    *,
    count: int | None = None,
    shape: tuple[int | None, ...] | None = None,
    rising: bool = False,
    above: float = -math.inf,
    at_least: float = -math.inf,
    below: float = math.inf,
) -> NDArray[np.float64]:
    """Take an array as `real_array` does, each number finite and within limits.

    Of so many numbers (n,), one of which may stand alone; or of a shape, None where any length will do. Where
    they must rise, each is above the one before, along the first axis.
    """
    array = real_array(what, values, allowed)
    if count is not None:
        array = np.atleast_1d(array)
        shape = (count,)
    if shape is not None and not _fits(array.shape, shape):
        received = count_of(array.size, "number") if array.ndim == 1 else f"shape {array.shape}"
        raise InputError(what, received, str(count) if count is not None else allowed)
    right = np.isfinite(array)
    for within, limit in ((np.greater, above), (np.greater_equal, at_least), (np.less, below)):
        if math.isfinite(limit):
            right &= within(array, limit)
    if not right.all():
        raise InputError(what, float(array[~right][0]), allowed)
    if rising and (np.diff(array, axis=0) <= 0.0).any():
        raise InputError(what, "numbers that do not rise", allowed)
    return array


def _fits(shape: tuple[int, ...], wanted: tuple[int | None, ...]) -> bool:
    return len(shape) == len(wanted) and all(n in (None, m) for m, n in zip(shape, wanted, strict=True))


def file_path(what: str, value: object, allowed: str) -> Path:
    """Take a path, from text or a path object, whether or not anything is there."""
    if not isinstance(value, str | os.PathLike) or not str(value).strip():
        raise InputError(what, shown(value), allowed)
    return Path(value)


def no_file(path: Path) -> str:
    """Say why a path names no file that can be read; pipes and devices may never end.

    What was found there instead, for a message; empty if it is a regular file with contents.
    """
    try:
        status = path.stat()
    except (FileNotFoundError, NotADirectoryError):
        return "no such file"
    except OSError as error:  # a name that is too long, a loop of links, a folder that is closed
        return f"a path that cannot be followed ({error.strerror or error})"
    except ValueError as error:  # a null character
        return f"a path that cannot be followed ({error})"
    if stat.S_ISDIR(status.st_mode):
        return "a folder"
    if not stat.S_ISREG(status.st_mode):
        return "a pipe or a device, which may never end"
    return "" if status.st_size else "an empty file"


def listed(names: Sequence[str]) -> str:
    """Write out names for a message: the first ten, and how many more there are."""
    shortened = [name if len(name) <= LONGEST else name[: LONGEST - 3] + "…" for name in names[:MOST_NAMES]]
    more = f" and {len(names) - MOST_NAMES} more" if len(names) > MOST_NAMES else ""
    return ", ".join(shortened) + more


def _number(value: object) -> float:
    """A real number, or NaN for anything else."""
    if getattr(value, "ndim", None) == 0 and hasattr(value, "item"):  # arrays of numpy and xarray
        value = value.item()
    if isinstance(value, bool | np.bool_) or not isinstance(value, numbers.Real):
        return math.nan
    try:
        return float(value)
    except OverflowError:
        return math.inf
