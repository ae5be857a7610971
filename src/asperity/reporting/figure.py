"""A figure of the report, declared: which numbers of a result, how they are drawn, what is said of them."""

import dataclasses
import difflib
import re
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import product
from pathlib import Path
from typing import Any

import numpy as np
from xarray import DataTree

from asperity.arguments import shown
from asperity.errors import InputError
from asperity.files import atomic_write, write_bytes
from asperity.reporting import data
from asperity.reporting.chart import Chart, Numbers, Panel, envelope
from asperity.reporting.headline import Answers
from asperity.reporting.tables import ReportTable
from asperity.schema import Entry
from asperity.text_files import csv_text


@dataclass(frozen=True, eq=False)
class Series:
    """Numbers with a name and a unit: a line of a figure, and a column of its CSV file."""

    name: str
    units: str
    values: Numbers
    entry: Entry | None = None  # whose numbers these are
    label: str = ""  # what it is called where it is drawn
    places: Mapping[str, Any] = dataclasses.field(default_factory=dict)  # along dimensions told apart
    # of its line, where no law or sequence gives it: colour, dashes, width, marker
    look: tuple[Any, ...] = ()

    @property
    def law(self) -> str:
        """Its law, where laws are told apart."""
        return str(self.places.get("law", ""))

    @property
    def heading(self) -> str:
        """Of its column, as ``"areal [N^2/Hz]"``."""
        units = re.sub(r"(?<=[A-Za-z)])(\d)", r"^\1", self.units).replace("um", "µm").replace("uPa", "µPa")
        return f"{self.name} [{units}]"


@dataclass(frozen=True, eq=False)
class Of:
    """Series of a variable over its last dimension, one for each place along the others that has numbers.

    Those dimensions are told apart that `name` or `label` has in braces, as ``"{law}, x = {sensor:g} m"``. Of
    the others the first place with numbers is taken: the main law, the first contact; of those in `one` that
    which it picks among the places with numbers.
    """

    entry: Entry
    name: str = ""  # of the column; that of the variable by default
    label: str = ""  # in the figure; by default the name
    look: tuple[Any, ...] = ()  # of its lines: colour, dashes, width, marker
    optional: bool = False  # whether the figure goes without it
    one: Mapping[str, Callable[[list[int]], int]] = dataclasses.field(default_factory=dict)
    # what the places of a dimension are called, instead of by their coordinates
    called: Mapping[str, Callable[[DataTree], Sequence[str]]] = dataclasses.field(default_factory=dict)

    def __call__(self, tree: DataTree) -> Iterator[Series]:
        """Take them from a result; none where it lacks the variable."""
        if not data.present(tree, self.entry):
            return
        found, name = data.variable_of(tree, self.entry), self.name or self.entry.name
        dims = [str(dim) for dim in found.dims[:-1]]
        apart = {dim for dim in dims if f"{{{dim}" in name + self.label and dim not in self.one}
        places = {dim: data.with_numbers(found, dim) for dim in dims}
        places |= {dim: [self.one.get(dim, min)(places[dim])] for dim in places if dim not in apart}
        called = {dim: words(tree) for dim, words in self.called.items()}
        for index in product(*places.values()):
            at = dict(zip(places, index, strict=True))
            numbers = np.asarray(found.isel(at).values, dtype=float)
            if np.isfinite(numbers).any():
                place = {dim: found[dim].values[n].item() for dim, n in at.items()}
                words = place | {dim: each[at[dim]] for dim, each in called.items()}
                told = {dim: place[dim] for dim in apart}
                written, label = name.format(**words), (self.label or name).format(**words)
                yield Series(written, self.entry.units, numbers, self.entry, label, told, self.look)


@dataclass(frozen=True, eq=False)
class Lines:
    """Numbers of a figure, collected once: it is drawn from them, and its CSV file holds them."""

    x: Series | None  # what they stand over
    lines: Sequence[Series]

    def of(self, *entries: Entry, **places: Any) -> list[Series]:
        """Those of some variables, at some places of them."""
        return [s for s in self.lines if s.entry in entries and places.items() <= s.places.items()]

    @property
    def at(self) -> Numbers:
        """What the lines are drawn over."""
        assert self.x is not None
        return self.x.values

    @property
    def columns(self) -> dict[str, Numbers]:
        """Of the CSV file: ``"quantity [unit]"`` → numbers, all of one length, in SI units."""
        first = [] if self.x is None else [self.x]
        return {series.heading: series.values for series in (*first, *self.lines)}


Columns = Callable[[DataTree], Iterable[Series]]
"""Takes columns of a figure from a result: an `Of`, or a function."""


def field(entry: Entry, across: Entry, symbol: str) -> Columns:
    """Columns of a variable over a plane: one for each place across."""

    def columns(tree: DataTree) -> Iterator[Series]:
        rows = zip(data.values(tree, across).tolist(), data.values(tree, entry).T, strict=True)
        for place, numbers in rows:
            yield Series(f"{symbol}(y={place:.9g} m)", entry.units, numbers)

    return columns


def starts(of: Of, count: int) -> Columns:
    """Column of where stretches begin in which a long line is told by its `extremes`."""

    def columns(tree: DataTree) -> Iterator[Series]:
        for series in of(tree):
            yield replace(series, values=series.values[envelope(series.values, count)[0]])

    return columns


def extremes(of: Of, count: int) -> Columns:
    """Columns of the lowest and the highest number of lines in each of so many stretches."""

    def columns(tree: DataTree) -> Iterator[Series]:
        for series in of(tree):
            for end, numbers in zip(("lowest", "highest"), envelope(series.values, count)[1:], strict=True):
                yield Series(f"{series.name} {end}", series.units, numbers)

    return columns


@dataclass(frozen=True, eq=False)
class Figure:
    """A figure of the report: a page draws it, its CSV file holds its columns."""

    name: str  # of its CSV file and of its place in the page
    title: str  # its heading
    over: Columns | None  # one series, which the others stand over
    columns: Sequence[Columns]
    draw: Callable[[DataTree, Lines], Chart | Iterable[Panel]]  # lays its columns out
    caption: str | Callable[[DataTree], str]  # says what is drawn and with which conventions
    further: tuple[Entry, ...] = ()  # variables without which it is left out, beside those of its columns
    any_of: tuple[Entry, ...] = ()  # variables of which it needs at least one, and of its columns no other
    # whether these variables have anything to show: a smooth surface has no spectrum
    worth: Callable[[DataTree], bool] = lambda _: True
    rows: Callable[[DataTree], slice] = lambda _: slice(None)  # of all columns

    @property
    def needs(self) -> tuple[Entry, ...]:
        """Variables without which it is left out."""
        columns = (self.over,) if self.any_of else (*self.columns, self.over)
        held = (each.entry for each in columns if isinstance(each, Of) and not each.optional)
        return (*held, *self.further)

    def drawable(self, tree: DataTree) -> bool:
        """Whether `tree` holds what the figure needs."""
        some = not self.any_of or any(data.present(tree, entry) for entry in self.any_of)
        return some and data.present(tree, *self.needs) and self.worth(tree)

    def collect(self, tree: DataTree) -> Lines:
        """Take its numbers from a result."""
        rows, taken = self.rows(tree), [each for each in (self.over, *self.columns) if each]
        found = [replace(one, values=one.values[rows]) for each in taken for one in each(tree)]
        return Lines(found[0], found[1:]) if self.over else Lines(None, found)

    def chart(self, tree: DataTree, lines: Lines) -> Chart:
        """Lay them out."""
        drawn = self.draw(tree, lines)
        return drawn if isinstance(drawn, Chart) else Chart(tuple(drawn))

    def laid_out(self, tree: DataTree) -> Chart:
        """The figure of a result."""
        return self.chart(tree, self.collect(tree))

    def said(self, tree: DataTree) -> str:
        """Caption, and what is missing and why."""
        caption = self.caption if isinstance(self.caption, str) else self.caption(tree)
        return f"{caption} {data.missing(tree, *self.needs, *self.any_of)}".strip()


@dataclass(frozen=True)
class Chapter:
    """What a chapter of the report can hold: its figures, then its tables."""

    name: str
    title: str
    figures: tuple[Figure, ...]
    tables: tuple[Callable[[DataTree], ReportTable | None], ...] = ()
    answers: Callable[[DataTree], Answers | None] | None = None  # what the top of the page says of it


def columns_text(columns: Mapping[str, Numbers]) -> str:
    """Comma-separated text: a header ``quantity [unit]``, then one row per value, exact to the last bit.

    A missing number (NaN) is an empty field.
    """
    table = [np.asarray(column, dtype=float).tolist() for column in columns.values()]
    fields = ([repr(number) if number == number else "" for number in column] for column in table)
    return csv_text(list(columns), []) + "".join(f"{','.join(row)}\n" for row in zip(*fields, strict=True))


def write_columns(columns: Mapping[str, Numbers], path: Path) -> Path:
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


def chosen_figures(figures: Sequence[Figure], names: Sequence[object]) -> list[Figure]:
    """Figures by name or title, or by what only one title begins with; all where no name is given."""
    return list(dict.fromkeys(_chosen(figures, name) for name in names)) if names else list(figures)


def _chosen(figures: Sequence[Figure], name: object) -> Figure:
    asked = " ".join(str(name).lower().split())
    known = {word: figure for figure in figures for word in (figure.title.lower(), figure.name)}
    begun = [figure for figure in figures if asked and figure.title.lower().startswith(asked)]
    if asked in known or len(begun) == 1:
        return known.get(asked) or begun[0]
    held = ", ".join(figure.name for figure in figures) or "it has none"
    alike = difflib.get_close_matches(asked[:100], known, n=len(known) or 1, cutoff=0.5)
    nearest = begun or list(dict.fromkeys(known[word] for word in alike))
    near = ", ".join(f'"{figure.name}" ({figure.title})' for figure in nearest[:NEAREST])
    allowed = f"a figure of this result, by name or title: {held}"
    raise InputError("name of a figure", shown(name), allowed, f"Nearest: {near}." if near else "")


def write_figures(tree: DataTree, figures: Sequence[Figure], folder: Path, format: str) -> list[Path]:
    """Draw figures of a result to files of a folder, each under its name."""
    return [write_chart(figure.laid_out(tree), "", folder / f"{figure.name}.{format}") for figure in figures]


def write_chart(chart: Chart, title: str, path: Path) -> Path:
    """Draw a chart to a file, whose ending says in which format."""
    from asperity.reporting.paper import draw, save_figure  # matplotlib, which nothing else needs

    figure = draw(chart, title)
    return atomic_write(path, lambda file: save_figure(figure, file, path.suffix[1:].lower()))
