"""A ball bearing under a load, as keys of a file or options; and the signal of one, read from a file."""

import warnings
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

import numpy as np

from asperity.arguments import Array, NDArray, require
from asperity.case import form, toml
from asperity.errors import InputError
from asperity.parameters import Choice, Origin, Quantity, key, keys_of, optional
from asperity.reference.bearings import BEARINGS
from asperity.structures.ball_bearing import BallBearing
from asperity.surfaces.readers import arrays, guards
from asperity.text_files import lines_of_cells, number_in, read_text

DIMENSIONS = keys_of(BallBearing, otherwise="that of the named bearing")
NEEDED = ("balls", "ball_diameter", "pitch_diameter")
LARGEST_TEXT = 64 * 2**20  # bytes
LOAD, LOADS = Quantity("N", at_least=0), "0 N to 100 MN: bearings carry less"
SPEEDS = "0 Hz to 10 kHz: bearings turn slower"


class BearingGeometry(form.Section, parameters=DIMENSIONS):
    """A ball bearing, named or by its dimensions."""

    ALTERNATIVES = (("clearance", "contact_angle"),)

    name: str | None = optional(Choice(tuple(BEARINGS)), "6205", "named bearing", "the dimensions are given")

    @property
    def bearing(self) -> BallBearing:
        """The bearing."""
        given = {name: getattr(self, name) for name in DIMENSIONS if getattr(self, name) is not None}
        return BallBearing(**given) if self.name is None else BallBearing.named(self.name, **given)

    def problems(self) -> Iterator[InputError]:
        """All dimensions of a bearing without a name, which must be one that can be."""
        missing = [name for name in NEEDED if getattr(self, name) is None]
        if self.name is None and missing:
            remedy = f"Named bearings: {', '.join(BEARINGS)}."
            yield InputError("name", f"none, and no {' and no '.join(missing)}", "these, or a name", remedy)
            return
        try:
            _ = self.bearing
        except InputError as error:
            yield error


class BearingKeys(BearingGeometry):
    """A ball bearing and what it carries."""

    radial: float = key(LOAD, "0 N", "radial load on the inner ring", LOADS)
    axial: float = key(LOAD, "0 N", "axial load on the inner ring", LOADS)
    speed: float | None = optional(
        Quantity("Hz", at_least=0), "1800 1/min", "speed of the ring that turns", "it stands still", SPEEDS
    )


def read_bearing(source: str, options: Mapping[str, Any]) -> BearingKeys:
    """Read a bearing by its name, or from a TOML file; options, as they are typed, are stronger."""
    keys: dict[str, Any] = {"name": source}
    if source not in BEARINGS:
        remedy = f"Named bearings: {', '.join(BEARINGS)}."
        keys = toml.read_toml(toml.read_definition(source, "bearing", remedy), "bearing", source)
        toml.refuse_vast(keys, source)
    return BearingKeys.read(keys | {k: v for k, v in options.items() if v is not None}, Origin.file(source))


def read_signal(
    path: Path, rate: float | None = None, *, array: str | None = None, column: int | None = None
) -> tuple[Array, float]:
    """Read a signal (n,) and its sampling rate, Hz, from ``.npy``, ``.npz``, ``.wav`` or a text table.

    `rate` is that which a file does not state, `array` the one of several in an archive, `column` the one of
    several, from 1. Samples of a WAV file are in shares of full scale.
    """
    file = guards.readable_file(path)
    kind = file.suffix.lower()
    with guards.hostile(file.name, kind.lstrip(".") or "text"):
        if kind == ".wav":
            stated, values = _of_wav(file)
            rate = rate or stated
        elif kind == ".npz":
            values = arrays.array_in(arrays.array_of_archive(file, array, "signals")[1], file.name)
        elif kind == ".npy":
            values = arrays.array_in(file.read_bytes(), file.name)
        else:
            values = _of_text(file)
    require(rate, "sampling rate", "nothing", "samples per second", 'Give it, as in --rate "12 kHz".')
    values = guards.scaled(values, 1.0, file.name)
    if values.ndim == 2:
        count = values.shape[1]
        received, allowed = f"{count} columns", f"one of 1 to {count}"
        chosen = 1 if column is None and count == 1 else column or 0
        require(1 <= chosen <= count, f"column in {file.name}", received, allowed, "Choose it with --column.")
        values = values[:, chosen - 1]
    require(values.ndim == 1, file.name, f"an array of shape {values.shape}", "a signal, or columns of them")
    return values, float(rate or 0.0)


def _of_wav(file: Path) -> tuple[float, NDArray[Any]]:
    from scipy.io import wavfile

    with warnings.catch_warnings(action="ignore"):  # of pieces that it does not know
        rate, values = wavfile.read(file)
    if values.dtype.kind == "u":
        values = values.astype(float) - 128.0
        return float(rate), values / 128.0
    full = float(np.iinfo(values.dtype).max) + 1.0 if values.dtype.kind == "i" else 1.0
    return float(rate), values / full


def _of_text(file: Path) -> NDArray[Any]:
    """Numbers of a table, below lines of words."""
    rows: list[list[float]] = []
    for line, cells in lines_of_cells(read_text(file, file.name, "a table of numbers", largest=LARGEST_TEXT)):
        try:
            numbers = [number_in(cell) for cell in cells]
        except ValueError:
            require(not rows, file.name, f"words in line {line}", "numbers below the heading")
            continue
        even = not rows or len(numbers) == len(rows[0])
        require(even, file.name, f"{len(numbers)} cells in line {line}", f"{len(rows[0]) if rows else 0}")
        rows.append(numbers)
    require(rows, file.name, "no numbers", "a table of numbers")
    return np.array(rows)
