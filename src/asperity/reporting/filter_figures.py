"""Figures of the contact filters: as estimated, as fitted and as applied, beside theory."""

from __future__ import annotations

from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import NDArray
from xarray import DataTree

from asperity.reporting.data import number, plain, present, stored_variable, values
from asperity.reporting.part import Data, Part, Series, series
from asperity.reporting.style import INK, MUTED, new_figure, sequence, styled, wavenumber_axis
from asperity.schema import Entry, contact

FLOOR = -40.0  # dB, lowest level of a drawn filter
MOST_FILTERS, MOST_PRINTED = 5, 3
LEAST_COHERENCE = 0.25  # of a signed estimate that is drawn in full
_DOT = 1.006  # length of a line that is drawn as a dot, as a ratio of wavenumbers
_RAW: dict[str, Any] = {"linewidth": 2.0, "solid_capstyle": "round", "snap": False}
_APPLIED: dict[str, Any] = {"linewidth": 1.1}
_THEORY: dict[str, Any] = {"linewidth": 0.8, "linestyle": (0, (4, 2))}


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


@styled()
def filter_figure(tree: DataTree, data: Data) -> Figure:
    """Contact filters of several approaches: magnitude, and below it the signed estimate."""
    signed = present(tree, contact.FILTER_SIGNED)
    rows = _drawn_filters(tree, data, contact.FILTER)
    figure = new_figure(7.4 if signed else 4.4)
    panels = figure.subplots(2 if signed else 1, 1, squeeze=False, height_ratios=(3, 2)[: 1 + signed])[:, 0]
    _magnitudes(panels[0], tree, data, contact.FILTERS, rows)
    if signed:
        _signed(panels[1], tree, data, rows)
        panels[0].set_xlabel("")  # the panels share their axes: name each quantity once
        figure.axes[-1].set_xlabel("")
    return figure


@styled()
def printed_filter_figure(tree: DataTree, data: Data) -> Figure:
    """The same filters, normalised as printed."""
    figure = new_figure(4.4)
    rows = _drawn_filters(tree, data, contact.PRINTED_FILTER, MOST_PRINTED)
    _magnitudes(figure.subplots(), tree, data, contact.PRINTED_FILTERS, rows)
    return figure


def _magnitudes(axes: Axes, tree: DataTree, data: Data, entries: tuple[Entry, ...], rows: list[int]) -> None:
    """A filter as estimated (dots), as fitted (wide) and as applied (thin), and what theory says (dashed)."""
    wavenumber, approach, excited = data.at, values(tree, contact.APPROACH), _excited(tree)
    fitted, raw, applied, spread = (data.of(entry) for entry in entries)
    theory = _theory(tree)
    for row, colour in zip(rows, sequence(len(rows)), strict=True):
        level = np.where(excited, _level(fitted[row]), np.nan)
        label = f"δ = {plain(approach[row] * 1e6)} µm"
        if row not in applied:
            axes.plot(wavenumber, level, color=colour, label=label, linewidth=1.7)
        else:
            axes.plot(wavenumber, level, color=colour, label=label, linewidth=4.5, alpha=0.35)
            axes.plot(wavenumber, np.where(excited, _level(applied[row]), np.nan), color=colour, **_APPLIED)
        if row in raw:
            axes.plot(*_dots(wavenumber, _level(raw[row])), color=colour, **_RAW)
        if row in spread:
            edges = (_level(fitted[row] - spread[row]), _level(fitted[row] + spread[row]))
            clear = excited & (fitted[row] > spread[row])
            axes.fill_between(wavenumber, *edges, where=clear, color=colour, alpha=0.09, linewidth=0)
        if theory is not None:
            lobe = np.logical_and.accumulate(theory[row] > 0)  # beyond it the lobes of all states would cross
            main_lobe = np.where(lobe, _level(theory[row]), np.nan)
            axes.plot(wavenumber, main_lobe, color=colour, **_THEORY)
    axes.set_ylim(FLOOR, 5)
    axes.set_ylabel("|H| / dB")
    axes.set_title("magnitude")
    kinds = (
        (raw, "ratio", {"linestyle": "", "marker": "."}),
        (applied, "applied", _APPLIED),
        (theory, "sin q / q", _THEORY),
    )
    for found, label, style in kinds:
        if found is not None and len(found):
            axes.plot([], [], color=INK, label=label, **style)
    axes.legend(loc="lower left", ncols=2)
    _over_wavenumbers(axes, wavenumber, excited)


def _dots(x: NDArray[np.float64], y: NDArray[np.float64]) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Dots as one broken line, a tenth of the size of as many markers."""
    gap = np.full(x.shape, np.nan)
    return np.stack([x / _DOT, x * _DOT, gap], axis=1).ravel(), np.stack([y, y, gap], axis=1).ravel()


def _signed(axes: Axes, tree: DataTree, data: Data, rows: list[int]) -> None:
    """The signed estimate, faint where it explains little of the force."""
    wavenumber, excited, theory = data.at, _excited(tree), _theory(tree)
    estimate, coherence = (data.of(entry) for entry in (contact.FILTER_SIGNED, contact.FILTER_COHERENCE))
    for row, colour in zip(rows, sequence(len(rows)), strict=True):
        signed = estimate.get(row, np.full(len(wavenumber), np.nan))
        known = excited & (coherence.get(row, np.ones(len(wavenumber))) >= LEAST_COHERENCE)
        axes.plot(wavenumber, np.where(excited, signed, np.nan), color=colour, linewidth=0.8, alpha=0.4)
        axes.plot(wavenumber, np.where(known, signed, np.nan), color=colour, linewidth=1.7)
        if theory is not None:
            axes.plot(wavenumber, theory[row], color=colour, **_THEORY)
    axes.axhline(0, color=MUTED, linewidth=0.8)
    axes.set_ylim(-0.5, 1.15)
    axes.set_ylabel("H (signed)")
    axes.set_title("signed estimate" + ("; dashed: sin q / q" if theory is not None else ""))
    _over_wavenumbers(axes, wavenumber, excited)


def _over_wavenumbers(axes: Axes, wavenumber: NDArray[np.float64], excited: NDArray[np.bool_]) -> None:
    positive = wavenumber[wavenumber > 0]
    wavenumber_axis(axes, positive[0], positive[-1])
    axes.fill_between(
        wavenumber,
        0,
        1,
        where=~excited,
        transform=axes.get_xaxis_transform(),
        color=MUTED,
        alpha=0.12,
        linewidth=0,
    )


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
        "Contact filter per approach against the wavenumber in rolling direction (cycles per metre), "
        f"wavelength along the top; cut off at {plain(FLOOR)} dB"
    ]
    if present(tree, contact.FILTER_RAW):
        parts.append(
            "dots: ratio of the scanned force to a point force on the lines (Eq. 2.6, power of all strips); "
            "wide: the fit to it; thin: what the taps of the filtered laws apply; shaded: standard deviation "
            "of the strips"
        )
    if _theory(tree) is not None:
        parts.append(
            "dashed: sin q / q, q = ka, the closed form of small roughness, uniform across, on Hertz's "
            "contact of radius a; it is negative beyond q = π, which a magnitude cannot show"
        )
    if present(tree, contact.FILTER_SIGNED):
        parts.append(
            "signed: the force regressed on the mean line under the patch, faint where the two have less "
            f"than {100 * LEAST_COHERENCE:.0f} % of their power in common"
        )
    if not _excited(tree).all():
        parts.append("grey: waves that the texture lacks, where the filter is held")
    return f"{'; '.join(parts)}. {_normalised(tree, contact.FILTER)}".strip()


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
        filter_figure,
        _filter_caption,
    ),
    Part(
        "contact_filter_printed",
        "Contact filter as printed",
        (contact.PRINTED_FILTER, contact.WAVENUMBER, contact.APPROACH),
        printed_filter_data,
        printed_filter_figure,
        _printed_filter_caption,
    ),
)
