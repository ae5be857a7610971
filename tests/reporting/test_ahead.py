"""Figures drawn from what is known before anything has rolled."""

from dataclasses import replace

import pytest
from xarray import DataTree

from asperity.kinds import KINDS
from asperity.kinds.cases import as_case
from asperity.kinds.report import draw_all, parts_of
from asperity.reporting.ahead import drawn_ahead
from asperity.reporting.data import holds, noted, present, stated, values
from asperity.running import prepare_case, run
from asperity.schema import contact, rolling, surface
from asperity.schema.provenance import KIND, TITLE
from small_cases import CASES

BEFORE = {"scenario", "contact", "surface"}
OWN = {"wheel-on-rail": {"track"}}


@pytest.fixture(scope="module")
def told(cache_of_module):
    """What runs tell of their results on the way, and at their end, by kind."""

    def told_of(kind):
        ahead = []
        result = run(replace(prepare_case(as_case(CASES[kind])), ahead=ahead.append))
        return ahead, result

    return {kind: told_of(kind) for kind in KINDS}


@pytest.mark.parametrize("kind", KINDS)
def test_what_is_known_comes_bit_by_bit(told, kind):
    ahead, result = told[kind]
    own = OWN.get(kind, set())
    assert [set(tree.children) for tree in ahead] == [(BEFORE | own) - {"surface"}, BEFORE | own]
    for name in {"surface"} | own:
        assert ahead[-1][name].to_dataset().identical(result[name].to_dataset())
    assert ahead[-1]["contact"].to_dataset().equals(result["contact"].to_dataset())


@pytest.mark.parametrize("kind", KINDS)
def test_a_run_that_tells_ahead_has_the_same_result(told, kind):
    _, result = told[kind]
    alone = run(as_case(CASES[kind]))
    for name in set(alone.children) - {"scenario"}:  # which holds wall times
        assert result[name].to_dataset().identical(alone[name].to_dataset())
        assert list(result[name].attrs) == list(alone[name].attrs)
    assert {k: v for k, v in result.attrs.items() if k != "created"} == {
        k: v for k, v in alone.attrs.items() if k != "created"
    }


@pytest.mark.parametrize("kind", KINDS)
def test_figures_drawn_ahead_are_those_of_the_result(told, kind):
    ahead, result = told[kind]
    drawn = drawn_ahead(ahead[-1], parts_of(ahead[-1]), lambda: False)
    kept = {name for name, early in drawn.items() if holds(result, early.looks)}
    assert kept >= {"contact_pressure", "texture_path", "texture_psd"}
    assert kept >= {f"{part}" for part in ("receptance", "decay_rate") if kind in OWN}
    later = draw_all(result)
    assert {name: drawn[name].picture for name in kept} == {name: later[name] for name in kept}
    assert draw_all(result, ahead=drawn) == later


def test_no_more_is_drawn_when_something_else_waits(told):
    ahead, _ = told["ball-on-beam"]
    answers = iter([False, False, True])
    parts = parts_of(ahead[-1])
    assert list(drawn_ahead(ahead[-1], parts, lambda: next(answers))) == [part.name for part in parts[:2]]


def test_a_figure_that_another_result_says_otherwise_is_drawn_again(told):
    ahead, result = told["ball-on-beam"]
    drawn = drawn_ahead(ahead[-1], parts_of(ahead[-1]), lambda: False)
    other = DataTree.from_dict({node.path: node.to_dataset() for node in result.subtree})
    spectrum = other["surface"].to_dataset()
    other["surface"] = DataTree(
        spectrum.assign({surface.PSD_PATH.name: 2.0 * spectrum[surface.PSD_PATH.name]})
    )
    assert not holds(other, drawn["texture_psd"].looks)
    assert holds(other, drawn["contact_pressure"].looks)
    again = draw_all(other, ahead=drawn)
    assert again["texture_psd"].svg != drawn["texture_psd"].picture.svg
    assert again["contact_pressure"] == drawn["contact_pressure"].picture


def test_what_was_looked_at_is_noted(told):
    (before, _), result = told["ball-on-beam"]
    with noted() as looks:
        assert values(before, contact.FORCE).size
        assert not present(before, rolling.CONTACT_FORCE)
        assert stated(before, KIND) == "ball-on-beam"
        assert stated(before, TITLE) is None
    assert set(looks) == {contact.FORCE, rolling.CONTACT_FORCE, KIND, TITLE}
    assert holds(before, looks)
    assert not holds(result, looks)  # there is a force now, and a title
    assert holds(result, {asked: looks[asked] for asked in (contact.FORCE, KIND)})
    assert not holds(result, {rolling.CONTACT_FORCE: None})
    assert not holds(result, {TITLE: None})
    stated(result, TITLE)
    assert len(looks) == 4  # nothing is noted any more
