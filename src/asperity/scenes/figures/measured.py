"""What was measured on a track and beside it, with what was computed: in figures, and tables of both."""

from collections.abc import Iterator
from typing import Any

import numpy as np
from xarray import DataTree

from asperity.reporting import chart, data, figure, panels, tables
from asperity.reporting.chart import Line, Panel
from asperity.scenes import schema
from asperity.schema import Entry
from asperity.schema.spectra import BAND
from asperity.spectra import a_weighting

MEASURED = "measured, in one-third octaves"
_LOOK: tuple[Any, ...] = (chart.INK, (), 2.0)


def over_bands(
    entry: Entry,
    of: Entry,
    look: tuple[Any, ...] = _LOOK,
    label: str = MEASURED,
    frequency: Entry = schema.TRACK_FREQUENCY,
) -> figure.Columns:
    """Column of what holds for one-third octaves, at the frequencies of a figure of the track.

    As one of the figure's own `of`: a mobility as a receptance.
    """

    def columns(tree: DataTree) -> Iterator[figure.Series]:
        if not data.present(tree, entry):
            return
        at, band = data.values(tree, frequency), data.values(tree, BAND)
        number = np.rint(10.0 * np.log10(at / band[0])).astype(int)
        inside = (number >= 0) & (number < len(band))
        found = np.where(inside, data.values(tree, entry)[np.clip(number, 0, len(band) - 1)], np.nan)
        if entry.units == "(m/s)/N":
            found = found / (2.0 * np.pi * at)
        if np.isfinite(found).any():
            yield figure.Series(entry.name, of.units, found, of, label, look=look)

    return columns


_COLUMNS = {
    "decay rate, measured / (dB/m)": schema.MEASURED_DECAY_RATE,
    "computed": schema.EXPECTED_DECAY_RATE,
    "lateral, measured": schema.MEASURED_LATERAL_DECAY_RATE,
    "mobility, measured / (dB re 1 m/(N s))": schema.MEASURED_MOBILITY,
    "computed, mid-span": schema.EXPECTED_MOBILITY,
    "linear force / dB": schema.MEASURED_FORCE_CHANGE,
    "rail and sleepers / dB": schema.MEASURED_POWER_CHANGE,
}


def measured_table(tree: DataTree) -> tables.ReportTable | None:
    """Decay rate and mobility in one-third octaves, measured and computed, and what that does to the rail."""
    if not data.present(tree, schema.MEASURED_POWER_CHANGE):
        return None
    shown = np.isfinite(data.values(tree, schema.MEASURED_POWER_CHANGE))
    doubtful = np.zeros(shown.sum(), dtype=bool)
    columns = {"band": tables.band_cells(data.values(tree, BAND)[shown], doubtful)}
    for head, entry in _COLUMNS.items():
        if data.present(tree, entry):
            found = data.values(tree, entry)[shown]
            if entry.units == "dB":
                columns[head] = tables.change_cells(found, doubtful)
            elif entry.units == "dB/m":
                columns[head] = tables.number_cells(found, "{:.2g}")
            else:
                columns[head] = tables.number_cells(20.0 * np.log10(found), data.signed)
    note = (
        "Computed: what a hammer at mid-span finds on the computed track, by EN 15461. The sound power of "
        "rail and sleepers goes as |F Y|²/Δ and changes as the last column says, with the force as that of a "
        "linear contact changes: on a softer rail it is smaller. Bands that were not measured stay as "
        "computed, and so does the contact force of this run in all its figures."
    )
    return tables.table("measured_track", "Track: measured against computed", columns, note)


# --- beside the track


def moved_words(tree: DataTree) -> str:
    """Say how a record that was measured lies over the computed one; a blank comes first."""
    if not data.present(tree, schema.MEASURED_LEVEL):
        return ""
    return (
        " Measured: moved in time so that the stretch between the points 10 dB below its maximum has the "
        "middle of that of the main law."
    )


def _over_pass_by(tree: DataTree) -> Iterator[figure.Series]:
    """Levels of the main law over the pass-by time, A-weighted, by what radiates; then those measured."""
    band, level = data.values(tree, schema.PASS_BY_BAND), schema.SOUND_EXPOSURE_LEVEL
    front, rear = (float(data.stated(tree, end)) for end in (schema.FRONT_TIME, schema.REAR_TIME))
    weighting, found = a_weighting(band), data.variable_of(tree, level)
    for number in data.with_numbers(found, "radiator"):
        name, values = str(found["radiator"].values[number]), found[0, number].values
        yield figure.Series(name, _SOUND, values - 10.0 * np.log10(rear - front) + weighting, level, name)
    own = schema.MEASURED_BAND_LEVEL
    yield figure.Series("measured", _SOUND, data.values(tree, own) + weighting, own, "measured")


_SOUND = "dB(A) re 20 uPa"
_LOOKS: dict[str, tuple[Any, ...]] = {
    "rail": (chart.VERMILLION, (1.5, 1.5), 1.2),
    "sleepers": (chart.GREEN, (4.0, 1.5), 1.2),
    "wheel": (chart.BLUE, (6.0, 1.5, 1.5, 1.5), 1.2),
    "total": (chart.BLUE, (), 1.6, "o"),
    schema.RAIL_SIDEWAYS: (chart.VERMILLION, (6.0, 1.5), 1.2),
    schema.WHEEL_BOTH: (chart.BLUE, (1.5, 1.5), 1.2),
    schema.WITH_SIDEWAYS: (chart.INK, (6.0, 1.5), 1.6, "o"),
    "measured": (chart.INK, (), 2.2, "s"),
}


def _bands(tree: DataTree, lines: figure.Lines) -> list[Panel]:
    drawn = [Line(lines.at, s.values, s.label, *_LOOKS.get(s.label, ())) for s in lines.lines]
    told = [line.y for line in drawn if line.label in ("total", schema.WITH_SIDEWAYS, "measured")]
    axis = panels.levels_axis("sound pressure level / dB(A) re 20 µPa", told, span=50.0)
    return [Panel(panels.band_axis(lines.at), axis, tuple(drawn), height=4.0)]


PASS_BY_BANDS = figure.Figure(
    "pass_by_bands",
    "Pass-by in one-third octaves, computed and measured",
    figure.Of(schema.PASS_BY_BAND, "band centre"),
    (_over_pass_by,),
    _bands,
    "A-weighted equivalent levels over the pass-by time. Computed: the energy of the whole passage, by the "
    "main law, all of it and by what radiates.",
    (schema.MEASURED_BAND_LEVEL, schema.SOUND_EXPOSURE_LEVEL),
)

_NUMBERS = {
    "L_pAFmax": (schema.MEASURED_MAXIMUM_LEVEL, schema.PASS_BY_MAXIMUM_LEVEL),
    "L_pAeq,Tp": (schema.MEASURED_EQUIVALENT_LEVEL, schema.PASS_BY_EQUIVALENT_LEVEL),
    "TEL": (schema.MEASURED_EXPOSURE_LEVEL, schema.TRANSIT_EXPOSURE_LEVEL),
}


def compared_numbers(tree: DataTree) -> dict[str, tuple[float, float]]:
    """Single numbers of a passage by name, measured and computed by the main law, dB(A)."""
    found = {}
    for name, (own, computed) in _NUMBERS.items():
        measured = data.number(tree, own)
        if measured is not None and (laws := data.laws(tree, computed)):
            found[name] = measured, float(data.of_law(tree, computed, laws[0])[-1])
    return found


def passage_table(tree: DataTree) -> tables.ReportTable | None:
    """Single numbers of a passage, measured and computed, and what lies between them."""
    if not (found := compared_numbers(tree)):
        return None
    measured, computed = np.array(list(found.values())).T
    columns = {
        "": tables.text_cells(found),
        "measured / dB(A)": tables.number_cells(measured, "{:.1f}"),
        "computed / dB(A)": tables.number_cells(computed, "{:.1f}"),
        "computed over measured / dB": tables.change_cells(
            computed - measured, np.zeros(len(found), dtype=bool)
        ),
    }
    note = f"Re 20 µPa. Computed by {data.laws(tree, schema.PASS_BY_MAXIMUM_LEVEL)[0]}, all that is known."
    ratio = data.number(tree, schema.MEASURED_DURATION_RATIO)
    if ratio is not None:
        note += (
            f" The measured passage lasted {ratio:.2f} times the computed one, within 10 dB of the maximum."
        )
    return tables.table("measured_passage", "Pass-by: measured against computed", columns, note)
