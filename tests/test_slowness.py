"""The guard against slowness tells pieces apart, and judges what is long enough to be judged."""

import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parents[1] / "benchmarks"))
from guard import CASES, ratios, rolled_in_turn, timed

from small_cases import COARSE


class Clockwork:
    """A tree whose pieces take known times, one after the other."""

    def __init__(self, *times):
        self.times = [{}, *times]
        self.asked = 0

    def time(self, case):
        self.asked += 1
        return self.times[self.asked - 1]


def test_what_looks_slower_gets_twice_the_rounds():
    before = Clockwork({"scan": 1.0}, {"scan": 1.0}, {"scan": 1.0}, {"scan": 1.0})
    after = Clockwork({"scan": 1.3}, {"scan": 1.2}, {"scan": 1.04}, {"scan": 1.2})
    assert ratios(*rolled_in_turn([before, after], "any", 2)) == {"scan": 1.04}
    assert after.asked == 5
    same = Clockwork({"scan": 1.0}, {"scan": 1.0})
    rolled_in_turn([same, Clockwork({"scan": 1.0}, {"scan": 1.1})], "any", 2)
    assert same.asked == 3


def test_a_run_is_told_apart_by_its_pieces():
    case = COARSE | {"laws": ["hertz"], "start": "0.2 m", "duration": "0.1 s"}
    times = timed(case)
    assert 0.0 < times["rolling"] < times["whole run"]


def test_its_cases_are_cases():
    from asperity.case.cases import as_case

    assert {as_case(case).kind for case in CASES.values()} == {"ball-on-beam", "wheel-on-rail"}
