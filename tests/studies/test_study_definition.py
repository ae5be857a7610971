"""What a study computes: keys with lists and ranges of values, in files, from Python, behind --vary."""

from pathlib import Path

import numpy as np
import pytest
from executors import BALL

import asperity
from asperity.case.cases import parse_case
from asperity.cli.studying import defined
from asperity.errors import CaseError, InputError
from asperity.studies.definition import TEMPLATE, expanded, load_study, separated, study_of
from refusals import refusals

SWEEP = 'case = "ball.toml"\n[sweep]\n'
SEEDS = {"seed": [1, 2]}


def study(text):
    Path("study.toml").write_text(text)
    return load_study("study.toml")


def test_the_template_is_a_study():
    Path("case.toml").write_text(BALL)
    assert study(TEMPLATE).sweep == {"speed": ["20 m/s", "56 m/s"], "seed": [1, 2, 3]}


@pytest.mark.parametrize(
    "written", ['"ball.load" = ["5 N"]', 'ball.load = ["5 N"]', '[sweep.ball]\nload = ["5 N"]']
)
def test_a_key_with_its_section_is_written_in_three_ways(written):
    found = study(SWEEP + written)
    assert found.sweep == {"ball.load": ["5 N"]}
    assert found.members()[0].case.ball.load == 5.0


def test_the_case_may_stand_in_the_study_and_need_its_swept_keys():
    base = 'case.kind = "ball-on-beam"\ncase.surface.hurst = 0.7\n'
    found = study(f'{base}[sweep]\n"surface.rms" = ["0.1 um", "0.2 um"]\n')
    assert [member.case.surface.rms for member in found.members()] == [1e-7, 2e-7]


def test_members_are_named_by_all_that_a_result_depends_on():
    keys = [member.key for member in study_of("ball.toml", {"speed": ["1 m/s", "2 m/s"]}).members()]
    assert len(set(keys)) == 2
    written_otherwise = study_of(parse_case(f"# again\n{BALL}"), {"speed": ["1000 mm/s"]}).members()
    assert written_otherwise[0].key == keys[0]
    Path("deep").mkdir()  # files are found from the case, and named by what they hold
    np.savetxt("deep/line.txt", np.zeros(9))
    Path("deep/case.toml").write_text(BALL.replace('spectrum = "iso3095"', 'line = "line.txt"'))
    found = study('case = "deep/case.toml"\n[sweep]\nseed = [1]\n')
    first = found.members()[0]
    assert first.case.surface.line.is_absolute()
    np.savetxt("deep/line.txt", np.ones(9))
    assert found.members()[0].key != first.key


def test_members_share_the_finest_grid_and_the_widest_window_that_any_was_given():
    """The contact of a heavy ball is wider: its window holds that of a light one, whose cells are in its."""
    rough = asperity.BallOnBeam(surface={"rms": "0.1 um"})
    loads = ["5 N", "100 N"]
    alone = [rough.with_(**{"ball.load": load}).contact for load in loads]
    assert alone[0].spacing < alone[1].spacing
    assert alone[0].window < alone[1].window
    shared = [member.case.contact for member in study_of(rough, {"ball.load": loads}).members()]
    assert {each.spacing for each in shared} == {alone[0].spacing}
    assert {each.window for each in shared} == {alone[1].window}
    bearing = asperity.BearingUnderLoad(axial=100, bearing={"name": "6205"})
    assert len(study_of(bearing, {"axial": ["50 N", "100 N"]}).members()) == 2


test_what_is_wrong_is_explained = refusals(
    ("", "study.toml: received an empty file"),
    ("# nothing", "case: received nothing; allowed: the path of a case"),
    ("case = 3", "case: received 3; allowed: the path of a case"),
    ("case = 'ball.toml'\nwhat = 1", "what: received an unknown key; allowed: case, [sweep] and"),
    ("case = [", "a study in TOML"),
    (SWEEP, "sweep: received nothing; allowed: a key with its values"),
    (f"{SWEEP}speeds = ['1 m/s']", 'sweep.speeds: received an unknown key.*Did you mean "speed"'),
    (f"{SWEEP}load = ['1 N']", 'sweep.load: .*unknown key.*Write it with its section, "ball.load"'),
    (f"{SWEEP}speed = []", "sweep.speed: received an empty list; allowed: one value or more"),
    (f"{SWEEP}speed = '1 m/s'", "sweep.speed: received '1 m/s'; allowed: a list of values"),
    (f"{SWEEP}speed = [1.0]", r"sweep.speed\[1\]: received 1.0; allowed: a speed.*Add unit"),
    (f"{SWEEP}speed = ['1 m/s', '1000 mm/s']", "sweep.speed: received '1000 mm/s' more than once"),
    (f"{SWEEP}seed = '1..2, 3 steps'", r"sweep.seed\[2\]: received 1.5"),
    (f"{SWEEP}laws = [['hertzz']]", r'sweep.laws\[1\]: received \'hertzz\'; .*Did you mean "hertz"'),
    (f"{SWEEP}kind = ['ball-on-beam']", "kind: received a swept key"),
    (f"{SWEEP}seed = [1]\n[[sweep.deep]]", "sweep.deep: received an unknown key"),
    (f"{SWEEP}speeds = ['1 m/s']\nseed = []", "study.toml: 2 errors"),
    (f"{SWEEP}seed = '1..200'\nspeed = '1..100 m/s, 100 steps'", "200 × 100 = 20000 members; allowed: at mo"),
    of=study,
)


def test_a_study_needs_a_valid_member_and_swept_keys_once():
    with pytest.raises(CaseError, match="start: received 2 m; allowed: a position on the beam"):
        asperity.study("ball.toml", {"start": ["2 m", "3 m"]})
    with pytest.raises(InputError, match="sweep: received keys for a study that has its own"):
        asperity.study(study_of("ball.toml", SEEDS), SEEDS)
    with pytest.raises(InputError, match="workers: received 0; allowed: a whole number greater than 0"):
        asperity.study("ball.toml", SEEDS, workers=0)


def test_ranges_have_steps_ratios_or_whole_numbers():
    """Behind --vary they stand beside other values."""
    words = ["speed = 80..300 km/h, 6 steps, 1 m/s", "seed=7, 1..3", "ball.load = 5 N, 10..80 N, 4 ratios"]
    speed, seed, load = defined("ball.toml", words, (), helps=False).axes
    assert speed.variable.values == pytest.approx([*np.linspace(80, 300, 6) / 3.6, 1.0])
    assert expanded("x", "600..1800 1/min, 3 steps") == ["600 1/min", "1200 1/min", "1800 1/min"]
    assert speed.variable.attrs["typed_unit"] == "km/h"
    assert seed.values == (7, 1, 2, 3)
    assert load.variable.values == pytest.approx([5, 10, 20, 40, 80])
    assert study_of("ball.toml", {"seed": "1..20"}).axes[0].values == tuple(range(1, 21))


@pytest.mark.parametrize(
    ("values", "separate"),
    [
        ("80, 135, 2e2 km/h", ["80 km/h", "135 km/h", "2e2 km/h"]),
        ("600,1.8e3 1/min", ["600 1/min", "1.8e3 1/min"]),
        ("-5, 0 dB", ["-5 dB", "0 dB"]),
        ("80, 20 m/s, 200 km/h", ["80", "20 m/s", "200 km/h"]),
        ("80, 100..200 km/h, 3 steps", ["80", "100..200 km/h, 3 steps"]),
        ("1, inf", ["1", "inf"]),
        ("1, 2.5e3", ["1", "2.5e3"]),
        ("areal, table", ["areal", "table"]),
    ],
)
def test_the_unit_of_the_last_value_is_that_of_bare_numbers_before_it(values, separate):
    """Where other units or ranges stand among them, each keeps what it has."""
    assert separated(values) == separate


@pytest.mark.parametrize(
    "value", ["../a..b.npy", "1..", "..", 3, None, "20 m/s", ["a"], "1" * 100_000 + "x"], ids=range(8)
)
def test_what_is_no_range_stays(value):
    """It is read in time that grows with its length."""
    assert expanded("x", value) == value


test_what_is_wrong_with_a_range_is_said = refusals(
    ("80..300 km/h", "a range with its number of values. Say how many, as '80..300 km/h, 6 steps'"),
    ("1..2, 1 steps", "two different ends and 2 to 10000 values. Both ends count"),
    ("0..1 m, 3 ratios", "ends above zero for equal ratios. Write steps instead"),
    ("1..1e999", "ends that a computer can hold"),
    ("1..20000", "a range with its number of values"),
    of=lambda value: expanded("x", value),
)
