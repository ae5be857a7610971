"""What is kept of a law that is solved in every step is found again by the same case, and by no other."""

from types import SimpleNamespace

import numpy as np
import pytest

from asperity.case.cases import as_case
from asperity.case.content import content
from asperity.scenes.compute import TOLD_OF, checkpoint_of
from small_cases import CASES

DIRECT = SimpleNamespace(name="direct")
FLAT = np.zeros((4, 3))
PATH = SimpleNamespace(rows=lambda first, last: FLAT[first:last], shape=FLAT.shape)


def name(monkeypatch, values):
    """Name of what is kept of a case, by all that it says, on the same path."""
    monkeypatch.setattr("asperity.scenes.compute.content", lambda *_: dict(values))
    prepared = SimpleNamespace(case=None, textures=SimpleNamespace(path=PATH, surface=PATH))
    return checkpoint_of(DIRECT, prepared, None).key


@pytest.mark.parametrize("kind", CASES)
def test_every_key_of_a_case_but_its_laws_names_another_checkpoint(monkeypatch, kind):
    """Whichever keys there will be: a ball's rolled on with the grid of an earlier case."""
    case = content(as_case(CASES[kind]))
    names = {name(monkeypatch, case), name(monkeypatch, case | {"laws": ["direct"]})}
    assert len(names) == 1
    told_of = [case | {key: "other"} for key in case.keys() & set(TOLD_OF)]
    assert {name(monkeypatch, each) for each in told_of} == names
    changed = [case | {key: "other"} for key in case.keys() - set(TOLD_OF)]
    for section in (key for key in case if isinstance(case[key], dict) and key not in TOLD_OF):
        changed += [case | {section: case[section] | {key: "other"}} for key in case[section]]
    found = [name(monkeypatch, each) for each in changed]
    assert len(found) > 40
    assert len({*names, *found}) == len(found) + 1


def test_a_ball_that_rolls_directly_on_another_grid_starts_anew(tmp_path, monkeypatch):
    """Though its path be the same: a measured one may have the same heights on two grids."""
    monkeypatch.setenv("ASPERITY_CACHE", str(tmp_path))
    case = as_case(CASES["ball-on-beam"])
    textures = SimpleNamespace(path=PATH, surface=PATH)
    keys = {
        checkpoint_of(DIRECT, SimpleNamespace(case=each, textures=textures), None).key
        for each in (case, case.with_(**{"contact.spacing": "10 um"}), case.with_(laws=("direct",)))
    }
    assert len(keys) == 2
