"""The causal track that stands for loss factors: causality, passivity, and the contact force on it."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from asperity import Track
from asperity.spectra import third_octave_bands
from asperity.store import Store
from asperity.structures import causal_track as module
from asperity.structures.causal_track import LEAST_STATIC, causal_track, least_static
from asperity.structures.moving_kernel import moving_kernel

STEP = 50e-6
NORDBORG = Track.named("nordborg-loss-factor")
TRACKS = [  # track, and what the contact force may be off in any band, dB
    (NORDBORG, 0.7),
    (replace(NORDBORG, ballast_loss_factor=1.0), 1.0),
    (replace(NORDBORG, ballast_loss_factor=2.0), 1.1),
    (replace(NORDBORG, pad_loss_factor=0.25), 0.8),
    (replace(NORDBORG, pad_loss_factor=0.25, ballast_loss_factor=2.0), 1.1),
    (Track.named("uic60", pad_loss_factor=0.25, ballast_loss_factor=1.0), 0.9),
    (Track.named("x2000"), 0.15),
]


def force_levels(receptances, frequency, mass=600.0, stiffness=1.25e9):
    """Level of the mean square contact force per band, (positions, bands, lines) → (bands,)."""
    carried = 1.0 / stiffness - 1.0 / (mass * (2.0 * np.pi * frequency) ** 2)
    return 10.0 * np.log10(np.mean(np.abs(1.0 / (carried + receptances)) ** 2, axis=(0, 2)))


@pytest.mark.parametrize(("track", "tolerance"), TRACKS)
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
    track = replace(NORDBORG, rail_loss_factor=rail, pad_loss_factor=pad, ballast_loss_factor=ballast)
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
    track = replace(NORDBORG, rail_loss_factor=0.0, pad_loss_factor=0.0, ballast_loss_factor=2e-30)
    assert max(causal_track(track).relaxations.ballast.strengths) < 1e-29


def test_the_least_static_stiffness_falls_with_the_loss_factor_to_a_bound():
    assert [least_static(eta) for eta in (0.0, 0.25, 2.0)] == pytest.approx([1.0, 1.0 / 1.5, LEAST_STATIC])


def test_what_is_causal_stays_as_it_is_and_what_is_not_keeps_its_nominal_track():
    viscous = Track.named("nordborg", rail_loss_factor=0.0)
    assert causal_track(viscous) is viscous
    causal = causal_track(NORDBORG)
    assert causal_track(causal) is causal
    assert causal.nominal == NORDBORG
    omega = 2.0 * np.pi * np.array([10.0, 100.0, 1000.0])
    np.testing.assert_allclose(NORDBORG.support.elements[0].stiffness(omega), 300e6 * (1.0 + 0.15j))
    np.testing.assert_allclose(NORDBORG.support.elements[-1].stiffness(omega), 150e6 * (1.0 + 0.4j))


def test_a_fit_is_kept_whatever_the_name_of_the_track(tmp_path, monkeypatch):
    store = Store(tmp_path)
    monkeypatch.setattr(module, "_fitted", {})
    fitted = causal_track(NORDBORG, store)
    assert causal_track(NORDBORG) is fitted
    monkeypatch.setattr(module, "_fitted", {})
    monkeypatch.setattr(module.scipy.optimize, "nnls", None)  # nothing is fitted
    other = causal_track(replace(NORDBORG, name="another"), store)
    assert other == replace(fitted, name="another")
    assert len(store.files()) == 1
