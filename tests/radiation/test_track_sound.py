"""Sound of rail and sleepers: motion against sums over many bays, radiation against exact fields."""

import math
from dataclasses import replace

import numpy as np
import pytest
from numpy.testing import assert_allclose
from section_field import INSIDE_60E1, SECTION_60E1, mirrored, power_per_length

from asperity import Track
from asperity.radiation import track as sound
from asperity.radiation.track import IMPEDANCE, SPEED_OF_SOUND, RailSection, SleeperTop
from asperity.scenarios.scene import force_transfer
from asperity.structures.body import Wheel
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


def superposed(track, force, cells, points=24):
    """Squared mobility of rail, of sleepers and at the force, summed over many cells on both sides."""
    waves, omega = track.waves(2.0 * np.pi * FREQUENCIES), 2.0 * np.pi * FREQUENCIES
    motion = [abs(sleeper_per_rail(bay, omega)) ** 2 for bay in track.bay_tracks]
    step = track.period / (2 * points)
    places = (np.arange(-cells * 2 * points, cells * 2 * points) + 0.5) * step
    expected, weights = np.zeros((3, FREQUENCIES.size)), 0.0
    for x0 in (np.arange(points) + 0.5) * track.period / points:  # on edges of steps
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
    [(UIC60, even, (60,)), (LOSSY, uneven, (60, 12)), (DAMPED, even, (30,)), (VARIED, uneven, (24, 15))],
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
    ka = np.array([1e-4, 0.00999, 0.01001])  # where the series of the piston takes over
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


ZERO = r"frequency \(Hz\): received 0.0; allowed: finite positive"


test_bad_questions_are_refused = refusals(
    *(
        (lambda f=f: f(UIC60, [0.0, 100.0]), ZERO)
        for f in (sound.squared_mobility, sound.squared_sleeper_mobility, sound.squared_point_mobility)
    ),
    (lambda: RailSection(0.0, 0.07, 7e-3), "foot_width of the rail's section: received 0.0; all"),
    (lambda: RailSection(0.15, 0.07, math.nan), "area of the rail's section"),
)
