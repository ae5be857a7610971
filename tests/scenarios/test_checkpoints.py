"""What outlives a computation: what `direct` found, for the same case and no other, and the results alone."""

import gc
import weakref

import numpy as np
import pytest

from asperity.case.cases import as_case
from asperity.case.form import content
from asperity.running import prepare_case, run
from asperity.scenarios import reducing
from asperity.scenarios.laws import ReducedCase
from asperity.scenes import compute
from small_cases import BALL, BEARING, CASES, WHEEL

FLAT = np.zeros((4, 3))


def name(case):
    """Name of what is kept of a case, on the same path."""
    return compute.checkpoint_of("direct", case, lambda: [FLAT], None).key


@pytest.mark.parametrize("kind", [*CASES, "ball-bearing"])
def test_every_key_of_a_case_but_its_laws_names_another_checkpoint(monkeypatch, kind):
    """Whichever keys there will be: a ball's rolled on with the grid of an earlier case."""
    case = content(as_case((CASES | {"ball-bearing": BEARING})[kind]))
    monkeypatch.setattr("asperity.scenes.compute.content", lambda values, *_: dict(values))
    told_of = [case | {key: "other"} for key in case.keys() & set(compute.TOLD_OF)]
    names = {name(each) for each in (case, case | {"laws": ["direct"]}, *told_of)}
    assert len(names) == 1
    changed = [case | {key: "other"} for key in case.keys() - set(compute.TOLD_OF)]
    for section in (key for key in case if isinstance(case[key], dict) and key not in compute.TOLD_OF):
        changed += [case | {section: case[section] | {key: "other"}} for key in case[section]]
    found = [name(each) for each in changed]
    assert len(found) > 40
    assert len({*names, *found}) == len(found) + 1


def recorded(monkeypatch, owner, name):
    """References to all that a function returns."""
    made, original = [], getattr(owner, name)

    def call(*arguments, **keywords):
        result = original(*arguments, **keywords)
        made.append(weakref.ref(result))
        return result

    monkeypatch.setattr(owner, name, call)
    return made


@pytest.mark.usefixtures("cache_of_module")
@pytest.mark.filterwarnings("ignore::asperity.errors.PhysicsWarning")
@pytest.mark.parametrize("case", [BALL, pytest.param(WHEEL, marks=pytest.mark.long)])
def test_laws_textures_and_state_functions_do_not_outlive_what_they_were_for(monkeypatch, case):
    gc.freeze()  # what other tests left is not sought through
    laws, states = recorded(monkeypatch, ReducedCase, "build"), recorded(monkeypatch, reducing, "reduce")
    computed = compute.compute(prepare_case(as_case(case)), lambda *_: None)
    gc.collect()
    assert set(computed.runs) == set(case["laws"])
    assert [law() for law in laws] == [None] * len(case["laws"])
    del computed
    assert "force_level" in run(case)["spectra"]
    gc.collect()
    assert [state() for state in states] == [None] * 2
