"""Levels of a bearing in one-third octaves, as of any scene, and how sure its velocities in bands are."""

from asperity.diagnostics import band_deviations
from asperity.scenes.computed_bearing import ComputedBearing
from asperity.scenes.observer import DECLARED, Observer
from asperity.scenes.schema import ACCELERATION_REFERENCE
from asperity.schema import Values, bearing, spectra
from asperity.spectra import (
    LEAST_PRODUCT,
    averaging_time,
    band_product,
    level_deviation,
    values_seen,
)


def levels_group(computed: ComputedBearing) -> Values:
    """Lay out levels of the forces of all contacts, and of acceleration at each sensor, by law and band."""
    case = computed.case
    runs = computed.runs
    samples = len(computed.first.time)
    averaged = averaging_time(samples, case.recorded_step, segment=computed.segment)
    product = band_product(computed.band, averaged)
    seen = values_seen(computed.first.contact_force[0], case.recorded_step, computed.band)
    accelerations = computed.psd(computed.stacked("acceleration"))
    return {
        spectra.BAND: computed.band,
        spectra.BAND_TIME_PRODUCT: spectra.BAND_TIME_PRODUCT.variable(product, least=LEAST_PRODUCT),
        spectra.LEVEL_DEVIATION: level_deviation(product * seen),
        spectra.FORCE_LEVEL: computed.levels(computed.force_psd.mean(axis=1)),
        bearing.SPECTRA_SENSOR: case.sensors,
        bearing.ACCELERATION_LEVEL: computed.levels(accelerations, ACCELERATION_REFERENCE),
        bearing.BAND_DEVIATION: [
            [band_deviations(signal, case.sampling_rate) for signal in run.acceleration]
            for run in runs.values()
        ],
    }


OBSERVER = Observer(
    "bearing_levels",
    DECLARED,
    levels_group,
    needs=("bearing",),
)
