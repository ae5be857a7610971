"""What moves sideways: lateral force, receptances and decay; friction of what creeps, and squeal."""

from collections.abc import Iterable

import numpy as np
from xarray import DataTree

from asperity.arguments import Array
from asperity.reporting import data, headline, panels
from asperity.reporting.chart import BLUE, MUTED, VERMILLION, Axis, Drawn, Line, Note, Panel
from asperity.reporting.figure import Lines, Of, field, figure
from asperity.reporting.tables import Cell, ReportTable, in_digits, number_cells, table, text_cells
from asperity.reporting.texture_figures import map_panel
from asperity.scenes import schema
from asperity.scenes.figures import force
from asperity.scenes.figures.measured import over_bands
from asperity.schema import bearing, rolling, spectra
from asperity.structures.squeal import FREE_OF_AXLE
from asperity.written_numbers import count_of, rounded

FORCE = schema.LATERAL_FORCE_LEVEL
_DOTS = (1.5, 1.5)
UNDECIDED = 2e-4
"""Share of critical damping by which growth says nothing: that of wheels is known no better."""


@figure(
    "Lateral contact force",
    Of(schema.SIDEWAYS_BAND, "band centre"),
    Of(FORCE, "{law}"),
    Of(spectra.FORCE_LEVEL, "vertical, {law}"),
    Of(schema.VERTICAL_FORCE_CHANGE),
)
def lateral_force(tree: DataTree, lines: Lines) -> Drawn:
    """Lateral force of each law per one-third octave, the vertical one of the main law, and friction."""
    vertical = lines.of(spectra.FORCE_LEVEL, law=data.main_law(tree, FORCE))
    friction = np.full(len(lines.at), 20.0 * np.log10(data.number(tree, schema.SLIP_FORCE) or np.nan))
    levels = [
        *panels.styled(tree, lines.at, lines.of(FORCE), markers=True),
        *panels.styled(tree, lines.at, vertical, colour=MUTED, dashes=(6, 1.5), width=1.2),
        Line(lines.at, friction, "friction of the static load", MUTED, _DOTS, 1.0),
    ]
    yield panels.band_panel(tree, lines, "contact force level / dB re 1 N", levels, span=80.0)
    (change,) = (series.values for series in lines.of(schema.VERTICAL_FORCE_CHANGE))
    most = change[np.argmax(np.abs(change))]
    yield (
        "The vertical force moves wheel and rail sideways, by as much as both differ at the contact; the "
        "lateral force that keeps them together in stick follows by frequency, linear. What it does to the "
        f"vertical force is left out: by linear theory {data.signed(most)} dB at most in these bands."
    )
    facts = schema.CONTACT_PLACE, schema.RAIL_CONTACT_PLACE, schema.STICK_STIFFNESS
    place, head, stiffness = (data.number(tree, fact) for fact in facts)
    if place is not None and stiffness is not None:
        own = (
            ""
            if head in (None, place)
            else f" of the tread, and {rounded(1e3 * head)} mm off that of the head"
        )
        yield (
            f"The contact is {rounded(1e3 * place)} mm off the middle{own}, positive towards the field "
            f"side, and as stiff as {data.engineering(stiffness, 'N/m')} sideways (Mindlin)."
        )
    yield panels.shaded_words(tree)


@figure("Spectrum of the lateral contact force", Of(spectra.FREQUENCY), Of(schema.LATERAL_FORCE_PSD, "{law}"))
def lateral_spectrum(tree: DataTree, lines: Lines) -> Drawn:
    """Spectrum of the force of each law."""
    yield panels.level_spectrum(tree, lines, "PSD of the lateral force / dB re 1 N²/Hz")
    yield f"One-sided power spectral density, {panels.DRAWN}."


@figure(
    "Receptances and decay sideways",
    Of(schema.SIDEWAYS_FREQUENCY),
    Of(schema.RAIL_LATERAL_RECEPTANCE, "", "rail, sideways", (VERMILLION, (), 1.6)),
    Of(schema.RAIL_CROSS_RECEPTANCE, "", "rail, by a vertical force", (VERMILLION, _DOTS), optional=True),
    Of(schema.WHEEL_LATERAL_RECEPTANCE, "", "wheel, axial", (BLUE, (), 1.6), optional=True),
    Of(schema.WHEEL_CROSS_RECEPTANCE, "", "wheel, by a vertical force", (BLUE, _DOTS), optional=True),
    Of(schema.LATERAL_DECAY_RATE, "", "rail, sideways", (VERMILLION, (), 1.6), optional=True),
    over_bands(schema.MEASURED_LATERAL_DECAY_RATE, schema.LATERAL_DECAY_RATE, at=schema.SIDEWAYS_FREQUENCY),
)
def lateral_receptance(tree: DataTree, lines: Lines) -> Drawn:
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
    yield (
        "Displacement per force, both at the contact, of the rail at mid-span and of the wheel as it turns; "
        "dotted: sideways per vertical force. Below: the least decaying of the three waves in which the rail "
        "bends sideways and twists."
    )


SIDEWAYS = lateral_force, lateral_spectrum, lateral_receptance


def sideways_table(tree: DataTree) -> ReportTable:
    """Lateral force and slip, per law."""
    laws = data.held_laws(tree, FORCE)
    columns = {
        "law": text_cells(laws, "name"),
        "lateral force, rms / N": number_cells(data.values(tree, schema.LATERAL_FORCE_SPREAD), in_digits(3)),
        "beyond friction": text_cells(map(data.in_percent, data.values(tree, schema.SLIP_SHARE)), "number"),
    }
    alone = schema.SINGLE_FORCE_POWER_LEVEL_A
    there = data.laws(tree, schema.SINGLE_FORCE_POWER_LEVEL_A)
    if there:
        levels = np.array([data.of_law(tree, alone, law) for law in laws])
        for name, found in zip(schema.SINGLE_FORCES, levels.T, strict=True):
            if np.isfinite(found).any():
                columns[f"{name} / dB(A)"] = number_cells(found, "{:.1f}")
    note = (
        "Beyond friction: share of the time in which a lateral force of this rms, normally distributed, is "
        "more than the coefficient of friction times the static load; where it is not small, the contact "
        "slips, and the force is less. Alone: sound power re 1 pW that one force would make without the "
        "other; no part of the total, which is under rolling noise."
    )
    return table("sideways_table", "Sideways", columns, note)


# --- how what rolls creeps: stick and slip, friction in time, and which of its modes squeal

FRICTION = schema.FRICTION_FORCE
HEAT = schema.FRICTION_POWER
GROWTH = schema.GROWTH_RATE


@figure(
    "Where it sticks and where it slips",
    Of(schema.CREEP_X, "x"),
    field(schema.TRACTION, schema.CREEP_Y, "q"),
    field(schema.SLIP_VELOCITY, schema.CREEP_Y, "v"),
)
def stick_and_slip(tree: DataTree, lines: Lines) -> Drawn:
    """Traction and slip velocity of a contact, from above."""
    y = data.values(tree, schema.CREEP_Y)
    slender = data.is_of_bearing(tree)
    traction, slip = (data.values(tree, entry) for entry in (schema.TRACTION, schema.SLIP_VELOCITY))
    for name, unit, values in (("traction", "MPa", 1e-6 * traction), ("slip velocity", "mm/s", 1e3 * slip)):
        scale = (f"{name} / {unit}", 0.0, float(values.max()) or 1.0)
        shown = np.where((traction > 0.0) & (values > 0.0), values, np.nan)
        yield map_panel(
            lines.at, y, shown, scale, equal=not slender, title=name, height=4.1, beside=name != "traction"
        )
    which = "The first sample, or smooth bodies, under the working load."
    if slender:
        which = (
            "The contact that makes more heat of the two most loaded ones of both rings, at rest; along and "
            "across to scales of their own."
        )
    yield f"{which} What has traction and no slip velocity sticks."
    if not data.present(tree, FRICTION):  # creepages that follow from the rolling, not from the case
        return
    # where full slip begins, by creepage and by load
    share, load = (data.number(tree, each) for each in (schema.FULL_SLIP_SCALE, schema.FULL_SLIP_LOAD))
    begins = "is not reached" if share is None else f"begins at {rounded(share)} times these creepages"
    under = "under any load of the run" if load is None else f"up to {data.engineering(load, 'N')}"
    yield f"Full slip {begins}, by smooth bodies under the working load; with them all slips {under}."


@figure(
    "Friction force on what rolls",
    Of(rolling.TIME),
    Of(FRICTION, "{way}, {law}", "{law}"),
    Of(HEAT, "heat, {law}", "{law}"),
    rows=force.around_peak,
)
def friction_force(tree: DataTree, lines: Lines) -> Drawn:
    """Friction force along and across, and heat, around the largest force of the main law."""
    time, unit = panels.time_axis(tree, lines.at)
    largest = max(float(np.abs(series.values).max()) for series in lines.of(FRICTION))
    size, symbol = data.force_unit(largest)
    for way in data.words(tree, schema.ROLLING_WAY):  # but for what is nearly nothing
        found = lines.of(FRICTION, way=way)
        if any(np.abs(series.values).max() > 1e-3 * largest for series in found):
            drawn = panels.styled(tree, lines.at / unit, found, size=size)
            yield Panel(time, Axis(f"{way} / {symbol}"), tuple(drawn), height=2.4)
    drawn = panels.styled(tree, lines.at / unit, lines.of(HEAT), size=1e3)
    yield Panel(time, Axis("heat / kW", 0.0), tuple(drawn), height=2.0)
    yield (
        "Around the largest contact force of the main law, at the first contact. Quasi-steady: that of "
        "smooth bodies in steady rolling under the contact force of the moment; zero without contact."
    )


def _growing(tree: DataTree) -> tuple[list[int], list[int]]:
    """Numbers of the motions that grow, the fastest first: those that squeal, and those of the axle."""
    growth = np.nan_to_num(data.values(tree, GROWTH), nan=-np.inf)
    squeals = data.values(tree, schema.SQUEAL_DIAMETERS) >= FREE_OF_AXLE
    order = [int(n) for n in np.argsort(-growth, kind="stable") if growth[n] > 0.0]
    return [n for n in order if squeals[n]], [n for n in order if not squeals[n]]


def _shapes(tree: DataTree) -> Array:
    """Numbers of the modes at rest; of a result that does not know them each motion is one."""
    if data.present(tree, schema.SQUEAL_SHAPE):
        return data.values(tree, schema.SQUEAL_SHAPE)
    return data.values(tree, schema.SQUEAL_MODE)


def _once(tree: DataTree, motions: Iterable[int]) -> list[int]:
    """Of the motions the first of each mode at rest: as a wheel turns, there are two of most."""
    shape = _shapes(tree)
    first = dict[float, int]()
    for n in motions:
        first.setdefault(float(shape[n]), n)
    return list(first.values())


def _named(tree: DataTree, motion: int) -> str:
    entries = schema.AXIAL_SHARE, schema.SQUEAL_DIAMETERS, schema.SQUEAL_FREQUENCY
    axial, count, frequency = (float(data.values(tree, entry)[motion]) for entry in entries)
    return f"{'axial' if axial > 0.5 else 'radial'} n = {count:.0f} at {frequency:.0f} Hz"


def creep_answers(tree: DataTree) -> headline.Answers | None:
    """Say whether a wheel that creeps squeals, in which modes and by what; n are nodal diameters."""
    if not data.present(tree, schema.STICK_AREA):
        return None
    if tuple(data.words(tree, schema.CREEP_WAY)) == schema.WAYS_OFF_TRACK:  # nothing squeals but on a rail
        return None
    if not data.present(tree, GROWTH):
        unknown = "Whether it squeals is not known, for want of the wheel's axial modes."
        return headline.Answers(more=unknown)
    growing, of_axle = _growing(tree)
    growth, frequency, diameters = (
        data.values(tree, entry) for entry in (GROWTH, schema.SQUEAL_FREQUENCY, schema.SQUEAL_DIAMETERS)
    )
    looked = np.flatnonzero(np.isfinite(growth) & (diameters >= FREE_OF_AXLE)).tolist()
    modes = f"{count_of(len(_once(tree, looked)), 'mode')} of the wheel with two and more nodal diameters"
    aside = ""
    if of_axle:
        named = ", ".join(_named(tree, n) for n in _once(tree, of_axle)[:3])
        aside = f" Not counted: {named}, of which the axle decides, here rigid."
    if not growing:
        return headline.Answers(more=f"Squeal: no, all {modes} decay (linear stability).{aside}")
    shapes = _once(tree, growing)
    falls = (data.number(tree, schema.CREEP_DAMPING) or 0.0) < 0.0
    cause = "falling friction" if falls else "mode coupling"
    fastest = ", ".join(_named(tree, n) for n in shapes[:3])
    ratio = max(float(growth[n] / (2.0 * np.pi * frequency[n])) for n in growing)
    decided = "yes" if ratio >= UNDECIDED else "on the edge, too near to be decided"
    more = (
        f"Squeal: {decided}, {len(shapes)} of {modes} grow, by {cause} (linear stability); fastest "
        f"{fastest}, the first e-fold in {data.engineering(1.0 / growth[growing[0]], 's')}; about "
        f"{rounded(100.0 * ratio, 2)} % more of critical damping would stop all.{aside}"
    )
    return headline.Answers(more=more)


@figure(
    "Which modes squeal",
    Of(schema.SQUEAL_FREQUENCY),
    Of(GROWTH),
    Of(schema.SQUEAL_DIAMETERS),
    Of(schema.AXIAL_SHARE),
    Of(schema.SQUEAL_SHAPE, optional=True),
)
def squeal(tree: DataTree, lines: Lines) -> Drawn:
    """Growth rate of each motion over its frequency, named by its nodal diameters where it grows."""
    growth = data.values(tree, GROWTH)
    squeals, of_axle = _growing(tree)
    growing = squeals + of_axle
    reach = 1.2 * max(float(growth[growing].max(initial=0.0)), 5.0)
    looks = (
        (np.flatnonzero(growth <= 0.0), "decays", MUTED, "o"),
        (of_axle, "grows, as the axle decides", BLUE, "s"),
        (squeals, "grows", VERMILLION, "^"),
    )
    points = [
        Line(lines.at[n], growth[n], name, colour, (), 0.0, mark) for n, name, colour, mark in looks if len(n)
    ]
    named = _once(tree, growing)
    diameters = data.values(tree, schema.SQUEAL_DIAMETERS)
    notes = [Note(f" {diameters[n]:.0f}", lines.at[n], growth[n]) for n in named]
    along = panels.frequency_axis(float(np.nanmin(lines.at)) / 1.1, float(np.nanmax(lines.at)) * 1.1)
    yield Panel(along, Axis("growth rate / (1/s)", -reach, reach), (panels.zero(), *points, *notes))
    damping, slope = (data.number(tree, fact) or 0.0 for fact in (schema.CREEP_DAMPING, schema.LOAD_SLOPE))
    yield (
        "Small motions of the wheel on the rail at mid-span, with nodal diameters where they grow; some "
        "decay faster than the axis shows. As the wheel turns, a mode with nodal diameters is two. "
        "Linear, by quasi-steady friction in line with the springs of the contact: it damps by "
        f"{data.engineering(damping, 'N s/m')}, and follows the load by {rounded(slope)}. Squeal is that "
        "of two and more nodal diameters: the others move the axle, which is rigid here."
    )


CREEP = stick_and_slip, friction_force, squeal


def friction_table(tree: DataTree) -> ReportTable:
    """Stick, forces and heat of each contact under the working load, then by each law as means over time."""
    laws = data.held_laws(tree, schema.MEAN_FRICTION_POWER)
    entries = schema.STICK_AREA, schema.SLIP_AREA, schema.SPIN_MOMENT, schema.SAMPLE_HEAT
    stick, slip, moment, heat = (data.values(tree, entry) for entry in entries)
    contacts = ["smooth", *(f"sample {n}" for n in range(1, len(stick)))]
    follows = data.present(tree, FRICTION)
    if not follows:
        contacts = [f"{ring} ring" for ring in data.words(tree, bearing.RING)]

    def column(of_contacts: Iterable[float], in_time: Iterable[float], form: str) -> list[Cell]:
        """Numbers of contacts at rest, then of laws in time; the others are not known."""
        at_rest = [*of_contacts] or [np.nan] * len(contacts)
        return number_cells(at_rest + ([*in_time] or [np.nan] * len(laws)), form)

    columns = {
        "contact": text_cells([*contacts, *(f"in time, {law}" for law in laws)]),
        "sticks / %": column(100.0 * stick / (stick + slip), (), "{:.1f}"),
    }
    if follows:
        full = data.values(tree, schema.FULL_SLIP_SHARE)
        columns["time in full slip / %"] = column((), 100.0 * full, "{:.1f}")
    forces = data.values(tree, schema.SAMPLE_FRICTION).T
    for n, way in enumerate(data.words(tree, schema.CREEP_WAY)):
        means = [data.of_law(tree, FRICTION, law)[n].mean() for law in laws] if follows else ()
        columns[f"force {way}"] = column(forces[n], means, "N")
    columns["spin moment"] = column(moment, (), "N m")
    columns["heat"] = column(heat, data.values(tree, schema.MEAN_FRICTION_POWER), "W")
    if data.present(tree, schema.WEAR_DEPTH):
        columns["wear of a passage"] = column((), data.values(tree, schema.WEAR_DEPTH), "m")
    if not follows:
        note = (
            "Friction on the balls, of the contact of each ring that carries most at rest; in time the mean "
            "of all contacts, those that carry nothing among them."
        )
        return table("friction_table", "Friction", columns, note)
    note = (
        "Friction on what rolls: under the working load, and mean over time, forces at the first contact. "
        "Heat is what drives the creepages, −V (F·ξ + M φ). Wear is that of all contacts, as a mean depth "
        "over the width of the smooth contact."
    )
    return table("friction_table", "Friction", columns, note)
