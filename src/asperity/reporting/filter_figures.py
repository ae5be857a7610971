"""Figures of the contact filters: as estimated, as fitted and as applied, beside theory."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray
from xarray import DataTree

from asperity.reporting.axes import shade, stretches, wavenumber_axis
from asperity.reporting.chart import Area, Axis, Chart, Line, Mark, Panel, Rules
from asperity.reporting.data import number, plain, present, stored_variable, values
from asperity.reporting.part import Data, Part, Series, series
from asperity.reporting.style import MUTED, sequence
from asperity.schema import Entry, contact

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
