"""The moving kernel, its causal track, its poles, and the rail between contacts."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from asperity import Track
from asperity.errors import CoarseSamplingWarning, UnconvergedWarning
from asperity.reference.railways import TRACKS
from asperity.spectra import third_octave_bands
from asperity.store import Store
from asperity.structures import causal_track as module
from asperity.structures import rail_poles as fitting
from asperity.structures.causal_track import LEAST_STATIC, causal_track, least_static
from asperity.structures.moving_kernel import DIED_AWAY, MovingKernel, _Begun, moving_kernel
from asperity.structures.rail_poles import RailPoles, poles_or_kernel, rail_between, rail_poles
from refusals import refusals

STEP = 50e-6
VISCOUS = Track.named("nordborg")
LOSSY = Track.named("nordborg-loss-factor")
SOFT = Track.named("uic60", pad_loss_factor=0.25, ballast_loss_factor=1.0)
DAMPED = Track.named("nordborg", rail_loss_factor=0.03)
BENDING, MASS = VISCOUS.bending_stiffness, VISCOUS.mass_per_length


def norm(kernel):
    return np.linalg.norm(getattr(kernel, "weights", kernel))


@pytest.fixture(scope="module")
def kernel():
    return moving_kernel(VISCOUS, 56.0, STEP, positions=12)


@pytest.fixture(scope="module")
def damped():
    return moving_kernel(DAMPED, 56.0, STEP, duration=0.08, positions=12)


@pytest.mark.parametrize(
    ("track", "distance"),
    [(VISCOUS, 0.0), (LOSSY, 0.0), (SOFT, 0.0), *((DAMPED, d) for d in (2.5, -2.5, 0.35, -0.35, -6.05))],
)
def test_the_kernel_at_rest_is_the_receptance(track, distance):
    """Of its causal track, times the transform of the hat, with what sampling folds onto each frequency."""
    highest = 3e3 if distance else 5e3  # Hz
    kernel = moving_kernel(track, 0.0, STEP, positions=24, distance=distance)
    frequency = np.array([30.0, 60.0, 150.0, 400.0, 900.0, 1400.0, 2500.0, 4000.0])
    frequency = frequency[frequency < highest]
    lags = STEP * np.arange(kernel.weights.shape[1])
    found = kernel.weights @ np.exp(-2j * np.pi * lags[:, None] * frequency)
    for row in (0, 5, 12):
        x, (expected, size) = 0.025 * row, np.zeros((2, frequency.size))
        for alias in (-2, -1, 0, 1, 2):
            f = frequency + alias / STEP
            at, own = (kernel.track.receptance(np.abs(f), x + d, x) for d in (distance, 0.0))
            hat = np.sinc(f * STEP) ** 2
            expected = expected + hat * (at.conj() if alias < 0 else at)
            size += hat * np.abs(own)
        assert np.all(np.abs(found[row] - expected) < 0.005 * size)
        if not distance:
            static = kernel.track.static_deflection(1.0, x)
            assert kernel.weights[row].sum() == pytest.approx(static, rel=2e-3)


def test_close_supports_give_the_moving_deflection_of_the_winkler_beam():
    """w0 / sqrt(1 - (v/v_cr)²) under a load moving over an (almost) undamped foundation."""
    track = Track(BENDING, MASS, 1e7, 0.0, 1e13, 0.1, pad_damping=300.0)
    stiffness = track.foundation_stiffness
    critical = (4 * stiffness * BENDING / MASS**2) ** 0.25
    beta = (stiffness / (4 * BENDING)) ** 0.25
    for share in (0.3, 0.6):
        kernel = moving_kernel(track, share * critical, 1e-4, positions=2)
        expected = beta / (2 * stiffness) / np.sqrt(1 - share**2)
        np.testing.assert_allclose(kernel.weights.sum(axis=1), expected, rtol=5e-3)


def test_the_pinned_pinned_peak_splits_by_the_speed(kernel):
    pinned = VISCOUS.pinned_pinned_frequency
    frequency = np.arange(pinned - 150.0, pinned + 150.0, 1.0)
    lags = STEP * np.arange(kernel.weights.shape[1])
    level = np.abs(kernel.weights @ np.exp(-2j * np.pi * lags[:, None] * frequency)).mean(axis=0)
    peaks = frequency[1:-1][(level[1:-1] > level[:-2]) & (level[1:-1] > level[2:])]
    highest = peaks[np.argsort(level[np.searchsorted(frequency, peaks)])[-2:]]
    expected = pinned + np.array([-1.0, 1.0]) * 56.0 / (2 * 0.6)
    np.testing.assert_allclose(np.sort(highest), expected, atol=10.0)


def test_a_moving_receiver_meets_the_wave_where_it_is(damped):
    """One that starts a bay behind, and rolls a bay in n steps, then meets what stands at the force."""
    lag, bay = 40, 0.6
    speed = bay / (lag * STEP)
    standing, behind, ahead = (
        moving_kernel(DAMPED, v, STEP, duration=0.08, positions=12, distance=d).weights[:, lag]
        for v, d in ((0.0, 0.0), (speed, -bay), (speed, 0.0))
    )
    np.testing.assert_allclose(behind, standing, atol=2e-3 * standing.max())
    assert np.abs(ahead - standing).max() > 0.1 * standing.max()


def test_more_poles_reproduce_the_kernel_better(kernel):
    fits = [rail_poles(kernel, count) for count in (8, 24, 60)]
    errors = [fit.fit_error for fit in fits]
    assert errors[0] > 4 * errors[1] > 8 * errors[2]
    assert (fits[0].accepted, fits[2].accepted) == (False, True)
    left = norm(fits[2].weights() - kernel.weights) / norm(kernel)
    assert 0.5 * errors[2] < left <= errors[2] < 2e-3  # which counts what comes after the kernel
    assert fits[2].static_error < 1e-3
    assert (np.abs(fits[2].poles) < 1.0).all()
    assert 100 <= poles_or_kernel(kernel, 1000).count <= 102  # no more than say something


@pytest.mark.parametrize("name", TRACKS)
def test_poles_end_as_the_kernel_does_however_many(name):
    """Beyond the window that was fitted, held to a kernel 2.5 times as long; passive on a denser grid."""
    track, step = Track.named(name), 6e-5
    kernel = moving_kernel(track, 56.0, step, positions=2)
    taps = kernel.weights.shape[1]
    longer = moving_kernel(track, 56.0, step, positions=2, duration=2.5 * taps * step).weights
    for count in (60, 200):
        fit = poles_or_kernel(kernel, count)
        assert fit.accepted
        found = fit.weights(longer.shape[1])
        assert norm(found - longer) < 2e-3 * norm(longer)
        assert np.abs(found - longer)[:, taps:].max() < 1e-3 * longer.max()
        assert np.abs(fit.weights(8 * taps)[:, 7 * taps :]).max() < 1e-9 * longer.max()
        mean = np.fft.rfft(fit.weights(8 * taps).mean(axis=0))
        frequency = np.fft.rfftfreq(8 * taps, step)
        assert (mean.imag[(frequency > 0.0) & (frequency < 1600.0)] < 0.0).all()


def test_what_gives_off_energy_is_not_taken_for_a_rail(damped, monkeypatch):
    fit = rail_poles(damped, 60)
    one_more = np.exp(np.array([1j * 2 * np.pi * 300.37 - 2.0]) * STEP)  # narrower than what is looked at
    residues = np.append(fit.residues, np.full((12, 1), 1e-2j * np.abs(fit.residues).max()), axis=1)
    active = replace(fit, poles=np.append(fit.poles, one_more), residues=residues)
    assert fit.is_passive
    assert not active.is_passive
    monkeypatch.setattr(fitting, "rail_poles", lambda *_, **__: active)
    with pytest.warns(UnconvergedWarning, match="60 poles give off energy: the track is scattered"):
        assert poles_or_kernel(damped, 60) is damped


def test_kernels_and_fits_are_kept_by_their_content(tmp_path):
    store, told = Store(tmp_path), []

    def files():
        """But for what stands for the loss factors of the track, which another test may have asked for."""
        return [path for path in store.files() if not path.name.startswith("causal-track")]

    like = {"duration": 0.05, "positions": 6, "cache": store}
    first, again = (
        moving_kernel(VISCOUS, 56.0, 2e-4, **like, progress=lambda *args: told.append(args)) for _ in range(2)
    )
    assert told[-1] == (6, 6, "moving kernel of 50 ms")
    assert (len(told), len(files())) == (6, 1)
    np.testing.assert_array_equal(first.weights, again.weights)
    moving_kernel(VISCOUS, 57.0, 2e-4, **like)
    fits = [rail_poles(first, 20, cache=store) for _ in range(2)]
    assert len(files()) == 3
    np.testing.assert_array_equal(fits[0].residues, fits[1].residues)


def test_a_periodic_function_is_tabulated_over_the_bay():
    fine = fitting.over_the_period(np.sin(2 * np.pi * np.arange(24) / 24), 1)
    np.testing.assert_allclose(fine, np.sin(2 * np.pi * np.linspace(0, 1, len(fine))), atol=1e-4)
    np.testing.assert_allclose(
        fitting.over_the_period(np.array([[2.0 + 1j, 3.0]]), 1), [[2.0 + 1j, 3.0]] * len(fine)
    )


def test_crossing_kernels_are_fitted_within_half_a_percent_of_the_direct_one_and_kept(damped, tmp_path):
    poles, told, cache = rail_poles(damped, 60), [], Store(tmp_path)
    between, again = (
        rail_between(poles, [0.0, 2.5], cache=cache, progress=lambda *args: told.append(args))
        for _ in range(2)
    )
    assert told == [(1, 1, "rail between contacts")] * 2
    assert set(between.crossing) == {2.5, -2.5}
    for distance, rail in between.crossing.items():
        assert isinstance(rail, RailPoles)
        assert norm(rail.weights() - rail.kernel.weights) <= fitting.TOLERANCE * norm(damped)
        np.testing.assert_array_equal(again.crossing[distance].residues, rail.residues)


def test_what_is_too_far_to_feel_is_left_out_by_itself(damped):
    between = rail_between(damped, [0.0, 2.5, 60.0, 90.0])
    assert set(between.crossing) == {2.5, -2.5}
    assert between.reach == 2.5
    assert between.between(57.5) is None
    far = moving_kernel(DAMPED, 56.0, STEP, duration=0.08, positions=12, distance=57.5)
    assert norm(far) < fitting.NEGLIGIBLE * norm(damped)


SHORT = MovingKernel(VISCOUS, 56.0, STEP, np.ones((4, 100)))


test_bad_input_is_refused = refusals(
    (lambda: moving_kernel(VISCOUS, 5000.0, STEP), "critical"),
    (lambda: moving_kernel(Track(BENDING, MASS, 3e8, 150.0, 1e8, 0.6), 56.0, STEP), "no damping at all"),
    (lambda: moving_kernel(VISCOUS, 56.0, 0.0), "time step"),
    (lambda: moving_kernel(VISCOUS, -1.0, STEP), "speed"),
    (lambda: moving_kernel(VISCOUS, 56.0, STEP, distance=np.inf), r"distance \(m\).*a finite number"),
    (lambda: rail_poles(SHORT, 20), "number of poles"),
    (lambda: rail_poles(SHORT, 5), "an even number"),
)


def test_a_kernel_that_has_not_died_away_is_told(monkeypatch):
    """Sleepers on light ballast swing on for long."""
    monkeypatch.setattr("asperity.structures.moving_kernel.LONGEST", 0.3)
    monkeypatch.setattr("asperity.structures.moving_kernel.SHORTEST", 0.3)
    light = replace(VISCOUS, pad_damping=30e3, ballast_damping=1e3, rail_loss_factor=0.01)
    with pytest.warns(CoarseSamplingWarning, match="cut off. Raise the damping or the loss factors of rail"):
        moving_kernel(light, 28.0, 2e-4, positions=2)
    moving_kernel(replace(light, ballast_damping=30e3), 28.0, 2e-4, positions=2)  # silent


def test_a_length_in_which_a_rail_rings_on_is_left_after_two_of_its_rows(monkeypatch):
    """Of 0.12 s, for 0.19 s; one that dies away in the first has all rows of it, each once."""
    asked, felt = [], _Begun.felt
    monkeypatch.setattr(_Begun, "felt", lambda begun, start: asked.append(start) or felt(begun, start))
    monkeypatch.setattr("asperity.structures.moving_kernel.thread_count", lambda: 1)
    found = moving_kernel(VISCOUS, 56.0, 2e-4)
    assert found.weights.shape == (24, 960)
    assert np.abs(found.weights).max(axis=1).all()
    assert asked[:2] == [0, 12]
    assert 26 <= len(asked) <= 30  # some may have begun meanwhile
    short = moving_kernel(VISCOUS, 56.0, 2e-4, duration=0.12)
    assert short.left_over > DIED_AWAY > found.left_over
    asked.clear()
    assert moving_kernel(DAMPED, 56.0, 2e-4).weights.shape == (24, 600)
    assert sorted(asked) == list(range(24))


# --- the causal track that stands for loss factors: causality, passivity, and the contact force on it

FITTED = [  # track, and what the contact force may be off in any band, dB
    (LOSSY, 0.7),
    (replace(LOSSY, ballast_loss_factor=1.0), 1.0),
    (replace(LOSSY, ballast_loss_factor=2.0), 1.1),
    (replace(LOSSY, pad_loss_factor=0.25), 0.8),
    (replace(LOSSY, pad_loss_factor=0.25, ballast_loss_factor=2.0), 1.1),
    (Track.named("uic60", pad_loss_factor=0.25, ballast_loss_factor=1.0), 0.9),
    (Track.named("x2000"), 0.15),
]


def force_levels(receptances, frequency, mass=600.0, stiffness=1.25e9):
    """Level of the mean square contact force per band, (positions, bands, lines) → (bands,)."""
    carried = 1.0 / stiffness - 1.0 / (mass * (2.0 * np.pi * frequency) ** 2)
    return 10.0 * np.log10(np.mean(np.abs(1.0 / (carried + receptances)) ** 2, axis=(0, 2)))


@pytest.mark.parametrize(("track", "tolerance"), FITTED)
def test_the_force_on_the_kernel_is_that_with_constant_loss_factors(track, tolerance):
    _, low, high = third_octave_bands(5.0, 2000.0)
    frequency = low[:, None] + (high - low)[:, None] * (np.arange(40) + 0.5) / 40
    weights, places = moving_kernel(track, 0.0, STEP, positions=8).weights, 0.6 / 8 * np.arange(8)
    lags = STEP * np.arange(weights.shape[1])[:, None]
    found = (weights @ np.exp(-2j * np.pi * lags * frequency.ravel())).reshape(8, *frequency.shape)
    nominal = np.array([track.receptance(frequency, x, x) for x in places])
    folded = np.zeros_like(nominal)  # what sampling adds to the kernel
    for alias in (-2, -1, 1, 2):
        f = frequency + alias / STEP
        moved = np.array([track.receptance(np.abs(f), x, x) for x in places])
        folded += np.sinc(f * STEP) ** 2 * (moved.conj() if alias < 0 else moved)
    error = force_levels((found - folded) / np.sinc(frequency * STEP) ** 2, frequency)
    assert np.abs(error - force_levels(nominal, frequency)).max() < tolerance


losses = st.just(0.0) | st.floats(1e-3, 3.0)


@settings(max_examples=15)
@given(rail=st.just(0.0) | st.floats(1e-4, 0.1), pad=losses, ballast=losses)
def test_it_is_passive_and_not_too_soft_at_rest(rail, pad, ballast):
    assume(rail + pad > 0.0)  # ballast alone damps no wave of the rail by what a number can hold
    track = replace(LOSSY, rail_loss_factor=rail, pad_loss_factor=pad, ballast_loss_factor=ballast)
    causal = causal_track(track)
    assert causal.is_causal
    if track.is_causal:
        return
    for factor, found in ((pad, causal.relaxations.pad), (ballast, causal.relaxations.ballast)):
        assert (found is None) == (factor == 0.0)
        if found is not None:
            assert min(found.strengths) >= 0.0
            assert found.static >= least_static(factor) * (1.0 - 1e-12)
    frequency = np.geomspace(1.0, 2e4, 200)
    for x in (0.0, 0.17, 0.3):
        assert (causal.receptance(frequency, x, x).imag <= 1e-18).all()


def test_losses_next_to_nothing_end_the_fit():
    track = replace(LOSSY, rail_loss_factor=0.0, pad_loss_factor=0.0, ballast_loss_factor=2e-30)
    assert max(causal_track(track).relaxations.ballast.strengths) < 1e-29


def test_the_least_static_stiffness_falls_with_the_loss_factor_to_a_bound():
    assert [least_static(eta) for eta in (0.0, 0.25, 2.0)] == pytest.approx([1.0, 1.0 / 1.5, LEAST_STATIC])


def test_what_is_causal_stays_as_it_is_and_what_is_not_keeps_its_nominal_track():
    viscous = Track.named("nordborg", rail_loss_factor=0.0)
    assert causal_track(viscous) is viscous
    causal = causal_track(LOSSY)
    assert causal_track(causal) is causal
    assert causal.nominal == LOSSY
    omega = 2.0 * np.pi * np.array([10.0, 100.0, 1000.0])
    np.testing.assert_allclose(LOSSY.support.elements[0].stiffness(omega), 300e6 * (1.0 + 0.15j))
    np.testing.assert_allclose(LOSSY.support.elements[-1].stiffness(omega), 150e6 * (1.0 + 0.4j))


def test_a_fit_is_kept_whatever_the_name_of_the_track(tmp_path, monkeypatch):
    store = Store(tmp_path)
    monkeypatch.setattr(module, "_fitted", {})
    fitted = causal_track(LOSSY, store)
    assert causal_track(LOSSY) is fitted
    monkeypatch.setattr(module, "_fitted", {})
    monkeypatch.setattr(module.scipy.optimize, "nnls", None)  # nothing is fitted
    other = causal_track(replace(LOSSY, name="another"), store)
    assert other == replace(fitted, name="another")
    assert len(store.files()) == 1
