"""Records that hold tones alone: no verdict of parts, and the tones are told."""

import numpy as np
import pytest

from asperity.diagnostics import diagnose, diagnosis_sentence
from asperity.diagnostics.pure_tones import beat, tones_alone
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
    eight = tones_alone(sum(sine(100.0 * n) for n in range(1, 9)), RATE)
    assert sorted(eight) == pytest.approx([100.0 * n for n in range(1, 9)], abs=0.5)
    assert tones_alone(sum(sine(100.0 * n) for n in range(1, 10)), RATE) == ()


MULTIPLES = ((1, 2, 3, 4), (30, 31, 32, 33), (100, 101, 102), (2.5, 7.3, 11.1, 40.2), (1, 2, 3, 4, 5, 6))


@pytest.mark.parametrize("multiples", MULTIPLES)
@pytest.mark.parametrize("speed", [20.0, 29.3])
@pytest.mark.parametrize("noise", [0.0, 1e-4, 0.1])
def test_the_beat_of_a_few_tones_is_no_blow(multiples, speed, noise):
    """Four sines that are a turn apart were blows that "come with the turns of the shaft, as of a rub", and
    others those of an outer ring, 97 % sure: by the tops that were taken for clicks."""
    signal = sum(sine(speed * n, 2.0, n * n) for n in multiples) + noise * NOISE[:24_000]
    found = diagnose(signal, RATE, TONES, speed)
    assert (found.parts, found.blows, found.once_in_a_turn) == ((), 0.0, False)


@pytest.mark.parametrize("part", ["outer", "inner", "ball"])
def test_a_fault_beside_loud_unbalance_is_found(part):
    """The ends of a loud tone, which do not meet, and its tops, which were cut, hid what is a twentieth of
    it: two of six made machines were named rightly."""
    unbalance = 20.0 * sine(SPEED, 2.0)
    signal = faulty_signal(part, SPEED, RATE, 2.0, noise=0.1) + unbalance
    for clicked in (0.0, 500.0):
        signal[7_000] += clicked
        found = diagnose(signal, RATE, TONES, SPEED)
        assert [each.part for each in found.parts] == [part]


def test_few_tones_make_a_band_and_blows_do_not():
    """Of measured bearings with a fault five lines have half of the band at most."""
    tones = sum(sine(SPEED * n, 2.0) for n in (100, 101, 102))
    blows = faulty_signal("outer", SPEED, RATE, 2.0, noise=0.0, shaft=0.0)
    assert beat(tones + 0.2 * NOISE[:24_000], RATE, (2000.0, 4000.0))
    assert not beat(tones + blows, RATE, (3200.0, 4000.0))
    assert not beat(blows, RATE, (2000.0, 4000.0))


def test_a_fault_beside_a_loud_tone_is_found():
    signal = faulty_signal("outer", SPEED, RATE, 2.0, noise=0.1) + 50.0 * sine(SPEED, 2.0)
    found = diagnose(signal, RATE, TONES, SPEED)
    assert found.tones_alone == ()
    assert [each.part for each in found.parts] == ["outer"]
