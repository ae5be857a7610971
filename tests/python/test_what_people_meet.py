"""What help, a prompt and a notebook show of cases and of the physical classes."""

import inspect

import numpy as np
import pytest

import asperity
from asperity.case import PRESETS
from asperity.case.cases import case_class

WHEEL = asperity.WheelOnRail(surface={"spectrum": "iso3095"}, track={"pad_stiffness": 150e6})


@pytest.mark.parametrize("kind", PRESETS)
def test_help_on_a_kind_tells_every_key_with_unit_default_meaning_and_limits(kind):
    model = case_class(kind)
    text = " ".join(inspect.getdoc(model).split())
    for title, section in [("", model), *((name, inner.model) for name, inner in model.sections().items())]:
        for name, key in section.keys.items():
            if name == "kind" or name not in getattr(model, "SHOWN", {}).get(title, (name,)):
                continue
            assert f"{name} : " in text
            assert key.meaning[1:] in text
            assert key.within in text
            assert key.default is None or f"default {key.default!r}" in text
    assert text.index("Parameters ----------") < text.index("Examples --------")


def test_help_names_the_unit_that_a_number_is_in():
    told = inspect.getdoc(asperity.WheelOnRail)
    assert "speed : m/s, default '56 m/s'\n    Rolling speed (a speed greater than 0, or a course" in told
    assert "    pad_stiffness : N/m, optional\n        Stiffness of a rail pad" in told
    assert "laws : list of text, default ['areal', 'linear-filtered']" in told
    assert "track : section of keys, as a mapping\n" in told
    of_bearing = inspect.getdoc(case_class("ball-bearing"))
    assert "fault : section of keys, as a mapping, or a list of them\n" in of_bearing


def test_the_signature_is_that_of_the_keys():
    signature = inspect.signature(asperity.WheelOnRail)
    assert signature.parameters["speed"].default == "56 m/s"
    assert {"surface", "wheel", "track"} <= set(signature.parameters)
    signature.bind(speed=30.0, surface={"spectrum": "iso3095"})
    with pytest.raises(TypeError, match="sped"):
        signature.bind(sped=30.0)
    sections = inspect.signature(type(WHEEL.track)).parameters
    assert "pad_stiffness" in sections


def test_dir_lists_keys_and_what_people_do_with_them():
    names = dir(WHEEL)
    assert {*WHEEL.keys, *WHEEL.sections(), "with_", "to_toml", "save", "time_step"} <= set(names)
    assert not [
        name for name in names if name.startswith("_") or name in ("given_names", "problems", "prepared")
    ]
    assert all(hasattr(WHEEL, name) for name in names)
    assert {"pad_stiffness", "model"} <= set(dir(WHEEL.track))


def test_a_notebook_shows_what_is_set():
    own = {"name": "<b>", "youngs_modulus": 2e11, "poisson_ratio": 0.3, "density": 7800}
    page = WHEEL.with_(wheel={"material": own | {"citation": "a book"}})._repr_html_()
    assert "<td>track.pad_stiffness</td><td>150 MN/m</td><td>stiffness of a rail pad</td>" in page
    assert "&lt;b&gt;" in page
    assert "a book" not in page  # the report cites it
    assert "<td>wheel.mass</td>" not in page  # it is at its default
    assert repr(WHEEL) == (
        "WheelOnRail(surface={'spectrum': 'iso3095'}, track={'pad_stiffness': '150 MN/m'})"
    )


def test_physical_classes_print_one_line_that_says_something():
    x = 5e-6 * np.arange(-20, 21)
    ball = np.add.outer(x**2, x**2) / (2 * 10e-3)
    space = asperity.HalfSpace(ball.shape, (5e-6, 5e-6), 115e9)
    assert (
        repr(space) == "<HalfSpace: 41 × 41 whole cells of 5 um × 5 um, E* 115 GPa, elastic, free boundary>"
    )
    contact = space.solve(ball, load=1.0)
    assert repr(contact).startswith("<Contact: 1 N at an approach of 0.16")
    assert f"on {np.count_nonzero(contact.pressure)} of 1681 cells" in repr(contact)
    assert repr(contact).endswith(f"converged in {contact.iterations} iterations>")
    surface = asperity.HeightMap(np.tile([1e-6, -1e-6], (40, 15)), (2e-6, 3e-6), "one\x1b.x3p")
    shown = "<HeightMap: 40 × 30 points, 0.08 mm × 0.09 mm, 2 um × 3 um apart, rms height 1 um, one\\x1b.x3p>"
    assert repr(surface) == shown
    assert repr(asperity.Profile(np.zeros(5), 1e-3)).startswith("<Profile: 5 points, 5 mm, 1000 um apart")
    track = asperity.Track.named("x2000", pad_stiffness=300e6)
    assert repr(track).startswith(
        "<Track x2000: rail 6.3777 MN m^2, 60.2 kg/m; pads 300 MN/m; half sleepers 150 kg"
    )
    for thing in (space, contact, surface, track):
        assert "\n" not in repr(thing)


def test_a_case_file_is_read_as_an_object(tmp_path):
    path = WHEEL.save(tmp_path / "case.toml")
    assert asperity.read_case(path) == WHEEL
    with pytest.raises(
        asperity.errors.InputError, match=r"nothing\.toml: received no such file; .*Check the path"
    ):
        asperity.read_case(tmp_path / "nothing.toml")


def test_kinds_are_called_by_what_rolls_without_a_suffix():
    """What they were called still leads to them."""
    names = {case_class(kind).__name__ for kind in PRESETS}
    assert names == {"BallOnBeam", "WheelOnRail", "Bodies", "BearingUnderLoad", "RollerBearingUnderLoad"}
    assert asperity.BallBearingCase is asperity.BearingUnderLoad
    assert "BallBearingCase" not in dir(asperity)
