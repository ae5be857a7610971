"""The moving kernel, its poles, and the rail between contacts, against receptances and closed forms."""

from dataclasses import replace

import numpy as np
import pytest

from asperity.errors import CoarseSamplingWarning, UnconvergedWarning
from asperity.reference.railways import TRACKS
from asperity.store import Store
from asperity.structures import rail_poles as fitting
from asperity.structures.moving_kernel import MovingKernel, moving_kernel
from asperity.structures.rail_poles import (
    RailPoles,
    over_the_period,
    poles_or_kernel,
    rail_between,
    rail_poles,
)
from asperity.structures.track import Track
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
    like = {"duration": 0.05, "positions": 6, "cache": store}
    first, again = (
        moving_kernel(VISCOUS, 56.0, 2e-4, **like, progress=lambda *args: told.append(args)) for _ in range(2)
    )
    assert told[-1] == (6, 6, "moving kernel of 0.05 s")
    assert (len(told), len(store.files())) == (6, 1)
    np.testing.assert_array_equal(first.weights, again.weights)
    moving_kernel(VISCOUS, 57.0, 2e-4, **like)
    fits = [rail_poles(first, 20, cache=store) for _ in range(2)]
    assert len(store.files()) == 3
    np.testing.assert_array_equal(fits[0].residues, fits[1].residues)


def test_a_periodic_function_is_tabulated_over_the_bay():
    fine = over_the_period(np.sin(2 * np.pi * np.arange(24) / 24), 1)
    np.testing.assert_allclose(fine, np.sin(2 * np.pi * np.linspace(0, 1, len(fine))), atol=1e-4)
    np.testing.assert_allclose(over_the_period(np.array([[2.0 + 1j, 3.0]]), 1), [[2.0 + 1j, 3.0]] * len(fine))


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
