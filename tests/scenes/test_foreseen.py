"""What a run warns of before anything moves, its check warns of in the same words."""

import json

import pytest

import asperity
from asperity.case.cases import as_case
from asperity.cli.running import planned
from asperity.running import prepare_case
from small_cases import BEARING, HEARD

ON_RAIL = HEARD | {"kind": "wheel-on-rail", "duration": "0.1 s", "settling": "50 ms"}
TRAIN = {"vehicle_length": "26 m", "axle_positions": ["0 m", "2.5 m", "19 m"], "vehicle": "coach"}
DRAWN = ON_RAIL | {"wheel": {"section": "straight-web"}}


def foreseen(case):
    return [told["message"] for told in planned(prepare_case(as_case(case)))["warnings"]]


@pytest.mark.parametrize(("case", "begins"), [
    (BEARING, "At a fault hertz holds for a contact under "),
    (BEARING | {"laws": ["areal", "linear"]}, "At a fault areal and linear hold for a contact under "),
    (ON_RAIL, "the sound power from vibration is that of rail and sleepers alone: "),
    (ON_RAIL | {"noise": TRAIN},
     "the sound power from vibration is that of rail and sleepers alone; no limit of TSI Noise "),
], ids=["hertz", "areal", "rigid wheel", "limit"])  # fmt: skip
def test_a_check_warns_of_what_its_run_warns_of(case, begins):
    (told,) = [words for words in foreseen(case) if words.startswith(begins)]
    met = json.loads(asperity.run(as_case(case), brief=True).attrs["warnings"])
    assert told in [each["message"] for each in met]


@pytest.mark.parametrize("case", [
    BEARING | {"laws": ["table"]}, BEARING | {"fault": {}}, DRAWN,
    ON_RAIL | {"speed": "30..32 m/s in 0.1 s"},
], ids=["seen", "sound", "drawn wheel", "course"])  # fmt: skip
def test_nothing_is_foreseen_that_no_run_warns_of(case):
    assert not [words for words in foreseen(case) if words.startswith(("At a fault", "the sound power"))]
