"""Paths are scanned at the states that a motion visits: forces are those of all states."""

import numpy as np
import pytest
from numpy.testing import assert_allclose

from asperity.laws.layout import force
from asperity.laws.table import Table
from asperity.reduction.stiffness import ForceTable
from asperity.running import prepare_case
from asperity.scenarios import scanned_states
from asperity.scenarios.scanned_states import states_around
from asperity.scenes.compute import compute
from small_cases import changed

STATES = np.cumsum(np.linspace(0.1, 0.3, 12)) * 1e-6  # m
ROLLED = {
    "held down": {"laws": ["table"]},
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
    whole, cut = (Table(ForceTable(forces[of], STATES[of], 0.0, 1e-5, touches)) for of in (slice(None), part))
    at = np.linspace(0.0, 29e-5, 200)
    for approach in np.linspace(*np.clip(visited, -1e-6, STATES[-1]), 9):
        assert_allclose(force(cut, at, approach), force(whole, at, approach), rtol=1e-12, atol=1e-12)


def rolled(monkeypatch, case, expected):
    monkeypatch.setattr(scanned_states, "EXPECTED", expected)
    computed = compute(prepare_case(case), lambda *_: None)
    return computed, computed.scanned


@pytest.mark.parametrize("name", ROLLED)
def test_a_motion_that_leaves_what_was_scanned_is_rolled_anew_over_more(own_cache, monkeypatch, name):
    case = changed("ball-on-beam", **ROLLED[name])
    every, whole = rolled(monkeypatch, case, (0.0, 1e9))
    few, states = rolled(monkeypatch, case, (0.98, 1.02))
    assert whole == slice(0, len(every.reduction.approaches))
    assert states.start > 0 if name == "held down" else states.start == 0
    assert few.scan.forces.shape[0] == states.stop - states.start < whole.stop
    assert few.scan.counts.solved < every.scan.counts.solved
    exact = every.first.contact_force
    assert (few.first.contact_force - exact).std() < 1e-3 * exact.std()
    assert bool(every.first.flights[0][0].size) == (name == "thrown off")
