"""Bearings by name: each entry is possible, printed tones are met, a name that is none is answered."""

import json
import math
from types import MappingProxyType

import pytest

from asperity import BallBearing
from asperity.errors import InputError
from asperity.reference.bearings import LISTED, TONES, near_names
from command_line import call, words_of

ISO_15 = MappingProxyType(
    {"60": (26, 28, 32, 35, 42, 47, 55, 62, 68, 75, 80), "62": (30, 32, 35, 40, 47, 52, 62, 72, 80, 85, 90),
     "63": (35, 37, 42, 47, 52, 62, 72, 80, 90, 100, 110),
     "719": (22, 24, 28, 30, 37, 42, 47, 55, 62, 68, 72)}
)  # fmt: skip
"""Outside diameters of `BORES`, mm, as catalogues have them by ISO 15."""
BORES = (10, 12, 15, 17, 20, 25, 30, 35, 40, 45, 50)
SERIES = MappingProxyType(
    {"60": "60", "62": "62", "63": "63", "70": "60", "72": "62", "73": "63", "719": "719"}
)


@pytest.mark.parametrize("name", LISTED)
def test_every_entry_is_possible_and_says_where_it_stands(name):
    each, bearing = LISTED[name], BallBearing.named(name)
    D, pitch = each.ball_diameter, each.pitch_diameter
    assert pitch * math.sin(math.pi / each.balls) > D  # they do not overlap
    assert (bearing.balls, bearing.ball_diameter, bearing.pitch_diameter) == (each.balls, D, pitch)
    assert each.citation.strip()
    assert each.prints.strip()
    if each.bore is not None:
        d, outside = each.bore, each.outside_diameter
        assert d < pitch - D < pitch + D < outside  # rings have a thickness on both sides
        assert pitch == pytest.approx(0.5 * (d + outside), rel=0.02)
        assert 0.5 <= round(D / (0.5 * (outside - d)), 3) < 0.7  # to the digits of what is printed in inches
        assert each.width > D
    if not each.is_pitch_printed:
        assert pitch == pytest.approx(0.5 * (each.bore + each.outside_diameter), rel=1e-12)
    if each.contact_angle is not None:
        assert bearing.free_angle == pytest.approx(each.contact_angle)


def test_boundary_dimensions_are_those_of_their_series():
    compared = 0
    for name, each in LISTED.items():
        digits = name.removesuffix("C")
        series, code = SERIES.get(digits[:-2]), digits[-2:]
        if series is None or int(code) > 10:
            continue
        place = int(code)
        assert each.bore == pytest.approx(1e-3 * BORES[place])
        assert each.outside_diameter == pytest.approx(1e-3 * ISO_15[series][place])
        compared += 1
    assert compared > 60


def test_tones_are_those_printed():
    """To the digits that rounded diameters leave; that of a ball takes up their errors most."""
    told = {name: each for name, each in LISTED.items() if each.tones}
    assert set(told) == {"6203", "6205", "ER-16K"}
    for name, each in told.items():
        turning = BallBearing.named(name).kinematics(1.0, contact_angle=0.0)
        found = [turning.cage, *(turning.tone(part) for part in TONES[1:])]
        assert found == pytest.approx(each.tones, abs=6e-3), name
        assert found[:3] == pytest.approx(each.tones[:3], abs=6e-4), name


def test_an_angle_that_is_printed_stays_unless_a_clearance_or_another_is_given():
    assert math.degrees(BallBearing.named("7205C").free_angle) == pytest.approx(15.0)
    assert math.degrees(
        BallBearing.named("7205C", contact_angle=math.radians(25.0)).free_angle
    ) == pytest.approx(25)
    assert BallBearing.named("7205C", clearance=10e-6).radial_clearance == 10e-6
    assert BallBearing.named("6206").radial_clearance == 10e-6


@pytest.mark.parametrize(
    ("asked", "near"),
    [
        ("SKF 6205-2RS", ("6205",)),
        ("nice", ("NICE",)),
        ("er16k", ("ER-16K",)),
        ("E 225", ("7205C",)),
        ("MM206K", ("6206",)),
        ("7205", ("7205C",)),
        ("6299", ("6209",)),
        ("wheel", ()),
    ],
)
def test_a_name_that_is_none_is_answered_with_near_ones(asked, near):
    assert near_names(asked)[: max(len(near), 1)] == near
    with pytest.raises(InputError) as refused:
        BallBearing.named(asked)
    assert ("Did you mean " in str(refused.value)) == bool(near)
    assert f"{len(LISTED)} bearings have a name: asperity bearing --list." in str(refused.value)


def test_the_list_says_what_is_printed_and_what_is_not():
    said = words_of(call("bearing", "--list").stdout)
    assert "6205 SKF 6205-2RS JEM 25 × 52 × 15 9 7.94 39.04 – " in said
    assert "7205C SNFA E 225 25 × 52 × 15 12 7.94 (38.5) 15°" in said
    assert "Pitch diameters in ( ) are not printed" in said
    assert "Nobody prints radii of grooves or clearances" in said
    document = json.loads(call("bearing", "--list", "--json").stdout)
    assert document["balls"] is None
    found = {each["name"]: each for each in document["catalogue"]}
    assert list(found) == list(LISTED)
    assert found["6205"]["tones"]["ball"] == 4.7135
    assert found["NICE"]["bore"] is None


def test_a_bearing_says_where_it_is_printed_and_what_is_chosen():
    said = words_of(call("bearing", "6206", "--radial", "100 N").stdout)
    assert "Timken MM206K, boundary dimensions, number and diameter of the balls as printed by" in said
    assert "the pitch diameter is the mean of bore and outside diameter, grooves and clearance chosen" in said
    said = words_of(call("bearing", "7205C", "--axial", "100 N").stdout)
    assert "free contact angle 15°" in said
    assert "diameter, grooves chosen here or given." in said
