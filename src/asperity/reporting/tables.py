"""Tables of a page, declared by their columns; those that all kinds share; how sure a result is."""

import re
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from functools import partial
from itertools import repeat
from typing import Any

import numpy as np
from xarray import DataTree

from asperity.arguments import Array, Flags
from asperity.reporting import chart, data
from asperity.schema import Attribute, Entry, contact, convergence, provenance, rolling, spectra
from asperity.spectra import nominal_frequency, say_little


@dataclass(frozen=True)
class Cell:
    """One field of a table: its text, and a class for its look."""

    text: str
    look: str = ""


@dataclass(frozen=True)
class ReportTable:
    """A table of the page: its name, heading, column heads, rows of cells and a note."""

    name: str
    title: str
    head: list[str]
    rows: list[list[Cell]] = field(default_factory=list)
    note: str = ""


def table(name: str, title: str, columns: Mapping[str, Sequence[Cell]], note: str = "") -> ReportTable:
    """Lay out columns by their heads, all of one length."""
    rows = [list(row) for row in zip(*columns.values(), strict=True)]
    return ReportTable(name, title, list(columns), rows, note)


def text_cells(found: Iterable[object], look: str = "") -> list[Cell]:
    """Column of words."""
    return [Cell(str(word), look) for word in found]


Writer = Callable[[float], str]


def number_cells(
    found: Iterable[float], write: str | Writer, look: str | Iterable[str] = "number"
) -> list[Cell]:
    """Column of numbers in a unit, ``"m/s²"``, in a format, ``"{:.1f}"``, or as a function writes them.

    A dash stands where there is none. All have one look, or each its own.
    """
    how = partial(data.engineering, unit=write) if isinstance(write, str) and "{" not in write else write
    told = (lambda each: how.format(each).replace("-", "−")) if isinstance(how, str) else how
    looks = repeat(look) if isinstance(look, str) else look
    cells = zip(found, looks, strict=False)
    return [Cell(told(float(each)) if np.isfinite(each) else "–", own) for each, own in cells]


def band_cells(bands: Iterable[float], doubtful: Flags) -> list[Cell]:
    """Column of one-third octaves, in grey where they say little."""
    return number_cells(
        bands, data.nominal_band, ["number faint" if doubt else "number" for doubt in doubtful]
    )


def change_cells(
    changes: Array, doubtful: Flags, off: float = 1.0, far: float = 3.0, places: int = 1
) -> list[Cell]:
    """Column of level differences, shaded above two sizes; in grey and in brackets where they say little."""

    def cell(change: float, doubt: bool) -> Cell:
        if not np.isfinite(change):
            return Cell("–", "number")
        if doubt:
            return Cell(f"({data.signed(change)})", "number faint")
        return Cell(data.signed(change, places), "number" + size_look(change, off, far))

    return [cell(float(change), bool(doubt)) for change, doubt in zip(changes, doubtful, strict=True)]


def size_look(change: float, off: float, far: float) -> str:
    """Look of a change by its size; a blank comes first."""
    return " far" if abs(change) > far else " off" if abs(change) > off else ""


def listed_table(
    tree: DataTree, attribute: Attribute, titles: tuple[str, str], columns: Mapping[str, Any], note: str
) -> ReportTable | None:
    """Lay out a list in an attribute of a result: of each column the key, or how its cell is made."""
    found = data.json_list(tree, attribute)
    cells = {
        head: [Cell(str(each.get(how, ""))) if isinstance(how, str) else how(each) for each in found]
        for head, how in columns.items()
    }
    return table(*titles, cells, note) if found else None


# --- numbers of figures, for where they are not drawn

SMALL = 1e-2
"""Lengths, m, that are not read well in metres."""
COLUMNS, ROWS = 12, 24
"""Of a table of numbers; the CSV file has all."""


def in_digits(count: int) -> Writer:
    """Writes numbers with so many digits."""
    return partial(data.plain, digits=count)


def numbers_table(columns: Mapping[str, Array], foremost: Sequence[str] = ()) -> ReportTable:
    """Numbers of a figure by the heads of its CSV file; of many the first, the `foremost`, and some."""
    count = len(next(iter(columns.values())))
    heads = list(columns)
    kept = list(dict.fromkeys([heads[0], *(head for head in foremost if head in columns)]))[:COLUMNS]
    others = [head for head in heads if head not in kept]
    kept += [others[n] for n in chart.spread(len(others), COLUMNS - len(kept))] if len(kept) < COLUMNS else []
    rows = chart.spread(count, ROWS)
    named = sorted(kept, key=heads.index)
    shown = {head: _unrounded(columns[head])[rows] for head in named}
    counts = {"rows": (len(rows), count), "columns": (len(named), len(columns))}
    parts = [f"{some} of {every} {what}" for what, (some, every) in counts.items() if some < every]
    note = f"{' and '.join(parts)}; the CSV file has all." if parts else ""
    cells = {_read_well(name): number_cells(numbers, in_digits(4)) for name, numbers in shown.items()}
    return table("", "Numbers", cells, note)


def _unrounded(numbers: Array) -> Array:
    """A column with zeros where rounding beside its largest number left something else."""
    if numbers.dtype.kind != "f" or not numbers.size:
        return numbers
    size = np.abs(numbers)
    largest = float(np.max(size, where=np.isfinite(size), initial=0.0))
    return np.where(size < np.finfo(float).eps * largest, 0.0, numbers)


def _read_well(head: str) -> str:
    """Head of a column of a CSV file with its small lengths in their units: ``"p(y=−80.0 µm) [Pa]"``."""

    def length(found: re.Match[str]) -> str:
        metres = float(found[1])
        return f"={data.engineering(metres, 'm')}" if abs(metres) < SMALL else found[0]

    return re.sub(r"=(-?\d[\d.]*(?:e-?\d+)?) m\b", length, head)


def chart_tables(drawn: chart.Chart) -> list[ReportTable]:
    """A table for each axis along which lines of a chart have the same places: a row for each place."""
    along: dict[bytes, dict[str, list[Cell]]] = {}
    for panel in drawn.panels:
        names = dict(panel.x.ticks)
        for mark in panel.marks:
            if isinstance(mark, chart.Line) and mark.label:
                places = [names.get(place) or data.plain(place) for place in mark.x.tolist()]
                columns = along.setdefault(mark.x.tobytes(), {panel.x.label: text_cells(places, "number")})
                head = ", ".join(filter(None, (panel.title, mark.label, panel.y.label)))
                columns[head] = number_cells(mark.y, in_digits(4))
    return [table("", "Numbers", columns) for columns in along.values()]


# --- the texture


def statistics_table(tree: DataTree) -> ReportTable | None:
    """Statistics of the texture, each with the bandwidth it holds for."""

    def value(entry: dict[str, Any]) -> Cell:
        found = entry.get("value")
        number = float(found) if isinstance(found, int | float) else np.nan
        return Cell(data.engineering(number, str(entry.get("unit", ""))), "number")

    columns: dict[str, Any] = {name: name for name in ("symbol", "meaning")}
    columns |= {"of": "surface", "value": value, "bandwidth": "bandwidth"}
    note = "A statistic of a texture holds for its bandwidth of wavelengths only."
    return listed_table(tree, contact.STATISTICS, ("statistics", "Statistics of the texture"), columns, note)


def homogeneity_table(tree: DataTree) -> ReportTable:
    """Whether the measured maps are the same everywhere."""
    shown = (contact.TILE_VARIATION, contact.TILE_VARIATION_EXPECTED, contact.HOMOGENEITY_P)
    significance = float(data.variable_of(tree, contact.HOMOGENEITY_P).attrs["significance"])
    variation, expected, p = (data.values(tree, entry) for entry in shown)
    looks = ["number" if same else "number off" for same in p > significance]
    columns = {
        "map": text_cells(range(1, len(p) + 1), "number"),
        "tiles vary by": number_cells(variation, data.in_percent, looks),
        "by chance": number_cells(expected, data.in_percent, looks),
        "p": number_cells(p, in_digits(2), looks),
        "same everywhere?": text_cells(
            "as far as chance tells" if same else "no" for same in p > significance
        ),
    }
    note = (
        "Coefficient of variation of the mean squares of tiles; p: share of stationary textures with the "
        "same spectrum and heights that vary as much. At p ≤ "
        f"{significance:g} a map is not the same everywhere; one in twenty is so by chance."
    )
    return table("homogeneity", "Homogeneity of the measured maps", columns, note)


def population_table(tree: DataTree) -> ReportTable | None:
    """Whether samples and path are one population and one stiffness is enough, and what follows in dB."""
    looks = {"out of range": "far", "warning": "off"}

    def here(entry: dict[str, Any]) -> Cell:
        return Cell(str(entry.get("value", "")), looks.get(str(entry.get("grade", "")), ""))

    note = (
        "Stiffness: dF/dr of each sample under the load. Maps and parts of the path are told apart by "
        "analysis of variance of their levels, at p ≤ 0.01. Direction: spectra of lines along the path over "
        "those of lines across, for wavelengths from half the length of the contact up. Shaded: more than "
        "1 dB, 3 dB."
    )
    columns = {"question": "question", "here": here, "answer": "answer"}
    return listed_table(tree, contact.POPULATION, ("population", "One population?"), columns, note)


_CONDITIONS = contact.TRACK_RMS, contact.TRACK_STIFFNESS


def condition_table(tree: DataTree) -> ReportTable:
    """The track before and after running-in."""
    found = [data.variable_of(tree, entry) for entry in _CONDITIONS]
    before, after = ([float(each.sel(condition=name)) for each in found] for name in ("before", "after"))
    units = [entry.units for entry in _CONDITIONS]
    change = [100 * (new / old - 1) if old else np.nan for old, new in zip(before, after, strict=True)]
    columns = {
        "quantity": text_cells(entry.long_name for entry in _CONDITIONS),
        "before": text_cells(map(data.engineering, before, units), "number"),
        "after": text_cells(map(data.engineering, after, units), "number"),
        "change": number_cells(change, lambda each: f"{each:+.1f} %".replace("-", "−")),
    }
    share = data.number(tree, contact.YIELDED_SHARE) or 0.0
    last = "changed nothing" if data.number(tree, contact.SHAKEN_DOWN) else "still lowered places"
    note = (
        f"{data.in_percent(share)} of the area that carried pressure has yielded. Before: the first "
        "contact, with the pressure capped at the hardness. All else in this report is of the surface after "
        f"running-in, whose last pass {last} beyond 1/1000 of the smooth bodies' approach."
    )
    return table("running_in_statistics", "Running-in", columns, note)


# --- the laws

LOSSES: dict[Entry, tuple[str, str | Writer]] = {
    rolling.CONTACT_LOSS_SHARE: ("time without contact", data.in_percent),
    rolling.CONTACT_LOSS_EVENTS: ("events", "{:.0f}"),
    rolling.LONGEST_LOSS: ("longest", lambda time: data.engineering(time, "s") if time > 0 else "–"),
}


def loss_table(tree: DataTree) -> ReportTable:
    """Share of time without contact, number of events and the longest, per law."""
    laws = data.held_laws(tree, rolling.CONTACT_LOSS_SHARE)
    columns = {
        head: number_cells([float(data.of_law(tree, entry, law)) for law in laws], write)
        for entry, (head, write) in LOSSES.items()
    }
    pulling = [law for law in laws if law in data.pulling(tree)]
    verb = "pulls" if len(pulling) == 1 else "pull"
    note = ""
    if pulling:
        note = f"{' and '.join(pulling)} cannot lose contact, but {verb} where others let go."
    note = " ".join(filter(None, [note, data.of_first_contact(tree)]))
    return table("contact_loss", "Loss of contact", {"law": text_cells(laws, "name"), **columns}, note)


# --- how sure a result is: convergence, chance, and what is not known

LOW, HIGH = 90.0, 5500.0
"""Frequencies between which the band centres lie that laws are compared in, Hz: 100 Hz to 5 kHz."""
OFF, FAR = 0.5, 1.0
"""Sizes of changes above which a field is shaded, and shaded more, dB."""


def setting_names(tree: DataTree) -> list[str]:
    """Settings that were made finer, or were to be; none where nobody asked."""
    return data.words(tree, convergence.SETTING)


def setting_numbers(tree: DataTree, entry: Entry) -> Array:
    """Numbers of an entry by setting, NaN where none is known."""
    return (
        data.values(tree, entry) if data.present(tree, entry) else np.full(len(setting_names(tree)), np.nan)
    )


def _main(tree: DataTree) -> str:
    return data.words(tree, convergence.LAW)[0]


def settings_table(tree: DataTree) -> ReportTable | None:
    """Each setting: from what to what, the largest change of the levels, and that of the stiffness."""
    names = setting_names(tree)
    if not names:
        return None
    changed, limits = (data.words(tree, entry) for entry in (convergence.CHANGE, convergence.LIMIT))
    size, band, stiffness = (setting_numbers(tree, entry) for entry in _CHANGES)
    motion = _largest_motion(tree)
    moved = data.stored_variable(tree, convergence.MOTION_LEVEL_CHANGE)
    change = [f"not changed: {why}" if why else how for how, why in zip(changed, limits, strict=True)]
    columns = {
        "setting": text_cells(names),
        "change": text_cells(change),
        "force, at most / dB": _size_cells(size),
        "at / Hz": number_cells(band, data.nominal_band),
        "motion, at most / dB": _size_cells(motion),
        "mean stiffness": number_cells(stiffness, lambda share: f"{data.signed(100 * share, 2)} %"),
    }
    what = "nothing recorded" if moved is None else f"the {moved.attrs['quantity']}"
    note = (
        f"Force: the level of {_main(tree)}; motion: {what}, energy mean over its places. Largest "
        "size of the change from 100 Hz to 5 kHz, in bands that say something; mean stiffness: dF/dr under "
        f"the load. Shaded: more than {OFF:g} dB, more than {FAR:g} dB. Grid and window are compared on one "
        "surface, that of the finer or wider case, at the points of the other. Half of the record differs "
        "from all of it by chance: its change is the scatter of one path. Where contact is lost, the course "
        "of a path is chaotic, and any change scatters as much."
    )
    return table("finer_settings", "Settings made finer, one at a time", columns, note)


_CHANGES = (convergence.LARGEST_CHANGE, convergence.LARGEST_BAND, convergence.STIFFNESS_CHANGE)


def _size_cells(sizes: Array) -> list[Cell]:
    looks = ["number" + size_look(each, OFF, FAR) for each in sizes]
    return number_cells(sizes, "{:.2f}", looks)


def _largest_motion(tree: DataTree) -> Array:
    """Largest size of the change of the main law's motion, in the bands of the force."""
    if not data.present(tree, convergence.MOTION_LEVEL_CHANGE):
        return np.full(len(setting_names(tree)), np.nan)
    change = np.abs(data.values(tree, convergence.MOTION_LEVEL_CHANGE)[:, 0])
    band = data.values(tree, convergence.BAND)
    little = say_little(data.values(tree, spectra.BAND_TIME_PRODUCT), 0.0)  # all start alike
    shown = ~little & (band > LOW) & (band < HIGH) & np.isfinite(change)
    found = np.where(shown, change, -1.0).max(axis=1)
    return np.where(found < 0.0, np.nan, found)


def changes_table(tree: DataTree) -> ReportTable:
    """Change of the main law's force level in each one-third octave, by setting."""
    entry = convergence.FORCE_LEVEL_CHANGE
    changes = data.values(tree, entry)[:, 0]
    faint = data.doubtful(tree, spectra.BAND_TIME_PRODUCT)
    columns = {"band / Hz": band_cells(data.values(tree, convergence.BAND), faint)}
    for name, change in zip(setting_names(tree), changes, strict=True):
        if np.isfinite(change).any():
            columns[name] = change_cells(change, faint, OFF, FAR, places=2)
    title = f"Change of the contact force level of {_main(tree)}, in dB, by what is made finer"
    note = f"Shaded: more than {OFF:g} dB, more than {FAR:g} dB. In brackets: bands that say little."
    return table("changes_by_band", title, columns, note)


NOTICED = 0.1
"""Level, dB, from which on the start of a record is told."""
Known = tuple[str, str, str]
"""Source of an uncertainty, its size, and how it is known."""


def uncertainty_table(tree: DataTree) -> ReportTable:
    """What is known of the uncertainty of force levels."""
    data.leave_to_bearing(tree)
    main = data.main_law(tree, rolling.CONTACT_FORCE)
    sources, sizes, ways = zip(*_law(tree, main), *_chance(tree), strict=True)
    note = (
        f"Of the force levels of {main}, apart from what is not known of the case itself: materials, "
        "roughness, damping. The sources are independent: their squares add, with what finer settings "
        "change (asperity run --converge) and what samples leave open (One population?)."
    )
    columns = {
        "source": text_cells(sources),
        "size": text_cells(sizes, "number"),
        "how it is known": text_cells(ways),
    }
    return table("uncertainty_by_source", "How far the levels may be off", columns, note)


def error_on_map(tree: DataTree, law: str | None) -> tuple[dict[str, Any], str, dict[str, Any]] | None:
    """What the map of law errors says of a law, in words, and what it says of the case; None if nothing."""
    found = data.json_attribute(tree, provenance.EXPECTED_ERRORS, {})
    error = next((each for each in found.get("errors", []) if each["law"] == law), None)
    if error is None:
        return None
    return error, f"{error['error']:.1f} dB ({error['low']:.1f} to {error['high']:.1f})", found


def _law(tree: DataTree, main: str) -> Iterator[Known]:
    source = f"the law {main}, against direct"
    if expected := error_on_map(tree, main):
        far = ", off the map: a guess" if expected[2]["off_map"] else ""
        how = "law accuracy map, rms over the one-third octaves; the band held in four of five cases"
        yield source, expected[1], f"{how}{far}"
    else:
        yield source, "not known", "the law accuracy map does not hold this law, or cases like this one"


def _chance(tree: DataTree) -> Iterator[Known]:
    """Standard deviation of a band level by chance, and how far it is low from the start of the record."""
    if not data.present(tree, spectra.BAND, spectra.BAND_TIME_PRODUCT, spectra.LEVEL_DEVIATION):
        return
    band = data.values(tree, spectra.BAND)
    deviation = data.values(tree, spectra.LEVEL_DEVIATION)
    shown = np.flatnonzero((band > LOW) & (band < HIGH) & ~data.doubtful(tree, spectra.BAND_TIME_PRODUCT))
    source = "chance: one record of this length"
    if shown.size:
        ends = (shown[np.argmin(deviation[shown])], shown[np.argmax(deviation[shown])])
        told = [f"{deviation[i]:.1f} dB at {nominal_frequency(band[i])}" for i in ends]
        how = "standard deviation of a level, from the bandwidth and the resonances that ring in it"
        yield source, data.between(*told), how
    else:
        yield source, "not small", "no band has a level that says something"
    if data.present(tree, spectra.START_SHARE):
        low = -10.0 * np.log10(1.0 - data.values(tree, spectra.START_SHARE))
        worst = int(np.argmax(low))
        if low[worst] >= NOTICED:
            size = f"up to {low[worst]:.1f} dB low, at {nominal_frequency(band[worst])}"
            how = "mean square that resonances have not built up yet; longer settling, or more damping, helps"
            yield "start of the record", size, how
