"""A figure of the report, declared: which numbers of a result, how they are drawn, what is said of them."""

import dataclasses
import re
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import product
from pathlib import Path
from typing import Any

import numpy as np
from xarray import DataTree

from asperity.arguments import Array, nearest, shown
from asperity.errors import InputError
from asperity.files import atomic_write, write_bytes
from asperity.reporting import data
from asperity.reporting.chart import Chart, Panel, envelope
from asperity.reporting.headline import Answers
from asperity.reporting.tables import ReportTable, chart_tables, numbers_table
from asperity.schema import Entry
from asperity.text_files import csv_text


@dataclass(frozen=True, eq=False)
class Series:
    """Numbers with a name and a unit: a line of a figure, and a column of its CSV file."""

    name: str
    units: str
    values: Array
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
    def is_total(self) -> bool:
        """Whether it is the sum of others."""
        return any(str(place).startswith("total") for place in self.places.values())

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
        """Take them from a result; none of an optional variable that it lacks."""
        if self.optional and not data.present(tree, self.entry):
            return
        found = data.variable_of(tree, self.entry)
        name = self.name or self.entry.name
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
                written = name.format(**words)
                label = (self.label or name).format(**words)
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
    def at(self) -> Array:
        """What the lines are drawn over."""
        assert self.x is not None
        return self.x.values

    def columns(self, stretches: int = 0) -> dict[str, Array]:
        """Of the CSV file: ``"quantity [unit]"`` → numbers, all of one length, in SI units.

        Of long lines, if asked, where each of so many stretches begins, and its lowest and highest number.
        """
        first = [] if self.x is None else [self.x]
        lines = list(self.lines)
        if stretches:
            first = [replace(x, values=x.values[envelope(x.values, stretches)[0]]) for x in first]
            lines = [
                replace(line, name=f"{line.name} {end}", values=numbers)
                for line in self.lines
                for end, numbers in zip(
                    ("lowest", "highest"), envelope(line.values, stretches)[1:], strict=True
                )
            ]
        return {series.heading: series.values for series in (*first, *lines)}


Columns = Callable[[DataTree], Iterable[Series]]
"""Takes columns of a figure from a result: an `Of`, or a function."""


def field(entry: Entry, across: Entry, symbol: str) -> Columns:
    """Columns of a variable over a plane: one for each place across."""

    def columns(tree: DataTree) -> Iterator[Series]:
        rows = zip(data.values(tree, across).tolist(), data.values(tree, entry).T, strict=True)
        for place, numbers in rows:
            yield Series(f"{symbol}(y={place:.9g} m)", entry.units, numbers)

    return columns


@dataclass(frozen=True, eq=False)
class PageFigure:
    """A figure as it is shown: what is drawn and said, and the columns of its CSV file."""

    name: str
    title: str
    caption: str
    chart: Chart
    file: str = ""  # with its numbers, beside the page
    columns: Mapping[str, Array] = dataclasses.field(default_factory=dict)  # of that file
    foremost: Sequence[str] = ()  # heads of the columns that are read first

    @classmethod
    def of(cls, name: str, title: str, parts: Iterable[Panel | str], *file: Any) -> "PageFigure":
        """Panels together, and sentences as a caption; `file` and `columns` follow where there are any."""
        found = list(parts)
        caption = " ".join(filter(None, (each.strip() for each in found if isinstance(each, str))))
        chart = Chart(tuple(each for each in found if isinstance(each, Panel)))
        return cls(name, title, caption, chart, *file)

    @property
    def numbers(self) -> list[ReportTable]:
        """Tables that are shown where no script runs."""
        return [numbers_table(self.columns, self.foremost)] if self.columns else chart_tables(self.chart)


Draw = Callable[[DataTree, Lines], Iterable[Panel | str]]
"""Lays out the lines of a figure in panels, and says in sentences what is drawn, by which conventions."""


@dataclass(frozen=True, eq=False)
class Figure:
    """A figure of the report: its columns, which a CSV file holds, and how they are drawn."""

    name: str  # of its CSV file and of its place in the page
    title: str  # its heading
    over: Columns | None  # one series, which the others stand over
    columns: Sequence[Columns]
    draw: Draw
    rows: Callable[[DataTree], slice] = lambda _: slice(None)  # of all columns
    stretches: int = 0  # of long lines, of which the CSV file holds the extremes

    @property
    def needs(self) -> list[Entry]:
        """Variables without which it is left out, as far as its columns tell."""
        columns = (each for each in (self.over, *self.columns) if isinstance(each, Of))
        return [each.entry for each in columns if not each.optional]

    def collect(self, tree: DataTree) -> Lines:
        """Take its numbers from a result."""
        rows = self.rows(tree)
        taken = [each for each in (self.over, *self.columns) if each]
        found = [replace(one, values=one.values[rows]) for each in taken for one in each(tree)]
        return Lines(found[0], found[1:]) if self.over else Lines(None, found)

    def drawn(self, tree: DataTree) -> PageFigure:
        """The figure of a result; `data.Missing` where this lacks what it takes, or has nothing to show."""
        lines = self.collect(tree)
        parts = [*self.draw(tree, lines), data.missing(tree, *self.needs)]
        if not any(isinstance(each, Panel) for each in parts):
            raise data.Missing(self.name)
        main = next(iter(data.law_entries(tree)), None)
        of_main = sorted(
            (each for each in lines.lines if each.law == main), key=lambda each: not each.is_total
        )
        file = f"{self.name}.csv", lines.columns(self.stretches), [each.heading for each in of_main]
        return PageFigure.of(self.name, self.title, parts, *file)


def figure(title: str, over: Columns | None, *columns: Columns, **how: Any) -> Callable[[Draw], Figure]:
    """Declare a figure by the function that lays it out, whose name it has.

    Parameters
    ----------
    title : str
        Its heading.
    over : Columns or None
        One series, which the others stand over.
    *columns : Columns
        The others.
    **how
        `rows` or `stretches` of a `Figure`.
    """
    return lambda draw: Figure(draw.__name__, title, over, columns, draw, **how)


@dataclass(frozen=True)
class Chapter:
    """What a chapter of the report can hold: its figures, then its tables."""

    name: str
    title: str
    figures: tuple[Figure, ...]
    tables: tuple[Callable[[DataTree], ReportTable | None], ...] = ()
    answers: Callable[[DataTree], Answers | None] | None = None  # what the top of the page says of it


def columns_text(columns: Mapping[str, Array]) -> str:
    """Comma-separated text: a header ``quantity [unit]``, then one row per value, exact to the last bit.

    A missing number (NaN) is an empty field.
    """
    table = [np.asarray(column, dtype=float).tolist() for column in columns.values()]
    fields = ([repr(number) if number == number else "" for number in column] for column in table)
    return csv_text(list(columns), []) + "".join(f"{','.join(row)}\n" for row in zip(*fields, strict=True))


def write_columns(columns: Mapping[str, Array], path: Path) -> Path:
    """Write `columns` to the file at `path`, completely or not at all."""
    return write_bytes(path, columns_text(columns).encode("utf-8"))


FORMATS = ("svg", "pdf", "png")


def figure_format(what: str, format: object) -> str:
    """Take a format of figures; `what` it is for the message."""
    if format not in FORMATS:
        raise InputError(what, shown(format), ", ".join(FORMATS))
    return str(format)


def chosen_figures(figures: Sequence[PageFigure], names: Sequence[object]) -> list[PageFigure]:
    """Figures by name or title, or by what only one title begins with; all where no name is given."""
    return list(dict.fromkeys(_chosen(figures, name) for name in names)) if names else list(figures)


def _chosen(figures: Sequence[PageFigure], name: object) -> PageFigure:
    asked = " ".join(str(name).lower().split())
    known = {word: figure for figure in figures for word in (figure.title.lower(), figure.name)}
    begun = [figure for figure in figures if asked and figure.title.lower().startswith(asked)]
    if asked in known or len(begun) == 1:
        return known.get(asked) or begun[0]
    held = ", ".join(figure.name for figure in figures) or "it has none"
    allowed = f"a figure of this result, by name or title: {held}"
    several = f"Say which: {', '.join(figure.name for figure in begun)}." if begun else ""
    raise InputError("name of a figure", shown(name), allowed, several or nearest(asked, list(known)))


def write_figures(figures: Sequence[PageFigure], folder: Path, format: str) -> list[Path]:
    """Draw figures to files of a folder, each under its name."""
    return [write_chart(figure.chart, "", folder / f"{figure.name}.{format}") for figure in figures]


def write_chart(chart: Chart, title: str, path: Path) -> Path:
    """Draw a chart to a file, whose ending says in which format."""
    from asperity.reporting.paper import draw, save_figure  # matplotlib, which nothing else needs

    figure = draw(chart, title)
    return atomic_write(path, lambda file: save_figure(figure, file, path.suffix[1:].lower()))
