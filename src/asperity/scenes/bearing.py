"""What a ball bearing did, as a result: its load at rest, its motion, and what its acceleration says."""

from __future__ import annotations

import math
import time
import warnings
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace

import numpy as np
import xarray

from asperity import diagnostics
from asperity.arguments import Array
from asperity.case.ball_bearing import BearingUnderLoad
from asperity.diagnostics import ISO_BANDS, LineFamily, Spectrum, band_deviations, band_velocities
from asperity.diagnostics.orders import envelope_order_spectrum
from asperity.errors import PhysicsWarning, percent, warn_of_findings
from asperity.progress import Progress
from asperity.rolling.bearing import RolledBearing, steady_where_still
from asperity.scenarios.prepared_bearing import (
    ON,
    RINGS,
    PreparedBearing,
    bearing_parts,
    named_on,
    names_in,
    omitted_from,
    prepare_bearing,
)
from asperity.scenes.bearing_at_rest import DIRECTIONS
from asperity.scenes.bearing_validity import bearing_findings
from asperity.scenes.computed_bearing import ComputedBearing, compute_bearing
from asperity.scenes.figures.sources import loudest
from asperity.scenes.observer import observed
from asperity.scenes.observers import OF_BEARINGS
from asperity.scenes.records import recorded_group
from asperity.scenes.result import root_attributes, scenario_group
from asperity.schema import Values, bearing, contact, spectra, tree
from asperity.speeds import SpeedCourse, speed_at
from asperity.structures.ball_bearing import PARTS
from asperity.written_numbers import rounded

HARMONICS = 5
REACH = 1.2
"""How far the envelope spectrum is kept, beyond the highest harmonic of a tone."""
RESOLVED = 0.003
"""Share by which a line may lie beside the tone of pure rolling, beyond the slip of the cage."""
SILENT = 1e-5
"""Amplitude of a line, m/s², that no accelerometer feels: what is left of rounding and of the start."""
BY_PARTS = "areal"
"""The law by which parts are run alone: it sees whole contacts, and asks for no scan."""
SOURCES = (
    "T. A. Harris and M. N. Kotzalas, Essential Concepts of Bearing Technology, 5th ed. (2007).",
    "F. P. Wardle, Proc. IMechE 202 C (1988) 305 (vibration of ball bearings by waviness).",
    "ISO 15242-2 (velocities in three bands).",
    "R. B. Randall and J. Antoni, Mechanical Systems and Signal Processing 25 (2011) 485 (envelope).",
    "J. Antoni, Mechanical Systems and Signal Processing 21 (2007) 108 (spectral kurtosis, of the band).",
)


# --- its result


def bearing_result(
    prepared: PreparedBearing,
    progress: Progress,
    caught: list[warnings.WarningMessage],
    *,
    brief: bool = False,
) -> xarray.DataTree:
    """Run a bearing by each of its laws and lay its result out, as `asperity.scenes.result` does others."""
    case = prepared.case
    began = time.monotonic()
    computed = compute_bearing(prepared, progress)
    heard = heard_group(case, computed.runs)
    apart = Values() if brief else alone(prepared, progress)
    runs = {name: steady_where_still(run) for name, run in computed.runs.items()}
    computed = replace(computed, runs=runs)
    seen = observed(computed, OF_BEARINGS)
    found = list(bearing_findings(case, runs)) + seen.findings
    warn_of_findings(found)
    numerics = (*_numerics(case, time.monotonic() - began), *seen.numerics)
    scenario = scenario_group(case, numerics)
    scenario[contact.VALIDITY] = [finding.row() for finding in found]
    laid_out = scenario | motion_group(computed) | heard | seen.values | apart
    result = bearing.with_ring_forces(tree(laid_out))
    result.attrs = root_attributes(
        case,
        case.title,
        (*SOURCES, case.bearing.bearing.SOURCE, *seen.sources),
        _verdict(case, heard, _deciding(apart)),
        caught,
        {
            names_in(case.bearing.bearing)[name]: f"{draw} on {radius:.6g} m, seed {case.seed}"
            for name, draw, radius in _draws(case)
        },
    )
    return result


def _draws(case: BearingUnderLoad) -> Iterator[tuple[str, str, float]]:
    """Parts whose surface is drawn, what is drawn, and their radius, m."""
    for name, keys, radius in bearing_parts(case):
        if draw := keys.texture().draw:
            yield name, draw, radius


# --- in time


def motion_group(computed: ComputedBearing) -> Values:
    """Lay out what was recorded in time, at the sampling rate of the case."""
    balls = np.arange(computed.bearing.balls)
    stacked = computed.stacked
    return recorded_group(computed) | {
        bearing.TACHO: speed_at(computed.case.speed, computed.first.time),
        bearing.ROLLING_BALL: 1 + balls,
        bearing.ROLLING_RING: list(RINGS),
        bearing.ROLLING_DIRECTION: list(DIRECTIONS),
        bearing.ROLLING_SENSOR: computed.case.sensors,
        bearing.BALL_AZIMUTH: computed.first.cage + 2.0 * np.pi / len(balls) * balls[:, None],
        bearing.CONTACT_RING: np.repeat(RINGS, len(balls)),
        bearing.CONTACT_BALL: 1 + np.tile(balls, len(RINGS)),
        bearing.BALL_MOTION: stacked("ball_motion"),
        bearing.RING_MOTION: np.stack([stacked(f"{ring}_motion") for ring in RINGS], axis=1),
        bearing.RING_ACCELERATION: stacked("acceleration"),
    }


# --- what its acceleration says


def heard_group(case: BearingUnderLoad, runs: dict[str, RolledBearing]) -> Values:
    """Lay out velocities in bands at all sensors; spectrum, envelope and lines in it at the first one."""
    rate = case.sampling_rate
    signals = [run.acceleration for run in runs.values()]
    families = case.kinematics.families
    highest = REACH * HARMONICS * max(tone for tone, _ in families.values())
    low, high = case.envelope_band or diagnostics.impulsive_band(signals[0][0], rate, highest)
    lines = [diagnostics.amplitude_spectrum(law[0], rate) for law in signals]
    frequency = lines[0][0]
    kept = (frequency > 0.0) & (frequency <= case.highest_frequency)
    struck = [envelope_at_fastest(case, law[0], (low, high)) for law in signals]
    slip = max(case.cage_slip) + RESOLVED
    found = [diagnostics.explained_lines(each, families, slip=slip, harmonics=HARMONICS) for each in struck]
    clear = [diagnostics.clear_families(each, SILENT) for each in found]
    judged = [[band_velocities(one, rate, quantity="acceleration") for one in law] for law in signals]
    for n in (
        n for n, run in enumerate(runs.values()) if not run.vibrates
    ):  # what rounding leaves is no result
        lines[n], struck[n] = ((at, np.full_like(size, np.nan)) for at, size in (lines[n], struck[n]))
        judged[n] = [np.zeros_like(each) for each in judged[n]]
        found[n] = {
            part: replace(each, **{what: np.nan * getattr(each, what) for what in LINES.values()})
            for part, each in found[n].items()
        }
    return {
        spectra.LAW: list(runs),
        spectra.FREQUENCY: frequency[kept],
        bearing.VELOCITY_AMPLITUDE: [each[kept] / (2.0 * np.pi * frequency[kept]) for _, each in lines],
        bearing.SENSOR: case.sensors,
        bearing.JUDGED_BAND: [f"{first:g} to {last:g} Hz" for first, last in ISO_BANDS],
        bearing.BAND_VELOCITY: judged,
        bearing.ENVELOPE_LOW: low,
        bearing.ENVELOPE_HIGH: high,
        bearing.ENVELOPE_SPEED: float(case.speed),
        **envelope_group(list(runs), struck, found, clear, highest),
    }


def envelope_group(
    names: Sequence[str],
    struck: Sequence[Spectrum],
    found: Sequence[Mapping[str, LineFamily]],
    clear: Sequence[Sequence[str]],
    highest: float,
    units: str = bearing.ENVELOPE.units,
) -> Values:
    """Lay out spectra of envelopes by name up to a frequency, Hz, lines of the parts, and which are clear."""
    frequency = struck[0][0]
    within = frequency <= highest
    envelopes = np.array([each[within] for _, each in struck])
    return {
        bearing.LAW: names,
        bearing.ENVELOPE_FREQUENCY: frequency[within],
        bearing.ENVELOPE: bearing.ENVELOPE.variable(envelopes, units=units),
        bearing.HARMONIC: 1 + np.arange(HARMONICS),
        **{entry: [_of_lines(each, what) for each in found] for entry, what in LINES.items()},
        bearing.LINES_FOUND: [[float(part in each) for part in PARTS] for each in clear],
    }


def envelope_at_fastest(case: BearingUnderLoad, signal: Array, band: tuple[float, float]) -> Spectrum:
    """Spectrum of the envelope of a signal; of a run-up over angle, orders as frequencies at the fastest."""
    rate = case.sampling_rate
    if not isinstance(case.speed, SpeedCourse):
        return diagnostics.envelope_spectrum(signal, rate, band)
    turns = case.speed.covered(np.arange(signal.size) / rate)
    if not np.ptp(signal):
        return diagnostics.envelope_spectrum(signal, rate, band)
    order, amplitude = envelope_order_spectrum(signal, rate, turns, band)
    kept = order * case.speed <= band[1] - band[0]
    return order[kept] * float(case.speed), amplitude[kept]


LINES = {
    bearing.LINE_FREQUENCY: "frequency",
    bearing.LINE_AMPLITUDE: "amplitude",
    bearing.LINE_SIDE_BANDS: "side_bands",
}


def _of_lines(found: Mapping[str, LineFamily], what: str) -> list[Array]:
    """Numbers of the lines of each part (parts, harmonics), of side bands the larger; NaN if not reached."""
    values = [getattr(found[part], what) for part in PARTS]
    each = [value.max(axis=1) if value.ndim == 2 else value for value in values]
    return [np.pad(value, (0, HARMONICS - len(value)), constant_values=np.nan) for value in each]


def _verdict(case: BearingUnderLoad, heard: Values, deciding: Sequence[str]) -> str:
    """How quiet the bearing is, by what in each band, and which part is heard if it has faults.

    Without, beats of waves of the parts lie in the envelope, some of them where lines of others would.
    """
    of = case.bearing.bearing
    velocities = heard[bearing.BAND_VELOCITY][0]
    told = ", ".join(
        f"{rounded(1e6 * rms)} µm/s in {band}{part}"
        for rms, band, part in zip(velocities[0], heard[bearing.JUDGED_BAND], deciding, strict=True)
        if np.isfinite(rms)
    )
    lines = zip(PARTS, heard[bearing.LINES_FOUND][0], heard[bearing.LINE_FREQUENCY][0], strict=True)
    at_speed = f" at {rounded(60.0 * case.speed, 5)} 1/min" if isinstance(case.speed, SpeedCourse) else ""
    parts = " and of the ".join(
        f"{names_in(of)[part]} ({rounded(at[0], 4)} Hz{at_speed})" for part, found, at in lines if found
    )
    law = heard[bearing.LAW][0]
    first = f" at {rounded(math.degrees(case.sensors[0]))}°" if len(case.sensors) > 1 else ""
    lead = f"Radial velocity{first} by {law}: {told or 'no band is sampled'}"
    if not np.nan_to_num(velocities).any() and told:
        lead = f"Nothing vibrates by {law}: all {of.ELEMENT}s are carried alike, on surfaces without waves"
    struck = f" Its envelope has lines of {f'the {parts}' if parts else 'no part'}." if case.faults else ""
    return f"{lead}.{struck} {omitted_from(case)}"


# --- which part makes it so


def alone(prepared: PreparedBearing, progress: Progress) -> Values:
    """Velocities with what is on each part alone, and on none, by `BY_PARTS`."""
    case = prepared.case
    textured = [key for key in ON if getattr(case, key).given()]
    if not textured:
        return {}
    names = ["perfect surfaces", *(named_on(case, key) for key in textured)]
    found = list[Array]()
    by_chance = list[Array]()
    if len(case.faults) > 1:
        names[-1] = "the faults"
    for kept in (None, *textured):
        others = case.with_(laws=[BY_PARTS], **{key: None for key in textured if key != kept})
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", PhysicsWarning)  # of the whole bearing it has been warned
            (run,) = compute_bearing(prepare_bearing(others), progress).runs.values()
        signal = run.acceleration[0] * run.vibrates
        found.append(band_velocities(signal, case.sampling_rate, quantity="acceleration"))
        by_chance.append(band_deviations(signal, case.sampling_rate))
    return {
        bearing.SOURCE: names,
        bearing.ALONE_VELOCITY: bearing.ALONE_VELOCITY.variable(np.array(found), law=BY_PARTS),
        bearing.ALONE_DEVIATION: by_chance,
    }


def _deciding(apart: Values) -> list[str]:
    """Which part makes most of each band, or which do within chance, in brackets after a blank.

    Empty where none is known to.
    """
    found = [""] * len(ISO_BANDS)
    if apart:
        squares = apart[bearing.ALONE_VELOCITY].values.T ** 2
        scatter = 2.0 * squares * np.nan_to_num(np.transpose(apart[bearing.ALONE_DEVIATION]))
        for band in np.flatnonzero(np.isfinite(squares).all(axis=1)):
            found[band] = _most_of(apart[bearing.SOURCE], squares[band], scatter[band])
    return found


def _most_of(names: Sequence[str], squares: Array, scatter: Array) -> str:
    """The parts that make most of a band, by mean squares (p,) with their scatter, perfect surfaces first."""
    part = np.append(squares[0], np.maximum(squares[1:] - squares[0], 0.0))
    scatter = np.append(scatter[0], np.hypot(scatter[1:], scatter[0]))
    levels = {
        name: (10.0 * np.log10(own), 10.0 / np.log(10.0) * by_chance / own)
        for name, own, by_chance in zip(names, part, scatter, strict=True)
        if own > 0.0
    }
    shares = dict(zip(names, part / (part.sum() or 1.0), strict=True))
    told = [f"{percent(float(shares[name]))} from {name}" for name in loudest(levels)]
    equal = ", equal within chance" if len(told) > 1 else ""
    return f" ({' and '.join(told)}{equal})" if told else ""


# --- how it was computed


def _numerics(case: BearingUnderLoad, wall: float) -> Iterator[tuple[str, str]]:
    """Numbers of the computation: names and values."""
    yield "time step", f"{rounded(case.step * 1e6, 4)} µs"
    yield "time steps per sample that is written", f"{case.steps_per_sample}"
    yield "resonance of the most loaded ball between the rings", f"{rounded(case.ball_resonance, 4)} Hz"
    yield "imbalance of the static solution", f"{rounded(case.static.imbalance, 1)} of the load"
    yield "wall time", f"{wall:.2f} s"
