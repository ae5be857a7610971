"""Ranges of swept keys in words, in study files, from Python and behind --vary."""

import numpy as np
import pytest

from asperity.cli.studying import varied
from asperity.errors import CaseError, InputError
from asperity.studies.definition import expanded, study_of

BALL = {"kind": "ball-on-beam", "surface": {"rms": "0.5 um"}}


def test_a_range_in_steps_has_its_ends_and_equal_distances():
    (axis,) = study_of(BALL, {"speed": "80..300 km/h, 6 steps"}).axes
    assert axis.coordinate == pytest.approx(np.linspace(80, 300, 6) / 3.6)
    assert axis.typed["typed_unit"] == "km/h"


def test_a_range_in_ratios_has_equal_ratios():
    (axis,) = study_of(BALL, {"ball.load": ["5 N", "10..80 N, 4 ratios"]}).axes
    assert axis.coordinate == pytest.approx([5, 10, 20, 40, 80])


def test_a_range_of_whole_numbers_needs_no_count():
    assert study_of(BALL, {"seed": "1..20"}).axes[0].values == tuple(range(1, 21))


def test_ranges_stand_behind_vary_beside_other_values(tmp_path):
    (tmp_path / "ball.toml").write_text('kind = "ball-on-beam"\n[surface]\nrms = "0.5 um"\n')
    words = ["speed = 1..2 m/s, 3 steps, 18 km/h", "seed=7, 1..3", "contact.spacing = 4..16 um, 3 ratios"]
    speed, seed, spacing = varied(tmp_path / "ball.toml", words).axes
    assert speed.coordinate == pytest.approx([1.0, 1.5, 2.0, 5.0])
    assert seed.values == (7, 1, 2, 3)
    assert spacing.coordinate == pytest.approx([4e-6, 8e-6, 16e-6])


@pytest.mark.parametrize("value", ["../a..b.npy", "1..", "..", 3, None, "20 m/s", ["a"]])
def test_what_is_no_range_stays(value):
    assert expanded("x", value) == value


@pytest.mark.parametrize(
    ("value", "message"),
    [
        ("80..300 km/h", "a range with its number of values. Say how many, as '80..300 km/h, 6 steps'"),
        ("5..1", "a range with its number of values"),
        ("1..2, 1 steps", "two different ends and 2 to 10000 values. Both ends count"),
        ("1..2, 99999 steps", "2 to 10000 values"),
        ("0..1 m, 3 ratios", "ends above zero for equal ratios. Write steps instead"),
        ("1..1e999", "ends that a computer can hold"),
        ("1..20000", "a range with its number of values"),
    ],
)
def test_what_is_wrong_with_a_range_is_said(value, message):
    with pytest.raises(InputError) as caught:
        expanded("x", value)
    assert message in str(caught.value)


def test_a_value_of_a_range_that_the_key_does_not_take_is_named():
    with pytest.raises(CaseError, match=r"sweep\.seed\[2\]: received 1\.5"):
        study_of(BALL, {"seed": "1..2, 3 steps"})


def test_a_range_is_read_in_time_that_grows_with_its_length():
    assert expanded("x", "1" * 100_000 + "x") == "1" * 100_000 + "x"
