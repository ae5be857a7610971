"""Motion of rail and sleepers along a track, against sums over many bays."""

import math

import numpy as np
import pytest

from asperity import Track
from asperity.errors import InputError
from asperity.radiation.track import (
    effective_length,
    squared_mobility,
    squared_point_mobility,
    squared_sleeper_mobility,
)
from asperity.structures.track import decay_rate

TRACKS = {
    "uic60": Track.named("uic60"),
    "loss factors": Track.named("nordborg-loss-factor", rail_loss_factor=0.05),
}
BAYS = 80
FREQUENCIES = np.array([80.0, 250.0, 500.0, 1063.0])


def bay_by_bay(track, cells=32, forces=16):
    """Squared mobility, summed over many bays on both sides, forces on edges of cells; of sleepers."""
    bay, omega = track.sleeper_spacing, 2.0 * np.pi * FREQUENCIES
    places = (np.arange(-BAYS * cells, BAYS * cells) + 0.5) * bay / cells
    waves = track.waves(omega)
    pad, ballast = (each.stiffness(omega) for each in (track.support.pad, track.support.ballast))
    passed_on = pad / (pad + ballast - track.sleeper_mass * omega**2)
    rail, sleepers = [], []
    for x0 in (np.arange(forces) + 0.5) * bay / forces:
        moved = np.array([waves.receptance(x, x0) for x in places])
        above = np.array([waves.receptance(n * bay, x0) for n in range(-BAYS, BAYS)])
        rail.append(np.sum(np.abs(omega * moved) ** 2, axis=0) * bay / cells)
        sleepers.append(np.sum(np.abs(omega * passed_on * above) ** 2, axis=0))
    return np.mean(rail, axis=0), np.mean(sleepers, axis=0)


@pytest.mark.parametrize("name", TRACKS)
def test_the_sums_over_bays_are_those_of_superposition(name):
    rail, sleepers = bay_by_bay(TRACKS[name])
    np.testing.assert_allclose(squared_mobility(TRACKS[name], FREQUENCIES), rail, rtol=3e-4)
    np.testing.assert_allclose(squared_sleeper_mobility(TRACKS[name], FREQUENCIES), sleepers, rtol=3e-4)


def test_one_wave_of_decay_rate_d_has_a_length_of_8_686_over_d():
    """A rail that hardly bends but shears, on nothing: exp(-ik|x|), k = ω √(m'/S), and 1/-Im k long."""
    rail = Track(
        bending_stiffness=1e9, mass_per_length=60.0, pad_stiffness=1e3, sleeper_mass=0.0,
        ballast_stiffness=1e3, sleeper_spacing=0.05, rail_loss_factor=0.05,
        shear_stiffness=2e7, rotary_inertia=1e-3,
    )  # fmt: skip
    frequency = np.array([500.0])
    decay = -(2.0 * np.pi * frequency * np.sqrt(60.0 / (2e7 * (1.0 + 0.05j)))).imag
    np.testing.assert_allclose(decay_rate(rail, frequency), 20.0 * math.log10(math.e) * decay, rtol=1e-3)
    expected = 8.686 / decay_rate(rail, frequency)
    np.testing.assert_allclose(effective_length(rail, frequency), expected, rtol=1e-3)


def test_the_near_field_halves_the_length_of_a_bending_wave():
    """|Y| at the force of a free Euler-Bernoulli rail is √2 of that of its travelling wave."""
    rail = Track(4.725e6, 60.0, 1e3, 0.0, 1e3, 0.6, rail_loss_factor=1e-3)
    frequency = np.array([1000.0])
    travelling = 20.0 * math.log10(math.e) / decay_rate(rail, frequency)
    assert effective_length(rail, frequency) == pytest.approx(0.5 * travelling, rel=5e-3)


def test_what_a_force_puts_into_a_track_is_lost_in_rail_pads_and_ballast():
    """Energy: Re Y(x₀|x₀)/2·2 equals what viscous dampers take, without loss in the rail."""
    track = Track.named("uic60", rail_loss_factor=0.0)
    frequency = np.array([100.0, 400.0, 1063.0, 2500.0])
    omega = 2.0 * np.pi * frequency
    waves, bay = track.waves(omega), track.sleeper_spacing
    node, weight = np.polynomial.legendre.leggauss(24)
    put_in = sum(
        0.5 * w * (1j * omega * waves.receptance(0.5 * bay * (u + 1.0), 0.5 * bay * (u + 1.0))).real
        for u, w in zip(node, weight, strict=True)
    )
    pad, ballast = (each.stiffness(omega) for each in (track.support.pad, track.support.ballast))
    below = pad / (pad + ballast - track.sleeper_mass * omega**2)
    sleepers = squared_sleeper_mobility(track, frequency)
    squeezed = sleepers * np.abs((1.0 - below) / below) ** 2  # of the pads, per force
    lost = track.pad_damping * squeezed + track.ballast_damping * sleepers
    np.testing.assert_allclose(lost, put_in, rtol=1e-6)


def test_the_point_mobility_is_that_of_the_track():
    track = TRACKS["uic60"]
    places = (np.arange(200) + 0.5) * track.sleeper_spacing / 200
    mean = np.mean([abs(2.0 * math.pi * 700.0 * track.receptance(700.0, x, x)) ** 2 for x in places])
    assert squared_point_mobility(track, 700.0)[0] == pytest.approx(mean, rel=1e-5)


@pytest.mark.parametrize("measure", [squared_mobility, squared_sleeper_mobility, effective_length])
def test_a_frequency_of_zero_is_refused(measure):
    with pytest.raises(InputError, match=r"frequency \(Hz\): received 0.0; allowed: finite positive"):
        measure(TRACKS["uic60"], [0.0, 100.0])
