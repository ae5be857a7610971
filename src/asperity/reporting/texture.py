"""Figures of the texture: map of a sample, strip of the path, spectra against wavenumber."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from itertools import cycle
from types import MappingProxyType
from typing import TYPE_CHECKING, Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.cm import ScalarMappable
from matplotlib.figure import Figure
from matplotlib.ticker import FuncFormatter, MaxNLocator
from numpy.typing import NDArray
from xarray import DataTree

from asperity.reporting.data import engineering, number, present, stated, values
from asperity.reporting.part import Data, Part, Series, field, present_series, series
from asperity.reporting.style import (
    BLUE,
    INK,
    MUTED,
    VERMILLION,
    band_axis,
    envelope,
    new_figure,
    note_at,
    power_axis,
    side_by_side,
    smooth_on_log_axis,
    styled,
    wavenumber_axis,
)
from asperity.schema import surface
from asperity.schema.contact import HERTZ_RADIUS
from asperity.spectra import nominal
from asperity.surfaces.material_ratio import material_ratio_curve

if TYPE_CHECKING:
    from asperity.surfaces.third_octaves import ThirdOctaves

SLENDER = 2.5  # times longer than wide: such a map gets the whole width
STRETCHES = 1200  # of the envelope of a long line
PIXELS = 320  # along each side of a drawn map; denser maps show every n-th point


def length_unit(extent: float) -> tuple[float, str]:
    """Unit in which a length of `extent` m reads well: its size in m and its symbol."""
    for size, symbol in ((1.0, "m"), (1e-3, "mm"), (1e-6, "µm")):
        if extent >= 0.5 * size:
            return size, symbol
    return 1e-9, "nm"


def draw_map(
    axes: Axes,
    x: NDArray[np.float64],
    y: NDArray[np.float64],
    field: NDArray[np.float64],
    unit: tuple[float, str],
    equal: bool = True,
    **options: Any,
) -> ScalarMappable:
    """Draw a field (nx, ny) with x to the right and y up, both in `unit`, thinned to what can be seen."""
    skip_x, skip_y = (
        max(1, -(-n // limit)) for n, limit in zip(field.shape, (3 * PIXELS, PIXELS), strict=True)
    )
    if equal:
        skip_x = max(skip_x, -(-field.shape[0] // PIXELS))
    half = [(c[1] - c[0]) / 2 if len(c) > 1 else 0.5 for c in (x, y)]
    extent = [x[0] - half[0], x[-1] + half[0], y[0] - half[1], y[-1] + half[1]]
    image = axes.imshow(
        field[::skip_x, ::skip_y].T,
        origin="lower",
        extent=tuple(edge / unit[0] for edge in extent),
        aspect="equal" if equal else "auto",
        **options,
    )
    axes.grid(visible=False)
    axes.set_xlabel(f"x / {unit[1]} (rolling direction →)")
    axes.set_ylabel(f"y / {unit[1]}")
    return image


def height_scale(heights: NDArray[np.float64]) -> tuple[float, str, dict[str, Any]]:
    """Unit of heights, its symbol, and colours symmetric to the mean that leave out 0.1 % at either end."""
    finite = heights[np.isfinite(heights)]
    middle = finite.mean()
    reach = np.abs(np.percentile(finite, [0.1, 99.9]) - middle).max() or 1e-9
    size, symbol = length_unit(reach)
    return size, symbol, {"vmin": (middle - reach) / size, "vmax": (middle + reach) / size, "cmap": "cividis"}


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


def height_histogram(axes: Axes, named: dict[str, Distribution], unit: tuple[float, str]) -> None:
    """Draw how often each height occurs, per series in `named`, with the normal distribution of the first."""
    colours = [BLUE, VERMILLION]
    for (name, (edges, density)), colour in zip(named.items(), colours, strict=False):
        axes.stairs(density * unit[0], edges / unit[0], color=colour, label=name, linewidth=1.4)
    edges, density = next(iter(named.values()))
    middle, share = (edges[1:] + edges[:-1]) / 2, density * np.diff(edges)
    mean = float(np.sum(middle * share))
    spread = float(np.sqrt(np.sum((middle - mean) ** 2 * share))) or unit[0]
    z = np.linspace(edges[0], edges[-1], 200)
    normal = np.exp(-((z - mean) ** 2) / (2 * spread**2)) / (spread * np.sqrt(2 * np.pi)) * unit[0]
    axes.plot(z / unit[0], normal, color=MUTED, linewidth=0.9, linestyle="--", label="normal")
    axes.xaxis.set_major_locator(MaxNLocator(6))
    axes.set_yscale("log")
    axes.set_ylim(normal.max() * 1e-4, normal.max() * 4)
    power_axis(axes.yaxis)
    axes.set_xlabel(f"height / {unit[1]} (out of the material →)")
    axes.set_ylabel(f"probability density / (1/{unit[1]})")
    axes.legend(loc="best")


def _map_and_histogram(slender: bool) -> tuple[Figure, Axes, Axes]:
    """Figure with room for a map and a histogram: beneath each other for a map that is long and narrow."""
    if slender:
        figure = new_figure(4.6)
        upper, lower = figure.subplots(2, 1, height_ratios=[1, 1.4])
        return figure, upper, lower
    figure, (left, right) = side_by_side(4.2, (1.25, 1))
    return figure, left, right


def sample_data(tree: DataTree) -> Data:
    """Heights of the first sample: one row per x, one column per y."""
    return field(tree, surface.SAMPLE_HEIGHTS, surface.X, surface.Y, "z")


@styled()
def sample_figure(tree: DataTree, data: Data) -> Figure:
    """Map of the first sample, and how its heights are distributed."""
    x, y, heights = data.at, values(tree, surface.Y), data.field
    size, symbol, colours = height_scale(heights)
    figure, left, right = _map_and_histogram(bool(np.ptp(x) > SLENDER * np.ptp(y)))
    image = draw_map(left, x, y, heights / size, length_unit(np.ptp(x)), **colours)
    left.set_title("first sample" + _between(tree))
    figure.colorbar(image, ax=left, label=f"height / {symbol}", extend="both", shrink=0.9, pad=0.02)
    named = {"sample": distribution(heights)}
    if present(tree, surface.PATH_HEIGHT_DENSITY):
        middle = values(tree, surface.PATH_HEIGHT)
        half = (middle[1] - middle[0]) / 2
        edges = np.append(middle - half, middle[-1] + half)
        named["path, whole"] = (edges, values(tree, surface.PATH_HEIGHT_DENSITY))
    height_histogram(right, named, (size, symbol))
    right.set_title("heights")
    return figure


def _between(tree: DataTree) -> str:
    """What to add to the title of a map that lines were laid out as."""
    return ", as laid out between lines" if stated(tree, surface.ACROSS) == "lines" else ""


def path_data(tree: DataTree) -> Data:
    """Lowest and highest point of the middle line of the path, in stretches of it."""
    starts, low, high = envelope(values(tree, surface.LINE), STRETCHES)
    units = surface.LINE.units
    lines = {"lowest": Series("lowest z", units, low), "highest": Series("highest z", units, high)}
    return Data(Series("x", surface.DISTANCE.units, values(tree, surface.DISTANCE)[starts]), lines)


@styled()
def path_figure(tree: DataTree, data: Data) -> Figure:
    """Strip of the path, and its middle line; a path given as a line has the line alone."""
    strip = present(tree, surface.PATH_HEIGHTS)
    figure = new_figure(3.9 if strip else 2.2)
    panels = figure.subplots(1 + strip, 1, squeeze=False)[:, 0]
    if strip:
        _draw_strip(panels[0], tree)
    _draw_line(panels[-1], data, float(values(tree, surface.DISTANCE)[-1]))
    return figure


def _draw_strip(axes: Axes, tree: DataTree) -> None:
    heights = values(tree, surface.PATH_HEIGHTS, "path_x", "path_y")
    x, y = values(tree, surface.PATH_X), values(tree, surface.PATH_Y)
    size, symbol, colours = height_scale(heights)
    image = draw_map(axes, x, y, heights / size, length_unit(np.ptp(x)), equal=False, **colours)
    axes.set_title(f"a piece of the path, seen from above (y stretched){_between(tree)}")
    axes.figure.colorbar(image, ax=axes, label=f"height / {symbol}", extend="both", pad=0.01)


def _draw_line(axes: Axes, data: Data, end: float) -> None:
    distance, low, high = data.at, data.lines["lowest"].values, data.lines["highest"].values
    along, along_symbol = length_unit(end - distance[0])
    size, symbol = length_unit(max(np.nanmax(-low), np.nanmax(high)) or 1e-9)
    axes.fill_between(distance / along, low / size, high / size, color=BLUE, linewidth=0.4)
    axes.set_xlim(distance[0] / along, end / along)
    axes.set_xlabel(f"distance / {along_symbol}")
    axes.set_ylabel(f"height / {symbol}")
    axes.set_title("middle line of the whole path (envelope)")


_SPECTRA = {
    surface.PSD_SAMPLE: ("samples, mean", "-", BLUE),
    surface.PSD_PATH: ("path", (0, (5, 1.5)), VERMILLION),
}


def texture_psd_data(tree: DataTree) -> Data:
    """Spectra against wavenumber, all lines."""
    names = {entry: f"PSD of {name}" for entry, (name, _, _) in _SPECTRA.items()}
    return Data(series(tree, surface.SURFACE_WAVENUMBER, "wavenumber"), present_series(tree, names))


@styled()
def texture_psd_figure(tree: DataTree, data: Data) -> Figure:
    """Power spectral densities of samples and path in the rolling direction."""
    figure = new_figure(3.9)
    axes = figure.subplots()
    drawn = []
    for entry, (label, dashes, colour) in _SPECTRA.items():
        psd = data.lines[entry].values if entry in data.lines else np.zeros(data.at.shape)
        kept = (data.at > 0) & (psd > 0)
        if kept.any():
            k, level = smooth_on_log_axis(data.at[kept], psd[kept])
            axes.loglog(k, level, color=colour, linestyle=dashes, label=label, linewidth=1.5)
            drawn.append((k, level))
    if drawn:
        levels = np.concatenate([level for _, level in drawn])
        axes.set_ylim(max(levels.min() / 2, levels.max() * 1e-8), levels.max() * 4)
        wavenumber_axis(axes, min(k[0] for k, _ in drawn), max(k[-1] for k, _ in drawn))
    _mark_contact(axes, tree)
    power_axis(axes.yaxis)
    axes.set_ylabel("one-sided PSD / m³")
    axes.legend(loc="lower left")
    return figure


def _mark_contact(axes: Axes, tree: DataTree) -> None:
    radius = number(tree, HERTZ_RADIUS)
    if radius is None or radius <= 0:
        return
    axes.axvline(1 / (2 * radius), color=INK, linewidth=0.9, linestyle=":")
    label = f"length of the contact, 2a = {engineering(2 * radius, 'm')}"
    note_at(axes, 1 / (2 * radius), 0.97, label, va="top")


def _sample_caption(tree: DataTree) -> str:
    missing = number(tree, surface.MISSING_SHARE) or 0.0
    source = stated(tree, surface.SOURCE) or "not stated"
    return (
        f"Source: {source}; {100 * missing:.3g} % of its points had no height. Heights are positive out of "
        "the material; the colours leave out 0.1 % of the points at either end."
    )


def _path_caption(tree: DataTree) -> str:
    above = ", and the piece seen from above" if present(tree, surface.PATH_HEIGHTS) else ""
    return (
        "Heights of the path, positive out of the material. The CSV file holds the envelope of its "
        f"middle line; run.nc has every point of it{above}."
    )


TEXTURE = (
    Part(
        "texture_sample",
        "Texture of the samples",
        (surface.SAMPLE_HEIGHTS,),
        sample_data,
        sample_figure,
        _sample_caption,
        worth=lambda tree: bool(np.nanmax(np.abs(values(tree, surface.SAMPLE_HEIGHTS))) > 0),
    ),
    Part(
        "texture_path",
        "Texture of the path",
        (surface.LINE, surface.DISTANCE),
        path_data,
        path_figure,
        _path_caption,
    ),
    Part(
        "texture_psd",
        "Texture against wavenumber",
        (surface.SURFACE_WAVENUMBER,),
        texture_psd_data,
        texture_psd_figure,
        lambda _: (
            "Power spectral density of the lines in rolling direction, mean over the lines, one-sided "
            "per cycle/m; drawn as mean power per 1/24 octave where the lines are denser than that."
        ),
        any_of=tuple(_SPECTRA),
        worth=lambda tree: any((values(tree, entry) > 0).any() for entry in _SPECTRA if present(tree, entry)),
    ),
)


NamedSpectra = Mapping[str, tuple[NDArray[np.float64], NDArray[np.float64]]]
"""Wavenumbers above zero, cycles/m, and one-sided PSD, m³, by name."""


@styled()
def surface_picture(
    heights: NDArray[np.float64],
    spacing: tuple[float, float],
    title: str,
    spectra: NamedSpectra = MappingProxyType({}),
    octaves: ThirdOctaves | None = None,
) -> Figure:
    """Draw what a surface file holds: its map, the distribution of its heights, and its spectra.

    Heights (nx, ny), or (n,) for a line, and distances along x and y, m, positive out of the material; NaN
    where missing.
    """
    heights = np.asarray(heights, dtype=np.float64)
    size, symbol, colours = height_scale(heights)
    length = np.asarray(heights.shape, dtype=np.float64) * spacing[: heights.ndim]
    if heights.ndim == 1 or length[0] > SLENDER * length[1]:
        figure, left, right = _picture_panels(4.6, (1, 1.4), spectra, octaves, stacked=True)
    else:
        figure, left, right = _picture_panels(4.2, (1.25, 1), spectra, stacked=False)
    _titled(figure, title)
    x = spacing[0] * np.arange(heights.shape[0], dtype=np.float64)
    unit = length_unit(np.ptp(x))
    if heights.ndim == 1:
        starts, low, high = envelope(heights / size, STRETCHES)
        left.fill_between(x[starts] / unit[0], low, high, color=BLUE, linewidth=0.6)
        left.set_xlabel(f"x / {unit[1]}")
        left.set_ylabel(f"height / {symbol}")
    else:
        y = spacing[1] * np.arange(heights.shape[1], dtype=np.float64)
        extreme = max(length) > 12 * min(length)
        image = draw_map(left, x, y, heights / size, unit, equal=not extreme, **colours)
        figure.colorbar(image, ax=left, label=f"height / {symbol}", extend="both", shrink=0.9)
    left.xaxis.set_major_locator(MaxNLocator(6))
    height_histogram(right, {"heights": distribution(heights)}, (size, symbol))
    _draw_material_ratio(right, heights, size)
    return figure


def _draw_material_ratio(axes: Axes, heights: NDArray[np.float64], size: float) -> None:
    """Draw the share of points that reach a height, on an axis of its own to the right."""
    ratio, height = material_ratio_curve(heights)
    share = axes.twinx()
    share.plot(height / size, 100.0 * ratio, color=VERMILLION, linewidth=1.2)
    share.set_ylim(0.0, 100.0)
    share.grid(visible=False)
    share.set_ylabel("material ratio / %", color=VERMILLION)
    share.tick_params(axis="y", colors=VERMILLION)


def _titled(figure: Figure, title: str) -> None:
    figure.set_facecolor("white")  # it goes to a file of its own
    figure.suptitle(title, x=0.01, ha="left", fontweight="bold")


def _picture_panels(
    height: float,
    ratios: tuple[float, float],
    spectra: NamedSpectra,
    octaves: ThirdOctaves | None = None,
    *,
    stacked: bool,
) -> tuple[Figure, Axes, Axes]:
    """Figure of a file with two panels, side by side or stacked, above its spectra, if there are any."""
    held = {name: pair for name, pair in spectra.items() if (pair[1] > 0).sum() > 1}
    below = 3.2 if held else 0.0
    figure = new_figure(height + below)
    grid = figure.add_gridspec(2 if held else 1, 1, height_ratios=[height, below] if held else [height])
    if stacked:
        inner = grid[0].subgridspec(2, 1, height_ratios=ratios)
    else:
        inner = grid[0].subgridspec(1, 2, width_ratios=ratios)
    first, second = (figure.add_subplot(inner[n]) for n in range(2))
    if held and octaves is not None:
        _draw_third_octaves(figure.add_subplot(grid[1]), octaves)
    elif held:
        _draw_spectra(figure.add_subplot(grid[1]), held)
    return figure, first, second


def _draw_third_octaves(axes: Axes, octaves: ThirdOctaves) -> None:
    shown = octaves.limited | (octaves.wavelength > 1e-3)
    centres = 1.0 / octaves.wavelength[shown]
    measured, processed, limit = (
        each[shown] for each in (octaves.measured, octaves.processed, octaves.limit)
    )
    axes.plot(centres, measured, color=MUTED, marker=".", linestyle="--", label="as measured")
    axes.plot(centres, processed, color=BLUE, marker="o", label="without spikes, rolled over (EN 15610)")
    axes.plot(centres, limit, color=INK, linewidth=1.8, label="limit of EN ISO 3095:2013, rails")
    over = processed > limit
    if over.any():
        axes.plot(centres[over], processed[over], "o", color=VERMILLION, label="above the limit")
    band_axis(axes, centres, "wavelength / mm")
    axes.xaxis.set_major_formatter(FuncFormatter(lambda k, _: f"{nominal(1e3 / k):g}"))
    axes.set_ylabel("roughness / dB re 1 µm")
    axes.set_title(f"one-third octaves: {over.sum()} of {np.isfinite(limit).sum()} above the limit")
    axes.legend(loc="best")


def _draw_spectra(axes: Axes, spectra: NamedSpectra) -> None:
    for (name, (wavenumber, density)), colour in zip(
        spectra.items(), cycle((BLUE, VERMILLION)), strict=False
    ):
        drawn = density > 0
        axes.loglog(*smooth_on_log_axis(wavenumber[drawn], density[drawn]), color=colour, label=name)
    level = np.concatenate([density[density > 0] for _, density in spectra.values()])
    axes.set_ylim(max(level.min() / 2, level.max() * 1e-10), level.max() * 4)
    ends = [wavenumber for wavenumber, _ in spectra.values()]
    wavenumber_axis(axes, min(k[0] for k in ends), max(k[-1] for k in ends))
    power_axis(axes.yaxis)
    axes.set_ylabel("one-sided PSD / m³")
    axes.legend(loc="lower left")


@styled()
def lines_picture(
    lines: Sequence[NDArray[np.float64]],
    spacing: float,
    title: str,
    spectra: NamedSpectra = MappingProxyType({}),
    octaves: ThirdOctaves | None = None,
) -> Figure:
    """Draw lines that were measured side by side, one above the other, their distribution and their spectra.

    Levelled heights (n,) and the distance of points along the lines, m, positive out of the material.
    """
    together = np.concatenate(lines)
    size, symbol, _ = height_scale(together)
    reach = np.ptp(np.nanpercentile(together, [0.1, 99.9])) / size
    figure, left, right = _picture_panels(2.4 + 0.42 * len(lines), (2.4, 1), spectra, octaves, stacked=False)
    _titled(figure, title)
    longest = max(map(len, lines)) * spacing
    unit = length_unit(longest)
    for row, (line, colour) in enumerate(zip(lines, cycle((BLUE, VERMILLION)), strict=False)):
        starts, low, high = envelope(line / size, STRETCHES)
        at = starts * spacing / unit[0]
        left.fill_between(at, low - row * reach, high - row * reach, color=colour, linewidth=0.5)
    left.set_xlim(0, longest / unit[0])
    left.set_ylim(-(len(lines) - 0.4) * reach, 0.6 * reach)
    left.set_yticks([-row * reach for row in range(len(lines))], [f"{n + 1}" for n in range(len(lines))])
    left.set_xlabel(f"distance along the lines / {unit[1]}")
    left.set_ylabel("line")
    left.set_title(f"levelled lines, each drawn {reach:.3g} {symbol} below the one before")
    length = _round_length(0.6 * reach)
    left.plot([0.985 * longest / unit[0]] * 2, [0.5 * reach - length, 0.5 * reach], color=INK, linewidth=3)
    left.text(0.975 * longest / unit[0], 0.5 * reach, f"{length:g} {symbol}", ha="right", va="top")
    height_histogram(right, {"heights": distribution(together)}, (size, symbol))
    _draw_material_ratio(right, together, size)
    right.set_title("heights of all lines")
    return figure


def _round_length(most: float) -> float:
    """Largest 1, 2 or 5 times a power of ten that is no more than a length."""
    decade = 10.0 ** np.floor(np.log10(most))
    return float(decade * max(step for step in (1, 2, 5) if step * decade <= most))
