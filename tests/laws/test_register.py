"""A law of the user's own: registered, rolled, in result, report and CSV; or refused."""

import json
import re
from dataclasses import dataclass, replace

import numpy as np
import pytest
from numpy.testing import assert_array_equal

from asperity import laws, report, run
from asperity.case.cases import as_case, parse_case, template
from asperity.errors import CaseError, InputError
from asperity.laws import LawSpec, Look, Need, Role, Variant, spec_of
from asperity.surfaces.cell_means import pressed_heights
from small_cases import CASES


@pytest.fixture
def registered():
    """``registered(law)`` registers a law until the end of the test."""
    added = []

    def register(law):
        laws.register(law)
        added.append(law.name)

    yield register
    for name in added:
        laws.unregister(name)


@dataclass
class Spring:
    """F = k s, evaluated from Python in every step; it pulls as well."""

    name: str
    stiffness: float
    at_rest: float
    load: float
    damping: float = 0.0

    def prepare(self, positions):
        return self

    def evaluate(self, step, approach):
        return self.load + self.stiffness * (approach - self.at_rest), self.stiffness

    def accept(self, step):
        pass

    restore, state, warn_of_flaws = accept, dict, staticmethod(lambda: None)


def build_twin(of):
    """The same force as `shifted`, by another name."""
    return laws.Shifted(of.curve, of.line, of.damping, of.name, of.line_at_load)


def build_spring(of):
    approach, stiffness = of.working_point
    return Spring(of.name, stiffness, approach, of.load, of.damping)


TWIN = LawSpec(
    "twin",
    "The force curve, shifted once more.",
    build_twin,
    {Need.SAMPLES, Need.FILTER},
    look=Look("#123456", (0, (2, 1)), "h"),
    variants=(Variant("bare", "Here without the filter.", {Need.SAMPLES}),),
)
SPRING = LawSpec("spring", "A spring without texture.", build_spring, may_pull=True)


def case(*names):
    return as_case(CASES["ball-on-beam"] | {"laws": names})


def test_a_law_of_the_test_runs_through_result_and_report(registered, tmp_path):
    registered(TWIN)
    registered(SPRING)
    names = ["twin", "twin-bare", "spring", "shifted", "shifted-unfiltered", "linear"]
    tree = run(case(*names))
    force = tree["rolling/contact_force"]
    assert list(force["law"].values) == names
    assert_array_equal(force.sel(law="twin"), force.sel(law="shifted"))
    assert_array_equal(force.sel(law="twin-bare"), force.sel(law="shifted-unfiltered"))
    assert float(force.sel(law="twin").std()) > 1e-3 * float(force.sel(law="twin").mean())
    spring, load = force.sel(law="spring"), tree["contact"].attrs["working_load"]
    assert float(spring.mean()) == pytest.approx(load, rel=0.1)
    assert float(spring.std()) < 0.2 * float(force.sel(law="linear").std())  # there is no texture in it
    entries = json.loads(tree["scenario"].attrs["laws"])
    assert [entry["name"] for entry in entries] == names
    assert [entry["may_pull"] for entry in entries] == [False, False, True, False, False, True]
    page = report(tree, tmp_path).read_text(encoding="utf-8")
    told = "<strong>twin-bare</strong>: The force curve, shifted once more. Here without the filter."
    assert page.index("<strong>twin</strong>") < page.index(told)
    (variable,) = re.findall(r"(--c\d+):#123456;", page)  # for light screens …
    assert page.count(f"{variable}:") >= 2  # … and another value for dark ones


def test_a_case_file_knows_it_while_it_is_registered(registered):
    text = 'kind = "ball-on-beam"\nlaws = ["twin"]\n[surface]\nrms = "0.04 um"'
    registered(TWIN)
    assert parse_case(text).laws == ("twin",)
    assert all('"twin", "twin-bare"' in template(kind) for kind in CASES)
    laws.unregister("twin")
    with pytest.raises(CaseError, match="laws"):
        parse_case(text)
    assert "twin" not in template("ball-on-beam")
    laws.register(TWIN)  # the fixture forgets it again


def test_what_a_law_needs_decides_where_it_may_stand(registered):
    registered(TWIN)
    registered(replace(SPRING, name="wide", needs={Need.SURFACE}))
    line = CASES["ball-on-beam"] | {"surface": {"spectrum": "iso3095"}}
    for law, told in (("twin", "without samples of the surface"), ("wide", "with a path given as a line")):
        with pytest.raises(CaseError, match=f'"{law}" {told}'):
            as_case(line | {"laws": [law]})


def changed(**changes):
    return lambda: replace(TWIN, **changes)


def added(**changes):
    return lambda: laws.register(replace(TWIN, **changes))


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (added(name="shifted"), "name of a law: received 'shifted'; allowed: a name that no other law has"),
        (added(name="linear", variants=()), "a name that no other law has"),
        (added(name="linear-", variants=()), "allowed: small letters and digits"),
        (added(role=Role.REFERENCE), 'role of law twin: received "reference", which the law direct has'),
        (lambda: laws.register(laws.Shifted), "allowed: an asperity.laws.LawSpec"),
        (lambda: laws.unregister("shifted"), "'shifted'; allowed: a law that was registered (none is)"),
        (lambda: laws.spec_of("shiftd"), 'allowed: "areal", "shifted"'),
        (lambda: laws.spec_of("shiftd"), 'Did you mean "shifted"?'),
        (lambda: laws.needs_of(["areal", 3]), "law: received 3; allowed:"),
        (changed(name="My law"), "name of a law: received 'My law'; allowed: small letters and digits"),
        (changed(name=3), "name of a law: received 3"),
        (changed(meaning="no sentence"), "meaning of law twin: received 'no sentence'; allowed: one line"),
        (changed(build="Shifted"), "build of law twin: received 'Shifted'; allowed: a function of the mat"),
        (changed(needs={"patience"}), "needs of law twin: received {'patience'}; allowed: a set of \"sam"),
        (changed(normalise="none"), "normalise of law twin: received 'none'; allowed: \"tangent\" or"),
        (changed(variants=(Variant("Not So", "So.", set()),)), "name of a law: received 'twin-Not So'"),
        (changed(parameters={"one": 1.0}), "parameters of law twin"),
        (lambda: Look(colour="blue"), "colour of a law: received 'blue'; allowed: six digits and letters"),
    ],
)
def test_what_is_no_law_or_taken_is_refused(call, message):
    before = laws.names()
    with pytest.raises(InputError, match=re.escape(message)):
        call()
    assert laws.names() == before


def test_a_variant_has_a_role_of_its_own():
    roles = {"linear-filtered": Role.PRACTICE, "linear": Role.BARE, "shifted-unfiltered": None}
    assert {name: spec_of(name).role for name in roles} == roles


def test_a_variant_may_not_take_a_name_either(registered):
    registered(replace(SPRING, name="twin-bare"))
    with pytest.raises(InputError, match="'twin-bare'"):
        laws.register(TWIN)
    assert "twin" not in laws.names()


@pytest.mark.parametrize(
    ("build", "message"),
    [
        (lambda m: m.curve, "materials of law spring: received curve; allowed: materials that it needs"),
        (lambda m: m.datum, "received datum"),
        (lambda m: m.areal, "received areal"),
        (lambda m: m.table, "received table"),
        (lambda m: m.heights, "received heights"),
        (lambda m: m.plane, "received plane"),
        (lambda m: 3.0, "law spring: received 3.0; allowed: an object with name, damping and prepare"),
        (lambda m: laws.HertzLaw(m.hertz_constant), "law spring: received one built as 'hertz'"),
    ],
)
def test_a_law_that_is_not_built_as_it_says_is_told(build, message, registered):
    registered(replace(SPRING, build=build))
    with pytest.raises(InputError, match=re.escape(message)):
        run(case("spring"))


def test_materials_are_what_they_say(registered):
    """Filtered where the law needs the filter, in the units and shapes that the protocol states."""
    seen, every = {}, frozenset(Need)

    def build(materials):
        seen[materials.name] = materials
        return build_spring(materials)

    filtering = (Variant("f", "So.", every),)
    registered(replace(SPRING, build=build, needs=every - {Need.FILTER}, variants=filtering))
    run(case("spring", "spring-f"))
    assert seen["spring"].cells == "covered"
    pressed = seen["spring"].heights
    run(case("spring", "spring-f").with_(contact={"rim_cells": "whole"}))
    bare, filtered = seen["spring"], seen["spring-f"]
    assert bare.cells == "whole"
    assert bare.line.heights.shape[0] == 1 < filtered.line.heights.shape[0]
    assert np.std(filtered.line.heights[0]) < np.std(bare.line.heights[0])
    assert filtered.line_at_load.heights.shape == bare.line.heights.shape
    rows, ny = bare.heights.shape
    assert (rows, ny) == (bare.line.heights.shape[1], bare.body.shape[1])
    assert bare.heights[:, ny // 2] == pytest.approx(-bare.line.heights[0], abs=1e-15)
    inside = slice(2, -2)  # beyond the ends other heights are known
    np.testing.assert_allclose(
        pressed[inside, inside], pressed_heights(bare.heights)[inside, inside], atol=1e-15
    )
    approach, stiffness = bare.working_point
    assert bare.hertz_constant * approach**1.5 == pytest.approx(bare.load, rel=1e-9)
    assert stiffness == pytest.approx(1.5 * bare.load / approach, rel=1e-9)
    assert bare.datum >= -float(bare.curve.first_touch)
    assert bare.table.forces.shape[0] == len(bare.table.approaches)
