"""Figures of motion: of a structure, of bodies, of wheel and rail at the contact, of the rail passed by."""

from dataclasses import replace
from functools import partial

import numpy as np
from xarray import DataTree

from asperity.reporting import chart, data, panels
from asperity.reporting.chart import Drawn, Mark, Panel
from asperity.reporting.figure import Lines, Of, Series, figure
from asperity.reporting.headline import Answers, HeadlineNumber, deciding_bands
from asperity.reporting.tables import ReportTable, number_cells, table, text_cells
from asperity.scenes import schema
from asperity.scenes.figures import force, track
from asperity.schema import rolling
from asperity.schema.spectra import BAND, FREQUENCY
from asperity.spectra import a_weighted_total
from asperity.written_numbers import rounded

_SPECTRUM = "acceleration PSD / dB re (1 µm/s²)²/Hz", schema.ACCELERATION_REFERENCE**2
_AT = "x = {sensor:g} m"
_SENSORS = Of(schema.ACCELERATION_PSD, "{law}, " + _AT, _AT, one={"law": min})


@figure("Acceleration at the sensors", Of(FREQUENCY), _SENSORS)
def acceleration_sensors(tree: DataTree, lines: Lines) -> Drawn:
    """Spectra at all sensors by the main law."""
    yield panels.level_spectrum(tree, lines, *_SPECTRUM)
    main = data.main_law(tree, schema.ACCELERATION_PSD)
    yield f"Acceleration at all sensors by the main law, {main}, positive downwards; {panels.DRAWN}."
    yield panels.shaded_words(tree)
    yield data.missing(tree, schema.ACCELERATION_LEVEL)


@figure(
    "Acceleration by law",
    Of(FREQUENCY),
    replace(_SENSORS, label="{law}", one={"sensor": lambda sensors: sensors[len(sensors) // 2]}),
)
def acceleration_laws(tree: DataTree, lines: Lines) -> Drawn:
    """Spectra at the middle sensor by all laws."""
    yield panels.level_spectrum(tree, lines, *_SPECTRUM)
    sensors = [series.label for series in _SENSORS(tree)]
    yield f"Acceleration at {sensors[len(sensors) // 2]} by all laws; {panels.DRAWN}."
    yield panels.shaded_words(tree)


ACCELERATION = acceleration_sensors, acceleration_laws

MOST_LINES = 6
"""Degrees of freedom that are drawn: the last, which are those of what rests on the others."""


@figure("Acceleration of the bodies", Of(FREQUENCY), Of(schema.BODY_ACCELERATION_PSD, "{degree}"))
def body_acceleration(tree: DataTree, lines: Lines) -> Drawn:
    """Spectra of the last degrees of freedom, and the tones of contacts that pass a place."""
    tones, told = _passing_tones(tree)
    yield panels.level_spectrum(tree, lines, *_SPECTRUM, tones, slice(-MOST_LINES, None))
    main = data.main_law(tree, schema.BODY_ACCELERATION_PSD)
    yield f"Acceleration of the bodies by the main law, {main}; {panels.DRAWN}."
    if (count := len(data.words(tree, schema.SPECTRA_DEGREE))) > MOST_LINES:
        yield f"The last {MOST_LINES} of {count} are drawn; the file has all."
    yield told
    yield panels.shaded_words(tree)


def _passing_tones(tree: DataTree) -> tuple[list[Mark], str]:
    """Multiples of the frequency at which contacts that stand apart pass a place, and what they are."""
    if not data.present(tree, schema.PASSING_FREQUENCY):
        return [], ""
    low, high = panels.frequency_range(tree)
    tones = data.values(tree, schema.PASSING_FREQUENCY)
    rules = chart.Rules(tones[(tones > low) & (tones < high)][:10], dashes=(1, 2), width=0.6)
    first = f"{rounded(float(tones[0]), 4)} Hz at which contacts pass a place"
    return [rules], f"Dotted: k v/L, multiples of the {first}{data.at_its_fastest(tree)}; ten are drawn."


def energy_table(tree: DataTree) -> ReportTable:
    """Energy balance per law, and what is left of it."""
    laws = data.held_laws(tree, schema.ENERGY)
    energies = np.transpose([data.of_law(tree, schema.ENERGY, law) for law in laws])
    terms = zip(data.words(tree, schema.ENERGY_TERM), energies, strict=True)
    columns = {"law": text_cells(laws, "name"), **{term: number_cells(energy, "J") for term, energy in terms}}
    note = (
        "A check of the steps in time, from the start of the run-in to the end of the run: the first term, "
        "the work of the loads, is the sum of the others: energy that has been gained (positive) or "
        "given off, what dampers took, and the work on the contacts less what the texture feeds in. Over a "
        "track the contacts hold what goes into the rail, too."
    )
    entry = schema.ENERGY_RESIDUAL
    if data.present(tree, entry):
        left = [float(data.of_law(tree, entry, law)) for law in laws]
        columns["relative residual"] = number_cells(left, partial(data.plain, digits=2))
        note += f" Residual: {entry.long_name}."
    return table("energy_balance", "Energy balance of the run", columns, note)


# --- wheel and rail at the contact

_MOTIONS = {
    schema.RAIL_DISPLACEMENT: ("rail", 1e-3, "mm"),
    schema.WHEEL_DISPLACEMENT: ("wheel", 1e-3, "mm"),
    rolling.RELATIVE_DISPLACEMENT: ("approach", 1e-6, "µm"),
}
"""What moves at the contact, and the unit it is drawn in."""
PIECE = 0.1
"""Length of the piece around the largest force, s."""


def _piece(tree: DataTree) -> slice:
    return force.around_peak(tree, PIECE) if data.present(tree, rolling.CONTACT_FORCE) else slice(None)


@figure(
    "Wheel and rail at the contact",
    Of(rolling.TIME),
    Of(rolling.POSITION, "position on the rail", optional=True),
    *(
        Of(entry, f"{name}, {{law}}", "{law}", optional=entry is not schema.RAIL_DISPLACEMENT)
        for entry, (name, _, _) in _MOTIONS.items()
    ),
    rows=_piece,
)
def displacement(tree: DataTree, lines: Lines) -> Drawn:
    """Displacement of rail and wheel at the contact and their approach, all laws, over a piece of the run."""
    time, unit = panels.time_axis(tree, lines.at)
    sleepers = track.sleeper_times(tree, lines.at[0], lines.at[-1], unit)
    for entry, (name, size, length) in _MOTIONS.items():
        if motions := lines.of(entry):
            drawn = panels.styled(tree, lines.at / unit, motions, size=size)
            low, high = panels.main_limits(motions, data.pulling(tree))
            downwards = chart.Axis(f"{name} / {length}", high / size, low / size)
            yield Panel(time, downwards, (*sleepers, *drawn), height=1.75)
    yield (
        "Motion at the contact around the largest force, positive downwards and drawn downwards; from the "
        "unloaded track, so that the static deflection is in. The approach of wheel and rail is positive "
        "closing. The axes suit the main law."
    )
    if data.number(tree, schema.SLEEPER_SPACING):
        yield "Ticks: the wheel passes a sleeper."


# --- the rail at points that the wheel passes

POINTS = 3
"""Passed points that are drawn, at most; the CSV files hold all."""
AROUND_PASSING = 0.15
"""Time before the first and after the last passing that is drawn, s."""


def point_labels(tree: DataTree) -> list[str]:
    """Positions of the passed points, with their place in the bay where it has a name."""
    bay = data.number(tree, schema.SLEEPER_SPACING)
    found = []
    for point in data.values(tree, schema.ROLLING_POINT).tolist():
        place = (point / bay) % 1 if bay else np.nan
        name = ", over a sleeper" if min(place, 1 - place) < 0.02 else ""
        found.append(f"x = {rounded(point, 4)} m{', mid-span' if abs(place - 0.5) < 0.02 else name}")
    return found


_VELOCITY, _VELOCITY_PSD = (
    Of(entry, "{law}, {point}", "{law}", called={"point": point_labels})
    for entry in (schema.POINT_VELOCITY, schema.POINT_VELOCITY_PSD)
)


def _by_point(lines: Lines) -> dict[str, list[Series]]:
    """Lines of the passed points that are drawn, by the names of these."""
    found: dict[str, list[Series]] = {}
    for series in lines.lines:
        found.setdefault(series.name.removeprefix(f"{series.law}, "), []).append(series)
    return dict(list(found.items())[:POINTS])


def _passing(tree: DataTree, point: float) -> float:
    """Time at which the wheel passes a point, s."""
    speed = data.number(tree, rolling.SPEED) or np.nan
    start = data.values(tree, rolling.POSITION)[0]
    return float(data.values(tree, rolling.TIME)[0] + (point - start) / speed)


def _passings(tree: DataTree) -> slice:
    """Time steps of all the passings, and of what lies between them."""
    passed = [_passing(tree, point) for point in {series.places["point"] for series in _VELOCITY(tree)}]
    ends = min(passed) - AROUND_PASSING, max(passed) + AROUND_PASSING
    low, high = np.searchsorted(data.values(tree, rolling.TIME), ends)
    return slice(int(low), int(high)) if high - low > 1 else slice(None)


@figure("Rail velocity where the wheel passes", Of(rolling.TIME), _VELOCITY, rows=_passings)
def rail_velocity(tree: DataTree, lines: Lines) -> Drawn:
    """Velocity of the rail at the passed points, around the passings."""
    time, unit = panels.time_axis(tree, lines.at)
    for title, found in _by_point(lines).items():
        passed = chart.Rules(np.array([_passing(tree, found[0].places["point"]) / unit]), colour=chart.INK)
        # they swing fast: dashes would not be seen
        drawn = panels.styled(tree, lines.at / unit, found, size=1e-3, width=1.0, dashes=())
        yield Panel(time, chart.Axis("velocity / (mm/s)"), (passed, *drawn), title, height=1.9)
    yield "Velocity of the rail at fixed points, positive downwards, while the wheel passes them (dotted)."


@figure("Rail velocity against frequency", Of(FREQUENCY), _VELOCITY_PSD)
def rail_velocity_psd(tree: DataTree, lines: Lines) -> Drawn:
    """Power spectral densities of the rail's velocity at the passed points, all laws, a panel per point."""
    points = {
        title: panels.narrow_levels(tree, lines, found, schema.VELOCITY_REFERENCE**2)
        for title, found in _by_point(lines).items()
    }
    label = "velocity PSD / dB re (1 nm/s)²/Hz"
    axis = panels.levels_axis(label, [s.values for _, levels in points.values() for s in levels])
    behind = track.natural_rules(tree, *panels.frequency_range(tree), named=False)
    for title, (frequency, levels) in points.items():
        panel = panels.spectrum_panel(tree, label, panels.styled(tree, frequency, levels), behind)
        yield replace(panel, y=axis, title=title, height=2.8)
    yield f"Velocity of the rail at fixed points over the whole run, {panels.DRAWN}."
    if named := ", ".join(f"{label} {f:.0f} Hz" for label, f in track.natural_frequencies(tree).items()):
        yield f"Dotted: {named}."
    yield panels.shaded_words(tree)


RAIL = displacement, rail_velocity, rail_velocity_psd


def acceleration_answers(tree: DataTree) -> Answers | None:
    """Acceleration at the sensors by the main law: rms, A-weighted level, and the bands that hold it."""
    main = data.main_law(tree, schema.ACCELERATION)
    if main not in data.laws(tree, schema.ACCELERATION_LEVEL):
        return None
    rms = np.sqrt(np.nanmean(data.of_law(tree, schema.ACCELERATION, main) ** 2, axis=1))
    levels = data.of_law(tree, schema.ACCELERATION_LEVEL, main)
    bands = data.values(tree, BAND)
    weighted = a_weighted_total(levels, bands)
    sensors = data.variable_of(tree, schema.ACCELERATION)["sensor"].values.tolist()
    places = [f"x = {sensor:g} m" for sensor in sensors]
    most = int(np.nanargmax(rms))
    strongest = data.engineering(rms[most], "m/s²")
    lead = (
        f"The structure vibrates most at {places[most]}: {strongest} rms, half of "
        f"its energy in {deciding_bands(bands, levels[most])}."
    )
    where = f"at {places[most]}" + (f", the largest rms of {len(places)} sensors" if len(places) > 1 else "")
    note = f"{weighted[most]:.1f} dB(A) re 1 µm/s² {where}"
    columns = {
        "sensor at": text_cells(places),
        "rms": number_cells(rms, "m/s²"),
        "A-weighted / dB(A) re 1 µm/s²": number_cells(weighted, "{:.1f}"),
    }
    listed = table("vibration_sensors", "Vibration at the sensors", columns)
    return Answers(lead, numbers=(HeadlineNumber("vibration, rms", strongest, note),), tables=(listed,))
