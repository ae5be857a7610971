"""What was measured on a track and beside it, beside what was computed; and where both disagree."""

from collections.abc import Mapping
from contextlib import suppress
from typing import Any

import numpy as np

from asperity.arguments import Array
from asperity.case.measured import FALL, read_band_levels, read_decay_rates, read_mobility, read_passage
from asperity.case.rolled_over import TrackKeys
from asperity.case.sections import NoiseKeys
from asperity.errors import ComputationError, Finding, Grade, MeasuredTrackWarning
from asperity.radiation import pass_by
from asperity.radiation.measured_track import HammerTest, in_bands
from asperity.scenes import schema
from asperity.scenes.compute import Computed
from asperity.schema import Attribute, Values
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
                category=MeasuredTrackWarning,
            )
        )
    return found


# --- a passage beside the track


DURATION = (0.8, 1.25)
"""Measured over computed time of a passage: outside of it the train or its speed was another one."""


def measured_passage(
    keys: NoiseKeys, time: Array, level: Array, passed: tuple[float, float] | None, band: Array
) -> Values:
    """Lay out what was measured as a train passed.

    Beside the computed level (t,), dB(A), at times (t,), s, of the train whose front and rear are opposite at
    the times `passed`, s; bands by their centres, Hz. The record is moved so that the times at which it lies
    10 dB below its maximum, first and last, have the same middle as those of the computed one.
    """
    laid_out: Values = {}
    if keys.measured_passage is not None:
        at, heard = read_passage(keys.measured_passage)
        (begin, end), (first, last) = within_fall(at, heard), within_fall(time, level)
        at = at + 0.5 * (first + last - begin - end)
        laid_out = _single_numbers(at, heard, passed)
        laid_out[schema.MEASURED_LEVEL] = np.interp(time, at, heard, left=np.nan, right=np.nan)
        laid_out[schema.MEASURED_DURATION_RATIO] = (end - begin) / (last - first)
    if keys.measured_bands is not None:
        laid_out[schema.MEASURED_BAND_LEVEL] = in_bands(band, *read_band_levels(keys.measured_bands))
    told: dict[Attribute, float | None] = {
        schema.MEASURED_MAXIMUM_LEVEL: keys.measured_maximum_level,
        schema.MEASURED_EQUIVALENT_LEVEL: keys.measured_equivalent_level,
        schema.MEASURED_EXPOSURE_LEVEL: keys.measured_exposure_level,
    }
    return laid_out | {entry: value for entry, value in told.items() if value is not None}


def within_fall(time: Array, level: Array) -> tuple[float, float]:
    """First and last time at which a level lies 10 dB below its maximum, s."""
    limit = level.max() - FALL
    above = np.flatnonzero(level > limit)
    rise, fall = (slice(at, at + 2) for at in (above[0] - 1, above[-1]))
    start = np.interp(limit, level[rise], time[rise])
    end = np.interp(-limit, -level[fall], time[fall])
    return float(start), float(end)


def _single_numbers(time: Array, level: Array, passed: tuple[float, float] | None) -> Values:
    """Largest level, and those over the pass-by time as far as the record holds it.

    Time weighting F delays energy by its time constant, which is taken off.
    """
    found: Values = {schema.MEASURED_MAXIMUM_LEVEL: float(level.max())}
    true = time - pass_by.FAST
    if passed is None or true[0] > passed[0] or true[-1] < passed[1]:
        return found
    squared = pass_by.REFERENCE_PRESSURE**2 * 10.0 ** (level[None] / 10.0)
    mean = pass_by.integral(true, squared, *passed) / (passed[1] - passed[0])
    found[schema.MEASURED_EQUIVALENT_LEVEL] = float(pass_by.pressure_level(mean)[0])
    with suppress(ComputationError):  # it ends before it has fallen as far as TEL asks
        exposed = pass_by.pass_by_levels(true, squared, passed).transit_exposure
        found[schema.MEASURED_EXPOSURE_LEVEL] = float(exposed[0])
    return found


def findings_of_passage(laid_out: Mapping[Any, Any]) -> list[Finding]:
    """Hold the time of a measured passage to that of the computed one; nothing where none was measured."""
    if (ratio := laid_out.get(schema.MEASURED_DURATION_RATIO)) is None:
        return []
    low, high = DURATION
    return [
        Finding(
            "time of the measured passage over that of the computed one, within 10 dB of the maximum",
            f"{ratio:.2f}",
            f"{low:g} to {high:g}",
            None if low <= ratio <= high else Grade.WARNING,
            "It was another train, or another speed.",
            "Check speed, noise.vehicle_length and noise.vehicles.",
        )
    ]
