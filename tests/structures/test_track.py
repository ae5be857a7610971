"""The infinite track against superposed supports, closed forms and limits."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.linalg import toeplitz

from asperity import Track
from asperity.errors import InputError
from asperity.reference.tracks import TRACKS

BENDING, MASS, SPACING = 4.725e6, 60.0, 0.6
SHEAR, INERTIA = 2.435e8, 0.238


def track(**changes):
    parameters = {
        "bending_stiffness": BENDING,
        "mass_per_length": MASS,
        "rail_loss_factor": 0.01,
        "pad_stiffness": 300e6,
        "pad_damping": 18e3,
        "sleeper_mass": 150.0,
        "ballast_stiffness": 150e6,
        "ballast_damping": 48e3,
        "sleeper_spacing": SPACING,
    }
    return Track(**(parameters | changes))


def timoshenko(**changes):
    return track(shear_stiffness=SHEAR, rotary_inertia=INERTIA, **changes)


@pytest.fixture(params=[track, timoshenko], ids=["euler-bernoulli", "timoshenko"])
def make(request):
    return request.param


def hysteretic(**changes):
    return track(
        pad_damping=None, pad_loss_factor=0.15, ballast_damping=None, ballast_loss_factor=0.4, **changes
    )


def undamped(**changes):
    return track(rail_loss_factor=0.0, pad_damping=None, ballast_damping=None, **changes)


def euler_free(rail, omega, foundation=0.0):
    """Receptance as printed in textbooks; a continuous foundation takes from the inertia."""
    bending = rail.bending_stiffness * (1.0 + 1j * rail.rail_loss_factor)
    k = ((rail.mass_per_length * omega**2 - foundation) / bending) ** 0.25
    return lambda x: -(1j * np.exp(-1j * k * np.abs(x)) + np.exp(-k * np.abs(x))) / (4.0 * bending * k**3)


def timoshenko_free(rail, omega, foundation=0.0):
    """Receptance from the conditions at the force: no rotation, shear force one half."""
    loss = 1.0 + 1j * rail.rail_loss_factor
    bending, shear = loss * rail.bending_stiffness, loss * rail.shear_stiffness
    mass, inertia = rail.mass_per_length * omega**2 - foundation, rail.rotary_inertia * omega**2
    # S(w'' - theta') + mass w = 0, B theta'' + S(w' - theta) + inertia theta = 0, with exp(p x)
    uncoupled = np.polymul([shear, 0.0, mass], [bending, 0.0, inertia - shear])
    roots = np.roots(np.polyadd(uncoupled, [shear**2, 0.0, 0.0]))
    p = roots[roots.real < 0.0]
    rotation = (shear * p**2 + mass) / (shear * p)  # theta/w
    amplitude = np.linalg.solve([rotation, shear * (p - rotation)], [0.0, -0.5])
    return lambda x: np.exp(np.multiply.outer(np.abs(x), p)) @ amplitude


def free_rail(rail, omega, foundation=0.0):
    free = euler_free if rail.shear_stiffness is None else timoshenko_free
    return free(rail, omega, foundation)


def supports_by_hand(rail, omega):
    """K from the two equations of motion of sleeper and pad."""
    pad = rail.pad_stiffness * (1.0 + 1j * (rail.pad_loss_factor or 0.0))
    pad += 1j * omega * (rail.pad_damping or 0.0)
    ballast = rail.ballast_stiffness * (1.0 + 1j * (rail.ballast_loss_factor or 0.0))
    ballast += 1j * omega * (rail.ballast_damping or 0.0)
    sleeper = pad / (pad + ballast - rail.sleeper_mass * omega**2)  # motion per motion of the rail
    return pad * (1.0 - sleeper)


def superposition(rail, frequency, pairs, supports=961):
    """Receptances by superposing the reactions of many supports under the free rail."""
    omega = 2.0 * math.pi * frequency
    free = free_rail(rail, omega)
    stiffness = supports_by_hand(rail, omega)
    at = rail.sleeper_spacing * (np.arange(supports) - supports // 2)
    matrix = np.eye(supports) + stiffness * toeplitz(free(at - at[0]), free(at - at[0]))
    forces = np.stack([free(at - x0) for _, x0 in pairs], axis=1)
    deflections = np.linalg.solve(matrix, forces)
    return np.array(
        [free(x - x0) - stiffness * free(x - at) @ deflections[:, n] for n, (x, x0) in enumerate(pairs)]
    )


PAIRS = [(0.3, 0.3), (0.0, 0.0), (0.1, 0.1), (0.1, 0.45), (3.77, 0.1), (-1.3, 0.2), (0.6, 0.0), (-7.2, -7.2)]


@pytest.mark.parametrize("make", [track, hysteretic, timoshenko])
@pytest.mark.parametrize("frequency", [20.0, 90.0, 276.0, 517.0, 1063.0, 1224.5, 2500.0, 5000.0])
def test_receptance_is_that_of_961_superposed_supports(make, frequency):
    rail = make()
    expected = superposition(rail, frequency, PAIRS)
    found = np.array([rail.receptance(np.array([frequency]), x, x0)[0] for x, x0 in PAIRS])
    np.testing.assert_allclose(found, expected, rtol=1e-8)


def test_rail_without_support_force_is_the_free_rail():
    rail = track(pad_damping=None, ballast_damping=None)
    frequency = math.sqrt(rail.ballast_stiffness / rail.sleeper_mass) / (2.0 * math.pi)
    free = euler_free(rail, 2.0 * math.pi * frequency)
    for x, x0 in PAIRS:
        assert rail.receptance(frequency, x, x0) == pytest.approx(free(x - x0), rel=1e-10)


@given(x=st.floats(-5.0, 5.0), x0=st.floats(-5.0, 5.0), frequency=st.floats(20.0, 5000.0))
@settings(max_examples=60)
def test_reciprocity_and_mirror_symmetry(x, x0, frequency):
    for rail in (track(), timoshenko()):
        here = rail.receptance(frequency, x, x0)
        scale = abs(rail.receptance(frequency, x0, x0)) + abs(here)
        assert abs(here - rail.receptance(frequency, x0, x)) < 1e-9 * scale
        assert abs(here - rail.receptance(frequency, -x, -x0)) < 1e-9 * scale
        assert abs(here - rail.receptance(frequency, x + 4.2, x0 + 4.2)) < 1e-9 * scale


def test_the_track_takes_power_from_the_force():
    frequency = np.geomspace(5.0, 10e3, 400)
    for name in TRACKS:
        rail = Track.named(name)
        for x in (0.0, 0.11, 0.3):
            assert np.all(rail.receptance(frequency, x, x).imag < 0.0)


def finely_supported(make, spacing):
    """The same stiffnesses, dampings and masses per length on supports at another distance."""
    names = ("pad_stiffness", "pad_damping", "sleeper_mass", "ballast_stiffness", "ballast_damping")
    share = spacing / SPACING
    return make(sleeper_spacing=spacing, **{name: share * getattr(make(), name) for name in names})


@pytest.mark.parametrize(("make", "order"), [(track, 4.0), (timoshenko, 2.0)])
@pytest.mark.parametrize("frequency", [30.0, 200.0, 400.0, 900.0])
def test_close_supports_become_a_winkler_foundation(make, order, frequency):
    """The ripple of bending falls with the fourth power of the distance, that of shear with the second."""
    errors = []
    for spacing in (0.08, 0.04):
        rail = finely_supported(make, spacing)
        omega = 2.0 * math.pi * frequency
        expected = free_rail(rail, omega, supports_by_hand(rail, omega) / spacing)(0.0)
        errors.append(abs(rail.receptance(frequency, 0.0, 0.0) / expected - 1.0))
    assert errors[1] < 1e-3
    assert math.log2(errors[0] / errors[1]) == pytest.approx(order, abs=0.1)


def test_static_deflection_is_that_of_superposed_springs(make):
    """Statics of a free rail with springs: rigid motion, cubics, and equilibrium."""
    rail = make()
    n = 241
    at = SPACING * (np.arange(n) - n // 2)
    stiffness = 1.0 / (1.0 / rail.pad_stiffness + 1.0 / rail.ballast_stiffness)

    def deflection(d):
        shear = 0.0 if rail.shear_stiffness is None else 0.5 * np.abs(d) / rail.shear_stiffness
        return np.abs(d) ** 3 / (12.0 * rail.bending_stiffness) - shear

    for x in (0.0, 0.17, 0.3, -0.41):
        matrix = np.zeros((n + 2, n + 2))
        matrix[:n, :n] = np.eye(n) / stiffness + deflection(at[:, None] - at)
        matrix[:n, n], matrix[:n, n + 1] = -1.0, -at
        matrix[n, :n], matrix[n + 1, :n] = 1.0, at
        solution = np.linalg.solve(matrix, np.concatenate([deflection(at - x), [1.0, x]]))
        reactions, (rise, tilt) = solution[:n], solution[n:]
        expected = deflection(0.0) - deflection(x - at) @ reactions + rise + tilt * x
        assert 65e3 * expected == pytest.approx(rail.static_deflection(65e3, x), rel=1e-7)


def test_static_deflection_is_the_limit_of_slow_motion(make):
    rail = make(rail_loss_factor=0.0)
    for x in (0.0, 0.17, 0.3, 0.6, -1.1):
        slow = rail.receptance(np.array([0.5, 1.0]), x, x).real
        assert rail.static_deflection(1.0, x) == pytest.approx((4.0 * slow[0] - slow[1]) / 3.0, rel=1e-8)


def test_pinned_pinned_frequency_of_uic60():
    """1420 Hz for Euler-Bernoulli and 1063 Hz for Timoshenko at 0.6 m."""
    assert Track.named("uic60-euler").pinned_pinned_frequency == pytest.approx(1420.0, abs=0.5)
    assert Track.named("uic60").pinned_pinned_frequency == pytest.approx(1063.0, abs=1.0)


def test_pinned_pinned_frequency_is_the_sharp_peak_at_mid_span(make):
    rail = make(rail_loss_factor=1e-4)
    expected = rail.pinned_pinned_frequency
    frequency = expected * np.linspace(0.95, 1.05, 2001)
    mid_span = np.abs(rail.receptance(frequency, 0.3, 0.3))
    assert frequency[np.argmax(mid_span)] == pytest.approx(expected, rel=2e-3)
    assert mid_span.max() > 10.0 * np.abs(rail.receptance(expected, 0.0, 0.0))


def test_sleepers_hold_the_rail_at_the_antiresonance(make):
    rail = undamped()
    expected = math.sqrt(450e6 / 150.0) / (2.0 * math.pi)
    assert rail.antiresonance_frequency == pytest.approx(expected, rel=1e-14)
    at, beside = np.abs(rail.receptance(expected * np.array([1.0, 1.1]), 0.0, 0.0))
    assert at < 1e-6 * beside
    assert track(sleeper_mass=0.0).antiresonance_frequency == math.inf


def test_cut_on_frequencies_are_those_of_uniform_motion():
    """All bays in step: the determinant of two masses on two springs vanishes."""
    for frequency in track().cut_on_frequencies:
        square = (2.0 * math.pi * frequency) ** 2
        rail, sleeper = 300e6 - MASS * SPACING * square, 450e6 - 150.0 * square
        assert rail * sleeper == pytest.approx(300e6**2, rel=1e-10)
    assert track().cut_on_frequency == max(track().cut_on_frequencies)
    light = track(sleeper_mass=0.0)
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


def test_vanishing_damping_is_the_limit_of_small_damping():
    frequency = np.array([60.0, 150.0, 350.0, 600.0, 2000.0])
    tiny = track(rail_loss_factor=1e-7, pad_damping=None, ballast_damping=None)
    exact, near = (rail.receptance(frequency, 0.1, 0.2) for rail in (undamped(), tiny))
    np.testing.assert_allclose(exact, near, rtol=1e-4)


def test_impulse_response_starts_with_the_square_root_of_time():
    """sqrt(t/2 pi) B^(-1/4) m'^(-3/4) has the Laplace transform 8^(-1/2) s^(-3/2) B^(-1/4) m'^(-3/4)."""
    rail = track(rail_loss_factor=0.0)
    s = np.array([5e5, 1e6, 3e6])
    found = rail.waves(-1j * s).receptance(0.3, 0.3)
    expected = 8**-0.5 * s**-1.5 * BENDING**-0.25 * MASS**-0.75
    np.testing.assert_allclose(found, expected, rtol=1e-6)


def test_impulse_response_of_a_shear_rail_starts_with_a_step():
    """The wave front of a string: 1/(2 sqrt(S m')), Laplace transform over s."""
    s = np.array([3e5, 6e5])
    found = timoshenko(rail_loss_factor=0.0).waves(-1j * s).receptance(0.3, 0.3)
    errors = np.abs(found * 2.0 * s * math.sqrt(SHEAR * MASS) - 1.0)
    assert errors[1] < 3e-3
    assert math.log2(errors[0] / errors[1]) == pytest.approx(2.0, abs=0.1)


def test_impulse_response_in_time_follows_the_short_time_law():
    """Inverse transform on a shifted line; the supports are felt only after some 0.1 ms."""
    rail = track(rail_loss_factor=0.0)
    step, count = 1e-6, 1 << 15
    shift = 8.0 / (step * count)
    omega = 2.0 * np.pi * np.fft.rfftfreq(count, step) - 1j * shift
    time = step * np.arange(count)
    response = np.fft.irfft(rail.waves(omega).receptance(0.3, 0.3), count) / step * np.exp(shift * time)
    early = (time > 1e-5) & (time < 4e-5)
    expected = np.sqrt(time / (2.0 * np.pi)) * BENDING**-0.25 * MASS**-0.75
    np.testing.assert_allclose(response[early], expected[early], rtol=5e-3)


def test_a_viscous_track_answers_real_forces_with_real_motion(make):
    rail = make(rail_loss_factor=0.0)
    omega = np.array([300.0, 4000.0, 20000.0]) - 200j
    right = rail.waves(omega).receptance(0.1, 0.9)
    left = rail.waves(-omega.conj()).receptance(0.1, 0.9)
    np.testing.assert_allclose(left, right.conj(), rtol=1e-10)


def test_waves_compose_the_receptance_as_documented(make):
    rail = make()
    omega = 2.0 * np.pi * np.array([80.0, 700.0, 3000.0])
    waves = rail.waves(omega)
    start, along, bays = 0.13, 0.47, 7
    composed = np.sum(
        waves.coefficients * waves.multipliers**bays * waves.outgoing(along) * waves.incoming(start), axis=0
    )
    expected = rail.receptance(omega / (2.0 * np.pi), bays * SPACING + along, start)
    np.testing.assert_allclose(composed, expected, rtol=1e-12)
    assert np.all(np.abs(waves.multipliers) < 1.0)


def test_critical_speed_and_deflection_of_the_continuous_foundation():
    light = track(sleeper_mass=0.0)
    foundation = 100e6 / SPACING
    assert light.foundation_stiffness == pytest.approx(foundation, rel=1e-14)
    beta = (foundation / (4.0 * BENDING)) ** 0.25
    critical = (4.0 * foundation * BENDING / MASS**2) ** 0.25
    assert light.critical_speed == pytest.approx(critical, rel=1e-12)
    heavy = MASS + 150.0 / SPACING
    assert track().critical_speed == pytest.approx(critical * math.sqrt(MASS / heavy), rel=1e-12)
    fine = finely_supported(track, 0.05)
    at_rest = 65e3 * beta / (2.0 * foundation)
    assert fine.static_deflection(65e3) == pytest.approx(at_rest, rel=1e-6)


def test_named_sets_name_a_source_for_every_value():
    for name, parameters in TRACKS.items():
        rail = Track.named(name)
        assert rail.name == name
        assert len(rail.sources) == len(parameters)
        for key, (value, source) in parameters.items():
            assert getattr(rail, key) == value
            assert f"{key}: {source}" in rail.sources
    assert all("thesis prints none" in source for source in Track.named("x2000").sources)


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


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"bending_stiffness": 0.0}, "bending stiffness"),
        ({"mass_per_length": -1.0}, "mass per length"),
        ({"pad_stiffness": math.nan}, "pad stiffness"),
        ({"ballast_stiffness": math.inf}, "ballast stiffness"),
        ({"sleeper_spacing": 0.0}, "sleeper spacing"),
        ({"sleeper_mass": -1.0}, "sleeper mass"),
        ({"rail_loss_factor": -0.1}, "rail loss factor"),
        ({"pad_loss_factor": 0.2}, "pad_damping = 18000 N s/m and pad_loss_factor = 0.2; allowed: one"),
        ({"ballast_loss_factor": 1.0}, "damping of the ballast"),
        ({"shear_stiffness": 2e8}, "no rotary_inertia"),
        ({"rotary_inertia": 0.2}, "no shear_stiffness"),
    ],
)
def test_bad_parameters_are_refused(changes, message):
    with pytest.raises(InputError, match=message):
        track(**changes)


def test_places_are_asked_one_by_one_or_all_at_once():
    frequency, to, of = [[80.0, 300.0, 1100.0]], np.array([0.0, 0.3, 0.77]), np.array([0.0, 0.3, -1.1])
    found = track().receptance(frequency, to, of)
    assert found.shape == (3, 1, 3)
    for each, x, x0 in zip(found, to, of, strict=True):
        np.testing.assert_array_equal(each, track().receptance(frequency, x, x0))
    assert track().receptance(80.0, 0.0, 0.0).shape == ()


def test_bad_questions_are_refused():
    with pytest.raises(
        InputError, match=r"positions on the track.*as many for the response as for the force"
    ):
        track().receptance(100.0, [0.0, 0.3], 0.0)
    with pytest.raises(InputError, match="frequency"):
        track().receptance([100.0, 0.0], 0.0, 0.0)
    with pytest.raises(InputError, match="positions on the track"):
        track().receptance(100.0, math.nan, 0.0)
    with pytest.raises(InputError, match="Lower the highest frequency"):
        track().receptance(1e9, 0.0, 0.0)
    with pytest.raises(InputError, match="below the critical speed of the track"):
        track().refuse_speed(track().critical_speed)
    with pytest.raises(InputError, match='Did you mean "nordborg"'):
        Track.named("nordburg")
    with pytest.raises(InputError, match="track parameter"):
        Track.named("nordborg", pad_mass=1.0)


def test_symmetric_places_share_the_work_for_their_shapes():
    model = track()
    waves = model.waves(np.array([200.0, 5000.0, 60000.0]) - 20j)
    places = np.array([0.0, 0.1, 0.3, 0.5, 0.6]) * model.sleeper_spacing / 0.6
    outgoing, incoming = waves.symmetric_shapes(places)
    np.testing.assert_allclose(outgoing, [waves.outgoing(x) for x in places], rtol=1e-9)
    np.testing.assert_allclose(incoming, [waves.incoming(x) for x in places], rtol=1e-9)
