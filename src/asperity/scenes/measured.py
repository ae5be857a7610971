"""What was measured on a track, beside what was computed: in the sound power, and where both disagree."""

import warnings

import numpy as np

from asperity.arguments import Array
from asperity.case.measured import read_decay_rates, read_mobility
from asperity.case.rolled_over import TrackKeys
from asperity.errors import Finding, Grade, MeasuredTrackWarning
from asperity.radiation.measured_track import HammerTest, in_bands
from asperity.scenes import schema
from asperity.scenes.compute import Computed
from asperity.schema import Values
from asperity.spectra import nominal_frequency
from asperity.structures.track import Track

FACTOR = 3.0
"""By which a decay rate or a mobility may be off that of the computed track before it is warned of."""


def hammer_tests(keys: TrackKeys, track: Track, band: Array) -> tuple[HammerTest, HammerTest] | None:
    """What was measured on a track, and what would be on the computed one, in bands by their centres, Hz.

    None where the keys say nothing of the kind.
    """
    if keys.decay_rates is None and keys.mobility is None:
        return None
    computed = HammerTest.of_track(track, band)
    rates = None if keys.decay_rates is None else read_decay_rates(keys.decay_rates)[:2]
    mobility = None if keys.mobility is None else read_mobility(keys.mobility)
    return computed.measured(rates, mobility), computed


def measured_track(run: Computed) -> tuple[Values, Array, Array] | None:
    """What was measured on the track of a case: laid out, and what it does in bands (b,).

    Factors of the sound power of rail and sleepers, and of the length of rail that radiates, over those of
    the computed track. None where the case says nothing of the kind.
    """
    keys = run.case.track
    if (tests := hammer_tests(keys, run.track.nominal, run.band)) is None:
        return None
    found, computed = tests
    lines = computed.frequency
    other = run.scene.first.receptance(lines.ravel()).reshape(lines.shape) + 1.0 / run.stiffness
    longer, louder = found.longer(computed), found.louder(computed, other)
    known = np.isfinite(found.decay_rate) | np.isfinite(found.rms_mobility)
    change = np.where(known, 10.0 * np.log10(longer * louder), np.nan)
    laid_out: Values = {schema.MEASURED_POWER_CHANGE: change}
    if keys.decay_rates is not None:
        laid_out |= {schema.MEASURED_DECAY_RATE: found.decay_rate}
        laid_out |= {schema.EXPECTED_DECAY_RATE: computed.decay_rate}
        centres, _, lateral = read_decay_rates(keys.decay_rates)
        if lateral is not None:
            laid_out |= {schema.MEASURED_LATERAL_DECAY_RATE: in_bands(run.band, centres, lateral)}
    if keys.mobility is not None:
        own, expected = found.rms_mobility, computed.rms_mobility
        force = 10.0 * np.log10(louder * (expected / own) ** 2)
        laid_out |= {schema.MEASURED_MOBILITY: own, schema.EXPECTED_MOBILITY: expected}
        laid_out |= {schema.MEASURED_FORCE_CHANGE: force}
    return laid_out, longer * louder, longer


def findings_of_measured(keys: TrackKeys, track: Track, band: Array) -> list[Finding]:
    """Hold what was measured to the computed track, in bands by their centres (b,), Hz."""
    if (tests := hammer_tests(keys, track, band)) is None:
        return []
    measured, computed = tests
    compared = (
        ("decay_rates", "decay rate", measured.decay_rate / computed.decay_rate),
        ("mobility", "point mobility", measured.rms_mobility / computed.rms_mobility),
    )
    found = []
    for key, quantity, ratio in compared:
        if np.isnan(ratio).all():
            continue
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
