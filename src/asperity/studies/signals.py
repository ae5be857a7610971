"""A folder of labelled signals, one file for each member of a study of bearings: for those who classify."""

import io
import re
import warnings
from array import array
from collections import deque
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property
from math import ceil
from pathlib import Path
from typing import Any, Literal

import numpy as np
import xarray

from asperity import files
from asperity.arguments import (
    Array,
    ArrayLike,
    FilePath,
    NDArray,
    file_path,
    finite_array,
    one_of,
    positive,
    require,
    shown,
)
from asperity.case import any_case
from asperity.case.ball_bearing import BearingUnderLoad
from asperity.case.table_headings import heading_of
from asperity.errors import InputError
from asperity.results import save, variable
from asperity.schema.bearing import TACHO
from asperity.speeds import speed_at
from asperity.store import content_key
from asperity.structures.ball_bearing import PARTS
from asperity.studies import rates
from asperity.studies.axes import AS_IT_IS, VARIANT, written_out
from asperity.studies.definition import Member
from asperity.studies.member import SIGNAL
from asperity.studies.times import Clock, clock_of, doubt_rate, rate_beside
from asperity.surfaces.readers import arrays, guards, matlab, text
from asperity.text_files import (
    blocks_of_lines,
    even_rows,
    lines_of_cells,
    number_in,
    read_text,
    separator_in,
    write_csv,
)
from asperity.units import quantity, unit_in
from asperity.written_numbers import count_of, rounded

FORMATS = ("nc", "npy", "wav")
LABELS = "labels.csv"
UNIT = "m/s2"
ALWAYS = ("speed", "radial", "axial", "seed")
"""Keys that label every signal, beside those that are swept and what the fault is."""
FAULT: dict[str, Any] = {
    "on": "none", "shape": "none", "length": 0.0, "width": 0.0, "depth": 0.0, "angle": np.nan, "ball": 0
}  # fmt: skip
"""What labels a fault, with what stands where there is none."""
FULL = 32_767
"""Number of a WAV file, of 16 bits, that stands for full scale."""
MOST_LEVEL = 200.0  # dB
LEAST_PEAK = 1e-60
"""Largest value of a signal, in whatever unit, and …"""
MOST_PEAK = 1e60
"""… where it is no signal any more: powers of it are taken, and their products."""
MOST_TERMS = 10_000
"""Largest number in the ratio of two sampling rates, which is taken as one of whole numbers."""
LARGEST_TEXT = 64 * 2**20  # bytes
UNREAD_WAV = ("Unknown wave file format", "Unsupported bit depth")
"""What SciPy says of an intact file that it does not read."""


@dataclass(frozen=True)
class SignalSet:
    """Signals that a study of bearings writes: the acceleration at its sensors, labelled.

    Parameters
    ----------
    folder : path
        Where they go, one file for each member, with ``labels.csv``.
    format : {"nc", "npy", "wav"}
        netCDF with its labels; a NumPy array (n,), of several sensors (n, sensors); or WAV of 16 bits, whose
        full scale, in m/s2, stands in ``labels.csv``. Beside the last two lies the case in TOML.
    path : path, optional
        File with the impulse response of the path from the bearing to the sensor, as `through_path` takes
        it: ``.npy``, ``.npz``, ``.mat``, ``.wav``, or a table, of which a column of times (s) may come first.
    path_rate : str or float, optional
        Samples per second of that response, where its file does not say: Hz, or with a unit.
    noise : str, optional
        Level of white noise that is added behind the path: ``"20 dB"`` below the rms of the signal, or its
        rms, ``"0.5 m/s^2"``. It differs from member to member, and is the same again.

    Raises
    ------
    InputError
        If one of these is wrong, or the file with the response cannot be read.

    Examples
    --------
    >>> from asperity.studies.signals import SignalSet
    >>> SignalSet("set", "npy", noise="20 dB").labels_file.name
    'labels.csv'
    """

    folder: FilePath
    format: str = "nc"
    path: FilePath | None = None
    path_rate: str | float | None = None
    noise: str | None = None

    def __post_init__(self) -> None:
        one_of("format of the signals", self.format, FORMATS)
        given = self.path_rate is None or self.path is not None
        require(given, "sampling rate of the path", "a rate without a path", "the file with the response")
        _ = self.labels_file, self._response, self._noise

    @cached_property
    def labels_file(self) -> Path:
        """The table of labels."""
        return file_path("folder of the signals", self.folder, "the path of a folder") / LABELS

    @cached_property
    def _response(self) -> tuple[Array, float] | None:
        """Impulse response and its sampling rate, Hz; None for none."""
        if self.path is None:
            return None
        file = file_path("path to the sensor", self.path, "the path of a file")
        rate = self.path_rate
        rate = quantity(rate, "Hz") if isinstance(rate, str) else rate
        if rate is not None or file.suffix.lower() == ".wav":
            return read_signal(file, rate)
        values, titles, stated, _ = _recorded(file, None)
        if stated and values.ndim == 1:
            return values, stated
        received = f"an array of shape {values.shape}"
        allowed = "a column of times (s), then the response"
        columns = values.ndim == 2 and values.shape[1] == 2
        require(columns, file.name, received, allowed, "Or give the sampling rate.")
        times = clock_of(values, titles or ["time (s)", ""], file.name)
        even = times.rate if times and not times.gaps else None
        return values[:, 1], rate_beside(None, even, file.name)

    @cached_property
    def _noise(self) -> dict[str, float]:
        """Level of the noise, as `with_noise` takes it; empty for none."""
        if self.noise is None:
            return {}
        received = shown(self.noise)
        allowed = "a level as '20 dB', or an rms above 0 as '0.5 m/s^2'"
        try:
            is_level = unit_in(self.noise) == "dB"
            found = quantity(self.noise, "dB" if is_level else "m/s^2")
        except (InputError, TypeError):
            raise InputError("noise of the signals", received, allowed) from None
        right = abs(found) <= MOST_LEVEL if is_level else 0.0 < found < np.inf
        require(right, "noise of the signals", received, f"{allowed}, within ±{MOST_LEVEL:g} dB")
        return {"below" if is_level else "rms": found}

    @classmethod
    def of(cls, asked: "FilePath | SignalSet", members: Iterable[Member]) -> "SignalSet":
        """Take signals that are asked for; refuse cases without any, and a folder that cannot be written."""
        found = asked if isinstance(asked, cls) else cls(asked)  # type: ignore[arg-type]
        for case in (member.case for member in members if member.case):
            if not isinstance(case, BearingUnderLoad):
                raise InputError("signals", f"a {case.kind} case", 'a case of kind = "ball-bearing"')
        files.refuse_unwritable(found.labels_file.parent, "folder of the signals", "Choose another one.")
        return found

    def write(self, member: Member, table: xarray.Dataset) -> dict[str, Any]:
        """Write the signal of a member, where it is not there yet, and return its labels."""
        assert isinstance(member.case, BearingUnderLoad)
        case, (heard, rate) = member.case, self._response or (np.zeros(0), 0.0)
        digest = content_key("signal", member.key, self.format, heard, rate, self._noise).partition("-")[2]
        file = self.labels_file.parent / f"{digest[:16]}.{self.format}"
        labels = {"file": file.name, **_labels(member, case)}
        if self.format != "wav" and file.exists():
            return labels
        signal = np.asarray(table[SIGNAL].values, dtype=float)
        if self._response:
            signal = np.stack([through_path(each, case.sampling_rate, heard, rate) for each in signal])
        if self._noise:
            seeds = [int(digest[n : n + 8], 16) for n in range(0, 32, 8)]
            signal = np.stack([with_noise(each, [*seeds, n], **self._noise) for n, each in enumerate(signal)])
        if self.format == "wav":
            labels[f"full_scale [{UNIT}]"] = float(np.abs(signal).max()) or 1.0
        if not file.exists():
            self._write(file, case, signal, labels)
        return labels

    def _write(self, file: Path, case: BearingUnderLoad, signal: Array, labels: Mapping[str, Any]) -> None:
        """Write a signal (sensors, n), its case first."""
        if self.format == "nc":
            told = {name.partition(" [")[0]: value for name, value in labels.items() if name != "file"}
            time = np.arange(signal.shape[1]) / case.sampling_rate
            held = {
                "time": variable("time", time, "s", "time"),
                "sensor": variable("sensor", np.array(case.sensors), "rad", "angle from the radial load"),
                SIGNAL: variable(("sensor", "time"), signal, UNIT, "acceleration at the sensor"),
                TACHO.name: variable("time", speed_at(case.speed, time), TACHO.units, TACHO.long_name),
            }
            save(xarray.DataTree(xarray.Dataset(held, attrs={**told, "case": case.text})), file)
            return
        files.write_bytes(file.with_suffix(".toml"), case.text.encode())
        columns = signal.T if len(signal) > 1 else signal[0]
        image = io.BytesIO()
        if self.format == "npy":
            np.save(image, columns)
        else:
            from scipy.io import wavfile

            shares = columns / labels[f"full_scale [{UNIT}]"]
            wavfile.write(image, round(case.sampling_rate), np.round(FULL * shares).astype(np.int16))
        files.write_bytes(file, image.getvalue())

    def label(self, labels: Mapping[tuple[int, ...], Mapping[str, Any]]) -> None:
        """Write the table of labels, the members in the order of the study.

        Each signal once: the case as it is, which no variant changes, gives way to one that is the same.
        """
        of_file: dict[str, Mapping[str, Any]] = {}
        for row in (labels[index] for index in sorted(labels)):
            if row["file"] not in of_file or of_file[row["file"]].get(VARIANT) == AS_IT_IS:
                of_file[row["file"]] = row
        rows = list(of_file.values())
        if rows:
            longest = max(rows, key=len)  # of those with most faults
            names = list(longest)
            told = [[row.get(name, _absent(name)) for name in names] for row in rows]
            write_csv(self.labels_file, names, told)


def _labels(member: Member, case: BearingUnderLoad) -> dict[str, Any]:
    """What is told of the signal of a member, in SI, units behind the names."""
    found: dict[str, Any] = {}
    for section, keys in (case.faults or {"fault": case.fault}).items():
        own = {"on": keys.part, "ball": keys.number if keys.part == "ball" else 0}
        fault = keys.fault
        for name, missing in FAULT.items():
            given = own[name] if name in own else getattr(fault, name, missing)
            found[_titled(f"{section}.{name}")] = given if fault else missing
    for name in dict.fromkeys((*ALWAYS, *member.values)):
        section, _, key = name.rpartition(".")
        if name == VARIANT:
            found[name] = member.values[name]
        elif _titled(name) not in found:
            value = getattr(getattr(case, section) if section else case, key)
            number = np.nan if value is None else value
            found[_titled(name)] = number if type(number) in (int, float) else written_out(value)
    turning = case.kinematics
    found |= {f"{part}_tone [Hz]": turning.tone(part) for part in PARTS}
    found |= {"cage_tone [Hz]": turning.cage, "sampling_rate [Hz]": case.sampling_rate}
    return found | {"unit": UNIT, "law": case.laws[0]}


def _absent(title: str) -> Any:
    """What stands for the label of a fault that a bearing does not have."""
    return FAULT.get(title.partition(".")[2].partition(" [")[0], np.nan)


def _titled(dotted: str) -> str:
    """Name of a key with its unit."""
    unit = any_case.entry_of(BearingUnderLoad, dotted).unit if dotted != VARIANT else None
    return f"{dotted} [{unit}]" if unit and unit != "1" else dotted


# --- signals from files, behind a path and in noise


def read_signal(
    path: Path, rate: float | None = None, *, array: str | None = None, column: int | None = None
) -> tuple[Array, float]:
    """Read a signal (n,) and its sampling rate, Hz, from ``.npy``, ``.npz``, ``.mat``, ``.wav`` or text.

    `rate` is that which a file does not state, `array` the one of several in an archive, `column` the one of
    several, from 1. A column of times gives the rate, see `clock_of`; NaN stands for samples that it leaves
    out, and for empty cells. Samples of a WAV file are in shares of full scale.
    """
    found = read_record(path, rate, array=array, column=column)
    return found.values, found.rate


@dataclass(frozen=True, eq=False)
class Recorded:
    """A signal from a file."""

    values: Array  # (n,)
    rate: float  # Hz
    rate_by: str  # what says so in the file, with the verb; empty where it was given alone


def read_record(
    path: Path, rate: float | None = None, *, array: str | None = None, column: int | None = None
) -> Recorded:
    """Read a signal as `read_signal` does, and what tells its rate."""
    file = guards.readable_file(path)
    values, titles, stated, teller = _recorded(file, array)
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


def read_beside(path: Path, which: str, array: str | None = None) -> tuple[Array, str]:
    """Read what was recorded beside a signal (n,), and its heading: of a column by number, or an array."""
    file = guards.readable_file(path)
    numbered = which.isdecimal()
    values, titles, _, _ = _recorded(file, array if numbered else which)
    if not numbered:
        require(values.ndim == 1, f"{which} in {file.name}", f"shape {values.shape}", "one number a sample")
        return values, ""
    count = values.shape[1] if values.ndim == 2 else 1
    number = int(which)
    allowed = f"one of 1 to {count}, or the name of an array"
    require(1 <= number <= count, f"column of the tacho in {file.name}", which, allowed)
    column = values.reshape(len(values), -1)[:, number - 1]
    return column, titles[number - 1] if titles else ""


def _check_size(values: Array, source: str) -> None:
    """Refuse a signal whose squares no number holds."""
    known = np.isfinite(values)
    largest = max(float(values.max(initial=0.0, where=known)), -float(values.min(initial=0.0, where=known)))
    held = largest == 0.0 or LEAST_PEAK < largest < MOST_PEAK
    allowed = f"{rounded(LEAST_PEAK)} to {rounded(MOST_PEAK)} at most"
    require(held, source, f"values of up to {rounded(largest)}", allowed, "Is its type right?")


def _recorded(file: Path, array: str | None) -> tuple[Array, list[str], float | None, str]:
    """What a file holds, titles of its columns, and the sampling rate, Hz, if it states it, and what does."""
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
        elif kind == ".mat":
            _, values, beside = matlab.array_of_matlab(file, array, "signals", rates.WORDS)
            values = values.ravel() if 1 in values.shape else values
        else:
            values, titles = _of_text(file)
        require(values.ndim, file.name, "a single number", "a signal, or columns of them")
        if (told := rates.rate_in(beside, len(values), file.name)) is not None:
            rate = told[0]
            teller = f"'{told[1]}' says"
    numbers = values if values.dtype == np.float64 else guards.scaled(values, 1.0, file.name)
    return numbers, titles, rate, teller


def _kind_of(file: Path) -> str:
    """Extension that a file with a signal has by its content, or by its name; empty for text."""
    with open(file, "rb") as opened:
        head = opened.read(32)
    known = {".wav": (b"RIFF", b"RIFX", b"RF64"), ".npy": (b"\x93NUMPY",), ".npz": (b"PK\x03\x04",)}
    for kind, begins in (known | {".mat": matlab.HEAD}).items():
        if head.startswith(begins):
            return kind
    named = file.suffix.lower()
    if named in (*known, ".mat"):
        return named
    allowed, remedy = ".npz, .npy, .wav, .mat or text", "Save the signal as one of these."
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
    """Sampling rate, Hz, and samples in shares of full scale; the pieces of the file are all there."""
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
        values = values.astype(float) - 128.0
        return float(rate), values / 128.0
    full = float(np.iinfo(values.dtype).max) + 1.0 if values.dtype.kind == "i" else 1.0
    return float(rate), values / full


def _check_pieces(file: Path) -> None:
    """Refuse a WAV file whose samples are more, by its own words, than it holds.

    What writes to a pipe does not know their number, and writes the largest there is, or none.
    """
    with open(file, "rb") as opened:
        head = opened.read(12)
        order: Literal["big", "little"] = "big" if head[:4] in (b"RIFX", b"FFIR") else "little"
        place = len(head)
        size = file.stat().st_size
        long = 0
        while place + 8 <= size:
            opened.seek(place)
            name = opened.read(4)
            told = int.from_bytes(opened.read(4), order)
            left = size - place - 8
            if name == b"ds64":  # of a file beyond 4 GiB
                long = int.from_bytes(opened.read(16)[8:], order)
            if name == b"data":
                told = long or told
                received = f"{told} bytes of samples, by its head, in {left}"
                allowed = "all of them"
                require(told <= left, file.name, received, allowed, "The file is truncated; copy it again.")
            place += 8 + told + told % 2


_UNIVERSAL = re.compile(r"\s*-1\s*\n\s*(\d{1,4})b?\b[^\n]*\n\s*[^\d\s+-]")
_DECIMAL_COMMA = re.compile(r"^[ \t]*(?:[-+]?\d+,0\d|-0,\d)\d*[ \t]*\r?$", re.MULTILINE)
"""A single number with a decimal comma: nobody writes whole numbers as 05 or -0."""


def _of_text(file: Path) -> tuple[Array, list[str]]:
    """Numbers of a table, below lines of words, of which the last may be titles of its columns."""
    content = read_text(file, file.name, "a table of numbers", largest=LARGEST_TEXT, latin=True)
    universal = _UNIVERSAL.match(content)
    received = f"a universal file, dataset {universal[1]}" if universal else ""
    allowed = "a table of numbers"
    require(not universal, file.name, received, allowed, "Save the signal as .mat, .npz, .wav or text.")
    if "." not in content and _DECIMAL_COMMA.search(content):
        content = content.replace(",", ".")
    numbers = array("d")
    columns = 0
    words: deque[list[str]] = deque(maxlen=2)
    line = 1
    for lines in blocks_of_lines(content):
        separator = separator_in(lines[-1])
        even = even_rows(lines, separator, "." if separator in (None, ",") else ",")
        if even is not None and even.shape[1] == (columns or even.shape[1]):
            columns = even.shape[1]
            numbers.frombytes(even.tobytes())
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
    return np.frombuffer(numbers).reshape(-1, columns), heading_of(words, ["s", *[""] * (columns - 1)])


def through_path(signal: ArrayLike, rate: float, response: ArrayLike, response_rate: float) -> Array:
    """Signal behind a path whose impulse response was measured, at whatever sampling rate.

    Parameters
    ----------
    signal : array_like (n,)
        In any unit.
    rate : float
        Its samples per second, Hz.
    response : array_like (m,)
        Weights of a filter at its own sampling rate: 1 alone leaves the signal as it is. What was measured
        in 1/s is divided by its sampling rate. No longer than the signal.
    response_rate : float
        Samples per second of the response, Hz.

    Returns
    -------
    ndarray (n,)
        In the unit of the signal times that of the response; it starts from rest.

    Notes
    -----
    The transfer function ``H(f) = Σ h_k exp(−2πi f k/response_rate)`` is taken at the frequencies of the
    signal itself, so that nothing is lost by resampling. Above half of `response_rate` nothing is known of
    the path, and nothing passes.

    Examples
    --------
    >>> from asperity.studies.signals import through_path
    >>> through_path([1.0, 0.0, 0.0, 0.0], 8e3, [0.5, 0.25], 8e3).round(12).tolist()
    [0.5, 0.25, 0.0, 0.0]
    """
    from scipy.fft import irfft, next_fast_len, rfft

    values = finite_array("signal", signal, "a series of finite numbers", shape=(None,))
    weights = finite_array("impulse response", response, "a series of finite numbers", shape=(None,))
    rates = positive("sampling rate (Hz)", rate), positive("sampling rate of the path (Hz)", response_rate)
    ratio = Fraction(rates[0] / rates[1]).limit_denominator(MOST_TERMS)
    received = f"{rates[0]:g} and {rates[1]:g} Hz"
    allowed = f"up to {MOST_TERMS} times apart"
    require(0 < ratio < MOST_TERMS, "sampling rates of the signal and the path", received, allowed)
    received = f"{weights.size / rates[1]:.4g} s"
    allowed = f"above 0, and at most {values.size / rates[0]:.4g} s, as the signal"
    remedy = "Cut it where it has died away."
    require(0 < weights.size * ratio <= values.size, "impulse response", received, allowed, remedy)
    ours, theirs = ratio.as_integer_ratio()  # samples of the same time
    pieces = next_fast_len(ceil((values.size + weights.size * ratio) / ours), real=True)
    lines = rfft(values, pieces * ours)
    transfer = rfft(weights, pieces * theirs)
    known = min(lines.size, transfer.size)
    return np.asarray(irfft(lines[:known] * transfer[:known], pieces * ours)[: values.size])


def with_noise(
    signal: ArrayLike, seed: int | Sequence[int], *, below: float | None = None, rms: float | None = None
) -> Array:
    """Signal with white noise of a normal distribution.

    Parameters
    ----------
    signal : array_like (n,)
        In any unit.
    seed : int or sequence of int
        Of the noise: the same seed makes the same noise.
    below : float
        Level by which the rms of the noise lies below that of the signal, less its mean, dB; or
    rms : float
        Rms of the noise, in the unit of the signal.

    Returns
    -------
    ndarray (n,)

    Examples
    --------
    >>> import numpy as np
    >>> from asperity.studies.signals import with_noise
    >>> sine = np.sin(np.arange(10_000))
    >>> noise = with_noise(sine, 1, below=20.0) - sine
    >>> bool(abs(noise.std() / sine.std() - 0.1) < 0.002)
    True
    """
    values = finite_array("signal", signal, "a series of finite numbers", shape=(None,))
    require((below is None) != (rms is None), "level of the noise", "both or none", "one of below and rms")
    spread = rms or 0.0 if below is None else float(values.std()) * 10.0 ** (-below / 20.0)
    return np.asarray(values + spread * np.random.default_rng(seed).standard_normal(values.size))
