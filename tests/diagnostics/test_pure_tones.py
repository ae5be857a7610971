"""Records that hold tones alone: no verdict of parts, and the tones are told."""

import numpy as np
import pytest

from asperity.diagnostics import diagnose, diagnosis_sentence
from asperity.diagnostics.pure_tones import tones_alone
from asperity.structures.ball_bearing import BallBearing
from faulty_signals import faulty_signal

RATE, SPEED = 12_000.0, 29.3
TONES = BallBearing.named("6205").tones()
NOISE = np.random.default_rng(0).normal(size=48_000)


def sine(frequency, duration=1.0, phase=0.3):
    time = np.arange(int(RATE * duration)) / RATE
    return np.sin(2.0 * np.pi * frequency * time + phase)


KINDS = {
    "a sine": lambda one, two, three: one,
    "three": lambda one, two, three: one + 0.3 * two + 0.2 * three,
    "clipped": lambda one, two, three: np.clip(one, -0.8, 0.8),
    "8 bits": lambda one, two, three: np.round(100.0 * one),
    "16 bits in volts": lambda one, two, three: np.round(3e4 * one) * (10.0 / 32_768),
    "clipped and 8 bits": lambda one, two, three: np.clip(np.round(100.0 * one), -80, 80),
    "seven digits": lambda one, two, three: one.astype(np.float32).astype(float),
    "modulated, as of a gear": lambda one, two, three: one + 0.2 * two + 0.2 * three,
    "far off zero": lambda one, two, three: 40.0 + one,
}  # fmt: skip


@pytest.mark.parametrize("frequency", [29.3, 50.0, 107.66, 1_000.5])
@pytest.mark.parametrize("duration", [0.5, 2.0])
@pytest.mark.parametrize("kind", KINDS)
def test_of_tones_alone_there_is_no_verdict_of_parts(kind, duration, frequency):
    """They were "97 % sure" an outer ring, blows of no part, or a speed that is confirmed."""
    signal = KINDS[kind](*(sine(frequency * n, duration) for n in (1, 2, 3)))
    found = diagnose(signal, RATE, TONES, SPEED)
    assert (found.parts, found.blows, found.speed_is) == ((), 0.0, "unconfirmed")
    assert found.confidence <= 0.5
    assert found.tones_alone[0] == pytest.approx(frequency, abs=1.0 / duration)
    said = diagnosis_sentence(found)
    assert said.startswith("The record holds the tone")
    assert "it says nothing of rings and balls." in said


@pytest.mark.parametrize("level", [1e-5, 1e-3])
def test_noise_beside_a_tone_is_more_than_a_tone(level):
    assert tones_alone(sine(100.0) + level * NOISE[:12_000], RATE) == ()


def test_noise_that_moves_the_last_digit_is_more_than_a_tone_and_less_is_not():
    """Rounding to a step is noise of 1/sqrt(12) of it."""
    digits = 100.0 * sine(107.66, 4.0)
    assert tones_alone(np.round(digits + 1.0 * NOISE), RATE) == ()
    assert tones_alone(np.round(digits + 0.05 * NOISE), RATE) == pytest.approx([107.66], abs=0.25)


def test_blows_without_noise_are_more_than_tones():
    """Blows of one period, without jitter or slip, have lines at all of its multiples and nothing between."""
    blows = faulty_signal("outer", SPEED, RATE, 2.0, noise=0.0, shaft=0.0, jitter=0.0, slip=0.0)
    assert tones_alone(blows, RATE) == ()
    five = tones_alone(sum(sine(100.0 * n) for n in range(1, 6)), RATE)
    assert sorted(five) == pytest.approx([100.0, 200.0, 300.0, 400.0, 500.0], abs=0.5)
    assert tones_alone(sum(sine(100.0 * n) for n in range(1, 7)), RATE) == ()


def test_a_fault_beside_a_loud_tone_is_found():
    signal = faulty_signal("outer", SPEED, RATE, 2.0, noise=0.1) + 50.0 * sine(SPEED, 2.0)
    found = diagnose(signal, RATE, TONES, SPEED)
    assert found.tones_alone == ()
    assert [each.part for each in found.parts] == ["outer"]
