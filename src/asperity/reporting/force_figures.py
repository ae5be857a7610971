"""Figures of the contact force: in time, in lines and in one-third octaves."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray
from xarray import DataTree

from asperity.reporting.axes import (
    band_axis,
    doubtful_boxes,
    frequency_axis,
    levels_axis,
    shade,
    stretches,
    words_axis,
)
from asperity.reporting.chart import (
    INK,
    Axis,
    Boxes,
    Chart,
    Line,
    Mark,
    Note,
    Numbers,
    Panel,
    Rules,
    decibels,
    envelope,
    smooth_on_log_axis,
)
from asperity.reporting.chart import TIME as OVER_TIME
from asperity.reporting.data import doubtful, engineering, force_unit, laws, of_law, present, values
from asperity.reporting.law_entries import differences, law_entry, law_style, pulling
from asperity.reporting.part import Data, Part, Series, by_law, series
from asperity.schema import Entry
from asperity.schema.rolling import CONTACT_FORCE, CONTACT_LOSS_SHARE, TIME
from asperity.schema.spectra import (
    BAND,
    BAND_TIME_PRODUCT,
    FORCE_LEVEL,
    FORCE_LEVEL_DIFFERENCE_TO_REFERENCE,
    FORCE_PSD,
    FREQUENCY,
    START_SHARE,
)
from asperity.spectra import LEAST_PRODUCT, MOST_START

IN_FREQUENCY = "linear, frequency domain"
"""Name of the linear contact that is solved there."""
REFERENCE_STYLE: dict[str, Any] = {
    "colour": INK,
    "dashes": (3.0, 3.0),
    "width": 1.0,
    "label": IN_FREQUENCY,
}

Spectrum = tuple[NDArray[np.float64], NDArray[np.float64]]


def frequency_range(tree: DataTree) -> tuple[float, float]:
    """Frequencies that are drawn, in Hz: those of the one-third octaves, else all from 20 Hz on."""
    if present(tree, BAND):
        bands = values(tree, BAND)
        return bands[0] / 10**0.05, bands[-1] * 10**0.05
    high = values(tree, FREQUENCY)[-1]
    return min(20.0, high / 100), high


def narrow_level(tree: DataTree, psd: NDArray[np.float64], reference: float) -> Spectrum:
    """Level of a PSD in dB within the drawn range, no denser than a line can show."""
    frequency = values(tree, FREQUENCY)
    low, high = frequency_range(tree)
    kept = (frequency >= low) & (frequency <= high) & (frequency > 0)
    if not kept.any():
        return np.array([low, high]), np.full(2, np.nan)
    smooth, power = smooth_on_log_axis(frequency[kept], psd[kept], 24)
    return smooth, decibels(power, reference)


def shaded_bands(tree: DataTree, labelled: bool = True) -> list[Boxes | Note]:
    """Shades of the frequencies of the bands that say little."""
    if not present(tree, BAND):
        return []
    return doubtful_boxes(values(tree, BAND), doubtful(tree, BAND_TIME_PRODUCT), labelled)


def shaded_words(tree: DataTree) -> str:
    """Say what is shaded in a spectrum, where something is; a blank comes first."""
    return doubtful_words(tree, BAND_TIME_PRODUCT) if present(tree, BAND) else ""


def force_spectrum_data(tree: DataTree) -> Data:
    """Power spectral density of the contact force of each law, all lines."""
    return Data(series(tree, FREQUENCY), by_law(tree, FORCE_PSD))


def force_spectrum_chart(tree: DataTree, data: Data) -> Chart:
    """Power spectral densities of the contact force of all laws on one axis."""
    return Chart((laws_panel(tree, data.lines, "contact force PSD / dB re 1 N²/Hz"),))


def laws_panel(tree: DataTree, lines: Mapping[Any, Series], label: str, reference: float = 1.0) -> Panel:
    """Level of each law's PSD over frequency, the main law first."""
    main = next(iter(lines))
    spectra = {law: narrow_level(tree, psd.values, reference) for law, psd in lines.items()}
    drawn = [Line(*spectra[law], label=law, **law_style(tree, law, main)) for law in main_last(spectra)]
    return spectrum_panel(tree, drawn, label)


def spectrum_panel(tree: DataTree, levels: Sequence[Line], label: str, behind: Sequence[Mark] = ()) -> Panel:
    """Levels over frequency, and other marks behind them."""
    axis = levels_axis(label, [line.y for line in levels])
    marks = (*shaded_bands(tree), *behind, *levels)
    return Panel(frequency_axis(*frequency_range(tree)), axis, marks, height=4.4)


def main_last(laws: Iterable[str]) -> list[str]:
    """Laws in the order in which they are drawn: the main law, the first, on top."""
    main, *others = laws
    return [*others, main]


def product_series(tree: DataTree, product: Entry) -> dict[Any, Series]:
    """Bandwidth times averaging time of bands, and whether their levels say something."""
    if not present(tree, product):
        return {}
    enough = (~doubtful(tree, product)).astype(float)
    return {
        product: series(tree, product, "B T"),
        "enough": Series("level says something", "1", enough),
    }


def band_data(tree: DataTree, *reference: Entry) -> Data:
    """Levels per one-third octave and law, and the differences; and the level of a `reference`."""
    lines = product_series(tree, BAND_TIME_PRODUCT)
    compared = {entry: f"{{}} minus {law}" for entry, law in differences(tree).items()}
    compared[FORCE_LEVEL_DIFFERENCE_TO_REFERENCE] = "{} minus reference"
    for entry, name in {FORCE_LEVEL: "{}", **compared}.items():
        lines |= {(entry, law): line for law, line in by_law(tree, entry, name).items()}
    lines |= {entry: series(tree, entry, IN_FREQUENCY) for entry in reference if present(tree, entry)}
    return Data(series(tree, BAND, "band centre"), lines)


def band_chart(tree: DataTree, data: Data, *reference: Entry) -> Chart:
    """One-third-octave levels of the contact force, and below them the differences to the linear laws."""
    levels = data.of(FORCE_LEVEL)
    held = [data.lines[entry].values for entry in reference if entry in data.lines]
    marks = [*_band_lines(tree, data, levels), *(Line(data.at, each, **REFERENCE_STYLE) for each in held)]
    axis = levels_axis("contact force level / dB re 1 N", list(levels.values()), span=100.0)
    panels = [Panel(band_axis(data.at), axis, (*shaded_bands(tree), *marks), height=3.6)]
    for entry, name in differences(tree).items():
        found = data.of(entry)
        axis = levels_axis(f"level − {name} / dB", list(found.values()), span=np.inf, step=5.0)
        under: list[Mark] = [*shaded_bands(tree, labelled=False), Rules(np.zeros(1), "y", dashes=())]
        lines = _band_lines(tree, data, found)
        panels.append(Panel(band_axis(data.at), axis, (*under, *lines), height=2.4))
    return Chart(tuple(panels))


def _band_lines(tree: DataTree, data: Data, levels: Mapping[str, NDArray[np.float64]]) -> list[Line]:
    main = next(iter(data.of(FORCE_LEVEL)))
    ordered = sorted(levels, key=lambda law: law == main)
    return [
        Line(
            data.at, levels[law], label=law, marker=law_entry(tree, law).marker, **law_style(tree, law, main)
        )
        for law in ordered
    ]


DRAWN = "drawn as mean power per 1/24 octave where the lines are denser than that"


def _force_caption(tree: DataTree) -> str:
    main = laws(tree, FORCE_PSD)[0]
    return (
        f"Contact force of all laws, one-sided PSD, {DRAWN}; thick: the main law, {main}. "
        "Ticks stand at the one-third octaves." + shaded_words(tree)
    )


def band_caption(tree: DataTree, *reference: Entry) -> str:
    """Say what the levels are compared with."""
    text = ["Levels per one-third octave (IEC 61260-1, base 10)."]
    if any(present(tree, entry) for entry in reference):
        text.append("Dashed: the linear contact solved in the frequency domain.")
    if compared := list(differences(tree).values()):
        named = " and that of ".join(compared)
        text.append(f"Below: level minus that of {named}; positive where linear contact underestimates.")
    return " ".join(text) + doubtful_words(tree, BAND_TIME_PRODUCT)


def doubtful_words(tree: DataTree, product: Entry) -> str:
    """Say what shaded bands are, where there are any; a blank comes first."""
    if not doubtful(tree, product).any():
        return ""
    scatter = 4.34 / np.sqrt(LEAST_PRODUCT)
    start = ""
    if product is BAND_TIME_PRODUCT and present(tree, START_SHARE):
        low = -10.0 * np.log10(1.0 - MOST_START)
        start = f", or resonances have not built up yet, and it is low by more than {low:.0f} dB"
    return (
        f" Shaded: levels that say little. Bandwidth times averaging time B T is below {LEAST_PRODUCT:g}, "
        f"and the standard deviation of a level above {scatter:.1f} dB{start}."
    )


def force_bands(*reference: Entry) -> Part:
    """Figure of the force in one-third octaves, with the levels of a `reference` where there is one."""
    return Part(
        "force_bands",
        "Contact force levels in one-third octaves",
        (FORCE_LEVEL, BAND),
        lambda tree: band_data(tree, *reference),
        lambda tree, data: band_chart(tree, data, *reference),
        lambda tree: band_caption(tree, *reference),
    )


FORCE_SPECTRUM = Part(
    "force_psd",
    "Contact force against frequency",
    (FORCE_PSD, FREQUENCY),
    force_spectrum_data,
    force_spectrum_chart,
    _force_caption,
)
FORCE_BANDS = force_bands()


COLUMNS = 700  # stretches of an envelope
PIECE = 2000  # time steps of the short piece, at most
HEADROOM = 0.5  # share of the main law's range by which other laws may widen its axis
AROUND = 400  # time steps that are shown around the largest force


def lost(tree: DataTree, law: str, force: NDArray[np.float64]) -> NDArray[np.bool_]:
    """Where contact is lost, as `force` of `law` shows; nowhere if the contact pulls as well."""
    if law_entry(tree, law).may_pull or (
        law in laws(tree, CONTACT_LOSS_SHARE) and of_law(tree, CONTACT_LOSS_SHARE, law) == 0
    ):
        return np.zeros(len(force), dtype=bool)
    return force <= 0


def piece(tree: DataTree) -> slice:
    """Short piece of the run: around the main law's longest loss of contact, else in the middle."""
    flight = _main_flight(tree)
    count = len(flight)
    middle = count // 2
    if flight.any():
        first, last = max(stretches(flight).tolist(), key=lambda stretch: stretch[1] - stretch[0])
        middle = (first + last + 1) // 2
    length = min(PIECE, max(count // 5, min(count, 200)))
    start = min(max(middle - length // 2, 0), count - length)
    return slice(start, start + length)


def _main_flight(tree: DataTree) -> NDArray[np.bool_]:
    """Time steps at which the main law has lost contact."""
    main = laws(tree, CONTACT_FORCE)[0]
    return lost(tree, main, of_law(tree, CONTACT_FORCE, main, "time"))


def force_unit_of(tree: DataTree) -> tuple[float, str]:
    """Unit in which the forces of a result read well: its size in N and its symbol."""
    return force_unit(float(np.nanmax(np.abs(values(tree, CONTACT_FORCE)))))


def main_limits(series: Mapping[str, NDArray[np.float64]], pulling: Collection[str]) -> tuple[float, float]:
    """Limits of an axis that suit the main law, the first of `series`.

    Its range, wider by at most `HEADROOM` of it on either side where zero, or another law that can lose
    contact, needs it. A law that pulls, and swings as if nothing could be lost, widens nothing.
    """
    main, *others = series
    low, high = float(np.nanmin(series[main])), float(np.nanmax(series[main]))
    bottom, top, room = low, high, HEADROOM * (high - low)
    for law in others:
        if law not in pulling:
            bottom = min(bottom, max(low - room, float(np.nanmin(series[law]))))
            top = max(top, min(high + room, float(np.nanmax(series[law]))))
    if low - room <= 0.0 <= high + room:
        bottom, top = min(bottom, 0.0), max(top, 0.0)
    margin = 0.04 * (top - bottom) or 1e-12
    return bottom - margin, top + margin


def beyond_limits(series: Mapping[str, NDArray[np.float64]], limits: tuple[float, float], unit: str) -> str:
    """Sentence that names the laws which leave the axis, with their extremes; empty if none does."""
    ends = {law: (float(np.nanmin(values)), float(np.nanmax(values))) for law, values in series.items()}
    left = [
        f"{law} ({engineering(low, unit)} to {engineering(high, unit)})"
        for law, (low, high) in ends.items()
        if low < limits[0] or high > limits[1]
    ]
    return f" The axis suits the main law; beyond it: {', '.join(left)}." if left else ""


def time_unit(duration: float) -> tuple[float, str]:
    """Unit in which a time of `duration` s reads well: its size in s and its symbol."""
    return (1.0, "s") if duration >= 0.5 else (1e-3, "ms")


def time_axis(tree: DataTree, time: Numbers) -> tuple[Axis, float]:
    """Axis from end to end of a piece of the run, and the size of its unit, that of the whole run."""
    unit, symbol = time_unit(float(np.ptp(values(tree, TIME))))
    axis = Axis(f"time / {symbol}", float(time[0]) / unit, float(time[-1]) / unit, linked=OVER_TIME)
    return axis, unit


def envelope_data(tree: DataTree) -> Data:
    """Lowest and highest contact force of each law in each stretch of the run."""
    time = values(tree, TIME)
    lines: dict[Any, Series] = {}
    for law, force in by_law(tree, CONTACT_FORCE).items():
        _, low, high = envelope(force.values, COLUMNS)
        lines[law, "lowest"] = Series(f"{law} lowest", CONTACT_FORCE.units, low)
        lines[law, "highest"] = Series(f"{law} highest", CONTACT_FORCE.units, high)
    return Data(Series("time", TIME.units, time[envelope(time, COLUMNS)[0]]), lines)


def whole_chart(tree: DataTree, _: Data) -> Chart:
    """Contact force of all laws over the whole run, every time step."""
    whole, unit = forces_data(tree, slice(None)), time_axis(tree, values(tree, TIME))[1]
    peak = int(np.nanargmax(next(iter(whole.lines.values())).values))
    losses = stretches(_main_flight(tree)).tolist()
    found = {
        "largest force": [_around(peak, AROUND)],
        "next loss of contact": [
            _around(sum(ends) // 2, 6 * (ends[1] - ends[0] + 1) + 40) for ends in losses
        ],
    }
    last = len(whole.at) - 1
    places = {name: whole.at[np.clip(steps, 0, last)] / unit for name, steps in found.items() if steps}
    return replace(forces_chart(tree, whole, width=0.9), places=places)


def _around(step: int, length: int) -> tuple[int, int]:
    return step - length // 2, step + length // 2


def cut_off(tree: DataTree, data: Data) -> str:
    """Say which laws leave the force axis of a piece."""
    forces = {law: force.values for law, force in data.lines.items()}
    return beyond_limits(forces, main_limits(forces, pulling(tree)), "N")


def piece_data(tree: DataTree) -> Data:
    """Contact force of each law over a short piece of the run."""
    return forces_data(tree, piece(tree))


def forces_data(tree: DataTree, part: slice) -> Data:
    """Contact force of each law over the time steps `part`, every one."""
    lines: dict[Any, Series] = {
        law: replace(force, values=force.values[part]) for law, force in by_law(tree, CONTACT_FORCE).items()
    }
    time = series(tree, TIME)
    return Data(replace(time, values=time.values[part]), lines)


def forces_chart(tree: DataTree, data: Data, **look: Any) -> Chart:
    """Contact force of all laws over a piece of the run, and below it, where there is any, the loss of it."""
    axis, unit = time_axis(tree, data.at)
    names = [str(law) for law in data.lines]
    flights = (lost(tree, law, data.lines[law].values) for law in names)
    found = (
        _bars(tree, law, data.at / unit, flight, row)
        for row, (law, flight) in enumerate(zip(names, flights, strict=True))
    )
    bars = [each for each in found if each.left.size]
    forces = Panel(axis, *_forces(tree, data, unit, look), height=3.3)
    if not bars:
        return Chart((forces,))
    shades = [shade(each.left, each.right, law=each.law) for each in bars if each.law == names[0]]
    rows = replace(words_axis(names, "no contact"), low=len(names) - 0.4, high=-0.6)
    below = Panel(axis, rows, tuple(bars), height=0.6 + 0.16 * len(names))
    return Chart((replace(forces, marks=(*shades, *forces.marks)), below))


def _forces(tree: DataTree, data: Data, unit: float, look: dict[str, Any]) -> tuple[Axis, tuple[Mark, ...]]:
    """Forces of all laws, and an axis that suits the main one."""
    forces = {law: force.values for law, force in data.lines.items()}
    main, (low, high) = next(iter(forces)), main_limits(forces, pulling(tree))
    size, symbol = force_unit_of(tree)
    marks: list[Mark] = [Rules(np.zeros(1), "y", dashes=())]
    for law in main_last(forces):
        beyond = np.nanmin(forces[law]) < low or np.nanmax(forces[law]) > high
        faint = {"opacity": 0.5, "width": 0.8} if beyond else {}
        style = law_style(tree, law, main) | look | faint
        marks.append(Line(data.at / unit, forces[law] / size, law, **style))
    return Axis(f"contact force / {symbol}", low / size, high / size), tuple(marks)


def _bars(tree: DataTree, law: str, time: Numbers, flight: NDArray[np.bool_], row: int) -> Boxes:
    """Stretches without contact in a row, half a time step longer at either end than from first to last."""
    first, last = stretches(flight).T
    half, middle = 0.5 * (time[1] - time[0]), np.full(first.shape, float(row))
    ends = (time[first] - half, time[last] + half, middle - 0.35, middle + 0.35)
    return Boxes(*ends, colour=law_entry(tree, law).colour, law=law)


def _piece_caption(tree: DataTree) -> str:
    where = "around the main law's longest loss of contact"
    if not _main_flight(tree).any():
        where = "in the middle of the run"
    data = piece_data(tree)
    return f"A short piece {where}, every time step.{bars_words(tree, data)}{cut_off(tree, data)}"


def bars_words(tree: DataTree, data: Data) -> str:
    """Sentence about the bars below the forces of a piece, where there are any."""
    flown = [law for law, force in data.lines.items() if lost(tree, law, force.values).any()]
    if not flown:
        return ""
    shaded = ", shaded above where the main law has none" if next(iter(data.lines)) in flown else ""
    held = " and ".join(law for law in data.lines if law_entry(tree, law).may_pull)
    return f" Bars below: no contact (F ≤ 0){shaded}" + (f"; {held} cannot lose it." if held else ".")


def _whole_caption(tree: DataTree) -> str:
    whole = forces_data(tree, slice(None))
    return (
        "Every time step; compression positive. Where steps lie too close to draw, a line spans lowest and "
        f"highest force.{bars_words(tree, whole)}{cut_off(tree, whole)} The CSV file holds lowest and "
        f"highest force in each of {min(COLUMNS, len(whole.at))} stretches, run.nc every time step."
    )


FORCE_PIECE = Part(
    "force_piece",
    "Contact force, a short piece",
    (CONTACT_FORCE, TIME),
    piece_data,
    forces_chart,
    _piece_caption,
)
FORCE_ENVELOPE = Part(
    "force_envelope",
    "Contact force, the whole run",
    (CONTACT_FORCE, TIME),
    envelope_data,
    whole_chart,
    _whole_caption,
)
