"""Sound of rail, sleepers and wheels: motion by sums over bays and in a run, radiation by exact fields."""

import math
from dataclasses import replace

import numpy as np
import pytest
from exact_fields import INSIDE_60E1, SECTION_60E1, axial_ratio, mirrored, power_per_length
from numpy.testing import assert_allclose
from scipy.special import jv

from asperity import Track, Wheel
from asperity.radiation import track as sound
from asperity.radiation import wheel as module
from asperity.radiation.track import IMPEDANCE, SPEED_OF_SOUND, RailSection, SideOfRail, SleeperTop
from asperity.radiation.wheel import RadiatingWheel, axial_transition, radial_transition
from asperity.scenarios.scene import force_transfer
from asperity.spectra import band_energies, psd, third_octave_bands
from asperity.structures.lateral_rail import LateralTrack
from asperity.structures.track_parameters import Bays
from refusals import refusals

UIC60 = Track.named("uic60")
LOSSY = Track.named("nordborg-loss-factor", rail_loss_factor=0.05)
FREQUENCIES = np.array([80.0, 250.0, 500.0, 1063.0])
SECTION = RailSection(foot_width=0.150, head_width=0.072, area=60.2 / sound.STEEL_DENSITY)
TOP = SleeperTop(length=2.6, width=0.25)


def sleeper_per_rail(track, omega):
    pad, ballast = (each.stiffness(omega) for each in track.support.elements[::2])
    return pad / (pad + ballast - track.sleeper_mass * omega**2)


def even(x, track):
    return np.ones_like(x)


def uneven(x, track):
    return (1.5 + 0.5 * np.sin(2.0 * np.pi * x / track.period)) ** 2


def superposed(track, force, cells, points):
    """Squared mobility of rail, of sleepers and at the force, summed over many cells on both sides.

    Of an even force on equal bays, which are alike on both sides, in one half of a bay.
    """
    waves, omega = track.waves(2.0 * np.pi * FREQUENCIES), 2.0 * np.pi * FREQUENCIES
    motion = [abs(sleeper_per_rail(bay, omega)) ** 2 for bay in track.bay_tracks]
    step = track.period / (2 * points)
    places = (np.arange(-cells * 2 * points, cells * 2 * points) + 0.5) * step
    expected, weights = np.zeros((3, FREQUENCIES.size)), 0.0
    alike = force is even and track.bays is None
    for x0 in (
        (np.arange(points // 2 if alike else points) + 0.5) * track.period / points
    ):  # on edges of steps
        weight = force(x0, track)
        weights += weight
        moved = np.array([waves.receptance(x, x0) for x in places])
        ends = track.period * np.arange(-cells, cells)
        above = np.array([[waves.receptance(s + end, x0) for s in track.sleepers] for end in ends])
        expected[0] += weight * step * np.sum(np.abs(moved) ** 2, axis=0)
        expected[1] += weight * np.sum(np.abs(above) ** 2 * motion, axis=(0, 1))
        expected[2] += weight * np.abs(waves.receptance(x0, x0)) ** 2
    return expected * omega**2 / weights


DAMPED = replace(UIC60, rail_damper_mass=15.0, rail_damper_frequency=800.0, rail_damper_loss_factor=0.35)
VARIED = replace(LOSSY, bays=Bays.drawn(3, spacing=0.15, ballast=0.4, seed=2))  # not alike on both sides


@pytest.mark.parametrize(
    ("track", "force", "resolved"),
    [(UIC60, even, (60, 16)), (LOSSY, uneven, (60, 8)), (DAMPED, even, (20, 24)), (VARIED, uneven, (24, 9))],
    ids=["uic60", "loss factors", "rail dampers", "bays that differ"],
)
def test_the_sums_over_bays_are_those_of_superposition(track, force, resolved):
    mobilities = sound.squared_mobility, sound.squared_sleeper_mobility, sound.squared_point_mobility
    for mobility, squares in zip(mobilities, superposed(track, force, *resolved), strict=True):
        found = mobility(track, FREQUENCIES, *([lambda x: force(x, track)[:, None]] * (force is uneven)))
        assert_allclose(found, squares, rtol=2e-3 if force is uneven else 5e-4)


def test_spread_sleepers_sound_as_close_ones():
    """As many per length, each of as little mass and stiffness."""
    spread, share = replace(UIC60, continuous=True), 0.05
    scaled = ("pad_stiffness", "pad_damping", "sleeper_mass", "ballast_stiffness", "ballast_damping")
    close = replace(UIC60, sleeper_spacing=share * 0.6, **{k: share * getattr(UIC60, k) for k in scaled})
    expected = share * sound.squared_sleeper_mobility(close, FREQUENCIES)
    assert_allclose(sound.squared_sleeper_mobility(spread, FREQUENCIES), expected, rtol=3e-3)


def test_a_sleeper_that_bends_sounds_by_its_mean_square():
    """Times what a rigid one would by the motion of its seat; none on rigid ground."""
    bent = replace(UIC60, sleeper_bending_stiffness=6e6)
    omega, sleeper = 2.0 * np.pi * FREQUENCIES, bent.elements["sleeper"]
    below = bent.springs["ballast"].stiffness(omega)
    seat = 1.0 - bent.support.stiffness(omega) / bent.springs["pad"].stiffness(omega)
    expected = np.abs(seat) ** 2 * sleeper.spread(omega, below)
    assert_allclose(bent.support.sleeper_square(omega), expected, rtol=1e-9)
    rigid = replace(bent, sleeper_bending_stiffness=1e13)
    heard = [sound.squared_sleeper_mobility(each, FREQUENCIES) for each in (rigid, UIC60, bent)]
    assert_allclose(heard[0], heard[1], rtol=1e-4)
    assert (np.abs(heard[2] / heard[1] - 1.0) > 0.05).any()
    assert not sound.squared_sleeper_mobility(replace(UIC60, ballast_stiffness=np.inf), FREQUENCIES).any()


def test_bays_that_differ_sound_as_equal_ones_in_the_mean():
    """T. X. Wu and D. J. Thompson, Acustica 86 (2000) 313-321: no significant effect on the mean noise."""
    band = 10.0 ** np.arange(2.2, 3.65, 0.2)
    lines = (band[:, None] * 10.0 ** (0.1 * np.array([-1.0, 0.0, 1.0]))).ravel()
    wheel = Wheel(600.0, 65e3)

    def power(track):
        def pressed(x):
            return np.abs(force_transfer(lines, wheel.receptance, track, 1.2e9, x)) ** 2

        square = np.mean(pressed(track.places(6)), axis=0)
        return (square * sound.squared_mobility(track, lines, pressed)).reshape(band.size, -1).mean(axis=1)

    varied = replace(UIC60, bays=Bays.drawn(8, spacing=0.05, pad=0.1, ballast=0.3, seed=1))
    assert np.abs(10.0 * np.log10(power(varied) / power(UIC60))).max() < 0.5


def test_limits_of_radiators():
    """One where ka is large."""
    ka = np.array([0.005, 0.01])
    assert_allclose(sound.baffled_piston(ka), 0.5 * ka**2 - ka**4 / 12.0 + ka**6 / 144.0, rtol=1e-9)
    k = 2.0 * math.pi / SPEED_OF_SOUND
    low = 0.5 * (10.0 * k) ** 2 * 0.325 / math.pi  # (ka)²/2, of the circle of the same area
    assert TOP.radiation_ratio(10.0)[0] == pytest.approx(low, rel=2e-3)
    for part in (SECTION, TOP):
        assert part.radiation_ratio(1e6)[0] == pytest.approx(1.0, abs=2e-3)


@pytest.mark.parametrize("ka", [0.1, 1.0, 3.0])
def test_the_boundary_elements_are_right_for_a_cylinder(ka):
    radius, angle = 0.07, np.linspace(0.0, 2.0 * math.pi, 200, endpoint=False)
    outline = radius * np.stack([np.cos(angle), np.sin(angle)], axis=1)
    found = power_per_length(outline, np.array([(0.01, 0.02), (-0.03, 0.013)]), ka / radius)
    assert found / (math.pi * radius) == pytest.approx(float(sound.cylinder(ka)), rel=2e-3)


@pytest.mark.parametrize(
    ("frequency", "low", "high"),
    [(100.0, 0.0, 0.5), (400.0, 0.3, 0.8), (800.0, 0.0, 0.6), (1600.0, -2.0, 0.0)],
)
def test_the_ratio_of_a_uic60_rail_is_near_that_of_its_section(frequency, low, high):
    """By how much the model is above boundary elements, dB, as its page says it is."""
    k = 2.0 * math.pi * frequency / SPEED_OF_SOUND
    field = power_per_length(mirrored(SECTION_60E1), INSIDE_60E1, k)
    model = SECTION.radiating_width * SECTION.radiation_ratio(frequency)[0]
    assert low < 10.0 * math.log10(model / field) < high


def test_a_table_replaces_the_model():
    section = RailSection(0.15, 0.072, 7.67e-3, (np.array([100.0, 1000.0]), np.array([0.01, 1.0])))
    found = section.radiation_ratio([50.0, 100.0, 316.2278, 2000.0])
    assert_allclose(found, [0.01, 0.01, 0.1, 1.0], rtol=1e-6)


def test_powers_are_those_of_the_whole_rail_and_of_all_half_sleepers():
    f = np.array([300.0, 1000.0])
    parts = ((SECTION, 0.3, sound.squared_mobility), (TOP, 0.325, sound.squared_sleeper_mobility))
    for part, area, mobility in parts:
        expected = IMPEDANCE * area * part.radiation_ratio(f) * mobility(UIC60, f)
        assert_allclose(part.power_per_force(UIC60, f), expected, rtol=1e-12)


test_bad_questions_are_refused = refusals(
    (
        lambda: sound.squared_mobility(UIC60, [0.0, 100.0]),
        r"frequency \(Hz\): received 0.0; allowed: finite pos",
    ),
    (lambda: RailSection(0.0, 0.07, 7e-3), "foot_width of the rail's section: received 0.0; all"),
    (lambda: RailSection(0.15, 0.07, math.nan), "area of the rail's section"),
)


SIDEWAYS = LateralTrack(Track.named("nordborg-loss-factor", rail_loss_factor=0.05), web_thickness=math.inf)
SIDE = SideOfRail(0.172, 0.150, 0.072)


def test_the_integral_along_the_rail_is_that_of_many_bays():
    frequency, place, bay, bays, cells = np.array([80.0, 500.0, 1500.0]), 0.012, 0.6, 60, 24
    places = (np.arange(4) + 0.5) * bay / 4
    waves, forces = SIDEWAYS.waves(2.0 * np.pi * frequency), SIDEWAYS.contact_shapes(place)
    along = (np.arange(-bays * cells, bays * cells) + 0.5) * bay / cells
    heights = np.linspace(-SIDEWAYS.foot_depth, SIDEWAYS.head_height, 201)
    simpson = np.ones(201)
    simpson[1:-1:2], simpson[2:-1:2] = 4.0, 2.0
    levers = np.stack([np.ones(201), heights])
    over_height = (levers * simpson) @ levers.T / simpson.sum()
    expected = np.zeros((2, 2, 3), complex)
    for x0 in places:
        moved = np.array([np.einsum("abf,nb->anf", waves.receptance(x, x0), forces) for x in along])
        expected += np.einsum("xamf,ab,xbnf->mnf", moved.conj(), over_height, moved) * bay / cells / 4
    found = sound.squared_lateral_mobility(SIDEWAYS, frequency, places, place).mean(axis=0)
    assert_allclose(found, (2.0 * np.pi * frequency) ** 2 * expected, rtol=5e-4)
    assert_allclose(found, found.conj().swapaxes(0, 1), rtol=1e-9)


@pytest.mark.parametrize(
    ("frequency", "low", "high"),
    [(100.0, 0.5, 1.0), (315.0, -1.2, -0.8), (630.0, -3.5, -3.2), (1250.0, 0.0, 0.5), (2500.0, 1.5, 2.2)],
)
def test_the_ratio_is_near_that_of_a_60e1_section(frequency, low, high):
    """By how much the model is above boundary elements of the section turned by a right angle, dB."""
    turned = [np.stack([-each[:, 1], each[:, 0]], axis=1) for each in (mirrored(SECTION_60E1), INSIDE_60E1)]
    field = power_per_length(*turned, 2.0 * math.pi * frequency / SPEED_OF_SOUND)
    model = SIDE.power(frequency, np.ones(1))[0] / IMPEDANCE
    assert low < 10.0 * math.log10(model / field) < high


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
