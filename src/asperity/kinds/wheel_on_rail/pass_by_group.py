"""The group of a result that says how loud the train is beside the track."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import xarray
from numpy.typing import NDArray

from asperity.kinds.wheel_on_rail import schema
from asperity.kinds.wheel_on_rail.case import WheelOnRail
from asperity.radiation.pass_by import (
    AxleSource,
    Passage,
    Receiver,
    exposure,
    weighted_squared_pressure,
)
from asperity.radiation.pass_by_levels import pass_by_levels, pressure_level, time_weighted
from asperity.schema import Attribute, Entry, attributes, spectra, variables
from asperity.spectra import a_weighting

KEPT_STEP = 0.02
"""Time between levels that are kept, s, where the record is finer: a sixth of the time constant F."""
PICOWATT = 1e-12
ONE_WAVE = 20.0 * math.log10(math.e)
"""Decay rate, dB/m, times the length of a wave that radiates."""
LONGEST = 1000.0
"""Greatest of these lengths, m; the exposure depends on none of them."""


def pass_by_group(case: WheelOnRail, found: xarray.Dataset) -> xarray.Dataset:
    """Lay out levels beside the track, from the sound power and the decay rates that the spectra hold."""
    passage, receiver = case.noise.passage(case.speed), Receiver()
    sources, band = _sources(case, found), found[spectra.BAND.name].values
    length = max(float(np.max(source.length)) for source in sources)
    time, weights = passage.times(receiver, length), 10.0 ** (a_weighting(band) / 10.0)
    squared = _with_total(
        [weighted_squared_pressure(source, passage, receiver, time, weights) for source in sources]
    )
    exposed = _with_total([exposure(source, passage, receiver) for source in sources])
    levels = [pass_by_levels(time, of_law, passage.passed) for of_law in squared]
    step = float(time[1] - time[0])
    kept = slice(None, None, max(1, math.floor(KEPT_STEP / step)))
    entries: dict[Entry, Any] = {
        schema.PASS_BY_LAW: found[spectra.LAW.name].values,
        schema.PASS_BY_RADIATOR: found[schema.RADIATOR.name].values,
        schema.PASS_BY_BAND: band,
        schema.PASS_BY_TIME: time[kept],
        schema.AXLE: 1 + np.arange(len(passage.axles)),
        schema.AXLE_TIME: np.array(passage.axles) / passage.speed,
        schema.PASS_BY_LEVEL: pressure_level(time_weighted(squared, step)[..., kept]),
        schema.PASS_BY_MAXIMUM_LEVEL: np.stack([each.maximum for each in levels]),
        schema.SOUND_EXPOSURE_LEVEL: pressure_level(exposed),
        schema.SOUND_EXPOSURE_LEVEL_A: pressure_level(exposed @ weights),
    }
    if passage.passed is not None:
        entries[schema.PASS_BY_EQUIVALENT_LEVEL] = np.stack([each.equivalent for each in levels])
        entries[schema.TRANSIT_EXPOSURE_LEVEL] = np.stack([each.transit_exposure for each in levels])
    return xarray.Dataset(variables(entries), attrs=attributes(_facts(passage, receiver)))


def _sources(case: WheelOnRail, found: xarray.Dataset) -> list[AxleSource]:
    """What one axle makes radiate: a wheel from its axle, the others along the rail as its waves decay."""
    level = found[schema.RADIATED_POWER_LEVEL.name].transpose("law", "radiator", "band")
    power = PICOWATT * np.nan_to_num(10.0 ** (level.values / 10.0)) / case.noise.axles
    decay = found[schema.BAND_DECAY_RATE.name].values
    length = ONE_WAVE / np.maximum(decay, ONE_WAVE / LONGEST)
    places = {"wheel": (0.0, case.wheel.radius)}
    return [
        AxleSource(power[:, number], *places.get(name, (length, 0.0)))
        for number, name in enumerate(level["radiator"].values.tolist())
        if name != "total"
    ]


def _with_total(parts: list[NDArray[np.float64]]) -> NDArray[np.float64]:
    """Sources (law, …) along the second axis, their sum the last of them."""
    return np.stack([*parts, np.sum(parts, axis=0)], axis=1)


def _facts(passage: Passage, receiver: Receiver) -> dict[Attribute, float]:
    facts = {schema.RECEIVER_DISTANCE: receiver.distance, schema.RECEIVER_HEIGHT: receiver.height}
    if passage.passed is not None:
        facts |= dict(zip((schema.FRONT_TIME, schema.REAR_TIME), passage.passed, strict=True))
    return facts
