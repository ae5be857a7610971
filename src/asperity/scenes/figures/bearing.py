"""A ball bearing on its page: how it carries its load, what moves, how quiet it is, which part is heard."""

from collections.abc import Iterable, Iterator
from dataclasses import replace
from typing import Any

import numpy as np
from xarray import DataTree

from asperity.arguments import Array
from asperity.diagnostics import one_anderon
from asperity.reporting import chart, data, panels
from asperity.reporting.figure import Lines, Of, Series, figure
from asperity.reporting.headline import Answers, HeadlineNumber
from asperity.reporting.tables import Cell, ReportTable, Writer, in_digits, number_cells, table, text_cells
from asperity.schema import Entry, bearing, provenance, rolling, spectra
from asperity.written_numbers import between, in_newtons, plain, rounded

CORNERS = 180
RING = 0.35
"""Thickness in which rings are drawn, over the diameter of a ball: a case does not hold it."""
TURNS = 3.0
"""Turns of the ring of which the acceleration is drawn."""
PER_OCTAVE = 96
"""Stretches of an octave of which the highest line is drawn."""
LOWEST = 10.0
"""Hz, from which spectra are drawn."""
NAMES = {"outer": "outer raceway", "inner": "inner raceway", "ball": "balls"}
FULL_FILM = 3.0
"""Film parameter from which on surfaces do not touch."""
RINGS = {"inner": (chart.VERMILLION, ()), "outer": (chart.BLUE, (5.0, 1.5))}
"""Looks of lines of the contacts with each ring."""
COLOURS = {"outer": chart.BLUE, "inner": chart.VERMILLION, "ball": chart.GREEN}
"""Of the parts of a bearing."""
RIGHT_ANGLES = tuple((each, plain(each)) for each in (-180.0, -90.0, 0.0, 90.0, 180.0))
AROUND = chart.Axis("azimuth from the radial load / °", -185.0, 185.0, ticks=RIGHT_ANGLES)


def _element(tree: DataTree) -> str:
    """What rolls in the bearing: a ball, or a roller."""
    return str(data.stated(tree, bearing.ELEMENT) or "ball")


def _numbers(tree: DataTree) -> Iterator[Series]:
    """Numbers of the balls or rollers, in a column that has their name."""
    for series in Of(bearing.BALL)(tree):
        yield replace(series, name=_element(tree))


def named_part(tree: DataTree, part: str) -> str:
    """Name of a part: what rolls is balls or rollers."""
    return f"{_element(tree)}s" if part == "ball" else NAMES[part]


def _main(tree: DataTree) -> str:
    return data.main_law(tree, bearing.LINES_FOUND)


def _degrees(azimuth: Array) -> Array:
    return np.degrees(np.angle(np.exp(1j * azimuth)))


# --- how it carries its load


def _at(radius: Any, azimuth: Any) -> tuple[Array, Array]:
    """Places on paper: the load points down, and what turns turns anticlockwise."""
    return np.atleast_1d(radius * np.sin(azimuth)), np.atleast_1d(-radius * np.cos(azimuth))


def _round(radius: float, x: Any = 0.0, y: Any = 0.0, **look: Any) -> chart.Shape:
    around = _at(radius, np.linspace(0.0, 2.0 * np.pi, CORNERS, endpoint=False))
    return chart.Shape(x + around[0], y + around[1], **look)


@figure(
    "The bearing and its load zone",
    _numbers,
    Of(bearing.AZIMUTH),
    Of(bearing.BALL_LOAD, "load on the {ring} ring"),
)
def load_zone(tree: DataTree, lines: Lines) -> chart.Drawn:
    """The bearing from the side, each ball as dark as it is loaded, and its load outside."""
    azimuth, _, outer = (series.values for series in lines.lines)
    lengths = (bearing.BALL_DIAMETER, bearing.PITCH_DIAMETER, bearing.CONTACT_ANGLE)
    ball, pitch, angle = (data.number(tree, each) or 0.0 for each in lengths)
    ball, pitch = 1e3 * ball, 1e3 * pitch
    half = 0.5 * ball * np.cos(angle)
    raceways = {"inner": 0.5 * pitch - half, "outer": 0.5 * pitch + half}
    rim = raceways["outer"] + RING * ball
    circles = (raceways["inner"] - RING * ball, *raceways.values(), rim)
    marks: list[chart.Mark] = [_round(radius, width=1.0) for radius in circles]
    for place, share in zip(azimuth, outer / max(outer.max(), 1e-300), strict=True):
        x, y = _at(0.5 * pitch, place)
        fill = _round(0.5 * ball, x, y, fill=chart.BLUE, colour="", opacity=0.08 + 0.8 * float(share))
        marks += [fill, _round(0.5 * ball, x, y)]
        if share:
            bar = _at(rim + np.array([0.1, 0.1 + 1.3 * share]) * ball, place)
            marks.append(chart.Line(*bar, colour=chart.VERMILLION, width=2.2))
            if share == 1.0:
                (x,), (y,) = _at(rim + 0.75 * ball, place)
                marks.append(chart.Note(f"  {in_newtons(outer.max())}", float(x), float(y), colour=chart.INK))
    every_fault = _faults(tree)
    for part, faults in every_fault.items():
        where, balls = (np.array(each) for each in zip(*faults, strict=True))
        x, y = _at(raceways.get(part, 0.5 * ball), where)
        middle = _at(0.0, 0.0)
        if part == "ball":  # an angle of zero touches the outer ring; balls turn against the inner ring
            place = azimuth[np.minimum(balls, len(azimuth)) - 1]
            against = -1.0 if data.case_words(tree, "bearing.turning") == "outer" else 1.0
            x, y = _at(0.5 * ball, place + against * where)
            middle = _at(0.5 * pitch, place)
        named = f"{'faults' if len(faults) > 1 else 'fault'} of the {named_part(tree, part)}", COLOURS[part]
        marks.append(chart.Line(x + middle[0], y + middle[1], *named, width=0.0, marker="D"))
    if data.present(tree, bearing.SENSOR):
        sensors = _at(rim - 0.5 * RING * ball, data.values(tree, bearing.SENSOR))
        marks.append(chart.Line(*sensors, "accelerometer", chart.INK, width=0.0, marker="^"))
    side = chart.Axis("mm", -rim - 1.5 * ball, rim + 1.5 * ball)
    seen = "from the side, the radial load downwards"
    yield chart.Panel(side, replace(side, label=""), tuple(marks), seen, height=5.0, equal=True, plain=True)
    yield (
        "To scale, but for the thickness of the rings, which is no part of the case. At rest, the first "
        f"{_element(tree)} below the load; {_element(tree)}s are as dark, and bars as long, as their static "
        "load, the longest "
        f"{in_newtons(outer.max())}. The bearing turns anticlockwise. Triangles: accelerometers."
    )
    for part, faults in every_fault.items():
        parts = data.words(tree, bearing.PART)
        moved = data.values(tree, bearing.MODULATION)
        turns = ", where the record begins" if part in parts and moved[parts.index(part)] > 0.0 else ""
        one, which = ("Diamond", "fault") if len(faults) == 1 else ("Diamonds", "faults")
        yield f"{one}: the {which} of the {named_part(tree, part)}{turns}."


def _faults(tree: DataTree) -> dict[str, list[tuple[float, int]]]:
    """Angles of the first fault of each section, rad, and numbers of their balls, by the part they are on."""
    found: dict[str, list[tuple[float, int]]] = {}
    name = "fault"
    count = 1
    element = _element(tree)
    parts = {part: part for part in NAMES} | {element: "ball"}
    while (on := data.case_words(tree, f"{name}.on")) in parts:
        angle = data.case_quantity(tree, f"{name}.angle", "rad") or 0.0
        number = int(data.case_words(tree, f"{name}.{element}") or 1)
        found.setdefault(parts[on], []).append((angle, number))
        name = f"fault[{count + 1}]"
        count = count + 1
    return found


# --- what moves


def _one_turn(tree: DataTree) -> slice:
    """The last turn of the cage."""
    azimuth = data.values(tree, bearing.BALL_AZIMUTH)[0]
    return slice(int(np.searchsorted(azimuth, azimuth[-1] - 2.0 * np.pi)), len(azimuth))


def _outer(contacts: list[int]) -> int:
    """Contact of the first ball with the outer ring, which follow those of all balls with the inner one."""
    return contacts[len(contacts) // 2]


@figure(
    "Load over a turn of the cage",
    Of(bearing.BALL_AZIMUTH, "azimuth"),
    Of(rolling.CONTACT_FORCE, "inner force", "on the inner ring"),
    Of(rolling.CONTACT_FORCE, "outer force", "on the outer ring", one={rolling.CONTACT.name: _outer}),
    rows=_one_turn,
)
def ball_turn(tree: DataTree, lines: Lines) -> chart.Drawn:
    """Forces over the azimuth, and behind them those at rest."""
    degrees = _degrees(lines.at)
    places = _degrees(data.values(tree, bearing.AZIMUTH).ravel())
    back = np.abs(np.diff(degrees, prepend=degrees[0])) > 180.0  # where the turn begins again on the left
    order = np.argsort(places)
    loads = data.values(tree, bearing.BALL_LOAD).reshape(2, -1)
    drawn = [
        chart.Line(
            places[order], load[order], f"static, {ring} ring", chart.INK, RINGS[ring][1], 2.4, opacity=0.4
        )
        for ring, load in zip(RINGS, loads, strict=True)
    ]
    drawn += [
        chart.Line(degrees, np.where(back, np.nan, each.values), each.label, *RINGS[ring], 0.9)
        for each, ring in zip(lines.lines, RINGS, strict=True)
    ]
    yield chart.Panel(AROUND, chart.Axis("force / N", low=0.0), tuple(drawn), height=4.0)
    yield (
        f"Contact forces of the first {_element(tree)} by the main law in its last turn, over the load that "
        "it has at rest."
    )


@figure(
    "Pressure along the roller that carries most",
    Of(bearing.ALONG_ROLLER),
    Of(bearing.LINE_PRESSURE, "{ring} ring"),
)
def along_roller(tree: DataTree, lines: Lines) -> chart.Drawn:
    """Pressures of the slices at rest, on both rings."""
    drawn = tuple(
        chart.Line(1e3 * lines.at, each.values / 1e9, each.label, *RINGS[ring], 1.4)
        for each, ring in zip(lines.lines, RINGS, strict=True)
    )
    yield chart.Panel(chart.Axis("place along the roller / mm"), chart.Axis("pressure / GPa", low=0.0), drawn)
    yield (
        "Hertz's pressure on the middle line of each slice, at rest. Slices know no edge: where an end "
        f"carries that does not fall back, the pressure there is higher.{_tilted(tree)}"
    )


def _tilted(tree: DataTree) -> str:
    """How far the inner ring of rollers is tilted at rest, and what holds it; empty where it is not."""
    tilt = data.number(tree, bearing.RING_TILT)
    moment = data.number(tree, bearing.TILT_MOMENT)
    if not tilt or moment is None:
        return ""
    return f" The inner ring is held at a tilt of {plain(1e3 * tilt)} mrad by {plain(moment)} N m."


@figure(
    "Films of oil",
    _numbers,
    Of(bearing.AZIMUTH),
    Of(bearing.FILM_THICKNESS, "{ring} ring, in the middle"),
    Of(bearing.LEAST_FILM, "{ring} ring, least"),
)
def ball_films(tree: DataTree, lines: Lines) -> chart.Drawn:
    """Films of all contacts at rest over the azimuth, and three times the roughness that they are to hide."""
    places = _degrees(data.values(tree, bearing.AZIMUTH).ravel())
    order = np.argsort(places)
    drawn: list[chart.Mark] = []
    rms = 1e9 * data.values(tree, bearing.FILM_RMS)
    told = []
    for row, ring in enumerate(data.words(tree, bearing.RING)):
        colour, dashes = RINGS[ring]
        for entry, place, width in (
            (bearing.FILM_THICKNESS, "in the middle", 2.0),
            (bearing.LEAST_FILM, "least", 0.9),
        ):
            film = 1e9 * data.values(tree, entry)[row].ravel()
            drawn.append(
                chart.Line(places[order], film[order], f"{ring} ring, {place}", colour, dashes, width)
            )
        if rms[row]:
            ends = np.array([AROUND.low, AROUND.high])
            flat = np.full(2, FULL_FILM * rms[row])
            drawn.append(chart.Line(ends, flat, f"{ring} ring, Λ = 3", colour, (1.0, 2.5), 1.2))
            told.append(f"{rounded(rms[row])} nm on the {ring} ring")
    yield chart.Panel(AROUND, chart.Axis("film / nm", low=0.0), tuple(drawn), height=4.0)
    yield (
        "Thickness of the film of each contact under its load at rest, in the middle and where it is least: "
        "of balls at the sides, of rollers at the outlet. A contact that carries nothing has none."
    )
    if told:
        yield (
            f"Dotted: where the least film is three times the rms of both surfaces, "
            f"{' and '.join(told)}: below, asperities touch."
        )


def films_table(tree: DataTree) -> ReportTable | None:
    """Films under the heaviest loads: how thick, how stiff, how damped."""
    if not data.present(tree, bearing.HEAVIEST_FILM):
        return None
    shown = (
        (bearing.HEAVIEST_FILM, "film, nm", 1e-9, in_digits(3)),
        (bearing.FILM_RMS, "rms of both surfaces, nm", 1e-9, in_digits(3)),
        (bearing.HEAVIEST_PARAMETER, "Λ", 1.0, in_digits(3)),
        (bearing.FILM_HEATING, "left by the heat of the inlet", 1.0, data.in_percent),
        (bearing.FILM_STIFFNESS, "stiffness, MN/m", 1e6, in_digits(3)),
        (bearing.FILM_DAMPING, "damping, N s/m", 1.0, in_digits(3)),
        (bearing.ASPERITY_SHARE, "carried by asperities", 1.0, data.in_percent),
    )
    columns = {"contact with": text_cells(f"{ring} ring" for ring in data.words(tree, bearing.RING))}
    for entry, head, unit, form in shown:
        if data.present(tree, entry):
            columns[head] = number_cells(data.values(tree, entry) / unit, form)
    viscosity = 1e3 * (data.number(tree, bearing.OIL_VISCOSITY) or 0.0)
    pressure = 1e9 * (data.number(tree, bearing.OIL_PRESSURE) or 0.0)
    formula = data.stated(tree, bearing.FILM_FORMULA) or "Hamrock and Dowson"
    note = (
        f"Under the heaviest static load{_at_fastest(tree)}. Its oil has {rounded(viscosity)} mPa s and "
        f"{rounded(pressure)} 1/GPa at its temperature; contacts are full of it. Film by {formula}, less "
        "what the heat of the inlet takes (Wilson and Sheu); Λ is the least film over the rms of both "
        "surfaces within the contact: 3 or more a full film, less than 1 boundary lubrication."
    )
    return table("films", "Films of oil", columns, note)


def _some_turns(tree: DataTree) -> slice:
    time = data.values(tree, rolling.TIME)
    length = TURNS / (data.number(tree, bearing.TURNING) or TURNS)
    return slice(0, int(np.searchsorted(time, length)) + 1)


@figure(
    "Acceleration of the outer ring",
    Of(rolling.TIME),
    Of(bearing.RING_ACCELERATION, "{law}"),
    rows=_some_turns,
)
def ring_acceleration(tree: DataTree, lines: Lines) -> chart.Drawn:
    """Acceleration of all laws over a few turns."""
    axis, unit = panels.time_axis(tree, lines.at)
    drawn = [replace(each, width=0.8) for each in panels.styled(tree, lines.at / unit, lines.lines)]
    yield chart.Panel(axis, chart.Axis("acceleration / (m/s²)"), tuple(drawn), height=3.4)
    yield "At the first accelerometer, radially outwards, in the first three turns of the record."


# --- how quiet it is, and what is heard


def tones_of(tree: DataTree) -> list[tuple[str, float]]:
    """Parts, and how often in a second their places are met."""
    return list(zip(data.words(tree, bearing.PART), data.values(tree, bearing.TONE).tolist(), strict=True))


def multiples(
    tree: DataTree, tones: Iterable[tuple[str, float]], form: str, count: int, highest: float
) -> list[chart.Mark]:
    """Rules at so many multiples of what is told of each part, below the highest."""
    return [
        chart.Rules(
            at[at < highest], label=f"{named_part(tree, part)}: {form.format(tone)} and multiples",
            colour=COLOURS[part], dashes=(2.0, 2.0)
        )
        for part, tone in tones
        for at in [tone * np.arange(1.0, count + 1.0)]
    ]  # fmt: skip


def _tones(tree: DataTree, highest: float) -> list[chart.Mark]:
    """Tones of the parts and their multiples."""
    count = len(data.values(tree, bearing.HARMONIC))
    return multiples(tree, tones_of(tree), "{:.1f} Hz", count, highest)


def _orders(tree: DataTree) -> chart.Second:
    return chart.Second("orders of the speed", 1.0 / (data.number(tree, bearing.TURNING) or 1.0))


def _at_fastest(tree: DataTree) -> str:
    """Of which speed frequencies of tones are, of a run-up."""
    if not data.present(tree, bearing.ORDER):
        return ""
    return f", at the fastest, {rounded(60.0 * (data.number(tree, bearing.TURNING) or 0.0), 5)} 1/min"


@figure("Spectrum of the radial velocity", Of(spectra.FREQUENCY), Of(bearing.VELOCITY_AMPLITUDE, "{law}"))
def velocity_spectrum(tree: DataTree, lines: Lines) -> chart.Drawn:
    """Highest lines in stretches of an octave, in dB, and the tones of the parts."""
    kept = lines.at >= LOWEST
    frequency = lines.at[kept]
    starts = np.flatnonzero(np.diff(np.floor(PER_OCTAVE * np.log2(frequency / frequency[0])), prepend=-1.0))
    levels = [
        replace(each, values=20.0 * np.log10(np.maximum.reduceat(each.values[kept], starts) / 1e-6))
        for each in lines.lines
    ]
    drawn = panels.styled(tree, frequency[starts], levels)
    along = replace(panels.frequency_axis(LOWEST, frequency[-1]), second=_orders(tree))
    across = panels.levels_axis("amplitude of the velocity / dB re 1 µm/s", [each.y for each in drawn], 100.0)
    yield chart.Panel(along, across, (*_tones(tree, frequency[-1]), *drawn), height=4.4)
    yield (
        "Lines of the radial velocity of the outer ring at the first accelerometer; the highest of each 1/96 "
        "octave. Dashed: at which frequencies the places of a part are met, in pure rolling"
        f"{_at_fastest(tree)}."
    )


@figure("Envelope spectrum", Of(bearing.ENVELOPE_FREQUENCY), Of(bearing.ENVELOPE, "{law}"))
def envelope_spectrum(tree: DataTree, lines: Lines) -> chart.Drawn:
    """Envelope of all laws, and what of it the main law's lines are."""
    highest = float(lines.at[-1])
    main = _main(tree)
    found = data.of_law(tree, bearing.LINES_FOUND, main)
    where, size = (data.of_law(tree, each, main) for each in (bearing.LINE_FREQUENCY, bearing.LINE_AMPLITUDE))
    marks = [
        chart.Line(
            where[row], size[row], f"{named_part(tree, part)}: found", COLOURS[part], width=0.0, marker="o"
        )
        for row, part in enumerate(data.words(tree, bearing.PART))
        if found[row]
    ]
    drawn = [replace(each, width=0.9) for each in panels.styled(tree, lines.at, lines.lines)]
    along = chart.Axis("frequency / Hz", 0.0, highest, second=_orders(tree))
    units = str(data.variable_of(tree, bearing.ENVELOPE).attrs["units"]).replace("m/s2", "(m/s²)")
    across = chart.Axis(f"amplitude of the envelope / {units}", low=0.0)
    yield chart.Panel(along, across, (*_tones(tree, highest), *drawn, *marks), height=4.4)
    low, high = (data.number(tree, each) or 0.0 for each in (bearing.ENVELOPE_LOW, bearing.ENVELOPE_HIGH))
    yield (
        "How evenly the outer ring is struck: lines in the envelope of its acceleration between "
        f"{low:.0f} and {high:.0f} Hz, at the first accelerometer. Dashed: expected in pure rolling; dots: "
        "lines of the main law that stand out, with their multiples."
    )
    if at := _at_fastest(tree):
        yield f"Of a run-up it is taken over angle, where lines are narrow: frequencies are orders{at}."


QUIET = load_zone, velocity_spectrum, envelope_spectrum, ring_acceleration


def bands_table(tree: DataTree) -> ReportTable:
    """Velocities in the bands in which bearings are judged, by law and sensor; of parts alone below."""
    found = data.values(tree, bearing.BAND_VELOCITY)
    sensors = np.degrees(data.values(tree, bearing.SENSOR))
    rows = [(law, f"at {at:.0f}°") for law in data.laws(tree, bearing.BAND_VELOCITY) for at in sensors]
    velocities = found.reshape(len(rows), -1)
    if data.present(tree, bearing.ALONE_VELOCITY):
        alone = data.variable_of(tree, bearing.ALONE_VELOCITY)
        rows += [(str(alone.attrs.get("law")), f"{name} alone") for name in alone["source"].values]
        velocities = np.concatenate([velocities, alone.values])
    columns = {"law": text_cells(law for law, _ in rows), "of": text_cells(what for _, what in rows)}
    by_chance = (
        each for each in (bearing.BAND_DEVIATION, bearing.ALONE_DEVIATION) if data.present(tree, each)
    )
    chance = [data.values(tree, each).reshape(-1, velocities.shape[1]) for each in by_chance]
    steady = data.present(tree, bearing.BAND_ANDERONS)
    one = 1e6 * one_anderon(data.number(tree, bearing.TURNING) or 1.0)
    for n, (band, values) in enumerate(
        zip(data.words(tree, bearing.JUDGED_BAND), 1e6 * velocities.T, strict=True)
    ):
        columns[f"{band}, µm/s"] = number_cells(values, in_digits(3))
        if steady:
            columns[f"{band}, anderon"] = number_cells(values / one[n], in_digits(3))
        if chance:
            of_records = np.concatenate(chance)[:, n]
            missing = np.full(len(rows) - len(of_records), np.nan)
            columns[f"± by chance, {band}"] = number_cells([*of_records, *missing], data.in_percent)
    note = (
        "Rms radial velocity of the outer ring; alone: at the first accelerometer, all other parts smooth. "
        "By chance: one standard deviation by eight parts of this record; another seed draws other waves. "
        "ISO 15242-2 measures it at 1800 1/min of the inner ring under an axial load, with filters whose "
        "slopes this leaves out."
    )
    if steady:
        note += (
            " One anderon is a microinch for each radian of a turn, over the root of the octaves of the band."
        )
    return table("judged_bands", "Velocities in the bands of ISO 15242-2", columns, note)


def lines_table(tree: DataTree) -> ReportTable:
    """Tones of the parts, and what the envelope has of them, by law."""
    tones = data.values(tree, bearing.TONE)
    turning = data.number(tree, bearing.TURNING) or 1.0
    columns = {
        "part": text_cells(named_part(tree, part) for part in data.words(tree, bearing.PART)),
        "tone / Hz": number_cells(tones, "{:.2f}"),
        "orders": number_cells(tones / turning, "{:.3f}"),
        "side bands ± / Hz": number_cells(data.values(tree, bearing.MODULATION), "{:.2f}"),
    }
    for law in data.held_laws(tree, bearing.LINES_FOUND):
        entries = (bearing.LINE_AMPLITUDE, bearing.LINE_SIDE_BANDS, bearing.LINES_FOUND)
        lines, sides, found = (data.of_law(tree, each, law) for each in entries)
        told = zip(lines[:, 0], sides[:, 0], found, strict=True)
        columns[f"{law}, m/s²"] = text_cells(
            f"{rounded(line)}, side bands {data.in_percent(side / line)}" if seen else "–"
            for line, side, seen in told
        )
    note = "First line of each part in the envelope, where it and its multiples stand out."
    return table("tones", "Tones of the parts", columns, note)


Shown = tuple[Entry, str, float, str | Writer]
"""A quantity of contacts in a table: its entry, its head, the size of its unit, how it is written."""


def _contact_columns(tree: DataTree, *shown: Shown) -> dict[str, list[Cell]]:
    """Columns of contacts at rest, the first ball below the load: of each with both rings."""
    element = _element(tree)
    rings = data.words(tree, bearing.RING)
    at = np.round(_degrees(data.values(tree, bearing.AZIMUTH)[0])) + 0.0
    loose = data.values(tree, bearing.BALL_LOAD)[:, 0] == 0.0  # (ring, ball)
    columns = {
        f"{element} at": number_cells(np.repeat(at, len(rings)), "{:.0f}°"),
        "contact with": text_cells(f"{ring} ring" for _ in at for ring in rings),
    }
    for entry, head, size, form in shown:
        values = np.where(loose, np.nan, data.values(tree, entry)[:, 0] / size)
        columns[head] = number_cells(values.T.ravel(), form)
    return columns


def ball_contacts_table(tree: DataTree) -> ReportTable:
    """Contacts of each ball at rest."""
    element = _element(tree)
    columns = _contact_columns(
        tree,
        (bearing.BALL_LOAD, "load / N", 1.0, in_digits(4)),
        (bearing.BALL_ANGLE, "angle", np.pi / 180.0, "{:.1f}°"),
        (bearing.SEMI_AXIS_ALONG, "half axis along / mm", 1e-3, "{:.3f}"),
        (bearing.SEMI_AXIS_ACROSS, "half axis across / mm", 1e-3, "{:.3f}"),
        (bearing.PEAK_PRESSURE, "largest pressure / GPa", 1e9, "{:.2f}"),
    )
    moved = 1e6 * data.values(tree, bearing.RING_DISPLACEMENT)
    stiffness = 1e-6 * data.values(tree, bearing.RING_STIFFNESS)
    told = (
        f"{way} {plain(np.round(to.mean(), 6) + 0.0, 4)} µm, "
        f"varying by {rounded(np.round(np.ptp(to), 6), 2)} µm, "
        f"{between(rounded(each.min(), 4), rounded(each.max(), 4))} MN/m"
        for way, to, each in zip(data.words(tree, bearing.DIRECTION), moved, stiffness, strict=True)
    )
    note = (
        f"At rest, the first {element} below the load; half axes along and across the raceway. The inner "
        f"ring as a {element} passes, how far it moved and its stiffness: "
        f"{'; '.join(told)}. {_rib_of(tree)}{data.stated(tree, bearing.LEFT_OUT) or ''}"
    )
    return table("ball_contacts", f"Contacts of the {element}s", columns, note)


def _rib_of(tree: DataTree) -> str:
    """What the rib pushes tapered rollers by in the run."""
    if not data.present(tree, bearing.RIB_FORCE):
        return ""
    forces = data.of_law(tree, bearing.RIB_FORCE, _main(tree))
    ends = between(rounded(forces.min(), 3), rounded(forces.max(), 3))
    told = f"As it runs the rib pushes rollers along their axes by {ends} N. "
    if data.present(tree, bearing.RIB_TORQUE):
        torque = 1e3 * float(data.of_law(tree, bearing.RIB_TORQUE, _main(tree)))
        heat = float(data.values(tree, bearing.RIB_HEAT).sum(axis=1).mean())
        told += (
            f"Their friction on it asks the rings for {rounded(torque, 4)} N mm, and turns "
            f"{rounded(heat, 4)} W into heat under the static load{_at_fastest(tree)}. "
        )
    return told


def ball_sliding_table(tree: DataTree) -> ReportTable | None:
    """How each ball slides on its raceways at rest."""
    if not data.present(tree, bearing.SPIN_CREEPAGE):
        return None
    shown: list[Shown] = [
        (bearing.SPIN_CREEPAGE, "spin / (rad/m)", 1.0, in_digits(3)),
        (bearing.RIM_CREEPAGE, "sliding at the rim / %", 0.01, in_digits(3)),
        (bearing.SLIDING_HEAT, "heat over μ / W", 1.0, in_digits(3)),
    ]
    rubs = data.present(tree, bearing.FRICTION_HEAT)
    if rubs:
        shown += [
            (bearing.SLIPPING_SHARE, "slips", 1.0, data.in_percent),
            (bearing.FRICTION_HEAT, "heat / W", 1.0, in_digits(3)),
        ]
    columns = _contact_columns(tree, *shown)
    every = np.nansum(data.values(tree, bearing.SLIDING_HEAT), axis=(0, 2)).mean()
    note = (
        f"Under the static load{_at_fastest(tree)}, the first ball below it. Spin against a raceway is that "
        "of the ring alone which does not control the axis of the ball. By the form of its groove a ball "
        "slides across the contact: at the rim, over the speed of rolling. The heat is that over the "
        "coefficient of friction "
        f"if all of the contact slips, the most there is: {rounded(every)} W for all contacts together. "
        f"{_friction_of(tree) if rubs else ''}Balls that do not touch both rings are left out."
    )
    return table("ball_sliding", "Sliding of the balls", columns, note)


def _friction_of(tree: DataTree) -> str:
    """What friction takes of all contacts."""
    heat = np.nansum(data.values(tree, bearing.FRICTION_HEAT), axis=(0, 2)).mean()
    torque = float(data.of_law(tree, bearing.FRICTION_TORQUE, _main(tree)))
    return (
        f"With the friction of the case, parts of a contact stick: all contacts together turn "
        f"{rounded(heat)} W into heat at rest under the load, and as the bearing runs ask the rings for "
        f"{rounded(1e3 * torque)} N mm. "
    )


def bearing_answers(tree: DataTree) -> Answers:
    """How quiet the bearing is, in three bands, and which part makes it so."""
    velocities = data.of_law(tree, bearing.BAND_VELOCITY, _main(tree)).T
    lead, _, more = str(data.stated(tree, provenance.VERDICT) or "").partition(". ")
    numbers = [
        HeadlineNumber(
            band,
            f"{rounded(1e6 * of_sensors[0])} µm/s",
            f"rms radial velocity, outer ring{_where(tree, of_sensors)}",
        )
        for band, of_sensors in zip(data.words(tree, bearing.JUDGED_BAND), velocities, strict=True)
    ]
    load, peak = (float(data.values(tree, each).max()) for each in (bearing.BALL_LOAD, bearing.PEAK_PRESSURE))
    heaviest = HeadlineNumber(
        f"heaviest load of a {_element(tree)}", in_newtons(load), f"{peak / 1e9:.2f} GPa at rest"
    )
    return Answers(f"{lead}.", more, (*numbers, heaviest))


def _where(tree: DataTree, velocities: Array) -> str:
    """At which of several accelerometers the first velocity is, and the largest; empty of one."""
    angles = np.degrees(data.values(tree, bearing.SENSOR))
    if len(angles) == 1:
        return ""
    at = f", at {rounded(angles[0])}°"
    if not np.isfinite(velocities).all() or not (largest := int(np.argmax(velocities))):
        return at
    return f"{at}; at most {rounded(1e6 * velocities[largest])} µm/s at {rounded(angles[largest])}°"
