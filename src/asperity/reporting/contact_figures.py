"""Figures of the contact: pressure, force and stiffness, filters."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray
from xarray import DataTree

from asperity.reporting.axes import shade, stretches, wavenumber_axis
from asperity.reporting.chart import (
    BLUE,
    GREEN,
    INK,
    MUTED,
    Area,
    Axis,
    Boxes,
    Chart,
    Dashes,
    Line,
    Mark,
    Panel,
    Rules,
    Second,
    sequence,
)
from asperity.reporting.data import (
    engineering,
    force_unit,
    laws,
    number,
    plain,
    present,
    stored_variable,
    values,
)
from asperity.reporting.drawing import CORNERS
from asperity.reporting.law_entries import law_entry
from asperity.reporting.part import Data, Part, Series, field, present_series, series
from asperity.reporting.texture_figures import length_unit, map_panel
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


FLOOR = -40.0  # dB, lowest level of a drawn filter
MOST_FILTERS, MOST_PRINTED = 5, 3
LEAST_COHERENCE = 0.25  # of a signed estimate that is drawn in full
_APPLIED: dict[str, Any] = {"width": 1.1}
_THEORY: dict[str, Any] = {"width": 0.8, "dashes": (5.0, 2.5)}
_THEORY_TOLD = "; dashed: sin q / q"


def filter_data(tree: DataTree) -> Data:
    """Filters against wavenumber, one group of lines per approach."""
    return _filters(
        tree, *contact.FILTERS, contact.FILTER_SIGNED, contact.FILTER_COHERENCE, contact.FILTER_THEORY
    )


def printed_filter_data(tree: DataTree) -> Data:
    """Filters as printed against wavenumber, one group of lines per approach."""
    return _filters(tree, *contact.PRINTED_FILTERS)


def _filters(tree: DataTree, *entries: Entry) -> Data:
    approach = values(tree, contact.APPROACH)
    lines: dict[Any, Series] = {}
    for entry in entries:
        if not present(tree, entry):
            continue
        rows = values(tree, entry, *entry.dims)
        for row in np.flatnonzero(np.isfinite(rows).any(axis=1)).tolist():
            name = f"{entry.name}(approach={approach[row]:.9g} m)"
            lines[entry, row] = Series(name, entry.units, rows[row])
    return Data(series(tree, contact.WAVENUMBER), lines)


def _drawn_filters(tree: DataTree, data: Data, entry: Entry, most: int = MOST_FILTERS) -> list[int]:
    """States whose filters are drawn: a few, evenly spread, that of the working load among them."""
    filled = np.array(list(data.of(entry)))
    picks = np.linspace(0, len(filled) - 1, min(most, len(filled))).round().astype(int)
    working = number(tree, contact.WORKING_APPROACH)
    if working is not None:
        at_load = int(np.argmin(np.abs(values(tree, contact.APPROACH)[filled] - working)))
        picks[np.argmin(np.abs(picks - at_load))] = at_load
    return filled[picks].tolist()


def filter_chart(tree: DataTree, data: Data) -> Chart:
    """Contact filters of several approaches: magnitude, and below it the signed estimate."""
    rows = _drawn_filters(tree, data, contact.FILTER)
    magnitudes = _magnitudes(tree, data, contact.FILTERS, rows)
    if not present(tree, contact.FILTER_SIGNED):
        return Chart((magnitudes,))
    upper, lower = replace(magnitudes.x, label=""), replace(magnitudes.x, second=None)  # each is named once
    return Chart((replace(magnitudes, x=upper), _signed(tree, data, rows, lower)))


def printed_filter_chart(tree: DataTree, data: Data) -> Chart:
    """The same filters, normalised as printed."""
    rows = _drawn_filters(tree, data, contact.PRINTED_FILTER, MOST_PRINTED)
    return Chart((_magnitudes(tree, data, contact.PRINTED_FILTERS, rows),))


def _magnitudes(tree: DataTree, data: Data, entries: tuple[Entry, ...], rows: list[int]) -> Panel:
    """A filter as estimated (dots), as fitted (wide) and as applied (thin), and what theory says (dashed)."""
    approach, excited = values(tree, contact.APPROACH), _excited(tree)
    fitted, raw, applied, spread = (data.of(entry) for entry in entries)
    theory = _theory(tree)
    marks: list[Mark] = []
    for row, colour in zip(rows, sequence(len(rows)), strict=True):
        if row in spread:
            edges = (fitted[row] - spread[row], fitted[row] + spread[row])
            clear = excited & (edges[0] > 0)
            low, high = (np.where(clear, _level(edge), np.nan) for edge in edges)
            marks.append(Area(data.at, low, high, colour=colour, opacity=0.09))
        wide = {"width": 4.5, "opacity": 0.35} if row in applied else {"width": 1.7}
        drawn: list[tuple[NDArray[np.float64], NDArray[np.bool_], dict[str, Any]]] = [
            (fitted[row], excited, {"label": f"δ = {plain(approach[row] * 1e6)} µm", **wide})
        ]
        if row in applied:
            drawn.append((applied[row], excited, _APPLIED))
        if row in raw:
            drawn.append((raw[row], np.isfinite(raw[row]), {"marker": ".", "width": 0.0}))
        if theory is not None:  # beyond the main lobe those of all states would cross
            drawn.append((theory[row], np.logical_and.accumulate(theory[row] > 0), _THEORY))
        marks += [
            Line(data.at, np.where(shown, _level(ratio), np.nan), colour=colour, **look)
            for ratio, shown, look in drawn
        ]
    told = "magnitude" + ("; dots: ratio; wide: fit; thin: as applied" if applied else "")
    return _over_wavenumbers(
        data.at,
        excited,
        Axis("|H| / dB", FLOOR, 5.0),
        marks,
        title=told + _THEORY_TOLD * (theory is not None),
        height=4.4,
    )


def _signed(tree: DataTree, data: Data, rows: list[int], axis: Axis) -> Panel:
    """The signed estimate, faint where it explains little of the force."""
    excited, theory = _excited(tree), _theory(tree)
    estimate, coherence = (data.of(entry) for entry in (contact.FILTER_SIGNED, contact.FILTER_COHERENCE))
    marks: list[Mark] = [Rules(np.zeros(1), "y", dashes=())]
    for row, colour in zip(rows, sequence(len(rows)), strict=True):
        signed = estimate.get(row, np.full(data.at.shape, np.nan))
        known = excited & (coherence.get(row, np.ones(data.at.shape)) >= LEAST_COHERENCE)
        faint = Line(data.at, np.where(excited, signed, np.nan), colour=colour, width=0.8, opacity=0.4)
        marks += [faint, Line(data.at, np.where(known, signed, np.nan), colour=colour, width=1.7)]
        if theory is not None:
            marks.append(Line(data.at, theory[row], colour=colour, **_THEORY))
    title = "signed estimate" + _THEORY_TOLD * (theory is not None)
    panel = _over_wavenumbers(
        data.at, excited, Axis("H (signed)", -0.5, 1.15), marks, title=title, height=3.0
    )
    return replace(panel, x=axis)


def _over_wavenumbers(
    wavenumber: NDArray[np.float64], excited: NDArray[np.bool_], y: Axis, marks: list[Mark], **place: Any
) -> Panel:
    """Panel over wavenumbers above zero, shaded where the texture excites nothing."""
    positive = wavenumber[wavenumber > 0]
    ends = np.maximum(wavenumber, positive[0])[stretches(~excited)]
    lacking = [shade(ends[:, 0], ends[:, 1], MUTED, opacity=0.12)] if len(ends) else []
    return Panel(wavenumber_axis(positive[0], positive[-1]), y, (*lacking, *marks), **place)


def _excited(tree: DataTree) -> NDArray[np.bool_]:
    """Where the texture excites the contact, by wavenumber; everywhere if the result does not say."""
    if not present(tree, contact.FILTER_EXCITED):
        return np.ones(len(values(tree, contact.WAVENUMBER)), dtype=bool)
    return values(tree, contact.FILTER_EXCITED) > 0


def _theory(tree: DataTree) -> NDArray[np.float64] | None:
    theory = contact.FILTER_THEORY
    return values(tree, theory, *theory.dims) if present(tree, theory) else None


def _level(ratio: NDArray[np.float64]) -> NDArray[np.float64]:
    return 20 * np.log10(np.maximum(ratio, 10 ** (FLOOR / 20 - 1)))


def _filter_caption(tree: DataTree) -> str:
    parts = [
        "Contact filter per approach against the wavenumber in rolling direction, in cycles per metre; cut "
        f"off at {plain(FLOOR)} dB"
    ]
    if present(tree, contact.FILTER_RAW):
        parts.append(
            "Dots: ratio of the scanned force to a point force on the lines (Eq. 2.6, power of all strips); "
            "wide: the fit to it; thin: what the filtered laws apply; shaded: standard deviation of strips"
        )
    if _theory(tree) is not None:
        parts.append(
            "Dashed: sin q / q, q = ka, the closed form of small roughness, uniform across, on Hertz's "
            "contact of radius a; it is negative beyond q = π, which a magnitude cannot show"
        )
    if present(tree, contact.FILTER_SIGNED):
        parts.append(
            "Signed: the force regressed on the mean line under the patch, faint where the two have less "
            f"than {100 * LEAST_COHERENCE:.0f} % of their power in common"
        )
    if not _excited(tree).all():
        parts.append("Grey: waves that the texture lacks, where the filter is held")
    return f"{'. '.join(parts)}. {_normalised(tree, contact.FILTER)}".strip()


def _normalised(tree: DataTree, entry: Entry) -> str:
    """What 0 dB of a filter is."""
    found = stored_variable(tree, entry)
    return "" if found is None else _NORMALISED.get(found.attrs.get("normalise", ""), "")


_NORMALISED = {
    "tangent": "Referred to the tangent stiffness: 0 dB is a texture that the contact feels fully.",
    "low-wavenumber": "Normalised as printed: 0 dB are its own longest waves.",
}


def _printed_filter_caption(tree: DataTree) -> str:
    scale = stored_variable(tree, contact.FILTER_SCALE)
    found = ""
    if scale is not None:
        low, high = float(np.nanmin(scale.values)), float(np.nanmax(scale.values))
        found = f" k_0/k_t = {plain(low, 2)} to {plain(high, 2)}: what the patch averages across is left out."
    normalised = _normalised(tree, contact.PRINTED_FILTER)
    return f"The filter of the law printed: as above, but {normalised[:1].lower()}{normalised[1:]}{found}"


FILTER = (
    Part(
        "contact_filter",
        "Contact filter",
        (contact.FILTER, contact.WAVENUMBER, contact.APPROACH),
        filter_data,
        filter_chart,
        _filter_caption,
    ),
    Part(
        "contact_filter_printed",
        "Contact filter as printed",
        (contact.PRINTED_FILTER, contact.WAVENUMBER, contact.APPROACH),
        printed_filter_data,
        printed_filter_chart,
        _printed_filter_caption,
    ),
)
