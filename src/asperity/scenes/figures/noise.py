"""Rolling noise: sound power from the vibration itself and by CNOSSOS-EU, and the pass-by."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np
from xarray import DataTree

from asperity.arguments import Array
from asperity.reference.railways import HARD
from asperity.reporting import chart, data, headline, panels
from asperity.reporting.chart import INK, MUTED, Axis, Drawn, Line, Mark, Note, Panel, Rules
from asperity.reporting.figure import Lines, Of, Series, figure
from asperity.reporting.tables import ReportTable, in_digits, number_cells, table, text_cells
from asperity.scenes import schema
from asperity.scenes.figures.measured import LOOKS, limit_sentence
from asperity.scenes.figures.sources import BODIES, RAIL, WHOLE, Sources, decides, main_sources
from asperity.schema import Entry
from asperity.schema.spectra import BAND, BAND_TIME_PRODUCT
from asperity.spectra import a_weighting, energy_of, energy_sum, in_bands
from asperity.written_numbers import count_of

OWN, OWN_A = schema.RADIATED_POWER_LEVEL, schema.RADIATED_POWER_LEVEL_A
"""Sound power from the vibration that was computed, by radiator."""
UNMEASURED, UNMEASURED_A = schema.UNMEASURED_POWER_LEVEL, schema.UNMEASURED_POWER_LEVEL_A
"""The same without what was measured on the track, where something was."""
STANDARD, STANDARD_A = schema.SOUND_POWER_LEVEL, schema.SOUND_POWER_LEVEL_A
"""The same by CNOSSOS-EU, from tables by label, by source."""
ALONE, ALONE_A = schema.SINGLE_FORCE_POWER_LEVEL, schema.SINGLE_FORCE_POWER_LEVEL_A
"""The same of what would radiate under one force alone, where something moves sideways."""
PASSING = schema.PASS_BY_LEVEL
TRACK = "rail and sleepers"
OF_TRACK = ("rail", schema.RAIL_SIDEWAYS, "sleepers")
_POWER = "sound power level / dB(A) re 1 pW"
_OF_STANDARD = {"track": (1.5, 1.5), "wheel": (6, 1.5, 1.5, 1.5)}
"""Dashes of its sources, in grey."""


def parts_of(tree: DataTree, entry: Entry) -> list[str]:
    """What radiates, as ``["track", "wheel", "total"]``; nothing without the levels."""
    found = data.stored_variable(tree, entry)
    return [] if found is None else [str(name) for name in found[entry.dims[1]].values]


def _of_law(tree: DataTree, entry: Entry, law: str) -> dict[str, float]:
    """Single numbers of a law by what radiates."""
    return dict(zip(parts_of(tree, entry), data.of_law(tree, entry, law).tolist(), strict=True))


def by_part(tree: DataTree, entry: Entry) -> dict[str, float]:
    """Single numbers of the main law by what radiates; what is not known is missing."""
    found = _of_law(tree, entry, laws[0]) if (laws := data.laws(tree, entry)) else {}
    return {name: level for name, level in found.items() if np.isfinite(level)}


def _weighting(tree: DataTree) -> Iterator[Series]:
    """Column of the A-weighting over bands."""
    yield Series("A-weighting", "dB", a_weighting(data.values(tree, BAND)), BAND)


def _of_parts(
    lines: Lines, entry: Entry, law: str, dashes: Mapping[str, Any], weighting: Any = 0.0
) -> list[Line]:
    """Lines of some parts of a law, in grey."""
    return [
        Line(lines.at, series.values + weighting, series.label, MUTED, dashes[part], 1.2)
        for part in dashes
        for series in lines.of(entry, law=law, **{entry.dims[1]: part})
    ]


# --- from the vibration itself


def with_sideways(tree: DataTree) -> str:
    """Say what the parts of the total are where something moves sideways; nothing where nothing does."""
    if not data.laws(tree, ALONE_A):
        return ""
    return (
        f"The {WHOLE} holds all motion: the rail up and down and sideways, the sleepers, and the wheel under "
        "both forces at once. What would radiate if one force alone acted is no part of it: both move the "
        "same modes, and the lateral one damps the axial ones."
    )


def silence(tree: DataTree) -> str:
    """Say why the wheel's part is missing; nothing where it is there."""
    found = data.stored_variable(tree, OWN)
    reason = "computed" if found is None else str(found.attrs.get("wheel", "computed"))
    if reason == "computed":
        return ""
    return f"The wheel's part is missing, and the total is that of rail and sleepers: {reason}."


def with_measured(tree: DataTree) -> str:
    """Say that what was measured on the track is in the sound power; nothing where nothing was."""
    if not data.present(tree, UNMEASURED_A):
        return ""
    return (
        "Rail and sleepers follow what was measured on the track, in the bands in which it was: the table "
        '"Track: measured against computed" says by how much.'
    )


def _standard_there(tree: DataTree) -> Iterator[Series]:
    """What CNOSSOS-EU has in the bands of the vibration."""
    by_tables = Of(STANDARD, "{source} by CNOSSOS-EU, {law}", "{source}, CNOSSOS-EU", optional=True)
    for series in by_tables(tree):
        found = in_bands(data.values(tree, BAND), data.values(tree, schema.NOISE_BAND), series.values)
        if np.isfinite(found).any():
            yield Series(series.name, series.units, found, STANDARD, series.label, series.places)


@figure(
    "Sound power from vibration in one-third octaves",
    Of(BAND, "band centre"),
    _weighting,
    panels.products(BAND_TIME_PRODUCT),
    Of(OWN, "{radiator}, {law}", "{radiator}"),
    Of(UNMEASURED, "{radiator} without what was measured, {law}", "{radiator}", optional=True),
    Of(ALONE, "{single_force}, {law}", "{single_force}", optional=True),
    _standard_there,
)
def radiated_power_bands(tree: DataTree, lines: Lines) -> Drawn:
    """A-weighted sound power of the main law per one-third octave, by what radiates, beside CNOSSOS-EU."""
    main = data.main_law(tree, OWN)
    (weighting,) = (series.values for series in lines.of(BAND))
    own = [
        Line(lines.at, series.values + weighting, series.label, *LOOKS.get(series.label, ()))
        for series in lines.of(OWN, ALONE, law=main)
    ]
    for series in lines.of(UNMEASURED, law=main, radiator="rail"):
        look = chart.VERMILLION, (9.0, 1.5), 1.3
        own.append(Line(lines.at, series.values + weighting, "rail, nothing measured", *look))
    standard = _of_parts(lines, STANDARD, main, _OF_STANDARD | {WHOLE: (5, 2)}, weighting)
    own += [replace(line, width=1.6 if line.label.startswith(WHOLE) else 1.3) for line in standard]
    yield panels.band_panel(tree, lines, _POWER, own)
    yield (
        f"A-weighted one-third octaves of {main}: the contact force on two rails moves them "
        "and their sleepers along the whole track, and each part radiates by its radiation ratio."
    )
    yield from (silence(tree), with_measured(tree), with_sideways(tree))
    if data.laws(tree, STANDARD):
        yield (
            "Grey: the same force by CNOSSOS-EU, of a track and a wheel that it knows by a label; its "
            "transfer functions hold lateral motion of the rail, and wheels that resonate."
        )
    yield panels.shaded_words(tree)


_PARTS = (*OF_TRACK, TRACK, "wheel", WHOLE)
_MODELS = {"by vibration": OWN_A, "nothing measured": UNMEASURED_A, "by CNOSSOS-EU": STANDARD_A}


def _powers(tree: DataTree) -> dict[tuple[str, str], dict[str, float]]:
    """A-weighted sound power by what radiates, of each law by each model."""
    found = {}
    for model, entry in _MODELS.items():
        for law in data.laws(tree, entry):
            levels = _of_law(tree, entry, law)
            both = levels.get("track") or energy_sum([levels[part] for part in OF_TRACK if part in levels])
            found[law, model] = {TRACK: float(both)} | levels
    standard = data.stored_variable(tree, schema.CNOSSOS_SOUND_POWER_LEVEL_A)
    if standard is not None:
        track, wheel, whole = standard.values.tolist()
        model = f"its contact filter, {standard.attrs['contact_filter']}"
        found["CNOSSOS-EU", model] = {TRACK: track, "wheel": wheel, WHOLE: whole}
    return found


def sound_power_table(tree: DataTree, main: bool = False) -> ReportTable:
    """A-weighted sound power by what radiates, per law and model, or of the main law alone."""
    powers = _powers(tree)
    if not powers:
        raise data.Missing(OWN_A.path)
    laws = list(dict.fromkeys(law for law, _ in powers))
    rows = {of: levels for of, levels in powers.items() if not main or of[0] == laws[0]}
    names, models = zip(*rows, strict=True)
    columns = {"law": text_cells(names, "name"), "model": text_cells(models)}
    for part in _PARTS:
        if any(part in levels for levels in rows.values()):
            columns[part] = number_cells((each.get(part, np.nan) for each in rows.values()), "{:.1f}")
    for base in [] if main else data.baselines_among(tree, laws):
        over = [
            levels[WHOLE] - powers[base, model][WHOLE] if law != base and (base, model) in powers else np.nan
            for (law, model), levels in rows.items()
        ]
        if np.isfinite(over).any():
            columns[f"over {base}"] = number_cells(over, data.signed)
    note = "dB(A) re 1 pW, over the bands that were computed" + (
        "." if main else "; differences of the total."
    )
    note = " ".join(filter(None, [note, silence(tree), with_measured(tree), with_sideways(tree)]))
    title = f"Sound power by source{f', {laws[0]}' if main else ''}"
    return table("sound_power_of_main_law" if main else "sound_power", title, columns, note)


# --- the pass-by: level over time beside the track, and its single numbers

SPAN = 30.0
"""dB below the maximum that are drawn."""
SINGLE_NUMBERS = {
    "L_pAFmax / dB(A)": schema.PASS_BY_MAXIMUM_LEVEL,
    "L_pAeq,Tp / dB(A)": schema.PASS_BY_EQUIVALENT_LEVEL,
    "TEL / dB(A)": schema.TRANSIT_EXPOSURE_LEVEL,
    "SEL / dB(A)": schema.SOUND_EXPOSURE_LEVEL_A,
}
MEASURED = {
    "L_pAFmax / dB(A)": schema.MEASURED_MAXIMUM_LEVEL,
    "L_pAeq,Tp / dB(A)": schema.MEASURED_EQUIVALENT_LEVEL,
    "TEL / dB(A)": schema.MEASURED_EXPOSURE_LEVEL,
}


def _passing_parts(tree: DataTree) -> list[str]:
    """What radiates and is known, and all of it together as the last."""
    found = data.stored_variable(tree, PASSING)
    if found is None:
        return []
    return [str(found["radiator"].values[n]) for n in data.with_numbers(found, "radiator")]


@figure("Level beside the track", Of(schema.PASS_BY_TIME, "time"), Of(PASSING, "{radiator}, {law}"))
def pass_by_level(tree: DataTree, lines: Lines) -> Drawn:
    """Level over time: the total by each law, the parts of the main law, and when axles pass."""
    *parts, whole = _passing_parts(tree)
    main = data.main_law(tree, PASSING)
    totals = panels.styled(tree, lines.at, lines.of(PASSING, radiator=whole))
    of_parts = [
        Line(lines.at, series.values, series.label, width=1.6, **look)  # in no colour of a law
        for part, look in zip(parts, chart.sequence_styles(len(parts)), strict=True)
        for series in lines.of(PASSING, law=main, radiator=part)
    ]
    label = "sound pressure level, F / dB(A) re 20 µPa"
    axis = panels.levels_axis(label, [line.y for line in totals], span=SPAN, step=5.0)
    time = Axis("time since the first axle was opposite / s", lines.at[0], lines.at[-1])
    axles = data.values(tree, schema.AXLE_TIME)
    yield Panel(time, axis, (*_train(tree, axles), *totals, *of_parts), height=4.2)
    passing = "One axle passes (tick), two wheels on it"
    if len(axles) > 1:
        passing = f"{count_of(len(axles), 'axle')} pass (ticks), two wheels on each"
    away, above = (data.number(tree, fact) for fact in (schema.RECEIVER_DISTANCE, schema.RECEIVER_HEIGHT))
    where = ""
    if away is not None and above is not None:
        where = f", {away:g} m from the middle of the track and {above:g} m above the rail head"
    if offset := data.number(tree, schema.RECEIVER_OFFSET):
        where += f", which adds {offset:+g} dB"
    lost = data.number(tree, schema.FAR_RAIL_SCREENING)
    screened = f"the farther rail is screened by {lost:g} dB" if lost else "nothing screens them"
    ground, directions = (data.stated(tree, fact) for fact in (schema.GROUND, schema.DIRECTIVITY))
    yield (
        f"{passing}{where}; ground: {ground or HARD}, directivity: "
        f"{directions or 'none'}. Rail and sleepers radiate along the track as its vibration decays, a wheel "
        f"from its axle; {screened}."
    )


def _train(tree: DataTree, axles: Array) -> list[Mark]:
    """Short rules where axles are opposite, and the pass-by time behind the lines."""
    passing = Rules(axles, colour=INK, dashes=(), width=1.4, short=True)
    front, rear = (data.number(tree, end) for end in (schema.FRONT_TIME, schema.REAR_TIME))
    if front is None or rear is None:
        return [passing]
    named = Note(f"Tp = {rear - front:.2f} s", 0.5 * (front + rear), 0.06, y_share=True, align="center")
    return [panels.shade(np.array([front]), np.array([rear]), opacity=0.6), named, passing]


def pass_by_table(tree: DataTree) -> ReportTable:
    """Single numbers of the pass-by, per law, and of each part by the main law."""
    laws = data.held_laws(tree, PASSING)
    *parts, whole = _passing_parts(tree)
    shown = [(law, whole) for law in laws] + [(laws[0], part) for part in parts]
    heard = {head: data.number(tree, each) for head, each in MEASURED.items()}
    beside = any(level is not None for level in heard.values())
    further = [("measured", "all"), ("computed over measured", whole)] if beside else []
    names, radiating = zip(*shown, *further, strict=True)
    columns = {"law": text_cells(names, "name"), "what radiates": text_cells(radiating)}
    for head, entry in SINGLE_NUMBERS.items():
        if data.present(tree, entry):
            found = data.variable_of(tree, entry)
            own = heard.get(head) or np.nan
            level = [float(found.sel(law=law, radiator=part)) for law, part in shown]
            columns[head] = number_cells([*level, own] if beside else level, "{:.1f}")
            columns[head] += number_cells([level[0] - own] if beside else [], data.signed)
    note = (
        "Re 20 µPa, SEL in 1 s. L_pAFmax: the largest level, time weighting F. SEL: all of the passage. "
        "L_pAeq,Tp: from when the front of the train is opposite to when its rear is; TEL: all between the "
        "points 10 dB down, over the same time (ISO 3095)."
    )
    return table("pass_by_table", "Single numbers", columns, note)


# --- what the report says first


def noise_answers(tree: DataTree) -> headline.Answers | None:
    """Sound power of the main law by both models, and what decides it."""
    if (powers := sound_power_table(tree, main=True)) is None:
        return None
    of = main_sources(tree, OWN_A)
    by_tables = by_part(tree, STANDARD_A)
    cards = []
    if of is not None:
        held = "from vibration" if "wheel" in of.parts else "from vibration, without the wheel"
        note = f"re 1 pW; {held}: {of.in_words}{_otherwise(tree, of.whole)}"
        cards.append(headline.HeadlineNumber("sound power, own radiation model", _written(of.whole), note))
    if WHOLE in by_tables:
        note = "re 1 pW; track and wheel by its tables, from the computed contact force"
        cards.append(headline.HeadlineNumber("sound power, CNOSSOS-EU", _written(by_tables[WHOLE]), note))
    return headline.Answers(_by_vibration(tree, of), silence(tree), tuple(cards), (powers,))


def _written(level: float) -> str:
    return f"{level:.1f} dB(A)"


def _otherwise(tree: DataTree, whole: float) -> str:
    """What the total would be without what was measured on the track, and without motion sideways."""
    told = ""
    if (plain := by_part(tree, UNMEASURED_A).get(WHOLE)) is not None:
        told += f"; track as measured, {data.signed(plain - whole)} dB if all is computed: {_written(plain)}"
    if (vertical := by_part(tree, ALONE_A).get(schema.VERTICAL_MOTION)) is not None:
        told += f"; {schema.VERTICAL_MOTION} {_written(vertical)}"
    return told


def _by_vibration(tree: DataTree, of: Sources | None) -> str:
    """Say what radiates most by its own vibration, or what is about equal, and in which bands."""
    if of is None or not of.bodies:
        return ""
    names = of.loudest
    without = "" if "wheel" in of.parts else " without the wheel"
    sideways = schema.RAIL_SIDEWAYS in of.parts
    levels = " and ".join(
        f"{of.bodies[name][0]:.1f}{' (sideways too)' if sideways and name == RAIL else ''}" for name in names
    )
    of_whole = f"{levels} of {_written(of.whole)} of sound power{without}"
    share = "half of it"
    parts = [part for name in names for part in BODIES[name] if part in of.parts]
    if len(names) > 1:
        share = "half of these"
    return f"By vibration {decides(names)}: {of_whole}, {share} in {_bands(tree, parts)}."


def _bands(tree: DataTree, parts: Sequence[str]) -> str:
    """Bands that hold half the A-weighted sound power of what radiates together, by the main law."""
    band = data.values(tree, BAND)
    names = parts_of(tree, OWN)
    levels = data.of_law(tree, OWN, data.main_law(tree, OWN))[[names.index(part) for part in parts]]
    return headline.deciding_bands(band, energy_sum(levels, axis=0) + a_weighting(band))


_HEADLINES = {"TEL": schema.TRANSIT_EXPOSURE_LEVEL, "L_pAFmax": schema.PASS_BY_MAXIMUM_LEVEL}
"""Single numbers; the first only of a vehicle, whose length is known."""


def pass_by_answers(tree: DataTree) -> headline.Answers | None:
    """Level beside the track by the main law."""
    found = {name: of for name, entry in _HEADLINES.items() if (of := main_sources(tree, entry)) is not None}
    if not found:
        return None
    (first, of), *others = found.items()
    away = data.number(tree, schema.RECEIVER_DISTANCE)
    where = "" if away is None else f", {away:g} m from the track"
    told = "".join(f"; {name} {_written(other.whole)}" for name, other in others)
    held = "" if "wheel" in of.parts else ", without the wheel"
    heard = data.number(tree, MEASURED[f"{first} / dB(A)"])
    measured = "" if heard is None else f"; {first} measured {_written(heard)}"
    note = f"re 20 µPa{where}{told}{measured}; own radiation model{held}: {of.in_words}"
    number = headline.HeadlineNumber(f"pass-by, {first}", _written(of.whole), note)
    return headline.Answers(more=limit_sentence(tree), numbers=(number,))


# --- the wheel, mode by mode


LOUDEST = 10
"""Modes that have a line of their own."""


def wheel_table(tree: DataTree) -> ReportTable:
    """The loudest modes of the wheels by the main law, and all others together."""
    laws = data.held_laws(tree, schema.WHEEL_MODE_POWER_LEVEL_A)
    level = np.nan_to_num(data.of_law(tree, schema.WHEEL_MODE_POWER_LEVEL_A, laws[0]), nan=-np.inf)
    frequency, damping, diameters = (
        data.values(tree, each)
        for each in (schema.WHEEL_MODE_FREQUENCY, schema.WHEEL_MODE_DAMPING, schema.WHEEL_MODE_DIAMETERS)
    )
    order = np.argsort(-level, kind="stable")
    shown = order[:LOUDEST]
    rest = order[LOUDEST:]
    more = [count_of(len(rest), "other")] * (len(rest) > 0)
    names = [f"{frequency[k]:.0f} Hz" if frequency[k] else "rigid motion" for k in shown]
    levels = np.append(level[shown], [energy_sum(level[rest])] * (len(rest) > 0))
    share = 100.0 * energy_of(levels - energy_sum(level))
    columns = {
        "mode at": text_cells(names + more),
        "nodal diameters": number_cells([*diameters[shown], *[np.nan] * len(more)], "{:.0f}"),
        "damping ratio": number_cells(
            [*np.where(frequency, damping, np.nan)[shown], *[np.nan] * len(more)], in_digits(2)
        ),
        "dB(A)": number_cells(levels, "{:.1f}"),
        "share / %": number_cells(share, "{:.1f}"),
    }
    note = (
        f"A-weighted sound power of the wheels of all axles, dB re 1 pW, by {laws[0]}, over the bands that "
        "were computed. Frequencies are those of the wheel at rest: seen from the contact, a mode with n "
        "nodal diameters rings n times the turning speed beside it, above and below."
    )
    return table("wheel_modes_table", "The wheel, mode by mode", columns, note)
