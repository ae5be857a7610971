"""Figures of the contact filters: as estimated, as fitted and as applied, beside theory."""

from __future__ import annotations

from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import NDArray
from xarray import DataTree

from asperity.reporting.data import number, plain, present, values, variable
from asperity.reporting.part import Columns, Part
from asperity.reporting.style import INK, MUTED, new_figure, sequence, styled, wavenumber_axis

FLOOR = -40.0  # dB, lowest level of a drawn filter
MOST_FILTERS, MOST_PRINTED = 5, 3
LEAST_COHERENCE = 0.25  # of a signed estimate that is drawn in full
_DOT = 1.006  # length of a line that is drawn as a dot, as a ratio of wavenumbers
_RAW: dict[str, Any] = {"linewidth": 2.0, "solid_capstyle": "round", "snap": False}
_APPLIED: dict[str, Any] = {"linewidth": 1.1}
_THEORY: dict[str, Any] = {"linewidth": 0.8, "linestyle": (0, (4, 2))}


def _drawn_filters(tree: DataTree, path: str, most: int = MOST_FILTERS) -> list[int]:
    """States whose filters are drawn: a few, evenly spread, that of the working load among them."""
    rows = values(tree, path, "approach", "wavenumber")
    filled = np.flatnonzero(np.isfinite(rows).any(axis=1))
    picks = np.linspace(0, len(filled) - 1, min(most, len(filled))).round().astype(int)
    working = number(tree, "contact", "working_approach")
    if working is not None:
        at_load = int(np.argmin(np.abs(values(tree, "contact/approach")[filled] - working)))
        picks[np.argmin(np.abs(picks - at_load))] = at_load
    return filled[picks].tolist()


@styled()
def filter_figure(tree: DataTree) -> Figure:
    """Contact filters of several approaches: magnitude, and below it the signed estimate."""
    signed = present(tree, "contact/filter_signed")
    figure = new_figure(7.4 if signed else 4.4)
    panels = figure.subplots(2 if signed else 1, 1, squeeze=False, height_ratios=(3, 2)[: 1 + signed])[:, 0]
    _magnitudes(panels[0], tree, "filter")
    if signed:
        _signed(panels[1], tree, _drawn_filters(tree, "contact/filter"))
        panels[0].set_xlabel("")  # the panels share their axes: name each quantity once
        figure.axes[-1].set_xlabel("")
    return figure


@styled()
def printed_filter_figure(tree: DataTree) -> Figure:
    """The same filters, normalised as printed."""
    figure = new_figure(4.4)
    _magnitudes(figure.subplots(), tree, "printed_filter")
    return figure


def _magnitudes(axes: Axes, tree: DataTree, name: str) -> None:
    """A filter as estimated (dots), as fitted (wide) and as applied (thin), and what theory says (dashed)."""
    wavenumber, approach = values(tree, "contact/wavenumber"), values(tree, "contact/approach")
    excited, theory = _excited(tree), _theory(tree)
    fitted, raw, applied, spread = (
        values(tree, f"contact/{name}{end}", "approach", "wavenumber")
        if present(tree, f"contact/{name}{end}")
        else None
        for end in ("", "_raw", "_applied", "_std")
    )
    assert fitted is not None
    rows = _drawn_filters(tree, f"contact/{name}", MOST_FILTERS if name == "filter" else MOST_PRINTED)
    for row, colour in zip(rows, sequence(len(rows)), strict=True):
        level = np.where(excited, _level(fitted[row]), np.nan)
        label = f"δ = {plain(approach[row] * 1e6)} µm"
        if applied is None:
            axes.plot(wavenumber, level, color=colour, label=label, linewidth=1.7)
        else:
            axes.plot(wavenumber, level, color=colour, label=label, linewidth=4.5, alpha=0.35)
            axes.plot(wavenumber, np.where(excited, _level(applied[row]), np.nan), color=colour, **_APPLIED)
        if raw is not None:
            axes.plot(*_dots(wavenumber, _level(raw[row])), color=colour, **_RAW)
        if spread is not None:
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
        if found is not None:
            axes.plot([], [], color=INK, label=label, **style)
    axes.legend(loc="lower left", ncols=2)
    _over_wavenumbers(axes, wavenumber, excited)


def _dots(x: NDArray[np.float64], y: NDArray[np.float64]) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Dots as one broken line, a tenth of the size of as many markers."""
    gap = np.full(x.shape, np.nan)
    return np.stack([x / _DOT, x * _DOT, gap], axis=1).ravel(), np.stack([y, y, gap], axis=1).ravel()


def _signed(axes: Axes, tree: DataTree, rows: list[int]) -> None:
    """The signed estimate, faint where it explains little of the force."""
    wavenumber, excited, theory = values(tree, "contact/wavenumber"), _excited(tree), _theory(tree)
    estimate = values(tree, "contact/filter_signed", "approach", "wavenumber")
    coherence = (
        values(tree, "contact/filter_coherence", "approach", "wavenumber")
        if present(tree, "contact/filter_coherence")
        else np.ones(estimate.shape)
    )
    for row, colour in zip(rows, sequence(len(rows)), strict=True):
        known = excited & (coherence[row] >= LEAST_COHERENCE)
        axes.plot(
            wavenumber, np.where(excited, estimate[row], np.nan), color=colour, linewidth=0.8, alpha=0.4
        )
        axes.plot(wavenumber, np.where(known, estimate[row], np.nan), color=colour, linewidth=1.7)
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
    if not present(tree, "contact/filter_excited"):
        return np.ones(len(values(tree, "contact/wavenumber")), dtype=bool)
    return values(tree, "contact/filter_excited", "wavenumber") > 0


def _theory(tree: DataTree) -> NDArray[np.float64] | None:
    path = "contact/filter_theory"
    return values(tree, path, "approach", "wavenumber") if present(tree, path) else None


def _level(ratio: NDArray[np.float64]) -> NDArray[np.float64]:
    return 20 * np.log10(np.maximum(ratio, 10 ** (FLOOR / 20 - 1)))


_FILTER = ("filter", "filter_raw", "filter_applied", "filter_std")


def filter_columns(tree: DataTree) -> Columns:
    """Filters against wavenumber, one group of columns per approach."""
    return _filter_columns(tree, (*_FILTER, "filter_signed", "filter_coherence", "filter_theory"))


def printed_filter_columns(tree: DataTree) -> Columns:
    """Filters as printed against wavenumber, one group of columns per approach."""
    return _filter_columns(tree, tuple(f"printed_{name}" for name in _FILTER))


def _filter_columns(tree: DataTree, names: tuple[str, ...]) -> Columns:
    columns: Columns = {"wavenumber [1/m]": values(tree, "contact/wavenumber")}
    approach = values(tree, "contact/approach")
    for name in names:
        if not present(tree, f"contact/{name}"):
            continue
        rows = values(tree, f"contact/{name}", "approach", "wavenumber")
        for row in np.flatnonzero(np.isfinite(rows).any(axis=1)):
            columns[f"{name}(approach={approach[row]:.9g} m) [1]"] = rows[row]
    return columns


def _filter_caption(tree: DataTree) -> str:
    parts = [
        "Contact filter per approach against the wavenumber in rolling direction (cycles per metre), "
        f"wavelength along the top; cut off at {plain(FLOOR)} dB"
    ]
    if present(tree, "contact/filter_raw"):
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
    if present(tree, "contact/filter_signed"):
        parts.append(
            "signed: the force regressed on the mean line under the patch, faint where the two have less "
            f"than {100 * LEAST_COHERENCE:.0f} % of their power in common"
        )
    if not _excited(tree).all():
        parts.append("grey: waves that the texture lacks, where the filter is held")
    normalise = tree["contact"].attrs.get("normalise")
    return "; ".join(parts) + "." + (f" {_NORMALISED[normalise]}" if normalise in _NORMALISED else "")


_NORMALISED = {
    "tangent": "Referred to the tangent stiffness: 0 dB is a texture that the contact feels fully.",
    "low-wavenumber": "Normalised as printed: 0 dB are its own longest waves.",
}


def _printed_filter_caption(tree: DataTree) -> str:
    scale = variable(tree, "contact/filter_scale")
    found = ""
    if scale is not None:
        low, high = float(np.nanmin(scale.values)), float(np.nanmax(scale.values))
        found = f" k_0/k_t = {plain(low, 2)} to {plain(high, 2)}: what the patch averages across is left out."
    return (
        f"The filter of `printed`: as above, but {_NORMALISED['low-wavenumber'][0].lower()}"
        f"{_NORMALISED['low-wavenumber'][1:]}{found}"
    )


FILTER = (
    Part(
        "contact_filter",
        "Contact filter",
        ("contact/filter", "contact/wavenumber", "contact/approach"),
        filter_figure,
        filter_columns,
        _filter_caption,
    ),
    Part(
        "contact_filter_printed",
        "Contact filter as printed",
        ("contact/printed_filter", "contact/wavenumber", "contact/approach"),
        printed_filter_figure,
        printed_filter_columns,
        _printed_filter_caption,
    ),
)
