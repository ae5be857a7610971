"""Labels of CNOSSOS-EU against the track and the wheel of a case."""

import pytest

from asperity import WheelOnRail
from asperity.errors import Grade, InputError, OutOfRangeWarning
from asperity.reference.cnossos import nearest_pad_class, nearest_wheel_transfer
from asperity.running import prepare_case
from asperity.scenes.noise import findings_of_labels, track_label, wheel_label
from asperity.scenes.plan import planned_rows


def case(noise=None, track=None, wheel=None):
    return WheelOnRail(
        surface={"spectrum": "iso3095"}, noise=noise or {}, track=track or {}, wheel=wheel or {}
    )


def messages(*sections):
    found = findings_of_labels(case(*sections))
    assert all(finding.grade is Grade.WARNING for finding in found)
    return [finding.message for finding in found]


@pytest.mark.parametrize(
    ("stiffness", "name"),
    [(80e6, "soft"), (200e6, "soft"), (250e6, "medium"), (799e6, "medium"), (900e6, "hard"), (2e9, "hard")],
)
def test_pads_have_the_class_of_the_directive(stiffness, name):
    """Table [2.3.b]: 150 to 250, 250 to 800, 800 to 1000 MN/m."""
    assert nearest_pad_class(stiffness) == name
    assert track_label(case(track={"pad_stiffness": stiffness})) == name


@pytest.mark.parametrize(
    ("diameter", "name"), [(0.6, "680 mm"), (0.8, "840 mm"), (0.9, "920 mm"), (1.25, "1200 mm")]
)
def test_wheels_have_the_nearest_diameter(diameter, name):
    assert nearest_wheel_transfer(diameter) == name
    assert wheel_label(case(wheel={"radius": diameter / 2})) == name


def test_a_label_that_is_given_is_taken():
    given = case({"track_pad": "hard", "wheel_transfer": "680 mm"})
    assert (track_label(given), wheel_label(given)) == ("hard", "680 mm")


def test_labels_that_fit_are_not_warned_of():
    assert messages() == []
    assert messages({"track_pad": "medium"}, {"pad_stiffness": 250e6}) == []


def test_a_label_against_the_pads_says_which_fits():
    (message,) = messages({"track_pad": "hard"}, {"pad_stiffness": 300e6})
    assert message == (
        "dynamic stiffness of the rail pads, for CNOSSOS-EU: 300 MN/m, in range 800 to 1000 MN/m, those of "
        'the class "hard". CNOSSOS-EU\'s sound power is that of another track or wheel. '
        'Set noise.track_pad = "medium", or leave it out.'
    )


@pytest.mark.parametrize(("stiffness", "label"), [(100e6, "soft"), (1200e6, "hard")])
def test_pads_outside_of_all_classes_have_none(stiffness, label):
    (message,) = messages(None, {"pad_stiffness": stiffness})
    assert f'those of the class "{label}"' in message
    assert message.endswith("It has no class for such pads; take the sound power from the vibration.")


@pytest.mark.parametrize("mass", [40.0, 400.0])
def test_a_sleeper_that_is_no_mono_block_is_told(mass):
    (message,) = messages(None, {"sleeper_mass": mass})
    assert f"mass of half a sleeper, for CNOSSOS-EU: {mass:g} kg, in range 110 to 210 kg" in message


def test_a_wheel_far_from_its_label_is_told():
    (message,) = messages({"wheel_transfer": "920 mm"}, None, {"radius": 0.34})
    assert "diameter of the wheel, for CNOSSOS-EU: 680 mm, in range within 15 % of 920 mm" in message
    assert 'Set noise.wheel_transfer = "680 mm", or leave it out.' in message
    (message,) = messages(None, None, {"radius": 0.25})
    assert message.endswith("It has no class for such a wheel.")


@pytest.mark.parametrize(
    ("nearest", "message"),
    [(nearest_pad_class, "stiffness of a rail pad"), (nearest_wheel_transfer, "wheel diameter")],
)
def test_what_is_not_positive_has_no_class(nearest, message):
    with pytest.raises(InputError, match=message):
        nearest(0.0)


def test_a_check_says_whose_sound_power_is_computed():
    found = dict(planned_rows(prepare_case(case())))
    assert found["sound power"] == (
        "of rail and sleepers, for the wheel is rigid; by CNOSSOS-EU for soft pads and a wheel of 920 mm"
    )
    with pytest.warns(OutOfRangeWarning, match='those of the class "hard"'):
        planned_rows(prepare_case(case({"track_pad": "hard"})))
    without = prepare_case(case({"track_pad": "hard"}).with_(laws=["hertz"]))
    assert "CNOSSOS" not in dict(planned_rows(without))["sound power"]
