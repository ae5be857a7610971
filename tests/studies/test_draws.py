"""What a study draws by chance: keys, jitter of a speed, resonances of a path, levels of noise."""

import numpy as np
import pytest
from executors import Here

import asperity
from asperity.case.cases import as_case
from asperity.errors import CaseError, InputError
from asperity.speeds import SpeedCourse
from asperity.studies.definition import load_study, study_of
from asperity.studies.draws import Span, chance
from asperity.studies.sensor_path import noise_of, path_to_sensor, resonant_response, through_path
from refusals import refusals
from small_cases import BEARING

HEALTHY = {**BEARING, "fault": {}, "duration": "0.3 s"}
SIZE = {"fault.length": "1 mm", "fault.depth": "0.1 mm"}
VARIANT = {part: SIZE | {"fault.on": part} for part in ("outer", "ball")}
DRAW = {"radial": "50..500 N, ratios", "fault.length": "0.2..3 mm", "fault.angle": "0..360 deg"}


def members(draw, seeds="1..3", case=HEALTHY):
    return study_of(case, {"seed": seeds, "variant": VARIANT}, draw).members()


def test_each_member_draws_its_own_and_the_same_again_whatever_else_is_swept_to():
    found = members(DRAW)
    values = [member.case.radial for member in found]
    assert len(set(values)) == len(values) == 9
    assert all(50.0 <= value <= 500.0 for value in values)
    again = {member.key: member.case for member in members(DRAW, "1..4")}
    assert all(again[member.key] == member.case for member in found)
    assert {member.drawn["radial"] for member in found} == {f"{value:.10g} N" for value in values}


def test_what_a_sound_bearing_does_not_have_is_not_drawn():
    for member in members(DRAW):
        faulty = member.values["variant"] in VARIANT
        assert set(member.drawn) == (set(DRAW) if faulty else {"radial"})
        assert (member.case.fault.length is not None) == faulty
        if faulty:
            assert 0.2e-3 <= member.case.fault.length <= 3e-3
            assert 0.0 <= member.case.fault.angle <= 2 * np.pi


def test_spans_are_drawn_evenly_in_differences_or_in_ratios():
    random = chance("evenly")
    even = [Span(2.0, 6.0, "mm").drawn(random) for _ in range(4000)]
    ratios = np.log([Span(1.0, 100.0, "mm", in_ratios=True).drawn(random) for _ in range(4000)])
    for values, low, high in ((even, 2.0, 6.0), (ratios, 0.0, np.log(100.0))):
        shares = (np.sort(values) - low) / (high - low)
        beside = np.abs(shares - (np.arange(4000) + 0.5) / 4000).max()
        assert beside < 1.95 / np.sqrt(4000)  # Kolmogorov and Smirnov, 1 in 1000
    assert chance("a", 1).random() == chance("a", 1).random() != chance("a", 2).random()


def test_one_of_a_list_and_whole_numbers_are_drawn():
    case = HEALTHY | {"fault": {"on": "ball", "length": "1 mm", "depth": "0.1 mm"}}
    draw = {"fault.ball": "1..9", "laws": [["hertz"], ["linear"]]}
    drawn = [member.case for member in study_of(case, {"seed": "1..40"}, draw).members()]
    assert {case.laws for case in drawn} == {("hertz",), ("linear",)}
    assert {case.fault.ball for case in drawn} == set(range(1, 10))


def test_a_speed_wanders_about_what_is_drawn_by_the_rms_that_was_asked_for():
    case = HEALTHY | {"duration": "6 s"}
    study = study_of(case, {"seed": "1..20"}, {"speed": "1200..1800 1/min ± 0.5 %"})
    courses = [member.case.speed for member in study.members()]
    assert all(isinstance(speed, SpeedCourse) for speed in courses)
    off = np.concatenate([speed.speeds / speed.speeds.mean() - 1.0 for speed in courses])
    assert off.std() == pytest.approx(0.005 * np.sqrt(60 / 61), rel=0.05)  # 1220 points: 2 % by chance
    assert abs(off).max() < 0.0165
    means = np.array([speed.speeds.mean() for speed in courses])
    assert 19.9 < means.min() < means.max() < 30.1
    assert all((speed.times[0], speed.end) == (0.0, 6.0) for speed in courses)
    fixed = [
        m.case.speed.speeds
        for m in study_of(case, {"seed": "1..20"}, {"speed": "1500 1/min ± 1 %"}).members()
    ]
    assert np.mean(fixed) == pytest.approx(25.0, rel=0.001)
    assert (
        0.75 <= np.abs(np.array(fixed) - 25.0).max() < 0.75 * (1.0 + 1e-6)
    )  # three times the rms, met and kept


def test_a_load_that_is_drawn_need_not_stand_in_the_case():
    case = {name: value for name, value in HEALTHY.items() if name != "radial"}
    (member,) = study_of(case, {"seed": [1]}, {"radial": "50..500 N"}).members()
    assert 50.0 < member.case.radial < 500.0


def test_a_study_file_and_the_table_say_what_is_drawn(tmp_path):
    file = tmp_path / "study.toml"
    (tmp_path / "case.toml").write_text(as_case(HEALTHY | {"duration": "0.1 s"}).to_toml())
    file.write_text('case = "case.toml"\n[sweep]\nseed = [1]\n[draw]\nradial = "50..500 N"\n')
    study = load_study(file)
    assert study.drawn == {"radial": "50..500 N"}
    table = asperity.study(study, executor=Here())
    assert table.attrs["draw"] == '{"radial": "50..500 N"}'
    (member,) = study.members()
    np.testing.assert_allclose(table["largest_load"].max(), max(load for _, load in member.case.contacts))
    np.testing.assert_allclose(table["radial"], [member.case.radial], rtol=1e-9)
    assert (table["radial"].dims, table["radial"].attrs["units"]) == (("seed",), "N")


def drawing(draw):
    return study_of(HEALTHY, {"seed": [1]}, draw)


test_what_cannot_be_drawn_is_refused = refusals(
    (
        {"radial": "50 N"},
        r"draw.radial: received '50 N'; allowed: a span as '0.2..3 mm', or a list of values",
    ),
    ({"radial": "50..50 N"}, "allowed: two different ends"),
    ({"radial": "-5..50 N"}, "draw.radial: received '-5 N'; allowed: a force at least 0"),
    ({"radial": "0..50 N, ratios"}, "allowed: ends above zero for equal ratios"),
    ({"radial": "50..60 m"}, r"draw.radial: .*allowed: a force"),
    ({"seed": "1..3"}, "draw.seed: received the key more than once; allowed: each key once, swept or drawn"),
    ({"kind": "1..3"}, "one kind of case in a study"),
    ({"nothing": "1..3"}, "nothing"),
    ({"radial": "50..60 N ± 1 %"}, "a jitter of a speed alone"),
    ({"speed": "900..1000 1/min ± 30 %"}, r"a jitter above 0 %, at most 20%"),
    ({"speed": "900..1000 1/min ± 0 %"}, r"a jitter above 0 %, at most 20%"),
    ("radial", "draw: received 'radial'; allowed: keys, each with what it is drawn from"),
    of=drawing,
    error=CaseError,
)


def test_keys_are_drawn_beside_swept_ones():
    with pytest.raises(
        InputError, match=r"draw: received keys without sweep; allowed: keys beside those of sweep"
    ):
        asperity.study("study.toml", draw={"radial": "1..2 N"})


def test_a_path_of_resonances_is_the_closed_form_of_masses_on_springs():
    rate, size = 25_600.0, 4096
    natural, ratios, shares = (
        2 * np.pi * np.array([900.0, 3000.0]),
        np.array([0.02, 0.05]),
        np.array([0.3, 0.7]),
    )
    weights = resonant_response(natural, ratios, shares, 8 * rate, size / rate)
    impulse = np.zeros(size)
    impulse[256] = 1.0
    found = np.fft.rfft(through_path(impulse, rate, weights, 8 * rate)) / np.fft.rfft(impulse)
    r = np.multiply.outer(2 * np.pi * np.fft.rfftfreq(size, 1 / rate), 1 / natural)
    expected = ((1 + 2j * ratios * r) / (1 - r**2 + 2j * ratios * r)) @ shares
    below = slice(0, size // 4)  # 6.4 kHz
    np.testing.assert_allclose(found[below], expected[below], rtol=0.0, atol=0.02 * abs(expected).max())
    assert found[0].real == pytest.approx(1.0, abs=2e-3)


def test_paths_and_noise_are_drawn_within_their_spans():
    path, signal = path_to_sensor("1..6 kHz, 3 resonances", None), np.zeros((1, 8192))
    signal[0, 256] = 1.0
    heard = [path.behind(signal, 25_600.0, chance("path", n))[0] for n in range(8)]
    spectra = abs(np.fft.rfft(heard))
    assert len({float(each.max()) for each in spectra}) == 8
    frequency = np.fft.rfftfreq(8192, 1 / 25_600.0)
    assert all(950.0 < frequency[each.argmax()] < 6050.0 for each in spectra)
    np.testing.assert_allclose(spectra[:, 0], 1.0, atol=5e-3)
    levels = [noise_of("-6..20 dB").level(chance(n)) for n in range(200)]
    assert (-6.0 < min(levels) < -5.0, 19.0 < max(levels) < 20.0) == (True, True)
    rms = noise_of("100..200 mm/s^2")
    assert 0.1 <= rms.level(chance(1)) <= 0.2


test_paths_and_noise_that_are_none = refusals(
    (lambda: path_to_sensor("1..6 kHz, 3 resonances", "48 kHz"), "resonances as '1..6 kHz, 3 resonances'"),
    (lambda: path_to_sensor("6 kHz, 3 resonances", None), "received '6 kHz, 3 resonances'"),
    (lambda: path_to_sensor("0..6 kHz, 3 resonances", None), "frequencies above zero"),
    (lambda: path_to_sensor("1..6 mm, 3 resonances", None), "mm"),
    (
        lambda: path_to_sensor("1..6 kHz, 3 resonances", None).behind(np.ones((1, 9)), 8e3, chance(1)),
        "received resonances up to 6000 Hz; allowed: below half of the sampling rate, 4000 Hz",
    ),
    (lambda: noise_of("0..500 dB"), "within ±200 dB"),
    (lambda: noise_of("-1..1 m/s^2"), "or a span of one as '0..30 dB'"),
)
