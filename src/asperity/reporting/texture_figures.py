"""Figures of surfaces: maps, heights, paths, spectra."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from itertools import cycle
from types import MappingProxyType
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray
from xarray import DataTree

from asperity.reporting.axes import band_axis, wavenumber_axis
from asperity.reporting.chart import (
    BLUE,
    INK,
    MUTED,
    VERMILLION,
    Area,
    Axis,
    Chart,
    Dashes,
    Field,
    Line,
    Mark,
    Note,
    Numbers,
    Panel,
    Rules,
    envelope,
    smooth_on_log_axis,
)
from asperity.reporting.data import engineering, number, present, stated, values
from asperity.reporting.part import Data, Part, Series, field, present_series, series
from asperity.schema import surface
from asperity.schema.contact import HERTZ_RADIUS
from asperity.spectra import nominal
from asperity.surfaces.statistics import material_ratio_curve

if TYPE_CHECKING:
    from asperity.surfaces.en15610 import ThirdOctaves

SLENDER = 2.5  # times longer than wide: such a map gets the whole width
STRETCHES = 1200  # of the envelope of a long line
SECOND_DASHES: Dashes = (5.0, 1.5)


def length_unit(extent: float) -> tuple[float, str]:
    """Unit in which a length of `extent` m reads well: its size in m and its symbol."""
    for size, symbol in ((1.0, "m"), (1e-3, "mm"), (1e-6, "µm")):
        if extent >= 0.5 * size:
            return size, symbol
    return 1e-9, "nm"


def map_panel(
    x: NDArray[np.float64],
    y: NDArray[np.float64],
    numbers: NDArray[np.float64],
    scale: tuple[str, float, float],
    *marks: Mark,
    equal: bool = True,
    colours: str = "cividis",
    **place: Any,
) -> Panel:
    """Numbers (nx, ny) from above, x to the right and y up, in the unit of x.

    `scale` is the label of their colours, and the lowest and highest number that these tell apart.
    """
    size, symbol = length_unit(np.ptp(x))
    edges_x, edges_y = (_edges(each, size) for each in (x, y))
    shown = Field(edges_x, edges_y, numbers, *scale, colours)
    along = Axis(f"x / {symbol} (rolling direction →)", *edges_x)
    return Panel(along, Axis(f"y / {symbol}", *edges_y), (shown, *marks), equal=equal, **place)


def _edges(points: NDArray[np.float64], size: float) -> tuple[float, float]:
    """Outer edges of cells around points, in a unit."""
    half = (points[1] - points[0]) / 2 if len(points) > 1 else 0.5
    return float(points[0] - half) / size, float(points[-1] + half) / size


def height_scale(heights: NDArray[np.float64]) -> tuple[float, str, float, float]:
    """Unit of heights and its symbol; limits in it about the mean that leave out 0.1 % at either end."""
    finite = heights[np.isfinite(heights)]
    middle = finite.mean()
    reach = np.abs(np.percentile(finite, [0.1, 99.9]) - middle).max() or 1e-9
    size, symbol = length_unit(reach)
    return size, symbol, float(middle - reach) / size, float(middle + reach) / size


def height_map(
    x: NDArray[np.float64], y: NDArray[np.float64], heights: NDArray[np.float64], **place: Any
) -> Panel:
    """Heights (nx, ny) in m from above."""
    size, symbol, low, high = height_scale(heights)
    return map_panel(x, y, heights / size, (f"height / {symbol}", low, high), **place)


Distribution = tuple[NDArray[np.float64], NDArray[np.float64]]
"""Edges of bins of height, m, and the probability density in them, 1/m."""


def distribution(heights: NDArray[np.float64]) -> Distribution:
    """Distribution of heights in m; missing points are left out."""
    finite = heights[np.isfinite(heights)]
    bins = int(np.clip(2 * len(finite) ** (1 / 3), 10, 80))  # Rice's rule
    low, high = finite.min(), finite.max()
    if low == high:
        low, high = low - 0.5e-9, high + 0.5e-9
    density, edges = np.histogram(finite, bins=bins, range=(low, high), density=True)
    return edges, density


def height_histogram(named: dict[str, Distribution], unit: tuple[float, str], **place: Any) -> Panel:
    """How often each height occurs, of one or two surfaces, with the normal distribution of the first."""
    size, symbol = unit
    looks: tuple[dict[str, Any], ...] = (
        {"colour": BLUE},
        {"colour": VERMILLION, "dashes": SECOND_DASHES},
    )
    steps = [
        Line(
            np.repeat(edges / size, 2)[1:-1], _positive(np.repeat(density * size, 2)), name, width=1.4, **look
        )
        for (name, (edges, density)), look in zip(named.items(), looks, strict=False)
    ]
    z, normal = _normal(*next(iter(named.values())))
    top = float(normal.max() * size)
    return Panel(
        Axis(f"height / {symbol} (out of the material →)"),
        Axis(f"probability density / (1/{symbol})", 1e-4 * top, 4.0 * top, log=True),
        (*steps, Line(z / size, normal * size, "normal", MUTED, (3.7, 1.6), 0.9)),
        **place,
    )


def _positive(numbers: NDArray[np.float64]) -> NDArray[np.float64]:
    """Numbers that a logarithmic axis has a place for."""
    return np.where(numbers > 0, numbers, np.nan)


def _normal(edges: NDArray[np.float64], density: NDArray[np.float64]) -> Distribution:
    """Normal distribution with the mean and the spread of another, at heights in its range."""
    middle, share = (edges[1:] + edges[:-1]) / 2, density * np.diff(edges)
    mean = float(np.sum(middle * share))
    spread = float(np.sqrt(np.sum((middle - mean) ** 2 * share))) or float(np.ptp(edges))
    z = np.linspace(edges[0], edges[-1], 200)
    return z, np.exp(-((z - mean) ** 2) / (2 * spread**2)) / (spread * np.sqrt(2 * np.pi))


def sample_data(tree: DataTree) -> Data:
    """Heights of the first sample: one row per x, one column per y."""
    return field(tree, surface.SAMPLE_HEIGHTS, surface.X, surface.Y, "z")


def sample_chart(tree: DataTree, data: Data) -> Chart:
    """Map of the first sample, and how its heights are distributed."""
    x, y, heights = data.at, values(tree, surface.Y), data.field
    slender = bool(np.ptp(x) > SLENDER * np.ptp(y))  # then the heights stand below the map
    named = {"sample": distribution(heights)}
    if present(tree, surface.PATH_HEIGHT_DENSITY):
        middle = values(tree, surface.PATH_HEIGHT)
        half = (middle[1] - middle[0]) / 2
        edges = np.append(middle - half, middle[-1] + half)
        named["path, whole"] = (edges, values(tree, surface.PATH_HEIGHT_DENSITY))
    title, height = "first sample" + _between(tree), 1.9 if slender else 4.2
    return Chart(
        (
            height_map(x, y, heights, title=title, height=height, share=1.25),
            height_histogram(
                named,
                height_scale(heights)[:2],
                title="heights",
                height=2.7 if slender else height,
                beside=not slender,
            ),
        )
    )


def _between(tree: DataTree) -> str:
    """What to add to the title of a map that lines were laid out as."""
    return ", as laid out between lines" if stated(tree, surface.ACROSS) == "lines" else ""


def path_data(tree: DataTree) -> Data:
    """Lowest and highest point of the middle line of the path, in stretches of it."""
    starts, low, high = envelope(values(tree, surface.LINE), STRETCHES)
    units = surface.LINE.units
    lines = {"lowest": Series("lowest z", units, low), "highest": Series("highest z", units, high)}
    return Data(Series("x", surface.DISTANCE.units, values(tree, surface.DISTANCE)[starts]), lines)


def path_chart(tree: DataTree, _: Data) -> Chart:
    """Strip of the path, and its middle line, every point; a path given as a line has the line alone."""
    panels = []
    if present(tree, surface.PATH_HEIGHTS):
        x, y = values(tree, surface.PATH_X), values(tree, surface.PATH_Y)
        heights = values(tree, surface.PATH_HEIGHTS, "path_x", "path_y")
        title = f"a piece of the path, seen from above (y stretched){_between(tree)}"
        panels.append(height_map(x, y, heights, title=title, equal=False, height=1.9))
    distance, line = values(tree, surface.DISTANCE), values(tree, surface.LINE)
    along, along_symbol = length_unit(np.ptp(distance))
    size, symbol = length_unit(float(np.nanmax(np.abs(line))) or 1e-9)
    panels.append(
        Panel(
            Axis(f"distance / {along_symbol}", float(distance[0]) / along, float(distance[-1]) / along),
            Axis(f"height / {symbol}"),
            (Line(distance / along, line / size, "height", BLUE, width=0.8),),
            title="middle line of the whole path",
            height=2.1,
        )
    )
    return Chart(tuple(panels))


_SPECTRA: dict[Any, tuple[str, Dashes, str]] = {
    surface.PSD_SAMPLE: ("samples, mean", (), BLUE),
    surface.PSD_PATH: ("path", SECOND_DASHES, VERMILLION),
}


def texture_psd_data(tree: DataTree) -> Data:
    """Spectra against wavenumber, all lines."""
    names = {entry: f"PSD of {name}" for entry, (name, _, _) in _SPECTRA.items()}
    return Data(series(tree, surface.SURFACE_WAVENUMBER, "wavenumber"), present_series(tree, names))


def texture_psd_chart(tree: DataTree, data: Data) -> Chart:
    """Power spectral densities of samples and path in the rolling direction."""
    drawn = []
    for entry, (label, dashes, colour) in _SPECTRA.items():
        psd = data.lines[entry].values if entry in data.lines else np.zeros(data.at.shape)
        kept = (data.at > 0) & (psd > 0)
        if kept.any():
            drawn.append(Line(*smooth_on_log_axis(data.at[kept], psd[kept]), label, colour, dashes, 1.5))
    return Chart((psd_panel(drawn, *_contact_length(tree), height=3.9),))


def psd_panel(spectra: list[Line], *marks: Mark, **place: Any) -> Panel:
    """Power spectral densities of heights in m³ over wavenumbers."""
    levels = np.concatenate([line.y for line in spectra])
    low, high = max(levels.min() / 2, levels.max() * 1e-8), levels.max() * 4
    return Panel(
        wavenumber_axis(min(line.x[0] for line in spectra), max(line.x[-1] for line in spectra)),
        Axis("one-sided PSD / m³", float(low), float(high), log=True),
        (*marks, *spectra),
        **place,
    )


def _contact_length(tree: DataTree) -> list[Mark]:
    """Where waves are as long as the contact."""
    radius = number(tree, HERTZ_RADIUS)
    if radius is None or radius <= 0:
        return []
    at = 1 / (2 * radius)
    label = f" length of the contact, 2a = {engineering(2 * radius, 'm')}"
    return [Rules(np.array([at]), colour=INK), Note(label, at, 0.95, y_share=True)]


def _sample_caption(tree: DataTree) -> str:
    missing = number(tree, surface.MISSING_SHARE)
    gaps = f"; {100 * missing:.3g} % of its points had no height" if missing else ""
    return (
        f"Source: {stated(tree, surface.SOURCE) or 'not stated'}{gaps}. Heights are positive out of the "
        "material; the colours leave out 0.1 % of the points at either end."
    )


def _path_caption(tree: DataTree) -> str:
    above = ", and the piece seen from above" if present(tree, surface.PATH_HEIGHTS) else ""
    stretches = min(STRETCHES, len(values(tree, surface.LINE)))
    return (
        "Heights of the path, positive out of the material, at every point of its middle line. The CSV file "
        f"holds the lowest and the highest in each of {stretches} stretches; run.nc has every point{above}."
    )


TEXTURE = (
    Part(
        "texture_sample",
        "Texture of the samples",
        (surface.SAMPLE_HEIGHTS,),
        sample_data,
        sample_chart,
        _sample_caption,
        worth=lambda tree: bool(np.nanmax(np.abs(values(tree, surface.SAMPLE_HEIGHTS))) > 0),
    ),
    Part(
        "texture_path",
        "Texture of the path",
        (surface.LINE, surface.DISTANCE),
        path_data,
        path_chart,
        _path_caption,
    ),
    Part(
        "texture_psd",
        "Texture against wavenumber",
        (surface.SURFACE_WAVENUMBER,),
        texture_psd_data,
        texture_psd_chart,
        lambda _: (
            "Power spectral density of the lines in rolling direction, mean over the lines, one-sided "
            "per cycle/m; drawn as mean power per 1/24 octave where the lines are denser than that."
        ),
        any_of=tuple(_SPECTRA),
        worth=lambda tree: any((values(tree, entry) > 0).any() for entry in _SPECTRA if present(tree, entry)),
    ),
)


NamedSpectra = Mapping[str, tuple[Numbers, Numbers]]
"""Wavenumbers above zero, cycles/m, and one-sided PSD, m³, by name."""
NO_SPECTRA: NamedSpectra = MappingProxyType({})
_LOOKS = (BLUE, ()), (VERMILLION, SECOND_DASHES)


def surface_chart(
    heights: Numbers,
    spacing: tuple[float, float],
    spectra: NamedSpectra = NO_SPECTRA,
    octaves: ThirdOctaves | None = None,
) -> Chart:
    """Lay out what a surface file holds: its map, the distribution of its heights, and its spectra.

    Heights (nx, ny), or (n,) for a line, and distances along x and y, m, positive out of the material; NaN
    where missing.
    """
    heights = np.asarray(heights, dtype=np.float64)
    length = np.asarray(heights.shape, dtype=np.float64) * spacing[: heights.ndim]
    across = heights.ndim == 1 or bool(length[0] > SLENDER * length[1])  # it takes the whole width
    x, *y = (step * np.arange(n, dtype=np.float64) for n, step in zip(heights.shape, spacing, strict=False))
    if heights.ndim == 1:
        above = _line_panel(x, heights)
    else:
        equal = bool(max(length) <= 12 * min(length))
        above = height_map(x, y[0], heights, equal=equal, height=1.9 if across else 4.2, share=1.25)
    unit = height_scale(heights)[:2]
    beside = height_histogram(
        {"heights": distribution(heights)}, unit, height=2.7 if across else 4.2, beside=not across
    )
    ratio = _ratio_panel(heights, unit, beside=across, height=2.7 if across else 3.2)
    return Chart((above, beside, ratio, *_spectra_panels(spectra, octaves, beside=not across)))


def _line_panel(x: Numbers, heights: Numbers) -> Panel:
    size, symbol = height_scale(heights)[:2]
    along, along_symbol = length_unit(np.ptp(x))
    starts, low, high = envelope(heights / size, STRETCHES)
    line = Area(x[starts] / along, low, high, colour=BLUE, opacity=1.0)
    return Panel(Axis(f"x / {along_symbol}"), Axis(f"height / {symbol}"), (line,), height=1.9)


def _ratio_panel(heights: Numbers, unit: tuple[float, str], **place: Any) -> Panel:
    """Share of the points that reach a height."""
    ratio, height = material_ratio_curve(heights)
    curve = Line(100.0 * ratio, height / unit[0], colour=VERMILLION)
    return Panel(Axis("material ratio / %", 0.0, 100.0), Axis(f"height / {unit[1]}"), (curve,), **place)


def _spectra_panels(spectra: NamedSpectra, octaves: ThirdOctaves | None, *, beside: bool) -> list[Panel]:
    """Spectra, or one-third octaves in their place; none of what has no waves."""
    place: dict[str, Any] = {"height": 3.2, "beside": beside, "share": 2.0}
    held = {name: pair for name, pair in spectra.items() if (pair[1] > 0).sum() > 1}
    if held and octaves is not None:
        return [_octaves_panel(octaves, **place)]
    lines = []
    for (name, (wavenumber, density)), (colour, dashes) in zip(held.items(), cycle(_LOOKS), strict=False):
        drawn = density > 0
        lines.append(Line(*smooth_on_log_axis(wavenumber[drawn], density[drawn]), name, colour, dashes))
    return [psd_panel(lines, **place)] if lines else []


def _octaves_panel(octaves: ThirdOctaves, **place: Any) -> Panel:
    shown = octaves.limited | (octaves.wavelength > 1e-3)
    centres = 1.0 / octaves.wavelength[shown]
    measured, processed, limit = (
        each[shown] for each in (octaves.measured, octaves.processed, octaves.limit)
    )
    over = processed > limit
    marks: list[Mark] = [
        Line(centres, measured, "as measured", MUTED, (3.7, 1.6), marker="."),
        Line(centres, processed, "without spikes, rolled over (EN 15610)", BLUE, marker="o"),
        Line(centres, limit, "limit of EN ISO 3095:2013, rails", INK, width=1.8),
    ]
    if over.any():
        marks.append(Line(centres[over], processed[over], "above the limit", VERMILLION, width=0, marker="s"))
    return Panel(
        band_axis(centres, "wavelength / mm", lambda wavenumber: f"{nominal(1e3 / wavenumber):g}"),
        Axis("roughness / dB re 1 µm"),
        tuple(marks),
        title=f"one-third octaves: {over.sum()} of {np.isfinite(limit).sum()} above the limit",
        **place,
    )


def lines_chart(
    lines: Sequence[Numbers],
    spacing: float,
    spectra: NamedSpectra = NO_SPECTRA,
    octaves: ThirdOctaves | None = None,
) -> Chart:
    """Lay out lines measured side by side, one above the other, with their distribution and their spectra.

    Levelled heights (n,) and the distance of points along the lines, m, positive out of the material.
    """
    together = np.concatenate(lines)
    unit = height_scale(together)[:2]
    height = 2.4 + 0.42 * len(lines)
    histogram = height_histogram(
        {"heights": distribution(together)}, unit, height=height, beside=True, title="heights of all lines"
    )
    ratio = _ratio_panel(together, unit, height=3.2)
    above = _lines_panel(lines, spacing, unit, height=height, share=2.0)
    return Chart((above, histogram, ratio, *_spectra_panels(spectra, octaves, beside=True)))


def _lines_panel(lines: Sequence[Numbers], spacing: float, unit: tuple[float, str], **place: Any) -> Panel:
    """Lines below each other, and a bar that says how high they are drawn."""
    size, symbol = unit
    reach = float(np.ptp(np.nanpercentile(np.concatenate(lines), [0.1, 99.9]))) / size or 1.0
    along, along_symbol = length_unit(longest := max(map(len, lines)) * spacing)
    end = longest / along
    marks: list[Mark] = []
    for row, (line, (colour, _)) in enumerate(zip(lines, cycle(_LOOKS), strict=False)):
        starts, low, high = envelope(line / size, STRETCHES)
        at, down = np.asarray(starts * spacing / along), row * reach
        marks.append(Area(at, low - down, high - down, colour=colour, opacity=1.0))
    tall = _round_length(0.45 * reach)
    bar = Line(np.full(2, 0.985 * end), 0.6 * reach + np.array([0.0, tall]), width=3.0)
    note = Note(f"{tall:g} {symbol}", 0.975 * end, 0.6 * reach + tall / 2, align="right", colour=INK)
    return Panel(
        Axis(f"distance along the lines / {along_symbol}", 0.0, end),
        Axis(
            "line",
            -(len(lines) - 0.4) * reach,
            1.1 * reach,
            ticks=tuple((-row * reach, f"{row + 1}") for row in range(len(lines))),
        ),
        (*marks, bar, note),
        title=f"levelled lines, each drawn {reach:.3g} {symbol} below the one before",
        **place,
    )


def _round_length(most: float) -> float:
    """Largest 1, 2 or 5 times a power of ten that is no more than a length."""
    decade = 10.0 ** np.floor(np.log10(most))
    return float(decade * max(step for step in (1, 2, 5) if step * decade <= most))
