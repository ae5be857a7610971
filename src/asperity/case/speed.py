"""Speeds as a case says them: constant, or a course: from one to another, by points, or by a table."""

import re
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from asperity.case.table_headings import Column
from asperity.case.tables import TableFile, TableSource, read_table
from asperity.errors import InputError
from asperity.parameters import DURATION_OR_ZERO, FROM_PYTHON, Origin, Quantity
from asperity.speeds import SpeedCourse
from asperity.units import factor, quantity, unit_in, written
from asperity.written_numbers import rounded

_RUN = re.compile(r"\s*(\S.*?)\s*\.\.\s*(\S+\s+\S.*?)\s+in\s+(\S.*?)\s*", re.IGNORECASE)
_POINT = re.compile(r"\s*(\S.*?)\s+at\s+(\S.*?)\s*", re.IGNORECASE)
_TABLES = (".csv", ".txt", ".dat", ".tsv")
_AT = " at "


@dataclass(frozen=True)
class Speed(Quantity):
    """A speed, constant or a course: `asperity.speeds.SpeedCourse`.

    A course is text, ``"600..1800 1/min in 5 s"`` or points as ``"600 1/min at 0 s, 1800 1/min at 5 s"``, the
    path of a table of time and speed, a list of pairs, or from Python an array (n, 2) of them in SI.
    """

    @property
    def course(self) -> str:
        """A course as it may stand behind the key."""
        return f"600..1800 {self.meant} in 5 s" if self.meant else "1..3 m/s in 5 s"

    @property
    def allowed(self) -> str:
        """What may stand behind the key."""
        constant, _, example = super().allowed.partition(", with")
        return f'{constant}, or a course as "{self.course}", with{example}'

    def __call__(self, value: object, origin: Origin = FROM_PYTHON) -> float:
        """Return the speed in SI, or its course."""
        if isinstance(value, SpeedCourse):
            return value
        if isinstance(value, str):
            return self._of_text(value, origin)
        if isinstance(value, np.ndarray) and value.ndim:
            return self._of_table(value, origin)
        if isinstance(value, list | tuple):
            return self._of_pairs([self._pair(each, origin) for each in value])
        return super().__call__(value, origin)

    def _of_text(self, text: str, origin: Origin) -> float:
        if run := _RUN.fullmatch(text):
            if not (unit := unit_in(run[2])):
                self.refuse(text, f'Write it as "{self.course}".')
            first = run[1] if unit_in(run[1]) else f"{run[1]} {unit}"
            return self._of_pairs([(0.0, self._one(first)), (_in_time(run[3]), self._one(run[2]))])
        if _AT in text:
            points = [_POINT.fullmatch(each) for each in text.split(",")]
            if not all(points):
                self.refuse(text, 'Write points as "600 1/min at 0 s, 1800 1/min at 5 s".')
            return self._of_pairs([(_in_time(each[2]), self._one(each[1])) for each in points if each])
        if names_table(text):
            return self._of_table(text, origin)
        return super().__call__(text, origin)

    def _pair(self, given: Any, origin: Origin) -> tuple[float, float]:
        if not isinstance(given, list | tuple) or len(given) != 2:
            self.refuse(
                given, 'Give pairs of time and speed, as [["0 s", "600 1/min"], ["5 s", "1800 1/min"]].'
            )
        return DURATION_OR_ZERO(given[0], origin), super().__call__(given[1], origin)

    def _one(self, text: str) -> float:
        return super().__call__(text)

    def _of_table(self, value: object, origin: Origin) -> float:
        def read(table: TableSource) -> SpeedCourse | float:
            columns = Column("time", "s"), Column("speed", self.dimension)
            return self._of_pairs(read_table(table, columns).tolist())

        kind = TableFile(columns=(2,), content="a table of time and speed", read=read)
        return read(kind(value, origin))

    def _of_pairs(self, pairs: Sequence[Sequence[float]]) -> float:
        """The course; a speed that does not change is a number."""
        times, speeds = np.array(pairs, dtype=float).reshape(-1, 2).T
        course = SpeedCourse(times, speeds)
        return float(course) if np.ptp(speeds) == 0.0 else course


def _in_time(text: str) -> float:
    return DURATION_OR_ZERO(text)


def names_table(text: str) -> bool:
    """Whether the text of a speed is the path of a table."""
    return text.strip().lower().endswith(_TABLES)


def written_course(course: SpeedCourse, dimension: str, unit: str, *, exactly: bool) -> str:
    """Write a course as `Speed` reads it: to the last bit, or with six digits."""
    kind = Speed(dimension)
    points = [
        (written(time, "s", "s", exactly=exactly), written(speed, dimension, unit, exactly=exactly))
        for time, speed in course.points
    ]
    _, first = points[0]
    end, last = points[-1]
    if len(points) == 2 and course.times[0] == 0.0 and unit_in(first) == unit_in(last):
        text = f"{first.removesuffix(unit_in(first)).strip()}..{last} in {end}"
        if not exactly or kind(text) == course:
            return text
    return ", ".join(f"{speed}{_AT}{time}" for time, speed in points)


def span_of(speed: float, dimension: str, unit: str) -> str:
    """A speed in words, with its unit as it was typed: one, or from the first to the last of a course."""
    if not isinstance(speed, SpeedCourse):
        text = written(speed, dimension, unit)
        typed = quantity(text, dimension) == speed
        return text if typed else f"{rounded(speed / factor(unit, dimension), 5)} {unit}"
    first, last = (span_of(float(each), dimension, unit) for each in speed.speeds[[0, -1]])
    if unit_in(first) == unit_in(last):
        first = first.removesuffix(f" {unit_in(last)}")
    return f"{first} to {last}"


def refuse_course(speed: float, where: str) -> None:
    """Refuse a speed, m/s, that changes where a constant one is asked for."""
    if isinstance(speed, SpeedCourse):
        received = f"a course, {rounded(speed.slowest, 5)} to {rounded(float(speed), 5)} m/s"
        raise InputError("speed", received, f"one constant speed {where}", "Give a constant speed.")
