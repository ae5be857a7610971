"""A law of the user's own: registered, rolled by both kinds, in result, report and CSV; or refused."""

import csv
import json
import re
from dataclasses import dataclass, replace

import numpy as np
import pytest
from numpy.testing import assert_array_equal

from asperity import laws
from asperity.case.cases import as_case, parse_case, template
from asperity.errors import CaseError, InputError
from asperity.laws import LawSpec, Look, Need, Role, Variant
from asperity.running import run
from asperity.scenes.report import report
from small_cases import CASES


@pytest.fixture
def registered():
    """``registered(law)`` registers a law until the end of the test."""
    added = []

    def register(law):
        laws.register(law)
        added.append(law.name)
        return law

    yield register
    for name in added:
        laws.unregister(name)


@dataclass(frozen=True)
class Stepped:
    """F = k s, evaluated from Python in every step; it pulls as well."""

    name: str
    stiffness: float
    approach: float
    load: float
    damping: float = 0.0

    def prepare(self, positions):
        return OnPath(self)


@dataclass
class OnPath:
    law: Stepped
    accepted: int = 0

    def evaluate(self, step, approach):
        law = self.law
        return law.load + law.stiffness * (approach - law.approach), law.stiffness

    def accept(self, step):
        self.accepted += 1

    def state(self):
        return {}

    def restore(self, state):
        pass

    def warn_of_flaws(self):
        pass


def build_twin(materials):
    """The same force as `shifted`, by another name."""
    return laws.Shifted(
        materials.curve, materials.line, materials.damping, materials.name, materials.line_at_load
    )


def build_spring(materials):
    approach, stiffness = materials.working_point
    return Stepped(materials.name, stiffness, approach, materials.load, materials.damping)


TWIN = LawSpec(
    "twin",
    "The force curve, shifted once more.",
    build_twin,
    frozenset({Need.SAMPLES, Need.FILTER}),
    look=Look("#123456", (0, (2, 1)), "h"),
    variants=(Variant("bare", "Here without the filter.", frozenset({Need.SAMPLES})),),
)
SPRING = LawSpec("spring", "A spring without texture.", build_spring, may_pull=True)


def case(kind, *names):
    return as_case(CASES[kind] | {"laws": names})


@pytest.mark.parametrize("kind", ["ball-on-beam", "wheel-on-rail"])
def test_a_law_of_the_test_runs_through_result_report_and_csv(kind, registered, tmp_path):
    registered(TWIN)
    registered(SPRING)
    names = ["twin", "twin-bare", "spring", "shifted", "shifted-unfiltered", "linear"]
    tree = run(case(kind, *names))
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
    for entry in entries:
        assert f"<strong>{entry['name']}</strong>: {entry['meaning']}" in page
    assert page.index("<strong>twin</strong>") < page.index("<strong>twin-bare</strong>")
    assert "The force curve, shifted once more. Here without the filter." in page
    (variable,) = re.findall(r"(--c\d+):#123456;", page)  # for light screens …
    assert page.count(f"{variable}:") >= 2  # … and another value for dark ones
    told = json.loads(re.search(r'id="charts">(.*?)</script>', page, re.DOTALL)[1])
    marks = [mark for panel in told["charts"]["force_bands"]["panels"] for mark in panel["marks"]]
    assert variable in [mark["colour"] for mark in marks if mark.get("law") == "twin"]
    with open(tmp_path / "force_bands.csv", encoding="utf-8", newline="") as file:
        rows = list(csv.reader(line for line in file if not line.startswith("#")))
    columns = [cell for row in rows[:3] for cell in row]
    for name in names:
        assert f"{name} [dB re 1 N]" in columns


def test_a_case_file_knows_it_while_it_is_registered(registered):
    text = 'kind = "ball-on-beam"\nlaws = ["twin"]\n[surface]\nrms = "0.04 um"'
    with pytest.raises(CaseError, match="laws"):
        parse_case(text)
    registered(TWIN)
    assert parse_case(text).laws == ("twin",)
    for kind in CASES:
        assert '"twin", "twin-bare"' in template(kind)
    laws.unregister("twin")
    with pytest.raises(CaseError, match="laws"):
        parse_case(text)
    assert "twin" not in template("ball-on-beam")
    laws.register(TWIN)  # the fixture forgets it again


def test_what_a_law_needs_decides_where_it_may_stand(registered):
    registered(TWIN)
    registered(replace(SPRING, name="wide", needs=frozenset({Need.SURFACE})))
    line = CASES["ball-on-beam"] | {"surface": {"spectrum": "iso3095"}}
    with pytest.raises(CaseError, match='"twin" without samples of the surface'):
        as_case(line | {"laws": ["twin"]})
    with pytest.raises(CaseError, match='"wide" with a path given as a line'):
        as_case(line | {"laws": ["wide"]})


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"name": "shifted"}, "name of a law: received 'shifted'; allowed: a name that no other law has"),
        (
            {"name": "linear-filtered"},
            "name of a law: received 'linear-filtered'; allowed: a name that no other",
        ),
        ({"name": "shifted", "variants": ()}, "a name that no other law has"),
        ({"role": Role.REFERENCE}, 'role of law twin: received "reference", which the law direct has'),
    ],
)
def test_what_is_taken_is_refused(changes, message):
    before = laws.names()
    with pytest.raises(InputError, match=re.escape(message)):
        laws.register(replace(TWIN, **changes))
    assert laws.names() == before


def test_a_variant_may_not_take_a_name_either(registered):
    registered(replace(SPRING, name="twin-bare"))
    with pytest.raises(InputError, match="'twin-bare'"):
        laws.register(TWIN)
    assert "twin" not in laws.names()


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"name": "My law"}, "name of a law: received 'My law'; allowed: small letters and digits"),
        ({"name": 3}, "name of a law: received 3"),
        ({"name": "twin\n"}, "name of a law: received"),
        ({"meaning": "no sentence"}, "meaning of law twin: received 'no sentence'; allowed: one line that"),
        ({"meaning": "Two\nlines."}, "meaning of law twin"),
        (
            {"build": "Shifted"},
            "build of law twin: received 'Shifted'; allowed: a function of the materials",
        ),
        (
            {"needs": {"patience"}},
            "needs of law twin: received {'patience'}; allowed: a set of \"samples\"",
        ),
        ({"needs": None}, "needs of law twin: received None"),
        ({"normalise": "none"}, "normalise of law twin: received 'none'; allowed: \"tangent\" or"),
        ({"look": "blue"}, "look of law twin: received 'blue'"),
        ({"role": "king"}, "role of law twin: received 'king'; allowed: None"),
        ({"variants": (3,)}, "variants of law twin"),
        ({"variants": (Variant("Not So", "So.", frozenset()),)}, "name of a law: received 'twin-Not So'"),
        ({"variants": (Variant("so", "So.", {"rest"}),)}, "needs of law twin-so"),
    ],
)
def test_a_bad_law_is_refused(changes, message):
    with pytest.raises(InputError, match=re.escape(message)):
        replace(TWIN, **changes)


@pytest.mark.parametrize(
    ("look", "message"),
    [
        ({"colour": "blue"}, "colour of a law: received 'blue'; allowed: six digits and letters"),
        ({"marker": "oo"}, "marker of a law: received 'oo'"),
        ({"dashes": "--"}, "dashes of a law: received '--'"),
        ({"dashes": (0, ())}, "dashes of a law"),
        ({"dashes": (0, (1, -1))}, "dashes of a law"),
    ],
)
def test_a_bad_look_is_refused(look, message):
    with pytest.raises(InputError, match=re.escape(message)):
        Look(**look)


def test_only_a_spec_can_be_registered_and_only_ones_own_be_forgotten():
    with pytest.raises(InputError, match=r"allowed: an asperity\.laws\.LawSpec"):
        laws.register(laws.Shifted)
    for name in ("shifted", "linear-filtered"):
        with pytest.raises(
            InputError, match=rf"received '{name}'; allowed: a law that was registered \(none is\)"
        ):
            laws.unregister(name)


@pytest.mark.parametrize("name", ["shiftd", 3, None, "twin"])
def test_unknown_names_are_refused_everywhere(name):
    with pytest.raises(InputError, match=r"allowed: \"areal\", \"shifted\"") as found:
        laws.spec_of(name)
    if name == "shiftd":
        assert found.value.remedy == 'Did you mean "shifted"?'
    with pytest.raises(InputError):
        laws.needs_of(["areal", name])


def spoilt(build):
    return replace(SPRING, build=build)


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
    registered(spoilt(build))
    with pytest.raises(InputError, match=re.escape(message)):
        run(case("ball-on-beam", "spring"))


def test_materials_are_what_they_say(registered):
    """Filtered where the law needs the filter, in the units and shapes that the protocol states."""
    seen = {}

    def build(materials):
        seen[materials.name] = materials
        return build_spring(materials)

    every = frozenset(Need)
    registered(
        replace(SPRING, build=build, needs=every - {Need.FILTER}, variants=(Variant("f", "So.", every),))
    )
    run(case("ball-on-beam", "spring", "spring-f"))
    bare, filtered = seen["spring"], seen["spring-f"]
    assert bare.line.heights.shape[0] == 1
    assert filtered.line.heights.shape[0] > 1
    assert np.std(filtered.line.heights[0]) < np.std(bare.line.heights[0])
    assert filtered.line_at_load.heights.shape == bare.line.heights.shape
    rows, ny = bare.heights.shape
    assert rows == bare.line.heights.shape[1]
    assert bare.body.shape[1] == ny
    assert bare.heights[:, ny // 2] == pytest.approx(-bare.line.heights[0], abs=1e-15)
    approach, stiffness = bare.working_point
    assert bare.hertz_constant * approach**1.5 == pytest.approx(bare.load, rel=1e-9)
    assert stiffness == pytest.approx(1.5 * bare.load / approach, rel=1e-9)
    assert bare.datum >= -float(bare.curve.first_touch)
    assert bare.table.forces.shape[0] == len(bare.table.approaches)
