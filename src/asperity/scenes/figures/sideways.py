"""What moves sideways: lateral force and friction, receptances and decay."""

from collections.abc import Iterator

import numpy as np
from xarray import DataTree

from asperity.reporting import chart, data, panels
from asperity.reporting.chart import INK, MUTED, Line, Mark, Note, Panel, Rules
from asperity.reporting.figure import Figure, Lines, Of
from asperity.reporting.tables import ReportTable, number_cells, table, text_cells
from asperity.scenes import schema
from asperity.scenes.figures.measured import over_bands
from asperity.schema import spectra

FORCE = schema.LATERAL_FORCE_LEVEL


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
    """Lateral force and slip, per law."""
    laws = data.laws(tree, FORCE)
    if not laws:
        return None
    columns = {
        "law": text_cells(laws),
        "lateral force, rms / N": number_cells(data.values(tree, schema.LATERAL_FORCE_SPREAD), "{:.3g}"),
        "beyond friction": text_cells(map(data.in_percent, data.values(tree, schema.SLIP_SHARE)), "number"),
    }
    note = (
        "Beyond friction: share of the time in which a lateral force of this rms, normally distributed, is "
        "more than the coefficient of friction times the static load; where it is not small, the contact "
        "slips, and the force is less. Sound power with what moves sideways: under rolling noise."
    )
    return table("sideways_table", "Sideways", columns, note)
