"""What is the shaft's own and no part's: rubs, half-orders, other shafts; and resampled records."""

import numpy as np
import pytest
from scipy.signal import resample, resample_poly

from asperity.diagnostics import Hypothesis, diagnose, diagnosis_sentence
from asperity.diagnostics.confidence import Basis
from asperity.diagnostics.decision import _seconds, _side_band
from asperity.diagnostics.shaft import has_own_lines, of_shaft_or_mains
from asperity.structures.ball_bearing import BallBearing
from faulty_signals import GEOMETRIES, faulty_signal, orders

RATE, SPEED = 12_000.0, 29.3
TONES = {name: BallBearing.named(name).tones() for name in GEOMETRIES}
TIME = np.arange(24_000) / RATE
NOISE = np.random.default_rng(5).normal(size=TIME.size)


def lines(speed, multiples):
    return sum(np.sin(2.0 * np.pi * speed * n * TIME + n * n) / n for n in multiples)


def rubbing(signal, height=2.0, seed=0):
    """A burst of noise once in a turn of the shaft."""
    touched = np.sin(np.pi * SPEED * TIME) ** 2 > 0.995
    return signal + height * touched * np.random.default_rng(seed).normal(size=TIME.size)


@pytest.mark.parametrize("bearing", GEOMETRIES)
@pytest.mark.parametrize("factor", [1.0, 1.01, 2.57, 0.9])
@pytest.mark.parametrize("part", [None, "outer"])
def test_multiples_of_a_rub_are_no_part(bearing, factor, part):
    """Of a 6203 f_o is 3.05, f_i 4.95 and 2 f_b 4.0 times the speed: three to five times that of a rub was a
    ring or a ball, at the speed told or at a fifth of it, 97 % sure."""
    for seed in range(2):
        sound = faulty_signal(part, SPEED, RATE, 2.0, bearing=bearing, noise=0.1, shaft=0.02, seed=seed)
        found = diagnose(rubbing(0.3 * sound, seed=seed), RATE, TONES[bearing], SPEED * factor)
        assert not found.parts or (
            [each.part for each in found.parts] == [part] and found.speed == pytest.approx(SPEED, rel=0.01)
        )


@pytest.mark.parametrize("factor", [0.95, 1.05])
@pytest.mark.parametrize("turns", [15, 29])
def test_multiples_of_a_rub_are_no_part_where_the_speed_is_told_wrong_by_a_little(factor, turns):
    """Five times the speed of the rub was an inner ring, and the turns of the rub a ball at a fifth of it."""
    time = TIME[: int(turns / SPEED * RATE)]
    for seed in range(4):
        sound = faulty_signal(None, SPEED, RATE, time[-1] + 1.5 / RATE, noise=0.1, shaft=0.0, seed=seed)
        touched = np.sin(np.pi * SPEED * time) ** 2 > 0.995
        rub = 2.0 * touched * np.random.default_rng(seed).normal(size=time.size)
        found = diagnose(0.3 * sound + rub, RATE, TONES["6205"], SPEED * factor)
        assert not found.parts
        assert (found.once_in_a_turn, found.confidence <= 0.5) == (True, True)  # it may hide a fault


@pytest.mark.parametrize("factor", [0.5, 2.0])
@pytest.mark.parametrize("struck", [("outer", "6203", 0.6), ("ball", "6205", 0.3), (None, "6203", 0.3)])
def test_a_rub_at_half_and_at_double_the_speed_is_no_part(factor, struck):
    """Twice a turn of the speed told was the spin of a ball, and 5.5 times an inner ring, 97 % sure."""
    part, bearing, height = struck
    for seed in range(3):
        signal = height * faulty_signal(part, SPEED, RATE, 2.0, bearing=bearing, noise=0.1, seed=seed)
        found = diagnose(rubbing(signal, seed=seed), RATE, TONES[bearing], SPEED * factor)
        right = [each.part for each in found.parts] == [part] and abs(found.speed / SPEED - 1.0) < 0.02
        assert right or not found.parts or found.confidence <= 0.5
        if found.parts and not right:
            said = "A shaft at 29.3 Hz (1758 1/min) that rubs would have these lines, too."
            assert said in diagnosis_sentence(found)


@pytest.mark.parametrize(
    ("beside", "clearness", "depth", "is_one"),
    [(1.0, 3.0, 0.5, True), (-2.0, 3.0, 0.5, True), (3.0, 3.0, 0.5, False), (1.01, 3.0, 0.5, False),
     (1.0, 2.2, 0.5, False), (1.0, 3.0, 0.3, False)],
)  # fmt: skip
def test_a_side_band_is_a_turn_or_two_beside_blows_that_are_deeper_and_clearer(
    beside, clearness, depth, is_one
):
    each = Hypothesis("outer", SPEED, 105.0, 2.0, 20.0, 0.4)
    other = Hypothesis("inner", 31.0, 105.0 + beside * SPEED, clearness, 0.0, depth)
    assert _side_band(each, [each, other], SPEED, 0.5) is is_one


def test_side_bands_of_another_bearing_are_no_part_of_this_one():
    """Of a bearing of 7 balls the inner ring has 4.55 blows in a turn, and its lower side bands are where the
    outer ring of a 6205 has its lines, 3.55: it was 97 % sure."""
    for seed in range(4):
        signal = faulty_signal("inner", SPEED, RATE, 4.0, bearing=(7, 0.30), noise=0.1, seed=seed)
        found = diagnose(signal, RATE, TONES["6205"], SPEED)
        assert not found.parts
        assert found.blows == pytest.approx(orders((7, 0.30), 0.14)["inner"] * SPEED, rel=0.01)
        assert found.basis == Basis("blows", found.turns)  # not that of a sound bearing


def test_a_record_that_a_rub_may_hide_a_fault_in_says_so_and_is_no_surer_than_even():
    sound = faulty_signal(None, SPEED, RATE, 2.0, noise=0.1, shaft=0.2)
    found = diagnose(rubbing(sound), RATE, TONES["6205"], SPEED)
    assert found.once_in_a_turn
    assert found.confidence == 0.5
    said = (
        "Blows come with the turns of the shaft, as of a rub; fainter ones may hide behind them. No lines of "
    )
    assert said + "rings or balls stand out: no sign of a fault" in diagnosis_sentence(found)
    assert not diagnose(sound, RATE, TONES["6205"], SPEED).once_in_a_turn
    struck = rubbing(faulty_signal("inner", SPEED, RATE, 2.0, noise=0.05), height=0.5)
    found = diagnose(struck, RATE, TONES["6205"], SPEED)
    assert [each.part for each in found.parts] == ["inner"]
    assert found.confidence > 0.9


@pytest.mark.parametrize("part", ["ball", "inner", "outer"])
def test_a_part_whose_tone_is_close_to_a_multiple_of_a_loud_shaft_is_named(part):
    """Of a 6203 at 9 degrees 2 f_b is 3.98, f_i 4.93 and f_o 3.07 times the speed, all within 2 % of a
    multiple: where the lines of the shaft are says which."""
    for seed in range(3):
        signal = faulty_signal(part, SPEED, RATE, 2.0, bearing="6203", angle=0.15, noise=0.1, seed=seed)
        clipped = np.clip(signal, -0.25, 0.25) + 0.2 * lines(SPEED, range(1, 9))
        found = diagnose(clipped, RATE, TONES["6203"], SPEED)
        assert [each.part for each in found.parts] == [part]


def test_a_ball_beside_a_rub_is_named_where_the_lines_of_the_shaft_are_clearer_at_its_speed():
    for seed in range(3):
        signal = faulty_signal("ball", SPEED, RATE, 2.0, bearing="6203", angle=0.15, noise=0.1, seed=seed)
        clipped = np.clip(signal, -0.6, 0.6) + 0.2 * lines(SPEED, range(1, 9))
        found = diagnose(rubbing(clipped, height=0.3, seed=seed), RATE, TONES["6203"], SPEED)
        assert [each.part for each in found.parts] == ["ball"]


@pytest.mark.parametrize("times", [2, 3])
def test_an_envelope_with_the_lines_of_the_shaft_and_of_a_part_of_its_speed_holds_no_blows(times):
    """As of a sound measured bearing whose band, after resampling by 4/5, was another one: lines of 0.43 at
    the speed and 0.07 at half of it were blows of no part at that half, 97 % sure."""
    turned = 1.0 + 0.45 * np.sin(2 * np.pi * SPEED * TIME) + 0.25 * np.sin(4 * np.pi * SPEED * TIME)
    turned += 0.12 * np.sin(2 * np.pi * SPEED / times * TIME)
    carrier = np.sin(
        2.0 * np.pi * 3_000.0 * TIME + np.cumsum(np.random.default_rng(3).normal(size=TIME.size)) / 9
    )
    signal = turned * carrier + 0.2 * lines(SPEED, range(1, 11))
    found = diagnose(
        signal + 0.02 * np.random.default_rng(4).normal(size=TIME.size), RATE, TONES["6205"], SPEED
    )
    assert (found.parts, found.blows) == ((), 0.0)


def test_half_and_a_third_of_a_speed_have_no_lines_of_their_own():
    signal = faulty_signal("outer", SPEED, RATE, 2.0, noise=0.2, shaft=0.3)
    record = diagnose(signal, RATE, TONES["6205"], SPEED).record
    tone = 0.995 * orders("6205", 0.14)["outer"] * SPEED
    for share, own in ((1.0, True), (0.5, False), (1.0 / 3.0, False), (1.5, False), (0.7, False)):
        assert (
            has_own_lines(record, Hypothesis("outer", share * SPEED, tone, 3.0, 20.0, 0.5), TONES["6205"])
            is own
        )


@pytest.mark.parametrize(("support", "of_shaft"), [(20.0, True), (30.0, False)])
def test_blows_once_in_a_turn_are_a_part_at_another_speed_only_where_much_speaks_for_it(support, of_shaft):
    record = diagnose(lines(SPEED, range(1, 11)) + 0.1 * NOISE, RATE, TONES["6205"], SPEED).record
    each = Hypothesis("inner", SPEED / orders("6205")["inner"], SPEED, 3.0, support, 0.5)
    assert of_shaft_or_mains(record, each, SPEED, 0.5, seen=True) is of_shaft


@pytest.mark.parametrize("seed", range(3))
def test_a_comb_of_the_spin_at_the_speed_of_another_shaft_is_no_ball(seed):
    """f_o of one shaft is f_b of one that turns 1.51 times as often, whose lines are there."""
    other = orders("6205", 0.14)["outer"] * 0.995 / (0.5 * orders("6205", 0.14)["ball"])
    signal = faulty_signal("outer", SPEED, RATE, 2.0, noise=0.1, shaft=0.02, seed=seed)
    signal += 0.1 * lines(other * SPEED, range(1, 9))
    found = diagnose(signal, RATE, TONES["6205"], 1.05 * SPEED)
    assert "ball" not in [each.part for each in found.parts]


RESAMPLED = {
    "4/5": lambda x: (resample_poly(x, 4, 5), 0.8),
    "3/2": lambda x: (resample_poly(x, 3, 2), 1.5),
    "four times, 16 bits": lambda x: (np.round(3e3 * resample(x, 4 * x.size)), 4.0),
    "each sample four times": lambda x: (np.repeat(x, 4), 4.0),
    "straight lines": lambda x: (np.interp(np.arange(4 * x.size) / 4, np.arange(x.size), x), 4.0),
    "every second sample": lambda x: (x[::2], 0.5),
    "without the upper third": lambda x: (_without_upper(x, 2.0 / 3.0), 1.0),
    "without the upper third, four bytes": lambda x: (_without_upper(x, 0.66).astype(np.float32), 1.0),
}  # fmt: skip


def _without_upper(signal, share):
    spectrum = np.fft.rfft(signal)
    spectrum[int(share * spectrum.size) :] = 0.0
    return np.fft.irfft(spectrum, signal.size)


@pytest.mark.parametrize("kind", RESAMPLED)
@pytest.mark.parametrize("part", ["outer", "inner", "ball", None])
def test_a_resampled_record_has_the_verdict_of_the_record(kind, part):
    signal, times = RESAMPLED[kind](faulty_signal(part, SPEED, RATE, 2.0, noise=0.2))
    for factor in (1.0, 0.7):
        found = diagnose(signal, times * RATE, TONES["6205"], SPEED * factor)
        assert [each.part for each in found.parts] == [part] * (part is not None)
        assert found.blows == 0.0 or part
        assert (found.speed_is == "confirmed") is (factor == 1.0)
        assert not any("smooth line" in each or "jumps" in each for each in found.doubts)


@pytest.mark.parametrize("seed", range(4))
@pytest.mark.parametrize("factor", [0.5, 1.0, 1.3])
def test_a_sound_bearing_without_a_line_of_the_shaft_has_that_said_first(seed, factor):
    signal = faulty_signal(None, SPEED, RATE, 2.0, noise=0.3, shaft=0.0, seed=seed)
    found = diagnose(signal, RATE, TONES["6205"], SPEED * factor)
    assert diagnosis_sentence(found).startswith("The line of the shaft is not found at ")


@pytest.mark.parametrize(("depth", "is_second"), [(0.31, True), (0.29, False)])
def test_a_second_part_moves_the_envelope_by_half_as_much_as_the_first_at_least(depth, is_second):
    best = Hypothesis("outer", SPEED, 105.0, 3.0, 40.0, 0.6)
    other = Hypothesis("ball", SPEED, 141.7, 2.5, 30.0, depth)
    assert _seconds([other], best, TONES["6205"], 0.5) == [other] * is_second
