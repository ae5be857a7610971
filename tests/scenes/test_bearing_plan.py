"""What a check says that a bearing takes: contacts that are solved, cells at rims, what is compiled."""

import json

import pytest

import asperity
from asperity.case.cases import as_case
from asperity.running import prepare_case
from asperity.scenarios import compiling, raceway_laws, run_time
from asperity.scenarios.prepared_bearing import CELL_TIME, expected, prepare_bearing, raceways_of
from small_cases import BEARING

BALLS = 9


def test_the_time_told_counts_the_contacts_that_are_solved_over_faults(monkeypatch):
    """By the law and with the fault alone, in every position at which the window holds something of it."""
    solved, gap_over = [], raceway_laws.OnRaceway._over

    def counted(self, at):
        solved.append(self.shape.body.size)
        return gap_over(self, at)

    monkeypatch.setattr(raceway_laws.OnRaceway, "_over", counted)
    case = as_case(BEARING | {"duration": "60 ms"})
    ready = prepare_case(case)
    _, work = expected(ready)
    assert not solved
    asperity.run(ready)
    assert len(solved) > 100
    told = work.time.parts["contacts over the faults"] / (CELL_TIME * run_time.pace())
    assert 0.95 * sum(solved) < told <= (1 + 1e-9) * sum(solved)  # a few more hold what areal takes them for
    _, work = expected(prepare_case(case.with_(fault=None)))
    assert work.time.parts["contacts over the faults"] == 0.0


def test_a_plan_says_how_cells_at_rims_count_and_compiles_both_kinds(monkeypatch):
    """On the damaged raceway they are whole; laws that do not see heights have no others."""
    monkeypatch.setattr(compiling, "is_kept", lambda kernel: kernel == compiling.ROLLING)
    case = as_case(BEARING | {"laws": ["table"]})
    rows, work = expected(prepare_case(case))
    told = [text for name, text in rows if name == "cells at rims"]
    assert told == ["covered on the inner raceway", "whole on the outer raceway"]
    rows, blind = expected(prepare_case(case.with_(laws=["hertz"])))
    assert "cells at rims" not in dict(rows)
    longer = work.compiling - blind.compiling
    assert longer == pytest.approx(run_time.pace() * compiling.CELLS_TIME["covered"])


def test_a_raceway_knows_the_ball_that_carries_least():
    """On it hangs how far apart positions of its scan may lie."""
    across = prepare_case(as_case({**BEARING, "radial": "100 N", "axial": "0 N"}))
    along = prepare_case(as_case({**BEARING, "radial": "0 N", "axial": "100 N"}))
    for prepared, alike in ((across, False), (along, True)):
        static = prepared.case.static
        ons = raceways_of(prepared, None)
        assert [each.least_load for each in ons] == [static.inner_load.min(), static.outer_load.min()]
        assert all((each.least_load >= 0.5 * each.load) is alike for each in ons)


def test_surfaces_of_parts_alone_are_those_of_the_whole_bearing():
    wavy = {"waviness": "10 nm"}
    whole = prepare_bearing(as_case(BEARING | {"inner_raceway": wavy, "balls": wavy}))

    def taken(**changes):
        alone = prepare_bearing(whole.case.with_(**changes), beside=whole)
        return [each in {*whole.raceways, *whole.balls} for each in (*alone.raceways, *alone.balls)]

    assert taken() == [True] * (2 + BALLS)
    assert taken(balls=None) == [True, True]
    assert taken(fault=None) == [True, False] + [True] * BALLS
    assert taken(inner_raceway=None, fault={"on": "ball"}) == [False, False, False] + [True] * (BALLS - 1)
    assert taken(seed=2) == [False] * (2 + BALLS)


def test_what_is_told_of_a_law_that_solves_every_step_is_at_most_all_balls_on_both_rings():
    """On the inner ring as many as carry at any angle of the cage, on the outer one all of them."""
    case = as_case(BEARING | {"laws": ["direct"], "duration": "60 ms"})
    touching = case.static.touching
    assert touching.min() < touching.max() < BALLS
    _, work = expected(prepare_case(case))
    assert work.solutions == {"direct": work.steps * (int(touching.max()) + BALLS)}


@pytest.fixture(scope="module")
def solved():
    return asperity.run(BEARING | {"laws": ["table", "areal"], "duration": "50 ms"}, brief=True)


def test_a_pit_that_is_solved_strikes_much_as_its_average_under_the_contact(solved):
    """It is narrower than the contact, and the load is near that for which the average is exact."""
    found = solved["bearing"]
    table, areal = found["band_velocity"].values[:, 0]
    assert table == pytest.approx(areal, rel=0.05)
    assert abs(table[2] / areal[2] - 1.0) > 1e-6  # it is another computation
    assert found["lines_found"].values[:, 0].tolist() == [1.0, 1.0]


def test_a_result_says_how_cells_at_rims_counted_as_its_plan_does(solved, runs):
    """A law that sees no heights has none."""
    seen, blind = (
        [
            row["value"]
            for row in json.loads(tree["scenario"].attrs["numerics"])
            if row["name"] == "cells at rims"
        ]
        for tree in (solved, runs(BEARING))
    )
    assert seen == ["covered on the inner raceway", "whole on the outer raceway"]
    assert blind == []
