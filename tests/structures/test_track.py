"""The infinite track against superposed supports, closed forms and limits; its decay rates and losses."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from asperity import Track
from asperity.reference.railways import TRACKS
from asperity.structures.support import Relaxation, relaxing
from asperity.structures.track import EN_15461_BAYS, decay_rate, decay_rate_en15461, decay_rate_of_responses
from refusals import refusals
from superposed import euler_free, free_rail, superposed, supports_by_hand

BENDING, MASS, SPACING = 4.725e6, 60.0, 0.6
SHEAR, INERTIA = 2.435e8, 0.238


def track(**changes):
    return Track.named("nordborg", **({"rail_loss_factor": 0.01} | changes))


def timoshenko(**changes):
    return track(shear_stiffness=SHEAR, rotary_inertia=INERTIA, **changes)


def undamped(**changes):
    return track(pad_damping=None, ballast_damping=None, **({"rail_loss_factor": 0.0} | changes))


@pytest.fixture(params=[track, timoshenko], ids=["euler-bernoulli", "timoshenko"])
def make(request):
    return request.param


PAIRS = [(0.3, 0.3), (0.0, 0.0), (0.1, 0.1), (0.1, 0.45), (3.77, 0.1), (-1.3, 0.2), (0.6, 0.0), (-7.2, -7.2)]


@pytest.mark.parametrize("make", [track, timoshenko])
@pytest.mark.parametrize("frequency", [20.0, 90.0, 276.0, 517.0, 1063.0, 1224.5, 2500.0, 5000.0])
def test_receptance_is_that_of_961_superposed_supports(make, frequency):
    rail, omega = make(), 2.0 * math.pi * frequency
    at = SPACING * (np.arange(961) - 480)
    expected = superposed(free_rail(rail, omega), supports_by_hand(rail, omega), at, PAIRS)
    found = np.array([rail.receptance(np.array([frequency]), x, x0)[0] for x, x0 in PAIRS])
    np.testing.assert_allclose(found, expected, rtol=1e-8)


def test_a_rail_without_support_force_is_the_free_rail():
    rail = track(pad_damping=None, ballast_damping=None)
    frequency = math.sqrt(150e6 / 150.0) / (2.0 * math.pi)  # of a sleeper on its ballast
    free = euler_free(rail, 2.0 * math.pi * frequency)
    found = [rail.receptance(frequency, x, x0) for x, x0 in PAIRS]
    np.testing.assert_allclose(found, [free(x - x0) for x, x0 in PAIRS], rtol=1e-10)


@given(x=st.floats(-5.0, 5.0), x0=st.floats(-5.0, 5.0), frequency=st.floats(20.0, 5000.0))
@settings(max_examples=60)
def test_reciprocity_and_mirror_symmetry(x, x0, frequency):
    for rail in (track(), timoshenko()):
        here = rail.receptance(frequency, x, x0)
        scale = abs(rail.receptance(frequency, x0, x0)) + abs(here)
        assert abs(here - rail.receptance(frequency, x0, x)) < 1e-9 * scale
        assert abs(here - rail.receptance(frequency, -x, -x0)) < 1e-9 * scale
        assert abs(here - rail.receptance(frequency, x + 4.2, x0 + 4.2)) < 1e-9 * scale


def test_static_deflection_is_the_limit_of_slow_motion(make):
    rail = make(rail_loss_factor=0.0)
    for x in (0.0, 0.17, 0.3, 0.6, -1.1):
        slow = rail.receptance(np.array([0.5, 1.0]), x, x).real
        assert rail.static_deflection(1.0, x) == pytest.approx(
            (4.0 * slow[0] - slow[1]) / 3.0, rel=1e-8, abs=0.0
        )


def test_pinned_pinned_frequency_of_uic60():
    """1420 Hz for Euler-Bernoulli and 1063 Hz for Timoshenko at 0.6 m."""
    assert Track.named("uic60-euler").pinned_pinned_frequency == pytest.approx(1420.0, abs=0.5)
    assert Track.named("uic60").pinned_pinned_frequency == pytest.approx(1063.0, abs=1.0)


def test_sleepers_hold_the_rail_at_the_antiresonance(make):
    rail = undamped()
    expected = math.sqrt(450e6 / 150.0) / (2.0 * math.pi)
    assert rail.antiresonance_frequency == pytest.approx(expected, rel=1e-14)
    at, beside = np.abs(rail.receptance(expected * np.array([1.0, 1.1]), 0.0, 0.0))
    assert at < 1e-6 * beside
    light = track(sleeper_mass=0.0)
    assert light.antiresonance_frequency == math.inf
    assert light.cut_on_frequency == pytest.approx(math.sqrt(100e6 / SPACING / MASS) / (2.0 * math.pi))


def test_waves_of_an_undamped_track_run_only_above_cut_on():
    rail = undamped()
    lower, upper = rail.cut_on_frequencies
    quiet = np.array([0.5 * lower, 0.97 * lower, 1.05 * rail.antiresonance_frequency, 0.98 * upper])
    running = np.array([1.03 * lower, 1.03 * upper, 900.0, 2000.0])
    response = rail.receptance(quiet, 0.1, 0.1)
    assert np.all(np.abs(response.imag) < 1e-6 * np.abs(response.real))
    assert np.all(rail.receptance(running, 0.1, 0.1).imag < 0.0)
    largest = np.abs(rail.waves(2.0 * np.pi * running).multipliers).max(axis=0)
    np.testing.assert_allclose(largest, 1.0, rtol=1e-6)


def test_named_sets_name_a_source_for_every_value():
    for name, parameters in TRACKS.items():
        rail = Track.named(name)
        assert rail.name == name
        assert len(rail.sources) == len(parameters)
        for key, (value, source) in parameters.items():
            assert getattr(rail, key) == value
            assert f"{key}: {source}" in rail.sources
    assert all("thesis prints none" in source for source in Track.named("x2000").sources)


def test_numbers_of_a_named_track_are_those_that_its_sources_state():
    values = {name: value for name, (value, _) in TRACKS["uic60"].items()}
    young, shear, inertia, area = 210e9, 80.77e9, 3037e-8, 76.7e-4
    assert values["bending_stiffness"] == young * inertia
    assert values["shear_stiffness"] == pytest.approx(0.393 * shear * area, rel=1e-15)
    assert values["rotary_inertia"] == pytest.approx(values["mass_per_length"] / area * inertia, rel=1e-15)
    supports = {"pad_stiffness": 180e6, "pad_damping": 18e3, "sleeper_mass": 150.0, "sleeper_spacing": 0.6}
    supports |= {"ballast_stiffness": 40e6, "ballast_damping": 47e3}
    assert values == {"mass_per_length": 60.2, "rail_loss_factor": 0.02} | supports | {
        name: values[name] for name in ("bending_stiffness", "shear_stiffness", "rotary_inertia")
    }
    assert math.isinf(TRACKS["embedded"]["ballast_stiffness"][0])
    assert TRACKS["embedded"]["continuous"][0] is True


def test_overrides_replace_the_other_kind_of_damping():
    rail = Track.named("nordborg", pad_loss_factor=0.2, sleeper_spacing=0.65)
    assert (rail.pad_damping, rail.pad_loss_factor) == (None, 0.2)
    assert rail.ballast_damping == 48e3
    assert "sleeper_spacing: given here" in rail.sources
    assert not any(source.startswith("pad_damping") for source in rail.sources)
    back = Track.named("nordborg-loss-factor", ballast_damping=48e3)
    assert (back.ballast_damping, back.ballast_loss_factor) == (48e3, None)
    assert not back.is_causal
    assert not rail.is_causal
    assert track(rail_loss_factor=0.0).is_causal
    assert rail.is_damped
    assert not undamped().is_damped


def test_places_are_asked_one_by_one_or_all_at_once():
    frequency, to, of = [[80.0, 300.0, 1100.0]], np.array([0.0, 0.3, 0.77]), np.array([0.0, 0.3, -1.1])
    found = track().receptance(frequency, to, of)
    assert found.shape == (3, 1, 3)
    for each, x, x0 in zip(found, to, of, strict=True):
        np.testing.assert_array_equal(each, track().receptance(frequency, x, x0))
    assert track().receptance(80.0, 0.0, 0.0).shape == ()


def test_an_impulse_starts_as_on_a_beam_or_as_the_wave_front_of_a_string():
    """Laplace transforms of sqrt(t/2 pi) B^(-1/4) m'^(-3/4), and of the step 1/(2 sqrt(S m'))."""
    s = np.array([5e5, 1e6, 3e6])
    found = track(rail_loss_factor=0.0).waves(-1j * s).receptance(0.3, 0.3)
    np.testing.assert_allclose(found, 8**-0.5 * s**-1.5 * BENDING**-0.25 * MASS**-0.75, rtol=1e-6)
    s = np.array([3e5, 6e5])
    found = timoshenko(rail_loss_factor=0.0).waves(-1j * s).receptance(0.3, 0.3)
    errors = np.abs(found * 2.0 * s * math.sqrt(SHEAR * MASS) - 1.0)
    assert errors[1] < 3e-3
    assert math.log2(errors[0] / errors[1]) == pytest.approx(2.0, abs=0.1)


def rates(frequency):
    """Decay rates, dB/m, by exp(−α x)."""
    return 20.0 * math.log10(math.e) * frequency


def test_the_decay_is_that_of_a_winkler_foundation_of_a_free_rail_and_of_the_far_field():
    """Near zero frequency waves fall with exp(−β x), far above cut-on with exp(−η k x/4)."""
    winkler = Track(BENDING, MASS, 6e6, 0.0, 3e6, 0.02, rail_loss_factor=1e-6)
    assert decay_rate(winkler, 1.0) == pytest.approx(rates((100e6 / (4.0 * BENDING)) ** 0.25), rel=1e-4)
    free = Track(BENDING, MASS, 1e5, 0.0, 1e5, 0.6, rail_loss_factor=0.02)
    frequency = np.array([[1000.0, 2000.0, 4000.0]])
    k = np.sqrt(2.0 * np.pi * frequency) * (MASS / BENDING) ** 0.25
    np.testing.assert_allclose(decay_rate(free, frequency), rates(0.02 * k / 4.0), rtol=1e-3)
    rail, frequency = Track.named("uic60"), np.array([300.0, 800.0, 1063.0, 3000.0])
    near, far = (np.abs(rail.receptance(frequency, 0.3 + 0.6 * n, 0.3)) for n in (40, 50))
    np.testing.assert_allclose(20.0 * np.log10(near / far) / 6.0, decay_rate(rail, frequency), rtol=1e-6)


@pytest.mark.parametrize("rate", [0.0, 0.8, 2.0, 4.0, 8.0])
def test_an_exponential_decay_is_found_by_the_standard(rate):
    """From 29 places; its rectangles overestimate the sum by some (2 alpha Delta x)^2/12.

    Without decay it finds 4.343 dB over the length that the positions stand for.
    """
    distances = 0.6 * np.array(EN_15461_BAYS)
    assert (distances.size, EN_15461_BAYS[-1]) == (29, 66.0)
    found = decay_rate_of_responses(distances, 3e-9 * 10.0 ** (-rate * distances[:, None] / 20.0))
    floor = 10.0 * math.log10(math.e) / (0.6 * (66.0 + 6.0))
    assert found == pytest.approx(rate or floor, rel=0.015 if rate else 1e-12, abs=0.0)


def test_both_rates_agree_where_one_wave_rules():
    rail, frequency = Track.named("uic60"), np.array([2000.0, 2500.0, 3000.0])
    np.testing.assert_allclose(decay_rate_en15461(rail, frequency), decay_rate(rail, frequency), rtol=0.15)


def test_a_relaxing_stiffness_is_a_spring_and_exponentials_in_time():
    """A unit strain rises at t = 0: stress = static + Σ strength e^(-2π f t), whose transform is K/(iω)."""
    mixed, omega = Relaxation(0.5, (1.0, 3.0), (10.0, 200.0)), np.array([[300.0 - 1.0j, 20.0]])
    decay = 2.0 * np.pi * np.array([10.0, 200.0])
    stress = 0.5 / (1j * omega) + np.sum([1.0, 3.0] / (1j * omega[..., None] + decay), axis=-1)
    np.testing.assert_allclose(mixed.at(omega) / (1j * omega), stress, rtol=1e-12)
    np.testing.assert_allclose(relaxing(omega, (10.0, 200.0)) @ [0.5, 1.0, 3.0], mixed.at(omega), rtol=1e-14)


test_bad_parameters_and_questions_are_refused = refusals(
    (lambda: track(bending_stiffness=0.0), "bending_stiffness of the track"),
    (lambda: track(pad_stiffness=math.nan), "pad_stiffness of the track"),
    (lambda: track(rail_loss_factor=-0.1), "rail_loss_factor of the track"),
    (
        lambda: track(pad_damping=18e3, pad_loss_factor=0.2),
        "pad_damping = 18000 N s/m and pad_loss_factor = 0.2; allowed: one",
    ),
    (lambda: track(shear_stiffness=2e8), "no rotary_inertia"),
    (lambda: track(rotary_inertia=0.2), "no shear_stiffness"),
    (lambda: track().receptance(100.0, [0.0, 0.3], 0.0), "as many for the response as for the force"),
    (lambda: track().receptance([100.0, 0.0], 0.0, 0.0), "frequency"),
    (lambda: track().receptance(100.0, math.nan, 0.0), "positions on the track"),
    (lambda: track().receptance(1e9, 0.0, 0.0), "Lower the highest frequency"),
    (lambda: track().refuse_speed(track().critical_speed), "below the critical speed of the track"),
    (lambda: Track.named("nordburg"), 'Did you mean "nordborg"'),
    (lambda: track(pad_mass=1.0), "track parameter"),
    (lambda: decay_rate(track(), [0.0, 100.0]), "frequency"),
    (lambda: decay_rate_of_responses([0.3, 0.6], [1.0, 0.5]), "ascending from zero"),
)
