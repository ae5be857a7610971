"""What was measured, from files: with a line for each place of an axis, or a measurement in each line."""

import re
import shlex
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import replace
from itertools import groupby
from pathlib import Path
from typing import Any

import numpy as np

from asperity.arguments import Array, Flags, NDArray, listed, nearest, one_of, require, shown
from asperity.case.any_case import AnyCase, entry_of
from asperity.case.form import content
from asperity.case.table_headings import WIDE, are_words
from asperity.case.tables import LARGEST_TABLE, TableSource
from asperity.errors import InputError
from asperity.observables import BUILT_IN, decay_rates, observable
from asperity.observables.observable import Measured, Observable
from asperity.parameters import FROM_PYTHON
from asperity.spectra import a_weighting, third_octave_numbers
from asperity.text_files import lines_of_cells, number_in, read_text, refuse_decimal_commas
from asperity.units import quantity, unit_in, unit_in_brackets
from asperity.written_numbers import count_of, in_a_row, with_article

MOST_RECORDS = 1000
"""Measurements of one file."""
HEADING = 10
"""Lines of a file among which the heading of a wide table is sought."""
_DIRECTION = "direction"
DIRECTIONS = {"vertical": decay_rates.VERTICAL, "lateral": decay_rates.LATERAL}
"""Words of such a column, and what was measured."""


def read_measured(
    case: AnyCase, path: Path, where: Mapping[str, str], what: str | None
) -> tuple[list[Measured], list[str]]:
    """Measurements in a file for a case, of a wide table those alone `where` its columns hold some words.

    Returns with them the titles of such columns. What they are is told by the heading, else by
    the name of the file, unless `what` says it. Columns that are called as keys of the case are conditions.
    """
    allowed = "a table of what was measured, with units in its heading"
    text = read_text(path, path.name, allowed, largest=LARGEST_TABLE, latin=True)
    refuse_decimal_commas(text, path.name)
    table = list(lines_of_cells(text))
    for number, (_, cells) in enumerate(table[:HEADING]):
        if (places := _axis_in(cells)) is not None and are_words(cells):
            rows = [cells for _, cells in table[number + 1 :]]
            return _wide(case, path, cells, places, rows, where, what)
    heading = " ".join(text.splitlines()[:HEADING])
    of = _recognised(path, heading, what, [each for each in BUILT_IN.values() if each.read is not None])
    assert of.read is not None
    return of.read(path), []


def _recognised(path: Path, heading: str, what: str | None, known: Sequence[Observable]) -> Observable:
    """What a table holds, as somebody says, else its heading, else the name of the file."""
    if what is not None:
        return observable(what)
    for text in (heading, re.sub(r"[_.-]", " ", path.stem)):
        for each in known:
            if each.is_told(text):
                return each
    allowed = "a table of " + ", ".join(BUILT_IN)
    remedy = 'Name it in the heading, with its unit, or say what it is: --as "vertical decay rate".'
    raise InputError(path.name, "a heading that does not tell what was measured", allowed, remedy)


# --- a measurement in each line


def _axis_in(cells: Sequence[str]) -> dict[int, float] | None:
    """Columns of a heading that are frequencies, Hz, by their numbers; None where they are too few.

    With their unit, or as bare numbers in which one third-octave follows the other.
    """
    found = {}
    bare = {}
    for number, cell in enumerate(cells):
        try:
            if unit_in(cell):
                found[number] = quantity(cell.replace(",", "."), "Hz")
            else:
                bare[number] = number_in(cell)
        except (InputError, ValueError):
            continue
    if len(found) > WIDE:
        return found
    return bare if len(bare) > WIDE and _follow(np.array(list(bare.values()))) else None


def _follow(values: Array) -> bool:
    """Whether values (n,) are centres of one-third octaves that follow one another, Hz."""
    if values.min() <= 0.0:
        return False
    numbers, off = _numbered(values)
    return bool((np.diff(numbers) == 1.0).all() and not off.any())


def _numbered(at: Array) -> tuple[Array, Flags]:
    """Numbers of the one-third octaves nearest to frequencies (n,), Hz, and which are centres of none."""
    numbers = third_octave_numbers(at)
    return numbers, np.abs(10.0 * np.log10(at) - numbers) > 0.06


def _wide(
    case: AnyCase,
    path: Path,
    heading: list[str],
    places: dict[int, float],
    rows: list[list[str]],
    where: Mapping[str, str],
    what: str | None,
) -> tuple[list[Measured], list[str]]:
    labels = {number: title for number, title in enumerate(heading) if number not in places}
    names = {_plain(title): title for title in labels.values()}
    asked = {name: value for name, value in where.items() if _plain(name) in names}
    kept = [row for row in rows if _fits(row, labels, asked)]
    if not kept:
        raise _no_line(path, labels, rows, asked)
    require(len(kept) <= MOST_RECORDS, path.name, count_of(len(kept), "line"), f"at most {MOST_RECORDS}")
    words = " ".join(labels.values())
    of = _recognised(path, words, what, list(BUILT_IN.values()))
    weighted = any("(A)" in unit_in_brackets(f"[{title}]") or "dB(A)" in title for title in labels.values())
    found = [_record(case, path, row, labels, places, of, weighted=weighted) for row in kept]
    return [each for each in found if each is not None], list(labels.values())


def _no_line(
    path: Path, labels: Mapping[int, str], rows: Sequence[Sequence[str]], asked: Mapping[str, str]
) -> InputError:
    """Error about a table of which no line is as asked for: what the last of these columns holds."""
    if not asked:
        return InputError(path.name, "no line below its heading", "a measurement in each line")
    told = " and ".join(f"{name}={value}" for name, value in asked.items())
    name = list(asked)[-1]
    column = next(number for number, title in labels.items() if _plain(title) == _plain(name))
    held = list(dict.fromkeys(_cell(row, column) for row in rows))
    return InputError(path.name, f"no line where {told}", f"{name}: {listed(held)}")


def _plain(title: str) -> str:
    """A title without its unit, in small letters."""
    return re.sub(r"[(\[].*", "", title).strip().lower()


def _cell(row: Sequence[str], number: int) -> str:
    return row[number] if number < len(row) else ""


def _fits(row: Sequence[str], labels: Mapping[int, str], where: Mapping[str, str]) -> bool:
    """Whether a line holds what is asked for; several words, with commas, mean any of them."""
    plain = {_plain(title): number for number, title in labels.items()}
    for name, wanted in where.items():
        held = _cell(row, plain[_plain(name)])
        if not any(_same(held, each.strip()) for each in wanted.split(",")):
            return False
    return True


def _same(held: str, wanted: str) -> bool:
    if held.lower() == wanted.lower():
        return True
    try:
        return number_in(held) == number_in(wanted)
    except ValueError:
        return False


def _record(
    case: AnyCase,
    path: Path,
    row: Sequence[str],
    labels: Mapping[int, str],
    places: Mapping[int, float],
    of: Observable,
    *,
    weighted: bool,
) -> Measured | None:
    """One line as a measurement; None of one without any number."""
    values = {}
    for number, frequency in places.items():
        if cell := _cell(row, number):
            try:
                values[frequency] = number_in(cell)
            except ValueError:
                raise InputError(
                    path.name, f"{shown(cell)} below {frequency:g} Hz", "a number, or nothing"
                ) from None
    if not values:
        return None
    at = np.array(sorted(values))
    held = np.array([values[frequency] for frequency in at])
    centres = _centres(path, at)
    every = {title: _cell(row, number) for number, title in labels.items()}
    told = {title: cell for title, cell in every.items() if cell}
    direction = _direction_in(told)
    if of.name in DIRECTIONS.values() and direction:
        of = observable(DIRECTIONS[one_of(f"direction in {path.name}", direction.lower(), DIRECTIONS)])
    if of.decade and (held <= 0.0).any():
        raise InputError(path.name, f"{with_article(of.name)} of {held[held <= 0.0][0]:g}", "greater than 0")
    held = held - a_weighting(centres) if weighted and of.units.startswith("dB re 20") else held
    conditions = conditions_of(case, told)
    said = {title: (cell,) for title, cell in every.items()}
    return Measured(of.name, centres, held, conditions=conditions, source=path.name, labels=said)


def _direction_in(told: Mapping[str, str]) -> str:
    """The word of the column that is called so, else one that says it in any; empty without one."""
    named = [each for title, each in told.items() if _plain(title) == _DIRECTION]
    said = [each for each in told.values() if each.lower() in DIRECTIONS]
    return next(iter([*named, *said]), "")


def _centres(path: Path, at: Array) -> Array:
    """Exact centres of one-third octaves by nominal ones, Hz."""
    numbers, off = _numbered(at)
    if off.any() or (np.diff(numbers) == 0).any():
        wrong = at[off][0] if off.any() else at[0]
        raise InputError(path.name, f"a column of {wrong:g} Hz", "centres of one-third octaves, each once")
    return 10.0 ** (0.1 * numbers)


# --- as a fit takes them


def conditions_of(case: AnyCase, labels: Mapping[str, str]) -> dict[str, Any]:
    """Labels of a measurement that are keys of a case with a unit, as ``speed (km/h)``, in SI."""
    found = {}
    for title, value in labels.items():
        try:
            entry = entry_of(type(case), _plain(title))
        except InputError:
            continue  # a label that is no key
        unit = unit_in_brackets(title)
        if entry.unit is not None and (unit or entry.unit == "1"):
            found[entry.dotted] = entry.read(f"{value} {unit}" if unit else number_in(value), FROM_PYTHON)
    return found


def combined(found: Sequence[Measured]) -> list[Measured]:
    """Repeated measurements of one quantity under the same conditions as their mean, with its uncertainty.

    Of values with decades the mean is that of their logarithms. Its standard deviation is that of the values
    about it over the root of their number, taken together over three to seven places of the axis.
    """

    def key(each: Measured) -> str:
        return repr((each.what, sorted(content(each.conditions).items()), each.places))

    ordered = sorted(found, key=key)  # stable: first come first
    groups = {name: list(group) for name, group in groupby(ordered, key)}
    wanted = dict.fromkeys(map(key, found))
    return [_mean(groups[name]) for name in wanted]


def _mean(group: Sequence[Measured]) -> Measured:
    if len(group) == 1:
        return group[0]
    of = observable(group[0].what)
    every = np.unique(np.concatenate([each.at for each in group]))
    held = _side_by_side(group, every)
    times = np.isfinite(held).sum(axis=0)
    about = np.nansum(held, axis=0) if of.decade else np.nanmean(held, axis=0)  # of a phase that may turn
    scale = of.decade / np.log(10.0) if of.decade else 1.0
    level = scale * np.log(held / about) if of.decade else held - about
    mean = np.nanmean(level, axis=0)
    deviation = _pooled(np.nansum(np.abs(level - mean) ** 2, axis=0), times)
    return replace(
        group[0],
        at=every,
        values=about * np.exp(mean / scale) if of.decade else about,
        uncertainty=None if deviation is None else deviation / np.sqrt(times),
        source=", ".join(dict.fromkeys(each.source for each in group)),
        records=len(group),
        labels=_labels_of(group),
    )


def _labels_of(group: Sequence[Measured]) -> dict[str, tuple[str, ...]]:
    """What columns say of any of these, each word once."""
    found: dict[str, dict[str, None]] = {}
    for each in group:
        for title, words in each.labels.items():
            found.setdefault(title, {}).update(dict.fromkeys(words))
    return {title: tuple(words) for title, words in found.items()}


MOST_COLUMNS = 4
"""Columns that are named in a sentence."""


def told_repeats(measured: Measured) -> str:
    """In which columns measurements differ that are taken as repeats, and how to choose; else empty."""
    if not (differ := measured.differing):
        return ""
    shown_columns = dict(list(differ.items())[:MOST_COLUMNS])
    named = [_column(title, words) for title, words in shown_columns.items()]
    if more := len(differ) - len(named):
        named.append(count_of(more, "more column"))
    title, words = next(iter(differ.items()))
    chosen = f"{_plain(title)}={next(word for word in words if word)}"
    return (
        f"{measured.records} measurements of the {measured.what} in {measured.source} are taken as repeats "
        f"of one, though they differ in {in_a_row(named)}: choose some of them, as with --where "
        f"{shlex.quote(chosen)}."
    )


def _column(title: str, words: Sequence[str]) -> str:
    """A column, and two of the words that it says."""
    said = ", ".join(word or "nothing" for word in words[:2])
    return f"{_plain(title)} ({said}{', …' if len(words) > 2 else ''})"


def _side_by_side(group: Sequence[Measured], every: Array) -> NDArray[np.inexact]:
    """Values of measurements at all places (m, n), NaN without one; magnitudes unless all have phases."""
    whole = all(np.iscomplexobj(each.values) for each in group)
    some = any(np.iscomplexobj(each.values) for each in group)
    held = np.full((len(group), len(every)), np.nan, dtype=complex if whole else float)
    for row, each in zip(held, group, strict=True):
        row[np.searchsorted(every, each.at)] = np.abs(each.values) if some and not whole else each.values
    return held


LEAST_SCATTER = 0.2
"""Of repeated measurements, dB: levels are read to a tenth."""


FREEDOM = 7
"""Degrees of freedom of a standard deviation that is read from repeats, where neighbours have them."""
NEIGHBOURS = 3
"""Places on either side that are taken together at most."""


def _pooled(square: Array, times: NDArray[np.int_]) -> Array | None:
    """Standard deviation at each place (n,), of squares over it and its neighbours; None without repeats.

    As few neighbours as have `FREEDOM` together: of fewer it is too uncertain to weigh what was measured.
    """
    freedom = np.maximum(times - 1, 0).astype(float)
    if not freedom.any():
        return None
    near = _with_neighbours(square, 1)
    known = _with_neighbours(freedom, 1)
    for reach in range(2, NEIGHBOURS + 1):
        wider = known < FREEDOM
        near = np.where(wider, _with_neighbours(square, reach), near)
        known = np.where(wider, _with_neighbours(freedom, reach), known)
    whole = square.sum() / freedom.sum()
    return np.maximum(np.sqrt(np.where(known > 0.0, near / np.maximum(known, 1.0), whole)), LEAST_SCATTER)


def _with_neighbours(values: Array, reach: int) -> Array:
    """Sums of each value (n,) and so many on either side."""
    return np.convolve(values, np.ones(2 * reach + 1))[reach : reach + len(values)]


def beside(case: AnyCase) -> list[Measured]:
    """What the case itself says was measured."""
    of_track = [
        each
        for of in BUILT_IN.values()
        if of.read is not None
        for title, table in _named(case, of)
        if title != MEASURED
        for each in of.read(table)
    ]
    return [*of_track, *tables_beside(case)]


def _named(case: AnyCase, of: Observable) -> Iterator[tuple[str, TableSource]]:
    """Tables of a quantity that a case names, each with the section in which it does."""
    for key in of.keys:
        title, _, name = key.partition(".")
        table = getattr(getattr(case, title, None), name, None)
        if table is not None:
            yield title, table


MEASURED = "measured"
"""Section of a case that names tables beside which its report states what was computed."""


def tables_beside(case: AnyCase) -> list[Measured]:
    """What tables hold that this section of a case names; an `InputError` tells what it cannot have."""
    found = []
    for of in BUILT_IN.values():
        for title, table in _named(case, of):
            if title == MEASURED and isinstance(table, Path):
                if lacks := of.lacks(case):
                    raise InputError(of.keys[-1], f"a case with {lacks}", "what the case can predict")
                found += read_measured(case, table, {}, of.name)[0]
    return found


def read_where(words: Iterable[str]) -> dict[str, str]:
    """Columns and what they shall hold, as ``"section=B5"``."""
    found: dict[str, str] = {}
    for each in words:
        name, sign, value = (part.strip() for part in each.partition("="))
        require(name and sign and value, "where", shown(each), "a column and what it holds, as section=B5")
        require(name not in found, "where", shown(each), "each column once", f"Write {name}=one,other.")
        found[name] = value
    return found


def refuse_unfound(where: Mapping[str, str], titles: Iterable[str]) -> None:
    """Refuse a column that no file has, of those with titles."""
    known = list(dict.fromkeys(map(_plain, titles)))
    for name in where:
        if _plain(name) not in known:
            allowed = (
                f"a column of a file: {listed(known)}" if known else "a file with a measurement in each line"
            )
            raise InputError("where", f"the column {shown(name)}", allowed, nearest(_plain(name), known))
