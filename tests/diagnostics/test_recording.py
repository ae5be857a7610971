"""Recordings that are clipped, have gaps, stand still or are shifted; and several of one bearing."""

import tracemalloc
from pathlib import Path

import numpy as np
import pytest
from scipy.fft import next_fast_len

from asperity.diagnostics import diagnose, diagnose_together, diagnosis_sentence
from asperity.diagnostics.prominence import Prominence
from asperity.diagnostics.recording import Recording, SignalPieces, _median, _reached
from asperity.errors import InputError
from asperity.structures.ball_bearing import BallBearing
from asperity.studies.recorded import read_signal
from faulty_signals import faulty_signal

RATE, SPEED = 12_000.0, 29.3
TONES = BallBearing.named("6205").tones()
NOISE = np.random.default_rng(0).normal(size=24_000)
OUTER = faulty_signal("outer", SPEED, RATE, 2.0, noise=0.3)


def doubts(signal, still=np.inf):
    return " ".join(Recording.of(signal, RATE, still).doubts)


# --- clipped


@pytest.mark.parametrize("height", [1.0, 2.0, 3.0])
@pytest.mark.parametrize("levels", [None, 127, 30_000])
@pytest.mark.parametrize("sides", [1, 2])
def test_a_flat_ceiling_is_told_with_the_share_of_samples_that_lie_there(height, levels, sides):
    low = -height if sides == 2 else NOISE.min()
    clipped = np.clip(NOISE, low, height) / height
    if levels:
        clipped = np.round(clipped * levels) / levels
    recording = Recording.of(0.5 + 7.0 * clipped, RATE)
    share = np.mean((np.abs(NOISE) if sides == 2 else NOISE) >= height)
    assert recording.clipped == pytest.approx(share, rel=0.25 if levels == 127 else 0.05)
    (told,) = recording.doubts
    assert told.startswith("The signal is clipped at " + ("-6.5 and 7.5, " if sides == 2 else "7.5, "))


@pytest.mark.parametrize("levels", [8, 127, 30_000, None])
@pytest.mark.parametrize("kind", ["noise", "sine in noise", "blows"])
def test_what_thins_out_towards_its_ends_is_not_clipped_however_coarse_its_steps(levels, kind):
    sine = np.sin(0.01234 * np.arange(NOISE.size))
    signal = {"noise": NOISE, "sine in noise": sine + 0.1 * NOISE, "blows": OUTER}[kind]
    signal = signal / np.abs(signal).max()
    assert doubts(signal if levels is None else np.round(signal * levels)) == ""


def test_a_clipped_record_is_judged_and_its_verdict_says_that_it_is_clipped():
    found = diagnose(np.clip(OUTER, -0.6, 0.6), RATE, TONES, SPEED)
    assert [each.part for each in found.parts] == ["outer"]
    said = diagnosis_sentence(found)
    assert "The signal is clipped at -0.6 and 0.6, where " in said
    assert said.endswith("of its samples lie: blows are higher.")


# --- gaps, a channel that is stuck, an offset


def test_few_missing_samples_are_bridged_and_gaps_part_a_record_into_stretches():
    signal = OUTER.copy()
    signal[[500, 5_000, 5_001]] = np.nan
    signal[9_000:9_400] = np.nan
    recording = Recording.of(signal, RATE)
    assert [each.size for each in recording.stretches] == [9_000, 14_600]
    assert " ".join(recording.doubts) == (
        "3 missing samples, up to 3 in a row, are replaced by straight lines. Samples are missing or left "
        "out, first at 0.75 s: read in 2 stretches without a gap (0.75, 1.22 s)."
    )
    found = diagnose(signal, RATE, TONES, SPEED)
    assert [each.part for each in found.parts] == ["outer"]
    assert found.resolution == pytest.approx(1.0 / 0.75)
    with pytest.raises(InputError, match="60 samples without a gap at most; allowed: at least 64"):
        Recording.of(np.where(np.arange(6_100) % 65 < 60, OUTER[:6_100], np.nan), RATE)
    with pytest.raises(InputError, match="signal: received no number, NaN throughout"):
        Recording.of(np.full(100, np.nan), RATE)
    with pytest.raises(InputError, match="signal: received inf"):
        Recording.of(np.where(np.arange(100) == 7, np.inf, 0.0), RATE)


@pytest.mark.parametrize("held", [0.0, 0.123])
def test_what_stands_still_for_a_turn_is_left_out(held):
    signal = OUTER.copy()
    signal[16_000:20_000] = held
    recording = Recording.of(signal, RATE, still=1.0 / SPEED)
    assert [each.size for each in recording.stretches] == [16_000, 4_000]
    assert recording.doubts[0] == (
        f"The signal stands still at {held:.4g} for 0.333 s, from 1.33 s on, as of a channel that is stuck: "
        "that is left out."
    )
    assert [each.part for each in diagnose(signal, RATE, TONES, SPEED).parts] == ["outer"]
    with pytest.raises(
        InputError, match=r"the same number throughout; allowed: .* Is the sensor connected\?"
    ):
        Recording.of(np.full(1_000, 0.7), RATE, 1.0 / SPEED)


def test_silence_between_blows_that_come_every_turn_is_no_stuck_channel():
    """Coarse steps: between blows nothing is left of the noise."""
    coarse = np.round(faulty_signal("outer", 3.0, RATE, 2.0, noise=0.01, shaft=0.0) * 10)
    assert np.mean(np.diff(coarse) == 0.0) > 0.5
    assert doubts(coarse, still=1.0 / 3.0) == ""


def test_an_offset_is_told_and_changes_nothing():
    shifted = 40.0 + OUTER
    assert doubts(shifted).startswith("Its mean of 40, ")
    assert diagnose(shifted, RATE, TONES, SPEED).parts[0].tone == pytest.approx(
        diagnose(OUTER, RATE, TONES, SPEED).parts[0].tone
    )


@pytest.mark.parametrize("begins", ["later", "anew"])
def test_a_gap_in_the_times_parts_a_record(tmp_path, begins):
    time = np.arange(4_000) / RATE
    kept = np.delete(np.arange(4_000), np.arange(1_500, 1_700))
    times = time[kept] if begins == "later" else np.concatenate([time[:1_500], time[: kept.size - 1_500]])
    file = Path(tmp_path, "run.csv")
    rows = [f"{t:.7f},{a:.6f}" for t, a in zip(times, NOISE[kept], strict=True)]
    file.write_text("\n".join(["time (s),a", *rows]))
    values, rate = read_signal(file)
    assert rate == pytest.approx(RATE, rel=1e-5)
    assert np.isnan(values[1_500:1_700]).sum() == (200 if begins == "later" else 1)
    np.testing.assert_allclose(values[np.isfinite(values)], NOISE[kept], atol=1e-6)


def test_an_empty_cell_is_a_missing_sample(tmp_path):
    file = Path(tmp_path, "run.csv")
    rows = [f"{'' if n == 5 else n % 7},{n / 100:g}" for n in range(100)]
    file.write_text("\n".join(["a,time (s)", *rows]))
    values, _ = read_signal(file)
    assert np.flatnonzero(np.isnan(values)).tolist() == [5]


# --- several


def test_pieces_are_as_long_as_the_shortest_that_is_half_of_the_longest():
    stretches = [np.arange(float(n)) for n in (1_000, 640, 499, 2_000 // 2)]
    assert [each.size for each in SignalPieces.of(stretches, 1e9)] == [640, 640, 640]
    assert [each.size for each in SignalPieces.of(stretches, 320.0)] == [320] * 9
    assert [each.size for each in SignalPieces.of(stretches[:1], 1_000.0)] == [1_000]


def test_what_recurs_seldom_is_limited_to_what_recurs_once_in_two_turns():
    """Twenty turns: ten samples of 5 are reached, one of 100 is a click."""
    values = np.sign(np.random.default_rng(0).normal(size=1_000))
    values[50::100] = 5.0
    values[3] = 100.0
    values -= values.mean()
    (piece,) = SignalPieces.of([values], 1e9, rate=1_000.0, speed=20.0)
    tenth = np.sort(np.abs(values))[-10]
    assert tenth > 4.0
    np.testing.assert_allclose(piece, np.clip(values, -tenth, tenth), atol=1e-12)


def test_pieces_of_loud_tones_are_faded_at_their_ends_and_others_are_not():
    time = np.arange(12_000) / 12_000.0
    tone = np.sin(2.0 * np.pi * 29.3 * time + 1.0)
    noise = np.random.default_rng(0).normal(size=time.size)
    (loud,) = SignalPieces.of([tone + 0.01 * noise], 1e9, rate=12_000.0, speed=29.3)
    assert np.abs(loud[[0, -1]]).max() < 1e-6
    np.testing.assert_allclose(loud[3_000:9_000], (tone + 0.01 * noise)[3_000:9_000], atol=0.01)
    (plain,) = SignalPieces.of([tone + noise], 1e9, rate=12_000.0, speed=29.3)
    assert np.abs(plain[:3_000]).std() > 0.5


@pytest.mark.parametrize("size", [262_147, 999_983, 1_048_576])
def test_long_pieces_have_lengths_that_are_quick_to_transform(size):
    """262 147 and 999 983 are primes, which take three times as long; short pieces stay whole."""
    (piece,) = SignalPieces.of([np.zeros(size)], 1e9)
    assert 0.997 * size <= piece.size <= size
    assert piece.size == next_fast_len(piece.size)
    (whole,) = SignalPieces.of([np.zeros(99_991)], 1e9)
    assert whole.size == 99_991


@pytest.mark.parametrize(("part", "noise"), [("outer", 0.45), ("inner", 0.2), ("ball", 0.3)])
def test_records_of_which_none_names_the_part_name_it_together(part, noise):
    """Six turns each in noise: the mean of their spectra has the lines."""
    several = [faulty_signal(part, SPEED, RATE, 0.2, noise=noise, slip=0.002, seed=n) for n in range(8)]
    assert not any(diagnose(one, RATE, TONES, SPEED).parts for one in several)
    together = diagnose_together(several, RATE, TONES, SPEED)
    assert [each.part for each in together.parts] == [part]
    assert together.record.pieces == 8
    sound = [faulty_signal(None, SPEED, RATE, 0.2, noise=noise, seed=n) for n in range(8)]
    assert diagnose_together(sound, RATE, TONES, SPEED).parts == ()


def test_noise_has_lines_in_the_mean_of_many_spectra_no_more_often_than_in_one():
    """Of one spectrum, noise is above four medians in one of 2^16 places; of a mean far less is as rare."""
    spectra = np.sqrt(-np.log(np.random.default_rng(3).uniform(size=(8, 40_000))))
    for several in (spectra[:1], spectra):
        mean = np.sqrt((several**2).mean(axis=0))
        found = Prominence.of((np.arange(40_000.0), mean), means=len(several))
        rarest = np.sort(found.log_ratio)[::-1]
        assert np.log(3.3) < rarest[0] < np.log(5.0)
        # the highest of five places is above two medians with the chance 1 − (1 − 1/16)⁵
        assert np.mean(found.log_ratio >= np.log(2.0)) == pytest.approx(1 - (15 / 16) ** 5, rel=0.1)


def test_a_loud_record_counts_no_more_than_others_and_one_alone_is_as_before():
    several = [OUTER[:12_000], OUTER[12_000:]]
    louder = [1e3 * several[0], several[1]]
    found = [diagnose_together(each, RATE, TONES, SPEED) for each in (several, louder)]
    assert found[0].parts[0].depth == pytest.approx(found[1].parts[0].depth, rel=1e-6)
    one, same = diagnose(OUTER, RATE, TONES, SPEED), diagnose_together([OUTER], RATE, TONES, SPEED)
    assert (one.parts, one.confidence) == (same.parts, same.confidence)


def test_progress_of_a_long_record_is_told_piece_by_piece():
    seen = []
    signal = faulty_signal("outer", 290.0, RATE, 6.0, noise=0.3)
    diagnose(signal, RATE, TONES, 290.0, progress=lambda *told: seen.append(told))
    assert seen[0] == (0, 4, "kurtogram")
    assert {message: done for done, _, message in seen} == dict.fromkeys(
        ("kurtogram", "spectrum", "envelope of the whitened signal", "envelope of the band"), 4
    )


def test_a_recording_is_looked_at_beside_no_copy_of_itself(monkeypatch):
    """A mask and blocks beside the samples, and one piece at a time: a text of single digits holds four times
    its bytes in numbers already."""
    monkeypatch.setattr("asperity.ranks.TOGETHER", 2**13)
    for module in ("missing_samples", "foretold"):
        monkeypatch.setattr(f"asperity.diagnostics.{module}.BLOCK", 2**13)
    monkeypatch.setattr("asperity.spectra.LONGEST_KEPT", 2**13)
    signal = np.random.default_rng(0).integers(0, 10, 2**20).astype(float)
    Recording.of(signal[:1_000], RATE)  # imports
    tracemalloc.start()
    try:
        recording = Recording.of(signal, RATE, still=1.0 / SPEED)
        for piece in SignalPieces.of(recording.stretches, 20_000.0, RATE, SPEED):
            assert abs(piece.mean()) < 0.2
        assert tracemalloc.get_traced_memory()[1] < 0.35 * signal.nbytes
    finally:
        tracemalloc.stop()
    assert recording.clipped == 0.0  # as many at the ends as beside them


def test_what_is_taken_in_blocks_is_what_all_at_once_is():
    """Medians of even and odd numbers of samples, of ties and of two lumps; sizes that are reached."""
    draw = np.random.default_rng(1)
    lumps = np.concatenate([np.full(40_000, -1.0), np.full(40_000, 3.0)])
    for values in (draw.normal(size=70_001), draw.normal(size=150_000) ** 3, np.sort(lumps), lumps[::-1]):
        assert _median(values) == np.median(values)
        for times in (1, 3, 70_000):
            assert _reached(values, 0.25, times) == np.sort(np.abs(values - 0.25))[-times]


@pytest.mark.parametrize("level", [1_797.0, -1_797.0])
def test_what_moves_by_rounding_alone_stands_still(level):
    """As a column with a speed that is read over angle; a sensor's noise is larger, whatever its offset."""
    noise = np.random.default_rng(5).normal(size=2_000)
    with pytest.raises(InputError, match="signal: received the same number throughout"):
        Recording.of(level * (1.0 + 1e-15 * noise), RATE)
    assert "is taken off" in " ".join(Recording.of(level * (1.0 + 1e-9 * noise), RATE).doubts)
