"""Figures of the contact: pressure at the working load, force and stiffness."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray
from xarray import DataTree

from asperity.reporting.chart import Area, Axis, Boxes, Chart, Dashes, Line, Mark, Panel, Rules, Second
from asperity.reporting.data import engineering, force_unit, laws, number, present, values
from asperity.reporting.law_entries import law_entry
from asperity.reporting.part import Data, Part, Series, field, present_series, series
from asperity.reporting.scene import CORNERS
from asperity.reporting.style import BLUE, GREEN, INK
from asperity.reporting.texture import length_unit, map_panel
from asperity.schema import Entry, contact
from asperity.schema.rolling import CONTACT_FORCE

CURVE_POINTS = 200
"""Points of a closed form."""
PAPER = "#f6f6f6"
"""Behind pressure, on a dark page too: its colours run from light to black."""
MICRO, MEGA = 1e-6, 1e6
HERTZ: Dashes = (4.0, 2.0)


def _centre(axis: NDArray[np.float64]) -> float:
    return 0.0 if axis[0] <= 0 <= axis[-1] else float(axis[0] + axis[-1]) / 2


def pressure_data(tree: DataTree) -> Data:
    """Pressure: one row per x, one column per y."""
    return field(tree, contact.PRESSURE, contact.PX, contact.PY, "p")


def pressure_chart(tree: DataTree, data: Data) -> Chart:
    """Pressure and, if known, gap at the working load, with the outline of Hertz's contact."""
    x, y, pressure = data.at, values(tree, contact.PY), data.field
    symbol, size = ("GPa", 1e9) if pressure.max() >= 2e9 else ("MPa", 1e6)
    loaded = np.where(pressure > 0, pressure, np.nan) / size
    outline, label = _outline(tree, x, y), f"pressure / {symbol}"
    whole = (np.array([-np.inf]), np.array([np.inf]))
    scale = (label, 0.0, float(np.nanmax(pressure)) / size)
    above = map_panel(x, y, loaded, scale, *outline, colours="inferno_r", title="pressure", height=4.1)
    above = replace(above, marks=(Boxes(*whole, *whole, colour=PAPER), *above.marks))
    if not present(tree, contact.GAP):
        return Chart((above, _pressure_section(x, y, pressure / size, label)))
    gap = np.maximum(values(tree, contact.GAP, "px", "py"), 0.0)  # but for rounding it is
    height, height_symbol = length_unit(float(np.nanmax(gap)) or 1e-6)
    scale = (f"gap / {height_symbol}", 0.0, float(np.nanmax(gap)) / height)
    return Chart(
        (above, map_panel(x, y, gap / height, scale, *outline, title="gap", height=4.1, beside=True))
    )


def _semi_axes(tree: DataTree) -> tuple[float, float] | None:
    """Semi-axes of Hertz's contact in m: along the rolling direction and across; the same for a circle."""
    along, across = (number(tree, axis) for axis in (contact.HERTZ_RADIUS, contact.HERTZ_RADIUS_ACROSS))
    return (along, across or along) if along else None


def _outline(tree: DataTree, x: NDArray[np.float64], y: NDArray[np.float64]) -> list[Line]:
    """Outline of Hertz's contact, black on white: it crosses all colours of a map."""
    semi_axes, (size, _) = _semi_axes(tree), length_unit(np.ptp(x))
    if semi_axes is None:
        return []
    angle = np.linspace(0.0, 2 * np.pi, CORNERS + 1)
    along = (_centre(x) + semi_axes[0] * np.cos(angle)) / size
    across = (_centre(y) + semi_axes[1] * np.sin(angle)) / size
    white = Line(along, across, colour="#ffffff", width=2.6)
    return [white, replace(white, colour="#000000", dashes=HERTZ, width=1.1)]


def _pressure_section(
    x: NDArray[np.float64], y: NDArray[np.float64], pressure: NDArray[np.float64], label: str
) -> Panel:
    """Pressure along the middle, a bar for each cell."""
    size, symbol = length_unit(np.ptp(x))
    middle = pressure[:, int(np.argmin(np.abs(y - _centre(y))))]
    at, half = x / size, (x[1] - x[0]) / size / 2
    bars = Boxes(at - half, at + half, np.zeros(at.shape), middle, colour=BLUE)
    along = Axis(f"x / {symbol} (rolling direction →)", at[0], at[-1])
    return Panel(along, Axis(label, 0.0), (bars,), title="along the middle", height=4.1, beside=True)


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


def loading_chart(tree: DataTree, data: Data) -> Chart:
    """Contact force and contact stiffness against the approach, with their spread and Hertz's."""
    rough = contact.FORCE_STD in data.lines and np.nanmax(data.lines[contact.FORCE_STD].values) > 0
    size, symbol = force_unit(float(np.nanmax(data.lines[contact.FORCE].values)))
    force = "rough, mean ± standard deviation" if rough else "smooth bodies (Hertz)"
    secant = "k_c = F/r, mean ± standard deviation" if rough else "F/r, smooth bodies (Hertz)"
    forces = [
        *_curve(data, contact.FORCE, size, force, BLUE, spread=contact.FORCE_STD),
        *_hertz(tree, data.at, 1.5, size),
    ]
    stiffnesses = [
        *_curve(data, contact.STIFFNESS, MEGA, secant, BLUE, spread=contact.STIFFNESS_STD),
        *_curve(data, contact.TANGENT_STIFFNESS, MEGA, "tangent dF/dδ", GREEN, (1.5, 1.5)),
        *_hertz(tree, data.at, 0.5, MEGA),
    ]
    axis, load = _approach_axis(tree, data.at), _working_load(tree, data.at)
    return Chart(
        (
            Panel(axis, Axis(f"contact force F / {symbol}", 0.0), (*load, *forces), height=4.2),
            Panel(axis, Axis("stiffness / (MN/m)", 0.0), (*load, *stiffnesses), height=4.2, beside=True),
        )
    )


def _curve(
    data: Data,
    mean: Entry,
    size: float,
    label: str,
    colour: str,
    dashes: Dashes = (),
    spread: Entry | None = None,
) -> list[Mark]:
    """Draw a curve, with dots where its states are few, and what it varies by."""
    if mean not in data.lines:
        return []
    approach, level = data.at / MICRO, data.lines[mean].values / size
    marker = "o" if spread and len(approach) <= 40 else ""
    line = Line(approach, level, label, colour, dashes, marker=marker)
    if spread not in data.lines:
        return [line]
    reach = data.lines[spread].values / size
    return [Area(approach, level - reach, level + reach, colour=colour), line]


def _hertz(tree: DataTree, approach: NDArray[np.float64], power: float, size: float) -> list[Mark]:
    """Draw Hertz's closed form K δ^power from where the smooth bodies touch: there is none below."""
    constant = number(tree, contact.HERTZ_CONSTANT)
    if constant is None or approach.max() <= 0:
        return []
    closed = np.linspace(0.0, approach.max(), CURVE_POINTS)
    return [Line(closed / MICRO, constant * closed**power / size, "Hertz", INK, HERTZ)]


def _approach_axis(tree: DataTree, approach: NDArray[np.float64]) -> Axis:
    low, high = approach.min() / MICRO, approach.max() / MICRO
    margin, datum = 0.02 * (high - low or 1.0), number(tree, contact.DATUM)
    state = None if datum is None else Second("state r = δ + d₀ / µm", offset=datum / MICRO)
    return Axis("approach δ / µm (closing →)", low - margin, high + margin, second=state, linked="approach")


def _working_load(tree: DataTree, approach: NDArray[np.float64]) -> list[Mark]:
    working = number(tree, contact.WORKING_APPROACH)
    if working is None or not approach.min() <= working <= approach.max():
        return []
    return [Rules(np.array([working / MICRO]), label="working load")]


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


PRESSURE = Part(
    "contact_pressure",
    "Pressure at the working load",
    (contact.PRESSURE, contact.PX, contact.PY),
    pressure_data,
    pressure_chart,
    _pressure_caption,
)
LOADING = Part(
    "contact_force",
    "Contact force and stiffness",
    (contact.FORCE, contact.APPROACH),
    loading_data,
    loading_chart,
    _force_caption,
)
