"""What a result is held against: figures and tables of what was measured, and of the limits of TSI Noise."""

from collections.abc import Iterator
from itertools import cycle
from typing import Any

import numpy as np
from xarray import DataTree

from asperity.arguments import Array, Flags, NDArray
from asperity.reference.railways import PassByLimit
from asperity.reporting import chart, data, figure, panels, tables
from asperity.reporting.tables import Cell, ReportTable, table, text_cells
from asperity.scenes import schema
from asperity.scenes.figures.sources import WHOLE, Sources, decides, main_sources
from asperity.schema import Entry, spectra
from asperity.schema import measured as beside
from asperity.spectra import a_weighting, in_bands, nominal_frequency, root_mean_square
from asperity.units import unit_in_brackets
from asperity.written_numbers import capital, count_of, rounded

MEASURED = "measured, in one-third octaves"
_LOOK: tuple[Any, ...] = (chart.INK, (), 2.0)


def over_bands(
    entry: Entry,
    of: Entry,
    look: tuple[Any, ...] = _LOOK,
    label: str = MEASURED,
    at: Entry = schema.TRACK_FREQUENCY,
) -> figure.Columns:
    """Column of what holds for one-third octaves, at the frequencies of a figure of the track.

    As one of the figure's own `of`: a mobility as a receptance.
    """

    def columns(tree: DataTree) -> Iterator[figure.Series]:
        if not data.present(tree, entry):
            return
        frequency = data.values(tree, at)
        found = in_bands(frequency, data.values(tree, spectra.BAND), data.values(tree, entry))
        if entry.units == "(m/s)/N":
            found = found / (2.0 * np.pi * frequency)
        if np.isfinite(found).any():
            yield figure.Series(entry.name, of.units, found, of, label, look=look)

    return columns


_COLUMNS = {
    "decay rate, measured / (dB/m)": schema.MEASURED_DECAY_RATE,
    "computed": schema.EXPECTED_DECAY_RATE,
    "lateral, measured": schema.MEASURED_LATERAL_DECAY_RATE,
    "lateral, computed": schema.EXPECTED_LATERAL_DECAY_RATE,
    "mobility, measured / (dB re 1 m/(N s))": schema.MEASURED_MOBILITY,
    "computed, mid-span": schema.EXPECTED_MOBILITY,
    "linear force / dB": schema.MEASURED_FORCE_CHANGE,
    "rail and sleepers / dB": schema.MEASURED_POWER_CHANGE,
    "rail sideways / dB": schema.MEASURED_LATERAL_POWER_CHANGE,
}


def measured_table(tree: DataTree) -> tables.ReportTable:
    """Decay rate and mobility in one-third octaves, measured and computed, and what that does to the rail."""
    shown = np.isfinite(data.values(tree, schema.MEASURED_POWER_CHANGE))
    doubtful = np.zeros(shown.sum(), dtype=bool)
    columns = {"band": tables.band_cells(data.values(tree, spectra.BAND)[shown], doubtful)}
    for head, entry in _COLUMNS.items():
        if data.present(tree, entry):
            found = data.values(tree, entry)[shown]
            if entry.units == "dB":
                columns[head] = tables.change_cells(found, doubtful)
            elif entry.units == "dB/m":
                columns[head] = tables.number_cells(found, tables.in_digits(2))
            else:
                columns[head] = tables.number_cells(20.0 * np.log10(found), data.signed)
    note = (
        "Computed: what a hammer at mid-span finds on the computed track, by EN 15461. The sound power of "
        "rail and sleepers goes as |F Y|²/Δ and changes as its column says, with the force as that of a "
        "linear contact changes: on a softer rail it is smaller. That of the rail sideways goes as 1/Δ of "
        "its lateral rate. Bands that were not measured stay as computed, and so does the "
        "contact force of this run in all its figures."
    )
    apart = [
        factor * np.log10(data.values(tree, own) / data.values(tree, expected))
        for factor, own, expected in _COMPARED
        if data.present(tree, own)
    ]
    told = _deviation(np.concatenate(apart), np.full(sum(map(len, apart)), MEASURING)) if apart else ""
    return tables.table(
        "measured_track", "Track: measured against computed", columns, f"{note} {told}".strip()
    )


_COMPARED = (
    (10.0, schema.MEASURED_DECAY_RATE, schema.EXPECTED_DECAY_RATE),
    (20.0, schema.MEASURED_MOBILITY, schema.EXPECTED_MOBILITY),
)
"""dB of a factor of ten, and what is compared."""
MEASURING = 1.0
"""Standard deviation of what is measured in a band, dB, where nobody tells it: as fits take it."""
TWICE = 1.96
"""Standard deviations in half a 95 % interval."""


NEXT = "Next: asperity fit CASE, which fits keys of the case to it."


def _deviation(apart: Array, deviation: Array) -> str:
    """Say how far measured bands are from computed ones (n,), dB, and what to do where that is too far.

    With the standard deviation of each difference, dB.
    """
    if not np.isfinite(apart).any():
        return ""
    told, outside = _how_far(apart, deviation, "band")
    return f"Measured over computed: {told}. {NEXT}" if outside else f"Measured over computed: {told}."


def _how_far(apart: Array, deviation: Array, of: str) -> tuple[str, int]:
    """Say how far measured values (n,), dB, are from computed ones, and how many are too far."""
    known = np.isfinite(apart)
    outside = int(np.sum(np.abs(apart[known]) > TWICE * deviation[known]))
    rms = root_mean_square(apart[known])
    values = count_of(int(known.sum()), of)
    beyond = f"{outside} of them beyond 95 % of what measuring and chance explain"
    return f"{_decibels(rms)} dB rms in {values}, {beyond}", outside


# --- beside the track


def measured_sound_table(tree: DataTree) -> ReportTable | None:
    """Levels in one-third octaves, measured and by the main law, and how far chance explains what differs."""
    lines = pass_by_bands.collect(tree)
    named = {line.label: line.values for line in lines.lines}
    shown = np.isfinite(named["measured"]) & np.isfinite(named[WHOLE])
    if not shown.any():
        return None
    apart = (named["measured"] - named[WHOLE])[shown]
    deviation = np.hypot(data.values(tree, spectra.LEVEL_DEVIATION)[shown], MEASURING)
    doubtful = np.abs(apart) <= TWICE * deviation
    columns = {
        "band": tables.band_cells(lines.at[shown], np.zeros(len(apart), dtype=bool)),
        "measured / dB(A)": tables.number_cells(named["measured"][shown], "{:.1f}"),
        "computed / dB(A)": tables.number_cells(named[WHOLE][shown], "{:.1f}"),
        "measured over computed / dB": tables.change_cells(apart, doubtful),
        "95 % / dB": tables.number_cells(TWICE * deviation, "± {:.1f}"),
    }
    note = (
        f"Uncertainty: {MEASURING:g} dB of measuring, and the chance of the record that was computed. In "
        "brackets: differences that these explain."
    )
    told = _deviation(apart, deviation)
    return table("measured_sound", "Sound: measured against computed", columns, f"{note} {told}".strip())


def _over_pass_by(tree: DataTree) -> Iterator[figure.Series]:
    """Levels of the main law over the pass-by time, A-weighted, by what radiates; then those measured."""
    own = schema.MEASURED_BAND_LEVEL
    level = schema.SOUND_EXPOSURE_LEVEL
    band = data.values(tree, schema.PASS_BY_BAND)
    measured = data.values(tree, own)
    front, rear = (float(data.stated(tree, end)) for end in (schema.FRONT_TIME, schema.REAR_TIME))
    weighting = a_weighting(band)
    found = data.variable_of(tree, level)
    for number in data.with_numbers(found, "radiator"):
        name = str(found["radiator"].values[number])
        values = found[0, number].values
        yield figure.Series(name, _SOUND, values - 10.0 * np.log10(rear - front) + weighting, level, name)
    yield figure.Series("measured", _SOUND, measured + weighting, own, "measured")


_SOUND = "dB(A) re 20 uPa"
LOOKS: dict[str, tuple[Any, ...]] = {  # colour, dashes, width and marker of each part
    "rail": (chart.VERMILLION, (1.5, 1.5), 1.3, "o"),
    "sleepers": (chart.GREEN, (4.0, 1.5), 1.3, "s"),
    "wheel": (chart.BLUE, (6.0, 1.5, 1.5, 1.5), 1.3, "^"),
    WHOLE: (chart.INK, (), 1.8),
    schema.RAIL_SIDEWAYS: (chart.VERMILLION, (6.0, 1.5), 1.3),
    schema.BY_VERTICAL: (chart.BLUE, (6.0, 1.5, 1.5, 1.5, 1.5, 1.5), 1.3),
    schema.BY_LATERAL: (chart.BLUE, (1.5, 1.5), 1.3),
    schema.VERTICAL_MOTION: (chart.INK, (6.0, 1.5), 1.3),
    "measured": ("#a8458f", (), 2.2, "s"),
}


@figure.figure(
    "Pass-by in one-third octaves, computed and measured",
    figure.Of(schema.PASS_BY_BAND, "band centre"),
    _over_pass_by,
)
def pass_by_bands(tree: DataTree, lines: figure.Lines) -> chart.Drawn:
    """Levels by what radiates, of all of it, and those measured."""
    drawn = [chart.Line(lines.at, s.values, s.label, *LOOKS.get(s.label, ())) for s in lines.lines]
    told = [line.y for line in drawn if line.label in (WHOLE, "measured")]
    axis = panels.levels_axis("sound pressure level / dB(A) re 20 µPa", told, span=50.0)
    yield chart.Panel(panels.band_axis(lines.at), axis, tuple(drawn), height=4.0)
    yield (
        "A-weighted equivalent levels over the pass-by time. Computed: the energy of the whole passage, by "
        "the main law, all of it and by what radiates."
    )
    yield data.missing(tree, schema.MEASURED_BAND_LEVEL)


# --- whatever a case names as measured


def _values_over(entry: Entry) -> figure.Columns:
    """Columns of what stands over frequency, one of each quantity, at all frequencies of them."""

    def columns(tree: DataTree) -> Iterator[figure.Series]:
        at = _frequencies(tree)
        names = _words(tree, beside.QUANTITY)
        over = data.values(tree, beside.AT)
        found = data.values(tree, entry)
        for name in dict.fromkeys(names[_over_frequency(tree)].tolist()):
            own = names == name
            values = np.full(len(at), np.nan)
            values[np.searchsorted(at, over[own])] = found[own]
            if np.isfinite(values).any():
                yield figure.Series(f"{name}, {_NAMES[entry]}", entry.units, values, entry, name)

    return columns


_NAMES = {beside.DEVIATION: "measured over computed", beside.UNCERTAINTY: "standard deviation"}


def _over_frequency(tree: DataTree) -> Flags:
    return np.array(["Hz" in axis for axis in _words(tree, beside.AXIS)], dtype=bool)


def _words(tree: DataTree, entry: Entry) -> NDArray[np.str_]:
    return data.variable_of(tree, entry).values.astype(str)


def _frequencies(tree: DataTree) -> Array:
    """All at which something was measured, rising, Hz."""
    return np.unique(data.values(tree, beside.AT)[_over_frequency(tree)])


def _at_frequencies(tree: DataTree) -> Iterator[figure.Series]:
    yield figure.Series("frequency", "Hz", _frequencies(tree), beside.AT, "frequency")


_MARKED = ((chart.VERMILLION, "o"), (chart.BLUE, "s"), (chart.GREEN, "^"), (chart.INK, "D"))


@figure.figure(
    "Measured over computed",
    _at_frequencies,
    _values_over(beside.DEVIATION),
    _values_over(beside.UNCERTAINTY),
)
def beside_measured(tree: DataTree, lines: figure.Lines) -> chart.Drawn:
    """How far each quantity is off over frequency, and how far measuring and chance explain that."""
    apart = lines.of(beside.DEVIATION)
    deviations = lines.of(beside.UNCERTAINTY)
    if not apart:
        return
    at = lines.at
    marks: list[chart.Mark] = [panels.zero()]
    reach = []
    for (colour, marker), own, sure in zip(cycle(_MARKED), apart, deviations, strict=False):
        known = np.isfinite(own.values)
        wide = TWICE * sure.values[known]
        marks.append(chart.Area(at[known], -wide, wide, colour=colour, opacity=0.12))
        marks.append(chart.Line(at[known], own.values[known], own.label, colour, (), 1.3, marker))
        reach += [own.values[known], wide, -wide]
    axis = panels.levels_axis("measured over computed / dB", reach, step=5.0)
    ends = at[0] / panels.EDGE**2, at[-1] * panels.EDGE**2
    yield chart.Panel(panels.frequency_axis(*ends), axis, tuple(marks))
    yield (
        "By the main law. Shaded: what 95 % of measuring and of the chance of the record that was computed "
        "explain."
    )


def beside_table(tree: DataTree) -> ReportTable | None:
    """All that the case names as measured, beside what was computed, and how far chance explains the rest."""
    if not data.present(tree, beside.DEVIATION):
        return None
    words = (beside.QUANTITY, beside.AXIS, beside.UNITS)
    names, axes, units = (_words(tree, each) for each in words)
    apart = data.values(tree, beside.DEVIATION)
    deviation = data.values(tree, beside.UNCERTAINTY)
    places = zip(data.values(tree, beside.AT).tolist(), axes.tolist(), strict=True)

    def in_units(entry: Entry) -> Iterator[str]:
        """Values with their units; of levels a tenth of a decibel."""
        for value, unit in zip(data.values(tree, entry).tolist(), units.tolist(), strict=True):
            scale, shown = _SHOWN.get(unit, (1.0, unit))
            number = f"{round(value, 1) + 0.0:.1f}" if unit.startswith("dB re") else rounded(scale * value, 4)
            yield f"{number.replace('-', '−')} {shown}" if np.isfinite(value) else "–"

    plain = np.zeros(len(apart), dtype=bool)
    coarse, fine = (tables.change_cells(apart, plain, places=places) for places in (1, 3))
    differences = [fine[n] if sure < SURE else coarse[n] for n, sure in enumerate(deviation)]
    columns = {
        "quantity": text_cells(names),
        "at": text_cells(_place(at, unit_in_brackets(axis)) for at, axis in places),
        "measured": text_cells(in_units(beside.VALUE)),
        "computed": text_cells(in_units(beside.COMPUTED)),
        "measured over computed / dB": [
            Cell(f"({cell.text})", "number faint") if explained else cell
            for cell, explained in zip(differences, np.abs(apart) <= TWICE * deviation, strict=True)
        ],
        "95 % / dB": tables.number_cells(TWICE * deviation, lambda each: f"± {_decibels(each)}"),
    }
    told = list[str]()
    off = 0
    for name in dict.fromkeys(names[np.isfinite(apart)].tolist()):
        how_far, outside = _how_far(apart[names == name], deviation[names == name], "value")
        told.append(f"{capital(name)}: {how_far}.")
        off += outside
    note = (
        "By the main law. Uncertainty: that of repeats, else the usual one of the quantity, and the chance "
        "of the record that was computed. In brackets: differences that these explain."
    )
    return table(
        "beside_measured", "Measured against computed", columns, " ".join([note, *told, *[NEXT] * (off > 0)])
    )


SURE = 0.05
"""Standard deviation, dB, below which a tenth of a decibel is too coarse, as of a tone."""
_SHOWN = {"m/s": (1e6, "µm/s"), "N/m": (1e-6, "MN/m")}
"""Units in which values are read well, and how many of them make one in SI."""


def _decibels(size: float) -> str:
    """A size in decibels, finer where it is small."""
    return f"{size:.1f}" if size >= TWICE * SURE else rounded(size, 2)


def _place(at: float, unit: str) -> str:
    """Where something was measured; a third octave by its nominal frequency."""
    is_band = unit == "Hz" and abs(10.0 * np.log10(at) - round(10.0 * np.log10(at))) < 1e-6
    return nominal_frequency(at) if is_band else f"{rounded(at, 4)} {unit}"


# --- limits of TSI Noise

_ABBREVIATED = ("emu", "dmu")
_PLACES = {"": schema.NORMALISED_LEVEL, ", 3.5 m high": schema.NORMALISED_LEVEL_ABOVE}


def _vehicle(tree: DataTree) -> str:
    told = str(data.stated(tree, schema.VEHICLE) or "")
    return told.upper() if told in _ABBREVIATED else told.replace("-", " ")


def _result(tree: DataTree, of: Sources) -> tuple[str, bool | None]:
    """Whether the limit is met, and by how much; None where nothing can be said."""
    limit = data.number(tree, schema.TSI_LIMIT)
    if limit is None:
        return "no limit holds for this receiver and speed", None
    met = PassByLimit(limit, 0.0, 0.0).met(of.whole)
    margin = limit - of.whole
    if "wheel" not in of.parts:
        short = f"{abs(margin):.1f} dB {'below' if margin >= 0.0 else 'over'} the {limit:g} dB(A) allowed"
        if met:
            return f"{short} without the wheel's part, so that it is not known whether the limit is met", None
        return f"{short} even without the wheel's part", False
    if met and margin < 0.0:
        return f"met as a whole decibel, {-margin:.1f} dB over the {limit:g} dB(A) allowed", met
    return f"{abs(margin):.1f} dB {'below' if met else 'over'} the {limit:g} dB(A) allowed", met


def limit_sentence(tree: DataTree) -> str:
    """Say whether the rolling noise of the vehicle is within its limit; nothing without a type of vehicle."""
    speed = data.number(tree, schema.REFERENCE_SPEED)
    of = main_sources(tree, schema.NORMALISED_LEVEL)
    if of is None or speed is None:
        return ""
    alone = "alone" if "wheel" in of.parts else "without the wheel"
    failed = [str(each.get("condition")) for each in _conditions(tree) if not each.get("met")]
    told = f" Not as a test asks: {', '.join(failed)}." if failed else ""
    if (above := main_sources(tree, schema.NORMALISED_LEVEL_ABOVE)) is not None:
        told = f" At 3.5 m height it has {above.whole:.1f} dB(A), {_result(tree, above)[0]}.{told}"
    return (
        f"TSI Noise, {_vehicle(tree)}: rolling noise {alone} has {of.whole:.1f} dB(A) at "
        f"{3.6 * speed:.0f} km/h, {_result(tree, of)[0]}; {decides(of.loudest)}.{told}"
    )


def _conditions(tree: DataTree) -> list[dict[str, Any]]:
    return data.json_list(tree, schema.REFERENCE_CONDITIONS)


def _verdict(met: object) -> Cell:
    return Cell("–") if met is None else Cell("yes") if met else Cell("no", "off")


def limits_table(tree: DataTree) -> ReportTable | None:
    """Level and limit of the vehicle, by source, and the conditions of ISO 3095."""
    conditions = _conditions(tree)
    speed = data.number(tree, schema.REFERENCE_SPEED)
    rows: list[dict[str, Any]] = []
    for place, entry in _PLACES.items():
        if speed is not None and (of := main_sources(tree, entry)) is not None:
            told, met = _result(tree, of)
            here = f"{of.whole:.1f} dB(A): {of.in_words}"
            what = f"L_pAeq,Tp at {3.6 * speed:.0f} km/h{place}"
            rows.append({"condition": what, "here": here, "asked": told, "met": met})
    if not rows:
        return None
    rows += conditions
    columns = {
        "what": text_cells(row.get("condition") for row in rows),
        "here": text_cells(row.get("here") for row in rows),
        "asked": text_cells(row.get("asked") for row in rows),
        "met": [_verdict(row.get("met")) for row in rows],
    }
    note = (
        f"{capital(_vehicle(tree))}, main law: rolling noise alone, to which traction and air add. "
        "Normalised by 30 lg v, from 250 km/h on by 50 lg v, of wagons to 0.225 axles per metre, and "
        "compared as a whole decibel (Regulation (EU) No 1304/2014, points 4.2.3 and 6.2.2.3). Where "
        "roughness or decay rate are not as asked, a measured level would be marked non-comparable."
    )
    return table("limits", "Limit of TSI Noise, and conditions of a test", columns, note)
