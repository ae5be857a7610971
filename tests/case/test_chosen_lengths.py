"""Grid, window and waves that a case does not give follow from load, radii and roughness."""

import numpy as np
import pytest

from asperity import BallOnBeam, Bodies, HeightMap, Hertz, WheelOnRail
from asperity.case.chosen_lengths import preferred_length
from asperity.errors import InputError
from asperity.running import prepare_case
from asperity.studies.definition import study_of

ROUGH = {"rms": "0.1 um"}


def on_track(radius, load):
    body = {"radius": radius, "load": load, "transverse_radius": "inf"}
    return Bodies(over="track", speed=20, surface=ROUGH, body=body)


@pytest.mark.parametrize(
    "case",
    [BallOnBeam(surface={"rms": "5 nm"}, ball={"radius": r, "load": f}) for r in (5e-3, 0.2) for f in (1, 70)]
    + [WheelOnRail(surface=ROUGH, wheel={"load": f}) for f in (2e4, 1.3e5)]
    + [on_track("30 mm", 500), on_track("0.6 m", 3e4)],
    ids=repr,
)
def test_grid_and_window_follow_load_and_radii(case):
    """Against the exact ellipse: eight cells in its smaller half-width, three loads in the window."""
    if isinstance(case, BallOnBeam):
        radii = (case.ball.radius, case.ball.radius)
        load, modulus = case.ball.load, 210e9 / (2 * (1 - 0.3**2))
    else:
        section = case.wheel if isinstance(case, WheelOnRail) else case.body
        radii, load, modulus = (section.radius, 0.3), section.load, 210e9 / (2 * (1 - 0.3**2))
    hertz = Hertz(modulus, *radii)
    axes, under_three = (hertz.semi_axes(hertz.approach(force)) for force in (load, 3 * load))
    assert 8 < min(axes) / case.contact.spacing < 13
    assert 1.05 < case.contact.window / (2 * max(under_three)) < 1.6
    assert case.surface.shortest >= 4 * case.contact.spacing * (1 - 1e-9)
    assert case.surface.longest >= 3.2 * max(axes)
    assert case.with_(seed=7).contact == case.contact
    assert set(case.with_(seed=7).given()) == {*case.given(), "seed"}  # nothing of this counts as given


@pytest.mark.parametrize(
    "base",
    [BallOnBeam(surface=ROUGH), WheelOnRail(surface=ROUGH, wheel={"section": "rigid"})],
    ids=["ball", "wheel"],
)
def test_the_longest_wave_is_that_of_what_is_rolled_over_not_of_the_load(base):
    load, radius = base.rolling.contact_load, base.rolling.radius
    for changes in (
        {"load": 2.0 * load},
        {"load": 0.5 * load},
        {"load": 8.0 * load},
        {"radius": 2.0 * radius},
        {"laws": ["areal"]},
        {"contact.window": 1.5 * base.contact.window},
        {"speed": 0.5 * base.speed},
        {"surface.rms": "0.2 um"},
    ):
        keys = {
            f"{base.ROLLING}.{name}" if name in ("load", "radius") else name: each
            for name, each in changes.items()
        }
        assert base.with_(**keys).surface.longest == base.surface.longest, changes
    assert base.surface.longest == (1.6e-3 if base.ROLLING == "ball" else 0.1)
    large = BallOnBeam(surface=ROUGH, ball={"load": 2000.0})  # a contact 1.2 mm across
    assert large.surface.longest == pytest.approx(16e-3)


def test_rougher_surfaces_get_wider_windows_and_shorter_waves_finer_grids():
    smooth, rough = (BallOnBeam(surface={"rms": rms}) for rms in ("10 nm", "1 um"))
    assert rough.contact.window > 1.5 * smooth.contact.window
    fine = BallOnBeam(surface={"rms": "10 nm", "shortest": "12 um"})
    assert fine.contact.spacing == pytest.approx(2.5e-6)
    slow = smooth.with_(speed="50 mm/s")
    assert slow.contact.spacing <= 0.05 / (2.5 * 5000) < smooth.contact.spacing


def test_what_is_given_stays_and_what_is_not_is_chosen_again():
    case = BallOnBeam(surface=ROUGH, contact={"spacing": "16 um"})
    heavier = case.with_(**{"ball.load": 60})
    assert case.contact.spacing == heavier.contact.spacing == 16e-6
    assert heavier.contact.window > case.contact.window
    assert heavier.with_(**{"contact.spacing": None}).contact.spacing == 20e-6
    assert 'spacing = "16 um"' in case.to_toml()
    assert "window" not in case.to_toml()
    rows = {row["key"]: row for row in case.parameters()}
    assert not rows["contact.spacing"]["is_default"]
    assert rows["contact.window"]["is_default"]
    assert rows["contact.window"]["value"] == "0.4 mm"


@pytest.mark.parametrize(("length", "below", "above"), [(1e-5, 1e-5, 1e-5), (9.9e-4, 8e-4, 1e-3)])
def test_lengths_are_ten_in_a_decade(length, below, above):
    assert (preferred_length(length), preferred_length(length, up=True)) == (below, above)


def test_members_of_a_study_roll_over_one_surface():
    case = BallOnBeam(laws=["areal"], surface=ROUGH)
    alone = [case.with_(**{"ball.load": load}).contact for load in (5, 60)]
    assert alone[0].spacing < alone[1].spacing
    assert alone[0].window < alone[1].window
    light, heavy = (member.case for member in study_of(case, {"ball.load": [5, 60]}).members())
    assert light.contact == heavy.contact
    assert light.surface == heavy.surface
    assert (light.contact.spacing, light.contact.window) == (alone[0].spacing, alone[1].window)
    swept = study_of(case, {"ball.load": [5, 60], "contact.spacing": ["8 um", "10 um"]}).members()
    assert [member.case.contact.spacing for member in swept] == pytest.approx([8e-6, 10e-6] * 2)


def test_a_chosen_window_is_no_wider_than_the_measured_map():
    heights = 1e-8 * np.random.default_rng(2).standard_normal((60, 60))
    surface = {"file": HeightMap(heights, (10e-6, 10e-6))}
    keys = {"surface": surface, "ball": {"load": 30.0}, "contact": {"spacing": 2e-5}}
    case = BallOnBeam(laws=["hertz"], duration=0.01, **keys)
    assert case.contact.window > 0.6e-3
    prepared = prepare_case(case)
    assert prepared.shape.body.shape[0] == 29  # odd, of 30
    assert prepared.case.text == case.text  # it is not taken for given
    with pytest.raises(InputError, match=r"received 640 um; allowed: at most the measured map, 600 um"):
        prepare_case(case.with_(**{"contact.window": 6.4e-4}))


def test_a_map_narrower_than_the_contact_is_told_as_one(tmp_path):
    """No window would help: one that holds the contact is wider than the map."""
    heights = 1e-8 * np.random.default_rng(2).standard_normal((19, 19))
    surface = {"file": HeightMap(heights, (10e-6, 10e-6))}
    case = BallOnBeam(laws=["hertz"], duration=0.01, surface=surface, ball={"load": 5.04})
    told = (
        r"surface.file: received maps of 190 um across; allowed: at least 205.\d um, 1.1 times the width .*"
    )
    with pytest.raises(InputError, match=told + "Measure wider maps, press less, or roll a smaller body"):
        prepare_case(case)
