"""What stands for the loss factors of a track in time, and how far the contact force is off for it."""

from __future__ import annotations

import warnings
from collections.abc import Iterator
from typing import Any

import numpy as np

from asperity.errors import Grade, PhysicsWarning
from asperity.kinds.wheel_on_rail import schema
from asperity.kinds.wheel_on_rail.bodies import wheel_of
from asperity.kinds.wheel_on_rail.case import WheelOnRail
from asperity.kinds.wheel_on_rail.compute import Computed
from asperity.kinds.wheel_on_rail.geometry import geometry_of
from asperity.kinds.wheel_on_rail.loss_factors import (
    DOUBTFUL,
    LossFactorError,
    loss_factor_error,
    signed_level,
)
from asperity.scenarios.laws import working_point
from asperity.scenarios.validity import Finding
from asperity.schema import Entry
from asperity.spectra import nominal_frequency
from asperity.structures.causal_track import causal_track

LEAST_SHOWN = 0.05
"""Errors below this, dB, are not listed."""


def error_of_losses(computed: Computed) -> LossFactorError:
    """Error of the contact force in bands, for the contact stiffness at the load."""
    case = computed.case
    _, stiffness = working_point(case.contact, computed.chain.shape, computed.chain.reduction)
    return loss_factor_error(computed.track, computed.wheel, stiffness, case.numerics.highest_frequency)


def expected_error_of_losses(case: WheelOnRail) -> LossFactorError:
    """Expect the error of the contact force in bands, with the stiffness of smooth bodies."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", PhysicsWarning)  # the run tells
        shape, wheel = geometry_of(case), wheel_of(case)
    _, stiffness = working_point(case.contact, shape, None)
    return loss_factor_error(case.track_model(), wheel, stiffness, case.numerics.highest_frequency)


def relaxed(error: LossFactorError) -> dict[Entry, Any]:
    """Lay out the stiffnesses that relax, and the errors in bands; nothing without loss factors."""
    track = causal_track(error.track)
    parts = {name: getattr(track.relaxations, name, None) for name in ("rail", "pad", "ballast")}
    layers = {name: found.at(2.0 * np.pi * error.bands) for name, found in parts.items() if found is not None}
    if not layers:
        return {}
    stiffness = np.array(list(layers.values()))
    factors = [getattr(error.track, f"{name}_loss_factor") for name in layers]
    return {
        schema.TRACK_BAND: error.bands,
        schema.LAYER: list(layers),
        schema.LOSS_FACTOR_FORCE_ERROR: error.force,
        schema.LOSS_FACTOR_RAIL_ERROR: error.rail,
        schema.LOSS_FACTOR: factors,
        schema.RELAXED_STIFFNESS: stiffness.real,
        schema.RELAXED_LOSS_FACTOR: stiffness.imag / stiffness.real,
    }


def findings_of_losses(error: LossFactorError) -> list[Finding]:
    """Hold the error of the contact force to its limit; nothing where the track has no loss factors."""
    if error.track.is_causal:
        return []
    worst, limit = error.worst, f"up to {DOUBTFUL:g} dB"
    grade = Grade.WARNING if abs(error.force[worst]) > DOUBTFUL else None
    value = f"{signed_level(error.force[worst])} dB ({nominal_frequency(error.bands[worst])})"
    meaning = "Nothing that answers after a force only has one loss factor at all frequencies."
    remedy = "Give the layers a damping instead, which is exact."
    name = "error of the contact force for constant loss factors, at most"
    return [Finding(name, value, limit, grade, meaning, remedy, "", (), told=True)]


def described_losses(error: LossFactorError, load: float) -> Iterator[tuple[str, str]]:
    """Say how far the force is off in each band, and how much softer the track is at rest under a load, N.

    Names and values; nothing where the track has no loss factors.
    """
    nominal, track = error.track, causal_track(error.track)
    if nominal.is_causal or track.relaxations is None:
        return
    off = [
        f"{nominal_frequency(band)} {signed_level(level)}"
        for band, level in zip(error.bands, error.force, strict=True)
        if abs(level) >= LEAST_SHOWN
    ]
    shown = [*off, f"{'else ' if off else ''}below {LEAST_SHOWN:g}"]
    yield "loss factors in time", f"error of the contact force, dB: {', '.join(shown)}"
    parts = (
        ("rail", track.relaxations.rail),
        ("pads", track.relaxations.pad),
        ("ballast", track.relaxations.ballast),
    )
    shares = ", ".join(f"{part} {found.static:.2f}" for part, found in parts if found is not None)
    half = 0.5 * track.sleeper_spacing
    rest, was = (1e3 * each.static_deflection(load, half) for each in (track, nominal))
    told = (
        f"of the nominal one: {shares}; the load at mid-span rests {rest:.3g} mm down, nominally {was:.3g} mm"
    )
    yield "stiffness at rest", told
