"""The sound of a run over a track, computed a second time: by frequency, at fixed points, and on paper.

What a run in time tells of force, rail and microphone is held against other formulas: the contact force by
receptances of wheel, contact and rail at places that stand still, which are the package's own, the motion of
the rail by points that the wheel passes, the level by a line source; and what waves along the rail, and their
near field, make of that level.
"""

from __future__ import annotations

import numpy as np
from scipy.special import hankel2

from asperity.radiation.track import IMPEDANCE, wavenumber
from asperity.reference import cnossos
from asperity.scenarios.scene import force_transfer, scene_of
from asperity.scenes.noise import rail_section
from asperity.spectra import HALF_BAND, a_weighting

PLACES = (np.arange(24) + 0.5) / 24
"""Of the contact, in bays."""
HERTZ = 9.413e10
"""N/m^1.5, of a wheel of 0.46 m on a rail of 0.30 m, of steel."""
STEP = 2.5
"""Hz."""
POINTS = 19.2 + 0.6 * (np.arange(6) + 0.5) / 6
"""Places of a bay in the middle of the run, m, at which the rail is watched."""


APART, COUNT, LINES = 0.05, 3000, 9
"""m between places of the rail on which waves are seen, how many, and frequencies in a band."""


def level(energy):
    return 10.0 * np.log10(energy)


def at_bands(tree, name, band):
    """Values of a result in bands, by their centres, Hz."""
    own = tree["spectra"]["band"].values
    return tree["spectra"][name].values[..., [int(np.argmin(np.abs(own - each))) for each in band]]


def in_bands(frequency, density, band):
    """Integrals of a density over one-third octaves."""
    return np.array(
        [density[(frequency >= f / HALF_BAND) & (frequency < f * HALF_BAND)].sum() * STEP for f in band]
    )


def force(case, tree, band):
    """Levels of the contact force, dB re 1 N, by receptances, the stated roughness and CNOSSOS-EU's filter.

    Then how much faster the rail moves at the contact than the unfiltered roughness rises, dB.
    """
    scene, frequency = scene_of(case), np.arange(80.0, 5700.0, STEP)
    track = scene.over.nominal
    stiffness = 1.5 * HERTZ ** (2.0 / 3.0) * case.rolling.load ** (1.0 / 3.0)
    places = PLACES * track.sleeper_spacing
    transfer = force_transfer(frequency, scene.first, track, stiffness, places)
    moved = transfer * track.receptance(frequency, places, places)
    spectra = tree["spectra"]
    waves = spectra["surface_band"].values
    stated = spectra["stated_roughness_level"].sel(part="combined").values
    known, place = np.isfinite(stated), np.log10(case.speed / frequency)
    rough = np.interp(place, np.log10(waves[known])[::-1], stated[known][::-1])
    at, gain = cnossos.contact_filter("50 kN, 920 mm")
    filtered = rough + np.interp(place, np.log10(at)[::-1], gain[::-1])
    per_hertz = 1e-12 / (frequency * (HALF_BAND - 1.0 / HALF_BAND))
    pressed = np.mean(np.abs(transfer) ** 2, axis=0) * 10.0 ** (0.1 * filtered) * per_hertz
    rising = 10.0 ** (0.1 * rough) * frequency**2 * per_hertz
    faster = in_bands(frequency, np.mean(np.abs(moved) ** 2, axis=0) * rising, band)
    return level(in_bands(frequency, pressed, band)), level(faster / in_bands(frequency, rising, band))


def rail_at_points(case, tree, band):
    """10 lg of ∫⟨v²⟩dx of the rail (bands,), by points that the wheel passes less by the sound power.

    Each point sees the whole rail go by: the time integral of v² there, times the speed, is that along it.
    """
    passed = 1e-18 * 10.0 ** (0.1 * at_bands(tree, "point_velocity_level", band)[0])
    seconds = case.time_step * tree["rolling"]["point_velocity"].shape[-1]
    along = passed.mean(axis=0) * seconds * case.speed
    section = rail_section(case, scene_of(case).over.nominal)
    power = 0.5e-12 * 10.0 ** (0.1 * at_bands(tree, "unmeasured_power_level", band)[0, 0])
    return level(along * IMPEDANCE * section.radiating_width * section.radiation_ratio(band) / power)


def at_microphone(tree, band, noise):
    """A-weighted level of the rail, dB, over hard ground: p² = W′ρc/2d of the power W′ per length."""
    power = 1e-12 * 10.0 ** (0.1 * at_bands(tree, "radiated_power_level", band)[0, 0])
    per_length = power * len(noise["axle_positions"]) / noise["vehicle_length"]
    inverse = np.mean(1.0 / near_rail_and_far(noise))
    squared = 0.5 * per_length * IMPEDANCE * inverse
    return level(squared / 4e-10) + noise["receiver_offset"] + a_weighting(band)


def near_rail_and_far(noise):
    """Distances of both rails from the microphone, m."""
    sides = noise["receiver_distance"] + np.array([-0.5, 0.5]) * noise["rail_distance"]
    return np.hypot(sides, noise["receiver_height"])


def heard_waves(k, beyond, distance):
    """Squared pressure of a passage of waves, by their wavenumbers along the rail, rad/m.

    Over that of as many sources that know nothing of each other, in the far field: k d |H₀(√(k² − k_x²) d)|².
    Waves slower than sound are heard in the near field alone.
    """
    across = np.sqrt(np.asarray(k**2 - beyond**2, dtype=complex))
    return k * distance * np.abs(hankel2(0, np.where(across.imag > 0.0, -across, across) * distance)) ** 2


def of_waves(track, band, noise, share):
    """What waves along the rail do to its level, with their near field, in place of incoherent sources, dB.

    The near rail has a share of the exposure.
    """
    frequency = (band[:, None] * HALF_BAND ** (2.0 * (np.arange(LINES) + 0.5) / LINES - 1.0)).ravel()
    waves = track.waves(2.0 * np.pi * frequency)
    along = APART * (np.arange(COUNT) - COUNT // 2)
    beyond, k = 2.0 * np.pi * np.fft.fftfreq(COUNT, APART), wavenumber(frequency)
    square = 0.0
    for place in track.sleeper_spacing * PLACES[::4]:
        moved = np.stack([waves.receptance(each, place) for each in along.tolist()])
        square = square + np.abs(np.fft.fft(moved, axis=0)) ** 2
    near, far = (
        np.sum(square * heard_waves(k, beyond[:, None], each), axis=0) / np.sum(square, axis=0)
        for each in near_rail_and_far(noise)
    )
    moving = frequency**2 * np.sum(square, axis=0)
    each = [
        (moving * by).reshape(len(band), LINES).sum(axis=1)
        for by in (share * near + (1.0 - share) * far, 1.0)
    ]
    return level(each[0] / each[1])
