"""``asperity bearing --oil``: films in its table, as a program reads them, and what it refuses."""

import json
from pathlib import Path

import pytest

from asperity.case.ball_bearing import BearingUnderLoad
from asperity.case.cases import as_case
from command_line import call, words_of

LOADED = ("--radial", "100 N", "--speed", "1800 1/min")
OIL = ("--oil", "ISO VG 68", "--temperature", "60 degC")


def films(*words):
    """What a program reads of the films."""
    return json.loads(call("bearing", *words, "--json").stdout)["films"]


def test_films_are_those_that_a_case_has_under_the_same_loads():
    oil = {"oil": "ISO VG 68", "temperature": "60 degC"}
    case = as_case({
        "kind": "ball-bearing", "radial": "100 N", "speed": "1800 1/min", "bearing": {"name": "6205"},
        "lubricant": oil,
    })  # fmt: skip
    assert isinstance(case, BearingUnderLoad)
    found = films("6205", *LOADED, *OIL)
    assert [each["ring"] for each in found] == ["inner", "outer"]
    for each, film, damping in zip(found, case.films, case.dampings, strict=True):
        load = each["load"]
        assert each["central"] == pytest.approx(film.central(load))
        assert each["least"] == pytest.approx(film.minimum(load))
        assert each["damping"] == pytest.approx(damping)
        assert each["outside"] == [*film.outside(load)]
    Path("case.toml").write_text(case.to_toml())
    again = films("case.toml")
    assert [each["damping"] for each in again] == pytest.approx([each["damping"] for each in found])
    assert films("case.toml", "--oil", "ISO VG 32")[0]["central"] < 0.8 * found[0]["central"]


def test_the_table_says_how_rough_surfaces_may_be():
    said = words_of(call("bearing", "6205", *LOADED, *OIL).stdout)
    assert "Films of oil, 24.7 mPa s at 60 °C, under the heaviest loads" in said
    assert "rms for Λ = 3, nm" in said
    assert "Films of oil" not in call("bearing", "6205", *LOADED).stdout
    assert films("6205", *LOADED) is None


@pytest.mark.parametrize(
    ("words", "told"),
    [
        (("--radial", "100 N", "--oil", "ISO VG 68"), "none of a bearing with oil"),
        ((*LOADED, "--oil", "ISO VG 67"), "ISO VG 68"),
        ((*LOADED, "--oil", "ISO VG 68", "--temperature", "70 K m"), "temperature"),
        ((*LOADED, "--temperature", "60 degC"), "oil"),
        ((*LOADED, *OIL, "--table", "a.csv"), "a signal, table, sheet or limits with it"),
    ],
)
def test_what_it_refuses(words, told):
    assert told in words_of(call("bearing", "6205", *words, code=2).output)
