"""The pass-by: ground with impedance, directivity and rails apart, sound of axles, and single numbers.

Against closed forms and exact integrals; others stand in the ledger of conformance.
"""

import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy.special import exp1

from asperity.errors import ComputationError
from asperity.radiation import pass_by
from asperity.radiation.pass_by import FAST, AxleSource, Passage, Receiver
from asperity.radiation.sound_path import PorousGround, SoundPath
from asperity.radiation.track import IMPEDANCE, wavenumber
from asperity.reference import cnossos
from asperity.reference.railways import GROUNDS
from refusals import refusals

BAND = 10.0 ** (np.arange(17, 38) / 10.0)
HARD, GRASS = PorousGround(1e12), PorousGround(GROUNDS["grass"])
D = 7.5
FLAT, ONE = Receiver(D, 0.0), Passage([0.0], 1.0)
WATT, MILLIWATT = np.array([1.0]), AxleSource(np.array([1e-3]))


def plain(count=1, receiver=FLAT):
    """A path without anything, of so many bands."""
    return SoundPath(np.full(count, 1000.0), receiver)


def decibels(ratio):
    return 10 * np.log10(ratio)


def levels(source, passage):
    time = passage.times(FLAT, float(np.max(source.length)))
    return pass_by.pass_by_levels(time, plain().squared_pressure(source, passage, time), passage.passed)[:, 0]


@pytest.mark.parametrize("resistivity", [80e3, 20e6])
def test_impedance_is_that_of_the_model_in_its_first_units(resistivity):
    """As C. I. Chessell prints it, σ in cgs units (J. Acoust. Soc. Am. 62 (1977) 825)."""
    x = 500.0 / (1e-3 * resistivity)
    printed = 1.0 + 9.08 * x**-0.754 - 11.9j * x**-0.732
    assert_allclose(PorousGround(resistivity).impedance(500.0), printed, rtol=0.01)


def test_grazing_incidence_and_hard_ground():
    # at grazing incidence far away nothing but −1/w² of the ground wave is left: w² = −ikRβ²/2
    f, far = 1000.0, 1e6
    admittance = 1.0 / GRASS.impedance(f)
    left = (1.0 + GRASS.reflection(f, 0.0, far)) * 1j * wavenumber(f) * far * admittance**2
    assert_allclose(left, 2.0, rtol=1e-4)
    assert_allclose(HARD.reflection(f, [0.0, 0.3, 1.0], 8.0), 1.0, atol=3e-3)
    assert abs(GRASS.reflection(f, 1.0, 8.0)) < abs(PorousGround(20e6).reflection(f, 1.0, 8.0)) < 1.0


def test_over_hard_ground_the_power_goes_above_it():
    """∫ |p|² dS over the half sphere is that of an even source."""
    sine, distance = 0.5 * (np.polynomial.legendre.leggauss(200)[0] + 1.0), 500.0
    band, around = BAND[BAND < 600.0], distance * np.sqrt(1.0 - sine**2)
    over = [
        HARD.inverse_square(band, (0.7, distance * s), np.array([r]))
        for s, r in zip(sine, around, strict=True)
    ]
    mean = 0.5 * np.polynomial.legendre.leggauss(200)[1] @ np.array(over)[:, :, 0]
    assert_allclose(mean * distance**2, 1.0, rtol=5e-3)
    low = HARD.inverse_square(BAND, (0.0, 1.2), np.array([7.5]))  # and right on the ground everywhere
    assert_allclose(low * (7.5**2 + 1.2**2), 1.0, rtol=5e-3)


def test_interference_within_a_band():
    """Over hard ground ½(1/R₁² + 1/R₂² + 2 ⟨cos kΔ⟩/R₁R₂)/(1 + sinc), the mean over lg f by quadrature."""
    source, receiver, away, centre = 0.5, 1.7, 7.5, 1000.0
    direct, bounced = np.hypot(away, receiver - source), np.hypot(away, receiver + source)
    f = centre * 10.0 ** np.linspace(-0.05, 0.05, 20_001)
    k = 2.0 * np.pi * f / 343.2
    square = 1.0 / direct**2 + 1.0 / bounced**2 + 2.0 * np.cos(k * (bounced - direct)) / (direct * bounced)
    expected = 0.5 * np.trapezoid(square / (1.0 + np.sin(k) / k), np.linspace(0.0, 1.0, len(f)))  # 2kh = k
    found = PorousGround(1e16).inverse_square(np.array([centre]), (source, receiver), np.array([away]))
    assert_allclose(found[0, 0], expected, rtol=1e-4)


def test_directivity_of_cnossos():
    """10 lg(0.01 + 0.99 sin²φ); upwards at 1.4 kHz 40/3 (⅔ sin 2ψ − sin ψ) times lg 10."""
    quarter = 0.5 * np.pi
    found = cnossos.directivity(
        [quarter, 0.0, quarter / 3, quarter, quarter, quarter], [0, 0, 0, -1, quarter, quarter / 3], 1400.0
    )
    upwards = 40.0 / 3.0 * (2.0 / 3.0 * np.sqrt(0.75) - 0.5)
    assert_allclose(found, [0.0, -20.0, 10 * np.log10(0.01 + 0.99 / 4), 0.0, -40.0 / 3.0, upwards], atol=1e-9)


@pytest.mark.parametrize(
    ("receiver", "source", "lowest", "highest"),
    [((7.5, 1.2), 0.46, 3.4, 3.6), ((7.5, 1.2), 0.0, 3.5, 3.9), ((7.5, 3.5), 0.46, 3.8, 4.8)],
)
def test_directivity_is_louder_opposite_by_what_the_page_says(receiver, source, lowest, highest):
    """By the mean of the formula over the upper half of a sphere, summed up here by even elevations."""
    band, fine = np.array([50.0, 8000.0]), np.linspace(0.0, 0.5 * np.pi, 2001)[:, None]
    paths = [SoundPath(band, Receiver(*receiver), directivity=each) for each in ("cnossos", "even")]
    uneven, even = (path.inverse_square(source, np.zeros(1))[:, 0] for path in paths)
    found = 10.0 * np.log10(uneven / even)
    upwards = 10.0 ** (40 / 30 * (2 / 3 * np.sin(2 * fine) - np.sin(fine)) * np.log10((band + 600.0) / 200.0))
    mean = 0.505 * np.trapezoid(upwards * np.cos(fine), fine[:, 0], axis=0)
    rise = np.arctan2(receiver[1] - source, receiver[0])
    opposite = 10.0 ** (
        40 / 30 * (2 / 3 * np.sin(2 * rise) - np.sin(rise)) * np.log10((band + 600.0) / 200.0)
    )
    np.testing.assert_allclose(found, 10.0 * np.log10(opposite / mean), atol=0.01)
    np.testing.assert_allclose(found, (lowest, highest), atol=0.06)


def test_directivity_keeps_power_and_hence_exposure():
    """Beside the track at the height of the source the horizontal pattern leaves the exposure as it is."""
    path = SoundPath(BAND, FLAT, directivity="cnossos")
    vertical = path.integral(0.0) * 7.5 / np.pi  # what the vertical pattern takes from above goes sideways
    sine = (np.arange(400) + 0.5) / 400  # all around and up, in equal parts of the half sphere
    around = np.pi * (np.arange(50) + 0.5) / 50
    level = cnossos.directivity(around[:, None, None], np.arcsin(sine)[:, None], BAND)
    horizontal = np.mean(0.01 + 0.99 * np.sin(around) ** 2)
    assert_allclose(vertical * np.mean(10.0 ** (0.1 * level), axis=(0, 1)), horizontal, rtol=1e-4)
    opposite = path.inverse_square(0.0, np.zeros(1))[:, 0] * 7.5**2
    assert_allclose(opposite, vertical / 0.505, rtol=1e-6)


def divergence(length, along):
    """Mean of 1/d² over a source that is spread as exp(−2|ξ|/ℓ)/ℓ: with 1/(d² + u²) = Im 1/(u − id)/d."""
    z = [2.0 / length * (side * along - 1j * D) for side in (1.0, -1.0)]
    return np.imag([np.exp(each) * exp1(each) for each in z]).sum(axis=0) / (length * D)


def test_a_path_without_anything_is_the_closed_form():
    along, length = np.linspace(0.0, 60.0, 402), np.array([0.0, 0.3, 3.0, 40.0, 1e3])
    expected = np.array([1.0 / (D**2 + along**2), *(divergence(each, along) for each in length[1:])])
    assert_allclose(plain(5).spread(0.0, length, along), expected, rtol=1e-4)


def test_rails_apart_add_as_two_lines():
    along, apart = np.linspace(0.0, 60.0, 41), SoundPath(BAND, FLAT, rail_distance=1.5)
    both = 0.5 * sum(1.0 / ((D + side) ** 2 + along**2) for side in (-0.75, 0.75))
    assert_allclose(apart.inverse_square(0.0, along), np.broadcast_to(both, (len(BAND), 41)), rtol=1e-12)
    assert_allclose(apart.integral(0.0), 0.5 * np.pi * (1 / 6.75 + 1 / 8.25), rtol=1e-6)


def test_dipoles_stand_in_the_direction_of_motion():
    """3 cos²θ: of one place opposite, of a long rail by closed forms, and as an even source in the mean."""
    path = SoundPath(BAND[:1], Receiver(2.0, 1.0), directivity="dipole")
    square = {"vertical": 1.0, "lateral": 4.0}
    for motion, part in square.items():
        assert_allclose(path.inverse_square(0.0, np.zeros(1), motion), 3.0 * part / 5.0 / 5.0)
        # ∫ dx/(x² + r²)² = π/(2 r³)
        assert_allclose(path.integral(0.0, motion), 3.0 * part * 0.5 * np.pi / 5.0**1.5, rtol=1e-5)
    assert_allclose(path.integral(0.0), np.pi / np.sqrt(5.0), rtol=1e-5)
    elevation, weight = np.polynomial.legendre.leggauss(20)
    rise = 0.5 * (elevation + 1.0)  # sine, even over the half sphere
    mean = [
        SoundPath(BAND[:1], Receiver(np.sqrt(1.0 - z * z), z), directivity="dipole").inverse_square(
            0.0, np.zeros(1), "vertical"
        )[0, 0]
        for z in rise
    ]
    assert 0.5 * weight @ mean == pytest.approx(1.0, rel=1e-9)
    assert_allclose(path.inverse_square(0.0, np.zeros(1)), 0.2)


def test_a_screened_rail_and_an_offset_receiver_are_heard_so():
    along, apart = np.zeros(1), SoundPath(BAND[:1], FLAT, rail_distance=1.5, far_rail_screening=10.0)
    assert_allclose(apart.inverse_square(0.0, along), 0.5 * (1.0 / 6.75**2 + 0.1 / 8.25**2), rtol=1e-12)
    louder = SoundPath(np.array([1000.0]), FLAT, receiver_offset=6.0)
    for heard in (
        decibels(louder.exposure(MILLIWATT, ONE) / plain().exposure(MILLIWATT, ONE)),
        decibels(
            louder.squared_pressure(MILLIWATT, ONE, [0.0, 3.0])
            / plain().squared_pressure(MILLIWATT, ONE, [0.0, 3.0])
        ),
    ):
        assert_allclose(heard, 6.0, rtol=1e-12)


def test_soft_ground_spreads_as_its_quadrature():
    """A wave that decays along the rail over grass: against a plain sum over the rail."""
    path, along = SoundPath(BAND[::7], Receiver(), GRASS, 0.5, "cnossos", 1.5), np.linspace(0.0, 40.0, 301)
    at = np.linspace(-120.0, 120.0, 12_001)
    weight = np.exp(-2.0 * np.abs(at) / 5.0) / 5.0 * (at[1] - at[0])
    found = path.spread(0.0, np.full(len(path.band), 5.0), along)
    for place in (0, 60, 200):
        expected = path.inverse_square(0.0, along[place] + at) @ weight
        assert_allclose(found[:, place], expected, rtol=0.01)


def test_a_hub_is_as_far_as_its_height_makes_it():
    # d² = 7.5² + 0.74² from 0.46 m to 1.2 m
    found = plain(1, Receiver()).squared_pressure(AxleSource(WATT, height=0.46), ONE, [0.0, 1.0])[0, 0]
    assert_allclose(found, IMPEDANCE / (2 * np.pi * (56.25 + 0.5476)), rtol=1e-9)


@pytest.mark.parametrize("length", [0.0, 10.0, 40.0])
def test_exposure_does_not_depend_on_the_spread(length):
    """∫ W ρc Q/(4π (d² + v² t²)) dt = W ρc Q/(4 d v), and a spread only delays parts of it."""
    source, closed = AxleSource(WATT, length), 1.0 * IMPEDANCE * 2.0 / (4.0 * D * 20.0)
    for axles, speed, distance, share in (([0.0], 20.0, D, 1.0), ([0.0, 2.5], 40.0, 2 * D, 0.5)):
        found = plain(1, Receiver(distance, 0.0)).exposure(source, Passage(axles, speed))
        assert_allclose(found, share * closed, rtol=1e-12)
    half = 4000.0  # m: arctan leaves 2/π d/half beyond it
    time = np.linspace(-half, half, 400_001) / 20.0
    integral = np.trapezoid(plain().squared_pressure(source, Passage([0.0], 20.0), time)[0], time)
    assert_allclose(integral, closed * (1.0 - 2.0 / np.pi * D / half), rtol=2e-5)


def test_axles_pass_one_after_the_other_the_same_before_and_after():
    source, time = AxleSource(np.array([1.0, 2.0]), np.array([0.0, 6.0])), np.linspace(-1.0, 2.0, 601)
    both = plain(2).squared_pressure(source, Passage([0.0, 20.0], 40.0), time)
    first, second = (
        plain(2).squared_pressure(source, Passage([0.0], 40.0), time - lag) for lag in (0.0, 0.5)
    )
    assert_allclose(both, first + second, rtol=1e-4)
    for passed, lag in ((first, 0.0), (second, 0.5)):
        assert time[passed.argmax(axis=1)] == pytest.approx(lag, abs=0.006)
    assert_allclose(first[:, :401], first[:, 400::-1], rtol=1e-6)


def test_front_and_rear():
    assert Passage([0.0], 10.0).passed is None
    assert_allclose(Passage([0.0, 2.0, 4.0], 10.0).passed, (-0.1, 0.5))  # as long as 3 axles 2 m apart
    assert_allclose(Passage([0.0, 2.0], 10.0, length=20.0).passed, (-0.9, 1.1))
    assert_allclose(Passage([0.0], 10.0, length=20.0).passed, (-1.0, 1.0))


@pytest.mark.parametrize("length", [0.0, 3.0, 40.0, 200.0])
@pytest.mark.parametrize("passage", [ONE, Passage([0.0, 2.5, 19.0, 21.5], 20.0, 26.4)])
def test_the_record_holds_the_whole_rise_and_fall(passage, length):
    time = passage.times(FLAT, length)
    found = plain().squared_pressure(AxleSource(WATT, length), passage, time)[0]
    assert max(found[0], found[-1]) < 0.1 * np.interp((passage.passed or (0.0, 0.0))[0], time, found)
    assert_allclose(np.diff(time), time[1] - time[0])


def test_levels_of_a_point_source_with_a_train_of_known_length():
    """p² = A/(d² + v² t²): over |t| < T/2 the integral is 2A/(dv) arctan(vT/2d)."""
    v, length = 25.0, 30.0
    _, *found = levels(MILLIWATT, Passage([0.0], v, length))
    a, duration, half = 1e-3 * IMPEDANCE / (2 * np.pi), length / v, length / 2
    far = np.sqrt(10 * (D**2 + half**2) - D**2)  # a tenth of what it is when the front is opposite
    for level, reach in zip(found, (half, far), strict=True):
        mean = 2 * a / (D * v) * np.arctan(reach / D) / duration
        assert_allclose(level, decibels(mean / 4e-10), atol=1e-2)


@pytest.mark.parametrize("speed", [0.5, 20.0, 100.0])
def test_the_maximum_is_that_of_the_weighted_pressure(speed):
    """Against quadrature of ∫ exp(−(t − u)/τ) p²(u) du/τ at its maximum."""
    lags = np.linspace(0.0, 60.0 * FAST, 40_001)
    t = np.linspace(0.0, 2.0, 41)[:, None] * min(D / speed, FAST)
    weighted = np.exp(-lags / FAST) / FAST / (D**2 + (speed * (t - lags)) ** 2)
    largest = 1e-3 * IMPEDANCE / (2 * np.pi) * np.trapezoid(weighted, lags).max()
    assert_allclose(pass_by.time_weighted(np.ones((2, 9)), 1e-3), 1.0, rtol=1e-12)  # steady before
    found = levels(MILLIWATT, Passage([0.0], speed))[0]
    assert found == pytest.approx(pass_by.pressure_level(largest), abs=0.02)


TIME = np.linspace(-1.0, 1.0, 101)


def test_sources_share_the_measured_time_and_add_up():
    passage = Passage([0.0, 2.5], 30.0)
    time = passage.times(FLAT, 20.0)
    sources = (AxleSource(np.array([1e-3]), length) for length in (0.0, 20.0))
    parts = [plain().squared_pressure(each, passage, time)[0] for each in sources]
    for one in pass_by.pass_by_levels(time, [*parts, sum(parts)], passage.passed)[1:]:
        assert decibels(np.sum(10 ** (one[:2] / 10))) == pytest.approx(one[2], abs=1e-9)
    without = pass_by.pass_by_levels(TIME, 1.0 / (1.0 + TIME[None] ** 2), None)
    assert np.isfinite(without[0]).all()
    assert np.isnan(without[1:]).all()


def test_a_train_that_is_louder_at_its_rear_is_measured_ten_decibels_below_each_end():
    """By exponentials: A τ (1 − 0.1) before, B τ' (1 − 0.1) behind, (B − A) T/ln(B/A) between."""
    front, rear, rises, falls, passing = 0.02, 0.3, 0.4, 0.9, 2.0
    time = np.linspace(-4.0, 9.0, 26_001)
    before, behind = front * np.exp(time / rises), rear * np.exp(-(time - passing) / falls)
    between = front * (rear / front) ** (time / passing)
    squared = np.where(time < 0.0, before, np.where(time > passing, behind, between))
    _, mean, exposure = pass_by.pass_by_levels(time, squared[None], (0.0, passing))[:, 0]
    inside = (rear - front) * passing / np.log(rear / front)
    assert mean == pytest.approx(10.0 * np.log10(inside / passing / 4e-10), abs=1e-4)
    outside = 0.9 * (front * rises + rear * falls)
    assert exposure == pytest.approx(10.0 * np.log10((inside + outside) / passing / 4e-10), abs=1e-3)


def test_a_level_that_does_not_fall_is_refused():
    message = "does not fall by 10 dB before and after the train between -1"
    with pytest.raises(ComputationError, match=message):
        pass_by.pass_by_levels(TIME, np.ones((1, 101)), (-0.5, 0.5))


test_bad_input = refusals(
    (lambda: SoundPath(BAND, Receiver(0.7), rail_distance=1.5), "beside both rails"),
    (lambda: SoundPath(BAND, Receiver(7.5, -1.0), GRASS), "-0.5 m above the ground"),
)
