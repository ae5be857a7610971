"""Figure and table of the sound power from the vibration itself, with that of CNOSSOS-EU beside it."""

from __future__ import annotations

from typing import Any

import numpy as np
from xarray import DataTree

from asperity.reporting.axes import band_axis, doubtful_boxes, levels_axis
from asperity.reporting.chart import BLUE, GREEN, INK, MUTED, VERMILLION, Chart, Line, Panel
from asperity.reporting.data import doubtful, laws, of_law, stored_variable, values
from asperity.reporting.force_figures import doubtful_words, product_series
from asperity.reporting.part import Data, Part, Series, series
from asperity.reporting.tables import Cell, ReportTable, signed, text_cell
from asperity.scenes import schema
from asperity.scenes.figures.noise import sources, told_level
from asperity.schema.spectra import BAND, BAND_TIME_PRODUCT
from asperity.spectra import a_weighting, energy_sum

POWER, POWER_A = schema.RADIATED_POWER_LEVEL, schema.RADIATED_POWER_LEVEL_A
STANDARD, STANDARD_A = schema.SOUND_POWER_LEVEL, schema.SOUND_POWER_LEVEL_A
_LOOKS: dict[str, Any] = {
    "rail": {"colour": VERMILLION, "marker": "o"},
    "sleepers": {"colour": GREEN, "marker": "s"},
    "wheel": {"colour": BLUE, "marker": "^"},
    "total": {"colour": INK, "width": 1.8},
}
_STANDARD_LOOKS: dict[str, Any] = {
    "track": {"dashes": (1.5, 1.5)},
    "wheel": {"dashes": (6, 1.5, 1.5, 1.5)},
    "total": {"dashes": (5, 2), "width": 1.6},
}
_COMPUTED = "computed"


def radiators(tree: DataTree) -> list[str]:
    """What radiates, as ``["rail", "sleepers", "wheel", "total"]``; nothing without the levels."""
    found = stored_variable(tree, POWER)
    return [] if found is None else [str(name) for name in found["radiator"].values]


def silence(tree: DataTree) -> str:
    """Say why the wheel's part is missing; nothing where it is there."""
    found = stored_variable(tree, POWER)
    reason = _COMPUTED if found is None else str(found.attrs.get("wheel", _COMPUTED))
    if reason == _COMPUTED:
        return ""
    return f"The wheel's part is missing, and the total is that of rail and sleepers: {reason}."


def radiated_data(tree: DataTree) -> Data:
    """Sound power per band, law and radiator, unweighted, the A-weighting, and what CNOSSOS-EU has there."""
    band = series(tree, BAND, "band centre")
    lines: dict[Any, Series] = {"A": Series("A-weighting", "dB", a_weighting(band.values))}
    lines |= product_series(tree, BAND_TIME_PRODUCT)
    for law in laws(tree, POWER):
        rows = of_law(tree, POWER, law, "radiator", "band")
        for name, row in zip(radiators(tree), rows, strict=True):
            if np.isfinite(row).any():
                lines[law, name] = Series(f"{name}, {law}", POWER.units, row)
    for law in laws(tree, STANDARD):
        rows = of_law(tree, STANDARD, law, "source", "noise_band")
        at = np.abs(band.values[:, None] / values(tree, schema.NOISE_BAND) - 1.0) < 0.01
        for name, row in zip(sources(tree, STANDARD), rows, strict=True):
            found = np.where(at.any(axis=1), row[at.argmax(axis=1)], np.nan)
            if np.isfinite(found).any():
                lines["standard", law, name] = Series(f"{name} by CNOSSOS-EU, {law}", STANDARD.units, found)
    return Data(band, lines)


def radiated_chart(tree: DataTree, data: Data) -> Chart:
    """A-weighted sound power of the main law per one-third octave, by what radiates, beside CNOSSOS-EU."""
    main, weighting = laws(tree, POWER)[0], data.lines["A"].values
    lines = [
        Line(data.at, data.lines[main, name].values + weighting, name, **_LOOKS.get(name, {}))
        for name in radiators(tree)
        if (main, name) in data.lines
    ]
    for name, look in _STANDARD_LOOKS.items():
        if ("standard", main, name) in data.lines:
            level = data.lines["standard", main, name].values + weighting
            lines.append(Line(data.at, level, f"{name}, CNOSSOS-EU", MUTED, **look))
    axis = levels_axis("sound power level / dB(A) re 1 pW", [line.y for line in lines], span=60.0)
    marks = (*doubtful_boxes(data.at, doubtful(tree, BAND_TIME_PRODUCT)), *lines)
    return Chart((Panel(band_axis(data.at), axis, marks, height=4.4),))


def _caption(tree: DataTree) -> str:
    main = laws(tree, POWER)[0]
    told = [
        f"A-weighted one-third octaves of {main}, vertical motion: the contact force on two rails moves them "
        "and their sleepers along the whole track, and each part radiates by its radiation ratio.",
        silence(tree),
    ]
    if laws(tree, STANDARD):
        told.append(
            "Grey: the same force by CNOSSOS-EU, of a track and a wheel that it knows by a label; its "
            "transfer functions hold lateral motion of the rail, and wheels that resonate."
        )
    return " ".join(filter(None, told)) + doubtful_words(tree, BAND_TIME_PRODUCT)


def radiated_table(tree: DataTree) -> ReportTable | None:
    """A-weighted sound power per law and radiator."""
    names, parts = laws(tree, POWER_A), radiators(tree)
    if not names:
        return None
    rows = [
        [
            text_cell(law),
            *(Cell(told_level(value), "number") for value in of_law(tree, POWER_A, law, "radiator")),
        ]
        for law in names
    ]
    note = (
        f"dB(A) re 1 pW, over the bands that were computed. {_over_standard(tree, names[0])}{silence(tree)}"
    )
    title = "Sound power from vibration, A-weighted"
    return ReportTable("radiated_power_table", title, ["law", *parts], rows, note)


def _over_standard(tree: DataTree, law: str) -> str:
    """Say how far rail and sleepers are from the track of CNOSSOS-EU, which is both; a blank comes last."""
    parts, standard = radiators(tree), sources(tree, STANDARD_A)
    if law not in laws(tree, STANDARD_A) or not {"rail", "sleepers"} <= set(parts) or "track" not in standard:
        return ""
    level = of_law(tree, POWER_A, law, "radiator")
    both = float(energy_sum([level[parts.index(part)] for part in ("rail", "sleepers")]))
    track = of_law(tree, STANDARD_A, law, "source")[standard.index("track")]
    return f"Rail and sleepers together are {signed(both - track)} dB over the track of CNOSSOS-EU ({law}). "


RADIATED = Part(
    "radiated_power_bands",
    "Sound power from vibration in one-third octaves",
    (POWER, BAND),
    radiated_data,
    radiated_chart,
    _caption,
)
