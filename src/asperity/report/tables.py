"""Tables of the report: statistics, difference to the reference law, loss of contact, energy, noise."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from xarray import DataTree

from asperity.report.data import (
    engineering,
    entries,
    group_attrs,
    laws,
    nominal_band,
    of_law,
    present,
    values,
    variable,
)

REFERENCE = "spectra/force_level_difference_to_reference"


@dataclass(frozen=True)
class Cell:
    """One field of a table: its text, and a class for its look."""

    text: str
    look: str = ""


@dataclass(frozen=True)
class Table:
    """A table of the page: its name, heading, column heads, rows of cells and a note."""

    name: str
    title: str
    head: list[str]
    rows: list[list[Cell]] = field(default_factory=list)
    note: str = ""


def _text(found: object) -> Cell:
    return Cell(str(found))


def statistics_table(tree: DataTree) -> Table | None:
    """Statistics of the texture, each with the bandwidth it holds for."""
    found = [e for e in entries(group_attrs(tree, "surface"), "statistics", []) if isinstance(e, dict)]
    if not found:
        return None
    rows = []
    for entry in found:
        value, unit = entry.get("value"), str(entry.get("unit", ""))
        shown = engineering(float(value), unit) if isinstance(value, int | float) else "–"
        names = [str(entry.get(name, "")) for name in ("symbol", "meaning", "surface")]
        rows.append(
            [
                _text(names[0]),
                _text(names[1]),
                _text(names[2]),
                Cell(shown, "number"),
                _text(entry.get("bandwidth", "")),
            ]
        )
    note = "A statistic of a texture holds for its bandwidth of wavelengths only."
    return Table(
        "statistics",
        "Statistics of the texture",
        ["symbol", "meaning", "of", "value", "bandwidth"],
        rows,
        note,
    )


def reference_law(tree: DataTree) -> str | None:
    """Law that the others are compared with: ``direct`` if it was run, else ``table``."""
    found = variable(tree, REFERENCE)
    if found is None:
        return None
    stated = found.attrs.get("reference")
    return (
        str(stated)
        if stated
        else next((law for law in ("direct", "table") if law in laws(tree, REFERENCE)), None)
    )


def reference_table(tree: DataTree) -> Table | None:
    """Level differences to the reference law per one-third octave."""
    reference = reference_law(tree)
    names = [law for law in laws(tree, REFERENCE) if law != reference]
    if reference is None or not names or not present(tree, "spectra/band"):
        return None
    differences = np.array([of_law(tree, REFERENCE, law, "band") for law in names])
    bands = values(tree, "spectra/band")
    rows = [
        [Cell(nominal_band(f), "number"), *map(_difference, column)]
        for f, column in zip(bands, differences.T, strict=True)
    ]
    with np.errstate(invalid="ignore"):
        largest = np.nanmax(np.abs(differences), axis=1)
        mean = np.nanmean(differences, axis=1)
    rows.append([Cell("mean", "total"), *(Cell(_signed(d), "number total") for d in mean)])
    rows.append([Cell("largest size", "total"), *(Cell(f"{d:.1f}", "number total") for d in largest)])
    note = "Shaded: more than 1 dB, more than 3 dB away."
    title = f"Contact force level minus that of {reference}, in dB"
    return Table("reference", title, ["band / Hz", *names], rows, note)


def _signed(difference: float) -> str:
    rounded = round(float(difference), 1)
    return "–" if not np.isfinite(difference) else f"{rounded:+.1f}".replace("-", "−") if rounded else "0.0"


def _difference(value: float) -> Cell:
    size = abs(value)
    look = " far" if size > 3 else " off" if size > 1 else ""
    return Cell(_signed(value), "number" + look)


def _percent(share: float) -> str:
    return f"{100 * share:.1f} %" if share >= 0.01 or share == 0 else f"{100 * share:.2g} %"


def loss_table(tree: DataTree) -> Table | None:
    """Share of time without contact, number of events and the longest, per law."""
    names = laws(tree, "rolling/contact_loss_share")
    if not names:
        return None
    has_events, has_longest = (present(tree, f"rolling/{n}") for n in ("contact_loss_events", "longest_loss"))
    head = [
        "law",
        "time without contact",
        *(["events"] if has_events else []),
        *(["longest"] if has_longest else []),
    ]
    rows = []
    for law in names:
        share = float(of_law(tree, "rolling/contact_loss_share", law))
        row = [_text(law), Cell(_percent(share), "number")]
        if has_events:
            row.append(Cell(f"{float(of_law(tree, 'rolling/contact_loss_events', law)):.0f}", "number"))
        if has_longest:
            longest = float(of_law(tree, "rolling/longest_loss", law))
            row.append(Cell(engineering(longest, "s") if longest > 0 else "–", "number"))
        rows.append(row)
    return Table(
        "contact_loss",
        "Loss of contact",
        head,
        rows,
        "The linear law cannot lose contact: it pulls where others let go." if "linear" in names else "",
    )


def energy_table(tree: DataTree) -> Table | None:
    """Energy balance per law, and what is left of it."""
    names = laws(tree, "rolling/energy")
    if not names:
        return None
    found = variable(tree, "rolling/energy")
    assert found is not None
    terms = [str(term) for term in found["energy_term"].values]
    residual = variable(tree, "rolling/energy_residual")
    rows = []
    for law in names:
        energies = of_law(tree, "rolling/energy", law, "energy_term")
        row = [_text(law), *(Cell(engineering(energy, "J"), "number") for energy in energies)]
        if residual is not None:
            row.append(Cell(f"{float(of_law(tree, 'rolling/energy_residual', law)):.1e}", "number"))
        rows.append(row)
    meaning = residual.attrs.get("long_name") if residual is not None else None
    note = "Energies at the end of the run." + (f" Residual: {meaning}." if meaning else "")
    head = ["law", *terms, *(["relative residual"] if residual is not None else [])]
    return Table(
        "energy_balance",
        "Energy balance of the run",
        head,
        rows,
        note,
    )


def sound_power_table(tree: DataTree) -> Table | None:
    """A-weighted sound power per law and source, and its difference to the linear law."""
    path = "spectra/sound_power_level_a"
    names, found = laws(tree, path), variable(tree, path)
    if found is None:
        return None
    sources = [str(source) for source in found["source"].values]
    levels = {law: of_law(tree, path, law, "source") for law in names}
    head = ["law", *(f"{source} / dB(A)" for source in sources)]
    if "linear" in names:
        head += [f"{source} − linear / dB" for source in sources]
    rows = []
    for law, level in levels.items():
        row = [_text(law), *(Cell(_level(value), "number") for value in level)]
        if "linear" in names:
            row += [Cell(_signed(d) if law != "linear" else "–", "number") for d in level - levels["linear"]]
        rows.append(row)
    note = "Re 1 pW, over the bands that were computed. Positive differences: linear contact underestimates."
    standard = variable(tree, "spectra/cnossos_sound_power_level_a")
    if standard is not None:
        level = standard.sel(source=found["source"]).values
        row = [_text("CNOSSOS-EU"), *(Cell(_level(value), "number") for value in level)]
        if "linear" in names:
            row += [Cell(_signed(d), "number") for d in level - levels["linear"]]
        rows.append(row)
        name = standard.attrs.get("contact_filter", "")
        note += f" CNOSSOS-EU: the same roughness with its own contact filter ({name})."
    return Table("sound_power_table", "A-weighted sound power", head, rows, note)


def _level(value: float) -> str:
    return f"{value:.1f}" if np.isfinite(value) else "–"
