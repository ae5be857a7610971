"""What the report of a ball, or of bodies, says first: how what they roll over vibrates."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from xarray import DataTree

from asperity.reporting.data import engineering, laws, of_law, present, stored_variable, values
from asperity.reporting.headline import Answers, HeadlineNumber, deciding_bands
from asperity.reporting.tables import Cell, ReportTable, text_cell
from asperity.scenes.schema import ACCELERATION, ACCELERATION_LEVEL
from asperity.schema.spectra import BAND
from asperity.spectra import a_weighting, energy_sum

MOST_SENSORS = 6
"""That are listed."""


def acceleration_answers(tree: DataTree) -> Answers | None:
    """Acceleration at the sensors by the main law: rms, A-weighted level, and the bands that hold it."""
    if not present(tree, ACCELERATION, ACCELERATION_LEVEL, BAND):
        return None
    main = laws(tree, ACCELERATION)[0]
    if main not in laws(tree, ACCELERATION_LEVEL):
        return None
    rms = np.sqrt(np.nanmean(of_law(tree, ACCELERATION, main, "sensor", "time") ** 2, axis=1))
    levels, bands = of_law(tree, ACCELERATION_LEVEL, main, "sensor", "band"), values(tree, BAND)
    weighted = np.array([_weighted(bands, level) for level in levels])
    places = [f"x = {place:g} m" for place in _places(tree)]
    most = int(np.nanargmax(rms))
    lead = (
        f"The structure vibrates most at {places[most]}: {engineering(rms[most], 'm/s²')} rms, half of "
        f"its energy in the bands of {deciding_bands(bands, levels[most])}."
    )
    note = f"{weighted[most]:.1f} dB(A) re 1 µm/s², at {places[most]}, the most of {len(places)} sensors"
    largest = HeadlineNumber("vibration, rms", engineering(rms[most], "m/s²"), note)
    return Answers(lead, numbers=(largest,), tables=(_table(places, rms, weighted),))


def _places(tree: DataTree) -> list[float]:
    found = stored_variable(tree, ACCELERATION)
    assert found is not None
    return [float(place) for place in found["sensor"].values]


def _weighted(bands: NDArray[np.float64], level: NDArray[np.float64]) -> float:
    known = np.isfinite(level)
    return float(energy_sum(level[known] + a_weighting(bands[known]))) if known.any() else np.nan


def _table(places: list[str], rms: NDArray[np.float64], weighted: NDArray[np.float64]) -> ReportTable:
    shown = np.sort(np.argsort(-np.nan_to_num(rms), kind="stable")[:MOST_SENSORS])
    rows = [
        [
            text_cell(places[i]),
            Cell(engineering(rms[i], "m/s²"), "number"),
            Cell(_level(weighted[i]), "number"),
        ]
        for i in shown
    ]
    head = ["sensor at", "rms", "A-weighted / dB(A) re 1 µm/s²"]
    note = f"The {len(shown)} of {len(places)} sensors that vibrate most." if len(shown) < len(places) else ""
    return ReportTable("vibration_sensors", "Vibration at the sensors", head, rows, note)


def _level(value: float) -> str:
    return f"{value:.1f}" if np.isfinite(value) else "–"
