"""Signals over angle: lines that follow a speed, resonances that stay, and both told apart."""

from dataclasses import replace

import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy.signal import lfilter

from asperity.diagnostics import amplitude_spectrum
from asperity.diagnostics.orders import (
    RunUp,
    envelope_order_spectrum,
    order_spectrum,
    over_angle,
    resonances_apart,
    run_up,
    turns_of,
)
from refusals import refusals

RATE = 8192.0
TIME = np.arange(int(2.0 * RATE)) / RATE
SPEEDS = 10.0 + 10.0 * TIME
TURNS = 10.0 * TIME + 5.0 * TIME**2
"""10 to 30 turns per second in two seconds."""


def width(spectrum):
    """Places at half of the highest line and above."""
    return np.count_nonzero(spectrum[1] >= 0.5 * spectrum[1].max())


def test_turns_are_the_integral_of_the_speed():
    assert_allclose(turns_of(SPEEDS, RATE), TURNS, atol=1e-9)


def test_lines_of_a_run_up_are_as_narrow_over_orders_as_those_of_a_constant_speed():
    line = 2.0 * np.cos(2.0 * np.pi * 7.3 * TURNS)
    order, amplitude = order_spectrum(line, TURNS)
    assert order[amplitude.argmax()] == pytest.approx(7.3, abs=order[1])
    assert amplitude.max() == pytest.approx(2.0, rel=0.04)
    steady = amplitude_spectrum(np.cos(2.0 * np.pi * 7.3 * 20.0 * TIME), RATE)
    assert width((order, amplitude)) <= width(steady) + 1
    assert width(amplitude_spectrum(line, RATE)) > 20 * width(steady)


def test_nothing_is_folded_over_angle():
    """A sine just below half the rate, sampled four times and more where turns are slow."""
    values, per_turn = over_angle(np.sin(2.0 * np.pi * 0.3 * RATE * TIME), TURNS)
    assert per_turn >= RATE / 10.0
    at = TURNS[0] + np.arange(values.size) / per_turn
    time = (np.sqrt(100.0 + 20.0 * at) - 10.0) / 10.0
    assert np.corrcoef(values, np.sin(2.0 * np.pi * 0.3 * RATE * time))[0, 1] > 0.99


def test_the_envelope_of_a_resonance_that_is_struck_has_lines_over_orders():
    """3.58 blows in a turn ring at 2 kHz, however fast it turns."""
    blows = np.diff(np.floor(3.58 * TURNS), prepend=0.0)
    pole = np.exp((-200.0 + 2j * np.pi * 2000.0) / RATE)
    rung = lfilter([1.0], [1.0, -2.0 * pole.real, abs(pole) ** 2], blows)
    order, amplitude = envelope_order_spectrum(rung, RATE, TURNS, (1500.0, 2500.0))
    near = (order > 1.0) & (order < 20.0)
    found = order[near][np.argsort(amplitude[near])[-1]]
    assert found == pytest.approx(3.58, abs=2.0 * order[1])


def test_a_run_up_holds_the_speed_of_each_piece():
    found = run_up(np.cos(2.0 * np.pi * 20.0 * TURNS), RATE, SPEEDS, resolution=8.0)
    highest = found.frequency[found.amplitude.argmax(axis=1)]
    assert_allclose(highest, 20.0 * found.speed, atol=12.0)
    assert found.amplitude.shape == (found.speed.size, found.frequency.size)


def test_resonance_and_orders_are_told_apart():
    """A = b(f/n) a(f): a of one degree of freedom at 300 Hz, b with a line 20 dB high at 8.2 in a turn."""
    speed = np.geomspace(10.0, 40.0, 40)
    frequency = np.arange(1.0, 1500.0)
    stays = 1.0 / np.abs(1.0 - (frequency / 300.0) ** 2 + 0.1j * frequency / 300.0)
    orders = frequency / speed[:, None]
    follows = np.where(abs(np.log2(orders / 8.2)) < 0.5 / 24.0, 10.0, 1.0) / orders
    found = resonances_apart(RunUp(speed, frequency, stays * follows), lowest=40.0)
    assert found.frequency[found.stays.argmax()] == pytest.approx(300.0, rel=0.03)
    inside = (found.frequency > 60.0) & (found.frequency < 1000.0)
    expected = np.interp(found.frequency, frequency, stays)[inside]
    assert np.std(20.0 * np.log10(found.stays[inside] / expected)) < 1.5
    lines = found.follows * found.order
    near = np.abs(np.log2(found.order / 8.2)) < 0.05
    far = (found.order > 2.0) & (found.order < 60.0) & (np.abs(np.log2(found.order / 8.2)) > 0.1)
    assert 10.0 < 20.0 * np.log10(lines[near].max() / np.median(lines[far])) < 21.0
    assert np.std(20.0 * np.log10(lines[far])) < 1.5
    assert found.unexplained < 2.0


STEADY = RunUp(np.array([10.0, 10.1]), np.arange(100.0), np.ones((2, 100)))
test_what_has_no_angle_is_refused = refusals(
    (lambda: turns_of([1.0, 0.0], 10.0), "speeds (1/s): received 0.0"),
    (lambda: over_angle(np.zeros(3), [0.0, 2.0, 1.0]), "as many turns as samples, each more than the one"),
    (
        lambda: over_angle(np.zeros(3), [0.0, 1.0, 2.0]),
        "turns: received 2 of the record; allowed: 4 at least",
    ),
    (lambda: resonances_apart(STEADY, lowest=1.0), "speeds within a factor of 1.01"),
    (lambda: resonances_apart(replace(STEADY, speed=SPEEDS[::9000]), lowest=80.0), "less than 49.5"),
    (lambda: run_up(TIME, RATE, SPEEDS, resolution=0.5), "two pieces"),
)
