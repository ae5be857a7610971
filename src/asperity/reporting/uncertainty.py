"""How far the numbers of a run may be off, source by source, where that is known."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from xarray import DataTree

from asperity.reporting.convergence import setting_names, setting_numbers
from asperity.reporting.data import doubtful, json_attribute, laws, nominal_band, number, present, values
from asperity.reporting.headline import HIGH, LOW
from asperity.reporting.tables import Cell, ReportTable, text_cell
from asperity.schema import contact, convergence, provenance
from asperity.schema.rolling import CONTACT_FORCE
from asperity.schema.spectra import BAND, BAND_TIME_PRODUCT, LEVEL_DEVIATION, START_SHARE

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
