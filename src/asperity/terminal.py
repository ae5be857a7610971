"""The one place that writes to the terminal: names are shown as text, and nobody has to listen."""

import codecs
import errno
import json
import math
import os
import shutil
import sys
import unicodedata
from collections.abc import Callable, Collection, Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager, suppress
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, TextIO

from asperity.errors import ComputationError, printable

_NOBODY_LISTENS = (errno.EPIPE, errno.EIO, errno.EBADF)
"""The reader of a pipe has ended, a terminal has gone, a stream is closed."""


@dataclass(frozen=True)
class Manner:
    """How much is said while a command runs, and in which form."""

    quiet: bool = False  # no progress and no remarks
    verbose: bool = False  # also what each piece of the work took
    document: bool = False  # standard output is one JSON document, and holds nothing else


_manner = Manner()


def manner() -> Manner:
    """How much is said at present."""
    return _manner


def change_manner(**changes: bool) -> None:
    """Change what is said from here on."""
    global _manner
    _manner = replace(_manner, **changes)


@contextmanager
def speaking(wanted: Manner) -> Iterator[None]:
    """Speak in a manner while the body of the ``with`` statement runs, until `change_manner` changes it."""
    global _manner
    before = _manner
    _manner = wanted
    try:
        yield
    finally:
        _manner = before


def say(text: str, *, err: bool = False, lines: bool = False) -> None:
    """Print text on a line of its own, on standard output or error.

    What would control the terminal is spelled out; `lines` says whether line ends and tabs in it are meant.
    Where standard output is a document, what is for people there is left out.
    """
    if err or not manner().document:
        write(sys.stderr if err else sys.stdout, text, lines=lines)


def remark(text: str) -> None:
    """Say on standard error what is good to know, unless it shall be quiet."""
    if not manner().quiet:
        say(text, err=True)


def detail(text: str) -> None:
    """Say on standard error what only who asks for it wants to know."""
    if manner().verbose:
        say(text, err=True)


def say_document(content: Mapping[str, Any]) -> None:
    """Print one JSON document on standard output: ASCII, and null for what is no finite number."""
    write(sys.stdout, json.dumps(json_ready(content), indent=2, allow_nan=False), lines=True)


def json_ready(value: Any) -> Any:
    """What JSON can hold of a value: numbers of numpy as such, paths as text, null for NaN and infinity."""
    if isinstance(value, Mapping):
        return {str(key): json_ready(item) for key, item in value.items()}
    if isinstance(value, str | bool | None):
        return value
    if hasattr(value, "tolist"):  # numpy
        return json_ready(value.tolist())
    if isinstance(value, int | float):
        return value if math.isfinite(value) else None
    if isinstance(value, Iterable):
        return [json_ready(item) for item in value]
    return str(value)


def write(stream: TextIO | None, text: str, *, lines: bool = False) -> None:
    """Write text to a stream as `say` does; None is a stream that is closed."""
    if stream is not None:
        stream.write(printable(text.removesuffix("\n"), lines=lines) + "\n")
        stream.flush()


def say_files(files: Mapping[str, Path]) -> None:
    """Say what was written, by what it is, and where."""
    for what, path in files.items():
        say(f"{what.capitalize() + ':':8} {path.resolve()}")


def line_width(otherwise: int) -> int:
    """Characters of a line of the terminal; `otherwise` where standard output is none."""
    return shutil.get_terminal_size().columns if sys.stdout.isatty() else otherwise


def say_table(
    title: str,
    headings: Sequence[str],
    rows: Iterable[Sequence[str]],
    *,
    width: int,
    bold: Collection[int] = (),
    widths: Sequence[int] = (),
) -> None:
    """Print a table of rows of text, with headings or without, some rows (by number, from 0) in bold.

    `width` is the characters of a line where standard output is no terminal; `widths` are those
    of the columns, by default what their cells need and the line allows.
    """
    if manner().document:
        return
    from rich.console import Console
    from rich.table import Table

    console = Console(file=sys.stdout, markup=False, emoji=False, highlight=False, force_jupyter=False)
    if not console.is_terminal:
        console.width = width
    table = Table(title=printable(title), title_justify="left", show_header=bool(headings))
    cells = [[printable(cell) for cell in row] for row in rows]
    for number, heading in enumerate(headings):
        table.add_column(printable(heading), width=widths[number] if widths else None)
    for number, row in enumerate(cells):
        table.add_row(*row, style="bold" if number in bold else None)
    console.print(table)


@contextmanager
def standard_streams() -> Iterator[None]:
    """Make standard output and error fit to be written to, whoever reads them, while a command runs.

    Where a stream is closed, no file that is opened later may take its number: what libraries print would go
    into that file. Where a reader has ended, as ``head`` does, the command goes on unheard. Characters that
    an encoding lacks are written in ASCII.
    """
    _open_closed()
    before = sys.stdout, sys.stderr
    try:
        for name in ("stdout", "stderr"):
            stream: Any = getattr(sys, name)
            if hasattr(stream, "reconfigure"):
                stream.reconfigure(errors=_IN_ASCII)
            setattr(sys, name, _Patient(stream, name))
        yield
    finally:
        for stream in (sys.stdout, sys.stderr):
            with suppress(ComputationError, ValueError):  # ValueError: closed by the command itself
                stream.flush()
        sys.stdout, sys.stderr = before


def require_output() -> None:
    """Refuse to say that all is done where standard output could not be written."""
    if isinstance(sys.stdout, _Patient):
        sys.stdout.require_written()


_IN_ASCII = "asperity-ascii"
"""Name of the handler of characters that an encoding lacks."""
_ALIKE = {
    "−": "-", "–": "-", "—": "-", "×": "x", "·": "*", "±": "+/-", "∓": "-/+", "≤": "<=", "≥": ">=",
    "→": "->", "←": "<-", "°": "deg", "√": "sqrt", "∝": "~", "“": '"', "”": '"', "„": '"', "’": "'",
    "α": "alpha", "β": "beta", "δ": "delta", "Δ": "Delta", "ζ": "zeta", "η": "eta", "λ": "lambda",
    "μ": "u", "ν": "nu", "π": "pi", "σ": "sigma", "Σ": "Sigma", "τ": "tau", "ω": "omega", "Ω": "Ohm",
}  # fmt: skip


def _in_ascii(error: UnicodeError) -> tuple[str, int]:
    """Characters in ASCII: ``-`` for a minus sign, ``u`` for micro; ``?`` for what has no likeness."""
    if not isinstance(error, UnicodeEncodeError):
        raise error
    return "".join(map(_alike, error.object[error.start : error.end])), error.end


def _alike(character: str) -> str:
    parts = [_ALIKE.get(part, part) for part in unicodedata.normalize("NFKD", character)]
    return _ALIKE.get(character) or "".join(filter(str.isascii, parts)) or "?"


codecs.register_error(_IN_ASCII, _in_ascii)


def _open_closed() -> None:
    """Put the null device in the place of standard streams that are closed."""
    names = ("stdin", "stdout", "stderr")
    for number in range(len(names)):
        try:
            os.fstat(number)
        except OSError:
            null = os.open(os.devnull, os.O_RDWR)  # takes the lowest free number
            if null != number:
                os.dup2(null, number)
                os.close(null)
            os.set_inheritable(number, True)
    for number, name in enumerate(names):
        if getattr(sys, name) is None:
            stream = open(number, "w" if number else "r", encoding="utf-8", closefd=False)  # noqa: SIM115
            setattr(sys, name, stream)


class _Patient:
    """A text stream that goes on when nobody reads it any more."""

    def __init__(self, stream: TextIO, name: str) -> None:
        self._stream = stream
        self._name = name
        self._failure: ComputationError | None = None

    def __getattr__(self, name: str) -> Any:
        return getattr(self._stream, name)

    def write(self, text: str) -> int:
        """Write text."""
        self._trying(self._stream.write, text)
        return len(text)

    def flush(self) -> None:
        """Hand over what is written."""
        self._trying(self._stream.flush)

    def _trying(self, work: Callable[..., object], *words: str) -> None:
        """Send what is still to come nowhere; what stands on a full disk is told, unless nobody hears it."""
        try:
            work(*words)
        except OSError as error:
            null = os.open(os.devnull, os.O_WRONLY)
            with suppress(OSError, ValueError):  # ValueError: a stream without a number
                os.dup2(null, self._stream.fileno())
            os.close(null)
            if self._name == "stdout" and error.errno not in _NOBODY_LISTENS:
                self._failure = ComputationError(
                    f"standard output could not be written ({error.strerror or error})",
                    "another place for it, or free space on its disk",
                )
                raise self._failure from error

    def require_written(self) -> None:
        """Hand over what is written; a `ComputationError` if any of it was not, whoever did not listen."""
        self.flush()
        if self._failure:
            raise self._failure
