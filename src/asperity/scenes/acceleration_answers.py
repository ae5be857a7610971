"""What the report of a ball, or of bodies, says first: how what they roll over vibrates."""

from __future__ import annotations

import numpy as np
from xarray import DataTree

from asperity.reporting import data
from asperity.reporting.headline import Answers, HeadlineNumber, deciding_bands
from asperity.reporting.tables import number_cells, table, text_cells
from asperity.scenes.schema import ACCELERATION, ACCELERATION_LEVEL
from asperity.schema.spectra import BAND
from asperity.spectra import a_weighting, energy_sum

MOST_SENSORS = 6
"""That are listed."""


def acceleration_answers(tree: DataTree) -> Answers | None:
    """Acceleration at the sensors by the main law: rms, A-weighted level, and the bands that hold it."""
    main = next(iter(data.laws(tree, ACCELERATION)), None)
    if main is None or main not in data.laws(tree, ACCELERATION_LEVEL) or not data.present(tree, BAND):
        return None
    rms = np.sqrt(np.nanmean(data.of_law(tree, ACCELERATION, main) ** 2, axis=1))
    levels, bands = data.of_law(tree, ACCELERATION_LEVEL, main), data.values(tree, BAND)
    known = np.isfinite(levels)
    loud = [
        float(energy_sum(level[some] + a_weighting(bands[some]))) if some.any() else np.nan
        for level, some in zip(levels, known, strict=True)
    ]
    weighted = np.array(loud)
    sensors = data.variable_of(tree, ACCELERATION)["sensor"].values.tolist()
    places = [f"x = {sensor:g} m" for sensor in sensors]
    most = int(np.nanargmax(rms))
    strongest = data.engineering(rms[most], "m/s²")
    lead = (
        f"The structure vibrates most at {places[most]}: {strongest} rms, half of "
        f"its energy in the bands of {deciding_bands(bands, levels[most])}."
    )
    note = f"{weighted[most]:.1f} dB(A) re 1 µm/s², at {places[most]}, the most of {len(places)} sensors"
    shown = np.sort(np.argsort(-np.nan_to_num(rms), kind="stable")[:MOST_SENSORS])
    columns = {
        "sensor at": text_cells(places[n] for n in shown),
        "rms": number_cells(rms[shown], "m/s²"),
        "A-weighted / dB(A) re 1 µm/s²": number_cells(weighted[shown], "{:.1f}"),
    }
    few = f"The {len(shown)} of {len(places)} sensors that vibrate most." if len(shown) < len(places) else ""
    listed = table("vibration_sensors", "Vibration at the sensors", columns, few)
    return Answers(lead, numbers=(HeadlineNumber("vibration, rms", strongest, note),), tables=(listed,))
