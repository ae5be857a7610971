"""Force and motion of a scene over frequency: PSDs, one-third octaves, how sure these are, and tones."""

from collections.abc import Iterable

import numpy as np

from asperity import laws
from asperity import spectra as bands
from asperity.arguments import Array
from asperity.scenes import schema
from asperity.scenes.compute import Computed
from asperity.scenes.start_of_record import ringing_along
from asperity.scenes.validity import difference_to
from asperity.schema import Values, spectra


def spectra_group(computed: Computed) -> Values:
    """Lay out PSDs and one-third octaves of force and motion.

    With how sure the levels are, and how far the laws are from each other.
    """
    scene = computed.scene
    forces = computed.stacked("contact_force")
    shown = computed.shown
    density = computed.force_psd.mean(axis=1)
    level = computed.levels(density)
    laid_out: Values = {
        spectra.LAW: list(computed.runs),
        spectra.FREQUENCY: computed.frequency[shown],
        spectra.BAND: computed.band,
        spectra.CONTACT: 1 + np.arange(forces.shape[1]),
        spectra.FORCE_PSD: density[..., shown],
        spectra.FORCE_LEVEL: level,
        spectra.CONTACT_FORCE_LEVEL: computed.force_levels,
    }
    product, start, values = computed.derived(held_values)
    laid_out |= (
        sureness(product, start, values) | level_differences(list(computed.runs), level) | _bodies(computed)
    )
    if forces.shape[1] > 1:
        tones = passing_frequencies(
            scene.offsets, computed.case.speed, computed.case.numerics.highest_frequency
        )
        laid_out |= {schema.PASSING_FREQUENCY: tones} if tones.size else {}
    if sensors := computed.case.rolled_over.sensor_positions:
        density = computed.psd(computed.stacked("acceleration"))
        laid_out[schema.SPECTRA_SENSOR] = sensors
        laid_out[schema.ACCELERATION_PSD] = density[..., shown]
        laid_out[schema.ACCELERATION_LEVEL] = computed.levels(density, schema.ACCELERATION_REFERENCE)
    return laid_out


def held_values(computed: Computed) -> tuple[Array, Array, Array]:
    """B T of the bands (b,), the share of their level that the start makes, and the independent values held.

    By the first contact: others of one path hold much the same.
    """
    case = computed.case
    run = computed.first
    band = computed.band
    time = bands.averaging_time(len(run.time), case.time_step, segment=computed.segment)
    seen = bands.values_seen(run.contact_force[0], case.time_step, band)
    record = float(run.time[-1])
    product = bands.band_product(band, time)
    ends = run.positions[0, [0, -1]]
    ringing = ringing_along(computed.scene, computed.stiffness, ends, band)
    start = np.array([each.not_built_up(case.settled_time, record) for each in ringing])
    held = np.array([each.values(record) for each in ringing])
    return product, start, np.minimum(product * seen, held * time / record)


def sureness(product: Array, start: Array, values: Array) -> Values:
    """Lay out how sure the levels of bands are: B T, chance, and start, from `held_values`."""
    return {
        spectra.START_SHARE: spectra.START_SHARE.variable(start, most=bands.MOST_START),
        spectra.BAND_TIME_PRODUCT: spectra.BAND_TIME_PRODUCT.variable(product, least=bands.LEAST_PRODUCT),
        spectra.LEVEL_DEVIATION: bands.level_deviation(values),
    }


def level_differences(names: list[str], force_level: Array) -> Values:
    """Differences of force levels (laws, bands), dB, to the linear laws, and to a reference if any."""
    compared = {difference_to(law): law for law in laws.baselines(names)}
    if (solved := laws.reference(names)) is not None:
        compared[spectra.FORCE_LEVEL_DIFFERENCE_TO_REFERENCE] = solved
    with np.errstate(invalid="ignore"):  # where nothing vibrates by either law
        return {
            entry: entry.variable(force_level - force_level[names.index(law)], reference=law)
            for entry, law in compared.items()
        }


def _bodies(computed: Computed) -> Values:
    """Acceleration of the bodies in their degrees of freedom, from second differences of their motion."""
    step = computed.case.time_step
    curvature = np.pad(np.diff(body_motion(computed), 2) / step**2, ((0, 0), (0, 0), (1, 1)), mode="edge")
    half = np.pi * computed.frequency * step
    to_acceleration = (half / np.sin(np.maximum(half, 1e-12))) ** 4
    density = (computed.psd(curvature) * to_acceleration)[..., computed.shown]
    return {schema.SPECTRA_DEGREE: list(computed.scene.degrees), schema.BODY_ACCELERATION_PSD: density}


EQUAL = 1e-6
"""Relative difference of distances that are equal."""


def passing_frequencies(offsets: Iterable[float], speed: float, highest: float) -> Array:
    """Multiples k v/L, Hz, of the frequency at which contacts at an equal distance L pass a place.

    Offsets in m, speed in m/s, up to the highest frequency, Hz; none where distances differ.
    """
    gaps = np.diff(np.sort(np.fromiter(offsets, dtype=float)))
    if not gaps.size or np.ptp(gaps) > EQUAL * gaps.mean():
        return np.zeros(0)
    first = speed / gaps.mean()
    return first * np.arange(1, int(highest / first) + 1)


def body_motion(computed: Computed) -> Array:
    """Degrees of freedom of all bodies (laws, d, n), positive downwards, m."""
    levers = np.array(list(computed.scene.degrees.values()))[:, None]
    return np.stack([-levers * np.concatenate(run.degrees_of_freedom) for run in computed.runs.values()])
