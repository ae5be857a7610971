"""Signals from files: what was recorded, at which rate, and what was recorded beside it."""

import math
import re
import warnings
import wave
from collections import deque
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from asperity.arguments import Array, NDArray, floats, kept_small, require
from asperity.case.table_headings import heading_of
from asperity.errors import InputError
from asperity.growing_numbers import GrowingNumbers
from asperity.ranks import known_pieces
from asperity.studies import kept_signals, rates
from asperity.studies.times import Clock, clock_of, doubt_rate, rate_beside
from asperity.surfaces.readers import arrays, guards, matlab, text
from asperity.text_files import (
    blocks_of_lines,
    even_rows,
    lines_of_cells,
    number_in,
    read_text,
    refuse_decimal_commas,
    separator_in,
)
from asperity.wave_files import FORM, SAMPLES, chunks_of, form_of, told_scale
from asperity.written_numbers import count_of, rounded

LEAST_PEAK = 1e-60
"""Largest value of a signal, in whatever unit, and …"""
MOST_PEAK = 1e60
"""… where it is no signal any more: powers of it are taken, and their products."""
LARGEST_TEXT = 64 * 2**20  # bytes
UNREAD_WAV = ("Unknown wave file format", "Unsupported bit depth")
"""What SciPy says of an intact file that it does not read."""

NUMBERS = (1, 3, 0xFFFE)
"""Kinds of WAV that hold numbers, PCM and floats, and one that says so further on."""


def read_signal(
    path: Path, rate: float | None = None, *, array: str | None = None, column: int | None = None
) -> tuple[Array, float]:
    """Read a signal (n,) and its sampling rate, Hz, from ``.npy``, ``.npz``, ``.mat``, ``.wav``, Parquet, a
    universal file or text.

    `rate` is that which a file does not state, `array` the one of several in an archive, `column` the one of
    several, from 1. A column of times gives the rate, see `clock_of`; NaN stands for samples that it leaves
    out, and for empty cells. Samples of a WAV file are in shares of full scale, or
    in the unit of which its comment tells the full scale, as this package writes it.
    """
    found = read_record(path, rate, array=array, column=column)
    return floats(found.values), found.rate


@dataclass(frozen=True, eq=False)
class Recorded:
    """A signal from a file."""

    values: NDArray[Any]  # (n,), in a small type where the file has one, or its numbers fit it
    rate: float  # Hz
    rate_by: str  # what says so in the file, with the verb; empty where it was given alone


def read_record(
    path: Path, rate: float | None = None, *, array: str | None = None, column: int | None = None
) -> Recorded:
    """Read a signal as `read_signal` does, and what tells its rate."""
    file = guards.readable_file(path, "signals")
    values, titles, stated, teller = read_columns(file, array)
    if stated:
        rate = rate_beside(rate, stated, file.name, teller)
    if values.ndim == 2:
        clock = clock_of(values, titles, file.name)
        values = values[:, _column(column, values.shape[1], clock, file.name)]
        if clock is not None and (titles or not rate):
            rate = rate_beside(rate, clock.rate, file.name)
            values = clock.filled(values)
            teller = "its times say" if clock.rate else ""
        elif rate and clock is not None and clock.rate:
            doubt_rate(rate, clock.rate, file.name)
    require(rate, "sampling rate", "nothing", "samples per second", 'Give it, as in --rate "12 kHz".')
    require(values.ndim == 1, file.name, f"an array of shape {values.shape}", "a signal, or columns of them")
    _check_size(values, file.name)
    return Recorded(values, float(rate or 0.0), teller)


def read_beside(path: Path, which: str, array: str | None) -> tuple[Array, str]:
    """Read what was recorded beside a signal (n,), and its heading: of a column by number, or an array."""
    file = guards.readable_file(path, "signals")
    numbered = which.isdecimal()
    values, titles, _, _ = read_columns(file, array if numbered else which)
    if not numbered:
        require(values.ndim == 1, f"{which} in {file.name}", f"shape {values.shape}", "one number a sample")
        return floats(values), ""
    count = values.shape[1] if values.ndim == 2 else 1
    number = int(which)
    allowed = f"one of 1 to {count}, or the name of an array"
    require(1 <= number <= count, f"column of the tacho in {file.name}", which, allowed)
    column = floats(values.reshape(len(values), -1)[:, number - 1])
    return column, titles[number - 1] if titles else ""


def _check_size(values: NDArray[Any], source: str) -> None:
    """Refuse a signal whose squares no number holds."""
    largest = max((float(np.abs(piece).max(initial=0.0)) for piece in known_pieces([values])), default=0.0)
    held = largest == 0.0 or LEAST_PEAK < largest < MOST_PEAK
    allowed = f"{rounded(LEAST_PEAK)} to {rounded(MOST_PEAK)} at most"
    require(held, source, f"values of up to {rounded(largest)}", allowed, "Is its type right?")


def read_columns(file: Path, array: str | None) -> tuple[NDArray[Any], list[str], float | None, str]:
    """What a file holds, titles of its columns, and the sampling rate, Hz, if it states it, and what does.

    Numbers are kept in the type that the file has them in where that is a small one.
    """
    kind = _kind_of(file)
    titles = list[str]()
    rate = None
    teller = ""
    beside: dict[str, NDArray[Any]] = {}
    with guards.hostile(file.name, kind.lstrip(".") or "text"):
        if kind == ".wav":
            rate, values = _of_wav(file)
            teller = "its head says"
        elif kind == ".npz":
            name, data = arrays.array_of_archive(file, array, "signals")
            values = arrays.array_in(data, file.name)
            beside = arrays.beside_in_archive(file, rates.WORDS)
            beside.pop(name, None)
        elif kind == ".npy":
            values = arrays.array_in(file.read_bytes(), file.name)
        elif kind in kept_signals.READERS:
            values, titles, rate = kept_signals.read(file, kind, array)
            teller = "its step says" if rate else ""
        elif kind == ".mat":
            _, values, beside = matlab.array_of_matlab(file, array, "signals", rates.WORDS)
            values = values.ravel() if 1 in values.shape else values
        else:
            values, titles = _of_text(file)
        require(values.ndim, file.name, "a single number", "a signal, or columns of them")
        if (told := rates.rate_in(beside, len(values), file.name)) is not None:
            rate = told[0]
            teller = f"'{told[1]}' says"
    return kept_small(guards.numbers_alone(values, file.name)), titles, rate, teller


def _kind_of(file: Path) -> str:
    """Extension that a file with a signal has by its content, or by its name; empty for text."""
    with open(file, "rb") as opened:
        head = opened.read(1024)
    if _UNIVERSAL.match(head.decode("latin-1")):
        return ".uff"
    known = {".wav": (b"RIFF", b"RIFX", b"RF64"), ".npy": (b"\x93NUMPY",), ".npz": (b"PK\x03\x04",)}
    known |= {".mat": matlab.HEAD, ".parquet": (b"PAR1",)}
    for kind, begins in known.items():
        if head.startswith(begins):
            return kind
    named = file.suffix.lower()
    if named in known:
        return named
    allowed = ".npz, .npy, .wav, .mat, .parquet, .uff or text"
    remedy = "Save the signal as one of these."
    require(text.holds_text(file), file.name, "bytes that are no text, and no signal", allowed, remedy)
    return ""


def _column(chosen: int | None, count: int, clock: Clock | None, source: str) -> int:
    """Column of a signal, from zero: that which was chosen, from one, or the only one that holds no times."""
    signals = [number for number in range(count) if clock is None or number != clock.column]
    if chosen is None and len(signals) == 1:
        return signals[0]
    received = count_of(count, "column")
    allowed = f"one of 1 to {count}"
    if clock is not None:
        allowed += f", of which {clock.column + 1} holds the times"
    within = chosen is not None and chosen - 1 in signals
    require(within, f"column in {source}", received, allowed, "Choose it with --column.")
    return (chosen or 0) - 1


def _of_wav(file: Path) -> tuple[float, Any]:
    """Sampling rate, Hz, and samples in shares of full scale, or in the unit that the file tells; its pieces
    are all there."""
    from scipy.io import wavfile

    _check_pieces(file)
    try:
        with warnings.catch_warnings(action="ignore"):  # of pieces that it does not know
            rate, values = wavfile.read(file)
    except ValueError as error:
        said = str(error).partition(". ")[0].rstrip(".")
        if not said.startswith(UNREAD_WAV):
            raise
        allowed = "whole numbers (PCM), or floats of 32 and 64 bits"
        remedy = "Save it as PCM of 16 bits."
        raise InputError(file.name, f"a kind of WAV that is not read ({said})", allowed, remedy) from None
    if values.dtype.kind == "u":
        return float(rate), (values.astype(np.float32) - np.float32(128.0)) / np.float32(128.0)
    full = float(np.iinfo(values.dtype).max) + 1.0 if values.dtype.kind == "i" else 1.0
    if values.dtype.kind == "i" and (scale := told_scale(file)) is not None:
        one = scale / _unit_number(file, values.dtype)
        # float32 has those of 16 bits in a unit to 1e-7 of themselves
        return float(rate), values * (np.float32(one) if values.dtype.itemsize <= 2 else one)
    if values.dtype.itemsize <= 2:  # whose shares float32 has to the last bit
        return float(rate), values.astype(np.float32) / np.float32(full)
    return float(rate), values / full


def _unit_number(file: Path, kind: NDArray[Any] | Any) -> float:
    """What SciPy makes of the number one: samples of 24 bits are read as ones of 32, to the left."""
    with wave.open(str(file)) as opened:
        return float(2 ** (8 * (np.dtype(kind).itemsize - opened.getsampwidth())))


def _check_pieces(file: Path) -> None:
    """Refuse a WAV file that lacks a piece, whose samples are of no bits, or are more than it holds.

    What writes to a pipe does not know their number, and writes the largest there is, or none.
    """
    size = file.stat().st_size
    met = set[bytes]()
    for name, place, told in chunks_of(file):
        met.add(name)
        if name == FORM:
            _check_form(file, place)
        if name == SAMPLES:
            received = f"{told} bytes of samples, by its head, in {size - place}"
            remedy = "The file is truncated; copy it again."
            require(told <= size - place, file.name, received, "all of them", remedy)
    missing = " and ".join(f"'{name.decode()}'" for name in (FORM, SAMPLES) if name not in met)
    allowed = "one that tells its kind ('fmt ') before its samples ('data')"
    remedy = "The file is damaged or truncated; copy or export it again."
    require(not missing, file.name, f"a WAV file without its piece {missing}", allowed, remedy)


def _check_form(file: Path, place: int) -> None:
    """Refuse a WAV file of numbers of which its head, at a place, says what cannot be."""
    kind, channels, rate, _, together, bits = form_of(file, place)
    received = (
        f"{count_of(channels, 'channel')} of {count_of(bits, 'bit')}, {count_of(together, 'byte')} a sample, "
        f"{rate} samples per second, by its head"
    )
    told = min(channels, bits, rate) > 0 and together >= channels * math.ceil(bits / 8)
    allowed = "none of them 0, and bytes for all bits"
    remedy = "Its head is damaged; export it again."
    require(told or kind not in NUMBERS, file.name, received, allowed, remedy)


_UNIVERSAL = re.compile(
    r"\s*-1\s*\n(?:\s*\d{1,4}b?\b[^\n]*\n\s*[^\d\s+-]| {3,4}(?:15|5[58]b?|82|151|164|24\d\d)\s)"
)
"""First lines of universal files: the mark of a dataset, its kind, then words; or a kind in six columns."""
_DECIMAL_COMMA = re.compile(r"^[ \t]*(?:[-+]?\d+,0\d|-0,\d)\d*[ \t]*\r?$", re.MULTILINE)
"""A single number with a decimal comma: nobody writes whole numbers as 05 or -0."""


def _of_text(file: Path) -> tuple[NDArray[Any], list[str]]:
    """Numbers of a table, below lines of words, of which the last may be titles of its columns."""
    content = read_text(file, file.name, "a table of numbers", largest=LARGEST_TEXT, latin=True)
    refuse_decimal_commas(content, file.name)
    if "." not in content and _DECIMAL_COMMA.search(content):
        content = content.replace(",", ".")
    numbers = GrowingNumbers()
    columns = 0
    words: deque[list[str]] = deque(maxlen=2)
    line = 1
    for lines in blocks_of_lines(content):
        separator = separator_in(lines[-1])
        even = even_rows(lines, separator, "." if separator in (None, ",") else ",")
        if even is not None and even.shape[1] == (columns or even.shape[1]):
            columns = even.shape[1]
            numbers.extend(even)
            line += len(lines)
            continue
        for number, cells in lines_of_cells("".join(lines), line):
            try:
                row = [np.nan if columns and not cell.strip() else number_in(cell) for cell in cells]
            except ValueError:
                require(not columns, file.name, f"words in line {number}", "numbers below the heading")
                words.append(cells)
                continue
            columns = columns or len(row)
            require(
                len(row) == columns, file.name, f"{count_of(len(row), 'cell')} in line {number}", str(columns)
            )
            numbers.extend(row)
        line += len(lines)
    require(columns, file.name, "no numbers", "a table of numbers")
    del content, lines  # before the numbers take their whole room
    return numbers.kept_small().reshape(-1, columns), heading_of(words, ["s", *[""] * (columns - 1)])
