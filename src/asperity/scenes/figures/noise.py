"""Figures of rolling noise: sound power per one-third octave and A-weighted, per law."""

from __future__ import annotations

from dataclasses import replace
from itertools import cycle
from typing import Any

import numpy as np
from numpy.typing import NDArray
from xarray import DataTree

from asperity.reporting.axes import band_axis, doubtful_boxes, levels_axis, words_axis
from asperity.reporting.chart import HATCHES, INK, MUTED, Axis, Boxes, Chart, Dashes, Line, Note, Panel
from asperity.reporting.data import doubtful, laws, of_law, stored_variable
from asperity.reporting.force_figures import doubtful_words, main_last, product_series
from asperity.reporting.law_entries import baselines_among, law_entry, law_style
from asperity.reporting.part import Data, Part, Series, series
from asperity.reporting.tables import Cell, ReportTable, signed, text_cell
from asperity.scenes import schema
from asperity.schema import Entry
from asperity.spectra import a_weighting

POWER, POWER_A, BAND = schema.SOUND_POWER_LEVEL, schema.SOUND_POWER_LEVEL_A, schema.NOISE_BAND
PRODUCT = schema.NOISE_BAND_TIME_PRODUCT
_SHARES: dict[str, Dashes] = {"track": (1.5, 1.5), "wheel": (6, 1.5, 1.5, 1.5)}


def sources(tree: DataTree, entry: Entry) -> list[str]:
    """Sources of the levels of an entry, as ``["track", "wheel", "total"]``."""
    found = stored_variable(tree, entry)
    return [] if found is None else [str(name) for name in found["source"].values]


def _share_law(tree: DataTree) -> str:
    """Law of which the shares of track and wheel are drawn: that of the bare roughness."""
    found = stored_variable(tree, POWER)
    assert found is not None
    return str(found.attrs.get("reference") or laws(tree, POWER)[0])


def sound_power_data(tree: DataTree) -> Data:
    """Sound power per band, law and source, unweighted, beside the A-weighting."""
    band = series(tree, BAND, "band centre")
    lines: dict[Any, Series] = {"A": Series("A-weighting", "dB", a_weighting(band.values))}
    lines |= product_series(tree, PRODUCT)
    for law in laws(tree, POWER):
        rows = of_law(tree, POWER, law, "source", "noise_band")
        for source, row in zip(sources(tree, POWER), rows, strict=True):
            lines[law, source] = Series(f"{source}, {law}", POWER.units, row)
    return Data(band, lines)


def sound_power_chart(tree: DataTree, data: Data) -> Chart:
    """A-weighted sound power per one-third octave: the total by each law, track and wheel of linear."""
    names, found, bands = laws(tree, POWER), sources(tree, POWER), data.at
    whole, weighting = "total" if "total" in found else found[-1], data.lines["A"].values
    lines = [
        Line(
            bands, data.lines[law, whole].values + weighting, f"{whole}, {law}",
            marker=law_entry(tree, law).marker, **law_style(tree, law, names[0]),
        )
        for law in main_last(names)
    ]  # fmt: skip
    axis = levels_axis("sound power level / dB(A) re 1 pW", [line.y for line in lines], span=60.0)
    share = _share_law(tree)
    for source, dashes in _SHARES.items():
        if (share, source) in data.lines:
            level = data.lines[share, source].values + weighting
            lines.append(Line(bands, level, f"{source}, {share}", MUTED, dashes, 1.2))
    marks = (*doubtful_boxes(bands, doubtful(tree, PRODUCT)), *lines)
    return Chart((Panel(band_axis(bands), axis, marks, height=4.4),))


def _band_caption(tree: DataTree) -> str:
    share = _share_law(tree)
    return (
        "A-weighted one-third octaves. The linear law: the roughness that was rolled and the transfer "
        "functions of CNOSSOS-EU, without its contact filter, for a linear contact follows the bare texture. "
        "The other laws add their difference of the contact force level to linear, band by band, which holds "
        "what the contact filters. "
        f"Grey: the shares of track and wheel by {share}.{doubtful_words(tree, PRODUCT)}"
    )


def total_data(tree: DataTree) -> Data:
    """A-weighted sound power: one row, one column per source and law."""
    lines: dict[Any, Series] = {}
    for law in laws(tree, POWER_A):
        levels = of_law(tree, POWER_A, law, "source")
        for source, level in zip(sources(tree, POWER_A), levels, strict=True):
            lines[law, source] = Series(f"{source}, {law}", POWER_A.units, np.array([level]))
    return Data(None, lines)


def total_chart(tree: DataTree, data: Data) -> Chart:
    """A-weighted sound power as bars, by source and law."""
    names, found = laws(tree, POWER_A), sources(tree, POWER_A)
    levels = np.array([[data.lines[law, source].values[0] for source in found] for law in names])
    lowest, top = float(np.nanmin(levels)), float(np.nanmax(levels))
    base = 5 * np.floor((lowest - 5) / 5)
    thickness = 0.82 / len(names)
    marks: list[Boxes | Note] = []
    for row, (law, level, hatch) in enumerate(zip(names, levels, cycle(HATCHES), strict=False)):
        known = np.isfinite(level)
        at = (np.arange(len(found)) + (row - (len(names) - 1) / 2) * thickness)[known]
        edges = np.full(len(at), base), level[known], at - 0.43 * thickness, at + 0.43 * thickness
        marks.append(Boxes(*edges, law, law_entry(tree, law).colour, hatch=hatch, law=law))
        marks += [
            Note(f"{y:.1f}", y, x, colour=INK, law=law)
            for x, y in zip(at.tolist(), level[known].tolist(), strict=True)
        ]
    across = words_axis(found)
    downwards = replace(across, low=across.high, high=across.low)
    along = Axis("A-weighted sound power level / dB(A) re 1 pW", base, top + 0.07 * (top - base))
    height = 0.7 + len(found) * (0.3 + 0.2 * len(names))
    return Chart((Panel(along, downwards, tuple(marks), height=height),))


def sound_power_table(tree: DataTree) -> ReportTable | None:
    """A-weighted sound power per law and source, and of all together its differences to the linear laws."""
    names, radiating = laws(tree, POWER_A), sources(tree, POWER_A)
    if not names:
        return None
    levels = {law: of_law(tree, POWER_A, law, "source") for law in names}
    compared = baselines_among(tree, names)
    whole = radiating.index("total") if "total" in radiating else -1

    def row(label: str, level: NDArray[np.float64]) -> list[Cell]:
        cells = [text_cell(label), *(Cell(told_level(value), "number") for value in level)]
        changes = (level[whole] - levels[name][whole] for name in compared)
        told = ("–" if label == name else signed(d) for name, d in zip(compared, changes, strict=True))
        return [*cells, *(Cell(text, "number") for text in told)]

    rows = [row(law, level) for law, level in levels.items()]
    note = (
        f"dB(A) re 1 pW, over the bands that were computed; differences of the {radiating[whole]}. Positive: "
        "linear contact underestimates."
    )
    standard = stored_variable(tree, schema.CNOSSOS_SOUND_POWER_LEVEL_A)
    if standard is not None:
        rows.append(row("CNOSSOS-EU", standard.sel(source=radiating).values))
        name = standard.attrs.get("contact_filter", "")
        note += f" Last row: the same roughness with the contact filter of CNOSSOS-EU itself ({name})."
    head = ["law", *radiating, *(f"over {name}" for name in compared)]
    return ReportTable("sound_power_table", "Sound power by CNOSSOS-EU, A-weighted", head, rows, note)


def told_level(value: float) -> str:
    """Write a level for a table."""
    return f"{value:.1f}" if np.isfinite(value) else "–"


NOISE = (
    Part(
        "sound_power",
        "A-weighted sound power by CNOSSOS-EU",
        (POWER_A,),
        total_data,
        total_chart,
        lambda _: (
            "Sum of the A-weighted bands below. The axis does not start at zero: compare the ends of the "
            "bars, not their lengths."
        ),
    ),
    Part(
        "sound_power_bands",
        "Sound power by CNOSSOS-EU in one-third octaves",
        (POWER, BAND),
        sound_power_data,
        sound_power_chart,
        _band_caption,
    ),
)
