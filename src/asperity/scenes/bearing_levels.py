"""Levels of a bearing in one-third octaves, as of any scene, and how sure its velocities in bands are."""

import numpy as np

from asperity.arguments import Array
from asperity.diagnostics import ISO_BANDS, band_deviations
from asperity.scenes.computed_bearing import ComputedBearing
from asperity.scenes.observer import Observer
from asperity.scenes.schema import ACCELERATION_REFERENCE
from asperity.schema import Values, bearing, spectra
from asperity.spectra import (
    LEAST_PRODUCT,
    averaging_time,
    band_levels,
    band_product,
    level_deviation,
    psd,
    spectrum_segment,
    values_seen,
)


def levels_group(computed: ComputedBearing) -> Values:
    """Lay out levels of the forces of all contacts, and of acceleration at each sensor, by law and band."""
    case = computed.case
    runs = computed.runs
    samples = len(next(iter(runs.values())).time)
    step = 1.0 / case.sampling_rate
    segment = spectrum_segment(samples, step)

    def densities(name: str) -> tuple[Array, Array]:
        """Frequencies, and PSDs (laws, contacts or sensors, f) of a record; none of what does not vary."""
        stacked = computed.stacked(name)
        frequency, density = psd(stacked, step, segment=segment)
        return frequency, np.where(np.ptp(stacked, axis=-1, keepdims=True) > 0.0, density, 0.0)

    frequency, of_forces = densities("contact_force")
    _, of_motion = densities("acceleration")
    highest = case.highest_frequency
    band, force = band_levels(frequency, of_forces.mean(axis=1), high=highest)
    _, acceleration = band_levels(frequency, of_motion, ACCELERATION_REFERENCE, high=highest)
    product = band_product(band, averaging_time(samples, step, segment=segment))
    seen = values_seen(computed.stacked("contact_force")[0, 0], step, band)
    return {
        spectra.BAND: band,
        spectra.BAND_TIME_PRODUCT: spectra.BAND_TIME_PRODUCT.variable(product, least=LEAST_PRODUCT),
        spectra.LEVEL_DEVIATION: level_deviation(product * seen),
        spectra.FORCE_LEVEL: force,
        bearing.SPECTRA_SENSOR: case.sensors,
        bearing.ACCELERATION_LEVEL: acceleration,
        bearing.BAND_DEVIATION: [
            [_deviations(signal, case.sampling_rate) for signal in run.acceleration] for run in runs.values()
        ],
    }


def _deviations(signal: Array, rate: float) -> Array:
    """How sure velocities in bands are; nothing of what does not vary."""
    return band_deviations(signal, rate) if np.ptp(signal) > 0.0 else np.full(len(ISO_BANDS), np.nan)


OBSERVER = Observer(
    "bearing_levels",
    (
        spectra.BAND,
        spectra.BAND_TIME_PRODUCT,
        spectra.LEVEL_DEVIATION,
        spectra.FORCE_LEVEL,
        bearing.SPECTRA_SENSOR,
        bearing.ACCELERATION_LEVEL,
        bearing.BAND_DEVIATION,
    ),
    levels_group,
    needs=("bearing",),
)
