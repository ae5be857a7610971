"""Speeds as cases say them: courses from text, pairs, arrays and tables, and back; what is refused."""

import numpy as np
import pytest

from asperity import BallOnBeam, BearingUnderLoad, Bodies, read_case
from asperity.case.form import content
from asperity.case.speed import Speed, span_of
from asperity.errors import CaseError, InputError
from asperity.scenarios.prepared_bearing import expected, prepare_bearing
from asperity.serving.case_form import case_data
from asperity.speeds import SpeedCourse
from refusals import refusals

TIGHT = {"name": "6205", "clearance": "-4 um"}
BEARING = {"radial": "100 N", "bearing": {"name": "6205"}}
RUN_UP = "600..1800 1/min in 0.5 s"
AT = ", at the fastest, 1800 1/min"


def turning(speed, **keys):
    return BearingUnderLoad(speed=speed, **BEARING | keys)


@pytest.mark.parametrize(
    ("typed", "meant", "told"),
    [
        ("143 km/h", "m/s", "143 km/h"),
        ("33.33333333 m/s", "m/s", "33.333 m/s"),
        ("80..96 km/h in 3 s", "m/s", "80 to 96 km/h"),
        ("80 km/h at 0 s, 3 m/s at 4 s", "m/s", "80 km/h to 3 m/s"),
        ("1423 1/min", "1/min", "1423 1/min"),
        ("23.7166 Hz", "1/min", "23.7166 Hz"),
        ("10 Hz at 0 s, 1800 1/min at 0.5 s", "1/min", "600 to 1800 1/min"),
    ],
)
def test_a_speed_is_told_as_it_was_typed(typed, meant, told):
    """With five digits if it is longer; of a course its ends, with one unit if they share it."""
    dimension = "Hz" if meant == "1/min" else "m/s"
    assert span_of(Speed(dimension)(typed), dimension, meant) == told


@pytest.mark.parametrize(
    "given",
    [
        RUN_UP,
        "600 1/min .. 1800 1/min in 500 ms",
        "10 Hz at 0 s, 1800 1/min at 0.5 s",
        [["0 s", "600 1/min"], ["0.5 s", "1800 1/min"]],
        np.array([[0.0, 10.0], [0.5, 30.0]]),
        SpeedCourse([0.0, 0.5], [10.0, 30.0]),
        "table",
    ],
    ids=["from to", "units", "points", "pairs", "array", "course", "table"],
)
def test_a_course_is_the_same_however_it_is_said(given, tmp_path):
    if isinstance(given, str) and given == "table":
        given = str(tmp_path / "run_up.csv")
        (tmp_path / "run_up.csv").write_text("time (ms),speed (1/min)\n0,600\n500,1800\n")
    case = turning(given)
    assert case.speed == SpeedCourse([0.0, 0.5], [10.0, 30.0])
    assert case.duration == 0.5  # until it ends, where the case says nothing
    assert f"speed='{RUN_UP}'" in repr(case)
    assert case.title == "Ball bearing 6205 at 600 to 1800 1/min"


def test_courses_stand_in_files_and_count_in_names_of_results(tmp_path):
    third = 100.0 / 3.0
    cases = [
        turning(each)
        for each in (RUN_UP, "30 Hz", [[0.1, 10.0], [0.3, third], [0.7, 12.0]], [[0.0, third], [2.0, 40.0]])
    ]
    told = {str(content(each)) for each in cases}
    assert len(told) == len(cases)
    for case in cases:
        case.save(tmp_path / "case.toml")
        assert read_case(tmp_path / "case.toml") == case
    assert isinstance(turning("600..600 1/min in 1 s").speed, float)
    assert turning("600..600 1/min in 1 s") == turning("600 1/min")


def test_a_run_up_over_a_beam_lasts_until_its_end():
    """0.5 m/s + t·5 m/s² up to 1 m/s: 75 mm in 0.1 s, and the rest of the way at 1 m/s."""
    case = BallOnBeam(
        speed="0.5..1 m/s in 0.1 s",
        surface={"rms": "0.1 um"},
        ball={"load": 5},
        start="0.2 m",
        settling="0.1 s",
    )
    first, last = case.rolled_range
    assert first == pytest.approx(0.2 - 0.05)
    assert last == pytest.approx(case.room[1])
    assert case.rolled_time == pytest.approx(0.1 + case.room[1] - 0.275)
    assert case.coarsest_spacing == pytest.approx(0.5 / 2.5 / case.highest_frequency)


def refused_track(speed):
    Bodies(
        over="track",
        speed=speed,
        body={"load": 5e4},
        surface={"rms": "5 um"},
        noise={"receiver_distance": 25},
    )


def refused_creep(speed):
    BallOnBeam(speed=speed, surface={"rms": "0.1 um"}, ball={"load": 5}, creep={"longitudinal": 0.001})


test_courses_that_cannot_be_are_refused = refusals(
    (turning, "600..x 1/min in 5 s", 'or a course as "600..1800 1/min in 5 s", with its unit'),
    (turning, "600..1800 in 5 s", "a frequency greater than 0"),
    (turning, "600..1800 1/min in 5", "Add the unit"),
    (turning, "0..1800 1/min in 5 s", "received '0 1/min'"),
    (turning, "600 1/min at 0 s, 700 1/min", 'Write points as "600 1/min at 0 s, 1800 1/min at 5 s"'),
    (turning, [[0.0, 10.0], [1.0]], 'Give pairs of time and speed, as [["0 s", "600 1/min"]'),
    (turning, [[0.0, 10.0], [0.0, 20.0]], "rising times, from zero on"),
    (turning, "none.csv", "There is no such file"),
    (turning, "0.001..1800 1/min in 5 s", "0.001 Hz to 10 kHz"),
    (lambda speed: turning(speed, duration="20 ms"), RUN_UP, "in which the slowest tone comes 5 times"),
    (
        lambda speed: turning(speed, radial=0.0, bearing=TIGHT),
        "600..90000 1/min in 5 s",
        "received up to 90000 1/min, which",
    ),
    (
        refused_track,
        "20..30 m/s in 1 s",
        "noise.receiver_distance: received a key of levels beside the track; allowed",
    ),
    (refused_creep, "1..3 m/s in 1 s", "one constant speed of what creeps"),
    of=lambda ask, speed: ask(speed),
    error=CaseError,
)


def test_the_page_reads_no_table_that_a_speed_names():
    values = {"speed": "/etc/speeds.csv", "radial": "100 N"}
    with pytest.raises(InputError, match="Write its points"):
        case_data("ball-bearing", values, lambda _: None)


def test_what_is_planned_of_a_run_up_says_of_which_speed_tones_are():
    """Smooth parts have no runs of their own."""
    rows, rows_at_one_speed = (
        dict(expected(prepare_bearing(turning(speed)))[0]) for speed in (RUN_UP, "1800 1/min")
    )
    assert rows["tones"] == rows_at_one_speed["tones"] + AT
    oil = {"oil": "ISO VG 68"}
    films = dict(expected(prepare_bearing(turning(RUN_UP, lubricant=oil, rotating="5 N")))[0])
    assert any(each.startswith("film, inner ring") and each.endswith(AT) for each in films)
    assert films["load that turns"].endswith(f"33.33 ms{AT}")
    assert rows["runs"] == "table, hertz"
