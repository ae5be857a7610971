"""Samples in types of few bytes, as files have them: all that is said of them is said of the same numbers."""

import tracemalloc

import numpy as np
import pytest
from scipy.io import wavfile

from asperity.diagnostics import diagnose
from asperity.diagnostics.envelopes import mean_spectrum
from asperity.diagnostics.prominence import STANDS_OUT, Prominence
from asperity.diagnostics.recording import Recording
from asperity.ranks import Ranked
from asperity.structures.ball_bearing import BallBearing
from asperity.studies.recorded import read_record, read_signal
from faulty_signals import faulty_signal

RATE, SPEED = 12_000.0, 29.3
TONES = BallBearing.named("6205").tones()
OUTER = faulty_signal("outer", SPEED, RATE, 2.0, noise=0.3)
WHOLE = np.round(OUTER / np.abs(OUTER).max() * 127.0)
SINE = np.round(120.0 * np.sin(2.0 * np.pi * 410.3 / RATE * np.arange(OUTER.size)))
TYPES = ("i1", "i2", "i4", "f2", "f4", ">i2", ">f4")


def stuck():
    signal = WHOLE.copy()
    signal[16_000:20_000] = 12.0
    return signal


def on_a_line():
    signal = WHOLE.copy()
    signal[9_000:9_064] = np.arange(-32, 32)
    return signal


def knocked():
    signal = np.round(16_000.0 * SINE / 120.0)
    signal[11_000:11_040] += 9_000.0
    return signal


RECORDS = {
    "blows": WHOLE,
    "ends of the type": np.where(np.arange(WHOLE.size) % 500 == 0, -128.0, WHOLE),
    "clipped": np.clip(WHOLE, -40.0, 40.0),
    "stuck": stuck(),
    "on a line": on_a_line(),
    "offset": np.clip(0.2 * WHOLE + 100.0, -128.0, 127.0).round(),
    "tones": SINE,
    "samples lost": np.delete(SINE, np.arange(9_000, 9_013)),
    "knocked": knocked(),
}


HELD = [
    (small, kind)
    for small in TYPES
    for kind, signal in RECORDS.items()
    if np.abs(signal).max() < 2_048 or small not in ("i1", "f2")
]


@pytest.mark.parametrize(("small", "kind"), HELD)
def test_a_record_is_what_its_numbers_are_in_any_type(small, kind):
    signal = RECORDS[kind]
    kept = signal.astype(small)
    expected = Recording.of(signal, RATE, 1.0 / SPEED)
    found = Recording.of(kept, RATE, 1.0 / SPEED)
    assert found.doubts == expected.doubts
    assert found.clipped == expected.clipped
    assert found.tones_alone == expected.tones_alone
    assert all(each.dtype == kept.dtype for each in found.stretches)
    for one, other in zip(found.stretches, expected.stretches, strict=True):
        np.testing.assert_array_equal(one, other)
    np.testing.assert_array_equal(Ranked([kept]).between(0, 99), Ranked([signal]).between(0, 99))


@pytest.mark.parametrize("small", ["i1", "i2", "f4", ">i2"])
def test_the_verdict_on_small_samples_is_that_on_their_numbers(small):
    expected, found = (diagnose(each, RATE, TONES, SPEED) for each in (WHOLE, WHOLE.astype(small)))
    (best,), (other,) = expected.parts, found.parts
    assert other.part == best.part == "outer"
    assert [other.tone, other.support] == pytest.approx([best.tone, best.support], rel=1e-9)
    assert found.confidence == pytest.approx(expected.confidence, rel=1e-9)
    np.testing.assert_allclose(found.record.band.amplitude, expected.record.band.amplitude, rtol=1e-9)


def test_few_missing_samples_of_small_floats_are_bridged_by_lines_that_are_not_rounded():
    signal = WHOLE.astype("f4")
    signal[500] = np.nan
    (stretch,) = Recording.of(signal, RATE).stretches
    assert stretch[500] == np.mean(WHOLE[[499, 501]])
    third = np.float32([0.1, np.nan, np.nan, 0.2])
    (stretch,) = Recording.of(np.concatenate([WHOLE[:100], third, WHOLE[:100]]).astype("f4"), RATE).stretches
    ends = np.float32([0.1, 0.2]).astype(float)
    assert stretch[101] == pytest.approx(ends[0] + np.ptp(ends) / 3.0, rel=1e-12)


def test_the_clearest_comb_of_a_long_spectrum_is_sought_in_little_memory():
    """A million of fundamentals are tried of it: not all at once."""
    count = 2**17
    time = np.arange(count) / RATE
    envelope = 1.0 + 0.1 * sum(np.cos(2.0 * np.pi * 107.3 * n * time) for n in range(1, 6))
    envelope += 0.1 * np.random.default_rng(0).normal(size=count)
    record = Prominence.of_envelopes([envelope], RATE, 0.5 * RATE, 1, np.inf)
    low, high = 10.0, 2_500.0
    tracemalloc.start()
    try:
        clear, tone = record.strongest(low, high)
        peak = tracemalloc.get_traced_memory()[1]
    finally:
        tracemalloc.stop()
    assert tone == pytest.approx(107.3, rel=1e-4)
    each = np.linspace(low, high, 200_001)
    assert clear >= record.combs(each, STANDS_OUT).max() - 0.2
    assert peak < 4e6  # bytes; all at once takes five times as many


def test_a_mean_of_spectra_holds_one_of_them_beside_the_sum():
    def parts(count):
        return ((np.random.default_rng(n).normal(size=2**15), 1.0) for n in range(count))

    peaks = []
    for count in (1, 1, 4):  # the first for imports
        tracemalloc.start()
        try:
            mean_spectrum(parts(count), RATE)
            peaks.append(tracemalloc.get_traced_memory()[1])
        finally:
            tracemalloc.stop()
    assert peaks[2] - peaks[1] < 1.1 * 8 * 2**15


@pytest.mark.parametrize(
    ("words", "kept"),
    [
        ("{:.0f}", "i1"),  # to the last bit in each
        ("{:.0f}00", "i2"),
        ("{:.0f}.25", "f4"),
        ("{:.0f}.1", "f8"),
        ("{:.0f}00000", "f4"),
    ],
)
def test_numbers_of_a_text_stay_in_the_smallest_type_that_has_them(tmp_path, words, kept):
    file = tmp_path / "run.txt"
    file.write_text("\n".join(words.format(each + 0.0) for each in WHOLE) + "\n")
    found = read_record(file, RATE)
    assert found.values.dtype == np.dtype(kept)
    np.testing.assert_array_equal(found.values, [float(words.format(each + 0.0)) for each in WHOLE])
    assert read_signal(file, RATE)[0].dtype == np.float64


@pytest.mark.parametrize(
    ("kind", "kept"), [("i2", "i2"), ("u1", "u1"), ("f4", "f4"), ("i8", "f8"), ("f2", "f2")]
)
def test_an_array_stays_in_its_type_and_has_its_numbers(tmp_path, kind, kept):
    np.save(tmp_path / "run.npy", np.abs(WHOLE).astype(kind))
    found = read_record(tmp_path / "run.npy", RATE)
    assert found.values.dtype == np.dtype(kept)
    np.testing.assert_array_equal(found.values, np.abs(WHOLE))


@pytest.mark.parametrize(("kind", "full", "middle"), [("u1", 128.0, 128.0), ("i2", 32_768.0, 0.0)])
def test_shares_of_full_scale_are_exact_in_small_floats(tmp_path, kind, full, middle):
    samples = (WHOLE + middle).astype(kind)
    wavfile.write(tmp_path / "run.wav", int(RATE), samples)
    found = read_record(tmp_path / "run.wav")
    assert found.values.dtype == np.float32
    np.testing.assert_array_equal(found.values, (samples.astype(float) - middle) / full)


def test_whole_numbers_beside_times_with_a_gap_have_nan_in_it(tmp_path):
    times = np.delete(np.arange(2_000) / 1_000.0, np.arange(700, 720))
    rows = [f"{at:.3f},{n % 7}" for n, at in enumerate(times)]
    file = tmp_path / "run.csv"
    file.write_text("\n".join(["time (s),a", *rows]))
    values = read_record(file).values
    assert np.flatnonzero(np.isnan(values)).tolist() == list(range(700, 720))
    np.testing.assert_array_equal(values[~np.isnan(values)], np.arange(1_980) % 7)
