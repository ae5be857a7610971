"""A path to the sensor and noise: filters and transfer functions in closed form, levels, seeds."""

import numpy as np
import pytest

from asperity.sensing import through_path, with_noise
from refusals import refusals

RATE = 51_200.0
TIME = np.arange(10_240) / RATE
WEIGHTS = np.exp(-np.arange(40) / 7.0) * np.cos(0.9 * np.arange(40))


def sine(frequency):
    """It comes and goes softly: edges hold every frequency."""
    return np.sin(np.pi * TIME / TIME[-1]) ** 2 * np.sin(2 * np.pi * frequency * TIME)


def test_a_path_of_the_same_rate_is_a_filter_and_one_alone_leaves_the_signal():
    signal = np.random.default_rng(3).normal(size=TIME.size)
    np.testing.assert_allclose(through_path(signal, RATE, [1.0], RATE), signal, rtol=0.0, atol=1e-13)
    filtered = np.convolve(signal, WEIGHTS)[: signal.size]
    np.testing.assert_allclose(through_path(signal, RATE, WEIGHTS, RATE), filtered, rtol=0.0, atol=1e-12)


@pytest.mark.parametrize(("rate", "frequency"), [(12e3, 500.0), (12e3, 5e3), (44_100.0, 5e3), (96e3, 500.0)])
def test_a_sine_leaves_a_path_of_any_rate_with_its_transfer_function(rate, frequency):
    found = through_path(sine(frequency), RATE, WEIGHTS, rate)
    middle = slice(4000, 6240)
    transfer = abs(np.exp(-2j * np.pi * frequency / rate * np.arange(WEIGHTS.size)) @ WEIGHTS)
    assert found[middle].std() == pytest.approx(transfer * sine(frequency)[middle].std(), rel=2e-3)


def test_nothing_passes_above_what_the_path_knows_and_all_below():
    found = through_path(sine(1000.0) + sine(8000.0), RATE, [1.0], 12_000.0)
    np.testing.assert_allclose(found, sine(1000.0), rtol=0.0, atol=1e-5)


def test_what_leaves_the_record_at_its_end_does_not_come_back_at_its_beginning():
    burst = np.exp(-(((TIME - 0.19) / 2e-3) ** 2))
    late = np.r_[np.zeros(500), 1.0]  # 42 ms
    assert abs(through_path(burst, RATE, late, 12_000.0)).max() < 1e-6
    shifted = through_path(burst[::-1], RATE, late, 12_000.0)
    assert TIME[shifted.argmax()] == pytest.approx(TIME[-1] - 0.19 + 500 / 12_000, abs=1 / RATE)


def test_noise_has_its_level_is_white_and_differs_by_seed():
    signal = 3.0 + np.sin(2 * np.pi * 700.0 * TIME)
    for given, rms in (({"below": 20.0}, 0.1 * np.sqrt(0.5)), ({"rms": 0.3}, 0.3)):
        noise = [with_noise(signal, seed, **given) - signal for seed in (1, 2, 1)]
        for each in noise:
            assert each.std() == pytest.approx(rms, rel=4.0 / np.sqrt(2 * TIME.size))
            assert abs(each[1:] @ each[:-1]) < 4.0 * rms**2 * np.sqrt(TIME.size)
        np.testing.assert_array_equal(noise[0], noise[2])
        assert abs(noise[0] @ noise[1]) < 4.0 * rms**2 * np.sqrt(TIME.size)


def path(response=(1.0,), rate=RATE, signal=TIME):
    return lambda: through_path(signal, RATE, response, rate)


test_wrong_paths_and_levels = refusals(
    (path([]), "impulse response: received 0 s; allowed: above 0, and at most 0.2 s"),
    (path(np.ones(9), 40.0), "impulse response: received 0.225 s"),
    (path(rate=1.0), "received 51200 and 1 Hz; allowed: up to 10000 times apart"),
    (path(rate=0.0), r"sampling rate of the path \(Hz\): received 0.0"),
    (path([1.0, np.nan]), "impulse response: received nan"),
    (lambda: with_noise(TIME, 1, below=1.0, rms=1.0), "noise: received both or none"),
    (lambda: with_noise(TIME, 1), "allowed: one of below and rms"),
)
