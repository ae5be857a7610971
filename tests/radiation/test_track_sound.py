"""Sound of rail and sleepers: motion against sums over many bays, radiation against exact fields."""

import math

import numpy as np
import pytest
from numpy.polynomial.legendre import leggauss
from numpy.testing import assert_allclose
from scipy.special import hankel2, j1
from section_field import INSIDE_60E1, SECTION_60E1, mirrored, power_per_length

from asperity import Track
from asperity.errors import InputError
from asperity.radiation import track as sound
from asperity.radiation.track import IMPEDANCE, SPEED_OF_SOUND, RailSection, SleeperTop
from asperity.structures.track import decay_rate

UIC60 = Track.named("uic60")
LOSSY = Track.named("nordborg-loss-factor", rail_loss_factor=0.05)
BAYS = 80
FREQUENCIES = np.array([80.0, 250.0, 500.0, 1063.0])
SECTION = RailSection(foot_width=0.150, head_width=0.072, area=60.2 / sound.STEEL_DENSITY)
TOP = SleeperTop(length=2.6, width=0.25)


def sleeper_per_rail(track, omega):
    pad, ballast = (each.stiffness(omega) for each in (track.support.pad, track.support.ballast))
    return pad / (pad + ballast - track.sleeper_mass * omega**2)


def bay_by_bay(track, cells=24, forces=12):
    """Squared mobility, summed over many bays on both sides, forces on edges of cells; of sleepers."""
    bay, omega = track.sleeper_spacing, 2.0 * np.pi * FREQUENCIES
    places = (np.arange(-BAYS * cells, BAYS * cells) + 0.5) * bay / cells
    waves, sleeper = track.waves(omega), sleeper_per_rail(track, omega)
    rail, sleepers = [], []
    for x0 in (np.arange(forces) + 0.5) * bay / forces:
        moved = np.array([waves.receptance(x, x0) for x in places])
        above = np.array([waves.receptance(n * bay, x0) for n in range(-BAYS, BAYS)])
        rail.append(np.sum(np.abs(omega * moved) ** 2, axis=0) * bay / cells)
        sleepers.append(np.sum(np.abs(omega * sleeper * above) ** 2, axis=0))
    return np.mean(rail, axis=0), np.mean(sleepers, axis=0)


@pytest.mark.parametrize("track", [UIC60, LOSSY], ids=["uic60", "loss factors"])
def test_the_sums_over_bays_are_those_of_superposition(track):
    rail, sleepers = bay_by_bay(track)
    assert_allclose(sound.squared_mobility(track, FREQUENCIES), rail, rtol=5e-4)
    assert_allclose(sound.squared_sleeper_mobility(track, FREQUENCIES), sleepers, rtol=5e-4)


def test_an_uneven_force_counts_by_its_square():
    """Force twice as high over the sleepers as at mid-span: the mean of point mobilities with its square."""
    places = (np.arange(200) + 0.5) * UIC60.sleeper_spacing / 200
    point = np.array([abs(2.0 * math.pi * 700.0 * UIC60.receptance(700.0, x, x)) ** 2 for x in places])

    def force(x):
        return (1.5 + 0.5 * np.cos(2.0 * np.pi * x / UIC60.sleeper_spacing)[:, None]) ** 2

    for square, given in ((np.ones(200), None), (force(places)[:, 0], force)):
        found = sound.squared_point_mobility(UIC60, 700.0, given)[0]
        assert found == pytest.approx(np.average(point, weights=square), rel=1e-5)


def test_one_wave_of_decay_rate_d_has_a_length_of_8_686_over_d():
    """A rail that hardly bends but shears, on nothing: exp(-ik|x|), k = ω √(m'/S), and 1/-Im k long."""
    supports, shear = (1e3, 0.0, 1e3, 0.05), {"shear_stiffness": 2e7, "rotary_inertia": 1e-3}
    rail = Track(1e9, 60.0, *supports, rail_loss_factor=0.05, **shear)
    decay = -(2.0 * np.pi * 500.0 * np.sqrt(60.0 / (2e7 * (1.0 + 0.05j)))).imag
    assert_allclose(decay_rate(rail, 500.0), 20.0 * math.log10(math.e) * decay, rtol=1e-3)
    assert_allclose(sound.effective_length(rail, 500.0), 8.686 / decay_rate(rail, 500.0), rtol=1e-3)


def test_what_a_force_puts_into_a_track_is_lost_in_pads_and_ballast():
    """Energy: Re Y(x₀|x₀)/2·2 equals what viscous dampers take, without loss in the rail."""
    track = Track.named("uic60", rail_loss_factor=0.0)
    frequency = np.array([100.0, 400.0, 1063.0, 2500.0])
    omega = 2.0 * np.pi * frequency
    node, weight = leggauss(24)
    at = 0.5 * track.sleeper_spacing * (node + 1.0)
    put_in = 0.5 * weight @ (1j * omega * track.receptance(frequency, at, at)).real
    below, sleepers = sleeper_per_rail(track, omega), sound.squared_sleeper_mobility(track, frequency)
    squeezed = sleepers * np.abs((1.0 - below) / below) ** 2  # of the pads, per force
    assert_allclose(track.pad_damping * squeezed + track.ballast_damping * sleepers, put_in, rtol=1e-6)


@pytest.mark.parametrize("ka", [0.2, 1.0, 3.0])
@pytest.mark.parametrize("order", [0, 1, 3])
def test_a_cylinder_radiates_what_passes_a_circle_around_it(ka, order):
    """Power through a circle, from pressure and its slope, over that of a plane wave; ρc = 1, a = 1."""
    step, r = 1e-6, 5.0
    slope = (hankel2(order, ka + step) - hankel2(order, ka - step)) / (2.0 * step)
    amplitude = -1j / slope  # -dp/dr = i k v on the surface
    pressure = amplitude * hankel2(order, ka * r)
    outwards = 1j * amplitude * (hankel2(order, (r + step) * ka) - hankel2(order, (r - step) * ka))
    around = 2.0 * math.pi if order == 0 else math.pi  # of cos² nθ
    power = (pressure * np.conj(outwards / (2.0 * step * ka))).real * around * r
    assert sound.cylinder(ka, order) == pytest.approx(power / around, rel=1e-6)


@pytest.mark.parametrize("ka", [0.05, 1.0, 4.0])
def test_a_piston_radiates_what_arrives_far_away(ka):
    """Rayleigh's integral: |p| = k a² v |2 J₁(ka sin ϑ)/(ka sin ϑ)|/(2R), integrated over the half-space."""
    node, weight = leggauss(200)
    angle = 0.25 * math.pi * (node + 1.0)
    beam = 2.0 * j1(ka * np.sin(angle)) / (ka * np.sin(angle))
    power = 2.0 * math.pi * 0.25 * math.pi * np.sum(weight * (0.5 * ka * beam) ** 2 * np.sin(angle))
    assert sound.baffled_piston(ka) == pytest.approx(power / math.pi, rel=1e-9)


def test_limits_of_radiators():
    """(π/2) ka of the line monopole, (π/2)(ka)³ of the line dipole; one where ka is large."""
    assert_allclose(
        [sound.cylinder(1e-3, 0), sound.cylinder(1e-3)], 0.5 * np.pi * np.array([1e-3, 1e-9]), 1e-4
    )
    ka = np.array([1e-4, 0.00999, 0.01001])  # where the series of the piston takes over
    assert_allclose(sound.baffled_piston(ka), 0.5 * ka**2 - ka**4 / 12.0 + ka**6 / 144.0, rtol=1e-9)
    # W' = ρ c ⟨v²⟩ k³ D²/8 at low frequency, both faces of the foot at high frequency
    k = 2.0 * math.pi / SPEED_OF_SOUND
    low = SECTION.radiating_width * SECTION.radiation_ratio(1.0)[0]
    assert low == pytest.approx(k**3 * 0.02941**2 / 8.0, rel=2e-3)  # 0.00767 + 0.01767 + 0.00407
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
KA = "wavenumber times radius"


@pytest.mark.parametrize(
    ("call", "message"),
    [
        *((lambda f=f: f(UIC60, [0.0, 100.0]), ZERO) for f in (
            sound.squared_mobility, sound.squared_sleeper_mobility, sound.effective_length)),
        *((lambda f=f, ka=ka: f(ka), KA) for f in (sound.cylinder, sound.baffled_piston)
          for ka in (0.0, -1.0, math.nan, math.inf)),
        (lambda: sound.cylinder(1.0, -1), "order of the motion around a cylinder"),
        (lambda: RailSection(0.0, 0.07, 7e-3), "foot_width of the rail's section: received 0.0; all"),
        (lambda: RailSection(0.15, 0.0, 7e-3), "head_width of the rail's section"),
        (lambda: RailSection(0.15, 0.07, math.nan), "area of the rail's section"),
        (lambda: SleeperTop(-1.0, 0.25), "length of a sleeper: received -1.0; allowed: a finite positive"),
        (lambda: SleeperTop(2.6, 0.0), "width of a sleeper"),
    ],
)  # fmt: skip
def test_bad_questions_are_refused(call, message):
    with pytest.raises(InputError, match=message):
        call()
