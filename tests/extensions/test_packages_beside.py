"""A package installed beside this one: each thing is one file and one line, and is known to all commands."""

import csv
import importlib.metadata
import json
import os
import re
import shutil
import struct
import subprocess
import sys
import tomllib
from pathlib import Path

import numpy as np
import pytest
import xarray
from click.testing import CliRunner

import asperity
from asperity import extensions, laws
from asperity.case.cases import case_class, parse_case, template
from asperity.case.form import case_key
from asperity.cli import main
from asperity.errors import CaseError
from asperity.extensions import ExtensionWarning
from asperity.scenarios.preparing import prepare
from asperity.scenes.observer import Observer
from asperity.scenes.report import names_of_reports
from asperity.schema import Attribute, Entry
from asperity.serving import case_form
from asperity.structures.modal import modal_receptance
from refusals import refusals
from small_cases import BEARING, ON_BEAM

LAB = Path(__file__).with_name("our_lab")
OVER_A_BEAM = {"kind": "ball-on-beam", "laws": ["linear"], "start": "0.45 m", "ball": {"load": "30 N"}}
KIND = "roller-on-foundation"
CASE = {
    "kind": "bodies",
    "over": "plate",
    "laws": ["damped", "areal"],
    "start": "0.4 m",
    "body": {"load": "30 N"},
    "plate": {"length": "0.8 m"},
}


def installed(folder, groups, name="our-lab"):
    """Write what an installer leaves of a package: its metadata, with its entry points."""
    told = folder / f"{name.replace('-', '_')}-1.0.dist-info"
    told.mkdir()
    (told / "METADATA").write_text(f"Metadata-Version: 2.1\nName: {name}\nVersion: 1.0\n", encoding="utf-8")
    lines = [
        line for group, each in groups.items() for line in (f"[{group}]", *map(" = ".join, each.items()))
    ]
    (told / "entry_points.txt").write_text("\n".join(lines), encoding="utf-8")


@pytest.fixture
def beside(tmp_path_factory, monkeypatch):
    """Folder of modules, as of an environment, whose packages are known; afterwards they are forgotten."""
    folder = tmp_path_factory.mktemp("site")
    monkeypatch.syspath_prepend(folder)
    for table in ("_specs", "_families", "_keys"):
        monkeypatch.setattr(laws, table, dict(getattr(laws, table)))
    before = set(sys.modules)
    extensions.forget()
    case_form.forms.cache_clear()
    yield folder
    extensions.forget()
    case_form.forms.cache_clear()
    for name in set(sys.modules) - before:
        if (getattr(sys.modules[name], "__file__", None) or "").startswith(str(folder)):
            del sys.modules[name]


@pytest.fixture
def lab(beside, tmp_path, monkeypatch):
    """The package of the documentation, installed as its pyproject.toml says."""
    shutil.copytree(LAB, beside / "our_lab", ignore=shutil.ignore_patterns("__pycache__"))
    project = tomllib.loads((LAB / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    installed(beside, project["entry-points"], project["name"])
    monkeypatch.chdir(tmp_path)


def command(*arguments):
    done = CliRunner().invoke(main, arguments, standalone_mode=False)
    assert (done.exit_code, done.exception) == (0, None), done.output
    return done.output


def profile(path, heights, distance=20.0):
    path.write_bytes(
        b"OURPROF1" + struct.pack("<iif", *heights.shape, distance) + heights.astype("<f4").tobytes()
    )


def test_a_reader_a_structure_a_law_an_observer_and_a_figure_roll_together(lab, tmp_path):
    """The map is read from a file of the lab's own format, and the plate is rolled over by the lab's law."""
    rng = np.random.default_rng(1)
    profile(tmp_path / "map.prof", rng.normal(scale=30.0, size=(400, 120)))
    surface = asperity.read_surface("map.prof")
    assert surface.shape == (400, 120)
    assert surface.heights.std() == pytest.approx(30e-9, rel=0.01)
    case = asperity.Bodies(
        **ON_BEAM | CASE | {"surface": {"file": "map.prof"}, "damped": {"viscosity": 200.0}}
    )
    assert (case.plate.length, "plate" in case.section_names, case.over_name) == (0.8, True, "plate")
    case.save("case.toml")
    assert "damped.viscosity" in command("check", "case.toml", "--keys")
    command("run", "case.toml", "-o", "out")
    tree = asperity.open_result("out")
    force = tree["rolling/contact_force"]
    assert list(force.law.values) == ["damped", "areal"]
    assert float(force.sel(law="damped").std()) < 0.95 * float(force.sel(law="areal").std())
    load = tree["fatigue/equivalent_load"]
    np.testing.assert_allclose(load, np.cbrt((force**3).mean("time")), rtol=1e-12)
    assert load.attrs["units"] == "N"
    width = 2.0 * prepare(case).shape.semi_axes[1]
    np.testing.assert_allclose(tree["wear/depth"], 1e-15 * 0.005 * force.mean("time") / width, rtol=1e-12)
    assert "ISO 281" in str(tree.attrs["citations"])
    assert doubt_of_wear(tree) == {"value": f"{tree['wear/depth'].values.max():.1e} m", "grade": ""}
    page = Path("out/report.html").read_text(encoding="utf-8")
    assert page.index('id="fatigue"') > page.index('id="laws"')
    assert "<strong>damped</strong>: As areal, with a damper of its own." in page
    assert ":#7f3b08;" in page
    assert "damped [dB re 1 N]" in Path("out/force_bands.csv").read_text(encoding="utf-8")
    with open("out/sorted_force.csv", encoding="utf-8", newline="") as file:
        shares = [float(row["damped [N]"]) for row in csv.DictReader(file)]
    assert np.array_equal(shares, force.sel(law="damped").values.ravel())
    assert "sorted_force.csv" in names_of_reports()


def test_the_same_observers_look_at_a_bearing(lab):
    """Under an axial load P each of Z balls carries P/(Z sin α) on both rings, and wears both."""
    keys = {"axial": "200 N", "radial": 0, "duration": "50 ms", "fault": None, "centrifugal": False}
    found = asperity.run(BEARING | keys)
    case = asperity.read_case(BEARING | keys)
    of, turning = case.bearing.bearing, case.kinematics
    load = case.axial / (of.balls * np.sin(case.static.contact_angle))
    assert found["fatigue/equivalent_load"].shape == (1, 2 * of.balls)
    np.testing.assert_allclose(found["fatigue/equivalent_load"], load, rtol=1e-6)
    for ring, (smooth, _) in enumerate(case.contacts):
        passed = abs(turning.cage - (turning.inner, turning.outer)[ring])
        width = 2.0 * smooth.semi_axes(smooth.approach(load))[1]
        depth = found["wear/depth"][0, ring * of.balls : (ring + 1) * of.balls] / 0.05
        np.testing.assert_allclose(depth, 1e-15 * 0.005 * load * passed / width, rtol=1e-2)
    assert "Archard" in str(found.attrs["citations"])
    assert doubt_of_wear(found)["value"] == f"{found['wear/depth'].values.max():.1e} m"


def doubt_of_wear(result):
    """What is said of it in the table of validity."""
    rows = json.loads(result["contact"].attrs["validity"])
    (row,) = (row for row in rows if row["quantity"] == "depth of wear, at most")
    return {name: row[name] for name in ("value", "grade")}


def test_an_observer_is_asked_of_what_has_what_it_needs(beside):
    """One of bearings finds nothing on a beam, one that says nothing of its needs nothing in a bearing."""
    (beside / "needy_lab.py").write_text(NEEDY)
    offered = {"pitch": "needy_lab:PITCH", "window": "needy_lab:WINDOW"}
    installed(beside, {extensions.OBSERVERS: offered}, "needy-lab")
    on_beam = asperity.run(ON_BEAM | OVER_A_BEAM)
    assert "pitch" not in on_beam.children
    assert on_beam["window/cells"].item() > 0.0
    found = asperity.run(BEARING | {"duration": "50 ms", "fault": None})  # a warning would be an error here
    assert "window" not in found.children
    assert found["pitch/circle"].item() == pytest.approx(38.5e-3, rel=0.02)  # of a 6205, between 25 and 52 mm


def test_a_plate_yields_to_a_load_as_plates_do(lab):
    """S. Timoshenko and S. Woinowsky-Krieger: 0.01160 F L²/D at the middle of a square plate."""
    plate = asperity.Bodies(
        over="plate", surface={"rms": "1 um"}, plate={"length": 1, "width": 1, "place": 0.5}
    )
    model = plate.plate.model(20e3)
    of, thickness = plate.plate.material, plate.plate.thickness
    stiffness = of.youngs_modulus * thickness**3 / (12.0 * (1.0 - of.poisson_ratio**2))
    sunk = modal_receptance(model, np.array([0.0]), 0.5, 0.5)[0].real
    assert sunk == pytest.approx(0.01160 / stiffness, rel=2e-3)


def test_a_kind_of_ones_own_is_written_checked_and_run(lab, beside):
    text = command("new", KIND)
    assert f'kind = "{KIND}"' in text
    for words in (["--help"], ["new", "--help"]):  # which are written when the program starts
        done = subprocess.run(
            [sys.executable, "-m", "asperity", *words],
            env=os.environ | {"PYTHONPATH": os.pathsep.join([str(beside), *filter(None, sys.path)])},
            capture_output=True,
            encoding="utf-8",
        )
        assert KIND in "".join(done.stdout.split()), done.stderr  # lines end at hyphens
    assert KIND in case_form.forms()
    own = {"kind": KIND, "settling": "5 ms", "roller": {"load": "30 N"}, "laws": ["hertz", "linear"]}
    contact = ON_BEAM["contact"] | {"window": "1 mm", "sample_length": "2 mm"}
    result = asperity.run(ON_BEAM | own | {"contact": contact})
    assert (result["scenario"].attrs["kind"], asperity.RollerOnFoundation) == (KIND, case_class(KIND))
    assert result.attrs["title"] == "A body over a foundation"
    rolling = result["rolling"].to_dataset().sel(contact=1)
    np.testing.assert_allclose(rolling["over_displacement"], rolling["contact_force"] / 5e6, rtol=1e-12)
    assert float(abs(rolling["contact_force"].mean("time") / 30.0 - 1.0).max()) < 0.02
    helps = asperity.what_helps(ON_BEAM | own)
    assert helps.sweep["variant"]["half as stiff"] == {"foundation.stiffness": "times 0.5"}
    softer = [member.case.foundation.stiffness for member in helps.members()]
    assert sorted(softer) == [2.5e6] * 3 + [5e6] * 3


def test_keys_limits_and_templates_of_a_law_and_a_structure_follow(lab):
    written = template("bodies", laws=["damped"])
    assert 'viscosity = "0 N s/m"' in written
    assert "[plate]" in written
    assert "# a rectangular plate on simple supports all around" in written
    assert "[damped]" not in template("bodies")
    with pytest.raises(CaseError, match=r"plate\.thickness: received 2 m; allowed: 10 um to 1 m"):
        parse_case('kind = "bodies"\nover = "plate"\nsurface.rms = "1 um"\nplate.thickness = "2 m"')
    with pytest.raises(CaseError, match='Did you mean "damped"'):
        parse_case('kind = "bodies"\nlaws = ["dampd"]')
    with pytest.raises(CaseError, match=r'over: received "beam"; allowed: "plate", where it is described'):
        parse_case('kind = "bodies"\nsurface.rms = "1 um"\nplate.length = "2 m"')


def test_members_of_a_study_know_it_in_processes_of_their_own(lab):
    case = ON_BEAM | CASE | {"laws": ["damped"]}
    table = asperity.study(case, {"damped.viscosity": ["0 N s/m", "500 N s/m"]}, workers=1)
    assert json.loads(table.attrs["failures"]) == []
    assert float(np.diff(table["force_level_a"].sel(law="damped"))[0]) < -0.1


NEEDY = """
from asperity.scenes.observer import Observer
from asperity.schema import Entry

LAW = Entry("pitch", "law", "1", "contact law")
CIRCLE = Entry("pitch", "circle(law)", "m", "diameter of the pitch circle")


def observe(computed):
    return {LAW: list(computed.runs), CIRCLE: [computed.bearing.pitch_diameter for _ in computed.runs]}


PITCH = Observer("pitch", (LAW, CIRCLE), observe, needs=["bearing"])
WINDOW_LAW = Entry("window", "law", "1", "contact law")
CELLS = Entry("window", "cells(law)", "1", "cells of the window")
WINDOW = Observer("window", (WINDOW_LAW, CELLS), lambda computed: {CELLS: [computed.shape.body.size]})
"""
BROKEN = {
    "asperity.laws": {
        "lost": "broken_lab:LAW",
        "named": "broken_lab.things:ANOTHER",
        "areal": "broken_lab.things:AREAL",
        "angry": "angry_lab.law:LAW",
    },
    "asperity.readers": {"words": "broken_lab.things:TEXT", "number": "broken_lab.things:NUMBER"},
    "asperity.structures": {"track": "broken_lab.things:NUMBER", "deck": "broken_lab.gone:Deck"},
    "asperity.kinds": {"bodies": "broken_lab.things:KIND", "skates": "broken_lab.gone:Skates"},
    "asperity.observers": {
        "heard": "broken_lab.things:FAILS",
        "rolling": "broken_lab.things:TAKEN",
        "turned": "broken_lab.things:TURNED",
    },
    "asperity.chapters": {"late": "broken_lab.things:LATE"},
}
THINGS = """
from asperity.laws import LawSpec, spec_of
from asperity.scenes.observer import Observer
from asperity.schema import Entry
from asperity.surfaces.readers import SurfaceFormat

NUMBER = 3
ANOTHER = LawSpec("another", "A law.", lambda materials: None)
AREAL = LawSpec("areal", "A law.", lambda materials: None)
TEXT = SurfaceFormat("words", lambda path, hints: [], (".txt",))


class KIND:
    pass


def observe(computed):
    raise ZeroDivisionError("nothing to divide by")


FAILS = Observer("heard", (Entry("heard", "level(law)", "dB re 1 N", "level"),), observe)
TAKEN = Observer("rolling", (Entry("rolling", "level(law)", "dB re 1 N", "level"),), observe)
FORCE = Entry("turned", "force(time, law)", "N", "a force, its dimensions in the wrong order")
LAW = Entry("turned", "law", "1", "contact law")
TURNED = Observer(
    "turned",
    (FORCE, LAW),
    lambda computed: {FORCE: computed.stacked("contact_force")[:, 0], LAW: list(computed.runs)},
)
"""
MESSAGES = {
    laws.names: [
        'the law "lost" of the package broken-lab 1.0: received broken_lab:LAW, .* fails with .*no law today',
        "name of the law: received 'another'; allowed: \"named\", as its entry point has it",
        "name of a law: received 'areal'; allowed: a name that no other law has",
        'the law "angry" .* fails with SystemExit .not on Sundays.',
    ],
    lambda: asperity.read_surface("line.csv"): [
        'reader "words": received .txt; allowed: extensions of its own. Say what its files begin with',
        'reader "number": received 3; allowed: an asperity.surfaces.readers.SurfaceFormat',
    ],
    lambda: template("bodies"): [
        'structure "track": received 3; allowed: a class of asperity.case.rolled_over.RolledOver',
        'the structure "deck" .* broken_lab.gone:Deck, which fails with .*gone',
    ],
    case_form.forms: [
        'kind of case "bodies": received a name of this program',
        'the kind of case "skates" .* fails with .*gone',
    ],
    names_of_reports: ['the chapter "late" of the package broken-lab 1.0: received broken_lab.things:LATE'],
}


@pytest.fixture
def broken(beside, tmp_path, monkeypatch):
    """A package of which nothing can be used."""
    (beside / "broken_lab").mkdir()
    (beside / "broken_lab" / "__init__.py").write_text(
        "def __getattr__(name):\n    raise OSError('no law today')\n"
    )
    (beside / "broken_lab" / "things.py").write_text(THINGS)
    (beside / "angry_lab").mkdir()
    (beside / "angry_lab" / "__init__.py").write_text("raise SystemExit('not on Sundays')")
    installed(beside, BROKEN, "broken-lab")
    monkeypatch.chdir(tmp_path)
    Path("line.csv").write_text("x (mm); z (um)\n" + "".join(f"{n}; {n % 3}\n" for n in range(20)))


def test_what_cannot_be_used_is_named_and_everything_else_works(broken):
    for ask, messages in MESSAGES.items():
        with pytest.warns(ExtensionWarning) as met:
            ask()
        for message in messages:
            assert [each for each in met if re.search(message, str(each.message))], message
        assert all("It is left out; mend or remove the package." in str(each.message) for each in met)
        ask()  # told once: a second warning would be an error here
    assert "areal" in laws.names()
    assert len(extensions.stamp()) == sum(map(len, BROKEN.values()))
    with pytest.raises(
        CaseError, match=r'the kind of case "skates" of the package broken-lab 1\.0: received'
    ):
        parse_case('kind = "skates"')


def test_of_two_packages_that_offer_one_name_one_is_left_out(beside):
    installed(beside, {extensions.OBSERVERS: {"same": "math:pi"}}, "one-lab")
    installed(beside, {extensions.OBSERVERS: {"same": "math:e"}}, "other-lab")
    with pytest.warns(ExtensionWarning, match="a name that another package has; allowed: a name of its own"):
        taken = extensions.taken(extensions.OBSERVERS, lambda name, number: number)
    assert len(taken) == 1


def test_an_observer_that_fails_does_not_lose_the_run(broken):
    with pytest.warns(ExtensionWarning) as met:
        result = asperity.run(ON_BEAM | OVER_A_BEAM)
    said = [str(each.message) for each in met]
    assert any(
        "observer heard: received a failure, ZeroDivisionError (nothing to divide by)" in each
        for each in said
    )
    assert any("group of the observer: received rolling" in each for each in said)
    steps = result["rolling"].sizes["time"]
    assert any(
        f"force(time, law) of observer turned: received the shape (1, {steps}); "
        "allowed: dimensions (time: any size, law: 1). It is left out." in each
        for each in said
    )
    assert not {"heard", "turned"} & set(result.children)


def looked_at(found):
    """Values of an observer that lays out two dimensions, a text and numbers in JSON."""
    return Observer("own", (LAW, TIME, LEVEL, WORDS, NUMBERS), dict).declared(found)


LAW, TIME = Entry("own", "law", "1", "contact law"), Entry("own", "time", "s", "time")
LEVEL = Entry("own", "level(law, time)", "dB re 1 N", "level")
WORDS, NUMBERS = Attribute("own", "words", "text", "said"), Attribute("own", "numbers", "JSON", "counted")
OF_OWN = "of observer own: received"
test_values_fit_what_an_observer_declares = refusals(
    (
        {LAW: ["a"], LEVEL: [1.0]},
        f"level(law, time) {OF_OWN} the shape (1,); allowed: dimensions (law, time)",
    ),
    (
        {TIME: [[1.0]]},
        f"time {OF_OWN} the shape (1, 1); allowed: dimensions (time). "
        'Name others behind it, as in Entry("own", "time(law, contact)", …).',
    ),
    (
        {LEVEL: [[1.0, 2.0]], LAW: ["a", "b"]},  # what is laid out first makes no difference
        f"level(law, time) {OF_OWN} the shape (1, 2); allowed: dimensions (law: 2, time: any size)",
    ),
    (
        {LAW: ["a"], TIME: [0.0, 1.0, 2.0], LEVEL: [[1.0, 2.0]]},
        "the shape (1, 2); allowed: dimensions (law: 1, time: 3)",
    ),
    (
        {LEVEL: xarray.Variable(("time", "law"), [[1.0]])},
        f"level(law, time) {OF_OWN} dimensions (time, law); allowed: dimensions (law, time)",
    ),
    ({LEVEL: [[1.0], [1.0, 2.0]]}, f"level(law, time) {OF_OWN} a failure, ValueError"),
    ({LEVEL: [[1j]]}, f"level(law, time) {OF_OWN} values of complex128; allowed: real numbers, or texts"),
    ({LEVEL: [[None]]}, f"level(law, time) {OF_OWN} values of object"),
    ({WORDS: {"a": 1}}, f"words {OF_OWN} values of object"),
    ({WORDS: [[1.0]]}, f"words {OF_OWN} an array of float64"),
    ({NUMBERS: {1j}}, f"numbers {OF_OWN} a failure, TypeError"),
    (None, "observer own: received None; allowed: values by its entries, as a dict"),
    of=looked_at,
)


def test_what_fits_is_laid_out_with_what_is_said_of_it():
    laid_out = looked_at(
        {
            LEVEL: xarray.Variable(LEVEL.dims, [[1.0]], {"least": 2}),
            LAW: np.array(["a"], object),
            NUMBERS: [1],
        }
    )
    assert laid_out[LEVEL].attrs == {"units": "dB re 1 N", "long_name": "level", "least": 2}
    assert laid_out[LAW].values == ["a"]
    assert laid_out[NUMBERS] == [1]


test_declarations_are_looked_at = refusals(
    (
        lambda: Entry("own", "level()", "1", "level"),
        "received 'level()'; allowed: a name, or a name with its",
    ),
    (
        lambda: Entry("own", "level(law,time)", "1", "level"),
        r"contact, time\).\. What has no dim",
    ),
    (lambda: Entry("own", "level(law, law)", "1", "level"), "entry of the group own"),
    (
        lambda: Entry("own", "level", ("law", "time"), "1"),
        "entry level of the group own: received ('law', 'time') and '1'; "
        "allowed: its unit and its meaning, as texts; its place is a name, or a name with its dimensions",
    ),
    (lambda: Entry("own", "level", "1", None), "received '1' and None; allowed: its unit and its meaning"),
    (
        lambda: Observer("a/b", (LEVEL,), dict),
        "name of an observer: received 'a/b'; allowed: letters, digits",
    ),
    (
        lambda: Observer("own", (LEVEL,), dict, sources="ISO 281"),
        "sources of observer own: received 'ISO 281'",
    ),
)


def test_a_command_names_what_fails_in_a_line_and_goes_on(broken):
    done = CliRunner().invoke(main, ["new", "bodies"], standalone_mode=False)
    assert done.exit_code == 0
    assert 'Warning: the structure "deck" of the package broken-lab 1.0' in done.stderr
    assert "[track]" in done.stdout


def test_what_is_kept_depends_on_the_packages(lab, beside):
    case = asperity.Bodies(surface={"rms": "1 um"})
    before, key = extensions.stamp(), case_key("run", 1, case)
    assert len(before) == 7
    file = beside / "our_lab" / "damped.py"
    file.write_text(file.read_text(encoding="utf-8") + "\n", encoding="utf-8")
    extensions.stamp.cache_clear()
    assert sum(a != b for a, b in zip(before, extensions.stamp(), strict=True)) == 1
    assert case_key("run", 1, case) != key


def test_nothing_is_looked_for_where_no_package_names_this_program(beside, monkeypatch):
    """The library that reads what packages say of themselves takes longer to import than this program."""
    monkeypatch.setattr(importlib.metadata, "distributions", lambda: pytest.fail("it was asked"))
    assert extensions.stamp() == ()
    assert extensions.offers(extensions.LAWS) == ()
