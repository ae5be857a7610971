"""Figures of the contact force: in time, in lines and in one-third octaves, of one contact and of all."""

from collections.abc import Iterator
from dataclasses import replace
from typing import Any

import numpy as np
from xarray import DataTree

from asperity.reporting import chart, data, panels
from asperity.reporting.figure import Figure, Lines, Of, Series, extremes, starts
from asperity.reporting.tables import ReportTable, number_cells, table, text_cells
from asperity.scenes import schema
from asperity.scenes.figures import track
from asperity.schema import rolling, spectra
from asperity.schema.spectra import BAND, BAND_TIME_PRODUCT, CONTACT_FORCE_LEVEL
from asperity.spectra import energy_sum

FORCES = Of(rolling.CONTACT_FORCE, "{law}")
IN_FREQUENCY = "linear, frequency domain"
"""Name of the linear contact that is solved there."""
REFERENCE_STYLE: dict[str, Any] = {
    "colour": chart.INK,
    "dashes": (3.0, 3.0),
    "width": 1.0,
    "label": IN_FREQUENCY,
}
REFERENCE_PSD, REFERENCE_LEVEL = (
    Of(entry, IN_FREQUENCY, optional=True)
    for entry in (schema.LINEAR_REFERENCE_PSD, schema.LINEAR_REFERENCE_LEVEL)
)


# --- over frequency


def _differences(tree: DataTree) -> Iterator[Series]:
    """Differences to the linear laws and to the reference law."""
    compared = data.differences(tree) | {spectra.FORCE_LEVEL_DIFFERENCE_TO_REFERENCE: "reference"}
    for entry, law in compared.items():
        for series in Of(entry, "{law}")(tree):
            yield replace(series, name=f"{series.name} minus {law}")


def _bands(tree: DataTree, lines: Lines) -> Iterator[chart.Panel]:
    """Levels in one-third octaves, and below them the differences to the linear laws."""
    found = lines.of(spectra.FORCE_LEVEL)
    levels = panels.styled(tree, lines.at, found, markers=True)
    reference = [chart.Line(lines.at, s.values, **REFERENCE_STYLE) for s in lines.of(REFERENCE_LEVEL.entry)]
    label, every = "contact force level / dB re 1 N", [*levels, *reference]
    yield panels.band_panel(tree, lines, label, every, of=levels, span=100.0, height=3.6)
    under = (*panels.shaded_bands(tree, labelled=False), panels.zero())
    for entry, law in data.differences(tree).items():
        less = panels.styled(tree, lines.at, lines.of(entry), markers=True, main=found[0].law)
        axis = panels.levels_axis(f"level − {law} / dB", [line.y for line in less], span=np.inf, step=5.0)
        yield chart.Panel(panels.band_axis(lines.at), axis, (*under, *less), height=2.4)


def _bands_caption(tree: DataTree) -> str:
    text = ["Levels per one-third octave (IEC 61260-1, base 10)."]
    if data.present(tree, REFERENCE_LEVEL.entry):
        text.append("Dashed: the linear contact solved in the frequency domain.")
    if compared := " and that of ".join(data.differences(tree).values()):
        text.append(f"Below: level minus that of {compared}; positive where linear contact underestimates.")
    return " ".join(text) + panels.shaded_words(tree)


FORCE_BANDS = Figure(
    "force_bands",
    "Contact force levels in one-third octaves",
    Of(spectra.BAND, "band centre"),
    (
        panels.products(spectra.BAND_TIME_PRODUCT),
        Of(spectra.FORCE_LEVEL, "{law}"),
        _differences,
        REFERENCE_LEVEL,
    ),
    _bands,
    _bands_caption,
)


def _spectrum(tree: DataTree, lines: Lines) -> list[chart.Panel]:
    """Power spectral densities over frequency, with the track's marks behind."""
    at, levels = panels.narrow_levels(tree, lines, lines.lines)
    drawn = panels.styled(tree, at, [series for series in levels if series.law])
    drawn += [chart.Line(at, series.values, **REFERENCE_STYLE) for series in levels if not series.law]
    ends = panels.frequency_range(tree)
    behind = (*track.sleeper_tones(tree, *ends), *track.split_rules(tree, *ends))
    return [panels.spectrum_panel(tree, "contact force PSD / dB re 1 N²/Hz", drawn, behind)]


def _spectrum_caption(tree: DataTree) -> str:
    main = data.laws(tree, spectra.FORCE_PSD)[0]
    text = [f"Contact force of all laws, one-sided PSD, {panels.DRAWN}; thick: the main law, {main}."]
    if data.present(tree, REFERENCE_PSD.entry):
        text.append(
            "Dashed: the linear contact in the frequency domain, F = −h/(α_W + α_C + α_R), at rest, with "
            "constant loss factors."
        )
    if tone := data.number(tree, schema.SLEEPER_PASSING_FREQUENCY):
        text.append(
            f"Ticks along the bottom: sleeper passing, n v/L, n up to {track.TONES}, every {tone:.1f} Hz."
        )
    if split := track.pinned_pinned_split(tree):
        text.append(
            f"Dotted: the pinned–pinned frequency as the moving wheel meets it, {split[0]:.0f} and "
            f"{split[1]:.0f} Hz."
        )
    if turns := data.number(tree, schema.WHEEL_REVOLUTION_FREQUENCY):
        text.append(f"The wheel turns at {turns:.1f} Hz.")
    return " ".join(text) + panels.shaded_words(tree)


FORCE_SPECTRUM = Figure(
    "force_psd",
    "Contact force against frequency",
    Of(spectra.FREQUENCY),
    (Of(spectra.FORCE_PSD, "{law}"), REFERENCE_PSD),
    _spectrum,
    _spectrum_caption,
)


# --- in time

COLUMNS = 700  # stretches of an envelope
AROUND_PEAK = 0.024
"""Length of the piece around the largest force, s."""


def lost(tree: DataTree, law: str, force: chart.Numbers) -> chart.Flags:
    """Where contact is lost, as `force` of `law` shows; nowhere if the contact pulls as well."""
    share = rolling.CONTACT_LOSS_SHARE
    never = law in data.laws(tree, share) and data.of_law(tree, share, law) == 0
    return np.zeros(len(force), dtype=bool) if never or data.law_entry(tree, law).may_pull else force <= 0


def _main_force(tree: DataTree) -> chart.Numbers:
    return data.of_law(tree, rolling.CONTACT_FORCE, data.laws(tree, rolling.CONTACT_FORCE)[0])


def around_peak(tree: DataTree, length: float = AROUND_PEAK) -> slice:
    """Time steps within `length` s around the largest force of the main law."""
    time = data.values(tree, rolling.TIME)
    steps = min(len(time), max(2, round(length * (len(time) - 1) / (time[-1] - time[0]))))
    start = int(np.nanargmax(_main_force(tree))) - steps // 2
    start = min(max(start, 0), len(time) - steps)
    return slice(start, start + steps)


def _forces(tree: DataTree, lines: Lines, **look: Any) -> list[chart.Panel]:
    """Contact force of all laws over a piece of the run, and below it, where there is any, the loss of it."""
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
    above = chart.Panel(axis, force, (*shades, panels.zero(), *drawn), height=3.3)
    shown = tuple(bar for bar in bars if bar.left.size)
    if not shown:
        return [above]
    rows = panels.words_axis([s.law for s in lines.lines], "no contact", margin=0.6, down=True)
    return [above, chart.Panel(axis, rows, shown, height=0.6 + 0.16 * len(bars))]


def _bars(tree: DataTree, series: Series, time: chart.Numbers, row: int) -> chart.Boxes:
    """Stretches without contact in a row, half a time step longer at either end than from first to last."""
    first, last = panels.stretches(lost(tree, series.law, series.values)).T
    half, middle = 0.5 * (time[1] - time[0]), np.full(first.shape, float(row))
    ends = (time[first] - half, time[last] + half, middle - 0.35, middle + 0.35)
    return chart.Boxes(*ends, colour=data.law_entry(tree, series.law).colour, law=series.law)


def _whole_run(tree: DataTree, _: Lines) -> list[chart.Panel]:
    """Contact force of all laws over the whole run, every time step."""
    return _forces(tree, Lines(next(Of(rolling.TIME)(tree)), list(FORCES(tree))), width=0.9)


_WORDS = (
    "The axis suits the main law. Bars below, if any: no contact (F ≤ 0), shaded above for the main law; "
    "a law that pulls cannot lose it."
)


def _whole_caption(tree: DataTree) -> str:
    count = min(COLUMNS, len(data.values(tree, rolling.TIME)))
    return (
        "Every time step; compression positive. Where steps lie too close to draw, a line spans lowest and "
        f"highest force. {_WORDS} The CSV file holds lowest and highest force in each of {count} stretches, "
        "run.nc every time step."
    )


def _peak_caption(tree: DataTree) -> str:
    force, law = _main_force(tree), data.laws(tree, rolling.CONTACT_FORCE)[0]
    peak = int(np.nanargmax(force))
    where = f"{data.engineering(force[peak], 'N')} at {data.values(tree, rolling.TIME)[peak]:.4f} s"
    if data.present(tree, rolling.POSITION):
        where += f", {data.values(tree, rolling.POSITION)[peak]:.3f} m along the rail"
    return f"Around the largest force of the main law, {law}: {where}. Every time step. {_WORDS}"


FORCE_PEAK = Figure(
    "force_peak",
    "Contact force around its largest value",
    Of(rolling.TIME),
    (FORCES,),
    _forces,
    _peak_caption,
    rows=around_peak,
)
FORCE_ENVELOPE = Figure(
    "force_envelope",
    "Contact force, the whole run",
    starts(Of(rolling.TIME), COLUMNS),
    (extremes(FORCES, COLUMNS),),
    _whole_run,
    _whole_caption,
    further=(rolling.CONTACT_FORCE, rolling.TIME),
)
FORCE = (FORCE_ENVELOPE, FORCE_PEAK, FORCE_SPECTRUM, FORCE_BANDS)


# --- of each of several contacts

MOST_LINES = 6
"""Contacts that are drawn one by one."""
MEAN = "energy mean"


def _names(tree: DataTree) -> list[str]:
    offsets = data.values(tree, rolling.OFFSET)
    return [f"contact {number}, {offset:.4g} m" for number, offset in enumerate(offsets, 1)]


_LEVELS = Of(CONTACT_FORCE_LEVEL, "{contact}", called={"contact": _names})


def _mean(tree: DataTree) -> Iterator[Series]:
    """Energy mean of the levels of all contacts."""
    level = np.stack([np.nan_to_num(series.values, nan=-np.inf) for series in _LEVELS(tree)])
    mean = energy_sum(level, axis=0) - 10.0 * np.log10(len(level))
    yield Series(MEAN, CONTACT_FORCE_LEVEL.units, mean, None, f"{MEAN} of all", look=(chart.INK, (), 2.0))


def _levels(tree: DataTree, lines: Lines) -> list[chart.Panel]:
    """One-third-octave levels of the force of each contact, all or some from the first to the last."""
    every = lines.of(CONTACT_FORCE_LEVEL)
    shown = [every[n] for n in chart.spread(len(every), MOST_LINES)]
    levels = panels.styled(tree, lines.at, shown, marker="o")
    levels += panels.styled(tree, lines.at, [series for series in lines.lines if series.name == MEAN])
    label = "contact force level / dB re 1 N"
    return [panels.band_panel(tree, lines, label, levels, span=100.0, height=4.2)]


def _levels_caption(tree: DataTree) -> str:
    main, count = data.laws(tree, CONTACT_FORCE_LEVEL)[0], len(data.values(tree, rolling.CONTACT))
    some = "" if count <= MOST_LINES else f" {MOST_LINES} of {count} contacts are drawn; the file has all."
    what = f"Force of each contact by the main law, {main}, per one-third octave."
    return f"{what}{some}{panels.shaded_words(tree)}"


def tone_rules(tree: DataTree) -> list[chart.Mark]:
    """Multiples of the frequency at which contacts pass a place, while they stand apart."""
    if not data.present(tree, schema.PASSING_FREQUENCY):
        return []
    low, high = panels.frequency_range(tree)
    tones = data.values(tree, schema.PASSING_FREQUENCY)
    return [chart.Rules(tones[(tones > low) & (tones < high)][:10], dashes=(1, 2), width=0.6)]


def tones_words(tree: DataTree) -> str:
    """Say what dotted lines are; a blank comes first."""
    if not data.present(tree, schema.PASSING_FREQUENCY):
        return ""
    first = float(data.values(tree, schema.PASSING_FREQUENCY)[0])
    return f" Dotted: k v/L, multiples of the {first:.4g} Hz at which contacts pass a place; ten are drawn."


def contacts_table(tree: DataTree) -> ReportTable | None:
    """Where the contacts are, what they carry, and how long they are lost."""
    if not data.present(tree, rolling.OFFSET, rolling.STATIC_LOAD, rolling.CONTACT_LOSS_SHARE):
        return None
    main = data.laws(tree, rolling.CONTACT_LOSS_SHARE)[0]
    lost = next(Of(rolling.CONTACT_LOSS_SHARE)(tree)).values
    columns = {
        "contact": text_cells(range(1, len(lost) + 1)),
        "ahead of the position of the run": number_cells(
            data.values(tree, rolling.OFFSET), lambda offset: data.engineering(offset, "m", 4)
        ),
        "static force": number_cells(data.values(tree, rolling.STATIC_LOAD), "N"),
        f"out of contact, {main}": number_cells(100.0 * lost, "{:.3g} %"),
    }
    for lateral in Of(schema.LATERAL_CONTACT_SPREAD)(tree):
        columns[f"lateral force, rms, {main}"] = number_cells(lateral.values, "N")
    return table("where_contacts_are", "Contacts", columns, "Static forces as on a rigid plane.")


def _several(tree: DataTree) -> bool:
    return len(data.values(tree, rolling.CONTACT)) > 1


CONTACTS = (
    Figure(
        "contact_levels",
        "Force of each contact",
        Of(BAND, "band centre"),
        (panels.products(BAND_TIME_PRODUCT), _LEVELS, _mean),
        _levels,
        _levels_caption,
        (rolling.CONTACT, rolling.OFFSET),
        worth=_several,
    ),
)
