"""The error of the contact force that loss factors bring in time: what is reported and warned of."""

import re
import warnings

import numpy as np
import pytest

from asperity import Track
from asperity.errors import LossFactorWarning
from asperity.scenes import track as losses
from asperity.scenes.track import loss_factor_error, warn_of_loss_factors
from asperity.spectra import nominal_frequency
from asperity.structures.moving_kernel import moving_kernel
from asperity.structures.wheel import Wheel

WHEEL, STIFFNESS, STEP = Wheel(600.0, 65e3), 1.25e9, 50e-6
LOSSY = Track.named("nordborg-loss-factor", ballast_loss_factor=2.0)


@pytest.fixture(scope="module")
def error():
    return loss_factor_error(LOSSY, WHEEL, STIFFNESS, 5000.0)


def test_it_starts_at_five_hertz_and_names_every_band(error):
    assert len(error.bands) == len(error.force) == len(error.rail) == 31
    assert [nominal_frequency(error.bands[i]) for i in (0, -1)] == ["5 Hz", "5 kHz"]


def test_it_is_that_of_the_kernel(error):
    # force of a wheel on the transform of the kernel at rest, against the receptance of the track
    places, kernel = 0.6 / 12 * np.arange(12), moving_kernel(LOSSY, 0.0, STEP, positions=12)
    lag = STEP * np.arange(kernel.weights.shape[1])
    for band in (8, 11, 12, 16, 17):  # from 31.5 Hz to 250 Hz
        frequency = error.bands[band] * 10.0 ** np.linspace(-0.049, 0.049, 40)
        transform = kernel.weights @ np.exp(-2j * np.pi * lag[:, None] * frequency)
        rail = transform / np.sinc(frequency * STEP) ** 2
        carried = WHEEL.receptance(frequency) + 1.0 / STIFFNESS
        nominal = np.array([LOSSY.receptance(frequency, x, x) for x in places])
        levels = [10 * np.log10(np.mean(np.abs(1 / (carried + each)) ** 2)) for each in (rail, nominal)]
        assert levels[0] - levels[1] == pytest.approx(error.force[band], abs=0.03)
        moved = [10 * np.log10(np.mean(np.abs(each) ** 2)) for each in (rail, nominal)]
        assert moved[0] - moved[1] == pytest.approx(error.rail[band], abs=0.03)


def test_a_causal_track_has_none():
    viscous = Track.named("nordborg", rail_loss_factor=0.0)
    found = loss_factor_error(viscous, WHEEL, STIFFNESS, 4000.0)
    np.testing.assert_array_equal(found.force, 0.0)
    np.testing.assert_array_equal(found.rail, 0.0)


def test_a_large_error_is_warned_of_with_a_remedy(error):
    with pytest.warns(LossFactorWarning) as caught:
        warn_of_loss_factors(error)
    text = str(caught[0].message)
    assert "is up to −1.0 dB from that with constant loss factors" in text
    assert re.search("more than 0.75 dB in the one-third octaves of 250 Hz, .*630 Hz: ", text)
    assert "the loss factor 2 of the ballast" in text
    # η k / ω at 631 Hz
    assert "give ballast_damping, which is exact: 75.7 kN s/m dissipate as much at 631 Hz" in text


@pytest.mark.parametrize(
    ("track", "part"),
    [
        (Track.named("uic60", pad_loss_factor=0.5), "the loss factor 0.5 of the pad .* give pad_damping"),
        (Track.named("x2000"), "the loss factor 0.02 of the rail .* or give the rail a smaller one"),
    ],
)
def test_the_part_with_the_largest_loss_factor_is_named(track, part, monkeypatch):
    monkeypatch.setattr(losses, "DOUBTFUL", 0.01)
    with pytest.warns(LossFactorWarning, match=part):
        warn_of_loss_factors(loss_factor_error(track, WHEEL, STIFFNESS, 5000.0))


def test_small_errors_are_not_warned_of():
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        warn_of_loss_factors(loss_factor_error(Track.named("nordborg-loss-factor"), WHEEL, STIFFNESS, 5000.0))
