"""Levels of a bearing in one-third octaves, as of any scene, and how sure its velocities in bands are."""

import numpy as np

from asperity.arguments import Array
from asperity.case.ball_bearing import BearingUnderLoad
from asperity.diagnostics import ISO_BANDS, band_deviations
from asperity.rolling.bearing import RolledBearing
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


def levels_group(case: BearingUnderLoad, runs: dict[str, RolledBearing]) -> Values:
    """Lay out levels of the forces of all contacts, and of acceleration at each sensor, by law and band."""
    samples = len(next(iter(runs.values())).time)
    step = 1.0 / case.sampling_rate
    segment = spectrum_segment(samples, step)

    def densities(records: list[Array]) -> tuple[Array, Array]:
        """Frequencies, and PSDs (laws, contacts or sensors, f) of records; none of what does not vary."""
        stacked = np.stack(records)
        frequency, density = psd(stacked, step, segment=segment)
        return frequency, np.where(np.ptp(stacked, axis=-1, keepdims=True) > 0.0, density, 0.0)

    forces = [np.concatenate([run.inner_force, run.outer_force]) for run in runs.values()]
    frequency, of_forces = densities(forces)
    _, of_motion = densities([run.acceleration for run in runs.values()])
    highest = case.highest_frequency
    band, force = band_levels(frequency, of_forces.mean(axis=1), high=highest)
    _, acceleration = band_levels(frequency, of_motion, ACCELERATION_REFERENCE, high=highest)
    product = band_product(band, averaging_time(samples, step, segment=segment))
    return {
        spectra.BAND: band,
        spectra.BAND_TIME_PRODUCT: spectra.BAND_TIME_PRODUCT.variable(product, least=LEAST_PRODUCT),
        spectra.LEVEL_DEVIATION: level_deviation(product * values_seen(forces[0][0], step, band)),
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
