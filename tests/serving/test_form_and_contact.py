"""The form on the page is the schema of the case, and its contact is Hertz's, whatever led to it."""

import json

import numpy as np
import pytest

import asperity
from asperity.case.any_case import entries
from asperity.case.cases import case_class, case_of, parse_case, template
from asperity.case.toml import read_toml
from asperity.errors import InputError
from asperity.parameters import File, Origin
from asperity.serving.case_form import case_data, form_values, forms
from asperity.serving.contact_preview import MOST_CELLS_SHOWN, PressedSample
from asperity.serving.run_view import viewed_run
from asperity.serving.worker import answered
from refusals import refusals
from small_cases import BALL, BEARING, WHEEL

UNITS = Origin("the case", units=True)


def no_file(identifier):
    return None


def fields_of(kind):
    return {field["key"]: field for group in forms()[kind]["groups"] for field in group["fields"]}


@pytest.mark.parametrize("kind", forms())
def test_the_form_holds_every_key_with_its_words_and_opens_as_a_case(kind):
    fields, model = fields_of(kind), case_class(kind)
    every = {entry.dotted for entry in entries(model)}
    hidden = {f"{title}.{name}" for title in model.SHOWN for name in model.sections()[title].model.keys}
    hidden -= {f"{title}.{name}" for title, names in model.SHOWN.items() for name in names}
    assert set(fields) == every - hidden - {"kind"}
    assert all(field["meaning"] and field["allowed"] for field in fields.values())
    assert "" in {group["title"] for group in forms()[kind]["groups"]}
    for field in fields.values():  # keys that go with others name keys of the form
        for companion in filter(None, field["goes_with"].split(" or ")):
            assert companion.partition("=")[0] in fields, field
    values = {key: field["value"] for key, field in fields.items()}
    assert case_of(case_data(kind, values, no_file), UNITS).kind == kind


@pytest.mark.parametrize("kind", forms())
def test_what_is_typed_reads_as_the_case_file_does(kind):
    text = template(kind)
    data = read_toml(text, "case", "case")
    typed = form_values(data, lambda path: None)
    assert case_of(case_data(kind, typed, no_file), UNITS) == parse_case(text)
    assert all(isinstance(value, str) for value in typed.values())


def test_lists_flags_numbers_and_materials_are_typed():
    values = {
        "laws": "hertz, linear",
        "seed": "7",
        "surface.rms": " 0.1 um ",
        "beam.sensors": "0.2 m, 0.4 m",
        "ball.material": '{ youngs_modulus = "72 GPa", poisson_ratio = 0.33, density = "2700 kg/m^3" }',
        "contact.samples": "3",
        "ball.load": "",
    }
    case = case_of(case_data("ball-on-beam", values, no_file), UNITS)
    assert case.laws == ("hertz", "linear")
    assert (case.seed, case.contact.samples, case.ball.load) == (7, 3, None)
    assert case.beam.sensors == (0.2, 0.4)
    assert case.ball.material.youngs_modulus == pytest.approx(72e9)


def read(values, kind="ball-on-beam"):
    case_of(case_data(kind, {"surface.rms": "0.1 um"} | values, no_file), UNITS)


test_what_is_wrong_is_said_of_its_key = refusals(
    (lambda: read({"ball.load": "5"}), "ball.load: received '5'"),
    (lambda: read({"contact.samples": "many"}), "contact.samples: .*whole number"),
    (lambda: read({"contact.samplse": "3"}), "contact.samplse: received an unknown key"),
    (lambda: read({"surface.file": "/etc/passwd"}), "surface.file: .*uploaded"),
    (lambda: read({"seed": ["7"]}), "seed: received .*text"),
    (lambda: read({"seed": "7" * 3000}), "seed: received .*at most 2000"),
    (lambda: read({"ball.material": "{ density = "}), "ball.material: "),
    *((lambda kind=kind: read({}, kind), "kind: received") for kind in ("roller", None, 3, ["ball-on-beam"])),
)


def test_a_case_that_names_a_file_of_its_own_says_to_upload_it():
    data = {"kind": "ball-on-beam", "surface": {"file": "/home/me/beam.x3p"}}
    with pytest.raises(InputError, match=r"surface.file: received 'beam.x3p'.*Upload it"):
        form_values(data, lambda path: None)


FILES = [
    (kind, each.dotted)
    for kind in ("ball-on-beam", "wheel-on-rail", "bodies", "ball-bearing")
    for each in entries(case_class(kind))
    if each.name == "speed" or isinstance(getattr(each.key.kind, "other", each.key.kind), File)
]


@pytest.mark.parametrize(("kind", "dotted"), FILES, ids=map(".".join, FILES))
def test_no_file_that_a_case_names_is_opened_unless_it_was_uploaded(kind, dotted, tmp_path):
    """What is wrong with it, or in it, would be told."""
    (tmp_path / "of somebody else.csv").write_text("SECRET, SECRET\n")
    section, _, name = dotted.rpartition(".")
    heading = f"[{section}]\n" if section else ""
    for path in (tmp_path / "of somebody else.csv", "of somebody else.csv"):
        text = f'kind = "{kind}"\n{heading}{name} = {json.dumps(str(path))}\n'
        question = {"question": "fill", "text": text, "surfaces": str(tmp_path)}
        (told,) = answered(json.dumps(question))["refused"]
        assert told.startswith(f"{dotted}: received 'of somebody else.csv'" if section else f"{dotted}: ")
        assert told.endswith(("Upload it, and choose it in the form.", "Write its points."))


SMOOTH = {
    "kind": "wheel-on-rail",
    "surface": {"smooth": True},
    "wheel": {"load": "65 kN"},
    "contact": {"spacing": "0.4 mm", "window": "30 mm"},
}


def test_smooth_bodies_follow_hertz():
    """F = K δ^1.5; K of a wheel of 0.46 m on a rail head of 0.3 m, E = 210 GPa, ν = 0.3: 9.413e10 N/m^1.5."""
    sample = PressedSample(case_of(SMOOTH))
    at_load = sample.at(None)
    assert at_load["force"] == pytest.approx(65e3, rel=1e-4)
    assert at_load["approach"] == pytest.approx(78.1e-6, rel=5e-3)
    assert at_load["tangent_stiffness"] == pytest.approx(1.248e9, rel=1e-2)
    length = (at_load["pressure"] > 0.0).any(axis=1).sum() * sample.spacing[0]
    assert sample.described()["passing"] == pytest.approx(case_of(SMOOTH).speed / length, rel=0.08)
    for share in (0.3, 0.6, 1.0):
        pressed = sample.at(share)
        assert pressed["force"] == pytest.approx(9.413e10 * pressed["approach"] ** 1.5, rel=1e-2)
        assert pressed["stiffness"] == pytest.approx(2 / 3 * pressed["tangent_stiffness"], rel=2e-2)
        ellipse = np.pi * np.prod(sample.hertz.semi_axes(pressed["approach"]))
        assert pressed["area"] == pytest.approx(ellipse, rel=0.012)  # a count of cells is 2 to 4 % more


def test_where_it_came_from_changes_nothing():
    sample = PressedSample(case_of(BALL))
    down = [sample.at(share) for share in (0.9, 0.5, 0.1)]
    up = [sample.at(share) for share in (0.1, 0.5, 0.9)][::-1]
    for one, other in zip(down, up, strict=True):
        assert one["force"] == pytest.approx(other["force"], rel=1e-4)
        np.testing.assert_allclose(one["pressure"], other["pressure"], atol=1e-3 * one["largest_pressure"])


def test_at_touch_nothing_is_carried_and_force_grows_from_there():
    sample = PressedSample(case_of(BALL))
    assert sample.at(0.0)["force"] == 0.0
    told = sample.described()
    forces = [state["force"] for state in told["curve"]]
    assert forces == sorted(forces)
    assert forces[0] > 0.0
    assert told["touch"] < told["working"] < told["deepest"]
    assert sample.at(None)["force"] == pytest.approx(told["load"], rel=1e-3)


def test_a_wide_window_is_thinned_and_says_so():
    wide = {**SMOOTH, "contact": {"spacing": "0.1 mm", "window": "30 mm"}}
    sample = PressedSample(case_of(wide))
    told = sample.described()
    assert told["thinning"] == 3
    assert max(told["shape"]) <= MOST_CELLS_SHOWN
    assert sample.at(None)["approach"] == pytest.approx(78.1e-6, rel=5e-3)
    assert told["heights"].shape == sample.gap.shape
    middle = tuple(n // 2 for n in told["shape"])
    assert sample.gap[middle] == sample.gap.min() == 0.0


def test_a_sample_of_each_kind_can_be_pressed():
    assert PressedSample(case_of(WHEEL)).at(0.5)["force"] > 0.0


PITTED = {"fault.on": "outer", "fault.length": "0.18 mm", "fault.depth": "0.1 mm"}


def test_the_most_loaded_ball_of_a_bearing_is_pressed_on_its_raceway():
    """Smooth it is Hertz's contact under its load; over a pit it is softer, and waves pass at its pace."""
    typed = form_values(read_toml(template("ball-bearing"), "case", "case"), lambda path: None)
    typed |= {"inner_raceway.waviness": "", "outer_raceway.waviness": ""}
    smooth, pitted = (
        PressedSample(case_of(case_data("ball-bearing", typed | more, no_file), UNITS))
        for more in ({}, PITTED)
    )
    found = smooth.at(None)
    assert found["force"] == pytest.approx(smooth.load, rel=1e-4)
    assert found["smooth_force"] == pytest.approx(smooth.load, rel=0.01)
    assert found["largest_pressure"] == pytest.approx(smooth.hertz.peak_pressure(found["approach"]), rel=0.02)
    assert 1.003 < pitted.working / smooth.working < 1.1  # narrower than the contact
    assert "over the middle of what is damaged" in pitted.source
    along, _ = smooth.hertz.semi_axes(smooth.hertz.approach(smooth.load))
    pace = 2.0 * np.pi * 23.49e-3 * 0.5 * 30.0 * (1.0 - 7.94 / 39.04)  # of the cage on the outer raceway
    assert smooth.passing == pytest.approx(pace / (2.0 * along), rel=0.01)


@pytest.mark.parametrize(
    ("speed", "at"), [("600..1800 1/min in 1 s", ", at the fastest, 1800 1/min"), ("1800 1/min", "")]
)
def test_waves_pass_a_contact_at_the_fastest_of_a_speed_that_changes(speed, at):
    case = {"kind": "ball-bearing", "speed": speed, "radial": "100 N", "bearing": {"name": "6205"}}
    told = PressedSample(case_of(case)).described()
    assert told["passing_at"] == at
    assert told["passing"] == pytest.approx(PressedSample(case_of(case | {"speed": "1800 1/min"})).passing)


def test_a_bearing_that_was_run_is_shown_with_its_figures(runs, tmp_path):
    file = asperity.save(runs(BEARING), tmp_path / "run.nc")
    shown = viewed_run(str(file))
    assert shown["force"] is None
    for title in ("The bearing and its load zone", "Envelope spectrum", "Contact force levels in one-third"):
        assert title in shown["blocks"]
