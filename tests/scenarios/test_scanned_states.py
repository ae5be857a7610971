"""Paths are scanned at the states that a motion visits, and where waves want it: levels are those of all."""

from dataclasses import replace

import numpy as np
import pytest

from asperity.contact.scan import scan_forces
from asperity.errors import ComputationError
from asperity.laws.layout import force
from asperity.laws.table import Table
from asperity.reduction.stiffness import ForceTable
from asperity.running import prepare_case
from asperity.scenarios import laws, reducing, scanned_states
from asperity.scenarios.preparing import scan_sizes, scans_of
from asperity.scenarios.scanned_states import FEWEST, states_apart, states_around
from asperity.scenes.compute import compute
from asperity.spectra import band_levels, psd
from small_cases import changed

TEXTURES = {
    "ball-on-beam": {"rms": "0.3 um", "longest": "0.4 mm"},
    "wheel-on-rail": {"spectrum": "iso3095", "level": "+10 dB"},
}
FINE = {"ball-on-beam": {}, "wheel-on-rail": {"spacing": "0.5 mm"}}
STATES = np.cumsum(np.linspace(0.1, 0.3, 12)) * 1e-6  # m
TABLE = {"laws": ["table"], "duration": "8 ms"}
ROLLED = {
    "held down": TABLE,
    "thrown off": {"laws": ["table"], "surface": {"rms": "0.1 um"}, "ball": {"load": "5 N"}},
}


@pytest.mark.parametrize(
    "visited",
    [
        (STATES[3], STATES[3]),
        (STATES[4] + 2e-8, STATES[4] + 4e-8),
        (0.9e-6, 1.1e-6),
        (0.0, 3e-6),
        (-1e-6, 0.3e-6),
    ],
)
def test_between_the_approaches_visited_the_force_is_that_of_all_states(visited):
    rng = np.random.default_rng(3)
    touches = rng.uniform(-0.1e-6, 0.1e-6, 30)
    over = np.maximum(STATES[:, None] - touches, 0.0)
    forces = 1e9 * over**1.5 * (1.0 + 0.2 * np.sin(over / 0.4e-6))
    part = states_around(STATES, visited)
    assert part.stop - part.start >= scanned_states.FEWEST
    whole, cut = (Table(ForceTable(forces[of], STATES[of], 0.0, 1e-5, touches)) for of in (slice(None), part))
    at = np.linspace(0.0, 29e-5, 200)
    for approach in np.linspace(*np.clip(visited, -1e-6, STATES[-1]), 9):
        off, exact = force(cut, at, approach) - force(whole, at, approach), force(whole, at, approach)
        assert off.std() <= 0.01 * exact.std()  # 0.1 dB


def test_every_other_state_is_left_out_where_those_beside_it_tell_its_force():
    approaches = np.linspace(0.5e-6, 5e-6, 11)
    touches = np.array([[0.0], [0.2e-6], [0.4e-6]])
    straight = 1e9 * (approaches - touches) ** 1.5
    assert states_apart(approaches, straight) == [0, 2, 4, 6, 8, 10]
    assert states_apart(approaches[1:], straight[:, 1:]) == [0, 1, 3, 5, 7, 9]  # the highest counts
    bent = straight * (1.0 + np.maximum(1.0 - approaches / 2e-6, 0.0) ** 2)
    assert states_apart(approaches, bent) == [0, 1, 2, 3, 4, 5, 6, 8, 10]  # slopes reach one state farther
    one = np.stack([straight[0], straight[0], bent[0]])  # one sample is enough
    assert states_apart(approaches, one)[:3] == [0, 1, 2]
    both = np.stack([bent[0], 2.0 * straight[0] - bent[0]])  # errors do not make good for each other
    assert states_apart(approaches, both)[:3] == [0, 1, 2]
    apart = 1e9 * np.maximum(approaches - 1.2e-6, 0.0) ** 1.5  # nothing is known before it touches
    assert states_apart(approaches, apart[None])[:3] == [0, 1, 2]
    assert states_apart(approaches[:4], straight[:, :4]) == [0, 1, 2, 3]


def looked_up(kind, **contact):
    """States of a case on covered cells that may be looked up, and all of them."""
    surface = {"surface": TEXTURES[kind]} if kind == "wheel-on-rail" else {}
    keys = {"laws": ["table"], "contact": FINE[kind] | {"rim_cells": "covered"} | contact}
    case = laws.reduced_case(prepare_case(changed(kind, **keys | surface)), lambda *_: None)
    return case.to_look_up, case.reduction.approaches.tolist()


@pytest.mark.filterwarnings("ignore::asperity.errors.TruncatedContactWarning")  # of the filters, seldom
def test_states_are_left_out_on_a_rail_alone_and_none_of_those_that_are_given(own_cache):
    """A beam rings with what its forces are off by: 1.7 % of the dynamic force of a smooth ball, 0.5 dB."""
    few, states = looked_up("wheel-on-rail")
    assert FEWEST <= len(few) < len(states)
    for every, among in (looked_up("wheel-on-rail", approaches=states), looked_up("ball-on-beam")):
        assert every == list(range(len(among)))


@pytest.mark.parametrize(("kind", "every"), [("wheel-on-rail", 2), ("ball-on-beam", 1)])
def test_a_plan_leaves_states_out_as_its_run_does(kind, every):
    states = np.linspace(0.0, 1e-6, reducing.STATES)
    keys = {"laws": ["table"], "surface": TEXTURES[kind], "contact": FINE[kind] | {"rim_cells": "covered"}}
    (job,) = scans_of(prepare_case(changed(kind, **keys)), states)["path"]
    assert len(job.approaches) >= FEWEST
    np.testing.assert_allclose(np.diff(job.approaches), every * states[1])


@pytest.mark.filterwarnings("ignore::asperity.errors.TruncatedContactWarning")  # of the filters, seldom
def test_a_wheel_over_every_other_state_has_the_levels_of_one_over_all(own_cache, monkeypatch):
    textures = {"surface": TEXTURES["wheel-on-rail"], "contact": FINE["wheel-on-rail"]}
    case = changed("wheel-on-rail", laws=["table"], **textures)
    prepared = prepare_case(case)
    expected = scan_sizes(prepared)["path"]
    few = compute(prepared, lambda *_: None)
    at_first = replace(few, states=None)
    more = len(at_first.to_look_up[at_first.scanned]) - expected.states
    assert more in (0, 1)  # where its samples are bent, which the plan does not know
    assert few.scan.forces.shape[1] == expected.positions
    assert few.shape.cells != few.cells_of_heights == "covered"
    monkeypatch.setattr(laws, "states_apart", lambda approaches, _: list(range(len(approaches))))
    every = compute(prepare_case(case), lambda *_: None)
    assert len(few.to_look_up[few.scanned]) < len(every.to_look_up[every.scanned])
    off = few.force_levels[0] - every.force_levels[0]
    assert 0.0 < np.sqrt(np.mean(off**2)) < 0.03


def rolled(monkeypatch, case, expected):
    monkeypatch.setattr(scanned_states, "EXPECTED", expected)
    computed = compute(prepare_case(case), lambda *_: None)
    return computed, computed.scanned


@pytest.mark.parametrize("name", ROLLED)
def test_a_motion_that_leaves_what_was_scanned_is_rolled_anew_over_more(own_cache, monkeypatch, name):
    case = changed("ball-on-beam", **ROLLED[name])
    every, whole = rolled(monkeypatch, case, (0.0, 1e9))
    asked: list[float] = []
    monkeypatch.setattr(
        laws, "scan_forces", lambda job, **how: asked.append(job.approaches[0]) or scan_forces(job, **how)
    )
    few, states = rolled(monkeypatch, case, (0.98, 1.02))
    assert sorted(asked) == few.reduction.approaches[few.to_look_up[states]].tolist()  # each once
    assert whole == slice(0, len(every.to_look_up))
    assert states.start > 0 if name == "held down" else states.start == 0
    assert few.scan.forces.shape[0] == states.stop - states.start < whole.stop
    assert few.scan.counts.solved < every.scan.counts.solved
    exact = every.first.contact_force
    assert (few.first.contact_force - exact).std() < 1e-3 * exact.std()
    assert bool(every.first.flights[0][0].size) == (name == "thrown off")


@pytest.mark.filterwarnings("ignore::asperity.errors.PhysicsWarning")  # so rough that windows are filled
@pytest.mark.parametrize("seed", [1, 8])
def test_a_motion_that_the_states_scanned_do_not_carry_is_rolled_over_all(own_cache, monkeypatch, seed):
    """Under one seed none of the states expected touches at the start, under the other motion goes beyond."""
    keys = {"surface": {"rms": "2 um"}, "ball": {"load": "5 N"}, "settling": "0 s", "seed": seed}
    case = changed("ball-on-beam", **TABLE, **keys)
    every, whole = rolled(monkeypatch, case, (0.0, 1e9))
    few, states = rolled(monkeypatch, case, (0.75, 1.25))
    assert states == whole
    np.testing.assert_array_equal(few.first.contact_force, every.first.contact_force)


def test_what_fails_over_all_states_fails(own_cache, monkeypatch):
    def fail(*_, **__):
        raise ComputationError("no rest", "another load")

    monkeypatch.setattr("asperity.scenes.compute.roll_bodies", fail)
    with pytest.raises(ComputationError, match="no rest"):
        compute(prepare_case(changed("ball-on-beam", **TABLE)), lambda *_: None)


def level(heights, step, highest):
    """One-third-octave levels of heights, m, that are passed every so many seconds, up to a frequency, Hz."""
    return band_levels(*psd(heights, step, segment=len(heights) // 2), 1e-6, high=highest)[1]


@pytest.mark.parametrize("kind", TEXTURES)
def test_positions_as_far_apart_as_patch_and_waves_let_them_be_have_the_levels_of_every_row(kind):
    keys = {"surface": TEXTURES[kind], "contact": FINE[kind], "duration": "20 ms", "settling": "0 s"}
    case = changed(kind, laws=["table"], **keys)
    prepared = prepare_case(case)
    shape, highest = prepared.shape, case.numerics.highest_frequency
    planes = reducing.patch_planes(prepared.textures.path, shape)[shape.body.shape[0] // 2 :]
    job = scans_of(prepared, shape.hertz.approach(reducing.nominal_forces(shape)))["path"][0]
    job = replace(job, approaches=job.approaches[1:2], anchor=0)

    def felt(stride):
        count = replace(job, stride=stride).positions
        felt = planes[: count * stride : stride]
        forces = scan_forces(replace(job, stride=stride, planes=felt)).forces
        table = ForceTable(forces, job.approaches, 0.0, stride, np.zeros(count))
        rows = np.arange((count - 1) * stride)
        softness = 1.0 / shape.hertz.tangent_stiffness(job.approaches[0])
        return planes[: len(rows)] + softness * table.at(rows)[:, 0]

    few, every = felt(job.stride), felt(1)
    assert job.stride > 1
    step = shape.spacing[0] / case.speed
    off = np.subtract(*(level(each[: len(few)], step, highest) for each in (few, every)))
    assert 0.0 < np.sqrt(np.mean(off**2)) < 0.1
