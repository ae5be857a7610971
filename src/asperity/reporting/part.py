"""What a figure of the report consists of: its numbers, how they are laid out, and a caption."""

from __future__ import annotations

import difflib
import re
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from xarray import DataTree

from asperity.arguments import shown
from asperity.errors import InputError
from asperity.files import atomic_write, write_bytes
from asperity.reporting.chart import Chart
from asperity.reporting.data import laws, of_law, present, values
from asperity.schema import Entry
from asperity.text_files import csv_text

Columns = dict[str, NDArray[np.float64]]
"""Columns of a CSV file: ``"quantity [unit]"`` → numbers, all of one length, in SI units."""


@dataclass(frozen=True, eq=False)
class Series:
    """Numbers with a name and a unit: a line of a figure, and a column of its CSV file."""

    name: str
    units: str
    values: NDArray[np.float64]

    @property
    def heading(self) -> str:
        """Of its column, as ``"areal [N^2/Hz]"``."""
        units = re.sub(r"(?<=[A-Za-z)])(\d)", r"^\1", self.units).replace("um", "µm").replace("uPa", "µPa")
        return f"{self.name} [{units}]"


@dataclass(frozen=True, eq=False)
class Data:
    """Numbers of a figure, collected once: it is drawn from them, and its CSV file holds them."""

    x: Series | None  # what they stand over
    lines: Mapping[Any, Series]  # by law, by entry of the schema, or by both

    def of(self, entry: Entry) -> dict[Any, NDArray[np.float64]]:
        """Numbers of one entry, by what tells its lines apart: a law, a state, a point."""
        keys = [key for key in self.lines if isinstance(key, tuple) and key[0] is entry]
        return {key[1]: self.lines[key].values for key in keys}

    @property
    def field(self) -> NDArray[np.float64]:
        """All lines side by side: ``field[x, y]``."""
        return np.stack([line.values for line in self.lines.values()], axis=1)

    @property
    def at(self) -> NDArray[np.float64]:
        """What the lines are drawn over."""
        assert self.x is not None
        return self.x.values

    @property
    def columns(self) -> Columns:
        """Of the CSV file."""
        first = [] if self.x is None else [self.x]
        return {series.heading: series.values for series in (*first, *self.lines.values())}


def series(tree: DataTree, entry: Entry, name: str = "") -> Series:
    """Numbers of a variable, under its own name or another."""
    return Series(name or entry.name, entry.units, values(tree, entry, *entry.dims))


def field(tree: DataTree, entry: Entry, x: Entry, y: Entry, symbol: str) -> Data:
    """A field over x and y: one row per x, one column per y."""
    rows = values(tree, entry, x.name, y.name)
    lines: dict[Any, Series] = {
        position: Series(f"{symbol}(y={position:.9g} m)", entry.units, rows[:, index])
        for index, position in enumerate(values(tree, y).tolist())
    }
    return Data(series(tree, x, "x"), lines)


def present_series(tree: DataTree, named: Mapping[Entry, str]) -> dict[Any, Series]:
    """Those of some variables that a result holds, under the names given."""
    return {entry: series(tree, entry, name) for entry, name in named.items() if present(tree, entry)}


def by_law(tree: DataTree, entry: Entry, name: str = "{}") -> dict[str, Series]:
    """Numbers of each law over the last dimension of a variable; `name` says where the law stands in it."""
    return {
        law: Series(name.format(law), entry.units, of_law(tree, entry, law, entry.dims[-1]))
        for law in laws(tree, entry)
    }


@dataclass(frozen=True)
class Part:
    """One figure of the report."""

    name: str  # of its CSV file and of its place in the page
    title: str  # its heading
    needs: tuple[Entry, ...]  # variables without which it is left out
    collect: Callable[[DataTree], Data]  # takes its numbers from a result
    chart: Callable[[DataTree, Data], Chart]  # lays them out; what is said beside them stands in the result
    caption: Callable[[DataTree], str]  # says what is drawn and with which conventions
    any_of: tuple[Entry, ...] = ()  # variables of which it needs at least one
    # whether these variables have anything to show: a smooth surface has no spectrum
    worth: Callable[[DataTree], bool] = lambda _: True

    def drawable(self, tree: DataTree) -> bool:
        """Whether `tree` holds what the figure needs."""
        some = not self.any_of or any(present(tree, entry) for entry in self.any_of)
        return some and present(tree, *self.needs) and self.worth(tree)

    def laid_out(self, tree: DataTree) -> Chart:
        """The figure of a result."""
        return self.chart(tree, self.collect(tree))

    def columns(self, tree: DataTree) -> Columns:
        """The numbers of the figure."""
        return self.collect(tree).columns


ROWS = 4096
"""Rows that are written at a time: as text they take many times as much memory."""


def columns_text(columns: Columns) -> str:
    """Comma-separated text: a header ``quantity [unit]``, then one row per value, exact to the last bit.

    A missing number (NaN) is an empty field.
    """
    table = [np.asarray(column, dtype=float) for column in columns.values()]
    return csv_text(list(columns), []) + "".join(_pieces(table))


def _pieces(table: Sequence[NDArray[np.float64]]) -> Iterator[str]:
    """Rows of columns (n,), all of one length, some at a time."""
    for start in range(0, max(map(len, table)), ROWS):
        numbers = (column[start : start + ROWS].tolist() for column in table)
        written = (["" if number != number else repr(number) for number in column] for column in numbers)
        yield "".join(f"{','.join(row)}\n" for row in zip(*written, strict=True))


def write_columns(columns: Columns, path: Path) -> Path:
    """Write `columns` to the file at `path`, completely or not at all."""
    return write_bytes(path, columns_text(columns).encode("utf-8"))


FORMATS = ("svg", "pdf", "png")
NEAREST = 3
"""Names that a message about a wrong one tells."""


def figure_format(what: str, format: object) -> str:
    """Take a format of figures; `what` it is for the message."""
    if format not in FORMATS:
        raise InputError(what, shown(format), ", ".join(FORMATS))
    return str(format)


def chosen_parts(parts: Sequence[Part], names: Sequence[object]) -> list[Part]:
    """Figures by name or title, or by what only one title begins with; all where no name is given."""
    return list(dict.fromkeys(_chosen(parts, name) for name in names)) if names else list(parts)


def _chosen(parts: Sequence[Part], name: object) -> Part:
    asked = " ".join(str(name).lower().split())
    for part in parts:
        if asked in (part.name, part.title.lower()):
            return part
    begun = [part for part in parts if asked and part.title.lower().startswith(asked)]
    if len(begun) == 1:
        return begun[0]
    held = ", ".join(part.name for part in parts) or "it has none"
    near = ", ".join(f'"{part.name}" ({part.title})' for part in (begun or _nearest(parts, asked))[:NEAREST])
    remedy = f"Nearest: {near}." if near else ""
    raise InputError(
        "name of a figure", shown(name), f"a figure of this result, by name or title: {held}", remedy
    )


def _nearest(parts: Sequence[Part], asked: str) -> list[Part]:
    """Figures whose names or titles are like what was asked for, the most alike first."""

    def likeness(part: Part) -> float:
        told = (part.name, part.title.lower())
        return max(difflib.SequenceMatcher(None, asked[:100], word).ratio() for word in told)

    return sorted((part for part in parts if likeness(part) > 0.5), key=likeness, reverse=True)


def write_figures(tree: DataTree, parts: Sequence[Part], folder: Path, format: str) -> list[Path]:
    """Draw figures of a result to files of a folder, each under its name."""
    return [write_chart(part.laid_out(tree), "", folder / f"{part.name}.{format}") for part in parts]


def write_chart(chart: Chart, title: str, path: Path) -> Path:
    """Draw a chart to a file, whose ending says in which format."""
    from asperity.reporting.paper import draw, save_figure  # matplotlib, which nothing else needs

    figure = draw(chart, title)
    return atomic_write(path, lambda file: save_figure(figure, file, path.suffix[1:].lower()))
