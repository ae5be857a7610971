"""What stands for the loss factors of a track in time, and how far the contact force is off for it."""

from __future__ import annotations

import warnings
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from asperity.errors import Grade, LossFactorWarning
from asperity.scenarios.laws import working_point
from asperity.scenarios.linear_force import WheelReceptance
from asperity.scenarios.validity import Finding
from asperity.scenes import schema
from asperity.scenes.compute import Computed
from asperity.schema import Entry
from asperity.spectra import nominal_frequency, third_octave_bands
from asperity.structures.causal_track import causal_track
from asperity.structures.track import Track

LOWEST = 5.0
"""Frequency in the first one-third octave, Hz."""
LINES, POSITIONS = 64, 12
"""Frequencies in a band, and places in half a bay."""
DOUBTFUL = 0.75
"""Error of a band, dB, from which on it is warned of."""


@dataclass(frozen=True, eq=False)
class LossFactorError:
    """What the causal track changes of a track with constant loss factors, for a linear contact at rest."""

    track: Track  # with constant loss factors
    bands: NDArray[np.float64]  # (b,), centres of one-third octaves, Hz
    force: NDArray[np.float64]  # (b,), level of the contact force over that with constant loss factors, dB
    rail: NDArray[np.float64]  # (b,), level of the rail's displacement under a given force over that, dB

    @property
    def worst(self) -> int:
        """Index of the band whose force is farthest off."""
        return int(np.argmax(np.abs(self.force)))


def loss_factor_error(
    track: Track, wheel: WheelReceptance, stiffness: float, highest: float
) -> LossFactorError:
    """Compare a track with the causal one that stands for it in time; the error of a causal one is zero.

    Tangent stiffness of the contact at the static load, N/m; bands from 5 Hz to that of `highest`, Hz. In
    each band of mean squares over a bay and over the band, for a texture that is white in it.
    """
    bands, low, high = third_octave_bands(LOWEST, highest)
    steps = (np.arange(LINES) + 0.5) / LINES
    frequency = (low[:, None] + (high - low)[:, None] * steps).ravel()
    places = (np.arange(POSITIONS) + 0.5) * 0.5 * track.sleeper_spacing / POSITIONS

    def levels(rail: Track) -> NDArray[np.float64]:
        moved = rail.receptance(frequency, places, places)
        force = 1.0 / (wheel.receptance(frequency) + 1.0 / stiffness + moved)  # as `force_transfer`
        squares = [
            np.mean(np.abs(found) ** 2, axis=0).reshape(-1, LINES).mean(axis=1) for found in (force, moved)
        ]
        return 10.0 * np.log10(np.array(squares))

    force, rail = levels(causal_track(track)) - levels(track)
    return LossFactorError(track, bands, force, rail)


def warn_of_loss_factors(error: LossFactorError) -> None:
    """Say where loss factors change the contact force of a band by more than is tolerable, 0.75 dB."""
    off = np.flatnonzero(np.abs(error.force) > DOUBTFUL)
    if not off.size:
        return
    layer, factor, remedy = _largest(error.track, error.bands[error.worst])
    bands = ", ".join(nominal_frequency(error.bands[i]) for i in off)
    warnings.warn(
        f"the contact force in time is up to {signed_level(error.force[error.worst])} dB from that with "
        f"constant loss factors, more than {DOUBTFUL:g} dB in the one-third octaves of {bands}: nothing "
        f"that answers after a force only has the loss factor {factor:g} of the {layer} at all "
        f"frequencies. Read these bands with their error, or {remedy}.",
        LossFactorWarning,
        stacklevel=2,
    )


def _largest(track: Track, frequency: float) -> tuple[str, float, str]:
    """Part with the largest loss factor, the factor, and what to do about it."""
    parts = {
        "rail": track.rail_loss_factor,
        "pad": track.pad_loss_factor,
        "ballast": track.ballast_loss_factor,
    }
    layer, factor = max(((name, eta or 0.0) for name, eta in parts.items()), key=lambda item: item[1])
    if layer == "rail":
        return layer, factor, "give the rail a smaller one"
    stiffness = track.pad_stiffness if layer == "pad" else track.ballast_stiffness
    damping = 1e-3 * stiffness * factor / (2.0 * np.pi * frequency)
    remedy = (
        f"give {layer}_damping, which is exact: {damping:.3g} kN s/m dissipate as much at {frequency:.3g} Hz"
    )
    return layer, factor, remedy


def signed_level(level: float) -> str:
    """Write a level difference with its sign, to 0.1 dB."""
    return f"{level:+.1f}".replace("-", "−")


LEAST_SHOWN = 0.05
"""Errors below this, dB, are not listed."""


def error_of_losses(computed: Computed) -> LossFactorError:
    """Error of the contact force in bands, for the contact stiffness at the load."""
    case = computed.case
    _, stiffness = working_point(case.contact, computed.chain.shape, computed.chain.reduction)
    return loss_factor_error(computed.track, computed.scene.first, stiffness, case.numerics.highest_frequency)


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
