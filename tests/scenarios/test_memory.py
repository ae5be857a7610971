"""What is still held when a case was computed: its results, and nothing that they were made from."""

import gc
import weakref

import pytest

from asperity.case.cases import as_case
from asperity.running import prepare_case, run
from asperity.scenarios.laws import LawMaterials
from asperity.scenes import compute as ball_on_beam
from asperity.scenes import compute as wheel_on_rail
from small_cases import BALL, WHEEL

pytestmark = [
    pytest.mark.usefixtures("cache_of_module"),
    pytest.mark.filterwarnings("ignore::asperity.errors.PhysicsWarning"),
]


def quiet(done, total, message):
    """A progress that nobody sees."""


def recorded(monkeypatch, owner, name):
    """References to all that a function returns."""
    made, original = [], getattr(owner, name)

    def call(*arguments, **keywords):
        result = original(*arguments, **keywords)
        made.append(weakref.ref(result))
        return result

    monkeypatch.setattr(owner, name, call)
    return made


def test_laws_are_not_held_once_they_are_rolled(monkeypatch):
    laws = recorded(monkeypatch, LawMaterials, "build")
    computed = ball_on_beam.compute(prepare_case(as_case(BALL)), quiet)
    gc.collect()
    assert set(computed.runs) == set(BALL["laws"])
    assert len(laws) == len(BALL["laws"])
    assert [law() for law in laws] == [None] * len(laws)


@pytest.mark.parametrize(("kind", "case"), [(ball_on_beam, BALL), (wheel_on_rail, WHEEL)])
def test_textures_and_state_functions_do_not_outlive_the_computation(monkeypatch, kind, case):
    states = recorded(monkeypatch, kind, "reduce")
    result = run(case)
    gc.collect()
    assert "force_level" in result["spectra"]
    assert [state() for state in states] == [None]
