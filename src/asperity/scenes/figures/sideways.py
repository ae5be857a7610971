"""What moves sideways: lateral force and friction, receptances and decay, and its part of the noise."""

from collections.abc import Iterator
from typing import Any

import numpy as np
from xarray import DataTree

from asperity.reporting import chart, data, panels
from asperity.reporting.chart import INK, MUTED, Line, Mark, Note, Panel, Rules
from asperity.reporting.figure import Figure, Lines, Of
from asperity.reporting.tables import ReportTable, number_cells, table, text_cells
from asperity.scenes import schema
from asperity.scenes.figures.measured import over_bands
from asperity.schema import spectra
from asperity.spectra import a_weighting

FORCE, POWER, POWER_A = schema.LATERAL_FORCE_LEVEL, schema.LATERAL_POWER_LEVEL, schema.LATERAL_POWER_LEVEL_A
RAIL, VERTICAL, BOTH, WHOLE = schema.SIDEWAYS_RADIATORS
UP = "rail up and down"


def _force(tree: DataTree, lines: Lines) -> Iterator[Panel]:
    """Lateral force of each law per one-third octave, the vertical one of the main law, and friction."""
    lateral = panels.styled(tree, lines.at, lines.of(FORCE), markers=True)
    main = data.laws(tree, FORCE)[0]
    vertical = [
        Line(lines.at, series.values, f"vertical, {main}", MUTED, (6, 1.5), 1.2)
        for series in lines.of(spectra.FORCE_LEVEL, law=main)
    ]
    marks: list[Mark] = [*lateral, *vertical]
    every = [line.y for line in (*lateral, *vertical)]
    if limit := data.number(tree, schema.SLIP_FORCE):
        level = 20.0 * np.log10(limit)
        marks += [Rules(np.array([level]), "y"), Note("friction of the static load", lines.at[0], level)]
        every.append(np.array([level]))
    shades = panels.doubtful_boxes(lines.at, data.doubtful(tree, spectra.BAND_TIME_PRODUCT))
    axis = panels.levels_axis("contact force level / dB re 1 N", every)
    yield Panel(panels.band_axis(lines.at), axis, (*shades, *marks), height=4.4)


def _force_caption(tree: DataTree) -> str:
    facts = schema.CONTACT_PLACE, schema.RAIL_CONTACT_PLACE, schema.STICK_STIFFNESS
    place, head, stiffness = (data.number(tree, fact) for fact in facts)
    told = ""
    if place is not None and stiffness is not None:
        own = "" if head in (None, place) else f" of the tread, and {1e3 * head:.3g} mm off that of the head"
        told = (
            f" The contact is {1e3 * place:.3g} mm off the middle{own}, positive towards the field side, and "
            f"as stiff as {data.engineering(stiffness, 'N/m')} sideways (Mindlin)."
        )
    change = data.values(tree, schema.VERTICAL_FORCE_CHANGE)
    most = change[np.argmax(np.abs(change))]
    return (
        "The vertical force moves wheel and rail sideways, by as much as both differ at the contact; the "
        "lateral force that keeps them together in stick follows by frequency, linear. What it does to the "
        f"vertical force is left out: by linear theory {data.signed(most)} dB at most in these bands."
        f"{told}{panels.shaded_words(tree)}"
    )


def _answers(tree: DataTree, lines: Lines) -> Iterator[Panel]:
    """Receptances of rail and wheel sideways, and below them the decay along the rail."""
    along = panels.frequency_axis(float(lines.at[0]), float(lines.at[-1]))
    sizes = [series for series in lines.lines if series.units == "m/N" and np.any(series.values > 0)]
    drawn = panels.styled(tree, lines.at, sizes)
    size = panels.log_axis("|receptance| / (m/N)", [line.y for line in drawn])
    yield Panel(along, size, tuple(drawn), height=4.0)
    if found := [series for series in lines.lines if series.units == "dB/m"]:
        rates = panels.styled(tree, lines.at, found)
        axis = panels.log_axis("decay rate / (dB/m)", [line.y for line in rates], lowest=0.01)
        yield Panel(along, axis, tuple(rates), height=2.6)


def _power(tree: DataTree, lines: Lines) -> list[Panel]:
    """A-weighted sound power of the main law: sideways, and beside it what moves up and down alone."""
    main, weighting = data.laws(tree, POWER)[0], a_weighting(lines.at)
    looks: dict[str, tuple[Any, ...]] = {
        RAIL: (chart.VERMILLION, (), 1.8, "o"),
        VERTICAL: (chart.BLUE, (1.5, 1.5), 1.3),
        BOTH: (chart.BLUE, (), 1.8, "^"),
        UP: (chart.VERMILLION, (1.5, 1.5), 1.3),
        WHOLE: (INK, (), 1.8),
    }
    drawn = [
        Line(lines.at, series.values + weighting, series.label, *looks[series.label])
        for series in lines.of(POWER, schema.RADIATED_POWER_LEVEL, law=main)
    ]
    return [panels.band_panel(tree, lines, "sound power level / dB(A) re 1 pW", drawn)]


SIDEWAYS = (
    Figure(
        "lateral_force",
        "Lateral contact force",
        Of(schema.SIDEWAYS_BAND, "band centre"),
        (Of(FORCE, "{law}"), Of(spectra.FORCE_LEVEL, "vertical, {law}"), Of(schema.VERTICAL_FORCE_CHANGE)),
        _force,
        _force_caption,
    ),
    Figure(
        "lateral_spectrum",
        "Spectrum of the lateral contact force",
        Of(spectra.FREQUENCY),
        (Of(schema.LATERAL_FORCE_PSD, "{law}"),),
        panels.draw_spectrum("PSD of the lateral force / dB re 1 N²/Hz"),
        f"One-sided power spectral density, {panels.DRAWN}.",
    ),
    Figure(
        "lateral_power",
        "Sound power of what moves sideways",
        Of(schema.SIDEWAYS_BAND, "band centre"),
        (
            Of(POWER, "{radiator}, {law}", "{radiator}"),
            Of(schema.RADIATED_POWER_LEVEL, f"{UP}, {{law}}", UP, one={"radiator": min}),  # the rail
        ),
        _power,
        "A-weighted one-third octaves. The rail radiates sideways over its height, beside its motion up and "
        "down (dotted); the modes of the wheel answer to both forces at once, beside the vertical one alone "
        "(dotted). The total holds rail and sleepers up and down, too.",
        any_of=(POWER,),
    ),
    Figure(
        "lateral_receptance",
        "Receptances and decay sideways",
        Of(schema.SIDEWAYS_FREQUENCY),
        (
            Of(schema.RAIL_LATERAL_RECEPTANCE, "", "rail, sideways", (chart.VERMILLION, (), 1.6)),
            Of(schema.RAIL_CROSS_RECEPTANCE, "", "rail, by a vertical force", (chart.VERMILLION, (1.5, 1.5))),
            Of(schema.WHEEL_LATERAL_RECEPTANCE, "", "wheel, axial", (chart.BLUE, (), 1.6)),
            Of(schema.WHEEL_CROSS_RECEPTANCE, "", "wheel, by a vertical force", (chart.BLUE, (1.5, 1.5))),
            Of(schema.LATERAL_DECAY_RATE, "", "rail, sideways", (chart.VERMILLION, (), 1.6)),
            over_bands(
                schema.MEASURED_LATERAL_DECAY_RATE,
                schema.LATERAL_DECAY_RATE,
                (INK, (), 2.0),
                frequency=schema.SIDEWAYS_FREQUENCY,
            ),
        ),
        _answers,
        "Displacement per force, both at the contact, of the rail at mid-span and of the wheel as it turns; "
        "dotted: sideways per vertical force. Below: the least decaying of the three waves in which the rail "
        "bends sideways and twists.",
        any_of=(schema.RAIL_LATERAL_RECEPTANCE,),
    ),
)


def sideways_table(tree: DataTree) -> ReportTable | None:
    """Lateral force, slip, and sound power with and without what moves sideways, per law."""
    laws = data.laws(tree, POWER_A)
    if not laws:
        return None
    radiators = data.words(tree, schema.SIDEWAYS_RADIATOR)
    own = [dict(zip(radiators, data.of_law(tree, POWER_A, law), strict=True)) for law in laws]
    known = data.laws(tree, schema.RADIATED_POWER_LEVEL_A) == laws
    up = data.stored_variable(tree, schema.RADIATED_POWER_LEVEL_A) if known else None
    columns = {
        "law": text_cells(laws),
        "lateral force, rms / N": number_cells(data.values(tree, schema.LATERAL_FORCE_SPREAD), "{:.3g}"),
        "beyond friction": text_cells(map(data.in_percent, data.values(tree, schema.SLIP_SHARE)), "number"),
    }
    levels = {UP: [float(up.sel(law=law, radiator="rail")) for law in laws]} if up is not None else {}
    levels |= {name: [each[name] for each in own] for name in schema.SIDEWAYS_RADIATORS}
    columns |= {name: number_cells(level, "{:.1f}") for name, level in levels.items()}
    note = (
        "Sound power in dB(A) re 1 pW, over the bands that were computed. Beyond friction: share of the "
        "time in which a lateral force of this rms, normally distributed, is more than the coefficient of "
        "friction times the static load; where it is not small, the contact slips, and the force is less."
    )
    return table("sideways_table", "Sideways", columns, note)
