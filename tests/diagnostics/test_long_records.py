"""Long records, as of shafts that turn slowly: read in pieces and blocks, of bounded memory."""

import ctypes
import os
import sys
import tracemalloc
from pathlib import Path

import numpy as np
import pytest

from asperity.diagnostics import diagnose
from asperity.diagnostics.envelopes import above_frequency, amplitude_spectrum, band_envelope, prewhitened
from asperity.diagnostics.kurtogram import kurtogram
from asperity.structures.ball_bearing import BallBearing
from faulty_signals import faulty_signal, orders

RATE = 12_000.0
B6205 = BallBearing.named("6205")
SLOW = 3.0  # turns per second


def test_a_long_record_whose_blows_slip_is_read_in_pieces():
    """Two thousand turns: lines of blows that come by their own clock are wider than it resolves, and no part
    is named."""
    signal = faulty_signal("inner", 50.0, RATE, 40.0, noise=0.2)
    diagnosis = diagnose(signal, RATE, B6205.tones(), 50.0)
    assert [each.part for each in diagnosis.parts] == ["inner"]
    assert diagnosis.resolution == pytest.approx(0.1)


def slow_record(monkeypatch, turns, together, signal, speed=SLOW):
    """Verdict on a record of a slow shaft, in pieces of so many turns, and so many samples together."""
    monkeypatch.setattr("asperity.diagnostics.decision.ENOUGH", turns)
    monkeypatch.setattr("asperity.ranks.TOGETHER", together)
    for module in ("decision", "recording"):
        monkeypatch.setattr(f"asperity.diagnostics.{module}.MOST_SAMPLES", together)
    return diagnose(signal, RATE, B6205.tones(), speed)


def test_of_a_slow_shaft_no_more_is_held_than_the_turns_that_are_enough_and_the_lines_that_are_sought(
    monkeypatch,
):
    """Pieces are of 20 turns here; spectra end above the lines."""
    signal = faulty_signal("outer", SLOW, RATE, 13.3, noise=0.05)
    whole = diagnose(signal, RATE, B6205.tones(), SLOW)
    assert whole.record.pieces == 1
    sought = 25.0 * orders("6205")["inner"] * SLOW
    ends = [each.amplitude.size * each.step for each in (whole.record.spectrum, whole.record.white)]
    assert all(sought < end < 0.45 * RATE for end in ends)
    in_pieces = slow_record(monkeypatch, 20.0, 2**14, signal)
    assert in_pieces.record.pieces == 2
    assert in_pieces.turns == pytest.approx(20.0, rel=0.01)
    for each in (whole, in_pieces):
        assert [part.part for part in each.parts] == ["outer"]
    assert slow_record(monkeypatch, 20.0, signal.size, signal).record.pieces == 1


@pytest.mark.parametrize("part", ["outer", "inner", "ball"])
def test_lines_of_a_slow_shaft_are_the_same_in_blocks_as_in_the_whole_record(monkeypatch, part):
    """Each block of 1.4 s holds four turns: lines of the shaft, and of blows in the envelope of the band."""
    signal = faulty_signal(part, SLOW, RATE, 13.3, noise=0.05)
    whole = diagnose(signal, RATE, B6205.tones(), SLOW)
    blocks = slow_record(monkeypatch, 100.0, 2**14, signal)
    assert blocks.record.white.amplitude.size < whole.record.white.amplitude.size
    assert blocks.record.limits == whole.record.limits
    for found in (whole, blocks):
        assert [each.part for each in found.parts] == [part]
        assert found.speed_is == "confirmed"
        assert found.confidence > 0.9
        assert found.record.pieces == 1
    for name, line in (("spectrum", SLOW), ("band", whole.parts[0].tone)):
        views = [getattr(each.record, name) for each in (whole, blocks)]
        heights = [each.lines_of(line)[1] / each.level for each in views]
        np.testing.assert_allclose(*heights, rtol=0.01)


def test_what_is_loud_for_longer_than_a_block_stays_loud_where_all_lines_are_made_equal(monkeypatch):
    """Noise that swells once in 5.3 s, in blocks of 1.4 s: its envelope has that line in both."""
    time = np.arange(round(16.0 * RATE)) / RATE
    swelling = 1.0 + 0.9 * np.cos(2 * np.pi * time / (16.0 / 3.0))
    signal = swelling * np.random.default_rng(2).normal(size=time.size)
    whole = diagnose(signal, RATE, B6205.tones(), SLOW)
    blocks = slow_record(monkeypatch, 100.0, 2**14, signal)
    for found in (whole, blocks):
        view = found.record.white
        assert view.amplitude[round(3.0 / 16.0 / view.step)] > 0.6 * view.level


def test_the_memory_that_a_record_takes_is_no_matter_of_how_slowly_its_shaft_turns(monkeypatch):
    """At a tenth of a speed ten turns are ten times the samples; the record itself is given."""
    signal = faulty_signal("outer", SLOW, RATE, 30.0, noise=0.05)
    peaks = []
    for speed in (3.0, 0.7, 0.3):
        tracemalloc.start()
        slow_record(monkeypatch, 10.0, 2**14, signal, speed)
        peaks.append(tracemalloc.get_traced_memory()[1] / signal.nbytes)
        tracemalloc.stop()
    assert max(peaks) < 1.5, peaks


def resident():
    """Memory that this process holds and uses, bytes."""
    ctypes.CDLL(None).malloc_trim(0)
    return int(Path("/proc/self/statm").read_text().split()[1]) * os.sysconf("SC_PAGE_SIZE")


@pytest.mark.skipif(sys.platform != "linux", reason="elsewhere free memory is not given back when asked")
def test_transforms_of_a_long_record_leave_no_tables_behind():
    """Tables for their lengths took seven times the samples, beyond what tracemalloc sees."""
    signal = np.random.default_rng(1).normal(size=2**18)
    amplitude_spectrum(signal[:1_000], RATE)  # imports
    before = resident()
    kurtogram(above_frequency(signal, RATE, 500.0), RATE)
    for values in (signal, band_envelope(prewhitened(signal, RATE), RATE, 1_000.0, 3_000.0)):
        amplitude_spectrum(values, RATE)
    assert resident() - before < 3 * signal.nbytes
