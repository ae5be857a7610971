"""Charts of what a surface file holds: heights as a map or as lines, their distribution, their spectra."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from itertools import cycle
from types import MappingProxyType
from typing import TYPE_CHECKING, Any

import numpy as np

from asperity.reporting.axes import band_axis
from asperity.reporting.chart import Area, Axis, Chart, Line, Mark, Note, Numbers, Panel
from asperity.reporting.style import BLUE, INK, MUTED, VERMILLION, envelope, smooth_on_log_axis
from asperity.reporting.texture import (
    SECOND_DASHES,
    SLENDER,
    STRETCHES,
    distribution,
    height_histogram,
    height_map,
    height_scale,
    length_unit,
    psd_panel,
)
from asperity.spectra import nominal
from asperity.surfaces.statistics import material_ratio_curve

if TYPE_CHECKING:
    from asperity.surfaces.en15610 import ThirdOctaves

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
