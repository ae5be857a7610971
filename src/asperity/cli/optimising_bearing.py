"""Waves of a bearing that were found: their table, their page, and what is said of them to programs."""

from typing import Any

import numpy as np

from asperity.cli.optimising import ToldOptimisation
from asperity.optimising.bearing import JUDGED, OptimisedBearing
from asperity.reporting import chart, panels
from asperity.reporting.chart import Axis, Drawn, Line, Panel
from asperity.reporting.figure import PageFigure
from asperity.reporting.tables import ReportTable, number_cells, table, text_cells
from asperity.scenarios.prepared_bearing import ON

LOOKS = {"inner_raceway": chart.VERMILLION, "outer_raceway": chart.BLUE, "balls": chart.GREEN}
"""Colours of the parts."""
HEADS = (
    "part",
    "fewest waves per turn",
    "most waves per turn",
    "rms before [um]",
    "rms after [um]",
    "change [dB]",
    *(f"alone before, {low:g} to {high:g} Hz [um/s]" for _, (low, high) in JUDGED),
)


def told_bearing(found: OptimisedBearing) -> ToldOptimisation:
    """What is said of waves that were found: on the page velocities before and after, and the waves."""
    figure = PageFigure.of("bands", "Waves of the parts", _waves(found))
    blocks = (_velocities(found), figure, _bands(found))
    return ToldOptimisation(_document(found), _rows(found), "Optimised bearing", blocks)


def _rows(found: OptimisedBearing) -> list[list[Any]]:
    """A row of the table for each band that was changed; roughness has no waves per turn."""
    rows = list[list[Any]]()
    for band, change, alone in zip(found.bands, found.changes.tolist(), found.alone.tolist(), strict=True):
        rms = 1e6 * band.rms
        fewest = min(band.orders) if band.orders else ""
        most = max(band.orders) if band.orders else ""
        heard = [1e6 * each for each in alone]
        rows.append([band.part, fewest, most, rms, rms * 10.0 ** (change / 20.0), change, *heard])
    return rows


def _document(found: OptimisedBearing) -> dict[str, Any]:
    """What came of it, for programs."""

    def heard(*, after: bool) -> dict[str, list[float]]:
        return {law: found.velocities(after=after, law=law).tolist() for law in found.laws}

    return {
        "quantity": "rms radial velocity in the bands of ISO 15242",
        "units": "m/s",
        "velocities_before": heard(after=False),
        "velocities_after": heard(after=True),
        "missed": {law: over.tolist() for law, over in found.missed.items()},
        "floor": found.floor.tolist(),
        "limits": [limit if np.isfinite(limit) else None for limit in found.aim.limits.tolist()],
        "price": found.price,
        "columns": list(HEADS),
    }


def _velocities(found: OptimisedBearing) -> ReportTable:
    """Velocities in bands before and after, by law, with limit and floor."""
    bands = [f"{low:g} to {high:g} Hz" for _, (low, high) in JUDGED]
    columns = {"band": text_cells(bands, "name")}
    limits = np.where(np.isfinite(found.aim.limits), found.aim.limits, np.nan)
    columns["limit / µm/s"] = number_cells(1e6 * limits, "{:.3g}")
    for law in found.laws:
        for words, after in (("before", False), ("after", True)):
            heard = 1e6 * found.velocities(after=after, law=law)
            columns[f"{law}, {words} / µm/s"] = number_cells(heard, "{:.3g}")
    columns["without waves / µm/s"] = number_cells(1e6 * found.floor, "{:.3g}")
    note = (
        "Rms over the sensors; what is left without the waves that were changed is by the law of the search."
    )
    return table("velocities", "Radial velocity in the bands of ISO 15242", columns, note)


def _bands(found: OptimisedBearing) -> ReportTable:
    """Each band that was changed, and what it makes alone."""
    columns = {
        "band": text_cells([band.name for band in found.bands], "name"),
        "rms before / nm": number_cells([1e9 * band.rms for band in found.bands], "{:.3g}"),
        "change / dB": number_cells(found.changes, "{:+.1f}"),
    }
    for (_, (low, high)), alone in zip(JUDGED, found.alone.T, strict=True):
        columns[f"{low:g} to {high:g} Hz"] = number_cells(1e6 * alone, "{:.3g}")
    return table("alone", "What may be changed, and the velocity that it makes alone before, µm/s", columns)


def _waves(found: OptimisedBearing) -> Drawn:
    """Rms of each third octave of waves per turn before and after, a colour for each part."""
    lines = list[Line]()
    every = list[float]()
    for part, colour in LOOKS.items():
        chosen = [number for number, band in enumerate(found.bands) if band.part == part and band.orders]
        if not chosen:
            continue
        middle = np.array([np.sqrt(found.bands[n].orders[0] * found.bands[n].orders[-1]) for n in chosen])
        rms = np.array([1e9 * found.bands[n].rms for n in chosen])
        every += middle.tolist()
        name = ON[part].removeprefix("the ")
        for words, dashes, change in (("before", (1.5, 1.5), 0.0), ("after", (), found.changes[chosen])):
            level = rms * 10.0 ** (change / 20.0)
            lines.append(Line(middle, level, f"{name}, {words}", colour, dashes, marker="o"))
    if lines:
        low = min(every) / panels.EDGE
        high = max(every) * panels.EDGE
        along = Axis("waves per turn", low, high, log=True)
        yield Panel(along, Axis("rms of the third octave / nm", log=True), tuple(lines), height=3.2)
    yield "Dotted the waves of the case, drawn through those found."
