"""What a ball bearing did, as a result: its load at rest, its motion, and what its acceleration says."""

import math
import time
import warnings
from collections.abc import Iterator

import numpy as np
import xarray

from asperity.arguments import Array
from asperity.case.ball_bearing import BearingUnderLoad
from asperity.diagnostics import ISO_BANDS
from asperity.diagnostics.lines import STANDS_OUT
from asperity.errors import percent, warn_of_findings
from asperity.progress import Progress
from asperity.scenarios.prepared_bearing import (
    RINGS,
    PreparedBearing,
    bearing_parts,
    names_in,
    omitted_from,
    rims_in_words,
)
from asperity.scenes.bearing_at_rest import DIRECTIONS
from asperity.scenes.bearing_validity import bearing_findings
from asperity.scenes.computed_bearing import BY_PARTS, ComputedBearing, compute_bearing, compute_with_parts
from asperity.scenes.figures.sources import loudest
from asperity.scenes.observer import observed
from asperity.scenes.observers import OF_BEARINGS
from asperity.scenes.records import recorded_group
from asperity.scenes.result import root_attributes, scenario_group
from asperity.schema import Values, bearing, contact, tree
from asperity.speeds import at_fastest, speed_at
from asperity.structures.rolling_bearing import PARTS
from asperity.written_numbers import rounded

SOURCES = (
    "T. A. Harris and M. N. Kotzalas, Essential Concepts of Bearing Technology, 5th ed. (2007).",
    "F. P. Wardle, Proc. IMechE 202 C (1988) 305 (vibration of ball bearings by waviness).",
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
    compute = compute_bearing if brief else compute_with_parts
    computed = compute(prepared, progress)
    seen = observed(computed, OF_BEARINGS)
    found = list(bearing_findings(case, computed.runs)) + seen.findings
    warn_of_findings(found)
    numerics = (*_numerics(prepared, time.monotonic() - began), *seen.numerics)
    scenario = scenario_group(case, numerics)
    scenario[contact.VALIDITY] = [finding.row() for finding in found]
    laid_out = scenario | motion_group(computed) | seen.values
    result = bearing.with_ring_forces(tree(laid_out))
    result.attrs = root_attributes(
        case,
        case.title,
        (*SOURCES, case.bearing.bearing.SOURCE, *seen.sources),
        _verdict(case, seen.values),
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
    some = {bearing.FLANK_FORCE: stacked("flank_force"), bearing.RIB_FORCE: stacked("rib_force")}
    motion: Values = recorded_group(computed) | {
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
    return motion | {entry: forces for entry, forces in some.items() if forces.size}


# --- in one sentence

NOTHING_STANDS_OUT = (
    f"No part has a line {STANDS_OUT:g} times above what is around it in the envelope, and two such multiples"
)
"""Fainter lines of a fault are not denied: in a longer record, or with their side bands, they may be told."""


def _verdict(case: BearingUnderLoad, heard: Values) -> str:
    """How quiet the bearing is, by what in each band, and which part is heard if it has faults.

    Without, beats of waves of the parts lie in the envelope, some of them where lines of others would.
    """
    of = case.bearing.bearing
    velocities = heard[bearing.BAND_VELOCITY].values[0]
    judged = zip(velocities[0], heard[bearing.JUDGED_BAND].values, _deciding(heard), strict=True)
    told = ", ".join(
        f"{rounded(1e6 * rms)} µm/s in {band}{part}" for rms, band, part in judged if np.isfinite(rms)
    )
    clear = heard[bearing.LINES_FOUND].values[0]
    lines = zip(PARTS, clear, heard[bearing.LINE_FREQUENCY].values[0], strict=True)
    at_speed = at_fastest(case.speed, "1/min", 60.0)
    parts = " and of the ".join(
        f"{names_in(of)[part]} ({rounded(at[0], 4)} Hz{at_speed})" for part, found, at in lines if found
    )
    law = case.laws[0]
    first = f" at {rounded(math.degrees(case.sensors[0]))}°" if len(case.sensors) > 1 else ""
    if law != BY_PARTS and "% from" in told:
        told += f"; shares by {BY_PARTS}"
    lead = f"Radial velocity{first} by {law}: {told or 'no band is sampled'}"
    if not np.nan_to_num(velocities).any() and told:
        lead = f"Nothing vibrates by {law}: all {of.ELEMENT}s are carried alike, on surfaces without waves"
    struck = f"Its envelope has lines of the {parts}" if parts else NOTHING_STANDS_OUT
    return f"{lead}. {f'{struck}. ' if case.faults else ''}{omitted_from(case)}"


def _deciding(heard: Values) -> list[str]:
    """Which part makes most of each band, or which do within chance, in brackets after a blank.

    Empty where none is known to.
    """
    found = [""] * len(ISO_BANDS)
    if bearing.SOURCE in heard:
        squares = heard[bearing.ALONE_VELOCITY].values.T ** 2
        scatter = 2.0 * squares * np.nan_to_num(heard[bearing.ALONE_DEVIATION].values.T)
        for band in np.flatnonzero(np.isfinite(squares).all(axis=1)):
            found[band] = _most_of(heard[bearing.SOURCE].values, squares[band], scatter[band])
    return found


def _most_of(names: Array, squares: Array, scatter: Array) -> str:
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


def _numerics(prepared: PreparedBearing, wall: float) -> Iterator[tuple[str, str]]:
    """Numbers of the computation: names and values."""
    case = prepared.case
    yield "time step", f"{rounded(case.step * 1e6, 4)} µs"
    yield "time steps per sample that is written", f"{case.steps_per_sample}"
    element = case.bearing.bearing.ELEMENT
    yield f"resonance of the most loaded {element} between the rings", f"{rounded(case.ball_resonance, 4)} Hz"
    yield "imbalance of the static solution", f"{rounded(case.static.imbalance, 1)} of the load"
    yield from rims_in_words(prepared)
    yield "wall time", f"{wall:.2f} s"
