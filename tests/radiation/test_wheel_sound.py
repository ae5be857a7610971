"""Sound of wheels, against a disc and a ring whose sound is known, and velocities of their modes in a run."""

import math

import numpy as np
import pytest
from disc_field import axial_ratio
from scipy.special import jv

from asperity.radiation import wheel as module
from asperity.radiation.track import IMPEDANCE, SPEED_OF_SOUND
from asperity.radiation.wheel import RadiatingWheel, axial_transition, radial_transition
from asperity.spectra import band_energies, psd, third_octave_bands
from asperity.structures.body import Wheel

RADIUS, WIDTH = 0.46, 0.135


def wheel(nodal_diameters=(0, 1, 2, 3, 4), axial=0.5, radial=0.7, radius=RADIUS):
    n = np.array(nodal_diameters)
    return RadiatingWheel(radius, WIDTH, n, np.full(n.shape, axial), np.full(n.shape, radial))


def at(ka):
    return ka * SPEED_OF_SOUND / (2.0 * math.pi * RADIUS)


@pytest.mark.parametrize("diameters", [0, 1, 2, 3, 4])
def test_axial_motion_is_that_of_a_disc(diameters):
    """At low frequency, and as its page says: within 4 dB at the transition, 2 dB from 1.25 of it on."""
    transition = axial_transition(diameters)
    low = wheel().axial_ratio(at(0.1 * transition))[diameters, 0]
    assert low == pytest.approx(axial_ratio(diameters, 0.1 * transition), rel=0.03, abs=0.0)
    for over, allowed in ((1.0, 4.0), (1.25, 2.1), (1.6, 1.1), (2.5, 0.6), (5.0, 0.2)):
        found = wheel().axial_ratio(at(over * transition))[diameters, 0]
        exact = axial_ratio(diameters, over * transition)
        assert abs(10.0 * math.log10(found / exact)) < allowed, over


@pytest.mark.parametrize("diameters", [0, 1, 2, 4])
def test_radial_motion_at_low_frequency_is_that_of_a_ring_of_monopoles(diameters):
    """Power through a far sphere, from the pressure of cos(nθ) around a ring, by quadrature."""
    ka = 0.1 * radial_transition(diameters, WIDTH / RADIUS)
    node, weight = np.polynomial.legendre.leggauss(60)
    pressure = 0.5 * ka * WIDTH * jv(diameters, ka * np.sqrt(1.0 - node**2))  # times r, per velocity
    # the integrals of cos² around the sphere and around the ring cancel
    expected = math.pi * np.sum(weight * pressure**2) / (math.pi * RADIUS * WIDTH)
    assert wheel().radial_ratio(at(ka))[diameters, 0] == pytest.approx(expected, rel=0.03)


def test_ratios_rise_with_the_published_exponents_and_end_at_one():
    n, low = np.arange(5), np.array([1.0, 2.0])
    for ratio, exponent in ((wheel().axial_ratio, 2 * n + 4), (wheel().radial_ratio, 2 * n + 2)):
        np.testing.assert_allclose(np.log2(ratio(low)[:, 1] / ratio(low)[:, 0]), exponent, rtol=1e-3)
        assert ratio(50e3) == pytest.approx(1.0, abs=1e-3)


def test_the_power_is_that_of_both_faces_of_the_disc_and_of_the_tread():
    disc, tread = 2.0 * math.pi * RADIUS**2 * 16.0, 2.0 * math.pi * RADIUS * WIDTH * 0.25
    found = wheel([3], 4.0, 0.5).power(np.array([20e3]), np.array([[1e-6]]))
    assert found[0] == pytest.approx(IMPEDANCE * 1e-6 * (disc + tread), rel=1e-4)


RATE, SAMPLES, SEGMENT = 20e3, 2**19, 4000  # 26 s; lines of 5 Hz, as in a run: the last mode is 1.5 Hz wide
MODES = [(430.0, 1e-2, 2000.0), (1600.0, 1e-3, 300.0), (2450.0, 3e-4, 800.0)]
OTHER = 1.0 / 1.2e9 * (1.0 - 0.3j)  # of contact and rail, m/N


def receptances(frequency):
    """Of a wheel of 600 kg, at frequencies (f,), Hz, of its mass and of each mode, (4, f)."""
    w = 2.0 * np.pi * np.maximum(frequency, 1e-3)
    own = [(2.0 * np.pi * f, z, m) for f, z, m in MODES]
    modes = [1.0 / (m * (o**2 - w**2 + 2j * z * o * w)) for o, z, m in own]
    return np.array([-1.0 / (600.0 * w**2) + 0j, *modes])


def test_bands_of_modal_velocities_are_those_of_the_motion():
    """A wheel against a damped spring over a rough path, whose lines are far wider than its resonances."""
    frequency = np.fft.rfftfreq(SAMPLES, 1.0 / RATE)
    roughness = np.fft.rfft(np.random.default_rng(1).standard_normal(SAMPLES)) * 1e-6 * (frequency >= 50.0)
    each = receptances(frequency)
    force = roughness / (each.sum(axis=0) + OTHER)
    lines, force_psd = psd(np.fft.irfft(force), 1.0 / RATE, segment=SEGMENT)
    _, motion = psd(np.fft.irfft(each.sum(axis=0) * force), 1.0 / RATE, segment=SEGMENT)
    lines, force_psd, motion = lines[1:], force_psd[None, 1:], motion[None, 1:]
    compliance = np.full(lines.size, abs(OTHER))
    wheel = Wheel(600.0, 65e3, *zip(*MODES, strict=True))
    found = module.modal_velocity_psd(wheel, lines, force_psd, motion, compliance)
    _, low, high = third_octave_bands(200.0, 3200.0)
    for mode, receptance in zip(found, each, strict=True):
        velocity = np.fft.irfft(2j * np.pi * frequency * receptance * force)
        fine, exact = psd(velocity, 1.0 / RATE, segment=5 * SEGMENT)
        expected = band_energies(fine, exact, low, high)
        level = 10.0 * np.log10(band_energies(lines, mode[0], low, high) / expected)
        assert np.abs(level).max() < 0.6
    # what the force alone would say of the last, line by line
    alone = np.abs(2.0 * np.pi * lines * receptances(lines)[-1]) ** 2 * force_psd[0]
    assert np.abs(10.0 * np.log10(band_energies(lines, alone, low, high) / expected)).max() > 5.0
