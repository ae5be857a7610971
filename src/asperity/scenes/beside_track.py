"""Levels beside a track: what a train makes heard as it passes."""

import math
from functools import cache
from typing import Any

import numpy as np
import xarray

from asperity.arguments import Array
from asperity.radiation import pass_by
from asperity.reference import railways
from asperity.scenes import measured, noise, schema
from asperity.scenes.measured import measured_passage
from asperity.schema import Values, spectra
from asperity.spectra import a_weighting, energy_of

KEPT_STEP = 0.02
"""Time between levels that are kept, s, where the record is finer: a sixth of the time constant F."""
ONE_WAVE = 20.0 * math.log10(math.e)
"""Decay rate, dB/m, times the length of a wave that radiates."""
LONGEST = 1000.0
"""Greatest of these lengths, m; the exposure depends on none of them."""


def sources_of(case: Any) -> tuple[str, ...]:
    """What the level beside the track is computed by, beyond the sound power."""
    ground = (railways.GROUND_CITATION,) if case.noise.sound_path(np.array([1000.0])).ground else ()
    return ground if case.noise.vehicle is None else (*ground, railways.TSI_CITATION)


def pass_by_group(case: Any, over_frequency: xarray.Dataset, beside: Values | None = None) -> Values:
    """Lay out levels beside the track, from the sound power and the decay rates that the spectra hold.

    All axles radiate alike: where several were rolled, as their mean. What moves sideways decays along the
    rail as its own waves do, of which the group `beside` tells.
    """
    keys = case.noise
    passage = case.passage
    band = over_frequency[spectra.BAND.name].values
    sources = _sources(case, over_frequency, beside or {})
    weights = energy_of(a_weighting(band))
    length = max(float(np.max(source.length)) for source in sources)

    @cache
    def heard(at: pass_by.Receiver) -> tuple[Array, ...]:
        """Times, squared pressure and exposure (laws, radiators, …), and the single numbers of both."""
        path = keys.sound_path(band, at)
        time = passage.times(at, length)

        def with_sum(each: list[Array]) -> Array:
            return np.stack([*each, np.sum(each, axis=0)], axis=1)

        squared = with_sum([weights @ path.squared_pressure(each, passage, time) for each in sources])
        exposed = with_sum([path.exposure(each, passage) for each in sources])
        levels = [pass_by.pass_by_levels(time, law, passage.passed) for law in squared]
        return time, squared, exposed, *np.stack(levels, axis=1)

    receiver = keys.receiver
    time, squared, exposed, maximum, equivalent, transit_exposure = heard(receiver)
    step = float(time[1] - time[0])
    kept = slice(None, None, max(1, math.floor(KEPT_STEP / step)))
    laid_out: Values = {
        schema.PASS_BY_LAW: over_frequency[spectra.LAW.name].values,
        schema.PASS_BY_RADIATOR: over_frequency[schema.RADIATOR.name].values.tolist(),
        schema.PASS_BY_BAND: band,
        schema.PASS_BY_TIME: time[kept],
        schema.AXLE: 1 + np.arange(len(passage.axles)),
        schema.AXLE_TIME: np.array(passage.axles) / passage.speed,
        schema.PASS_BY_LEVEL: pass_by.pressure_level(pass_by.time_weighted(squared, step)[..., kept]),
        schema.PASS_BY_MAXIMUM_LEVEL: maximum,
        schema.SOUND_EXPOSURE_LEVEL: pass_by.pressure_level(exposed),
        schema.SOUND_EXPOSURE_LEVEL_A: pass_by.pressure_level(exposed @ weights),
        schema.RECEIVER_DISTANCE: receiver.distance,
        schema.RECEIVER_HEIGHT: receiver.height,
        schema.GROUND: keys.ground_words,
        schema.DIRECTIVITY: keys.directivity,
        schema.RAIL_DISTANCE: keys.rail_distance or 0.0,
        schema.FAR_RAIL_SCREENING: keys.far_rail_screening,
        schema.RECEIVER_OFFSET: keys.receiver_offset,
    }
    if passage.passed is not None:
        laid_out[schema.PASS_BY_EQUIVALENT_LEVEL] = equivalent
        laid_out[schema.TRANSIT_EXPOSURE_LEVEL] = transit_exposure
        laid_out |= dict(zip((schema.FRONT_TIME, schema.REAR_TIME), passage.passed, strict=True))
        laid_out |= measured.held_to_limits(case, over_frequency, lambda at: heard(at)[4])
    return laid_out | measured_passage(case.noise, band)


def _sources(case: Any, over_frequency: xarray.Dataset, beside: Values) -> list[pass_by.AxleSource]:
    """What one axle makes radiate: a wheel from its axle, the others along the rail as its waves decay.

    Waves sideways reach no farther than the longest of those up and down, but where that was measured.
    """
    power = over_frequency[schema.RADIATED_POWER_LEVEL.name].transpose("law", "radiator", "band")
    band = power["band"].values
    decay = over_frequency[schema.BAND_DECAY_RATE.name].values
    height = case.noise.source_heights
    up = ONE_WAVE / np.maximum(decay, ONE_WAVE / LONGEST)
    found = []
    for name, level in zip(power["radiator"].values.tolist(), np.moveaxis(power.values, 1, 0), strict=True):
        sent = noise.PICOWATT * np.nan_to_num(energy_of(level)) / len(case.contacts_behind)
        if name == "wheel":
            found.append(pass_by.AxleSource(sent, 0.0, case.rolling.radius))
        elif name == schema.RAIL_SIDEWAYS:
            rate = np.interp(
                band[:, None] * noise.WITHIN,
                beside[schema.SIDEWAYS_FREQUENCY],
                beside[schema.LATERAL_DECAY_RATE],
            )
            lateral = np.minimum(np.mean(ONE_WAVE / rate, axis=1), float(np.max(up)))
            if (change := schema.MEASURED_LATERAL_POWER_CHANGE.name) in over_frequency:
                own = lateral * energy_of(over_frequency[change].values)
                lateral = np.where(np.isfinite(own), np.minimum(own, LONGEST), lateral)
            found.append(pass_by.AxleSource(sent, lateral, height["rail"], "lateral"))
        elif name != "total":
            motion = "vertical" if name == "rail" else "all"
            found.append(pass_by.AxleSource(sent, up, height[name], motion))
    return found
