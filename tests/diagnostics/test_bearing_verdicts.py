"""What is said of a bearing's record: which part, at which speed, how sure; on made signals and on measured
ones."""

import re
from dataclasses import replace
from functools import cache
from types import SimpleNamespace

import numpy as np
import pytest

from asperity.diagnostics import (
    Hypothesis,
    Tacho,
    Tone,
    diagnose,
    diagnosis_sentence,
    impulsive_band,
    kurtogram,
    prewhitened,
)
from asperity.diagnostics.confidence import COEFFICIENTS, Basis, own_share
from asperity.diagnostics.decision import SUPPORTED, _agrees, _beside_shaft
from asperity.diagnostics.diagnosis import NOT_FOUND, Diagnosis
from asperity.diagnostics.hypotheses import chance_of
from asperity.diagnostics.prominence import Prominence
from asperity.errors import InputError
from asperity.structures.ball_bearing import BallBearing
from faulty_signals import faulty_signal, orders

RATE, SPEED = 12_000.0, 29.3
B6205 = BallBearing.named("6205")
PARTS = ("outer", "inner", "ball")
MADE = {
    "plain": {},
    "slip and jitter of 2 %": {"slip": 0.01, "jitter": 0.02, "duration": 2.0},
    "a foreign line near twice the speed, and hum": {
        "foreign": ((2.03 * SPEED, 0.5),),
        "hum": 0.3,
        "seed": 1,
    },
    "an angle of 13 degrees and a foreign line": {
        "angle": np.radians(13),
        "foreign": ((2.03 * SPEED, 0.5),),
        "seed": 2,
    },
}


def made(part, **how):
    """A made record of a second, and what is found in it."""
    return faulty_signal(part, SPEED, RATE, **{"duration": 1.0, "noise": 0.15} | how)


@cache
def found(part, kind, factor=1.0):
    return diagnose(made(part, **MADE[kind]), RATE, B6205.tones(), SPEED * factor)


@pytest.mark.parametrize("kind", MADE)
@pytest.mark.parametrize("part", PARTS)
def test_the_part_that_is_struck_is_named_and_no_other_and_the_speed_is_by_its_lines(part, kind):
    diagnosis = found(part, kind)
    assert [each.part for each in diagnosis.parts] == [part]
    assert not diagnosis.alike
    assert diagnosis.speed == pytest.approx(SPEED, rel=0.005)
    assert diagnosis.speed_is == "confirmed"
    (lines,) = diagnosis.parts
    assert lines.tone == pytest.approx(orders("6205")[part] * SPEED, rel=0.02)


@pytest.mark.parametrize("factor", [0.5, 0.7, 0.9, 0.97, 1.03, 1.1, 1.3, 2.0])
@pytest.mark.parametrize("part", PARTS)
def test_at_a_wrong_speed_no_part_is_named_but_the_one_that_is_struck_at_the_speed_of_its_lines(part, factor):
    diagnosis = found(part, "plain", factor)
    assert diagnosis.speed_is != "confirmed"
    assert [each.part for each in diagnosis.parts] in ([], [part])
    if diagnosis.parts:
        assert diagnosis.speed == pytest.approx(SPEED, rel=0.005)
    assert diagnosis_sentence(diagnosis).startswith("The line of the shaft is not ")


@pytest.mark.parametrize("unlike", [0.4, 0.2, 0.0])
def test_a_ball_that_one_ring_strikes_harder_has_lines_of_its_spin_and_is_named(unlike):
    """A spot meets the inner and the outer ring in turn: every second blow is alike, the comb has f_b."""
    diagnosis = diagnose(made("ball", unlike=unlike, duration=2.0), RATE, B6205.tones(), SPEED)
    assert [each.part for each in diagnosis.parts] == ["ball"]
    assert diagnosis.speed_is == "confirmed"
    (ball,) = diagnosis.parts
    assert ball.every == 2
    assert ball.blows == pytest.approx(orders("6205", 0.14)["ball"] * SPEED, rel=0.01)
    assert diagnosis_sentence(diagnosis).startswith("There are lines of the ball at 13")


def test_the_comb_of_a_spin_is_a_ball_only_where_the_shaft_speaks_for_no_other_part():
    """Of an outer ring, asked at the speed whose f_b its blows have: f_o/f_b times its own."""
    tone = orders("6205", 0.14)
    signal = made("outer", duration=2.0)
    asked = SPEED * 0.995 * tone["outer"] / (0.5 * tone["ball"])
    diagnosis = diagnose(signal, RATE, B6205.tones(), asked)
    assert "ball" not in [each.part for each in diagnosis.parts]
    unheard = diagnose(made("ball", unlike=0.0, shaft=0.0, duration=2.0), RATE, B6205.tones(), SPEED)
    assert [each.part for each in unheard.parts] == ["ball"]


MAINS = [(50.0 * n, 0.6 / n) for n in (1, 2, 3, 4, 6)]


@pytest.mark.parametrize("seed", range(4))
def test_hum_and_its_harmonics_beat_with_each_other_and_are_no_blows(seed):
    signal = faulty_signal(None, 28.41, RATE, 2.0, noise=0.1, shaft=0.3, foreign=MAINS, seed=seed)
    diagnosis = diagnose(signal, RATE, B6205.tones(), 28.41)
    assert (diagnosis.parts, diagnosis.blows) == ((), 0.0)
    assert diagnosis.speed_is != "contradicted"


@pytest.mark.parametrize("part", ["outer", "inner"])
def test_unbalance_far_above_the_blows_hides_none_of_them(part):
    diagnosis = diagnose(
        made(part, foreign=[(SPEED, 10.0)], noise=0.1, duration=2.0), RATE, B6205.tones(), SPEED
    )
    assert [each.part for each in diagnosis.parts] == [part]


@pytest.mark.parametrize("part", PARTS)
def test_a_single_click_hides_no_fault(part):
    signal = made(part, duration=2.0)
    signal[7_000] += 1e4
    diagnosis = diagnose(signal, RATE, B6205.tones(), SPEED)
    assert [each.part for each in diagnosis.parts] == [part]


@pytest.mark.filterwarnings("error")
@pytest.mark.parametrize("gain", [1e-150, 1e-6, 1e6, 1e150])
def test_the_verdict_is_the_same_in_every_unit(gain):
    diagnosis = diagnose(gain * made("outer"), RATE, B6205.tones(), SPEED)
    assert [each.part for each in diagnosis.parts] == ["outer"]
    assert diagnosis.confidence == pytest.approx(found("outer", "plain").confidence)
    assert diagnosis.speed == pytest.approx(found("outer", "plain").speed)


@pytest.mark.parametrize("deep", [0.1, 0.3])
def test_varying_compliance_of_a_sound_bearing_is_no_fault(deep):
    """Balls pass the load: the signal and the resonance rise and fall by so much with the tone of the outer
    ring."""
    diagnosis = diagnose(made(None, compliance=deep, duration=2.0, noise=0.05), RATE, B6205.tones(), SPEED)
    assert diagnosis.speed_is == "confirmed"
    assert diagnosis.parts == ()
    assert diagnosis_sentence(diagnosis).startswith(
        "No lines of rings or balls stand out: no sign of a fault, "
    )


@pytest.mark.parametrize("part", ["outer", "inner"])
def test_a_second_ring_that_the_shaft_makes_of_the_first_is_not_named(part):
    """f_o + f_i = Z f_r: where the load turns with the shaft each ring has lines at which the other would."""
    time = np.arange(2 * int(RATE)) / RATE
    turns = 1.0 + 0.9 * np.cos(2 * np.pi * SPEED * time) + 0.5 * np.cos(2 * np.pi * 9 * SPEED * time)
    signal = made(part, duration=2.0, noise=0.02) * turns
    diagnosis = diagnose(signal, RATE, B6205.tones(), SPEED)
    assert [each.part for each in diagnosis.parts] == [part]


def test_what_lies_above_the_lines_that_are_sought_changes_none_of_those_below():
    amplitude = np.abs(np.random.default_rng(3).normal(size=4_000)) + 0.1
    spectrum = 0.5 * np.arange(4_000.0), amplitude
    every = Prominence.of(spectrum)
    some = Prominence.of(spectrum, highest=700.0)
    assert some.amplitude.size == 1_401
    for name in ("amplitude", "log_ratio"):
        np.testing.assert_array_equal(getattr(some, name), getattr(every, name)[:1_401])
    np.testing.assert_array_equal(*(each.background(np.arange(1_401)) for each in (some, every)))


def test_noise_says_nothing_of_speed_and_parts():
    for seed in range(3):
        diagnosis = diagnose(np.random.default_rng(seed).normal(size=12_000), RATE, B6205.tones(), SPEED)
        assert (diagnosis.parts, diagnosis.blows, diagnosis.speed_is) == ((), 0.0, "unconfirmed")


def test_parts_whose_lines_are_the_same_are_both_named_where_nothing_else_tells_them():
    """Eight balls of a fifth of the pitch diameter: 2 f_b = f_i, as 2 (1 - γ) = Z γ there."""
    bearing = BallBearing(8, 6e-3, 30e-3)
    tones = bearing.tones()
    assert tones["ball"].order == pytest.approx(tones["inner"].order)
    signal = faulty_signal(
        "outer", 162.0 / 3.2 * 1.0, RATE, 2.0, bearing=(8, 0.2), noise=0.1, shaft=0.0, slip=0.0
    )
    tone = orders((8, 0.2), np.radians(8.0))["outer"] * 162.0 / 3.2  # even blows without side bands
    diagnosis = diagnose(signal, RATE, tones, tone / tones["inner"].order)
    assert {each.part for each in (*diagnosis.parts, *diagnosis.alike)} == {"inner", "ball"}
    assert "agree with more than one part, the " in diagnosis_sentence(diagnosis)


def test_tones_allow_for_contact_angle_and_slip():
    """Closed forms at 15 degrees and at a cage that lags by 1 %; nominal at 0, at the free angle of an axial
    load."""
    tones = B6205.tones()
    for part, order in orders("6205").items():
        if part != "cage":
            assert tones[part].order == pytest.approx(order)
            inclined = orders("6205", np.radians(15.0))[part]
            assert (
                tones[part].lowest - 1e-9
                <= min(order, inclined)
                <= max(order, inclined)
                <= tones[part].highest + 1e-9
            )
    assert tones["outer"].lowest == pytest.approx(0.99 * orders("6205")["outer"])
    assert tones["outer"].highest == pytest.approx(
        orders("6205", max(np.radians(15.0), B6205.free_angle + np.radians(5.0)))["outer"]
    )
    inclined = BallBearing.named("6205", contact_angle=np.radians(40.0)).tones()
    assert inclined["outer"].order == pytest.approx(orders("6205", np.radians(40.0))["outer"])


# --- the sentence


OUTER = Hypothesis("outer", 30.0, 107.66, 3.0, 40.0, 1.0)
BASIS = SimpleNamespace(confidence=0.834, kind="fault")
FOREIGN = SimpleNamespace(confidence=0.834, kind=NOT_FOUND)
SOUND = Diagnosis(30.0, 30.0, "confirmed", (), (), None, 0.0, (), BASIS, 0.25, SimpleNamespace(duration=4.0))


@pytest.mark.parametrize(
    ("change", "said"),
    [
        ({}, "No lines of rings or balls stand out: no sign of a fault, 83 % sure that there is none."),
        (
            {"parts": (OUTER,)},
            "There are lines of the outer ring at 107.7 Hz, resolved to 0.25 Hz: 83 % sure.",
        ),
        (
            {"parts": (OUTER, replace(OUTER, part="ball", tone=142.0))},
            "There are lines of the outer ring at 107.7 Hz and lines of the ball at 142.0 Hz, resolved to "
            "0.25 Hz: 83 % sure, by made signals.",
        ),
        (
            {"parts": (replace(OUTER, part="ball", tone=70.7, every=2),)},
            "There are lines of the ball at 141.4 Hz and at half of it (one ring strikes harder), resolved "
            "to 0.25 Hz: 83 % sure, by made signals.",
        ),
        (
            {"parts": (OUTER,), "alike": (replace(OUTER, part="ball"),)},
            "Lines at 107.7 Hz, resolved to 0.25 Hz, agree with more than one part, the outer ring and "
            "the ball; "
            "the outer ring is likelier: 83 % sure.",
        ),
        (
            {"parts": (OUTER,), "speed_is": "unconfirmed"},
            "The line of the shaft is not found at 30 Hz (1800 1/min): the speed is not confirmed. If it "
            "is right, there are "
            "lines of the outer ring at 107.7 Hz, resolved to 0.25 Hz: 83 % sure.",
        ),
        (
            {"parts": (OUTER,), "speed_is": "contradicted", "told": 33.0, "blows": 107.7},
            "The line of the shaft is not at 33 Hz (1980 1/min), as told, but at 30 Hz (1800 1/min): is "
            "the speed or the "
            "sampling rate wrong? At that speed there are lines of the outer ring at 107.7 Hz, resolved "
            "to 0.25 Hz: 83 % sure.",
        ),
        (
            {"speed_is": "unconfirmed", "blows": 35.9},
            "The line of the shaft is not found at 30 Hz (1800 1/min): is the speed or the sampling rate "
            "wrong? Blows at "
            "35.9 Hz, resolved to 0.25 Hz, are those of no part at this speed: 83 % sure.",
        ),
        (
            {"speed_is": "unconfirmed", "blows": 35.9, "nearest": replace(OUTER, part="inner", speed=29.5)},
            "The line of the shaft is not found at 30 Hz (1800 1/min): is the speed or the sampling rate "
            "wrong? Blows at 35.9 Hz, resolved to 0.25 Hz, are those of no part at this speed: 83 % sure. Of "
            "a shaft at 29.5 Hz (1770 1/min) they would be those of the inner ring.",
        ),
        (
            {"parts": (OUTER,), "speed_is": "unconfirmed", "basis": FOREIGN, "by_chance": 0.1},
            "The line of the shaft is not found at 30 Hz (1800 1/min): the speed is not confirmed. If it "
            "is right, there are lines of the outer ring at 107.7 Hz, resolved to 0.25 Hz, or of another "
            "bearing: 81 % sure.",
        ),
        (
            {"speed_is": "unconfirmed"},
            "The line of the shaft is not found at 30 Hz (1800 1/min): the speed is not confirmed. No "
            "lines of rings or "
            "balls stand out: no sign of a fault if it is right, 83 % sure that there is none.",
        ),
        (
            {
                "parts": (OUTER,),
                "speed_is": "unconfirmed",
                "otherwise": replace(OUTER, part="ball", speed=45.0),
            },
            "The line of the shaft is not found at 30 Hz (1800 1/min): the speed is not confirmed. If it is "
            "right, there are lines of the outer ring at 107.7 Hz, resolved to 0.25 Hz; they fit the ball of "
            "a shaft at 45 Hz (2700 1/min) better: 50 % sure.",
        ),
        (
            {"speed_is": "unconfirmed", "tones_alone": (100.0, 33.25)},
            "The record holds the tones at 100.0 Hz and 33.2 Hz alone, beside which it has no more than what "
            "rounding leaves: it says nothing of rings and balls.",
        ),
        (
            {"blows": 54.7},
            "Lines of the shaft are at 30 Hz (1800 1/min), but do not explain all blows: is the speed or the "
            "sampling rate wrong? Blows at 54.7 Hz, resolved to 0.25 Hz, are those of no part at this "
            "speed: 83 % sure.",
        ),
        (
            {"speed_is": "unconfirmed", "others": (15.0, 60.0)},
            "Lines of the shaft are at 30 Hz (1800 1/min); a shaft at 15 Hz (900 1/min) or 60 Hz (3600 "
            "1/min) would have them, too. No lines of rings or balls stand out: no sign of a fault, "
            "83 % sure that there is none.",
        ),
        (
            {"parts": (OUTER,), "speed_is": "unconfirmed", "record": SimpleNamespace(duration=0.1)},
            "The record of 0.1 s, 3 turns, is too short for the line of the shaft at 30 Hz (1800 1/min), "
            "which takes 0.2 s: the speed is not confirmed. If it is right, there are lines of the outer "
            "ring at 107.7 Hz, resolved to 0.25 Hz: 83 % sure.",
        ),
        (
            {"speed_is": "unconfirmed", "record": SimpleNamespace(duration=0.1)},
            "The record of 0.1 s holds 3 turns of the shaft at 30 Hz (1800 1/min): too short to tell whether "
            "there is a fault. Record 6 turns, 0.2 s, or more.",
        ),
        (
            {"doubts": ("The signal is clipped at 1.",)},
            "No lines of rings or balls stand out: no sign of a fault, 83 % sure that there is none. The "
            "signal is clipped at 1.",
        ),
    ],
)
def test_each_kind_of_verdict_says_the_speed_first_then_the_part_and_how_sure(change, said):
    diagnosis = replace(SOUND, **change)
    assert diagnosis_sentence(diagnosis) == said
    unseen = "Of the fault of the inner ring that is known to be there, the record holds no sign."
    assert diagnosis_sentence(diagnosis, "inner") == " ".join(
        [diagnosis_sentence(replace(diagnosis, doubts=())), unseen, *diagnosis.doubts]
    )
    if diagnosis.parts:
        assert diagnosis_sentence(diagnosis, diagnosis.parts[0].part) == said


@pytest.mark.parametrize(
    ("pulses", "change", "said"),
    [
        (0, {}, "By the tacho the shaft turns at 30 Hz (1800 1/min) on average. No lines of rings or balls "
         "stand out: no sign of a fault, 83 % sure that there is none."),
        (60, {"parts": (OUTER,)}, "By the tacho the shaft turns at 30 Hz (1800 1/min) on average. There are "
         "lines of the outer ring at 107.7 Hz, resolved to 0.25 Hz: 83 % sure."),
        (0, {"parts": (OUTER,), "speed_is": "unconfirmed"}, "By the tacho the shaft turns at 30 Hz (1800 "
         "1/min) on average. There are lines of the outer ring at 107.7 Hz, resolved to 0.25 Hz: 83 % sure."),
        (60, {"parts": (OUTER,), "speed_is": "unconfirmed"}, "By the tacho the shaft turns at 30 Hz (1800 "
         "1/min) on average, if it gives 60 pulses in a turn. If it does, there are lines of the outer ring "
         "at 107.7 Hz, resolved to 0.25 Hz: 83 % sure."),
        (1, {"speed_is": "unconfirmed"}, "By the tacho the shaft turns at 30 Hz (1800 1/min) on average, if "
         "it gives 1 pulse in a turn. No lines of rings or balls stand out: no sign of a fault if it does, "
         "83 % sure that there is none."),
        (0, {"speed_is": "unconfirmed", "others": (15.0, 60.0)}, "By the tacho the shaft turns at 30 Hz "
         "(1800 1/min) on average. No lines of rings or balls stand out: no sign of a fault, 83 % sure that "
         "there is none."),
        (2, {"speed_is": "unconfirmed", "others": (15.0, 60.0)}, "By the tacho the shaft turns at 30 Hz "
         "(1800 1/min) on average, if it gives 2 pulses in a turn; a shaft at 15 Hz (900 1/min) or 60 Hz "
         "(3600 1/min) would have its lines, too. No lines of rings or balls stand out: no sign of a fault, "
         "83 % sure that there is none."),
        (2, {"parts": (OUTER,), "speed_is": "contradicted", "told": 15.0, "blows": 107.7}, "The line of the "
         "shaft is not at 15 Hz (900 1/min), as the tacho says, but at 30 Hz (1800 1/min), as with 1 pulse "
         "in a turn: does the tacho give 2 pulses in a turn, and is it on this shaft? At that speed there "
         "are lines of the outer ring at 107.7 Hz, resolved to 0.25 Hz: 83 % sure."),
        (2, {"parts": (OUTER,), "speed_is": "contradicted", "told": 33.0, "blows": 107.7}, "The line of the "
         "shaft is not at 33 Hz (1980 1/min), as the tacho says, but at 30 Hz (1800 1/min): does the tacho "
         "give 2 pulses in a turn, and is it on this shaft? At that speed there are lines of the outer ring "
         "at 107.7 Hz, resolved to 0.25 Hz: 83 % sure."),
        (0, {"speed_is": "unconfirmed", "blows": 35.9}, "By the tacho the shaft turns at 30 Hz (1800 1/min) "
         "on average; its line is not found there: is the speed beside the signal that of this shaft, and "
         "are its unit and the rate right? Blows at 35.9 Hz, resolved to 0.25 Hz, are those of no part at "
         "this speed: 83 % sure."),
        (2, {"blows": 54.7}, "By the tacho the shaft turns at 30 Hz (1800 1/min) on average; its lines are "
         "there, but do not explain all blows: does the tacho give 2 pulses in a turn, and is it on this "
         "shaft? Blows at 54.7 Hz, resolved to 0.25 Hz, are those of no part at this speed: 83 % sure."),
        (2, {"parts": (OUTER,), "fastest": 20.0}, "Hardly any bearing of this size turns at 30 Hz (1800 "
         "1/min), as the tacho says: does the tacho give 2 pulses in a turn, and is it on this shaft? By the "
         "tacho the shaft turns at 30 Hz (1800 1/min) on average. There are lines of the outer ring at 107.7 "
         "Hz, resolved to 0.25 Hz: 50 % sure."),
        (0, {"speed_is": "unconfirmed", "record": SimpleNamespace(duration=0.15)}, "The record of 0.15 s "
         "holds 4.5 turns of the shaft at 30 Hz (1800 1/min), as the tacho says: too short to tell whether "
         "there is a fault. Record 6 turns, 0.2 s, or more."),
        (
            0,
            {"parts": (OUTER,), "speed_is": "contradicted", "told": 15.0, "blows": 107.7},
            "The line of the shaft is not at 15 Hz (900 1/min), as the tacho says, but at 30 Hz (1800 1/min)"
            ": is the speed beside the signal that of this shaft, and are its unit and the rate right? At "
            "that speed there are lines of the outer ring at 107.7 Hz, resolved to 0.25 Hz: 83 % sure.",
        ),
    ],
)  # fmt: skip
def test_a_speed_by_a_tacho_is_said_to_be_and_what_is_doubted_are_its_pulses(pulses, change, said):
    assert diagnosis_sentence(replace(SOUND, tacho=Tacho(pulses), **change)) == said


def test_confidence_rises_with_what_speaks_for_it_and_is_never_all_or_nothing():
    def sure(kind, *basis):
        return Basis(kind, *basis).confidence

    for kind in COEFFICIENTS:
        told = [sure(kind, 50.0, margin, margin) for margin in (0.0, 10.0, 40.0, 1e6)]
        told += [sure(kind, turns, 1e6, 1e6, 1.0) for turns in (1.0, 3.0, 50.0, 1e6)]
        assert told[:4] == sorted(told[:4])
        assert told[4:] == sorted(told[4:])
        assert 0.03 <= min(told) <= max(told) <= 0.97
    assert sure("fault", 3.0, 5.0, 5.0, 0.2) < sure("fault", 3.0, 5.0, 5.0, 0.8)
    assert sure("nothing", 50.0) < sure("sound", 50.0)  # a shaft that is found makes it no less sure


def test_what_lies_where_a_part_has_it_by_chance_makes_a_part_that_no_shaft_speaks_for_less_sure():
    """Bayes by hand: four of five are ours, and of others one in ten lies there; parts that overlap count
    once."""
    assert own_share(0.1) == pytest.approx(0.8 / (0.8 + 0.02))
    assert (own_share(0.0), own_share(1.0)) == (1.0, pytest.approx(0.8))
    one = Tone(4.0, 0.0, 4.0 / 0.98, 5.0 / 1.02)
    far = Tone(8.0, 1.0, 8.0 / 0.98, 10.0 / 1.02)
    inside = Tone(4.2, 1.0, 4.2, 4.6)
    assert chance_of({"outer": one}) == pytest.approx(np.log(1.25) / np.log(5.0))
    assert chance_of({"outer": one, "inner": inside}) == chance_of({"outer": one})
    assert chance_of({"outer": one, "inner": far}) == pytest.approx(2.0 * np.log(1.25) / np.log(10.0))
    halved = replace(far, unlike=2)
    assert chance_of({"ball": halved}) == chance_of({"outer": one, "inner": far})


def test_a_part_beside_an_unheard_shaft_may_be_of_another_bearing():
    signal = faulty_signal("outer", 30.0, 12_000.0, 2.0, noise=0.1, shaft=0.0)
    tones = BallBearing.named("6205").tones()
    found = diagnose(signal, 12_000.0, tones, 30.0)
    assert found.may_be_foreign
    assert found.by_chance == chance_of(tones)
    assert found.confidence == pytest.approx(found.basis.confidence * own_share(found.by_chance))
    assert found.confidence < 0.95 < found.basis.confidence


@pytest.mark.parametrize("factor", [0.95, 1.05])
def test_blows_of_no_part_are_told_to_be_one_at_a_speed_nearby(factor):
    """An unheard shaft whose speed is told 5 % off: "those of no part" was all that was said."""
    signal = faulty_signal("outer", 30.0, 12_000.0, 2.0, noise=0.1, shaft=0.0)
    found = diagnose(signal, 12_000.0, BallBearing.named("6205").tones(), 30.0 * factor)
    assert not found.parts
    assert found.blows
    assert found.nearest is not None
    assert found.nearest.part == "outer"
    assert found.nearest.speed == pytest.approx(30.0, rel=0.02)


@pytest.mark.parametrize(
    ("speed", "support", "beside"),
    [(30.3, 0.0, True), (30.3, SUPPORTED, False), (30.1, 0.0, False)],
    ids=["beside", "with lines of its own", "as near as slip"],
)
def test_a_part_beside_the_lines_of_the_shaft_is_another_bearings_but_with_lines_of_its_own(
    speed, support, beside
):
    heard = Hypothesis("inner", speed, 5.4 * speed, 1.0, support, 0.5)
    assert _beside_shaft(heard, 30.0, 0.1) is beside


# --- band and whitening


def test_the_kurtogram_of_noise_is_zero_and_of_a_sine_minus_one():
    noise = kurtogram(np.random.default_rng(0).normal(size=2**17), RATE)
    assert np.abs(noise.kurtosis).max() < 0.15
    assert noise.power[noise.count == 16] == pytest.approx(np.full(16, 1 / 16), rel=0.05)
    sine = kurtogram(np.sin(2 * np.pi * 700.0 * np.arange(12_000) / RATE), RATE)
    held = (sine.low < 700.0) & (sine.high > 700.0)
    np.testing.assert_allclose(sine.kurtosis[held], -1.0, atol=0.02)
    blows = made("outer", resonance=0.3, noise=0.1)
    assert kurtogram(blows, RATE, 500.0).best == impulsive_band(blows, RATE, 500.0)
    low, high = impulsive_band(blows, RATE, 500.0)
    assert low < 0.3 * RATE < high


def test_whitening_makes_lines_alike_and_leaves_blows():
    """A tone a thousand times as strong as the blows holds no more than its share of the lines afterwards."""
    time = np.arange(12_000) / RATE
    blows = made("outer", noise=0.01, shaft=0.0, jitter=0.0)
    white = prewhitened(blows + 1000.0 * np.sin(2 * np.pi * 400.0 * time), RATE)
    size = np.abs(np.fft.rfft(white))[1:-1]
    np.testing.assert_allclose(size, np.sqrt(12_000), rtol=1e-6)
    assert (white**4).mean() / (white**2).mean() ** 2 > 5.0


# --- mains, side bands, and speeds beyond belief


def test_a_ball_is_named_by_made_signals_and_its_verdict_says_so():
    assert found("ball", "plain").by_made_signals
    assert diagnosis_sentence(found("ball", "plain")).endswith(" % sure, by made signals.")
    assert not found("outer", "plain").by_made_signals


MAINS_BLOWS = [100.0 * n for n in range(1, 6)]


@pytest.mark.parametrize(("told", "parts"), [(10.0, []), (24.0, []), (28.41, ["outer"])])
def test_what_the_mains_make_ring_contradicts_no_speed_and_is_told_where_a_part_has_it(told, parts):
    """A resonance that 100 Hz modulates, as of an inverter: it was an inner ring at another speed."""
    time = np.arange(24_000) / RATE
    humming = 1.0 + 0.5 * sum(np.cos(2 * np.pi * each * time) for each in MAINS_BLOWS) / 2.0
    signal = faulty_signal(None, told, RATE, 2.0, noise=0.05, shaft=0.3)
    signal += (
        0.1 * humming * np.sin(2 * np.pi * 3_300.0 * time) * np.random.default_rng(1).normal(size=time.size)
    )
    diagnosis = diagnose(signal, RATE, B6205.tones(), told)
    assert [each.part for each in diagnosis.parts] == parts
    assert diagnosis.blows == 0.0
    assert diagnosis.speed_is != "contradicted"
    assert ("What the mains feed has lines at 100 Hz, too." in diagnosis_sentence(diagnosis)) == bool(parts)


@pytest.mark.parametrize("turns", [8, 14])
def test_side_bands_of_the_shaft_are_no_third_of_a_tone(turns):
    """f_o/3 is 1.19 f_r: a short record does not resolve the two, and blows were those of no part."""
    time = np.arange(int(turns / SPEED * RATE)) / RATE
    loaded = 1.0 + 0.7 * np.cos(2 * np.pi * SPEED * time)
    signal = made("outer", noise=0.02, slip=0.0, jitter=0.002, duration=2.0)[: time.size] * loaded
    diagnosis = diagnose(signal, RATE, B6205.tones(), SPEED)
    assert [each.part for each in diagnosis.parts] == ["outer"]


def test_a_line_of_the_shaft_one_place_beside_its_own_does_not_contradict_the_speed():
    """Of 3 s at 8 Hz places are 1/6 Hz apart: 47/6 Hz was "not at 8 Hz, as told", 97 % sure."""
    places = np.arange(1, 200) / 6.0
    told = places[20:]
    assert all(_agrees(beside, speed, 1.0 / 3.0) for beside, speed in zip(places[19:], told, strict=False))
    assert not any(
        _agrees(beside, speed, 1.0 / 3.0) for beside, speed in zip(places, told[:20], strict=False)
    )


def test_a_record_sampled_too_slowly_for_the_blows_is_no_sound_bearing():
    """It was "no sign of a fault, 92 % sure" of lines above half of its sampling rate."""
    signal = np.random.default_rng(0).standard_normal(4000)
    words = "received 300 Hz; allowed: more than 324.4 Hz, to hold the blows of the inner ring at 162.2 Hz"
    with pytest.raises(InputError, match=re.escape(words)):
        diagnose(signal, 300.0, B6205.tones(), 29.95)
    assert diagnose(signal, 330.0, B6205.tones(), 29.95).confidence < 0.97


def test_a_speed_that_hardly_any_bearing_has_is_doubted_first_and_nothing_is_surer_than_even():
    signal = made("outer", duration=0.5)
    for fastest, begin, most in (
        (20.0, "Hardly any bearing of this size turns at 29.3 Hz", 0.5),
        (30.0, "There are", 1),
    ):
        diagnosis = diagnose(signal, RATE, B6205.tones(), SPEED, fastest=fastest)
        assert diagnosis_sentence(diagnosis).startswith(begin)
        assert diagnosis.confidence <= most
    assert diagnosis.confidence > 0.5
