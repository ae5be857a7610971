"""What is expected of a scan before it starts is what it then takes."""

import pytest

from asperity.config import parse_case
from asperity.scenarios.ball_on_beam import compute
from asperity.scenarios.expecting import direct_time, expected_scans
from asperity.store import Store

CASE = """
kind = "ball-on-beam"
duration = "8 ms"
settling = "0 s"
laws = ["table"]
[surface]
rms = "0.05 um"
shortest = "40 um"
[contact]
spacing = "{spacing}"
window = "0.5 mm"
samples = 2
"""


@pytest.mark.filterwarnings("ignore:the record starts 0 ms")
@pytest.mark.parametrize("spacing", ["10 um", "6 um"])
def test_size_on_disk_and_number_of_positions(spacing, monkeypatch, tmp_path):
    """At 6 µm, an eighth of the patch is two rows."""
    monkeypatch.setenv("ASPERITY_CACHE", str(tmp_path))
    case = parse_case(CASE.format(spacing=spacing))
    expected = expected_scans(case)["path"]
    scanned = compute(case, lambda done, total, message: None).chain.scan
    states, positions = scanned.forces.shape
    assert states == expected.states
    assert expected.single == scanned.single
    assert positions <= expected.positions <= positions + 2
    files = [Store().path(key) for key in scanned.forces.keys]
    assert sum(file.stat().st_size for file in files) == pytest.approx(expected.bytes, rel=0.05)
    assert 0 < scanned.solved <= expected.solutions


def test_time_grows_with_the_path_and_the_grid():
    case = CASE.format(spacing="10 um")
    short = expected_scans(parse_case(case))
    long = expected_scans(parse_case(case.replace("8 ms", "80 ms")))
    fine = parse_case(case.replace("10 um", "5 um"))
    assert set(short) == {"filters", "path"}
    assert 8 < long["path"].seconds / short["path"].seconds < 10
    assert long["filters"] == short["filters"]
    longest = expected_scans(parse_case(case.replace("8 ms", "800 ms")))["path"]
    assert (short["path"].single, longest.single) == (False, True)
    assert 4 < longest.seconds / long["path"].seconds < 9
    assert direct_time(fine) > 1.5 * direct_time(parse_case(case))
