"""Samples that are missing where nothing marks them: told where and how much, left out of verdicts."""

import numpy as np
import pytest

from asperity.diagnostics import diagnose, diagnosis_sentence
from asperity.diagnostics.foretold import unforetold
from asperity.diagnostics.missing_samples import filled_in, runs_of
from asperity.diagnostics.phase_jumps import lost_between
from asperity.diagnostics.recording import Recording
from asperity.errors import InputError
from asperity.structures.ball_bearing import BallBearing
from faulty_signals import faulty_signal

RATE, SPEED = 12_000.0, 29.3
TURN = RATE / SPEED
TONES = BallBearing.named("6205").tones()
NOISE = np.random.default_rng(0).normal(size=36_000)
TIME = np.arange(36_000) / RATE
NONE = np.zeros((0, 2))


def tone(frequency, time=TIME):
    return np.sin(2.0 * np.pi * frequency * time + 0.3)


def without(signal, kind, firsts, size):
    """A signal with stretches of so many samples that were not measured."""
    signal = signal.copy()
    if kind == "lost":
        return np.delete(signal, np.concatenate([np.arange(first, first + size) for first in firsts]))
    for first in firsts:
        ends = {"zeros": (0.0, 0.0), "held": (signal[first - 1],) * 2, "NaN": (np.nan,) * 2}
        low, high = ends.get(kind, (signal[first - 1], signal[first + size]))
        signal[first : first + size] = np.linspace(low, high, size + 2)[1:-1]
    return signal


KINDS = ("zeros", "held", "line", "NaN", "lost")
PLACES = {"one": [7_013], "five": [1_201, 4_750, 8_503, 10_750, 15_007], "even": range(500, 34_000, 1_024)}


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("size", [1, 50, 300])
@pytest.mark.parametrize("places", PLACES)
@pytest.mark.parametrize("frequency", [29.3, 1_000.5])
@pytest.mark.filterwarnings("error")
def test_a_tone_with_missing_samples_has_no_part_that_is_struck(kind, size, places, frequency):
    """They were blows of no part, or a ring, 97 % sure, in up to half of these records."""
    ends = PLACES[places][-1] + 5_000
    for noise in (0.0, 1e-4):
        signal = (tone(frequency) + noise * NOISE)[:ends]
        found = diagnose(without(signal, kind, PLACES[places], size), RATE, TONES, SPEED)
        assert (found.parts, found.blows) == ((), 0.0)
        assert noise or found.tones_alone[0] == pytest.approx(frequency, abs=12.0)


def test_what_was_filled_in_is_told_with_where_and_how_much():
    outer = faulty_signal("outer", SPEED, RATE, 3.0, noise=0.3)
    one = Recording.of(without(outer, "line", [12_000], 120), RATE, 1.0 / SPEED)
    assert one.doubts == (
        "The signal is held or on a smooth line for 0.01 s from 1 s on, as where samples were lost: that is "
        "left out.",
        "Samples are missing or left out, first at 1 s: read in 2 stretches without a gap (1, 1.99 s).",
    )
    found = diagnose(without(outer, "zeros", PLACES["five"], 60), RATE, TONES, SPEED)
    assert [each.part for each in found.parts] == ["outer"]
    assert "smooth line 5 times, for 0.005 s at most, first from 0.1 s on, as where" in diagnosis_sentence(
        found
    )


@pytest.mark.parametrize("size", [12, 60, 300])
@pytest.mark.parametrize("kind", ["zeros", "held", "line", "cubic"])
@pytest.mark.parametrize("steps", [None, 30_000, 1_000])
def test_stretches_that_were_filled_in_are_found_to_a_few_samples(kind, size, steps):
    signal = NOISE + 3.0 * tone(SPEED)
    if kind == "cubic":
        x = np.linspace(-1.0, 1.0, size)
        signal[5_000 : 5_000 + size] = 0.3 + x - 2.0 * x**2 + x**3
    else:
        signal = without(signal, kind, [5_000], size)
    if steps:
        signal = np.round(signal / np.abs(signal).max() * steps)
    (found,) = filled_in(signal)
    assert found == pytest.approx([5_000, 5_000 + size], abs=3)


WHOLE = {
    "noise": NOISE,
    "noise of few steps": np.round(2.0 * NOISE),
    "a slow tone of few steps": np.round(20.0 * tone(3.0)),
    "a tone": tone(50.0),
    "a tone of four bytes": tone(50.0).astype(np.float32).astype(float),
    "clipped": np.clip(NOISE, -0.5, 0.5),
    "a clipped tone": np.clip(tone(107.0) + 0.01 * NOISE, -0.4, 0.6),
    "blows in silence": np.round(faulty_signal("outer", 3.0, RATE, 3.0, noise=0.0, shaft=0.0) * 200.0),
    "blows that die out": faulty_signal("outer", SPEED, RATE, 3.0, noise=0.0, shaft=0.0),
    "two tones that beat": tone(50.0) + tone(53.0),
    "a loud shaft with blows": 9.0 * tone(SPEED) + faulty_signal("outer", SPEED, RATE, 3.0, noise=0.05),
    "a shaft that varies by 2 %": tone(SPEED, TIME + 0.003 * np.sin(2.0 * np.pi * 0.9 * TIME)) + 0.02 * NOISE,
    "a tone that comes and goes": tone(50.0) * (1.0 + 0.9 * np.sin(2.0 * np.pi * 2.0 * TIME)),
}


@pytest.mark.parametrize("kind", WHOLE)
@pytest.mark.filterwarnings("error")
def test_of_a_record_that_is_whole_nothing_is_left_out(kind):
    recording = Recording.of(WHOLE[kind], RATE, 1.0 / SPEED if kind != "blows in silence" else 1.0 / 3.0)
    assert len(recording.stretches) == 1
    assert recording.stretches[0].size == WHOLE[kind].size


@pytest.mark.parametrize("noise", [1e-3, 0.1, 0.3])
@pytest.mark.parametrize("size", [100, 250, 1_500])
def test_where_samples_were_left_out_the_phase_of_a_loud_tone_jumps(noise, size):
    """By 2 π 29.3 Hz times what is missing: 1.5, 3.8 and 23.0 rad, of which 22.0 are 3.5 turns."""
    signal = without(tone(SPEED) + noise * NOISE, "lost", [12_000], size)
    (found,) = lost_between(signal, TURN)
    assert found.mean() == pytest.approx(12_000, abs=0.25 * TURN)
    recording = Recording.of(signal, RATE, 1.0 / SPEED)
    assert len(recording.stretches) == 2
    assert recording.doubts[0].startswith(
        "The phase of the loudest tone jumps at 1 s: samples are missing there, "
    )


def test_a_click_moves_no_phase_for_long_and_whole_periods_that_are_lost_are_not_seen():
    signal = tone(50.0) + 0.1 * NOISE
    assert lost_between(without(signal, "lost", [12_000], 480), TURN).tolist() == NONE.tolist()
    signal[12_000:12_020] += 20.0
    assert lost_between(signal, TURN).tolist() == NONE.tolist()


def test_what_tones_do_not_foretell_is_left_out_where_it_is_too_seldom_for_blows():
    signal = tone(SPEED) + 0.4 * tone(1_000.5) + 1e-4 * NOISE
    signal[[3_000, 20_000]] += 0.2
    found = unforetold(signal, 2.0)
    assert (
        found.tolist() == [[3_000, 3_012], [20_000, 20_012]]
        or np.abs(found - [[2_989, 3_012], [19_989, 20_012]]).max() <= 12
    )
    assert unforetold(signal, 1.0).tolist() == NONE.tolist()
    said = diagnosis_sentence(diagnose(signal, RATE, TONES, SPEED))
    assert "In 2 places, first at 0.25 s, the signal is not what its tones foretell, as where samples" in said
    assert unforetold(NOISE, 100.0).tolist() == NONE.tolist()
    often = tone(SPEED) + 1e-4 * NOISE
    often[200::100] += 0.5
    assert unforetold(often, often.size / TURN).tolist() == NONE.tolist()


@pytest.mark.parametrize("samples", [21_000, 24_000, 30_000])
@pytest.mark.parametrize(("size", "noise"), [(1, 1e-4), (2, 3e-4)])
def test_samples_that_are_held_again_and_again_are_no_blows(samples, size, noise):
    """They are 9 to 18 times the rms of the noise, by which nothing was left out and a ball was struck."""
    signal = (tone(SPEED) + noise * NOISE)[:samples]
    signal = without(signal, "held", range(500, samples - 2_000, 1_024), size)
    found = diagnose(signal, RATE, TONES, SPEED)
    assert (found.parts, found.blows) == ((), 0.0)
    assert "the signal is not what its tones foretell" in diagnosis_sentence(found)


def test_few_of_many_blows_that_stand_out_are_not_left_out():
    """A single one of 270 is 4 times as large as what noise often reaches, and 34 are 2.7 times as large."""
    signal = faulty_signal("ball", SPEED, RATE, 2.0, noise=0.1) + 20.0 * tone(SPEED)[:24_000]
    assert unforetold(signal, signal.size / TURN).tolist() == NONE.tolist()


def test_a_record_of_gaps_that_leave_too_little_is_refused_with_what_is_left():
    signal = without(NOISE, "held", range(300, 35_900, 400), 100)
    with pytest.raises(
        InputError, match=r"duration of the signal: received 0\.0249 s without a gap; allowed: at "
    ):
        diagnose(signal, RATE, TONES, SPEED)


@pytest.mark.parametrize("size", [1, 2, 7, 1000])
@pytest.mark.parametrize("least", [1, 2, 5, 40])
@pytest.mark.parametrize("share", [0.0, 0.3, 0.9, 1.0])
def test_runs_of_pieces_are_those_of_the_whole(size, least, share):
    held = np.random.default_rng(8).random(400) < share
    first = np.flatnonzero(held & ~np.append(False, held[:-1]))
    last = np.flatnonzero(held & ~np.append(held[1:], False)) + 1
    long = last - first >= least
    found = runs_of((held[at : at + size] for at in range(0, held.size, size)), least)
    np.testing.assert_array_equal(found, np.column_stack([first[long], last[long]]))
