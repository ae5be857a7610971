"""Velocities of a wheel's modes from spectra whose lines are far wider than its resonances."""

import numpy as np

from asperity.radiation.wheel import modal_velocity_psd
from asperity.spectra import band_energies, psd, third_octave_bands
from asperity.structures.wheel import Wheel

RATE, SAMPLES = 20e3, 2**19  # 26 s
LISTS = [430.0, 1600.0, 2450.0], [1e-2, 1e-3, 3e-4], [2000.0, 300.0, 800.0]
WHEEL = Wheel(600.0, 65e3, *LISTS)
MODES = [
    lambda w, o=2 * np.pi * f, z=z, m=m: 1 / (m * (o**2 - w**2 + 2j * z * o * w))
    for f, z, m in zip(*LISTS, strict=True)
]
OTHER = 1.0 / 1.2e9 * (1.0 - 0.3j)  # of contact and rail, m/N


def steady_motion():
    """Force between a wheel and a damped spring over a rough path, and what each mode makes of it."""
    frequency = np.fft.rfftfreq(SAMPLES, 1.0 / RATE)
    omega = 2.0 * np.pi * np.maximum(frequency, 1e-3)
    roughness = np.fft.rfft(np.random.default_rng(1).standard_normal(SAMPLES)) * 1e-6
    roughness[frequency < 50.0] = 0.0
    receptance = [-1.0 / (WHEEL.mass * omega**2)]
    receptance += [each(omega) for each in MODES]
    force = roughness / (sum(receptance) + OTHER)
    moved = [1j * omega * each * force for each in receptance]
    return np.fft.irfft(force), np.fft.irfft(sum(receptance) * force), [np.fft.irfft(v) for v in moved]


def test_bands_of_modal_velocities_are_those_of_the_motion():
    force, displacement, velocities = steady_motion()
    segment = 4000  # lines of 5 Hz, as in a run; the last mode is 1.5 Hz wide
    frequency, force_psd = psd(force, 1.0 / RATE, segment=segment)
    _, motion = psd(displacement, 1.0 / RATE, segment=segment)
    used = frequency > 0.0
    lines = frequency[used]
    compliance = np.full(lines.size, abs(OTHER))
    found = modal_velocity_psd(WHEEL, lines, force_psd[None, used], motion[None, used], compliance)
    _, low, high = third_octave_bands(200.0, 3200.0)
    for mode, velocity in enumerate(velocities):
        _, exact = psd(velocity, 1.0 / RATE, segment=5 * segment)
        fine = np.fft.rfftfreq(5 * segment, 1.0 / RATE)
        expected = band_energies(fine, exact, low, high)
        level = 10.0 * np.log10(band_energies(lines, found[mode, 0], low, high) / expected)
        assert np.abs(level).max() < 0.6, (mode, level)
    omega = 2.0 * np.pi * lines  # what the force alone would say, line by line
    alone = np.abs(MODES[-1](omega)) ** 2
    level = 10.0 * np.log10(band_energies(lines, omega**2 * alone * force_psd[used], low, high) / expected)
    assert np.abs(level).max() > 5.0, level


def test_of_a_rigid_wheel_it_is_the_velocity_of_its_mass():
    wheel, lines = Wheel(600.0, 65e3), np.arange(100.0, 200.0, 5.0)
    omega = 2.0 * np.pi * lines
    force = np.full((1, lines.size), 3.0)
    displacement = force / (600.0 * omega**2) ** 2
    found = modal_velocity_psd(wheel, lines, force, displacement, np.full(lines.size, 1e-9))
    np.testing.assert_allclose(found[0], force / (600.0 * omega) ** 2, rtol=2e-3)
