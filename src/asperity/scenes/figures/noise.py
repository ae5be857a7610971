"""Rolling noise: sound power from the vibration itself and by CNOSSOS-EU, and the pass-by."""

from collections.abc import Iterator, Mapping
from dataclasses import replace
from typing import Any

import numpy as np
from xarray import DataTree

from asperity.reference.grounds import HARD
from asperity.reporting import chart, data, headline, panels
from asperity.reporting.chart import INK, MUTED, Axis, Line, Mark, Note, Panel, Rules
from asperity.reporting.figure import Figure, Lines, Of, Series
from asperity.reporting.tables import Cell, ReportTable, number_cells, table, text_cells
from asperity.scenes import schema
from asperity.scenes.figures.measured import LOOKS, compared_numbers, limit_sentence
from asperity.schema import Entry
from asperity.schema.spectra import BAND, BAND_TIME_PRODUCT
from asperity.spectra import a_weighting, energy_sum

OWN, OWN_A = schema.RADIATED_POWER_LEVEL, schema.RADIATED_POWER_LEVEL_A
"""Sound power from the vibration that was computed, by radiator."""
UNMEASURED, UNMEASURED_A = schema.UNMEASURED_POWER_LEVEL, schema.UNMEASURED_POWER_LEVEL_A
"""The same without what was measured on the track, where something was."""
STANDARD, STANDARD_A = schema.SOUND_POWER_LEVEL, schema.SOUND_POWER_LEVEL_A
"""The same by CNOSSOS-EU, from tables by label, by source."""
SIDE, SIDE_A = schema.LATERAL_POWER_LEVEL, schema.LATERAL_POWER_LEVEL_A
"""The same of what moves sideways, and with it."""
PASSING = schema.PASS_BY_LEVEL
WHOLE, TRACK, BOTH = "total", "rail and sleepers", ("rail", "sleepers")
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


def _levels_table(
    words: tuple[str, str, str],
    rows: Mapping[str, Mapping[str, float]],
    note: str,
    more: Mapping[str, list[Cell]],
) -> ReportTable:
    """Levels in dB(A) by what radiates, a row each; name, title and first head in words, and more columns."""
    name, title, head = words
    parts = dict.fromkeys(part for levels in rows.values() for part in levels)
    levels = {
        part: number_cells((row.get(part, np.nan) for row in rows.values()), "{:.1f}") for part in parts
    }
    return table(name, title, {head: text_cells(rows), **levels, **more}, note)


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


# --- by CNOSSOS-EU


def sound_power_table(tree: DataTree) -> ReportTable | None:
    """A-weighted sound power per law and source, and of all together its differences to the linear laws."""
    laws, note = data.laws(tree, STANDARD_A), ""
    if not laws:
        return None
    rows = {law: _of_law(tree, STANDARD_A, law) for law in laws}
    standard = data.stored_variable(tree, schema.CNOSSOS_SOUND_POWER_LEVEL_A)
    if standard is not None:
        rows["CNOSSOS-EU"] = {part: float(standard.sel(source=part)) for part in parts_of(tree, STANDARD_A)}
        name = standard.attrs.get("contact_filter", "")
        note = f" Last row: the same roughness with the contact filter of CNOSSOS-EU itself ({name})."
    totals = {law: levels[WHOLE] for law, levels in rows.items()}
    over = {
        f"over {base}": number_cells(
            (np.nan if law == base else level - totals[base] for law, level in totals.items()), data.signed
        )
        for base in data.baselines_among(tree, laws)
    }
    note = (
        f"dB(A) re 1 pW, over the bands that were computed; differences of the {WHOLE}. Positive: linear "
        f"contact underestimates.{note}"
    )
    words = "sound_power_table", "Sound power by CNOSSOS-EU, A-weighted", "law"
    return _levels_table(words, rows, note, over)


# --- from the vibration itself


def with_sideways(tree: DataTree) -> str:
    """Say what the total with sideways holds; nothing where nothing moves so."""
    if not data.laws(tree, SIDE_A):
        return ""
    return (
        f"The {WHOLE} is that of vertical motion; in the {schema.WITH_SIDEWAYS} the rail radiates sideways, "
        "too, and the wheel answers to both forces instead of the vertical one, which damps its axial modes."
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
    for series in Of(STANDARD, "{source} by CNOSSOS-EU, {law}", "{source}, CNOSSOS-EU")(tree):
        at = np.abs(data.values(tree, BAND)[:, None] / data.values(tree, schema.NOISE_BAND) - 1.0) < 0.01
        found = np.where(at.any(axis=1), series.values[at.argmax(axis=1)], np.nan)
        if np.isfinite(found).any():
            yield Series(series.name, series.units, found, STANDARD, series.label, series.places)


def _own_bands(tree: DataTree, lines: Lines) -> list[Panel]:
    """A-weighted sound power of the main law per one-third octave, by what radiates, beside CNOSSOS-EU."""
    main, (weighting,) = data.laws(tree, OWN)[0], (series.values for series in lines.of(BAND))
    own = [
        Line(lines.at, series.values + weighting, series.label, *LOOKS.get(series.label, ()))
        for series in lines.of(OWN, SIDE, law=main)
        if series.label != schema.WHEEL_VERTICAL
    ]
    for series in lines.of(UNMEASURED, law=main, radiator="rail"):
        look = chart.VERMILLION, (9.0, 1.5), 1.3
        own.append(Line(lines.at, series.values + weighting, "rail, nothing measured", *look))
    standard = _of_parts(lines, STANDARD, main, _OF_STANDARD | {WHOLE: (5, 2)}, weighting)
    own += [replace(line, width=1.6 if line.label.startswith(WHOLE) else 1.3) for line in standard]
    return [panels.band_panel(tree, lines, _POWER, own)]


def _own_caption(tree: DataTree) -> str:
    told = [
        f"A-weighted one-third octaves of {data.laws(tree, OWN)[0]}, vertical motion: the contact force on "
        "two rails moves them and their sleepers along the whole track, and each part radiates by its "
        "radiation ratio.",
        silence(tree),
        with_measured(tree),
        with_sideways(tree),
    ]
    if data.laws(tree, STANDARD):
        told.append(
            "Grey: the same force by CNOSSOS-EU, of a track and a wheel that it knows by a label; its "
            "transfer functions hold lateral motion of the rail, and wheels that resonate."
        )
    return " ".join(filter(None, told)) + panels.shaded_words(tree)


RADIATED = Figure(
    "radiated_power_bands",
    "Sound power from vibration in one-third octaves",
    Of(BAND, "band centre"),
    (
        _weighting,
        panels.products(BAND_TIME_PRODUCT),
        Of(OWN, "{radiator}, {law}", "{radiator}"),
        Of(UNMEASURED, "{radiator} without what was measured, {law}", "{radiator}", optional=True),
        Of(SIDE, "{radiator}, {law}", "{radiator}", optional=True),
        _standard_there,
    ),
    _own_bands,
    _own_caption,
)


def radiated_table(tree: DataTree) -> ReportTable | None:
    """A-weighted sound power per law and radiator."""
    laws, beside, sideways = (data.laws(tree, entry) for entry in (OWN_A, UNMEASURED_A, SIDE_A))
    if not laws:
        return None
    measured = ", track as measured" if beside else ""
    rows = {
        f"{law}{measured}": _of_law(tree, OWN_A, law)
        | (_of_law(tree, SIDE_A, law) if law in sideways else {})
        for law in laws
    }
    rows |= {f"{law}, all computed": _of_law(tree, UNMEASURED_A, law) for law in beside}
    for levels in rows.values():
        levels.pop(schema.WHEEL_VERTICAL, None)
    told = " ".join(filter(None, [silence(tree), with_measured(tree), with_sideways(tree)]))
    note = f"dB(A) re 1 pW, over the bands that were computed. {told}"
    words = "radiated_power_table", "Sound power from vibration, A-weighted", "law"
    return _levels_table(words, rows, note, {})


# --- the pass-by: level over time beside the track, and its single numbers

SPAN = 30.0
"""dB below the maximum that are drawn."""
SINGLE_NUMBERS = {
    "L_pAFmax / dB(A)": schema.PASS_BY_MAXIMUM_LEVEL,
    "L_pAeq,Tp / dB(A)": schema.PASS_BY_EQUIVALENT_LEVEL,
    "TEL / dB(A)": schema.TRANSIT_EXPOSURE_LEVEL,
    "SEL / dB(A)": schema.SOUND_EXPOSURE_LEVEL_A,
}


def _passing_parts(tree: DataTree) -> list[str]:
    """What radiates and is known, and all of it together as the last."""
    found = data.stored_variable(tree, PASSING)
    if found is None:
        return []
    return [str(found["radiator"].values[n]) for n in data.with_numbers(found, "radiator")]


def _pass_by(tree: DataTree, lines: Lines) -> list[Panel]:
    """Level over time: the total by each law, the parts of the main law, and when axles pass."""
    *parts, whole = _passing_parts(tree)
    totals = panels.styled(tree, lines.at, lines.of(PASSING, radiator=whole))
    dashes = {part: LOOKS[part][1] for part in parts}
    of_parts = _of_parts(lines, PASSING, data.laws(tree, PASSING)[0], dashes)
    label = "sound pressure level, F / dB(A) re 20 µPa"
    axis = panels.levels_axis(label, [line.y for line in totals], span=SPAN, step=5.0)
    time = Axis("time since the first axle was opposite / s", lines.at[0], lines.at[-1])
    return [Panel(time, axis, (*_train(tree), *totals, *of_parts), height=4.2)]


def _train(tree: DataTree) -> list[Mark]:
    """Short rules where axles are opposite, and the pass-by time behind the lines."""
    axles = data.values(tree, schema.AXLE_TIME)
    passing = Rules(axles, colour=INK, dashes=(), width=1.4, short=True)
    front, rear = (data.number(tree, end) for end in (schema.FRONT_TIME, schema.REAR_TIME))
    if front is None or rear is None:
        return [passing]
    named = Note(f"Tp = {rear - front:.2f} s", 0.5 * (front + rear), 0.06, y_share=True, align="center")
    return [panels.shade(np.array([front]), np.array([rear]), opacity=0.6), named, passing]


def _pass_by_caption(tree: DataTree) -> str:
    count = len(data.values(tree, schema.AXLE_TIME))
    passing = "One axle passes" if count == 1 else f"{count} axles pass"
    away, above = (data.number(tree, fact) for fact in (schema.RECEIVER_DISTANCE, schema.RECEIVER_HEIGHT))
    where = ""
    if away is not None and above is not None:
        where = f", {away:g} m from the middle of the track and {above:g} m above the rail head"
    ground, directions = (data.stated(tree, fact) for fact in (schema.GROUND, schema.DIRECTIVITY))
    return (
        f"{passing} (ticks), two wheels on each{where}; ground: {ground or HARD}, directivity: "
        f"{directions or 'none'}. Rail and sleepers radiate along the track as its vibration decays, a wheel "
        "from its axle; nothing screens them."
    )


def pass_by_table(tree: DataTree) -> ReportTable | None:
    """Single numbers of the pass-by, per law, and of each part by the main law."""
    laws = data.laws(tree, PASSING)
    if not laws:
        return None
    *parts, whole = _passing_parts(tree)
    shown = [(law, whole) for law in laws] + [(laws[0], part) for part in parts]
    names, radiating = zip(*shown, strict=True)
    columns = {"law": text_cells(names), "what radiates": text_cells(radiating)}
    for head, entry in SINGLE_NUMBERS.items():
        if data.present(tree, entry):
            found = data.variable_of(tree, entry)
            level = [float(found.sel(law=law, radiator=part)) for law, part in shown]
            columns[head] = number_cells(level, "{:.1f}")
    note = (
        "Re 20 µPa, SEL in 1 s. L_pAFmax: the largest level, time weighting F. SEL: all of the passage. "
        "L_pAeq,Tp: from when the front of the train is opposite to when its rear is; TEL: all between the "
        "points 10 dB down, over the same time (ISO 3095)."
    )
    return table("pass_by_table", "Single numbers", columns, note)


PASS_BY = Figure(
    "pass_by_level",
    "Level beside the track",
    Of(schema.PASS_BY_TIME, "time"),
    (Of(PASSING, "{radiator}, {law}"),),
    _pass_by,
    _pass_by_caption,
    (schema.AXLE_TIME,),
)


# --- what the report says first


def noise_answers(tree: DataTree) -> headline.Answers | None:
    """Sound power of the main law by both models, and what decides it."""
    own, standard = by_part(tree, OWN_A), by_part(tree, STANDARD_A)
    if not own and not standard:
        return None
    side, whole = by_part(tree, SIDE_A), own
    lead, more = _by_vibration(tree, own, side)
    held = "rail, sleepers and wheel" if "wheel" in own else f"{TRACK}, without the wheel"
    plain = by_part(tree, UNMEASURED_A).get(WHOLE)
    beside = "" if plain is None else f"; track as measured, {plain:.1f} dB(A) if all is computed"
    if schema.WITH_SIDEWAYS in side and WHOLE in own:
        whole = {WHOLE: side[schema.WITH_SIDEWAYS]}
        beside += f"; vertical motion alone {own[WHOLE]:.1f} dB(A)"
    by_tables = "re 1 pW; track and wheel by its tables, from the computed contact force"
    models = (
        ("own radiation model", whole, f"re 1 pW; {held}, from their computed vibration{beside}"),
        ("CNOSSOS-EU", standard, by_tables),
    )
    cards = tuple(
        headline.HeadlineNumber(f"sound power, {how}", f"{of[WHOLE]:.1f} dB(A)", note)
        for how, of, note in models
        if WHOLE in of
    )
    return headline.Answers(lead, more, cards, (_sources_table(own | side, standard),))


def _by_vibration(tree: DataTree, own: Mapping[str, float], side: Mapping[str, float]) -> tuple[str, str]:
    """Say what radiates most by its own vibration, and in which bands; then what is beside it."""
    parts = {name: level for name, level in own.items() if name != WHOLE}
    if not parts:
        return "", ""
    most = max(parts, key=lambda name: parts[name])
    verb, with_side = "decide" if most == "sleepers" else "decides", ""
    if schema.WITH_SIDEWAYS in side:
        told = [f"{n} {side[n]:.1f}" for n in (schema.RAIL_SIDEWAYS, schema.WHEEL_BOTH) if n in side]
        with_side = f"With motion sideways it is {side[schema.WITH_SIDEWAYS]:.1f} dB(A): {'; '.join(told)}."
    lead = (
        f"By vibration the {most} {verb}: {parts[most]:.1f} of {own.get(WHOLE, parts[most]):.1f} dB(A) of "
        f"sound power, half of it in the bands of {_bands(tree, most)}."
    )
    return lead, " ".join(filter(None, [with_side, silence(tree)]))


def _bands(tree: DataTree, part: str) -> str:
    """Bands that hold half the A-weighted sound power of what radiates, by the main law."""
    band = data.values(tree, BAND)
    level = data.of_law(tree, OWN, data.laws(tree, OWN)[0])[parts_of(tree, OWN).index(part)]
    return headline.deciding_bands(band, level + a_weighting(band))


def _sources_table(own: Mapping[str, float], standard: Mapping[str, float]) -> ReportTable:
    """Sound power by source and model."""
    both = [own[name] for name in BOTH if name in own]
    track = {TRACK: float(energy_sum(both))} if len(both) == 2 else {}
    by_label = {TRACK: standard["track"]} if "track" in standard else {}
    models = {"by vibration, own model": {**own, **track}, "by CNOSSOS-EU": {**standard, **by_label}}
    shown = {name: levels for name, levels in models.items() if levels}
    heads = {name: name for name in (*BOTH, TRACK, "wheel")} | {WHOLE: "sum"}
    heads |= {name: name for name in (schema.RAIL_SIDEWAYS, schema.WHEEL_BOTH) if name in own}
    heads |= {schema.WITH_SIDEWAYS: "sum with sideways"} if schema.WITH_SIDEWAYS in own else {}
    rows = {
        name: {head: levels.get(part, np.nan) for part, head in heads.items()}
        for name, levels in shown.items()
    }
    note = "" if "wheel" in own or not own else "–: not known. The first sum is without the wheel."
    words = "sound_power_sources", "Sound power by source", "dB(A) re 1 pW"
    return _levels_table(words, rows, note, {})


_HEADLINES = {"TEL": schema.TRANSIT_EXPOSURE_LEVEL, "L_pAFmax": schema.PASS_BY_MAXIMUM_LEVEL}
"""Single numbers; the first only of a vehicle, whose length is known."""


def pass_by_answers(tree: DataTree) -> headline.Answers | None:
    """Level beside the track by the main law."""
    levels = {
        name: float(data.of_law(tree, entry, data.laws(tree, entry)[0])[-1])
        for name, entry in _HEADLINES.items()
        if data.present(tree, entry)
    }
    if not levels:
        return None
    (first, level), *others = levels.items()
    away = data.number(tree, schema.RECEIVER_DISTANCE)
    where = "" if away is None else f", {away:g} m from the track"
    told = "".join(f"; {name} {other:.1f} dB(A)" for name, other in others)
    held = "" if "wheel" in _passing_parts(tree) else ", without the wheel"
    heard, _ = compared_numbers(tree).get(first, (None, None))
    measured = "" if heard is None else f"; {first} measured {heard:.1f} dB(A)"
    if schema.WITH_SIDEWAYS in (parts := parts_of(tree, _HEADLINES[first])):
        entry = _HEADLINES[first]
        own = data.of_law(tree, entry, data.laws(tree, entry)[0])[parts.index(WHOLE)]
        told += f"; vertical motion alone {own:.1f} dB(A)"
    note = f"re 20 µPa{where}{told}{measured}; own radiation model{held}"
    number = headline.HeadlineNumber(f"pass-by, {first}", f"{level:.1f} dB(A)", note)
    return headline.Answers(more=limit_sentence(tree), numbers=(number,))


# --- the wheel, mode by mode


LOUDEST = 10
"""Modes that have a line of their own."""


def wheel_table(tree: DataTree) -> ReportTable | None:
    """The loudest modes of the wheels by the main law, and all others together."""
    laws = data.laws(tree, schema.WHEEL_MODE_POWER_LEVEL_A)
    if not laws:
        return None
    level = np.nan_to_num(data.of_law(tree, schema.WHEEL_MODE_POWER_LEVEL_A, laws[0]), nan=-np.inf)
    frequency, damping, diameters = (
        data.values(tree, each)
        for each in (schema.WHEEL_MODE_FREQUENCY, schema.WHEEL_MODE_DAMPING, schema.WHEEL_MODE_DIAMETERS)
    )
    order = np.argsort(-level, kind="stable")
    shown, rest = order[:LOUDEST], order[LOUDEST:]
    more = [f"{len(rest)} others"] * (len(rest) > 0)
    names = [f"{frequency[k]:.0f} Hz" if frequency[k] else "rigid motion" for k in shown]
    levels = np.append(level[shown], [energy_sum(level[rest])] * (len(rest) > 0))
    share = 100.0 * 10.0 ** ((levels - energy_sum(level)) / 10.0)
    columns = {
        "mode at": text_cells(names + more),
        "nodal diameters": number_cells([*diameters[shown], *[np.nan] * len(more)], "{:.0f}"),
        "damping ratio": number_cells(
            [*np.where(frequency, damping, np.nan)[shown], *[np.nan] * len(more)], "{:.2g}"
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
