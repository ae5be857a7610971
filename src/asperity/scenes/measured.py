"""What was measured on a track, beside what was computed: in the sound power, and where both disagree."""

import warnings

import numpy as np
import xarray

from asperity.arguments import Array
from asperity.case.measured import read_decay_rates, read_mobility
from asperity.errors import Finding, Grade, MeasuredTrackWarning
from asperity.radiation.measured_track import HammerTest
from asperity.scenes import schema
from asperity.scenes.compute import Computed
from asperity.schema import Values, spectra
from asperity.spectra import nominal_frequency

FACTOR = 3.0
"""By which a decay rate or a mobility may be off that of the computed track before it is warned of."""


def measured_track(run: Computed) -> tuple[Values, Array, Array] | None:
    """What was measured on the track of a case: laid out, and what it does in bands (b,).

    Factors of the sound power of rail and sleepers, and of the length of rail that radiates, over those of
    the computed track. None where the case says nothing of the kind.
    """
    keys = run.case.track
    if keys.decay_rates is None and keys.mobility is None:
        return None
    computed = HammerTest.of_track(run.track.nominal, run.band)
    rates = None if keys.decay_rates is None else read_decay_rates(keys.decay_rates)
    mobility = None if keys.mobility is None else read_mobility(keys.mobility)
    found = computed.measured(None if rates is None else rates[:2], mobility)
    lines = computed.frequency
    other = run.scene.first.receptance(lines.ravel()).reshape(lines.shape) + 1.0 / run.stiffness
    longer, louder = found.longer(computed), found.louder(computed, other)
    known = np.isfinite(found.decay_rate) | np.isfinite(found.rms_mobility)
    change = np.where(known, 10.0 * np.log10(longer * louder), np.nan)
    laid_out: Values = {schema.MEASURED_POWER_CHANGE: change}
    if rates is not None:
        laid_out |= {schema.MEASURED_DECAY_RATE: found.decay_rate}
        laid_out |= {schema.EXPECTED_DECAY_RATE: computed.decay_rate}
        if rates[2] is not None:
            sideways = computed.measured((rates[0], rates[2]), None)
            laid_out |= {schema.MEASURED_LATERAL_DECAY_RATE: sideways.decay_rate}
    if mobility is not None:
        own, expected = found.rms_mobility, computed.rms_mobility
        force = 10.0 * np.log10(louder * (expected / own) ** 2)
        laid_out |= {schema.MEASURED_MOBILITY: own, schema.EXPECTED_MOBILITY: expected}
        laid_out |= {schema.MEASURED_FORCE_CHANGE: force}
    return laid_out, longer * louder, longer


_COMPARED = (
    ("decay_rates", "decay rate", schema.MEASURED_DECAY_RATE, schema.EXPECTED_DECAY_RATE),
    ("mobility", "point mobility", schema.MEASURED_MOBILITY, schema.EXPECTED_MOBILITY),
)


def findings_of_measured(over_frequency: xarray.Dataset) -> list[Finding]:
    """Hold what was measured to the computed track; nothing where nothing was."""
    band, found = over_frequency[spectra.BAND.name].values, []
    for key, quantity, own, expected in _COMPARED:
        if own.name not in over_frequency or np.isnan(over_frequency[own.name]).all():
            continue
        ratio = over_frequency[own.name].values / over_frequency[expected.name].values
        apart = np.exp(np.abs(np.log(ratio)))
        worst = int(np.nanargmax(apart))
        off = ", ".join(map(nominal_frequency, band[apart > FACTOR]))
        found.append(
            Finding(
                f"measured {quantity} over that of the computed track, farthest from 1",
                f"{ratio[worst]:.2g} ({nominal_frequency(band[worst])})",
                f"{1.0 / FACTOR:.2g} to {FACTOR:g}",
                Grade.WARNING if off else None,
                f"The contact force is that of another track than the one measured: see {off}.",
                f"Fit pads, ballast and losses of [track] to it, or check track.{key}.",
                warned=True,
            )
        )
    return found


def warn_of_contradictions(found: list[Finding]) -> None:
    """Say in which bands what was measured contradicts the track that was computed."""
    for finding in found:
        if finding.grade is not None:
            warnings.warn(MeasuredTrackWarning(finding.message, finding.grade), stacklevel=2)
