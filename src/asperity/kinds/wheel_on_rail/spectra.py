"""The group of a wheel-on-rail result that shows spectra: force, rail motion, roughness and sound power."""

from __future__ import annotations

import math

import numpy as np
import xarray
from numpy.typing import NDArray

from asperity.kinds.wheel_on_rail.compute import Computed
from asperity.kinds.wheel_on_rail.linear_reference import linear_force_psd
from asperity.kinds.wheel_on_rail.noise_group import noise_variables
from asperity.results import variable
from asperity.scenarios.laws import working_point
from asperity.scenarios.tree import (
    law_coordinate,
    level_differences,
    product_variable,
    spectrum_segment,
)
from asperity.spectra import averaging_time, band_levels, psd
from asperity.surfaces.heightmap import Profile
from asperity.surfaces.levels import band_levels_of

VELOCITY_REFERENCE = 1e-9


def spectra_group(computed: Computed) -> xarray.Dataset:
    """Lay out the spectra of a run.

    Parameters
    ----------
    computed : Computed
        What was computed.

    Returns
    -------
    xarray.Dataset
        PSDs, one-third octaves, differences to the linear law, and their consequence for sound power.
    """
    step, highest = computed.case.time_step, computed.case.numerics.highest_frequency
    laws = list(computed.chain.runs)
    samples = len(computed.chain.runs[laws[0]].time)
    segment = spectrum_segment(samples, step)
    time = averaging_time(samples, step, segment=segment)
    frequency, force = psd(computed.chain.stacked("contact_force"), step, segment=segment)
    band, force_level = band_levels(frequency, force, high=highest)
    shown = (frequency > 0.0) & (frequency <= 1.13 * highest)
    reference, texture = linear_reference(computed, frequency, segment)
    _, reference_level = band_levels(frequency, reference, high=highest)
    variables = {
        "law": law_coordinate(computed.chain),
        "frequency": variable("frequency", frequency[shown], "Hz", "frequency"),
        "band": variable("band", band, "Hz", "one-third-octave band centre"),
        "band_time_product": product_variable("band", band, time),
        "force_psd": variable(
            ("law", "frequency"), force[:, shown], "N2/Hz", "PSD of the contact force, one-sided"
        ),
        "force_level": variable(("law", "band"), force_level, "dB re 1 N", "contact force level"),
        "texture_psd": variable(
            "frequency", texture[shown], "m2/Hz", "PSD of the texture passed by, one-sided"
        ),
        "linear_reference_psd": variable(
            "frequency",
            reference[shown],
            "N2/Hz",
            "PSD of the contact force, linear, by frequency, with constant loss factors",
        ),
        "linear_reference_level": variable(
            "band", reference_level, "dB re 1 N", "contact force level, linear, in the frequency domain"
        ),
    }
    variables |= level_differences(laws, force_level) | _points(computed, segment)
    variables |= _roughness(computed) | noise_variables(computed, band, force_level)
    if "noise_band" in variables:
        centres = variables["noise_band"].values
        variables["noise_band_time_product"] = product_variable("noise_band", centres, time)
    return xarray.Dataset(variables, attrs=_attributes(computed))


def linear_reference(
    computed: Computed, frequency: NDArray[np.float64], segment: int
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """One-sided PSDs (f,) of the force of the linear contact, N²/Hz, and of the texture passed, m²/Hz.

    In the frequency domain; the track is the nominal one, with constant loss factors. Frequencies (f,) of the
    spectra, from zero, Hz; segments in time steps.
    """
    case, chain = computed.case, computed.chain
    run = next(iter(chain.runs.values()))
    textures = chain.textures
    at = textures.start + case.contact.spacing * np.arange(len(textures.line))
    passed = np.interp(run.position, at, textures.followed)
    _, texture = psd(passed, case.time_step, segment=segment)
    _, stiffness = working_point(case.contact, chain.shape, chain.reduction)
    force = np.zeros_like(texture)
    above = frequency > 0.0
    force[above] = linear_force_psd(
        frequency[above], texture[above] * case.speed, case.speed, computed.wheel, computed.track, stiffness
    )
    return force, texture


def _points(computed: Computed, segment: int) -> dict[str, xarray.Variable]:
    step, highest = computed.case.time_step, computed.case.numerics.highest_frequency
    _, velocity = computed.points
    frequency, density = psd(velocity, step, segment=segment)
    shown = (frequency > 0.0) & (frequency <= 1.13 * highest)
    _, level = band_levels(frequency, density, VELOCITY_REFERENCE, high=highest)
    return {
        "point": point_coordinate(computed),
        "point_velocity_psd": variable(
            ("law", "point", "frequency"),
            density[..., shown],
            "(m/s)2/Hz",
            "PSD of the rail's velocity at a point passed by, one-sided",
        ),
        "point_velocity_level": variable(
            ("law", "point", "band"), level, "dB re 1 nm/s", "velocity level of the rail at a point passed by"
        ),
    }


def point_coordinate(computed: Computed) -> xarray.Variable:
    """Positions of the points that are passed, as a coordinate.

    Parameters
    ----------
    computed : Computed
        What was computed.

    Returns
    -------
    xarray.Variable
        m from a sleeper.
    """
    return variable("point", np.array(computed.case.point_positions), "m", "point on the rail passed by")


def _roughness(computed: Computed) -> dict[str, xarray.Variable]:
    """Band levels of rail and wheel over wavelength, without flat and joint."""
    textures, spacing = computed.chain.textures, computed.case.contact.spacing
    lines = {**textures.parts, "combined": textures.line}
    found = {name: band_levels_of(Profile(line, spacing)) for name, line in lines.items()}
    wavelength = found["combined"][0]
    levels = np.stack([level for _, level in found.values()])
    averaged = averaging_time(len(textures.line), spacing)
    return {
        "part": variable("part", np.array(list(found)), "1", "what bears the texture"),
        "surface_band": variable("surface_band", wavelength, "m", "wavelength of the one-third octave"),
        "surface_band_length_product": product_variable("surface_band", 1.0 / wavelength, averaged, "length"),
        "roughness_level": variable(
            ("part", "surface_band"),
            np.where(np.isfinite(levels), levels, np.nan),
            "dB re 1 um",
            "roughness level of the line rolled over",
        ),
    }


def _attributes(computed: Computed) -> dict[str, float]:
    case, track = computed.case, computed.track
    half = 0.5 * case.speed / track.sleeper_spacing
    pinned = track.pinned_pinned_frequency
    return {
        "sleeper_passing_frequency": 2.0 * half,
        "pinned_pinned_low": pinned - half,
        "pinned_pinned_high": pinned + half,
        "wheel_revolution_frequency": case.speed / (2.0 * math.pi * case.wheel.radius),
    }
