"""The moving kernel and its poles against closed forms of beams on elastic foundation and of short times."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.integrate import quad
from scipy.interpolate import CubicSpline

from asperity.errors import CoarseSamplingWarning, InputError, UnconvergedWarning
from asperity.reference.tracks import TRACKS
from asperity.store import Store
from asperity.structures.moving_kernel import MovingKernel, moving_kernel
from asperity.structures.rail_poles import over_the_bay, poles_or_kernel, rail_poles
from asperity.structures.track import Track

STEP = 50e-6
NORDBORG = {
    "bending_stiffness": 4.725e6,
    "mass_per_length": 60.0,
    "pad_stiffness": 300e6,
    "sleeper_mass": 150.0,
    "ballast_stiffness": 150e6,
    "sleeper_spacing": 0.6,
}
VISCOUS = Track(**NORDBORG, rail_loss_factor=0.004, pad_damping=18e3, ballast_damping=48e3)


def sampled_receptance(track, frequency, x, step=STEP):
    """Receptance times the hat's transform, with what sampling folds onto each frequency."""
    total = 0.0
    for alias in (-2, -1, 0, 1, 2):
        f = frequency + alias / step
        receptance = track.receptance(np.abs(f), x, x)
        hat = (np.sin(np.pi * f * step) / (np.pi * f * step)) ** 2
        total = total + hat * (np.conj(receptance) if alias < 0 else receptance)
    return total


@pytest.fixture(scope="module")
def kernel():
    return moving_kernel(VISCOUS, 56.0, STEP)


@pytest.fixture(scope="module")
def at_rest():
    return moving_kernel(VISCOUS, 0.0, STEP)


def test_a_constant_force_at_rest_gives_the_static_deflection(at_rest):
    places = 0.6 / 24 * np.arange(24)
    expected = [at_rest.track.static_deflection(1.0, x) for x in places]
    np.testing.assert_allclose(at_rest.weights.sum(axis=1), expected, rtol=1e-3)


def test_the_transform_of_the_kernel_at_rest_is_the_receptance(at_rest):
    frequency = np.array([60.0, 150.0, 400.0, 900.0, 1400.0, 2500.0, 4000.0])
    lags = STEP * np.arange(at_rest.weights.shape[1])
    found = at_rest.weights @ np.exp(-2j * np.pi * lags[:, None] * frequency)
    for row in (0, 5, 12):
        expected = sampled_receptance(at_rest.track, frequency, 0.025 * row)
        np.testing.assert_allclose(found[row], expected, rtol=0.005)


def test_short_times_follow_the_closed_law_of_the_free_beam():
    # g(t) = sqrt(t/2π) B^(-1/4) m^(-3/4), weighted by the hat of each step
    step = 5e-6
    kernel = moving_kernel(VISCOUS, 56.0, step, duration=0.02)

    def law(t):
        return np.sqrt(t / (2 * np.pi)) * 4.725e6**-0.25 * 60.0**-0.75

    rising = quad(lambda t: law(t) * (1 - t / step), 0.0, step)[0]
    assert kernel.weights[12, 0] == pytest.approx(rising, rel=0.01)
    for k in (1, 2, 5, 10):
        hat = quad(lambda t, k=k: law(t) * (1 - abs(t / step - k)), (k - 1) * step, k * step)[0]
        hat += quad(lambda t, k=k: law(t) * (1 - abs(t / step - k)), k * step, (k + 1) * step)[0]
        assert kernel.weights[12, k] == pytest.approx(hat, rel=0.01)


def test_close_supports_give_the_moving_deflection_of_the_winkler_beam():
    # w0 / sqrt(1 - (v/v_cr)²) under a load moving over an (almost) undamped foundation
    track = Track(
        bending_stiffness=4.725e6,
        mass_per_length=60.0,
        pad_stiffness=1e7,
        pad_damping=300.0,
        sleeper_mass=0.0,
        ballast_stiffness=1e13,
        sleeper_spacing=0.1,
    )
    stiffness = track.foundation_stiffness
    critical = (4 * stiffness * 4.725e6 / 60.0**2) ** 0.25
    beta = (stiffness / (4 * 4.725e6)) ** 0.25
    for share in (0.3, 0.6):
        kernel = moving_kernel(track, share * critical, 1e-4, positions=6)
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


def test_start_positions_and_length_do_not_matter(kernel):
    longer = moving_kernel(VISCOUS, 56.0, STEP, duration=1.5 * kernel.weights.shape[1] * STEP)
    finer = moving_kernel(VISCOUS, 56.0, STEP, positions=36, duration=kernel.weights.shape[1] * STEP)
    size = np.linalg.norm(kernel.weights)
    assert np.linalg.norm(longer.weights[:, : kernel.weights.shape[1]] - kernel.weights) < 1e-3 * size
    assert np.linalg.norm(finer.weights[::3] - kernel.weights[::2]) < 1e-3 * size


def test_poles_reproduce_the_kernel(kernel):
    fit = rail_poles(kernel, 100)
    assert fit.accepted
    assert fit.fit_error < 2e-3
    assert fit.static_error < 1e-3
    left = np.linalg.norm(fit.weights() - kernel.weights) / np.linalg.norm(kernel.weights)
    assert left < 2e-3
    assert (np.abs(fit.poles) < 1.0).all()


def test_more_poles_fit_better_and_few_are_not_accepted(kernel):
    errors = [rail_poles(kernel, count).fit_error for count in (8, 24, 60)]
    assert errors[0] > 4 * errors[1] > 16 * errors[2] / 2
    assert not rail_poles(kernel, 8).accepted


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
        assert np.linalg.norm(found - longer) < 2e-3 * np.linalg.norm(longer)
        assert np.abs(found - longer)[:, taps:].max() < 1e-3 * longer.max()
        lasting = np.abs(fit.weights(8 * taps)[:, 7 * taps :]).max()
        assert lasting < 1e-9 * longer.max()
        mean = np.fft.rfft(fit.weights(8 * taps).mean(axis=0))
        frequency = np.fft.rfftfreq(8 * taps, step)
        assert (mean.imag[(frequency > 0.0) & (frequency < 1600.0)] < 0.0).all()


def test_only_poles_that_say_something_are_taken(kernel):
    taken = {count: poles_or_kernel(kernel, count).count for count in (60, 1000)}
    assert taken[60] <= 62
    assert taken[1000] <= 102


def test_what_gives_off_energy_is_not_taken_for_a_rail(kernel, monkeypatch):
    fit = rail_poles(kernel, 60)
    one_more = np.exp(np.array([1j * 2 * np.pi * 300.37 - 2.0]) * STEP)  # narrower than what is looked at
    active = replace(
        fit,
        poles=np.append(fit.poles, one_more),
        residues=np.append(fit.residues, np.full((24, 1), 1e-2j * np.abs(fit.residues).max()), axis=1),
    )
    assert fit.is_passive
    assert not active.is_passive
    monkeypatch.setattr("asperity.structures.rail_poles.rail_poles", lambda *_, **__: active)
    with pytest.warns(UnconvergedWarning, match="60 poles give off energy: the track is scattered"):
        assert poles_or_kernel(kernel, 60) is kernel


def test_kernels_and_fits_are_kept_by_their_content(tmp_path):
    store = Store(tmp_path)
    first = moving_kernel(VISCOUS, 56.0, 2e-4, duration=0.05, cache=store)
    again = moving_kernel(VISCOUS, 56.0, 2e-4, duration=0.05, cache=store)
    assert len(store.files()) == 1
    np.testing.assert_array_equal(first.weights, again.weights)
    moving_kernel(VISCOUS, 57.0, 2e-4, duration=0.05, cache=store)
    assert len(store.files()) == 2
    fits = [rail_poles(first, 20, cache=store) for _ in range(2)]
    assert len(store.files()) == 3
    np.testing.assert_array_equal(fits[0].residues, fits[1].residues)


def test_a_periodic_function_is_tabulated_over_the_bay():
    places = np.arange(24) / 24
    fine = over_the_bay(np.sin(2 * np.pi * places))
    np.testing.assert_allclose(fine, np.sin(2 * np.pi * np.linspace(0, 1, len(fine))), atol=1e-4)


@pytest.mark.parametrize("count", [1, 2, 3, 24])
def test_the_table_over_the_bay_is_a_periodic_spline(count):
    values = np.random.default_rng(count).normal(size=(count, 3)) + 1j
    fine = over_the_bay(values)
    spline = CubicSpline(np.linspace(0, 1, count + 1), [*values, values[0]], bc_type="periodic")
    np.testing.assert_allclose(fine, spline(np.linspace(0, 1, len(fine))), atol=1e-12)


def test_progress_names_the_kernel():
    seen = []
    moving_kernel(VISCOUS, 56.0, 2e-4, duration=0.02, positions=6, progress=lambda *args: seen.append(args))
    assert seen[-1] == (6, 6, "moving kernel of 0.02 s")


def test_bad_input_is_refused():
    with pytest.raises(InputError, match="critical"):
        moving_kernel(VISCOUS, 5000.0, STEP)
    with pytest.raises(InputError, match="no damping at all"):
        moving_kernel(Track(**NORDBORG), 56.0, STEP)
    with pytest.raises(InputError, match="time step"):
        moving_kernel(VISCOUS, 56.0, 0.0)
    with pytest.raises(InputError, match="speed"):
        moving_kernel(VISCOUS, -1.0, STEP)
    short = MovingKernel(VISCOUS, 56.0, STEP, np.ones((4, 100)))
    with pytest.raises(InputError, match="number of poles"):
        rail_poles(short, 20)
    with pytest.raises(InputError, match="an even number"):
        rail_poles(short, 5)


def test_a_kernel_that_does_not_die_away_is_warned_of(monkeypatch):
    monkeypatch.setattr("asperity.structures.moving_kernel.LONGEST", 0.05)
    monkeypatch.setattr("asperity.structures.moving_kernel.SHORTEST", 0.05)
    with pytest.warns(CoarseSamplingWarning, match="what comes later is cut off"):
        moving_kernel(VISCOUS, 56.0, 2e-4)


@pytest.mark.parametrize(
    ("damping", "rail", "told", "remedy"),
    [
        (1e3, 0.01, r"swings at 140 Hz: raise ballast_damping", {"ballast_damping": 30e3}),
        (30e3, 0.0, r"swings at 1200 Hz: raise rail_loss_factor", {"rail_loss_factor": 0.01}),
    ],
)
def test_what_is_advised_lets_a_kernel_die_away(monkeypatch, damping, rail, told, remedy):
    """Sleepers on light ballast, and the rail between them, swing on for long."""
    monkeypatch.setattr("asperity.structures.moving_kernel.LONGEST", 0.3)
    monkeypatch.setattr("asperity.structures.moving_kernel.SHORTEST", 0.3)
    light = {**NORDBORG, "pad_damping": 30e3, "ballast_damping": damping, "rail_loss_factor": rail}
    with pytest.warns(CoarseSamplingWarning, match=told):
        moving_kernel(Track(**light), 28.0, 2e-4, positions=2)
    moving_kernel(Track(**{**light, **remedy}), 28.0, 2e-4, positions=2)  # silent
