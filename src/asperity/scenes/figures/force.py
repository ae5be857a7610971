"""Figures of the contact force: in time, in lines and in one-third octaves, of one contact and of all."""

from collections.abc import Iterator
from dataclasses import replace
from typing import Any

import numpy as np
from xarray import DataTree

from asperity.arguments import Array, Flags
from asperity.reporting import chart, data, panels
from asperity.reporting.chart import Drawn, Panel
from asperity.reporting.figure import Lines, Of, Series, figure
from asperity.reporting.tables import ReportTable, number_cells, table, text_cells
from asperity.scenes import schema
from asperity.scenes.figures import track
from asperity.schema import rolling, spectra
from asperity.schema.spectra import BAND, BAND_TIME_PRODUCT, CONTACT_FORCE_LEVEL
from asperity.spectra import energy_mean
from asperity.written_numbers import rounded

TO_REFERENCE = spectra.FORCE_LEVEL_DIFFERENCE_TO_REFERENCE
FORCES = Of(rolling.CONTACT_FORCE, "{law}")
IN_FREQUENCY = "linear, frequency domain"
"""Name of the linear contact that is solved there."""
REFERENCE_PSD, REFERENCE_LEVEL = (
    Of(entry, IN_FREQUENCY, look=(chart.INK, (3.0, 3.0), 1.0), optional=True)
    for entry in (schema.LINEAR_REFERENCE_PSD, schema.LINEAR_REFERENCE_LEVEL)
)


# --- over frequency


def _differences(tree: DataTree) -> Iterator[Series]:
    """Differences to the linear laws and to the reference law."""
    compared = data.differences(tree) | {TO_REFERENCE: "reference"}
    for entry, law in compared.items():
        for series in Of(entry, "{law}", optional=True)(tree):
            if series.name != law:
                yield replace(series, name=f"{series.name} minus {law}")


@figure(
    "Contact force levels in one-third octaves",
    Of(spectra.BAND, "band centre"),
    panels.products(spectra.BAND_TIME_PRODUCT),
    Of(spectra.FORCE_LEVEL, "{law}"),
    _differences,
    REFERENCE_LEVEL,
)
def force_bands(tree: DataTree, lines: Lines) -> Drawn:
    """Levels in one-third octaves, and below them the differences to the linear laws and to the reference."""
    levels, reference = (
        panels.styled(tree, lines.at, lines.of(entry), markers=True)
        for entry in (spectra.FORCE_LEVEL, REFERENCE_LEVEL.entry)
    )
    label = "contact force level / dB re 1 N"
    every = [*levels, *reference]
    yield panels.band_panel(tree, lines, label, every, of=levels, span=100.0, height=3.6)
    under = (*panels.shaded_bands(tree, labelled=False), panels.zero())
    compared = data.differences(tree)
    whole = data.stored_variable(tree, TO_REFERENCE)
    solved = {} if whole is None else {TO_REFERENCE: str(whole.attrs["reference"])}
    for entry, law in (compared | solved).items():
        less = panels.styled(tree, lines.at, lines.of(entry), markers=True, main=levels[-1].law)
        axis = panels.levels_axis(f"level − {law} / dB", [line.y for line in less], span=np.inf, step=5.0)
        yield Panel(panels.band_axis(lines.at), axis, (*under, *less), height=2.4)
    yield "Levels per one-third octave (IEC 61260-1, base 10)."
    if reference:
        yield "Dashed: the linear contact solved in the frequency domain."
    if compared:
        others = " and that of ".join(compared.values())
        yield f"Below: level minus that of {others}; positive where linear contact underestimates."
    for law in solved.values():
        yield f"Last: level minus that of {law}, which solves or scans the whole contact."
    yield data.of_first_contact(tree)
    yield panels.shaded_words(tree)


@figure(
    "Contact force against frequency", Of(spectra.FREQUENCY), Of(spectra.FORCE_PSD, "{law}"), REFERENCE_PSD
)
def force_psd(tree: DataTree, lines: Lines) -> Drawn:
    """Power spectral densities over frequency, with the track's marks behind."""
    at, levels = panels.narrow_levels(tree, lines, lines.lines)
    drawn = panels.styled(tree, at, levels)
    ends = panels.frequency_range(tree)
    behind = (*track.sleeper_tones(tree, *ends), *track.split_rules(tree, *ends))
    yield panels.spectrum_panel(tree, "contact force PSD / dB re 1 N²/Hz", drawn, behind)
    main = data.main_law(tree, spectra.FORCE_PSD)
    yield f"Contact force of all laws, one-sided PSD, {panels.DRAWN}; thick: the main law, {main}."
    if data.present(tree, REFERENCE_PSD.entry):
        yield (
            "Dashed: the linear contact in the frequency domain, F = −h/(α_W + α_C + α_R), at rest, with "
            "constant loss factors."
        )
    if tone := data.number(tree, schema.SLEEPER_PASSING_FREQUENCY):
        yield f"Ticks along the bottom: sleeper passing, n v/L, n up to {track.TONES}, every {tone:.1f} Hz."
    if split := track.pinned_pinned_split(tree):
        words = f"{split[0]:.0f} and {split[1]:.0f} Hz"
        yield f"Dotted: the pinned–pinned frequency as the moving wheel meets it, {words}."
    if turns := data.number(tree, schema.WHEEL_REVOLUTION_FREQUENCY):
        yield f"The wheel turns at {turns:.1f} Hz."
    yield data.of_first_contact(tree)
    yield panels.shaded_words(tree)


# --- in time

STRETCHES = 700
"""Of the whole run, whose extremes are in the CSV file."""
AROUND_PEAK = 0.024
"""Length of the piece around the largest force, s."""


def lost(tree: DataTree, law: str, force: Array) -> Flags:
    """Where contact is lost, as `force` of `law` shows; nowhere if the contact pulls as well."""
    share = rolling.CONTACT_LOSS_SHARE
    never = law in data.laws(tree, share) and data.of_law(tree, share, law) == 0
    return np.zeros(len(force), dtype=bool) if never or data.law_entry(tree, law).may_pull else force <= 0


def _main_force(tree: DataTree) -> Array:
    return data.of_law(tree, rolling.CONTACT_FORCE, data.main_law(tree, rolling.CONTACT_FORCE))


def around_peak(tree: DataTree, length: float = AROUND_PEAK) -> slice:
    """Time steps within `length` s around the largest force of the main law."""
    time = data.values(tree, rolling.TIME)
    steps = min(len(time), max(2, round(length * (len(time) - 1) / (time[-1] - time[0]))))
    start = int(np.nanargmax(_main_force(tree))) - steps // 2
    start = min(max(start, 0), len(time) - steps)
    return slice(start, start + steps)


def _forces(tree: DataTree, lines: Lines, **look: Any) -> Iterator[Panel]:
    """Contact force of all laws over a piece of the run, and below it, where there is any, the loss of it."""
    data.leave_to_bearing(tree)
    axis, unit = panels.time_axis(tree, lines.at)
    size, symbol = data.force_unit(float(np.nanmax(np.abs(data.values(tree, rolling.CONTACT_FORCE)))))
    low, high = (end / size for end in panels.main_limits(lines.lines, data.pulling(tree)))
    drawn = [
        replace(line, opacity=0.5, width=0.8) if np.nanmin(line.y) < low or np.nanmax(line.y) > high else line
        for line in panels.styled(tree, lines.at / unit, lines.lines, size=size, **look)
    ]
    bars = [_bars(tree, s, lines.at / unit, row) for row, s in enumerate(lines.lines)]
    shades = [panels.shade(bars[0].left, bars[0].right, law=bars[0].law)] if bars[0].left.size else []
    force = chart.Axis(f"contact force / {symbol}", low, high)
    yield Panel(axis, force, (*shades, panels.zero(), *drawn), height=3.3)
    if shown := tuple(bar for bar in bars if bar.left.size):
        rows = panels.words_axis([s.law for s in lines.lines], "no contact", margin=0.6, down=True)
        yield Panel(axis, rows, shown, height=0.6 + 0.16 * len(bars))


def _bars(tree: DataTree, series: Series, time: Array, row: int) -> chart.Boxes:
    """Stretches without contact in a row, half a time step longer at either end than from first to last."""
    first, last = panels.stretches(lost(tree, series.law, series.values)).T
    half = 0.5 * (time[1] - time[0])
    middle = np.full(first.shape, float(row))
    ends = (time[first] - half, time[last] + half, middle - 0.35, middle + 0.35)
    return chart.Boxes(*ends, colour=data.law_entry(tree, series.law).colour, law=series.law)


_WORDS = (
    "The axis suits the main law. Bars below, if any: no contact (F ≤ 0), shaded above for the main law; "
    "a law that pulls cannot lose it."
)


@figure("Contact force, the whole run", Of(rolling.TIME), FORCES, stretches=STRETCHES)
def force_envelope(tree: DataTree, lines: Lines) -> Drawn:
    """Contact force of all laws over the whole run, every time step."""
    yield from _forces(tree, lines, width=0.9)
    count = min(STRETCHES, len(lines.at))
    yield (
        "Every time step; compression positive. Where steps lie too close to draw, a line spans lowest and "
        f"highest force. {_WORDS} The CSV file holds lowest and highest force in each of {count} stretches, "
        "run.nc every time step."
    )
    yield data.of_first_contact(tree)


@figure("Contact force around its largest value", Of(rolling.TIME), FORCES, rows=around_peak)
def force_peak(tree: DataTree, lines: Lines) -> Drawn:
    """Contact force of all laws around the largest one of the main law."""
    yield from _forces(tree, lines)
    force = _main_force(tree)
    law = data.main_law(tree, rolling.CONTACT_FORCE)
    peak = int(np.nanargmax(force))
    where = f"{data.engineering(force[peak], 'N')} at {data.values(tree, rolling.TIME)[peak]:.4f} s"
    if data.present(tree, rolling.POSITION):
        where += f", {data.values(tree, rolling.POSITION)[peak]:.3f} m along the path"
    yield f"Around the largest force of the main law, {law}: {where}. Every time step. {_WORDS}"
    yield data.of_first_contact(tree)


FORCE = force_envelope, force_peak, force_psd, force_bands


# --- of each of several contacts

MOST_LINES = 6
"""Contacts that are drawn one by one."""
MEAN = "energy mean"


def _names(tree: DataTree) -> list[str]:
    offsets = data.values(tree, rolling.OFFSET)
    return [f"contact {number}, {rounded(offset, 4)} m" for number, offset in enumerate(offsets, 1)]


_LEVELS = Of(CONTACT_FORCE_LEVEL, "{contact}", called={"contact": _names})


def _mean(tree: DataTree) -> Iterator[Series]:
    """Energy mean of the levels of all contacts."""
    level = np.stack([np.nan_to_num(series.values, nan=-np.inf) for series in _LEVELS(tree)])
    mean = energy_mean(level, axis=0)
    yield Series(MEAN, CONTACT_FORCE_LEVEL.units, mean, None, f"{MEAN} of all", look=(chart.INK, (), 2.0))


@figure("Force of each contact", Of(BAND, "band centre"), panels.products(BAND_TIME_PRODUCT), _LEVELS, _mean)
def contact_levels(tree: DataTree, lines: Lines) -> Drawn:
    """One-third-octave levels of the force of each contact, all or some from the first to the last."""
    every = lines.of(CONTACT_FORCE_LEVEL)
    if len(every) < 2:
        return
    shown = [every[n] for n in chart.spread(len(every), MOST_LINES)]
    levels = panels.styled(tree, lines.at, shown, marker="o")
    levels += panels.styled(tree, lines.at, [series for series in lines.lines if series.name == MEAN])
    label = "contact force level / dB re 1 N"
    yield panels.band_panel(tree, lines, label, levels, span=100.0, height=4.2)
    main = data.main_law(tree, CONTACT_FORCE_LEVEL)
    yield f"Force of each contact by the main law, {main}, per one-third octave."
    yield chart.part_shown(len(shown), len(every), "contacts")
    yield panels.shaded_words(tree)


def contacts_table(tree: DataTree) -> ReportTable | None:
    """Where the contacts are, what they carry, and how long they are lost; nothing of a single one."""
    main = data.main_law(tree, rolling.CONTACT_LOSS_SHARE)
    lost = next(Of(rolling.CONTACT_LOSS_SHARE)(tree)).values
    if len(lost) < 2:
        return None
    columns = {
        "contact": text_cells(range(1, len(lost) + 1)),
        "ahead of the position of the run": number_cells(
            data.values(tree, rolling.OFFSET), lambda offset: data.engineering(offset, "m", 4)
        ),
        "static force": number_cells(data.values(tree, rolling.STATIC_LOAD), "N"),
        f"out of contact, {main}": number_cells(lost, data.in_percent),
    }
    for lateral in Of(schema.LATERAL_CONTACT_SPREAD, optional=True)(tree):
        columns[f"lateral force, rms, {main}"] = number_cells(lateral.values, "N")
    return table("where_contacts_are", "Contacts", columns, "Static forces as on a rigid plane.")
