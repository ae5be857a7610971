"""How sure a result is: convergence, chance, and what is not known."""

from collections.abc import Iterator
from typing import Any

import numpy as np
from xarray import DataTree

from asperity.reporting import data, tables
from asperity.reporting.chart import Numbers
from asperity.reporting.tables import ReportTable
from asperity.schema import Entry, contact, convergence, provenance, rolling, spectra
from asperity.spectra import say_little

LOW, HIGH = 90.0, 5500.0
"""Frequencies between which the band centres lie that laws are compared in, Hz: 100 Hz to 5 kHz."""
OFF, FAR = 0.5, 1.0
"""Sizes of changes above which a field is shaded, and shaded more, dB."""


def setting_names(tree: DataTree) -> list[str]:
    """Settings that were made finer, or were to be; none where nobody asked."""
    return data.words(tree, convergence.SETTING)


def setting_numbers(tree: DataTree, entry: Entry) -> Numbers:
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
    motion, moved = _largest_motion(tree), data.stored_variable(tree, convergence.MOTION_LEVEL_CHANGE)
    change = [f"not changed: {why}" if why else how for how, why in zip(changed, limits, strict=True)]
    columns = {
        "setting": tables.text_cells(names),
        "change": tables.text_cells(change),
        "force, at most / dB": _size_cells(size),
        "at / Hz": tables.number_cells(band, data.nominal_band),
        "motion, at most / dB": _size_cells(motion),
        "mean stiffness": tables.number_cells(stiffness, lambda share: f"{data.signed(100 * share, 2)} %"),
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
    return tables.table("finer_settings", "Settings made finer, one at a time", columns, note)


_CHANGES = (convergence.LARGEST_CHANGE, convergence.LARGEST_BAND, convergence.STIFFNESS_CHANGE)


def _size_cells(sizes: Numbers) -> list[tables.Cell]:
    looks = ["number" + tables.size_look(each, OFF, FAR) for each in sizes]
    return tables.number_cells(sizes, "{:.2f}", looks)


def _largest_motion(tree: DataTree) -> Numbers:
    """Largest size of the change of the main law's motion, in the bands of the force."""
    if not data.present(tree, convergence.MOTION_LEVEL_CHANGE):
        return np.full(len(setting_names(tree)), np.nan)
    change = np.abs(data.values(tree, convergence.MOTION_LEVEL_CHANGE)[:, 0])
    band = data.values(tree, convergence.BAND)
    little = say_little(data.values(tree, spectra.BAND_TIME_PRODUCT), 0.0)  # all start alike
    shown = ~little & (band > LOW) & (band < HIGH) & np.isfinite(change)
    found = np.where(shown, change, -1.0).max(axis=1)
    return np.where(found < 0.0, np.nan, found)


def changes_table(tree: DataTree) -> ReportTable | None:
    """Change of the main law's force level in each one-third octave, by setting."""
    entry = convergence.FORCE_LEVEL_CHANGE
    if not data.present(tree, entry, convergence.BAND):
        return None
    changes = data.values(tree, entry)[:, 0]
    faint = data.doubtful(tree, spectra.BAND_TIME_PRODUCT)
    columns = {"band / Hz": tables.band_cells(data.values(tree, convergence.BAND), faint)}
    for name, change in zip(setting_names(tree), changes, strict=True):
        if np.isfinite(change).any():
            columns[name] = tables.change_cells(change, faint, OFF, FAR, places=2)
    title = f"Change of the contact force level of {_main(tree)}, in dB, by what is made finer"
    note = f"Shaded: more than {OFF:g} dB, more than {FAR:g} dB. In brackets: bands that say little."
    return tables.table("changes_by_band", title, columns, note)


NOTICED = 0.1
"""Level, dB, from which on the start of a record is told."""
Known = tuple[str, str, str]
"""Source of an uncertainty, its size, and how it is known."""


def uncertainty_table(tree: DataTree) -> ReportTable | None:
    """What is known of the uncertainty of force levels."""
    if not data.present(tree, rolling.CONTACT_FORCE):
        return None
    main = data.laws(tree, rolling.CONTACT_FORCE)[0]
    sources, sizes, ways = zip(
        *_law(tree, main), *_chance(tree), *_samples(tree), *_settings(tree), strict=True
    )
    note = (
        f"Of the force levels of {main}, apart from what is not known of the case itself: materials, "
        "roughness, damping. The sources are independent: their squares add."
    )
    columns = {
        "source": tables.text_cells(sources),
        "size": tables.text_cells(sizes, "number"),
        "how it is known": tables.text_cells(ways),
    }
    return tables.table("uncertainty_by_source", "How far the levels may be off", columns, note)


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
    band, deviation = data.values(tree, spectra.BAND), data.values(tree, spectra.LEVEL_DEVIATION)
    shown = np.flatnonzero((band > LOW) & (band < HIGH) & ~data.doubtful(tree, spectra.BAND_TIME_PRODUCT))
    source = "chance: one record of this length"
    if shown.size:
        ends = (shown[np.argmin(deviation[shown])], shown[np.argmax(deviation[shown])])
        told = [f"{deviation[i]:.1f} dB at {data.nominal_band(band[i])} Hz" for i in ends]
        how = "standard deviation of a level, from the bandwidth and the resonances that ring in it"
        yield source, " to ".join(dict.fromkeys(told)), how
    else:
        yield source, "not small", "no band has a level that says something"
    if data.present(tree, spectra.START_SHARE):
        low = -10.0 * np.log10(1.0 - data.values(tree, spectra.START_SHARE))
        worst = int(np.argmax(low))
        if low[worst] >= NOTICED:
            size = f"up to {low[worst]:.1f} dB low, at {data.nominal_band(band[worst])} Hz"
            how = "mean square that resonances have not built up yet; longer settling, or more damping, helps"
            yield "start of the record", size, how


def _samples(tree: DataTree) -> Iterator[Known]:
    """Standard deviation of the mean stiffness of the samples under the load."""
    count, approach = (data.number(tree, a) for a in (contact.SAMPLES, contact.WORKING_APPROACH))
    if count is None or count < 2 or approach is None or not data.present(tree, contact.STIFFNESS_STD):
        return
    states = data.values(tree, contact.APPROACH)
    mean, spread = (
        float(np.interp(approach, states, data.values(tree, entry)))
        for entry in (contact.STIFFNESS, contact.STIFFNESS_STD)
    )
    if mean > 0.0:
        level = 20.0 * np.log10(1.0 + spread / mean / np.sqrt(count))
        how = f"standard deviation of the mean of {count:.0f} samples, k_c under the load"
        yield "contact stiffness, from the samples", f"{level:.1f} dB", how


def _settings(tree: DataTree) -> Iterator[Known]:
    names = setting_names(tree)
    if not names:
        how = "asperity run --converge computes again with each of them made finer"
        yield "settings: grid, window, samples, time step, …", "not known", how
        return
    sizes = dict(zip(names, setting_numbers(tree, convergence.LARGEST_CHANGE), strict=True))
    half = sizes.pop(convergence.PATH_LENGTH, np.nan)
    known = {name: size for name, size in sizes.items() if np.isfinite(size)}
    if known:
        worst = max(known, key=lambda name: known[name])
        how = f"largest change of a one-third octave, {worst} made finer; all settings below"
        yield "settings", f"{known[worst]:.2f} dB", how
    if np.isfinite(half):
        how = "largest difference of the first half of the record to all of it"
        yield "chance, seen", f"{half:.1f} dB", how
