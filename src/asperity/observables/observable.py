"""What can be measured and predicted alike: a quantity over an axis, and how a case gives it."""

import re
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any, Protocol

import numpy as np
from xarray import DataTree

from asperity.arguments import Array, Numbers, as_row, require, shown
from asperity.case.in_memory import name_of
from asperity.case.table_headings import Column
from asperity.case.tables import TableSource, read_table

Values = Numbers
Collected = dict[str, Array]
"""What is kept of a run, by name."""


@dataclass(frozen=True, eq=False)
class Measured:
    """A quantity that was measured, in SI.

    Parameters
    ----------
    what : str
        One of `asperity.observables.quantities()`, as ``"vertical decay rate"``.
    at : array_like (n,)
        Where along its axis: frequencies, Hz, centres of bands, Hz, loads, N.
    values : array_like (n,)
        In the units of the quantity; complex where a phase was measured.
    uncertainty : array_like (n,) or float, optional
        Standard deviation, dB; without it that of repeated measurements, else one that is usual.
    conditions : mapping, optional
        Keys of the case that were otherwise in this measurement, as ``{"speed": "120 km/h"}``.
    places : tuple of two floats, optional
        Of the response and of the force, m, where they are told.
    source : str
        Where it comes from.
    records : int
        Number of measurements of which it is the mean.
    labels : mapping
        What columns of a table say of it, by their titles: of a mean each word that they say of any of them.

    Raises
    ------
    InputError
        If its arrays are not of one length, or not finite.

    Examples
    --------
    >>> import asperity
    >>> rates = asperity.Measured("vertical decay rate", [500.0, 630.0, 800.0], [16.0, 14.0, 11.0])
    >>> rates.count
    3
    """

    what: str
    at: Array
    values: Values
    uncertainty: Array | float | None = None
    conditions: Mapping[str, Any] = field(default_factory=dict)
    places: tuple[float, float] | None = None
    source: str = "measured"
    records: int = 1
    labels: Mapping[str, tuple[str, ...]] = field(default_factory=dict)

    def __post_init__(self) -> None:
        at = as_row(self.at)
        values = np.atleast_1d(np.asarray(self.values))
        sound = values.dtype.kind in "fiuc" and at.ndim == 1 and at.shape == values.shape and at.size > 0
        allowed = "two arrays of one length, of finite numbers"
        require(sound, self.what, f"{shown(at)} and {shown(values)}", allowed)
        require(np.isfinite(at).all() and np.isfinite(values).all(), self.what, "what is not finite", allowed)
        object.__setattr__(self, "at", at)
        object.__setattr__(self, "values", values)
        if self.uncertainty is not None:
            given = np.broadcast_to(np.asarray(self.uncertainty, dtype=float), at.shape)
            positive = bool((np.isfinite(given) & (given > 0.0)).all())
            require(
                positive, f"uncertainty of the {self.what}", shown(self.uncertainty), "dB, greater than 0"
            )
            object.__setattr__(self, "uncertainty", given)

    @property
    def count(self) -> int:
        """Real numbers that it holds."""
        return len(self.at) * (2 if np.iscomplexobj(self.values) else 1)

    @property
    def differing(self) -> dict[str, tuple[str, ...]]:
        """Columns in which measurements differ of which it is the mean, with what they say.

        One that says something else of each, as a date, chooses none: it is named where no other differs.
        """
        differ = {title: words for title, words in self.labels.items() if len(words) > 1}
        return {title: words for title, words in differ.items() if len(words) < self.records} or differ


class Predictable(Protocol):
    """A case of which something is predicted, with what a run of it gives."""

    @property
    def case(self) -> Any:
        """The case, of a kind that lacks nothing of what is predicted."""

    @property
    def whole(self) -> Any:
        """The case as it is run."""

    @property
    def fine(self) -> bool:
        """Whether bands are resolved as in a report, or enough to search."""

    @property
    def collected(self) -> Collected:
        """What a run of it gives of all that is measured."""


@dataclass(frozen=True)
class Observable:
    """A quantity over an axis that is measured, and that a case predicts.

    Parameters
    ----------
    name : str
        What it is called.
    units : str
        Of its values.
    axis : str
        What it is measured over, with the unit.
    decade : float
        dB that ten times the value is: 10 of rates and powers, 20 of amplitudes, 0 of levels.
    uncertainty : float
        Standard deviation, dB, where nothing tells it.
    lacks : callable
        What a case lacks to predict it, in words; empty where it lacks nothing.
    predict : callable
        Its values at those of a `Measured`, (n,), of a `Predictable`.
    free : callable
        Keys that are fitted where none are named, those of the case first that decide most.
    words : str
        Pattern of words in a heading, or in the name of a file, that tell it.
    read : callable, optional
        Reads it from a file with a line for each place of its axis, or from the array that it would hold.
    collect : callable, optional
        What is kept for it of the result of a run; without one the case is not run.
    keys : tuple of str
        Keys of a case that name a table of it, with their sections.
    chance : callable, optional
        Standard deviation of each predicted value (n,), dB, by the chance of the record that was computed.
    chosen : callable, optional
        Keys, with their values, that a case does not give and that its run chose.
    jumps : bool
        Whether it jumps by tenths of a decibel as a key is moved by a per cent, and may rise and fall.
    """

    name: str
    units: str
    axis: str
    decade: float
    uncertainty: float
    lacks: Callable[[Any], str]
    predict: Callable[[Predictable, Measured], Values]
    free: Callable[[Any], tuple[str, ...]]
    words: str
    read: Callable[[TableSource], list[Measured]] | None = None
    collect: Callable[[DataTree], Collected] | None = None
    keys: tuple[str, ...] = ()
    chance: Callable[[Collected, Measured], Array] | None = None
    chosen: Callable[[Predictable], dict[str, Any]] | None = None
    jumps: bool = False

    @property
    def by_run(self) -> bool:
        """Whether the case is run for it."""
        return self.collect is not None

    def differs(self, values: Values, predicted: Values) -> Array:
        """Level of measured values (n,) over predicted ones, dB; of complex ones the phase, in dB, behind it.

        A phase of one radian counts as 8.7 dB, as an amplitude does that is e times as large.
        """
        if not self.decade:
            return np.asarray(values - predicted, dtype=float)
        with np.errstate(divide="ignore", invalid="ignore"):
            ratio = self.decade / np.log(10.0) * np.log(values / predicted)
        return np.concatenate([ratio.real, ratio.imag]) if np.iscomplexobj(values) else ratio.real

    def is_told(self, text: str) -> bool:
        """Whether words tell this quantity."""
        return re.search(self.words, text, re.IGNORECASE) is not None


def reader(what: str, place: Column, value: Column) -> Callable[[TableSource], list[Measured]]:
    """Reader of a quantity from a table with two columns: places along its axis, and its values."""

    def read(table: TableSource) -> list[Measured]:
        at, values = read_table(table, (place, value)).T
        return [Measured(what, at, values, source=name_of(table))]

    return read
