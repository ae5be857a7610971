"""Figures of track and wheel: receptances, decay rate, loss factors, roughness; and marks in others."""

from dataclasses import replace

import numpy as np
from xarray import DataTree

from asperity.arguments import Array
from asperity.reporting import chart, data, panels
from asperity.reporting.chart import INK, MUTED, VERMILLION, Axis, Drawn, Line, Mark, Note, Panel, Rules
from asperity.reporting.figure import Lines, Of, figure
from asperity.scenes import schema
from asperity.scenes.figures.measured import MEASURED, over_bands
from asperity.schema import contact, rolling
from asperity.spectra import HALF_BAND, third_octave_bands
from asperity.written_numbers import rounded

# --- marks of the track: its natural frequencies, the passing of sleepers

_NAMES = {
    "anti-resonance": schema.ANTIRESONANCE_FREQUENCY,
    "cut-on": schema.CUT_ON_FREQUENCY,
    "pinned–pinned": schema.PINNED_PINNED_FREQUENCY,
}


def natural_frequencies(tree: DataTree) -> dict[str, float]:
    """Frequencies of the resting track that the results state, in Hz, low to high, by name."""
    found = {name: frequency for name, a in _NAMES.items() if (frequency := data.number(tree, a))}
    return dict(sorted(found.items(), key=lambda item: item[1]))


def natural_rules(tree: DataTree, low: float, high: float, named: bool = True) -> list[Mark]:
    """Natural frequencies between two others, their names written along them."""
    inside = {name: f for name, f in natural_frequencies(tree).items() if low < f < high}
    notes = [Note(f"{name}, {f:.0f} Hz", f, 0.03, y_share=True, upright=True) for name, f in inside.items()]
    return [Rules(np.array(list(inside.values()))), *(notes if named else [])]


def pinned_pinned_split(tree: DataTree) -> tuple[float, float] | None:
    """The two frequencies f_pp ∓ v/2L that a moving load feels instead of f_pp, in Hz."""
    low, high = (data.number(tree, end) for end in (schema.PINNED_PINNED_LOW, schema.PINNED_PINNED_HIGH))
    return (low, high) if low and high else None


def split_rules(tree: DataTree, low: float, high: float) -> list[Mark]:
    """Frequencies f_pp ∓ v/2L between two others, with their name at the top."""
    split = pinned_pinned_split(tree)
    if split is None or not low < split[0] < split[1] < high:
        return []
    return [Rules(np.array(split)), Note("f_pp ∓ v/2L", split[1], 0.97, y_share=True)]


TONES = 12
"""Multiples of sleeper passing that are marked: further ones lie too close on an axis by octaves."""


def sleeper_tones(tree: DataTree, low: float, high: float) -> list[Mark]:
    """Short rules at n v/L between two frequencies, the first `TONES`."""
    tone = data.number(tree, schema.SLEEPER_PASSING_FREQUENCY)
    last = min(np.floor(high / tone), TONES) if tone else 0.0
    return [_short(tone * np.arange(np.ceil(low / tone), last + 1.0))] if tone else []


def sleeper_times(tree: DataTree, start: float, end: float, unit: float) -> list[Mark]:
    """Short rules where the wheel passes sleepers between two times, on an axis in `unit` s."""
    spacing = data.number(tree, schema.SLEEPER_SPACING)
    speed = data.number(tree, rolling.SPEED)
    if not spacing or not speed or not data.present(tree, rolling.POSITION):
        return []
    time = data.values(tree, rolling.TIME)
    position = data.values(tree, rolling.POSITION)
    first, last = np.interp([start, end], time, position)
    sleepers = sleepers_between(tree, first, last, spacing)
    return [_short((time[0] + (sleepers - position[0]) / speed) / unit)]


def sleepers_between(tree: DataTree, first: float, last: float, spacing: float) -> Array:
    """Places of the sleepers between two others, m: equally spaced, or as bays of a cell that repeats."""
    if not data.present(tree, schema.BAY_LENGTH):
        return spacing * np.arange(np.ceil(first / spacing), np.floor(last / spacing) + 1)
    ends = np.cumsum(data.values(tree, schema.BAY_LENGTH))
    cells = np.arange(np.floor(first / ends[-1]), np.floor(last / ends[-1]) + 1)
    every = (ends[-1] * cells[:, None] + np.concatenate([[0.0], ends[:-1]])).ravel()
    return every[(every >= first) & (every <= last)]


def _short(at: Array) -> Rules:
    return Rules(at, colour=INK, dashes=(), width=0.8, short=True)


# --- receptances and decay rates


_MIDSPAN = "rail, mid-span", (chart.BLUE,)
_SUPPORT = "rail, over a sleeper", (VERMILLION, (6, 1.5))
RECEPTANCES = (
    Of(schema.RECEPTANCE_MIDSPAN, "", *_MIDSPAN, optional=True),
    Of(schema.RECEPTANCE_MIDSPAN_PHASE, "receptance_midspan phase", *_MIDSPAN, optional=True),
    Of(schema.RECEPTANCE_SUPPORT, "", *_SUPPORT, optional=True),
    Of(schema.RECEPTANCE_SUPPORT_PHASE, "receptance_support phase", *_SUPPORT, optional=True),
    Of(schema.RECEPTANCE_ALL_BAYS, "", "rail, mid-spans of all bays, rms", (INK, (), 1.6), optional=True),
    Of(schema.RECEPTANCE_EQUAL_BAYS, "", "rail, mid-span of equal bays", (MUTED, (3, 1.5)), optional=True),
    Of(schema.WHEEL_RECEPTANCE, "", "wheel", (chart.GREEN, (6, 1.5, 1.5, 1.5)), optional=True),
    Of(schema.CONTACT_RECEPTANCE, "", "contact spring", (MUTED, (1.5, 1.5)), optional=True),
)
_MOBILITY = over_bands(schema.MEASURED_MOBILITY, schema.RECEPTANCE_MIDSPAN)


def _along(lines: Lines) -> tuple[Axis, tuple[float, float]]:
    """Axis of all positive frequencies, and its ends."""
    ends = float(lines.at[lines.at > 0][0]), float(lines.at[-1])
    return panels.frequency_axis(*ends), ends


@figure("Receptance of rail, wheel and contact", Of(schema.TRACK_FREQUENCY), *RECEPTANCES, _MOBILITY)
def receptance(tree: DataTree, lines: Lines) -> Drawn:
    """Magnitude of the receptances, and below it their phase."""
    along, ends = _along(lines)
    magnitudes = panels.styled(tree, lines.at, [s for s in lines.lines if s.units != "rad"])
    if not magnitudes:
        return
    size = Axis("|receptance| / (m/N)", log=True)
    yield Panel(along, size, (*natural_rules(tree, *ends), *magnitudes), height=4.0)
    if phases := [s for s in lines.lines if s.units == "rad"]:
        turned = [replace(s, values=(np.degrees(s.values) + 180) % 360 - 180) for s in phases]
        turns = tuple((degrees, f"{degrees:g}") for degrees in (-180.0, -90.0, 0.0, 90.0, 180.0))
        phase = Axis("phase / °", -190.0, 190.0, ticks=turns)
        rules = natural_rules(tree, *ends, named=False)
        yield Panel(along, phase, (*rules, *panels.styled(tree, lines.at, turned)), height=2.2)
    yield (
        "Displacement per force at the point of the force, both positive downwards, time factor e^{+iωt}: "
        "a spring has the phase 0°, a mass ±180°, a damper −90°. Dotted lines: frequencies of the resting "
        "track."
    )
    facts = []
    if speed := data.number(tree, schema.CRITICAL_SPEED):
        facts.append(f"critical speed {data.plain(speed)} m/s")
    if deflection := data.number(tree, schema.STATIC_DEFLECTION):
        facts.append(f"static deflection of the rail under the wheel {data.engineering(deflection, 'm')}")
    if facts:
        yield f"Of this track: {'; '.join(facts)}."
    if data.present(tree, schema.BAY):
        count = len(data.values(tree, schema.BAY))
        yield f"Of the first of {count} bays that differ, and of the sleeper with which it begins."


_RATES = (
    Of(schema.DECAY_RATE, "", "eigenvalue", (chart.BLUE, (), 1.6), optional=True),
    Of(
        schema.DECAY_RATE_EN15461, "", "EN 15461, sum over distances", (VERMILLION, (6, 1.5), 1.2),
        optional=True,
    ),
    Of(schema.DECAY_RATE_LIMIT, "", "lower limit, ISO 3095", (INK, (4, 2), 1.4), optional=True),
    over_bands(schema.MEASURED_DECAY_RATE, schema.DECAY_RATE),
    over_bands(
        schema.MEASURED_LATERAL_DECAY_RATE, schema.DECAY_RATE, (MUTED, (), 1.4), f"{MEASURED}, lateral"
    ),
)  # fmt: skip


@figure("Decay rate of the track", Of(schema.TRACK_FREQUENCY), *_RATES)
def decay_rate(tree: DataTree, lines: Lines) -> Drawn:
    """Decay rate along the rail against frequency, with the limit that tests of vehicles ask for."""
    if not lines.of(schema.DECAY_RATE, schema.DECAY_RATE_EN15461):
        return
    positive = [replace(s, values=np.where(s.values > 0, s.values, np.nan)) for s in lines.lines]
    rates = panels.styled(tree, lines.at, positive)
    along, ends = _along(lines)
    axis = panels.log_axis("decay rate / (dB/m)", [line.y for line in rates], lowest=0.01)
    yield Panel(along, axis, (*natural_rules(tree, *ends), *rates), height=3.9)
    yield (
        "Decay of the vertical bending wave along the rail. Eigenvalue: the least decaying wave of the "
        "periodic track, −20 lg|λ|/L; EN 15461: from the responses at the distances of the standard."
    )
    if lines.of(schema.DECAY_RATE_LIMIT):
        yield "Dashed: the lowest decay that ISO 3095 allows the track of a vehicle's noise test, vertical."


# --- loss factors: what stands for them in time, and what that does to the contact force

_FORCE = schema.LOSS_FACTOR_FORCE_ERROR


@figure("Loss factors in time", Of(schema.TRACK_BAND, "band centre"), Of(_FORCE, "contact force, error"))
def loss_factors(tree: DataTree, lines: Lines) -> Drawn:
    """Errors of the force per one-third octave."""
    (error,) = (s.values for s in lines.of(_FORCE))
    edges = lines.at / panels.EDGE, lines.at * panels.EDGE, np.fmin(error, 0.0), np.fmax(error, 0.0)
    boxes = chart.Boxes(*edges, "contact force", chart.BLUE, hatch="/")
    zero = panels.zero(colour=INK, width=0.8)
    yield Panel(panels.band_axis(lines.at), Axis("error / dB"), (boxes, zero), height=2.4)
    yield (
        "Nothing that answers after a force only has one stiffness and one loss factor at all frequencies, "
        "or any measured table: the stiffness grows where it dissipates. In time, springs and Maxwell "
        "elements stand for them, chosen for the contact force. Drawn: level of the linear contact force "
        "over that with constant loss factors, for a wheel at rest, mean over a bay. Receptances, decay "
        "rates and the linear contact in the frequency domain have constant loss factors."
    )
    rest, nominal = (
        data.number(tree, a) for a in (schema.STATIC_DEFLECTION_IN_TIME, schema.STATIC_DEFLECTION)
    )
    if rest and nominal:
        yield (
            "At rest the track is softer: the wheel's load lowers the rail by "
            f"{data.engineering(rest, 'm')}, by {data.engineering(nominal, 'm')} on the nominal stiffnesses."
        )


# --- roughness, on the axes that rail acoustics uses

PRODUCT = schema.SURFACE_BAND_LENGTH_PRODUCT
NAMED = 3
"""Orders that are named in words."""
COMPARED = (100.0, 5000.0)
"""Hz, of the bands that laws are compared in."""
SPAN = 60.0
"""Levels, dB, that are drawn below the highest: a texture without waves leaves rounding errors."""
_LOOKS = {
    "rail": (chart.BLUE, (), 1.4, "o"),
    "wheel": (VERMILLION, (6, 1.5), 1.4, "s"),
    "combined": (INK, (1.5, 1.5), 1.8, ""),
}


def _millimetres(wavelength: float) -> str:
    """Nominal name of a band of wavelength in mm, as ``"31.5"`` or ``"1000"``."""
    return f"{float(data.nominal_band(wavelength)) * 1e3:g}" if wavelength < 900 else f"{1e3 * wavelength:g}"


@figure(
    "Roughness of rail and wheel",
    Of(schema.SURFACE_BAND, "wavelength"),
    panels.products(PRODUCT),
    Of(schema.ROUGHNESS_LEVEL, "{part}"),
    Of(schema.STATED_ROUGHNESS_LEVEL, "{part} as stated", optional=True),
)
def roughness(tree: DataTree, lines: Lines) -> Drawn:
    """Roughness levels per one-third octave of wavelength, long waves on the left."""
    parts = lines.of(schema.ROUGHNESS_LEVEL)
    lowest = max(np.nanmax(series.values) for series in parts) - SPAN
    levels = [np.where(series.values >= lowest, series.values, np.nan) for series in parts]
    kept = np.isfinite(levels).any(axis=0)  # bands in which some part reaches into the span
    wavelength = lines.at[kept]
    speed = data.number(tree, rolling.SPEED)
    drawn = [
        Line(wavelength, level[kept], series.name, *_LOOKS.get(series.name, (MUTED, (), 1.4, "^")))
        for series, level in zip(parts, levels, strict=True)
    ]
    stated = [
        Line(wavelength, series.values[kept], series.name, _LOOKS[part][0], (1.5, 2.5), 1.0)
        for series in lines.of(schema.STATED_ROUGHNESS_LEVEL)
        if (part := series.name.removesuffix(" as stated")) != "combined" and part in _LOOKS
    ]
    drawn += [line for line in stated if np.isfinite(line.y).any()]
    axis = panels.levels_axis(
        "roughness level / dB re 1 µm", [line.y for line in drawn], span=100.0, step=5.0
    )
    along = panels.band_axis(np.sort(wavelength), "wavelength / mm", _millimetres)
    along = panels.long_waves_left(along, f"frequency v/λ, at v = {rounded(speed or 0.0)} m/s", speed)
    doubtful = panels.doubtful_boxes(wavelength, data.doubtful(tree, PRODUCT)[kept])
    yield Panel(along, axis, (*doubtful, *_contact(tree, wavelength), *drawn), height=4.2)
    yield (
        "Roughness levels per one-third octave of wavelength, re 1 µm, of the textures that were rolled, "
        "before any contact filter."
    )
    if stated:
        yield "Dotted: as the spectrum of the case states it, of which this is one texture."
    if any(series.name == "combined" for series in parts):
        yield "Combined: rail and wheel as they meet in the contact."
    rough = [series for series in parts if series.name != "combined"]
    held = np.isfinite([line.y for line in stated]).any(axis=0) if len(stated) == len(rough) else None
    if speed and (held is None or held.any()):
        yield _heard(wavelength if held is None else wavelength[held], speed, data.at_its_fastest(tree))
    yield (
        "Left out: bands that the texture does not hold, and levels more than "
        f"{SPAN:.0f} dB below the highest."
    )
    yield panels.shaded_words(tree, PRODUCT).replace("time B T", "length B T")


@figure(
    "Out of round, by orders",
    Of(schema.ORDER, "order"),
    Of(schema.ORDER_FREQUENCY, "frequency"),
    Of(schema.ORDER_LEVEL, "level"),
)
def out_of_round(tree: DataTree, lines: Lines) -> Drawn:
    """Level of each order of what rolls, and the frequency at which it passes the contact."""
    (level,) = (series.values for series in lines.of(schema.ORDER_LEVEL))
    (frequency,) = (series.values for series in lines.of(schema.ORDER_FREQUENCY))
    order = lines.at
    axis = panels.levels_axis("level of the rms height / dB re 1 µm", [level], span=SPAN)
    at = data.at_its_fastest(tree)
    second = chart.Second(f"frequency{at} / Hz", scale=float(frequency[0] / order[0]))
    along = chart.Axis("order: waves around", 0.0, float(order[-1]) + 1.0, second=second)
    base = np.full(len(level), axis.low if axis.low is not None else float(np.nanmin(level)))
    half = np.full(len(level), 0.35)
    bars = chart.Boxes(order - half, order + half, base, np.fmax(level, base), colour=VERMILLION)
    yield Panel(along, axis, (bars,), height=3.0)
    run_out = data.number(tree, schema.RUN_OUT)
    amplitude = np.sqrt(2.0) * 1e-6 * 10.0 ** (level / 20.0)
    largest = np.argsort(-np.nan_to_num(amplitude), kind="stable")[:NAMED].tolist()
    told = ", ".join(
        f"{order[n]:.0f} with {data.engineering(float(amplitude[n]), 'm')} at {rounded(frequency[n])} Hz"
        for n in largest
        if level[n] > np.nanmax(level) - SPAN
    )
    swing = "" if run_out is None else f"Run-out {data.engineering(run_out, 'm')}. "
    yield f"{swing}The largest orders, by their amplitude: {told}{at}."
    yield "An order n passes n times in each turn."


def _heard(wavelength: Array, speed: float, changing: str) -> str:
    """Say which one-third octaves of frequency bands of wavelength, m, cover at a speed, m/s.

    And of one that changes that it is the fastest.
    """
    bands, _, _ = third_octave_bands(*COMPARED)
    ends = speed / wavelength.max(), speed / wavelength.min()
    heard = int(np.sum((bands >= ends[0] / HALF_BAND) & (bands <= ends[1] * HALF_BAND)))
    passed = " to ".join(data.engineering(each, "Hz") for each in ends)
    smooth = "; in the others the surfaces are smooth" * (heard < len(bands))
    of = f"{heard} of the {len(bands)} one-third octaves from 100 Hz to 5 kHz"
    at = "At its fastest, " if changing else "At "
    return f"{at}{speed:.4g} m/s they pass with {passed}: {of}{smooth}."


def _contact(tree: DataTree, wavelength: Array) -> list[Mark]:
    """The length of the contact, where it is among the wavelengths."""
    length = 2 * (data.number(tree, contact.HERTZ_RADIUS) or 0.0)
    if not wavelength.min() < length < wavelength.max():
        return []
    words = f"length of the contact, 2a = {data.engineering(length, 'm')}"
    return [Rules(np.array([length]), colour=INK), Note(words, length, 0.97, y_share=True, align="right")]
