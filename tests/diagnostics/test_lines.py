"""Signals of bearings: lines of known answer, and what was measured beside a 6205 with and without faults."""

from functools import cache
from pathlib import Path

import numpy as np
import pytest

from asperity.diagnostics import (
    ISO_BANDS,
    amplitude_spectrum,
    band_deviations,
    band_velocities,
    envelope_spectrum,
    envelopes,
    explained_lines,
    find_lines,
    impulsive_band,
)  # fmt: skip
from asperity.structures.ball_bearing import BallBearing
from refusals import refusals

RATE = 12_000.0
TIME = np.arange(48_000) / RATE
B6205 = BallBearing.named("6205")
CARRIER = (1.0 + 0.6 * np.cos(2 * np.pi * 87.0 * TIME)) * np.cos(2 * np.pi * 2500.0 * TIME)
MEASURED = Path(__file__).parents[3] / "shared" / "data" / "cwru_6205_12k.npz"


def noise(seed=0):
    return np.random.default_rng(seed).normal(size=TIME.size)


def rung(times, strengths, resonance=3000.0):
    """A damped resonance that is struck."""
    pulse = np.exp(-800.0 * TIME[:200]) * np.sin(2 * np.pi * resonance * TIME[:200])
    struck = np.zeros(TIME.size)
    np.add.at(struck, np.minimum((times * RATE).astype(int), TIME.size - 1), strengths)
    return np.convolve(struck, pulse)[: TIME.size]


def test_a_sine_has_its_amplitude_wherever_it_lies():
    for tone in (100.0, 100.0625, 333.3):
        frequency, amplitude = amplitude_spectrum(2.0 * np.sin(2 * np.pi * tone * TIME), RATE)
        assert frequency[amplitude.argmax()] == pytest.approx(tone, abs=0.07)
        assert 1.9 < amplitude.max() <= 2.0001


def test_the_envelope_of_a_modulated_carrier_is_its_modulation_alone():
    low = 5.0 * np.sin(2 * np.pi * 87.0 * TIME)  # at the same frequency, but outside of the band
    frequency, amplitude = envelope_spectrum(CARRIER + low, RATE, (2000.0, 3000.0))
    assert frequency[amplitude.argmax()] == pytest.approx(87.0)
    assert amplitude.max() == pytest.approx(0.6, rel=1e-3)
    assert np.median(amplitude) < 1e-6
    assert frequency[-1] <= 1000.0


def test_velocities_of_a_sine_in_each_band():
    rate, time = 48_000.0, np.arange(96_000) / 48_000.0
    speeds = {120.0: 30e-6, 700.0: 20e-6, 5000.0: 10e-6}
    velocity = sum(np.sqrt(2.0) * v * np.sin(2 * np.pi * f * time) for f, v in speeds.items())
    rising = sum(np.sqrt(2.0) * v * 2 * np.pi * f * np.cos(2 * np.pi * f * time) for f, v in speeds.items())
    expected = list(speeds.values())
    np.testing.assert_allclose(band_velocities(velocity, rate), expected, rtol=1e-4)
    np.testing.assert_allclose(band_velocities(rising, rate, quantity="acceleration"), expected, rtol=1e-3)
    assert np.isnan(band_velocities(velocity[::4], 12_000.0)).tolist() == [False, False, True]


def test_a_record_in_which_nothing_moves_has_no_velocity_in_bands():
    still = np.full(4096, 0.3)
    np.testing.assert_array_equal(band_velocities(still, 24_000.0, quantity="acceleration"), 0.0)
    assert np.isnan(band_deviations(still, 24_000.0)).all()
    assert ISO_BANDS[0] == (50.0, 300.0)


def test_a_fault_that_turns_through_the_load_has_side_bands():
    """Blows at 150 Hz whose strength follows a turn at 30 Hz, 1 % slow; each decays with 800 1/s."""
    turns = 0.99 * 150.0
    times = np.arange(int(4 * turns)) / turns
    signal = rung(times, 1.0 + 0.8 * np.cos(2 * np.pi * 30.0 * times)) + 0.01 * noise()
    lines = find_lines(envelope_spectrum(signal, RATE, (1000.0, 5000.0)), 150.0, distance=30.0)
    assert lines.found
    assert lines.prominent.all()
    assert lines.deviation == pytest.approx(-0.01, abs=5e-4)
    falls = 1.0 / np.hypot(1.0, 2 * np.pi * (turns + 30.0 * np.array([-1.0, 0.0, 1.0])) / 800.0)
    expected = 0.4 * falls[[0, 2]] / falls[1]
    np.testing.assert_allclose(lines.side_bands[0] / lines.amplitude[0], expected, rtol=0.05)
    np.testing.assert_allclose(lines.frequency, turns * np.arange(1, 6), atol=0.3)
    assert not find_lines(envelope_spectrum(signal, RATE), 110.0).found


def test_the_band_that_rings_is_found_among_louder_tones():
    signal = rung(np.arange(80) / 20.0, np.full(80, 1.0), 4600.0) + 0.02 * noise()
    loud = signal + 0.6 * np.sin(2 * np.pi * 300.0 * TIME) + 0.3 * np.sin(2 * np.pi * 1300.0 * TIME)
    low, high = impulsive_band(loud, RATE, 200.0)
    assert low <= 4600.0 <= high
    assert low > 1300.0
    assert impulsive_band(loud, RATE, high - low + 1.0) == (0.0, 6000.0)


def test_what_one_family_explains_counts_for_no_other():
    """Lines of the outer ring alone: three times its frequency is nearly twice that of the inner one."""
    families = B6205.kinematics(30.0, contact_angle=0.0).families
    tone = families["outer"][0]
    times = np.arange(int(4 * tone)) / tone
    spectrum = envelope_spectrum(rung(times, np.ones(times.size)) + 0.02 * noise(), RATE)
    assert find_lines(spectrum, families["inner"][0]).prominent[1]
    found = explained_lines(spectrum, families)
    assert next(iter(found)) == "outer"
    assert found["outer"].found
    assert not found["inner"].prominent[:2].any()
    assert not found["inner"].found


def test_a_single_line_is_no_fault():
    spectrum = envelope_spectrum(CARRIER + 0.1 * noise(), RATE, (2000.0, 3000.0))
    assert find_lines(spectrum, 87.5, harmonics=1).found
    five = find_lines(spectrum, 87.5)
    assert five.prominent.tolist() == [1.0, 0.0, 0.0, 0.0, 0.0]
    assert not five.found


def test_noise_has_no_lines():
    for seed in range(3):
        spectrum = envelope_spectrum(noise(seed), RATE)
        assert not any(find_lines(spectrum, tone).found for tone in (40, 107, 163))


measured = pytest.mark.skipif(not MEASURED.is_file(), reason="no measured bearing in shared/data")


@cache
def lines_of(name):
    with np.load(MEASURED) as data:
        signal, nominal = data[name].astype(float), float(name.split("_")[0]) / 60.0
    turns = nominal * (1.0 + find_lines(amplitude_spectrum(signal, RATE), nominal, harmonics=3).deviation)
    families = B6205.kinematics(turns, contact_angle=0.0).families
    del families["ball"]
    return explained_lines(envelope_spectrum(signal, RATE), families)


@measured
@pytest.mark.parametrize("speed", [1797, 1730])
@pytest.mark.parametrize("size", [7, 21])
def test_measured_faults_have_their_lines_and_not_those_of_the_other_ring(speed, size):
    """And both say one contact angle, as under an axial preload: outer lines are above those of 0°."""
    gamma, angles = 7.94 / 39.04, []
    for record, faulty, sound, sign in (("OR_at_6", "outer", "inner", 1.0), ("IR", "inner", "outer", -1.0)):
        found = lines_of(f"{speed}_{record}_{size}")
        lines = found[faulty]
        assert next(iter(found)) == faulty
        assert lines.found
        assert lines.prominent.all()
        assert found[sound].amplitude[0] < 0.06 * lines.amplitude[0]
        angles.append(np.degrees(np.arccos(1.0 - sign * lines.deviation * (1.0 - sign * gamma) / gamma)))
        if faulty == "inner":  # it turns through the load zone
            assert (lines.side_bands[0] > 4.0 * lines.background[0]).all()
            assert lines.distance == pytest.approx(speed / 60.0, rel=0.01)
    assert angles == pytest.approx([9.0, 9.0], abs=1.7)


@measured
def test_measured_lines_are_as_high_as_seen_before_and_harmonics_keep_their_order():
    """Envelope of the raw records at 1797 1/min, in g; no line without a fault.

    Of the small outer pit the fifth comes before the third, of the inner one the fifth before the second.
    """
    for name, part, seen in (
        ("OR_at_6_7", "outer", 0.63), ("OR_at_6_21", "outer", 0.41), ("IR_7", "inner", 0.20),
        ("IR_21", "inner", 0.29)
    ):  # fmt: skip
        assert lines_of(f"1797_{name}")[part].amplitude[0] == pytest.approx(seen, rel=0.12)
    healthy = lines_of("1797_Normal").values()
    assert not any(lines.found for lines in healthy)
    assert max(lines.amplitude[0] for lines in healthy) < 2e-3
    outer, inner = lines_of("1797_OR_at_6_7")["outer"], lines_of("1797_IR_7")["inner"]
    assert (np.argsort(-outer.amplitude) + 1)[:3].tolist() == [1, 2, 5]
    assert (np.argsort(-inner.amplitude) + 1).tolist() == [1, 5, 2, 3, 4]


test_messages_about_signals = refusals(
    (lambda: envelope_spectrum(np.ones(100), 1e3), "the same number throughout"),
    (lambda: envelope_spectrum(np.arange(10.0), 1e3), "signal: received 10 samples"),
    (lambda: envelope_spectrum([np.nan] * 100, 1e3), "signal: received nan"),
    (lambda: envelope_spectrum(noise(), 0.0), "sampling rate"),
    (lambda: envelope_spectrum(noise(), RATE, (3e3, 8e3)), "3000 to 8000 Hz; allowed: rising, within 0"),
    (lambda: find_lines(envelope_spectrum(noise(), RATE), 7e3), "less than the spectrum reaches, 6000"),
    (lambda: find_lines(envelope_spectrum(noise(), RATE), 0.5), r"sought: received 0.5 Hz; .* 1 Hz, four"),
    (lambda: find_lines(envelope_spectrum(noise(), RATE), 50.0, slip=0.5), "slip"),
    (lambda: band_velocities(noise(), RATE, quantity="force"), "one of velocity, acceleration"),
)  # fmt: skip


def test_harmonics_tell_the_deviation_the_more_closely():
    """Bins of 1 Hz next to 100.4 Hz and its multiples: their sum over that of the orders is exact."""
    frequency, amplitude = np.arange(1000.0), np.full(1000, 1e-3)
    amplitude[[100, 201, 301, 402, 502]] = 1.0
    found = find_lines((frequency, amplitude), 100.0, slip=0.02, harmonics=5)
    assert 100.0 * (1.0 + found.deviation) == pytest.approx(100.4, rel=1e-9)


def test_how_sure_a_velocity_in_a_band_is_follows_bandwidth_and_time():
    """White acceleration: velocity as 1/f², effective bandwidth (∫S)²/∫S²; a line in all parts is sure."""
    rate, time, draws = 12_000.0, 4.0, np.random.default_rng(7)
    bands = ((300.0, 1800.0), (1800.0, 5000.0), (1800.0, 10_000.0))
    found = [band_deviations(draws.standard_normal(int(rate * time)), rate, bands) for _ in range(12)]
    assert np.isnan(found).all(axis=0).tolist() == [False, False, True]  # beyond the sampling
    low, high = np.array(bands[:2]).T
    width = (1.0 / low - 1.0 / high) ** 2 / ((low**-3.0 - high**-3.0) / 3.0)
    expected = 0.5 / np.sqrt(width * time)
    np.testing.assert_allclose(
        np.mean(found, axis=0)[:2], expected, rtol=0.25
    )  # of eight parts, twelve times
    line = np.sin(2.0 * np.pi * 500.0 * np.arange(int(rate * time)) / rate)
    assert band_deviations(line, rate, bands)[0] < 1e-6


def test_a_band_holds_the_lines_at_its_ends():
    """A line of amplitude one at an end is one in magnitude throughout; a step beyond it is none."""
    values = np.cos(2.0 * np.pi * 100.0 * np.arange(1_000) / 1_000.0)
    for low, high, held in ((50.0, 100.0, 1.0), (100.0, 150.0, 1.0), (101.0, 150.0, 0.0), (50.0, 99.0, 0.0)):
        magnitude = envelopes.band_envelope(values, 1_000.0, low, high)
        np.testing.assert_allclose(magnitude, held, atol=1e-12)
    np.testing.assert_allclose(envelopes.band_envelope(values + 0.5, 1_000.0, 0.0, 50.0), 0.5, atol=1e-12)
