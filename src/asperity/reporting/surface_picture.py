"""Pictures of what a surface file holds: heights as a map or as lines, their distribution, their spectra."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from itertools import cycle
from types import MappingProxyType
from typing import TYPE_CHECKING

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import FuncFormatter, MaxNLocator
from numpy.typing import NDArray

from asperity.reporting.style import (
    BLUE,
    INK,
    MUTED,
    VERMILLION,
    band_axis,
    envelope,
    new_figure,
    power_axis,
    smooth_on_log_axis,
    styled,
    wavenumber_axis,
)
from asperity.reporting.texture import (
    SLENDER,
    STRETCHES,
    distribution,
    draw_map,
    height_histogram,
    height_scale,
    length_unit,
)
from asperity.spectra import nominal
from asperity.surfaces.material_ratio import material_ratio_curve

if TYPE_CHECKING:
    from asperity.surfaces.third_octaves import ThirdOctaves

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
