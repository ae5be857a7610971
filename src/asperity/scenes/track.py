"""What is looked at where a track is rolled over: texture, linear reference, the rail and its answer."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import xarray
from numpy.typing import NDArray

from asperity.reduction.texture import along_path
from asperity.reference.decay_rate_limit import iso_3095_decay_rate
from asperity.scenarios.laws import working_point
from asperity.scenarios.linear_force import coupled_force_psd, linear_force_psd
from asperity.scenarios.tree import drawn, product_of_bands, spectrum_segment
from asperity.scenes import schema
from asperity.scenes.compute import Computed
from asperity.scenes.loss_factors import error_of_losses, relaxed
from asperity.scenes.sound import noise, radiation
from asperity.schema import Attribute, Entry, attributes, variables
from asperity.spectra import averaging_time, band_levels, psd
from asperity.structures.rail_poles import RailPoles
from asperity.structures.track import decay_rate, decay_rate_en15461
from asperity.surfaces.bands import band_levels_of
from asperity.surfaces.heightmap import Profile


def track_spectra(
    computed: Computed,
    frequency: NDArray[np.float64],
    force: NDArray[np.float64],
    band: NDArray[np.float64],
    force_level: NDArray[np.float64],
) -> dict[Entry, Any]:
    """Lay out texture, linear reference, motion of the rail, and sound power, of what rolls over a track.

    Frequencies of the spectra (f,), from zero, Hz; PSDs (laws, c, f), N²/Hz, and levels (laws, c, b), dB
    re 1 N, of all contact forces, in bands with centres (b,), Hz.
    """
    step, highest = computed.case.time_step, computed.case.numerics.highest_frequency
    samples = len(next(iter(computed.chain.runs.values())).time)
    segment = spectrum_segment(samples, step)
    shown = drawn(frequency, highest)
    reference, texture = linear_reference(computed, frequency, segment)
    found: dict[Entry, Any] = {
        schema.TEXTURE_PSD: texture[shown],
        schema.LINEAR_REFERENCE_PSD: reference[shown],
        schema.LINEAR_REFERENCE_LEVEL: band_levels(frequency, reference, high=highest)[1],
    }
    found |= _points(computed, segment) | _roughness(computed) | noise(computed, band, force_level)
    found |= radiation(computed, band, frequency, force, segment)
    if schema.NOISE_BAND in found:
        centres, time = found[schema.NOISE_BAND], averaging_time(samples, step, segment=segment)
        product = product_of_bands(schema.NOISE_BAND_TIME_PRODUCT, centres, time)
        found[schema.NOISE_BAND_TIME_PRODUCT] = product
    return found


def linear_reference(
    computed: Computed, frequency: NDArray[np.float64], segment: int
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """One-sided PSDs (f,) of the force of the linear contact, N²/Hz, and of the texture passed, m²/Hz.

    In the frequency domain; the track is the nominal one, with constant loss factors. Frequencies (f,) of the
    spectra, from zero, Hz; segments in time steps.
    """
    case, chain = computed.case, computed.chain
    textures, position = chain.textures, next(iter(chain.runs.values())).positions[0]

    def passed(line: NDArray[np.float64]) -> NDArray[np.float64]:
        """PSD of a line at the contact."""
        at = along_path("texture", line[None, :], textures.start, case.contact.spacing, position)[:, 0]
        return psd(at, case.time_step, segment=segment)[1]

    texture = passed(textures.followed)
    _, stiffness = working_point(case.contact, chain.shape, chain.reduction)
    force, above = np.zeros_like(texture), frequency > 0.0
    lines, speed, scene, track = frequency[above], case.speed, computed.scene, computed.track
    if len(scene.offsets) == 1:
        seen = texture[above] * speed
        force[above] = linear_force_psd(lines, seen, speed, scene.first, track, stiffness)
        return force, texture
    own = passed(textures.parts["wheel"]) if textures.parts else np.zeros_like(texture)
    path = passed(textures.followed - textures.parts["wheel"]) if textures.parts else texture
    places = track.sleeper_spacing * (np.arange(PLACES) + 0.5) / PLACES
    force[above] = coupled_force_psd(lines, path[above], own[above], speed, scene, stiffness, places)
    return force, texture


def _points(computed: Computed, segment: int) -> dict[Entry, Any]:
    step, highest = computed.case.time_step, computed.case.numerics.highest_frequency
    _, velocity = computed.points
    frequency, density = psd(velocity, step, segment=segment)
    shown = drawn(frequency, highest)
    _, level = band_levels(frequency, density, schema.VELOCITY_REFERENCE, high=highest)
    return {
        schema.SPECTRA_POINT: computed.scene.points,
        schema.POINT_VELOCITY_PSD: density[..., shown],
        schema.POINT_VELOCITY_LEVEL: level,
    }


def _roughness(computed: Computed) -> dict[Entry, Any]:
    """Band levels of rail and wheel over wavelength, without flat and joint."""
    textures, spacing = computed.chain.textures, computed.case.contact.spacing
    lines = {**textures.parts, "combined": textures.line}
    found = {name: band_levels_of(Profile(line, spacing)) for name, line in lines.items()}
    wavelength = found["combined"][0]
    averaged = averaging_time(len(textures.line), spacing)
    product = product_of_bands(schema.SURFACE_BAND_LENGTH_PRODUCT, 1.0 / wavelength, averaged)
    return {
        schema.PART: list(found),
        schema.SURFACE_BAND: wavelength,
        schema.SURFACE_BAND_LENGTH_PRODUCT: product,
        schema.ROUGHNESS_LEVEL: np.stack([level for _, level in found.values()]),
    }


def track_facts(computed: Computed) -> dict[Attribute, float]:
    """Frequencies that speed, track and wheel have of themselves."""
    case, track = computed.case, computed.track
    half = 0.5 * case.speed / track.sleeper_spacing
    pinned = track.pinned_pinned_frequency
    return {
        schema.SLEEPER_PASSING_FREQUENCY: 2.0 * half,
        schema.PINNED_PINNED_LOW: pinned - half,
        schema.PINNED_PINNED_HIGH: pinned + half,
        schema.WHEEL_REVOLUTION_FREQUENCY: case.speed / (2.0 * math.pi * case.rolling_radius),
    }


PLACES = 12
"""Of several contacts in a bay, over which their linear forces are averaged."""
LOWEST_FREQUENCY = 20.0
FREQUENCIES = 600
KERNEL_STARTS = 6
KERNEL_LAG = 0.25
"""Longest lag of the moving kernel that is kept in a result, s."""


def track_group(computed: Computed) -> xarray.Dataset:
    """Lay out what the wheel rolls on: receptances, decay rates, moving kernel, loss factors and numbers.

    None of it depends on what has rolled.
    """
    track, case = computed.track, computed.case
    frequency = np.geomspace(LOWEST_FREQUENCY, case.numerics.highest_frequency, FREQUENCIES)
    half = 0.5 * track.sleeper_spacing
    midspan, support = track.receptance(frequency, [half, 0.0], [half, 0.0])
    _, stiffness = working_point(case.contact, computed.chain.shape, computed.chain.reduction)

    found = {
        schema.TRACK_FREQUENCY: frequency,
        schema.RECEPTANCE_MIDSPAN: np.abs(midspan),
        schema.RECEPTANCE_MIDSPAN_PHASE: np.angle(midspan),
        schema.RECEPTANCE_SUPPORT: np.abs(support),
        schema.RECEPTANCE_SUPPORT_PHASE: np.angle(support),
        schema.WHEEL_RECEPTANCE: np.abs(computed.scene.first.receptance(frequency)),
        schema.CONTACT_RECEPTANCE: np.full(FREQUENCIES, 1.0 / stiffness),
        schema.DECAY_RATE: decay_rate(track, frequency),
        schema.DECAY_RATE_EN15461: decay_rate_en15461(track, frequency),
        schema.DECAY_RATE_LIMIT: iso_3095_decay_rate(frequency),
    }
    found |= _kernel(computed) | relaxed(error_of_losses(computed))
    return xarray.Dataset(variables(found), attrs=attributes(_track_facts(computed)))


def _kernel(computed: Computed) -> dict[Entry, NDArray[np.float64]]:
    kernel = computed.kernel
    positions, taps = kernel.weights.shape
    rows = np.arange(0, positions, max(1, positions // KERNEL_STARTS))
    kept = slice(0, min(taps, round(KERNEL_LAG / kernel.time_step)))
    responses = kernel.weights[rows, kept] / kernel.time_step
    starts = rows * computed.track.sleeper_spacing / positions
    return {
        schema.START_POSITION: starts,
        schema.LAG: kernel.lag[kept],
        schema.MOVING_KERNEL: responses,
    }


def _track_facts(computed: Computed) -> dict[Attribute, float | int | str]:
    track, load, rail = computed.track, computed.chain.shape.load, computed.rail
    half = 0.5 * track.sleeper_spacing
    facts: dict[Attribute, float | int | str] = {
        schema.NAME: track.name,
        schema.SLEEPER_SPACING: track.sleeper_spacing,
        schema.PINNED_PINNED_FREQUENCY: track.pinned_pinned_frequency,
        schema.CUT_ON_FREQUENCY: track.cut_on_frequency,
        schema.ANTIRESONANCE_FREQUENCY: track.antiresonance_frequency,
        schema.CRITICAL_SPEED: track.critical_speed,
        schema.STATIC_DEFLECTION: track.static_deflection(load, half),
        schema.STATIC_DEFLECTION_IN_TIME: computed.kernel.track.static_deflection(load, half),
        schema.KERNEL_METHOD: "poles" if isinstance(rail, RailPoles) else "scatter",
    }
    if isinstance(rail, RailPoles):
        facts |= {schema.KERNEL_FIT_ERROR: rail.fit_error, schema.KERNEL_POLES: rail.count}
    return facts
