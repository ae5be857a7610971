"""How sure a result is: convergence, chance, and what is not known."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray
from xarray import DataTree

from asperity.reporting.data import (
    doubtful,
    json_attribute,
    laws,
    nominal_band,
    number,
    present,
    stored_variable,
    values,
)
from asperity.reporting.tables import Cell, ReportTable, signed, text_cell
from asperity.schema import Entry, contact, convergence, provenance
from asperity.schema.rolling import CONTACT_FORCE
from asperity.schema.spectra import BAND, BAND_TIME_PRODUCT, LEVEL_DEVIATION, START_SHARE
from asperity.spectra import say_little

LOW, HIGH = 90.0, 5500.0
"""Frequencies between which the band centres lie that laws are compared in, Hz: 100 Hz to 5 kHz."""
OFF, FAR = 0.5, 1.0
"""Sizes of changes above which a field is shaded, and shaded more, dB."""


def settings_table(tree: DataTree) -> ReportTable | None:
    """Each setting: from what to what, the largest change of the levels, and that of the stiffness."""
    names = setting_names(tree)
    if not names:
        return None
    changed, limits = (_words(tree, entry) for entry in (convergence.CHANGE, convergence.LIMIT))
    size, band, stiffness = (
        setting_numbers(tree, entry)
        for entry in (convergence.LARGEST_CHANGE, convergence.LARGEST_BAND, convergence.STIFFNESS_CHANGE)
    )
    motion = _largest_motion(tree, len(names))
    rows = [
        [
            text_cell(name),
            text_cell(f"not changed: {limits[k]}" if limits[k] else changed[k]),
            Cell(f"{size[k]:.2f}" if np.isfinite(size[k]) else "–", "number" + _look(size[k])),
            Cell(nominal_band(band[k]) if np.isfinite(band[k]) else "–", "number"),
            Cell(f"{motion[k]:.2f}" if np.isfinite(motion[k]) else "–", "number" + _look(motion[k])),
            Cell(_percent(stiffness[k]), "number"),
        ]
        for k, name in enumerate(names)
    ]
    head = ["setting", "change", "force, at most / dB", "at / Hz", "motion, at most / dB", "mean stiffness"]
    note = (
        f"Force: the level of {_main(tree)}; motion: {_motion(tree)}, energy mean over its places. Largest "
        "size of the change from 100 Hz to 5 kHz, in bands that say something; mean stiffness: dF/dr under "
        f"the load. Shaded: more than {OFF:g} dB, more than {FAR:g} dB. Grid and window are compared on one "
        "surface, that of the finer or wider case, at the points of the other. Half of the record differs "
        "from all of it by chance: its change is the scatter of one path. Where contact is lost, the course "
        "of a path is chaotic, and any change scatters as much."
    )
    return ReportTable("finer_settings", "Settings made finer, one at a time", head, rows, note)


def changes_table(tree: DataTree) -> ReportTable | None:
    """Change of the main law's force level in each one-third octave, by setting."""
    entry = convergence.FORCE_LEVEL_CHANGE
    if not present(tree, entry, convergence.BAND):
        return None
    change = values(tree, entry, "setting", "law", "band")[:, 0]
    kept = np.flatnonzero(np.isfinite(change).any(axis=1))
    names = [setting_names(tree)[k] for k in kept]
    faint = doubtful(tree, BAND_TIME_PRODUCT)
    rows = [
        [Cell(nominal_band(f), "number faint" if doubt else "number"), *(_change(d, doubt) for d in column)]
        for f, column, doubt in zip(values(tree, convergence.BAND), change[kept].T, faint, strict=True)
    ]
    title = f"Change of the contact force level of {_main(tree)}, in dB, by what is made finer"
    note = f"Shaded: more than {OFF:g} dB, more than {FAR:g} dB. In brackets: bands that say little."
    return ReportTable("changes_by_band", title, ["band / Hz", *names], rows, note)


def _words(tree: DataTree, entry: Entry) -> list[str]:
    if entry.group not in tree.children or entry.name not in tree[entry.group].variables:
        return []
    return [str(word) for word in tree[entry.group].to_dataset()[entry.name].values]


def setting_names(tree: DataTree) -> list[str]:
    """Settings that were made finer, or were to be; none where nobody asked."""
    return _words(tree, convergence.SETTING)


def setting_numbers(tree: DataTree, entry: Entry) -> NDArray[np.float64]:
    """Numbers of an entry by setting, NaN where none is known."""
    return values(tree, entry) if present(tree, entry) else np.full(len(setting_names(tree)), np.nan)


def _main(tree: DataTree) -> str:
    return _words(tree, convergence.LAW)[0]


def _motion(tree: DataTree) -> str:
    found = stored_variable(tree, convergence.MOTION_LEVEL_CHANGE)
    return "nothing recorded" if found is None else f"the {found.attrs['quantity']}"


def _largest_motion(tree: DataTree, count: int) -> NDArray[np.float64]:
    """Largest size of the change of the main law's motion, in the bands of the force."""
    if not present(tree, convergence.MOTION_LEVEL_CHANGE):
        return np.full(count, np.nan)
    change = np.abs(values(tree, convergence.MOTION_LEVEL_CHANGE, "setting", "law", "band")[:, 0])
    band = values(tree, convergence.BAND)
    little = say_little(values(tree, BAND_TIME_PRODUCT, "band"), 0.0)  # all start alike
    shown = ~little & (band > 90.0) & (band < 5500.0)
    found = np.where(shown & np.isfinite(change), change, -1.0).max(axis=1)
    return np.where(found < 0.0, np.nan, found)


def _look(size: float) -> str:
    return " far" if size > FAR else " off" if size > OFF else ""


def _change(value: float, doubt: bool) -> Cell:
    if doubt:
        return Cell(f"({signed(value)})", "number faint")
    return Cell(_signed(value) if np.isfinite(value) else "–", "number" + _look(abs(value)))


def _percent(share: float) -> str:
    return f"{_signed(100 * share)} %" if np.isfinite(share) else "–"


def _signed(value: float) -> str:
    """Two places, with a sign where they are not zero."""
    text = f"{value:+.2f}".replace("-", "−")
    return text if round(value, 2) else text[1:]


NOTICED = 0.1
"""Level, dB, from which on the start of a record is told."""
Known = tuple[str, str, str]
"""Source of an uncertainty, its size, and how it is known."""


def uncertainty_table(tree: DataTree) -> ReportTable | None:
    """What is known of the uncertainty of force levels."""
    if not present(tree, CONTACT_FORCE):
        return None
    main = laws(tree, CONTACT_FORCE)[0]
    found = [*_law(tree, main), *_chance(tree), *_samples(tree), *_settings(tree)]
    rows = [[text_cell(source), Cell(size, "number"), text_cell(how)] for source, size, how in found]
    note = (
        f"Of the force levels of {main}, apart from what is not known of the case itself: materials, "
        "roughness, damping. The sources are independent: their squares add."
    )
    return ReportTable(
        "uncertainty_by_source",
        "How far the levels may be off",
        ["source", "size", "how it is known"],
        rows,
        note,
    )


def _law(tree: DataTree, main: str) -> Iterator[Known]:
    found = json_attribute(tree, provenance.EXPECTED_ERRORS, {})
    error = next((e for e in found.get("errors", []) if e["law"] == main), None)
    if error is None:
        yield (
            f"the law {main}, against direct",
            "not known",
            "the law accuracy map does not hold this law, or cases like this one",
        )
        return
    far = ", off the map: a guess" if found["off_map"] else ""
    yield (
        f"the law {main}, against direct",
        f"{error['error']:.1f} dB ({error['low']:.1f} to {error['high']:.1f})",
        f"law accuracy map, rms over the one-third octaves; the band held in four of five cases{far}",
    )


def _chance(tree: DataTree) -> Iterator[Known]:
    """Standard deviation of a band level by chance, and how far it is low from the start of the record."""
    if not present(tree, BAND, BAND_TIME_PRODUCT, LEVEL_DEVIATION):
        return
    band, deviation = values(tree, BAND), values(tree, LEVEL_DEVIATION)
    shown = np.flatnonzero((band > LOW) & (band < HIGH) & ~doubtful(tree, BAND_TIME_PRODUCT))
    if shown.size:
        least, most = (pick(shown, key=lambda i: deviation[i]) for pick in (min, max))
        told = [f"{deviation[i]:.1f} dB at {nominal_band(band[i])} Hz" for i in (least, most)]
        how = "standard deviation of a level, from the bandwidth and the resonances that ring in it"
        yield "chance: one record of this length", " to ".join(dict.fromkeys(told)), how
    else:
        yield "chance: one record of this length", "not small", "no band has a level that says something"
    if present(tree, START_SHARE):
        low = -10.0 * np.log10(1.0 - values(tree, START_SHARE))
        worst = int(np.argmax(low))
        if low[worst] >= NOTICED:
            how = "mean square that resonances have not built up yet; longer settling, or more damping, helps"
            yield (
                "start of the record",
                f"up to {low[worst]:.1f} dB low, at {nominal_band(band[worst])} Hz",
                how,
            )


def _samples(tree: DataTree) -> Iterator[Known]:
    """Standard deviation of the mean stiffness of the samples under the load."""
    count, approach = number(tree, contact.SAMPLES), number(tree, contact.WORKING_APPROACH)
    if count is None or count < 2 or approach is None or not present(tree, contact.STIFFNESS_STD):
        return
    states = values(tree, contact.APPROACH)
    mean, spread = (
        float(np.interp(approach, states, values(tree, entry)))
        for entry in (contact.STIFFNESS, contact.STIFFNESS_STD)
    )
    if mean > 0.0:
        level = 20.0 * np.log10(1.0 + spread / mean / np.sqrt(count))
        how = f"standard deviation of the mean of {count:.0f} samples, k_c under the load"
        yield "contact stiffness, from the samples", f"{level:.1f} dB", how


def _settings(tree: DataTree) -> Iterator[Known]:
    names = setting_names(tree)
    if not names:
        yield (
            "settings: grid, window, samples, time step, …",
            "not known",
            "asperity run --converge computes again with each of them made finer",
        )
        return
    sizes = dict(zip(names, setting_numbers(tree, convergence.LARGEST_CHANGE), strict=True))
    half = sizes.pop(convergence.PATH_LENGTH, np.nan)
    known = {name: size for name, size in sizes.items() if np.isfinite(size)}
    if known:
        worst = max(known, key=lambda name: known[name])
        how = f"largest change of a one-third octave, {worst} made finer; all settings below"
        yield "settings", f"{known[worst]:.2f} dB", how
    if np.isfinite(half):
        yield (
            "chance, seen",
            f"{half:.1f} dB",
            "largest difference of the first half of the record to all of it",
        )
