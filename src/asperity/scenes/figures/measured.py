"""What was measured on a track, beside what was computed: in figures of the track, and a table of both."""

from collections.abc import Iterator
from typing import Any

import numpy as np
from xarray import DataTree

from asperity.reporting import chart, data
from asperity.reporting.figure import Columns, Series
from asperity.reporting.tables import ReportTable, band_cells, change_cells, number_cells, table
from asperity.scenes import schema
from asperity.schema import Entry
from asperity.schema.spectra import BAND

MEASURED = "measured, in one-third octaves"
_LOOK: tuple[Any, ...] = (chart.INK, (), 2.0)


def over_bands(entry: Entry, of: Entry, look: tuple[Any, ...] = _LOOK, label: str = MEASURED) -> Columns:
    """Column of what holds for one-third octaves, at the frequencies of a figure of the track.

    As one of the figure's own `of`: a mobility as a receptance.
    """

    def columns(tree: DataTree) -> Iterator[Series]:
        if not data.present(tree, entry):
            return
        frequency, band = data.values(tree, schema.TRACK_FREQUENCY), data.values(tree, BAND)
        number = np.rint(10.0 * np.log10(frequency / band[0])).astype(int)
        inside = (number >= 0) & (number < len(band))
        found = np.where(inside, data.values(tree, entry)[np.clip(number, 0, len(band) - 1)], np.nan)
        if entry.units == "(m/s)/N":
            found = found / (2.0 * np.pi * frequency)
        if np.isfinite(found).any():
            yield Series(entry.name, of.units, found, of, label, look=look)

    return columns


def measured_table(tree: DataTree) -> ReportTable | None:
    """Decay rate and mobility in one-third octaves, measured and computed, and what that does to the rail."""
    if not data.present(tree, schema.MEASURED_POWER_CHANGE):
        return None
    change = data.values(tree, schema.MEASURED_POWER_CHANGE)
    shown = np.isfinite(change)
    columns = {"band": band_cells(data.values(tree, BAND)[shown], np.zeros(shown.sum(), dtype=bool))}
    for head, entry in {
        "decay rate, measured / (dB/m)": schema.MEASURED_DECAY_RATE,
        "computed": schema.EXPECTED_DECAY_RATE,
        "lateral, measured": schema.MEASURED_LATERAL_DECAY_RATE,
    }.items():
        if data.present(tree, entry):
            columns[head] = number_cells(data.values(tree, entry)[shown], "{:.2g}")
    for head, entry in {
        "mobility, measured / (dB re 1 m/(N s))": schema.MEASURED_MOBILITY,
        "computed, mid-span": schema.EXPECTED_MOBILITY,
    }.items():
        if data.present(tree, entry):
            level = 20.0 * np.log10(data.values(tree, entry)[shown])
            columns[head] = number_cells(level, "{:.1f}")
    doubtful = np.zeros(shown.sum(), dtype=bool)
    for head, entry in {
        "linear force / dB": schema.MEASURED_FORCE_CHANGE,
        "rail and sleepers / dB": schema.MEASURED_POWER_CHANGE,
    }.items():
        if data.present(tree, entry):
            columns[head] = change_cells(data.values(tree, entry)[shown], doubtful)
    note = (
        "Computed: what a hammer at mid-span finds on the computed track, by EN 15461. The sound power of "
        "rail and sleepers goes as |F Y|²/Δ and changes as the last column says, with the force as that of a "
        "linear contact changes: on a softer rail it is smaller. Bands that were not measured stay as "
        "computed, and so does the contact force of this run in all its figures."
    )
    return table("measured_track", "Track: measured against computed", columns, note)
