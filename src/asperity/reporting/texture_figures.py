"""Figures of surfaces: maps, heights, paths, spectra; of results, and of what a surface file holds."""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from itertools import cycle
from typing import Any

import numpy as np
from xarray import DataTree

from asperity.arguments import Array
from asperity.ranks import Ranked
from asperity.reporting import chart, data, panels
from asperity.reporting.chart import BLUE, INK, MUTED, VERMILLION, Axis, Chart, Drawn, Line, Mark, Panel
from asperity.reporting.data import length_unit
from asperity.reporting.figure import Lines, Of, field, figure
from asperity.schema import contact
from asperity.spectra import nominal
from asperity.surfaces.measured_lines import ThirdOctaves
from asperity.surfaces.statistics import material_ratio_curve
from asperity.written_numbers import rounded

SLENDER = 2.5
"""Times longer than wide: such a map gets the whole width."""
STRETCHES = 1200
"""Of the envelope of a long line."""
LOOKS: tuple[tuple[str, chart.Dashes], ...] = ((BLUE, ()), (VERMILLION, (5.0, 1.5)))
"""Of one surface and of another."""
NORMAL: tuple[str, chart.Dashes] = (MUTED, (3.7, 1.6))
ENDS = np.array([0.001, 0.999])
"""Shares of the points between which a scale of heights reaches."""


def map_panel(
    x: Array,
    y: Array,
    numbers: Array,
    scale: tuple[str, float, float],
    *marks: Mark,
    equal: bool = True,
    colours: str = "cividis",
    **place: Any,
) -> Panel:
    """Numbers (nx, ny) from above, x to the right and y up, in the unit of x where both are to one scale.

    `scale` is the label of their colours, and the lowest and highest number that these tell apart.
    """
    size, symbol = length_unit(np.ptp(x))
    size_across, symbol_across = (size, symbol) if equal else length_unit(np.ptp(y))
    left, right = _edges(x, size)
    low, high = _edges(y, size_across)
    shown = chart.Field((left, right), (low, high), numbers, *scale, colours)
    along = Axis(f"x / {symbol} (rolling direction →)", left, right)
    return Panel(along, Axis(f"y / {symbol_across}", low, high), (shown, *marks), equal=equal, **place)


def _edges(points: Array, size: float) -> tuple[float, float]:
    """Outer edges of the cells around evenly spaced points, m, in a unit of this size."""
    half = (points[1] - points[0]) / 2 if len(points) > 1 else 0.5
    return float(points[0] - half) / size, float(points[-1] + half) / size


def height_scale(known: Ranked) -> tuple[float, str, float, float]:
    """Unit of heights and its symbol; limits in it about the mean that leave out 0.1 % at either end."""
    middle = sum(float(piece.sum()) for piece in known.pieces()) / known.count
    reach = float(np.abs(known.quantiles(ENDS) - middle).max()) or 1e-9
    size, symbol = length_unit(reach)
    return size, symbol, float(middle - reach) / size, float(middle + reach) / size


def height_map(x: Array, y: Array, heights: Array, **place: Any) -> Panel:
    """Heights (nx, ny) in m from above."""
    size, symbol, low, high = height_scale(Ranked([heights]))
    return map_panel(x, y, heights / size, (f"height / {symbol}", low, high), **place)


def distribution(known: Ranked) -> tuple[Array, Array]:
    """Distribution of heights, m: edges of bins, and density in them, 1/m."""
    bins = int(np.clip(2 * known.count ** (1 / 3), 10, 80))  # Rice's rule
    low = known.lowest
    high = known.highest
    if low == high:
        low = low - 0.5e-9
        high = high + 0.5e-9
    often = sum(np.histogram(piece, bins, (low, high))[0] for piece in known.pieces())
    edges = np.histogram_bin_edges(np.zeros(0), bins, (low, high))
    return edges, often / (known.count * np.diff(edges))


def height_histogram(
    named: Mapping[str, tuple[Array, Array]], unit: tuple[float, str], **place: Any
) -> Panel:
    """How often each height occurs, of one or two surfaces, with the normal distribution of the first."""
    size, symbol = unit
    edges, density = next(iter(named.values()))
    middle = (edges[1:] + edges[:-1]) / 2
    share = density * np.diff(edges)
    mean = float(np.sum(middle * share))
    spread = float(np.sqrt(np.sum((middle - mean) ** 2 * share))) or float(np.ptp(edges))
    z = np.linspace(edges[0], edges[-1], 200)
    normal = np.exp(-((z - mean) ** 2) / (2 * spread**2)) / (spread * np.sqrt(2 * np.pi))
    top = float(normal.max() * size)
    normal[normal < 1e-8 * normal.max()] = np.nan  # far out it is zero, which no axis in decades holds
    bottom = 1e-4 * top
    steps = []
    for (name, (edges, density)), look in zip(named.items(), LOOKS, strict=False):
        often = np.repeat(density * size, 2)
        at = np.repeat(edges / size, 2)[1:-1]
        # a bin without heights reaches the foot of the panel: an axis in decades has no zero
        steps.append(Line(at, np.where(often > 0, often, bottom), name, *look, width=1.4))
    highest = max(float(each.y.max()) for each in steps)  # of rounded heights few bins hold all
    return Panel(
        Axis(f"height / {symbol} (out of the material →)"),
        Axis(f"probability density / (1/{symbol})", bottom, max(4.0 * top, 1.2 * highest), log=True),
        (*steps, Line(z / size, normal * size, "normal", *NORMAL, width=0.9)),
        **place,
    )


def psd_panel(spectra: Sequence[Line], *marks: Mark, **place: Any) -> Panel:
    """Power spectral densities of heights in m³ over wavenumbers."""
    levels = np.concatenate([line.y for line in spectra])
    low = max(levels.min() / 2, levels.max() * 1e-8)
    high = levels.max() * 4
    along = panels.wavenumber_axis(min(line.x[0] for line in spectra), max(line.x[-1] for line in spectra))
    density = Axis("one-sided PSD / m³", float(low), float(high), log=True)
    return Panel(along, density, (*marks, *spectra), **place)


def psd_line(wavenumber: Array, density: Array, label: str, *look: Any) -> Line:
    """Power spectral density where there is any, smoothed for the eye."""
    kept = (wavenumber > 0) & (density > 0)
    return Line(*chart.smooth_on_log_axis(wavenumber[kept], density[kept]), label, *look)


# --- of results


def _between(tree: DataTree) -> str:
    """What to add to the title of a map that lines were laid out as."""
    return ", as laid out between lines" if data.stated(tree, contact.ACROSS) == "lines" else ""


@figure("Texture of the samples", Of(contact.MAP_X, "x"), field(contact.SAMPLE_HEIGHTS, contact.MAP_Y, "z"))
def texture_sample(tree: DataTree, lines: Lines) -> Drawn:
    """Map of the first sample, and how its heights are distributed."""
    x = lines.at
    y = data.values(tree, contact.MAP_Y)
    heights = data.values(tree, contact.SAMPLE_HEIGHTS)
    if not np.nanmax(np.abs(heights)) > 0:
        return
    slender = bool(np.ptp(x) > SLENDER * np.ptp(y))  # then the heights stand below the map
    known = Ranked([heights])
    named = {"sample": distribution(known)}
    height, below = (1.9, 2.7) if slender else (4.2, 4.2)
    yield height_map(x, y, heights, title="first sample" + _between(tree), height=height, share=1.25)
    yield height_histogram(named, height_scale(known)[:2], title="heights", height=below, beside=not slender)
    missing = data.number(tree, contact.MISSING_SHARE)
    gaps = f"; {rounded(100 * missing)} % of its points had no height" if missing else ""
    yield (
        f"Source: {data.stated(tree, contact.SOURCE) or 'not stated'}{gaps}. Heights are positive out of the "
        "material; the colours leave out 0.1 % of the points at either end."
    )


@figure("Texture of the path", Of(contact.DISTANCE, "x"), Of(contact.LINE, "z"), stretches=STRETCHES)
def texture_path(tree: DataTree, lines: Lines) -> Drawn:
    """Strip of the path, and its middle line, every point; a path given as a line has the line alone."""
    above = ""
    if data.present(tree, contact.PATH_HEIGHTS):
        strip = (data.values(tree, entry) for entry in (contact.PATH_X, contact.PATH_Y, contact.PATH_HEIGHTS))
        title = f"a piece of the path, seen from above (y stretched){_between(tree)}"
        yield height_map(*strip, title=title, equal=False, height=1.9)
        above = ", and the piece seen from above"
    distance = lines.at
    line = lines.lines[0].values
    along, along_symbol = length_unit(np.ptp(distance))
    size, symbol = length_unit(float(np.nanmax(np.abs(line))) or 1e-9)
    x = Axis(f"distance / {along_symbol}", float(distance[0]) / along, float(distance[-1]) / along)
    drawn = Line(distance / along, line / size, "height", BLUE, width=0.8)
    yield Panel(x, Axis(f"height / {symbol}"), (drawn,), "middle line of the whole path", height=2.1)
    yield (
        "Heights of the path, positive out of the material, at every point of its middle line. The CSV file "
        f"holds the lowest and the highest in each of {min(STRETCHES, len(line))} stretches; run.nc has "
        f"every point{above}."
    )


@figure(
    "Texture against wavenumber",
    Of(contact.SURFACE_WAVENUMBER, "wavenumber"),
    Of(contact.PSD_SAMPLE, "PSD of samples, mean", "samples, mean", LOOKS[0], optional=True),
    Of(contact.PSD_PATH, "PSD of path", "path", LOOKS[1], optional=True),
)
def texture_psd(tree: DataTree, lines: Lines) -> Drawn:
    """Spectra of samples and path in the rolling direction, and the length of the contact."""
    drawn = [
        psd_line(lines.at, s.values, s.label, *s.look, 1.5)
        for s in lines.lines
        if ((lines.at > 0) & (s.values > 0)).any()
    ]
    if not drawn:
        return
    marks: list[Mark] = []
    if (radius := data.number(tree, contact.HERTZ_RADIUS) or 0.0) > 0.0:
        at = 1 / (2 * radius)
        length = data.engineering(2 * radius, "m")
        note = chart.Note(f" length of the contact, 2a = {length}", at, 0.95, y_share=True)
        marks = [chart.Rules(np.array([at]), colour=INK), note]
    yield psd_panel(drawn, *marks, height=3.9)
    yield (
        "Power spectral density of the lines in rolling direction, mean over the lines, one-sided "
        "per cycle/m; drawn as mean power per 1/24 octave where the lines are denser than that."
    )


TEXTURE = texture_sample, texture_path, texture_psd

STRETCH = 10.0
"""Length of the line that is drawn before and after running-in, in widths of the nominal patch."""


@figure(
    "Surface before and after running-in",
    Of(contact.DISTANCE),
    Of(contact.LINE_UNTOUCHED, "before running-in"),
    Of(contact.LINE, "after running-in"),
)
def running_in(tree: DataTree, lines: Lines) -> Drawn:
    """The line before and after running-in, around its deepest mark."""
    before, after = (series.values for series in lines.lines)
    lowering = before - after
    if not (lowering > 0).any():
        return
    radius = data.number(tree, contact.HERTZ_RADIUS)
    count = len(lines.at)
    if radius:
        count = round(2 * STRETCH * radius / (lines.at[1] - lines.at[0]))
    first = int(np.clip(np.argmax(lowering) - count // 2, 0, max(len(lines.at) - count, 0)))
    x, before, after = (numbers[first : first + max(count, 2)] for numbers in (lines.at, before, after))
    along, unit = length_unit(float(np.ptp(x)))
    height, symbol = length_unit(float(np.ptp(before)))
    drawn = (
        Line(x / along, before / height, "before running-in", MUTED, LOOKS[1][1], 0.9),
        Line(x / along, after / height, "after", BLUE),
    )
    distance = Axis(f"distance along the path / {unit}", x[0] / along, x[-1] / along)
    yield Panel(distance, Axis(f"height / {symbol} (out of the material ↑)"), drawn, height=2.9)
    deepest, mean = (data.engineering(float(each), "m") for each in (lowering.max(), lowering.mean()))
    yield (
        "Heights along the middle of the path, around the place that was lowered most, before and after "
        f"running-in under the working load. Lowered by {deepest} at most, by {mean} in the mean."
    )


# --- of surface files

NamedSpectra = Mapping[str, tuple[Array, Array]]
"""Wavenumbers above zero, cycles/m, and one-sided PSD, m³, by name."""
SPECTRA: dict[str, Any] = {"height": 3.2, "share": 2.0}
"""Place of spectra, or of one-third octaves."""


def surface_chart(heights: Array, spacing: tuple[float, float], spectra: NamedSpectra) -> Chart:
    """Lay out what a map holds: its heights from above, their distribution, and their spectra.

    Heights (nx, ny), and distances along x and y, m, positive out of the material; NaN where missing.
    """
    heights = np.asarray(heights, dtype=np.float64)
    length = np.asarray(heights.shape, dtype=np.float64) * spacing
    slender = bool(length[0] > SLENDER * length[1])
    equal = bool(max(length) <= 12 * min(length))
    seen, shares = chart.as_seen(heights)
    steps = length * shares / seen.shape
    x, y = (step * np.arange(n, dtype=np.float64) for n, step in zip(seen.shape, steps, strict=True))
    above = height_map(x, y, seen, equal=equal, height=1.9 if slender else 4.2, share=1.25)
    return _with_statistics(above, Ranked([heights]), spectra, beside=not slender)


def lines_chart(lines: Sequence[Array], spacing: float, spectra: NamedSpectra) -> Chart:
    """Lay out lines measured side by side, one above the other, with their distribution and their spectra.

    Levelled heights (n,) and the distance of points along the lines, m, positive out of the material.
    """
    known = Ranked(lines)
    above = _lines_panel(lines, spacing, known)
    return _with_statistics(above, known, spectra, beside=True)


def with_octaves(chart: Chart, octaves: ThirdOctaves) -> Chart:
    """The chart of lines with one-third octaves in place of their spectra, where it has any."""
    *others, spectra = chart.panels
    return replace(chart, panels=(*others, _octaves_panel(octaves, **SPECTRA, beside=spectra.beside)))


def _with_statistics(above: Panel, known: Ranked, spectra: NamedSpectra, *, beside: bool) -> Chart:
    """What heights look like, and how often each occurs, beside it or below, and their spectra."""
    unit = height_scale(known)[:2]
    named = {"heights": distribution(known)}
    histogram = height_histogram(named, unit, height=above.height if beside else 2.7, beside=beside)
    ratio = _ratio_panel(known, unit, beside=not beside, height=3.2 if beside else 2.7)
    return Chart((above, histogram, ratio, *_spectra_panels(spectra, beside=beside)))


def _ratio_panel(known: Ranked, unit: tuple[float, str], **place: Any) -> Panel:
    """Share of the points that reach a height."""
    ratio, height = material_ratio_curve(known)
    curve = Line(100.0 * ratio, height / unit[0], colour=VERMILLION)
    return Panel(Axis("material ratio / %", 0.0, 100.0), Axis(f"height / {unit[1]}"), (curve,), **place)


def _spectra_panels(spectra: NamedSpectra, *, beside: bool) -> list[Panel]:
    """Spectra; none of what has no waves."""
    held = {name: pair for name, pair in spectra.items() if (pair[1] > 0).sum() > 1}
    lines = [
        psd_line(*pair, name, *look) for (name, pair), look in zip(held.items(), cycle(LOOKS), strict=False)
    ]
    return [psd_panel(lines, **SPECTRA, beside=beside)] if lines else []


def _octaves_panel(octaves: ThirdOctaves, **place: Any) -> Panel:
    shown = octaves.limited | (octaves.wavelength > 1e-3)
    centres = 1.0 / octaves.wavelength[shown]
    measured, processed, limit = (
        each[shown] for each in (octaves.measured, octaves.processed, octaves.limit)
    )
    over = processed > limit
    marks = [
        Line(centres, measured, "as measured", *NORMAL, marker="."),
        Line(centres, processed, "without spikes, rolled over (EN 15610)", BLUE, marker="o"),
        Line(centres, limit, "limit of EN ISO 3095:2013, rails", INK, width=1.8),
    ]
    if over.any():
        marks.append(Line(centres[over], processed[over], "above the limit", VERMILLION, width=0, marker="s"))
    title = f"one-third octaves: {over.sum()} of {np.isfinite(limit).sum()} above the limit"
    along = panels.band_axis(centres, "wavelength / mm", lambda wavenumber: f"{nominal(1e3 / wavenumber):g}")
    return Panel(along, Axis("roughness / dB re 1 µm"), tuple(marks), title=title, **place)


def _lines_panel(lines: Sequence[Array], spacing: float, known: Ranked) -> Panel:
    """Lines below each other, and a bar that says how high they are drawn."""
    size, symbol = height_scale(known)[:2]
    reach = float(np.ptp(known.quantiles(ENDS))) / size or 1.0
    along, along_symbol = length_unit(longest := max(map(len, lines)) * spacing)
    end = longest / along
    marks: list[Mark] = []
    for row, (line, (colour, _)) in enumerate(zip(lines, cycle(LOOKS), strict=False)):
        starts, low, high = chart.envelope(line, STRETCHES)
        at = np.asarray(starts * spacing / along)
        down = row * reach
        marks.append(chart.Area(at, low / size - down, high / size - down, colour=colour, opacity=1.0))
    tall = 0.45 * reach  # cut down to a round length
    decade = 10.0 ** np.floor(np.log10(tall))
    tall = float(decade * max(step for step in (1, 2, 5) if step * decade <= tall))
    bar = Line(np.full(2, 0.985 * end), 0.6 * reach + np.array([0.0, tall]), width=3.0)
    note = chart.Note(f"{tall:g} {symbol}", 0.975 * end, 0.6 * reach + tall / 2, align="right", colour=INK)
    ticks = tuple((-row * reach, f"{row + 1}") for row in range(len(lines)))
    return Panel(
        Axis(f"distance along the lines / {along_symbol}", 0.0, end),
        Axis("line", -(len(lines) - 0.4) * reach, 1.1 * reach, ticks=ticks),
        (*marks, bar, note),
        title=f"lines {rounded(reach)} {symbol} apart, levelled" if len(lines) > 1 else "line, levelled",
        height=2.4 + 0.42 * len(lines),
        share=2.0,
    )
