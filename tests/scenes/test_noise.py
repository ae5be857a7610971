"""Sound power of rolling by CNOSSOS-EU, and its labels against the track and the wheel of a case."""

import numpy as np
import pytest

from asperity import WheelOnRail
from asperity.errors import Grade, OutOfRangeWarning
from asperity.reference import cnossos
from asperity.running import prepare_case
from asperity.scenes import noise
from asperity.scenes.noise import rolling_sound_power
from asperity.scenes.track import planned_track
from asperity.spectra import a_weighted_total

DISC = cnossos.wheel_roughness("disc")
TRACK = cnossos.track_transfer("medium")
WHEEL = cnossos.wheel_transfer("920 mm")


def test_bands_without_roughness_are_unknown_and_left_out():
    # the wheel's table begins at 1 m: at 100 m/s nothing is known below 100 Hz
    centres, levels = rolling_sound_power(100.0, None, DISC, TRACK, WHEEL)
    assert np.isnan(levels[:, centres < 90.0]).all()
    assert np.isfinite(levels[:, centres > 90.0]).all()
    assert np.isfinite(a_weighted_total(levels, centres)).all()


def case(track=None, wheel=None, **keys):
    sections = {"track": track or {}, "wheel": wheel or {}}
    return WheelOnRail(surface={"spectrum": "iso3095"}, **sections, **keys)


@pytest.mark.parametrize(
    ("stiffness", "name"),
    [(80e6, "soft"), (200e6, "soft"), (250e6, "medium"), (799e6, "medium"), (900e6, "hard"), (2e9, "hard")],
)
def test_pads_have_the_class_of_the_directive(stiffness, name):
    """Table [2.3.b]: 150 to 250, 250 to 800, 800 to 1000 MN/m."""
    assert noise.track_label(case(track={"pad_stiffness": stiffness})) == name


@pytest.mark.parametrize(
    ("diameter", "name"), [(0.6, "680 mm"), (0.8, "840 mm"), (0.9, "920 mm"), (1.25, "1200 mm")]
)
def test_wheels_have_the_nearest_diameter(diameter, name):
    assert noise.wheel_label(case(wheel={"radius": diameter / 2})) == name


@pytest.mark.parametrize(
    ("sections", "told"),
    [
        ({}, None),
        (
            {"track": {"pad_stiffness": 100e6}},
            "dynamic stiffness of the rail pads, MN/m, for CNOSSOS-EU: 100, in range 150 to 250. "
            "CNOSSOS-EU's sound power is that of another one. Take the sound power from the vibra",
        ),
        ({"track": {"pad_stiffness": 1200e6}}, "in range 800 to 1000."),
        ({"track": {"sleeper_mass": 40.0}}, "half a sleeper, kg, for CNOSSOS-EU: 40, in range 110 to 210"),
        ({"track": {"sleeper_mass": 400.0}}, "for CNOSSOS-EU: 400, in range 110 to 210"),
        (
            {"wheel": {"radius": 0.25}},
            "diameter of the wheel, mm, for CNOSSOS-EU: 500, in range 591.3 to 782",
        ),
    ],
)
def test_a_label_that_does_not_fit_is_told_with_what_to_do(sections, told):
    found = noise.findings_of_labels(case(**sections))
    assert [finding.grade for finding in found] == [Grade.WARNING] * (told is not None)
    assert all(told in finding.message for finding in found)


def test_a_check_says_whose_sound_power_is_computed():
    found = dict(planned_track(prepare_case(case())))
    assert found["sound power"] == (
        "of rail, sleepers and wheel; by CNOSSOS-EU for soft pads and a wheel of 920 mm"
    )
    rigid = dict(planned_track(prepare_case(case(wheel={"section": "rigid"}))))["sound power"]
    assert rigid.startswith("of rail and sleepers: of this wheel it is not known how")
    hard = {"pad_stiffness": 1200e6}
    with pytest.warns(OutOfRangeWarning, match="in range 800 to 1000"):
        planned_track(prepare_case(case(track=hard)))
    without = prepare_case(case(track=hard, laws=["hertz"]))
    assert "CNOSSOS" not in dict(planned_track(without))["sound power"]
