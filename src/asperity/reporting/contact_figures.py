"""Figures of the contact: pressure, force and stiffness, filters."""

from collections.abc import Iterator
from dataclasses import replace
from typing import Any

import numpy as np
from xarray import DataTree

from asperity.arguments import Array
from asperity.reporting import chart, data, panels
from asperity.reporting.chart import BLUE, GREEN, INK, Axis, Boxes, Drawn, Line, Mark, Panel
from asperity.reporting.figure import Lines, Of, Series, field, figure
from asperity.reporting.texture_figures import map_panel
from asperity.schema import Entry, contact, rolling

CURVE_POINTS = 200
"""Points of a closed form."""
CORNERS = 120
"""Of an ellipse."""
PAPER = "#f6f6f6"
"""Behind pressure, on a dark page too: its colours run from light to black."""
MICRO, MEGA = 1e-6, 1e6
HERTZ: chart.Dashes = (4.0, 2.0)


def _semi_axes(tree: DataTree) -> tuple[float, float] | None:
    """Semi-axes of Hertz's contact in m: along the rolling direction and across; the same for a circle."""
    along, across = (data.number(tree, axis) for axis in (contact.HERTZ_RADIUS, contact.HERTZ_RADIUS_ACROSS))
    return (along, across or along) if along else None


def _outline(tree: DataTree, x: Array, y: Array) -> list[Line]:
    """Outline of Hertz's contact, black on white: it crosses all colours of a map."""
    semi_axes = _semi_axes(tree)
    size, _ = data.length_unit(np.ptp(x))
    if semi_axes is None:
        return []
    angle = np.linspace(0.0, 2 * np.pi, CORNERS + 1)
    along, across = (
        ((0.0 if at[0] <= 0 <= at[-1] else (at[0] + at[-1]) / 2) + semi_axis * turn(angle)) / size
        for at, semi_axis, turn in zip((x, y), semi_axes, (np.cos, np.sin), strict=True)
    )
    white = Line(along, across, colour="#ffffff", width=2.6)
    return [white, replace(white, colour="#000000", dashes=HERTZ, width=1.1)]


@figure("Pressure at the working load", Of(contact.PX, "x"), field(contact.PRESSURE, contact.PY, "p"))
def contact_pressure(tree: DataTree, lines: Lines) -> Drawn:
    """Pressure and gap at the working load, with Hertz's contact outlined."""
    x = lines.at
    y = data.values(tree, contact.PY)
    pressure = data.values(tree, contact.PRESSURE)
    gap = np.maximum(data.values(tree, contact.GAP), 0.0)  # but for rounding it is
    height, symbol = data.length_unit(float(np.nanmax(gap)) or 1e-6)
    size, unit = (1e9, "GPa") if pressure.max() >= 2e9 else (1e6, "MPa")
    loaded = np.where(pressure > 0, pressure, np.nan) / size
    outline = _outline(tree, x, y)
    scale = (f"pressure / {unit}", 0.0, float(np.nanmax(pressure)) / size)
    above = map_panel(x, y, loaded, scale, *outline, colours="inferno_r", title="pressure", height=4.1)
    whole = np.array([-np.inf]), np.array([np.inf])
    yield replace(above, marks=(Boxes(*whole, *whole, colour=PAPER), *above.marks))
    scale = (f"gap / {symbol}", 0.0, float(np.nanmax(gap)) / height)
    yield map_panel(x, y, gap / height, scale, *outline, title="gap", height=4.1, beside=True)
    told = {
        contact.WORKING_LOAD: "working load",
        contact.WORKING_APPROACH: "approach",
        contact.HERTZ_RADIUS: "semi-axis of Hertz's contact (dashed) in rolling direction",
        contact.HERTZ_RADIUS_ACROSS: "across",
        contact.CONTACT_AREA: "area in contact",
    }
    parts = [
        f"{label} {data.engineering(found, attribute.units.replace('m2', 'm²'))}"
        for attribute, label in told.items()
        if (found := data.number(tree, attribute)) is not None
    ]
    area = data.number(tree, contact.CONTACT_AREA)
    if area and (semi_axes := _semi_axes(tree)):
        parts[-1] += f" ({100 * area / (np.pi * semi_axes[0] * semi_axes[1]):.0f} % of Hertz's)"
    parts.append(f"highest pressure {data.engineering(float(np.nanmax(pressure)), 'Pa')}")
    cells, why = (data.stated(tree, each) for each in (contact.RIM_CELLS, contact.RIM_CELLS_CHOSEN))
    chosen = f" Cells at rims count as {cells}: {why}." if why else ""
    yield f"First sample at the working load: {'; '.join(parts)}.{chosen}"


# --- force and stiffness over the approach


def _state(tree: DataTree) -> Iterator[Series]:
    datum = data.number(tree, contact.DATUM)
    if datum is not None:
        yield Series("state r", "m", data.values(tree, contact.APPROACH) + datum)


_CURVES = (
    contact.FORCE_STD, contact.HERTZ_FORCE, contact.STIFFNESS, contact.STIFFNESS_STD,
    contact.TANGENT_STIFFNESS, contact.HERTZ_STIFFNESS, contact.CONTACT_RADIUS,
)  # fmt: skip


@figure(
    "Contact force and stiffness",
    Of(contact.APPROACH),
    _state,
    Of(contact.FORCE),
    *(Of(entry, optional=True) for entry in _CURVES),
)
def contact_force(tree: DataTree, lines: Lines) -> Drawn:
    """Contact force and contact stiffness against the approach, with their spread and Hertz's."""
    rough = any(np.nanmax(series.values) > 0 for series in lines.of(contact.FORCE_STD))
    size, symbol = data.force_unit(float(np.nanmax(data.values(tree, contact.FORCE))))
    force = "rough, mean ± standard deviation" if rough else "smooth bodies (Hertz)"
    secant = "k_c = F/r, mean ± standard deviation" if rough else "F/r, smooth bodies (Hertz)"
    at = lines.at / MICRO
    datum = data.number(tree, contact.DATUM)
    margin = 0.02 * (at.max() - at.min() or 1.0)
    state = None if datum is None else chart.Second("state r = δ + d₀ / µm", offset=datum / MICRO)
    ends = at.min() - margin, at.max() + margin
    axis = Axis("approach δ / µm (closing →)", *ends, second=state, linked="approach")
    load = []
    working = data.number(tree, contact.WORKING_APPROACH)
    if working is not None and lines.at.min() <= working <= lines.at.max():
        load = [chart.Rules(np.array([working / MICRO]), label="working load")]
    forces = _curve(lines, contact.FORCE, contact.FORCE_STD, size, force)
    forces += _hertz(tree, lines.at, 1.5, size)
    yield Panel(axis, Axis(f"contact force F / {symbol}", 0.0), (*load, *forces), height=4.2)
    secants = _curve(lines, contact.STIFFNESS, contact.STIFFNESS_STD, MEGA, secant)
    tangents = [
        Line(at, series.values / MEGA, "tangent dF/dδ", GREEN, (1.5, 1.5))
        for series in lines.of(contact.TANGENT_STIFFNESS)
    ]
    marks = (*load, *secants, *tangents, *_hertz(tree, lines.at, 0.5, MEGA))
    yield Panel(axis, Axis("stiffness / (MN/m)", 0.0), marks, height=4.2, beside=True)
    common = "no common datum stated"
    if datum is not None:
        common = f"one common datum d₀ = {data.engineering(datum, 'm')}"
    sampled = data.number(tree, contact.SAMPLES) is not None
    plane = "Approach from the plane that the nominal patch feels" if sampled else "Approach"
    yield (
        f"{plane}, positive closing; rough contact starts below zero. The state r counts from {common}. "
        "k_c is the secant F/r (Eq. 2.3), the tangent is what small vibration feels. Hertz: smooth bodies in "
        "closed form, F = K δ^1.5 and their secant F/δ, at δ = r − d₀."
    )
    yield _datum_sensitivity(tree)


def _curve(lines: Lines, mean: Entry, spread: Entry, size: float, label: str) -> list[Mark]:
    """Draw a curve, with dots where its states are few, and what it varies by."""
    at = lines.at / MICRO
    marks = list[Mark]()
    for series in lines.of(mean):
        level = series.values / size
        for by in (each.values / size for each in lines.of(spread)):
            marks.append(chart.Area(at, level - by, level + by, colour=BLUE))
        marks.append(Line(at, level, label, BLUE, marker="o" if len(at) <= 40 else ""))
    return marks


def _hertz(tree: DataTree, approach: Array, power: float, size: float) -> list[Mark]:
    """Draw Hertz's closed form K δ^power from where the smooth bodies touch: there is none below."""
    constant = data.number(tree, contact.HERTZ_CONSTANT)
    if constant is None or approach.max() <= 0:
        return []
    closed = np.linspace(0.0, approach.max(), CURVE_POINTS)
    return [Line(closed / MICRO, constant * closed**power / size, "Hertz", INK, HERTZ)]


def _datum_sensitivity(tree: DataTree) -> str:
    """What a force that is k_c = F/r times the texture owes to where r counts from."""
    load, approach, datum, samples, path = (data.number(tree, attribute) for attribute in _OF_DATUM)
    laws = data.laws(tree, rolling.CONTACT_FORCE)
    used = [law for law in laws if "datum" in data.law_entry(tree, law).needs]
    if not used or load is None or approach is None or datum is None or samples is None or path is None:
        return ""
    other, where = (path, "samples and path") if datum == samples else (samples, "the samples alone")
    states, tangents = (data.values(tree, entry) for entry in (contact.APPROACH, contact.TANGENT_STIFFNESS))
    below = 20 * np.log10(np.interp(approach, states, tangents) * (approach + datum) / load)
    change = data.signed(20 * np.log10((approach + datum) / (approach + other)))
    return (
        f"In {' and '.join(used)} k_c multiplies the texture: under the working load {below:.1f} dB below "
        f"the tangent. d₀ from {where}, {data.engineering(other, 'm')}, would change that by {change} dB."
    )


_OF_DATUM = (
    contact.WORKING_LOAD,
    contact.WORKING_APPROACH,
    contact.DATUM,
    contact.DATUM_SAMPLES,
    contact.DATUM_PATH,
)


# --- filters over the wavenumber

FLOOR = -40.0  # dB, lowest level of a drawn filter
MOST_FILTERS = 5
_THEORY: dict[str, Any] = {"width": 0.8, "dashes": (5.0, 2.5)}


def _of_states(*entries: Entry) -> tuple[Of, ...]:
    """Columns of filters, one per approach that has a filter; the first must be there."""
    name = "{approach:.9g} m)"
    return tuple(
        Of(entry, f"{entry.name}(approach={name}", "δ", optional=entry is not entries[0]) for entry in entries
    )


def _by_state(lines: Lines, entry: Entry) -> dict[float, Array]:
    return {series.places["approach"]: series.values for series in lines.of(entry)}


def _drawn_states(tree: DataTree, lines: Lines) -> list[float]:
    """Approaches whose filters are drawn: a few, evenly spread, that of the working load among them."""
    filled = np.array(list(_by_state(lines, contact.FILTER)))
    picks = np.array(chart.spread(len(filled), MOST_FILTERS))
    working = data.number(tree, contact.WORKING_APPROACH)
    if working is not None:
        at_load = int(np.argmin(np.abs(filled - working)))
        picks[np.argmin(np.abs(picks - at_load))] = at_load
    return filled[picks].tolist()


def _level(ratio: Array) -> Array:
    return 20 * np.log10(np.maximum(ratio, 10 ** (FLOOR / 20 - 1)))


@figure(
    "Contact filter",
    Of(contact.WAVENUMBER),
    *_of_states(*contact.FILTERS, contact.FILTER_SIGNED, contact.FILTER_COHERENCE, contact.FILTER_THEORY),
)
def contact_filter(tree: DataTree, lines: Lines) -> Drawn:
    """A filter as estimated (dots), as fitted (wide) and as applied (thin), and what theory says (dashed).

    Over wavenumbers above zero, shaded where the texture excites nothing.
    """
    excited = np.ones(len(lines.at), dtype=bool)
    states = _drawn_states(tree, lines)
    if data.present(tree, contact.FILTER_EXCITED):
        excited = data.values(tree, contact.FILTER_EXCITED) > 0
    theory = _by_state(lines, contact.FILTER_THEORY)
    fitted, raw, applied, spread = (_by_state(lines, entry) for entry in contact.FILTERS)
    positive = lines.at[lines.at > 0]
    ends = np.maximum(lines.at, positive[0])[panels.stretches(~excited)]
    lacking = panels.shade(ends[:, 0], ends[:, 1], chart.MUTED, opacity=0.12)
    marks: list[Mark] = [lacking] if len(ends) else []
    for state, colour in zip(states, chart.sequence(len(states)), strict=True):
        name: dict[str, Any] = {"label": f"δ = {data.plain(state * 1e6)} µm", "width": 1.7}
        found = [(fitted[state], excited, name)]
        if state in spread:
            edges = (fitted[state] - spread[state], fitted[state] + spread[state])
            low, high = (np.where(excited & (edges[0] > 0), _level(edge), np.nan) for edge in edges)
            marks.append(chart.Area(lines.at, low, high, colour=colour, opacity=0.09))
        if state in applied:
            name.update(width=4.5, opacity=0.35)
            found.append((applied[state], excited, {"width": 1.1}))
        if state in raw:
            found.append((raw[state], np.isfinite(raw[state]), {"marker": ".", "width": 0.0}))
        if state in theory:  # beyond the main lobe those of all states would cross
            found.append((theory[state], np.logical_and.accumulate(theory[state] > 0), _THEORY))
        for ratio, where, look in found:
            marks.append(Line(lines.at, np.where(where, _level(ratio), np.nan), colour=colour, **look))
    along = panels.wavenumber_axis(positive[0], positive[-1])
    yield Panel(along, Axis("|H| / dB", FLOOR, 5.0), tuple(marks), height=4.4)
    yield (
        "Contact filter per approach against the wavenumber in rolling direction, in cycles per metre; cut "
        f"off at {data.plain(FLOOR)} dB."
    )
    if raw:
        yield (
            "Dots: ratio of the scanned force to a point force on the lines (Eq. 2.6, power of all strips); "
            "wide: the fit to it; thin: what the filtered laws apply; shaded: standard deviation of strips."
        )
    if theory:
        yield (
            "Dashed: sin q / q, q = ka, the closed form of small roughness, uniform across, on Hertz's "
            "contact of radius a; it is negative beyond q = π, which a magnitude cannot show."
        )
    if not excited.all():
        yield "Grey: waves that the texture lacks, where the filter is held."
    told = {
        "tangent": "Referred to the tangent stiffness: 0 dB is a texture that the contact feels fully.",
        "low-wavenumber": "Normalised as printed: 0 dB are its own longest waves.",
    }
    yield told.get(data.variable_of(tree, contact.FILTER).attrs.get("normalise", ""), "")
