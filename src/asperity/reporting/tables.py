"""Tables of the report: statistics, difference to the reference law, loss of contact, energy, noise."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray
from xarray import DataTree

from asperity.reporting.data import (
    baselines,
    doubtful,
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
from asperity.spectra import LEAST_PRODUCT

REFERENCE = "spectra/force_level_difference_to_reference"
SIGNIFICANCE = 0.05
"""Of the test for homogeneity."""


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


def homogeneity_table(tree: DataTree) -> Table | None:
    """Whether the measured maps are the same everywhere."""
    names = ("tile_variation", "tile_variation_expected", "homogeneity_p")
    if not present(tree, *(f"surface/{name}" for name in names)):
        return None
    columns = [values(tree, f"surface/{name}", "sample") for name in names]
    rows = []
    for number, (variation, expected, p) in enumerate(zip(*columns, strict=True), start=1):
        same = bool(p > SIGNIFICANCE)
        cells = [_percent(variation), _percent(expected), f"{p:.2g}"]
        look = "number" if same else "number off"
        told = "as far as chance tells" if same else "no"
        rows.append([Cell(str(number), "number"), *(Cell(text, look) for text in cells), _text(told)])
    note = (
        "Coefficient of variation of the mean squares of tiles; p: share of stationary textures with the "
        "same spectrum and heights that vary as much. At p ≤ "
        f"{SIGNIFICANCE:g} a map is not the same everywhere; one in twenty is so by chance."
    )
    head = ["map", "tiles vary by", "by chance", "p", "same everywhere?"]
    return Table("homogeneity", "Homogeneity of the measured maps", head, rows, note)


def validity_table(tree: DataTree) -> Table | None:
    """Quantities that bound the range in which the laws hold, with their limits."""
    found = [e for e in entries(group_attrs(tree, "contact"), "validity", []) if isinstance(e, dict)]
    if not found:
        return None
    looks = {"out of range": "number far", "warning": "number off"}
    rows = []
    for entry in found:
        grade = str(entry.get("grade", ""))
        told = f"{entry.get('meaning', '')} {entry.get('remedy', '')}" if grade else "in range"
        names = [str(entry.get(name, "")) for name in ("quantity", "value", "limit")]
        value = Cell(names[1], looks.get(grade, "number"))
        rows.append([_text(names[0]), value, _text(names[2]), _text(told)])
    note = "Shaded: outside the range in which the laws are known to hold, and far outside."
    return Table("validity", "Range of validity", ["quantity", "here", "in range", "meaning"], rows, note)


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
    found = np.array([of_law(tree, REFERENCE, law, "band") for law in names])
    bands, faint = values(tree, "spectra/band"), doubtful(tree, "band")
    rows = [
        [
            Cell(nominal_band(f), "number faint" if doubt else "number"),
            *(_difference(d, doubt) for d in column),
        ]
        for f, column, doubt in zip(bands, found.T, faint, strict=True)
    ]
    told = [row[np.isfinite(row) & ~faint] for row in found]
    mean = [_signed(row.mean()) if row.size else "–" for row in told]
    largest = [f"{np.abs(row).max():.1f}" if row.size else "–" for row in told]
    rows.append([Cell("mean", "total"), *(Cell(text, "number total") for text in mean)])
    rows.append([Cell("largest size", "total"), *(Cell(text, "number total") for text in largest)])
    note = "Shaded: more than 1 dB, more than 3 dB away."
    if faint.any():
        note += (
            " In grey and in brackets: bands whose bandwidth times averaging time is below "
            f"{LEAST_PRODUCT:g}; they say little, and are not in the last two rows."
        )
    title = f"Contact force level minus that of {reference}, in dB"
    return Table("reference", title, ["band / Hz", *names], rows, note)


def _signed(difference: float) -> str:
    rounded = round(float(difference), 1)
    return "–" if not np.isfinite(difference) else f"{rounded:+.1f}".replace("-", "−") if rounded else "0.0"


def _difference(value: float, doubt: bool) -> Cell:
    size = abs(value)
    if doubt:
        return Cell(f"({_signed(value)})", "number faint")
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
    note = "Energies from the start of the run-in to the end of the run." + (
        f" Residual: {meaning}." if meaning else ""
    )
    head = ["law", *terms, *(["relative residual"] if residual is not None else [])]
    return Table(
        "energy_balance",
        "Energy balance of the run",
        head,
        rows,
        note,
    )


def sound_power_table(tree: DataTree) -> Table | None:
    """A-weighted sound power per law and source, and its differences to the linear laws."""
    path = "spectra/sound_power_level_a"
    names, found = laws(tree, path), variable(tree, path)
    if found is None:
        return None
    sources = [str(source) for source in found["source"].values]
    levels = {law: of_law(tree, path, law, "source") for law in names}
    compared = baselines(names)
    head = ["law", *(f"{source} / dB(A)" for source in sources)]
    head += [f"{source} − {name} / dB" for name in compared for source in sources]

    def row(label: str, level: NDArray[np.float64]) -> list[Cell]:
        cells = [_text(label), *(Cell(_level(value), "number") for value in level)]
        for name in compared:
            cells += [Cell(_signed(d) if label != name else "–", "number") for d in level - levels[name]]
        return cells

    rows = [row(law, level) for law, level in levels.items()]
    note = "Re 1 pW, over the bands that were computed. Positive differences: linear contact underestimates."
    standard = variable(tree, "spectra/cnossos_sound_power_level_a")
    if standard is not None:
        rows.append(row("CNOSSOS-EU", standard.sel(source=found["source"]).values))
        name = standard.attrs.get("contact_filter", "")
        note += f" CNOSSOS-EU: the same roughness with its own contact filter ({name})."
    return Table("sound_power_table", "A-weighted sound power", head, rows, note)


def _level(value: float) -> str:
    return f"{value:.1f}" if np.isfinite(value) else "–"
