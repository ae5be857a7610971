"""Figures of the contact: pressure at the working load, force and stiffness."""

from __future__ import annotations

from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Ellipse
from numpy.typing import NDArray
from xarray import DataTree

from asperity.reporting.data import engineering, force_unit, laws, number, present, values
from asperity.reporting.filter_figures import FILTER
from asperity.reporting.law_entries import law_entry
from asperity.reporting.part import Data, Part, Series, field, present_series, series
from asperity.reporting.style import (
    BLUE,
    GREEN,
    INK,
    MUTED,
    side_by_side,
    styled,
)
from asperity.reporting.texture import draw_map, length_unit
from asperity.schema import Entry, contact
from asperity.schema.rolling import CONTACT_FORCE

CURVE_POINTS = 200
"""Points of a closed form."""


def _centre(axis: NDArray[np.float64]) -> float:
    return 0.0 if axis[0] <= 0 <= axis[-1] else float(axis[0] + axis[-1]) / 2


def pressure_data(tree: DataTree) -> Data:
    """Pressure: one row per x, one column per y."""
    return field(tree, contact.PRESSURE, contact.PX, contact.PY, "p")


@styled()
def pressure_figure(tree: DataTree, data: Data) -> Figure:
    """Pressure and, if known, gap at the working load, with the outline of Hertz's contact."""
    with_gap = present(tree, contact.GAP)
    figure, panels = side_by_side(4.1, (1, 1))
    x, y, pressure = data.at, values(tree, contact.PY), data.field
    unit = length_unit(np.ptp(x))
    symbol, size = ("GPa", 1e9) if pressure.max() >= 2e9 else ("MPa", 1e6)
    loaded = np.where(pressure > 0, pressure, np.nan) / size
    image = draw_map(panels[0], x, y, loaded, unit, cmap="inferno_r", vmin=0)
    figure.colorbar(image, ax=panels[0], label=f"pressure / {symbol}", shrink=0.9)
    panels[0].set_title("pressure")
    panels[0].set_facecolor("#f6f6f6")  # on a dark page too: the colours run from light to black
    semi_axes = _semi_axes(tree)
    if with_gap:
        gap = values(tree, contact.GAP, "px", "py")
        height, height_symbol = length_unit(float(np.nanmax(gap)) or 1e-6)
        image = draw_map(panels[1], x, y, gap / height, unit, cmap="cividis", vmin=0)
        figure.colorbar(image, ax=panels[1], label=f"gap / {height_symbol}", shrink=0.9)
        panels[1].set_title("gap")
    else:
        _pressure_section(panels[1], x, y, pressure / size, unit, symbol)
    for axes in panels[: 2 if with_gap else 1]:
        _ellipse(axes, x, y, semi_axes, unit)
    return figure


def _semi_axes(tree: DataTree) -> tuple[float, float] | None:
    """Semi-axes of Hertz's contact in m: along the rolling direction and across; the same for a circle."""
    along, across = (number(tree, axis) for axis in (contact.HERTZ_RADIUS, contact.HERTZ_RADIUS_ACROSS))
    return (along, across or along) if along else None


def _ellipse(
    axes: Axes,
    x: NDArray[np.float64],
    y: NDArray[np.float64],
    semi_axes: tuple[float, float] | None,
    unit: tuple[float, str],
) -> None:
    if semi_axes is None:
        return
    centre = (_centre(x) / unit[0], _centre(y) / unit[0])
    size = [2 * semi_axis / unit[0] for semi_axis in semi_axes]
    for colour, width, dashes in (("white", 2.6, "-"), ("black", 1.1, (0, (4, 2)))):
        axes.add_patch(
            Ellipse(centre, *size, fill=False, edgecolor=colour, linewidth=width, linestyle=dashes)
        )


def _pressure_section(
    axes: Axes,
    x: NDArray[np.float64],
    y: NDArray[np.float64],
    pressure: NDArray[np.float64],
    unit: tuple[float, str],
    symbol: str,
) -> None:
    middle = int(np.argmin(np.abs(y - _centre(y))))
    axes.fill_between(x / unit[0], pressure[:, middle], color=BLUE, linewidth=0.5, step="mid")
    axes.set_xlim(x[0] / unit[0], x[-1] / unit[0])
    axes.set_ylim(bottom=0)
    axes.set_xlabel(f"x / {unit[1]} (rolling direction →)")
    axes.set_ylabel(f"pressure / {symbol}")
    axes.set_title("along the middle")


def _pressure_caption(tree: DataTree) -> str:
    parts = []
    semi_axes = _semi_axes(tree)
    oval = semi_axes is not None and semi_axes[0] != semi_axes[1]
    outline = "semi-axis of Hertz's contact in rolling direction" if oval else "radius of Hertz's contact"
    for attribute, label in (
        (contact.WORKING_LOAD, "working load"),
        (contact.WORKING_APPROACH, "approach"),
        (contact.HERTZ_RADIUS, f"{outline} (dashed {'ellipse' if oval else 'circle'})"),
        *([(contact.HERTZ_RADIUS_ACROSS, "across")] if oval else []),
        (contact.CONTACT_AREA, "area in contact"),
    ):
        found = number(tree, attribute)
        if found is not None:
            parts.append(f"{label} {engineering(found, attribute.units.replace('m2', 'm²'))}")
    peak = engineering(float(np.nanmax(values(tree, contact.PRESSURE))), "Pa")
    area = number(tree, contact.CONTACT_AREA)
    if area and semi_axes:
        parts[-1] += f" ({100 * area / (np.pi * semi_axes[0] * semi_axes[1]):.0f} % of Hertz's)"
    return f"First sample at the working load: {'; '.join([*parts, f'highest pressure {peak}'])}."


_CURVES = (
    contact.FORCE,
    contact.FORCE_STD,
    contact.HERTZ_FORCE,
    contact.STIFFNESS,
    contact.STIFFNESS_STD,
    contact.TANGENT_STIFFNESS,
    contact.HERTZ_STIFFNESS,
    contact.CONTACT_RADIUS,
)


def loading_data(tree: DataTree) -> Data:
    """Force and stiffness against approach and state."""
    approach = series(tree, contact.APPROACH)
    lines = present_series(tree, {entry: entry.name for entry in _CURVES})
    datum = number(tree, contact.DATUM)
    if datum is not None:
        state: dict[Any, Series] = {"state": Series("state r", "m", approach.values + datum)}
        lines = state | lines
    return Data(approach, lines)


@styled()
def loading_figure(tree: DataTree, data: Data) -> Figure:
    """Contact force and contact stiffness against the approach, with their spread and Hertz's."""
    figure, panels = side_by_side(4.2, (1, 1))
    rough = bool(contact.FORCE_STD in data.lines and np.nanmax(data.lines[contact.FORCE_STD].values) > 0)
    size, symbol = force_unit(float(np.nanmax(data.lines[contact.FORCE].values)))
    force = "rough, mean ± standard deviation" if rough else "smooth bodies (Hertz)"
    secant = "k_c = F/r, mean ± standard deviation" if rough else "F/r, smooth bodies (Hertz)"
    solid, dotted = {"color": BLUE, "linestyle": "-"}, {"color": GREEN, "linestyle": (0, (1.5, 1.5))}
    _curve(panels[0], data, contact.FORCE, contact.FORCE_STD, size, label=force, **solid)
    _hertz(panels[0], tree, data.at, 1.5, size)
    panels[0].set_ylabel(f"contact force F / {symbol}")
    _curve(panels[1], data, contact.STIFFNESS, contact.STIFFNESS_STD, 1e6, label=secant, **solid)
    _curve(panels[1], data, contact.TANGENT_STIFFNESS, None, 1e6, label="tangent dF/dδ", **dotted)
    _hertz(panels[1], tree, data.at, 0.5, 1e6)
    panels[1].set_ylabel("stiffness / (MN/m)")
    for axes in panels:
        _approach_axis(axes, tree, data.at)
        axes.set_ylim(bottom=0)
        axes.legend(loc="upper left")
    return figure


def _curve(axes: Axes, data: Data, mean: Entry, spread: Entry | None, size: float, **look: Any) -> None:
    """Draw a curve, with dots where its states are few, and what it varies by."""
    if mean not in data.lines:
        return
    approach, level = data.at * 1e6, data.lines[mean].values / size
    marker = "o" if spread and len(approach) <= 40 else ""
    axes.plot(approach, level, marker=marker, zorder=3, **look)
    if spread in data.lines:
        reach = data.lines[spread].values / size
        axes.fill_between(
            approach, level - reach, level + reach, color=look["color"], alpha=0.25, linewidth=0
        )


def _hertz(axes: Axes, tree: DataTree, approach: NDArray[np.float64], power: float, size: float) -> None:
    """Draw Hertz's closed form K δ^power from where the smooth bodies touch: there is none below."""
    constant = number(tree, contact.HERTZ_CONSTANT)
    if constant is None or approach.max() <= 0:
        return
    closed = np.linspace(0.0, approach.max(), CURVE_POINTS)
    axes.plot(
        closed * 1e6,
        constant * closed**power / size,
        color=INK,
        linestyle=(0, (4, 2)),
        label="Hertz",
        zorder=3,
    )


def _approach_axis(axes: Axes, tree: DataTree, approach: NDArray[np.float64]) -> None:
    low, high = 1e6 * approach.min(), 1e6 * approach.max()
    margin = 0.02 * (high - low or 1.0)
    axes.set_xlim(low - margin, high + margin)
    axes.set_xlabel("approach δ / µm (closing →)")
    datum = number(tree, contact.DATUM)
    if datum is not None:
        top = axes.twiny()
        top.set_xlim(*(edge + 1e6 * datum for edge in axes.get_xlim()))
        top.grid(visible=False)
        top.set_xlabel("state r = δ + d₀ / µm")
    working = number(tree, contact.WORKING_APPROACH)
    if working is not None and low <= 1e6 * working <= high:
        axes.axvline(1e6 * working, color=MUTED, linewidth=0.9, linestyle=":", label="working load")


def _force_caption(tree: DataTree) -> str:
    datum = number(tree, contact.DATUM)
    common = (
        f"one common datum d₀ = {engineering(datum, 'm')}" if datum is not None else "no common datum stated"
    )
    rough = number(tree, contact.SAMPLES) is not None
    plane = "Approach from the plane that the nominal patch feels" if rough else "Approach"
    return (
        f"{plane}, positive closing; rough contact starts below zero. The state r counts from {common}. "
        "k_c is the secant F/r (Eq. 2.3), the tangent is what small vibration feels. Hertz: smooth bodies in "
        f"closed form, F = K δ^1.5 and their secant F/δ, at δ = r − d₀.{_datum_sensitivity(tree)}"
    )


def _datum_sensitivity(tree: DataTree) -> str:
    """What a force that is k_c = F/r times the texture owes to where r counts from."""
    load, approach, datum, samples, path = (
        number(tree, attribute)
        for attribute in (
            contact.WORKING_LOAD,
            contact.WORKING_APPROACH,
            contact.DATUM,
            contact.DATUM_SAMPLES,
            contact.DATUM_PATH,
        )
    )
    used = [law for law in laws(tree, CONTACT_FORCE) if "datum" in law_entry(tree, law).needs]
    if not used or load is None or approach is None or datum is None or samples is None or path is None:
        return ""
    other, where = (path, "samples and path") if datum == samples else (samples, "the samples alone")
    tangent = np.interp(approach, values(tree, contact.APPROACH), values(tree, contact.TANGENT_STIFFNESS))
    below = 20 * np.log10(tangent * (approach + datum) / load)
    change = f"{20 * np.log10((approach + datum) / (approach + other)):+.1f}".replace("-", "−")
    return (
        f" In {' and '.join(used)} k_c multiplies the texture: under the working load {below:.1f} dB below "
        f"the tangent. d₀ from {where}, {engineering(other, 'm')}, would change that by {change} dB."
    )


CONTACT = (
    Part(
        "contact_pressure",
        "Pressure at the working load",
        (contact.PRESSURE, contact.PX, contact.PY),
        pressure_data,
        pressure_figure,
        _pressure_caption,
    ),
    Part(
        "contact_force",
        "Contact force and stiffness",
        (contact.FORCE, contact.APPROACH),
        loading_data,
        loading_figure,
        _force_caption,
    ),
    *FILTER,
)
