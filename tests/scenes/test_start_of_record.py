"""A check foresees which levels a run finds low since resonances have not built up when the record starts."""

import re

import numpy as np
import pytest

import asperity
from asperity.case.cases import as_case, parse_case, template
from asperity.running import prepare_case
from asperity.scenes.start_of_record import ringing_along, start_foreseen
from command_line import call
from small_cases import COARSE

BRIEF = {"laws": ["linear"], "duration": "0.12 s", "settling": "50 ms"}
LINE = {"spectrum": "iso3095", "level": "-40 dB"}
RINGING = COARSE | BRIEF | {"surface": LINE}
ON_BEAM = RINGING | {"kind": "bodies", "body": RINGING["ball"]}
del ON_BEAM["ball"]
RUBBER = {"name": "uic60", "pad_stiffness": "40 MN/m", "pad_loss_factor": 1e-3, "rail_loss_factor": 1e-4}
ON_RAIL = BRIEF | {
    "kind": "wheel-on-rail", "speed": "20 m/s", "settling": "1 ms", "surface": LINE,
    "track": RUBBER, "wheel": {"section": "rigid"}, "contact": {"spacing": "1 mm"},
    "numerics": {"highest_frequency": "1 kHz", "kernel": "scatter"},
}  # fmt: skip


def foreseen(case):
    return list(start_foreseen(prepare_case(as_case(case))))


@pytest.mark.parametrize("case", [RINGING, ON_BEAM, ON_RAIL], ids=["ball", "bodies", "rail"])
def test_a_check_foresees_the_levels_that_a_run_finds_low(case):
    (finding,) = foreseen(case)
    bands, low = re.fullmatch(r"(.*), (up to [\d.]+ dB low)", finding.value).groups()
    verdict = asperity.run(as_case(case), brief=True).attrs["verdict"]
    assert f"Levels at {bands} are {low}: resonances there have not built up" in verdict


def test_the_settling_that_is_told_is_enough_and_not_much_more():
    (finding,) = foreseen(RINGING)
    (told,) = re.findall(r"Take a settling of ([\d.]+) s, with room for it", finding.remedy)
    assert not foreseen(RINGING | {"settling": float(told)})
    assert foreseen(RINGING | {"settling": 0.75 * float(told)})


def test_all_places_of_a_record_count_alike():
    """From either end the same is not built up; where a record begins and ends it is another."""
    prepared = prepare_case(as_case(RINGING))
    case = prepared.case
    start = case.record_start
    end = start + case.rolled_in(0.12)
    band = np.array([200.0, 400.0, 800.0])

    def not_built_up(*ends):
        found = ringing_along(prepared.scene, 2e7, ends, band)
        return [each.not_built_up(0.05, 0.12) for each in found]

    np.testing.assert_allclose(not_built_up(start, end), not_built_up(end, start), rtol=1e-9)
    assert not np.allclose(not_built_up(start, start), not_built_up(end, end), rtol=1e-3)


def test_nothing_is_low_where_nothing_vibrates():
    assert not foreseen(RINGING | {"surface": {"smooth": True}})


@pytest.mark.parametrize("kind", ["ball-on-beam", "bodies", "wheel-on-rail"])
def test_records_of_templates_start_when_resonances_have_built_up(kind):
    assert not list(start_foreseen(prepare_case(parse_case(template(kind)))))


def test_a_check_says_so(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "case.toml").write_text(as_case(RINGING).to_toml())
    said = call("check", "case.toml")
    assert "levels of bands that the start of the record makes low: " in said.stderr
