"""Figures of the track: receptances, decay rate, loss factors; and what it marks in others."""

from collections.abc import Iterator
from dataclasses import replace

import numpy as np
from xarray import DataTree

from asperity.reporting import chart, data, panels
from asperity.reporting.chart import INK, MUTED, VERMILLION, Axis, Mark, Note, Numbers, Panel, Rules
from asperity.reporting.figure import Figure, Lines, Of
from asperity.scenes import schema
from asperity.scenes.figures.measured import MEASURED, over_bands
from asperity.schema import rolling

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


TONES = 20
"""Multiples of sleeper passing that are marked: further ones lie too close on an axis by octaves."""


def sleeper_tones(tree: DataTree, low: float, high: float) -> list[Mark]:
    """Short rules at n v/L between two frequencies, the first `TONES`."""
    tone = data.number(tree, schema.SLEEPER_PASSING_FREQUENCY)
    last = min(np.floor(high / tone), TONES) if tone else 0.0
    return [_short(tone * np.arange(np.ceil(low / tone), last + 1.0))] if tone else []


def sleeper_times(tree: DataTree, start: float, end: float, unit: float) -> list[Mark]:
    """Short rules where the wheel passes sleepers between two times, on an axis in `unit` s."""
    spacing, speed = data.number(tree, schema.SLEEPER_SPACING), data.number(tree, rolling.SPEED)
    if not spacing or not speed or not data.present(tree, rolling.POSITION):
        return []
    time, position = data.values(tree, rolling.TIME), data.values(tree, rolling.POSITION)
    first, last = np.interp([start, end], time, position)
    sleepers = sleepers_between(tree, first, last, spacing)
    return [_short((time[0] + (sleepers - position[0]) / speed) / unit)]


def sleepers_between(tree: DataTree, first: float, last: float, spacing: float) -> Numbers:
    """Places of the sleepers between two others, m: equally spaced, or as bays of a cell that repeats."""
    if not data.present(tree, schema.BAY_LENGTH):
        return spacing * np.arange(np.ceil(first / spacing), np.floor(last / spacing) + 1)
    ends = np.cumsum(data.values(tree, schema.BAY_LENGTH))
    cells = np.arange(np.floor(first / ends[-1]), np.floor(last / ends[-1]) + 1)
    every = (ends[-1] * cells[:, None] + np.concatenate([[0.0], ends[:-1]])).ravel()
    return every[(every >= first) & (every <= last)]


def _short(at: Numbers) -> Rules:
    return Rules(at, colour=INK, dashes=(), width=0.8, short=True)


# --- receptances and decay rates


_MIDSPAN = "rail, mid-span", (chart.BLUE,)
_SUPPORT = "rail, over a sleeper", (VERMILLION, (6, 1.5))
RECEPTANCES = (
    Of(schema.RECEPTANCE_MIDSPAN, "", *_MIDSPAN),
    Of(schema.RECEPTANCE_MIDSPAN_PHASE, "receptance_midspan phase", *_MIDSPAN),
    Of(schema.RECEPTANCE_SUPPORT, "", *_SUPPORT),
    Of(schema.RECEPTANCE_SUPPORT_PHASE, "receptance_support phase", *_SUPPORT),
    Of(schema.RECEPTANCE_ALL_BAYS, "", "rail, mid-spans of all bays, rms", (INK, (), 1.6), optional=True),
    Of(schema.RECEPTANCE_EQUAL_BAYS, "", "rail, mid-span of equal bays", (MUTED, (3, 1.5)), optional=True),
    Of(schema.WHEEL_RECEPTANCE, "", "wheel", (chart.GREEN, (6, 1.5, 1.5, 1.5))),
    Of(schema.CONTACT_RECEPTANCE, "", "contact spring", (MUTED, (1.5, 1.5))),
)
_MOBILITY = over_bands(schema.MEASURED_MOBILITY, schema.RECEPTANCE_MIDSPAN)


_LATERAL = over_bands(
    schema.MEASURED_LATERAL_DECAY_RATE, schema.DECAY_RATE, (MUTED, (), 1.4), f"{MEASURED}, lateral"
)


def _along(lines: Lines) -> tuple[Axis, tuple[float, float]]:
    """Axis of all positive frequencies, and its ends."""
    ends = float(lines.at[lines.at > 0][0]), float(lines.at[-1])
    return panels.frequency_axis(*ends), ends


def _receptance(tree: DataTree, lines: Lines) -> Iterator[Panel]:
    """Magnitude of the receptances, and below it their phase."""
    along, ends = _along(lines)
    magnitudes = panels.styled(tree, lines.at, [s for s in lines.lines if s.units != "rad"])
    size = Axis("|receptance| / (m/N)", log=True)
    yield Panel(along, size, (*natural_rules(tree, *ends), *magnitudes), height=4.0)
    if phases := [s for s in lines.lines if s.units == "rad"]:
        turned = [replace(s, values=(np.degrees(s.values) + 180) % 360 - 180) for s in phases]
        turns = tuple((degrees, f"{degrees:g}") for degrees in (-180.0, -90.0, 0.0, 90.0, 180.0))
        phase, rules = Axis("phase / °", -190.0, 190.0, ticks=turns), natural_rules(tree, *ends, named=False)
        yield Panel(along, phase, (*rules, *panels.styled(tree, lines.at, turned)), height=2.2)


def _receptance_caption(tree: DataTree) -> str:
    facts = []
    if speed := data.number(tree, schema.CRITICAL_SPEED):
        facts.append(f"critical speed {data.plain(speed)} m/s")
    if deflection := data.number(tree, schema.STATIC_DEFLECTION):
        facts.append(f"static deflection of the rail under the wheel {data.engineering(deflection, 'm')}")
    stated = f" Of this track: {'; '.join(facts)}." if facts else ""
    return (
        "Displacement per force at the point of the force, both positive downwards, time factor e^{+iωt}: "
        "a spring has the phase 0°, a mass ±180°, a damper −90°. Dotted lines: frequencies of the resting "
        f"track.{stated}{_first_bay(tree)}"
    )


def _first_bay(tree: DataTree) -> str:
    """Say which bay is shown, where they differ."""
    if not data.present(tree, schema.BAY):
        return ""
    count = len(data.values(tree, schema.BAY))
    return f" Of the first of {count} bays that differ, and of the sleeper with which it begins."


def _decay(tree: DataTree, lines: Lines) -> Iterator[Panel]:
    """Decay rate along the rail against frequency, with the limit that tests of vehicles ask for."""
    positive = [replace(s, values=np.where(s.values > 0, s.values, np.nan)) for s in lines.lines]
    rates = panels.styled(tree, lines.at, positive)
    along, ends = _along(lines)
    axis = panels.log_axis("decay rate / (dB/m)", [line.y for line in rates], lowest=0.01)
    yield Panel(along, axis, (*natural_rules(tree, *ends), *rates), height=3.9)


def _decay_caption(tree: DataTree) -> str:
    limit = (
        " Dashed: the lowest decay that ISO 3095 allows the track of a vehicle's noise test, vertical."
        if data.present(tree, schema.DECAY_RATE_LIMIT)
        else ""
    )
    return (
        "Decay of the vertical bending wave along the rail. Eigenvalue: the least decaying wave of the "
        f"periodic track, −20 lg|λ|/L; EN 15461: from the responses at the distances of the standard.{limit}"
    )


TRACK = (
    Figure(
        "receptance",
        "Receptance of rail, wheel and contact",
        Of(schema.TRACK_FREQUENCY),
        (*RECEPTANCES, _MOBILITY),
        _receptance,
        _receptance_caption,
        any_of=tuple(each.entry for each in RECEPTANCES if each.entry.units != "rad"),
    ),
    Figure(
        "decay_rate",
        "Decay rate of the track",
        Of(schema.TRACK_FREQUENCY),
        (
            Of(schema.DECAY_RATE, "", "eigenvalue", (chart.BLUE, (), 1.6)),
            Of(schema.DECAY_RATE_EN15461, "", "EN 15461, sum over distances", (VERMILLION, (6, 1.5), 1.2)),
            Of(schema.DECAY_RATE_LIMIT, "", "lower limit, ISO 3095", (INK, (4, 2), 1.4)),
            over_bands(schema.MEASURED_DECAY_RATE, schema.DECAY_RATE),
            _LATERAL,
        ),
        _decay,
        _decay_caption,
        any_of=(schema.DECAY_RATE, schema.DECAY_RATE_EN15461),
    ),
)


# --- loss factors: what stands for them in time, and what that does to the contact force

_FORCE = schema.LOSS_FACTOR_FORCE_ERROR


def _loss(tree: DataTree, lines: Lines) -> Iterator[Panel]:
    """Errors of the force per one-third octave."""
    (error,) = (s.values for s in lines.of(_FORCE))
    edges = lines.at / panels.EDGE, lines.at * panels.EDGE, np.fmin(error, 0.0), np.fmax(error, 0.0)
    boxes = chart.Boxes(*edges, "contact force", chart.BLUE, hatch="/")
    zero = panels.zero(colour=INK, width=0.8)
    yield Panel(panels.band_axis(lines.at), Axis("error / dB"), (boxes, zero), height=2.4)


def _loss_caption(tree: DataTree) -> str:
    rest, nominal = (
        data.number(tree, a) for a in (schema.STATIC_DEFLECTION_IN_TIME, schema.STATIC_DEFLECTION)
    )
    softer = ""
    if rest and nominal:
        softer = (
            " At rest the track is softer: the wheel's load lowers the rail by "
            f"{data.engineering(rest, 'm')}, by {data.engineering(nominal, 'm')} on the nominal stiffnesses."
        )
    return (
        "Nothing that answers after a force only has one stiffness and one loss factor at all frequencies, "
        "or any measured table: the stiffness grows where it dissipates. In time, springs and Maxwell "
        "elements stand for them, chosen for the contact force. Drawn: level of the linear contact force "
        "over that with constant loss factors, for a wheel at rest, mean over a bay. Receptances, decay "
        f"rates and the linear contact in the frequency domain have constant loss factors.{softer}"
    )


LOSS_FACTORS = Figure(
    "loss_factors",
    "Loss factors in time",
    Of(schema.TRACK_BAND, "band centre"),
    (Of(_FORCE, "contact force, error"),),
    _loss,
    _loss_caption,
)
