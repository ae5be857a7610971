"""Where sections of wheel and rail touch as they lie: closed forms, signs, and what no contact can be."""

import math
import re

import numpy as np
import printed_sections
import pytest

from asperity import Profile, WheelOnRail, WheelSection
from asperity.case import across
from asperity.errors import CaseError, InputError, PhysicsWarning
from asperity.scenarios.geometry import geometry_of
from asperity.scenarios.preparing import prepare
from asperity.structures.outline import doubts_of
from refusals import refusals
from small_cases import HEARD

WINDOW = {"spacing": "0.25 mm", "window": "16 mm"}


def section(shape, first=-40e-3, last=40e-3, points=161):
    """Heights out of the material over places towards the field side, m."""
    y = np.linspace(first, last, points)
    return Profile(shape(y), y[1] - y[0], "", first)


def circle(radius, **where):
    return section(lambda y: np.sqrt(radius**2 - y**2) - radius, **where)


CONE = section(lambda y: -y / 20.0)


def case_of(wheel=None, rail=None, rail_inclination="0", **sideways):
    sideways["rail_inclination"] = rail_inclination
    keys = {"wheel": HEARD["wheel"] | {"profile": wheel}, "track": HEARD["track"] | {"rail_profile": rail}}
    return WheelOnRail(**HEARD | keys | {"contact": WINDOW, "sideways": sideways})


@pytest.mark.parametrize("rail", [None, circle(0.3)], ids=["by its radius", "measured"])
@pytest.mark.parametrize("inclination", ["0", "1:40", "1:20"])
def test_a_cone_touches_a_round_head_where_both_are_as_steep(rail, inclination):
    """R sin(angle between cone and rail) off the middle of the head, to the gauge side of an upright one."""
    turned = {"0": 0.0, "1:40": 1 / 40, "1:20": 1 / 20}[inclination]
    between = math.atan(1 / 20) - math.atan(turned)
    on_tread, on_head = case_of(CONE, rail, rail_inclination=inclination).contact_places
    assert on_head == pytest.approx(-0.3 * math.sin(between), rel=0.0, abs=1e-8)
    lifted, below = (
        math.atan(turned),
        0.3 * (1.0 - math.cos(between)),
    )  # it turns about the middle of its head
    assert on_tread == pytest.approx(on_head * math.cos(lifted) + below * math.sin(lifted), rel=0.0, abs=1e-8)


@pytest.mark.parametrize("shift", [5e-3, -8e-3])
def test_of_two_circles_the_flatter_is_touched_farther_off(shift):
    """At a slope that both have: s R/(R + R') from the middle of the head, the rest on the tread."""
    case = case_of(circle(0.5), circle(0.3), wheel_shift=shift)
    places = -shift * 0.5 / 0.8, shift * 0.3 / 0.8
    assert case.contact_places == pytest.approx(places, rel=0.0, abs=1e-7)
    assert geometry_of(case).hertz.radius_y == pytest.approx(1.0 / (1.0 / 0.5 + 1.0 / 0.3), rel=1e-3)


def test_places_count_from_the_zero_of_a_file_and_heights_from_any(tmp_path):
    file = tmp_path / "rail.csv"
    rows = (f"{at:.6g};{172.0 - at**2 / 600.0:.9g}" for at in np.linspace(45.0, -30.0, 151))
    file.write_text("\n".join(["y (mm); z (mm)", *rows]))
    for inclination, on_head in (("0", -0.015), ("1:20", 0.0)):
        case = case_of(CONE, file, rail_inclination=inclination)
        assert case.contact_places == pytest.approx((on_head, on_head), rel=0.0, abs=2e-5)
    own, aside = (case_of(CONE, Profile(circle(0.3).heights, 0.5e-3, "", at)) for at in (None, -38e-3))
    assert own.contact_places == pytest.approx(case_of(CONE, circle(0.3)).contact_places)  # by its middle
    assert own != aside


def test_a_place_that_is_given_is_that_of_both_and_moves_no_gap():
    found, given = (case_of(CONE, **more) for more in ({}, {"contact_place": 0.004}))
    assert given.contact_places == (0.004, 0.004)
    np.testing.assert_array_equal(geometry_of(given).body, geometry_of(found).body)


NARROW = circle(0.3, first=-10e-3, last=10e-3, points=41)


test_sections_that_cannot_touch_are_refused = refusals(
    (CONE, NARROW, "sections that meet 2.5 mm from an edge of what is known of them; allowed: a con"),
    (section(lambda y: -y), None, "meet 0.0 mm from an edge.*shift them less, or shrink contact.window"),
    (section(lambda y: y, first=0.05, last=0.09), NARROW, "at least 8 mm inside, half of contact.win"),
    (CONE, section(lambda y: 100.0 * y), "rail_profile: received a section that overhangs.*Leave flanks out"),
    (Profile([0.0, 0.0, 0.0], 0.04), None, "wheel.profile: received 3 points; allowed: at least 4"),
    of=lambda wheel, rail: case_of(wheel, rail, rail_inclination="1:40"),
    error=(CaseError, InputError),
)


# --- sections as tables have them: wheel and rail with one z, upwards or downwards, and mirrored

FLANGED = section(
    lambda y: -y / 20.0 + 28e-3 * np.sin(np.clip((-38e-3 - y) / 14e-3, 0.0, 1.0) * np.pi / 2.0),
    first=-60e-3,
    last=60e-3,
    points=481,
)
"""A cone of 1:20 with a flange 28 mm high."""
HEAD = section(
    lambda y: np.sqrt(0.3**2 - y**2) - 0.3 - np.maximum(np.abs(y) - 26e-3, 0.0),
    first=-36e-3,
    last=36e-3,
    points=289,
)


def turned(line):
    return Profile(-line.heights, line.spacing, "", line.start)


def mirrored(line):
    return Profile(
        line.heights[::-1], line.spacing, "", -(line.start + (len(line.heights) - 1) * line.spacing)
    )


@pytest.mark.parametrize("inclination", ["0", "1:40", None])
@pytest.mark.parametrize("head", [HEAD, turned(HEAD), mirrored(HEAD)], ids=["out", "into", "mirrored"])
@pytest.mark.parametrize("tread", [FLANGED, turned(FLANGED)], ids=["out", "into"])
def test_sections_each_way_up_touch_in_one_place(tread, head, inclination):
    """R sin(angle between cone and rail) off the middle; in it where levelled, the flange left out."""
    case = case_of(tread, head, rail_inclination=inclination)
    steep = math.atan(1 / 20) - math.atan({"0": 0.0, "1:40": 1 / 40, None: 1 / 20}[inclination])
    met = across.meeting_of(case)
    assert met.places[1] == pytest.approx(-0.3 * math.sin(steep), rel=0.0, abs=2e-7)
    into = int(tread is not FLANGED) + int(head.heights[0] > 0.0)
    with PhysicsWarning.caught() as caught:
        shape = geometry_of(case)
    notes = [str(each.message) for each in caught if "turned upside down" in str(each.message)]
    assert len(notes) == into
    slope = math.cos(math.atan(1 / 20)) if inclination else 1.0  # y'' of a circle is 1/(R cos^3)
    assert shape.hertz.radius_y == pytest.approx(0.3 * slope**3, rel=5e-4)
    assert shape.semi_axes == pytest.approx((6.20e-3, 4.67e-3), rel=3e-3)


@pytest.mark.parametrize("tread", [mirrored(FLANGED), mirrored(turned(FLANGED))], ids=["out", "into"])
def test_a_flange_on_the_field_side_is_told(tread):
    with pytest.raises((CaseError, InputError), match=r"flange at 60 mm, on the field side.*Change the sign"):
        case_of(tread, HEAD)


@pytest.mark.parametrize("inclination", ["0", "1:40", None])
@pytest.mark.parametrize("way", [lambda line: line, turned], ids=["out", "into"])
def test_sections_that_are_exchanged_are_refused_and_one_of_them_is_doubted(way, inclination):
    """Where one alone meets nowhere, the message says so in the place of a remedy."""
    head = section(
        lambda y: -0.5 * y**2 / 0.3 - 0.7 * np.maximum(np.abs(y) - 27e-3, 0.0), first=-36e-3, last=36e-3
    )
    of_rail = "wheel.profile: its ends are 8.46 mm off its middle, .* 72 mm wide, .*section of the rail"
    of_wheel = "track.rail_profile: 1.* mm are level beside a step of 2.* mm, .*section of the wheel"
    for wheel, rail, told in ((way(head), None, of_rail), (None, way(FLANGED), of_wheel)):
        with PhysicsWarning.caught() as caught:
            try:
                geometry_of(case_of(wheel, rail, rail_inclination=inclination))
                said = [str(each.message) for each in caught]
            except (CaseError, InputError) as error:
                said = [str(error)]
        assert any(re.search(told, each) for each in said), said
    with pytest.raises(
        (CaseError, InputError), match=r"sections exchanged: .* allowed: the wheel's under whe"
    ):
        geometry_of(case_of(way(head), way(FLANGED), rail_inclination=inclination))


def test_treads_and_worn_heads_are_not_taken_for_each_other():
    """A narrow tread with the beginning of its flange, a wide one; a head with a flank on one side."""
    narrow = section(
        lambda y: -y / 20.0 + 0.6 * (np.maximum(-y - 24e-3, 0.0) - np.maximum(y - 26e-3, 0.0)),
        first=-38e-3,
        last=38e-3,
    )
    flank = section(lambda y: -0.5 * y**2 / 0.3 - 2.0 * np.maximum(-y - 28e-3, 0.0), first=-36e-3, last=36e-3)
    for wheel, rail in ((narrow, HEAD), (FLANGED, HEAD), (FLANGED, flank)):
        met = across.meeting_of(case_of(wheel, rail, rail_inclination="1:40"))
        assert not met.tread.is_the_other
        assert not met.head.is_the_other


@pytest.mark.parametrize(("unit", "told"), [("m", "a section 120 m wide"), ("um", "a section 0.12 mm wide")])
@pytest.mark.parametrize("part", ["wheel", "rail"])
def test_a_section_in_a_wrong_unit_is_refused_with_the_cause(unit, told, part, tmp_path):
    """Tables of mm under another unit: their slopes are right, and tell nothing."""
    file = tmp_path / "a.csv"
    rows = "\n".join(f"{y}; {-(y**2) / 600:.4f}" for y in range(-60, 60))
    file.write_text(f"y ({unit}); z ({unit})\n{rows}\n")
    with pytest.raises((CaseError, InputError), match=f"{told}; allowed: .*Are its places in mm"):
        case_of(**{part: file})


def test_what_has_no_flange_is_left_as_it_is():
    """Treads without one, tilted by 3 degrees and with a chamfer of 5 mm; a crowned body; a grooved rail."""
    y = np.linspace(-30e-3, 60e-3, 361)
    tilted = 0.05 * y - np.maximum(y - 55e-3, 0.0)
    assert across.flange_of(y, tilted) == (0, 0)
    assert across.flange_of(y, -(y**2) / 0.1) == (0, 0)
    both = np.maximum(np.abs(y - 15e-3) - 35e-3, 0.0) * 3.0
    assert across.flange_of(y, both) == (1, 0)
    grooved = section(lambda y: -47e-3 * ((y > -70e-3) & (y < -28e-3)), first=-90e-3, last=28e-3, points=237)
    for rail, down in ((grooved, False), (turned(grooved), True)):
        assert across._is_head_down(across._places_of(rail), rail.heights) is down


def test_a_flanged_line_without_places_has_its_middle_in_that_of_its_tread():
    bare = Profile(FLANGED.heights, FLANGED.spacing)
    places = across.meeting_of(case_of(bare, HEAD, rail_inclination=None)).places
    assert places == pytest.approx((0.0, 0.0), abs=1e-6)


def test_the_window_that_is_chosen_holds_the_contact_of_measured_sections():
    """Hollow by 353 mm on a head of 300 mm: 2 m across, wider than the head alone asks for."""
    hollow = section(lambda y: 0.353 - np.sqrt(0.353**2 - y**2), first=-60e-3, last=60e-3, points=481)
    keys = {"wheel": HEARD["wheel"] | {"profile": hollow}, "track": HEARD["track"] | {"rail_profile": HEAD}}
    case = WheelOnRail(**HEARD | keys | {"contact": {}})
    shape = geometry_of(case)
    assert shape.hertz.radius_y == pytest.approx(1.0 / (1.0 / 0.3 - 1.0 / 0.353), rel=5e-3)
    assert 2.2 * max(shape.semi_axes) < case.contact.window <= 72e-3
    sharp = WheelOnRail(**HEARD | {"track": HEARD["track"] | {"rail_profile": circle(0.08)}, "contact": {}})
    assert sharp.contact.spacing <= min(geometry_of(sharp).semi_axes) / 8.0


# --- heights as tables print them


def rounded_to(step, shape, spacing, lift):
    y = np.arange(-40e-3, 40.01e-3, spacing)
    heights = shape(y) + lift
    return Profile(step * np.rint(heights / step) if step else heights, spacing, "", -40e-3)


def met_of(step, radius, spacing, draw):
    """A cone of 1:40 on a head, each lifted by some share of a millimetre, shifted by up to 3 mm."""
    lifts = draw.uniform(0.0, 1e-3, 2)
    cone = rounded_to(step, lambda y: -y / 40.0, spacing, lifts[0])
    head = rounded_to(step, lambda y: np.sqrt(radius**2 - y**2) - radius, spacing, lifts[1])
    case = case_of(cone, head, rail_inclination="1:40", wheel_shift=draw.uniform(-3e-3, 3e-3))
    return across.meeting_of(case, 1e-3), case


@pytest.mark.parametrize(("step", "radius"), [(1e-5, 0.3), (5e-6, 0.6), (1e-6, 0.6)])
@pytest.mark.parametrize("spacing", [0.25e-3, 1e-3, 2e-3])
def test_rounding_leaves_a_contact_as_uncertain_as_is_told(step, radius, spacing):
    """By drawn sections of which the radius is known: by up to so much, at two standard deviations."""
    draw = np.random.default_rng(1)
    exact, case = met_of(0.0, radius, spacing, draw)
    load = case.rolling.contact_load
    smooth = exact.osculating(case.smooth_contact, load)
    assert smooth.radius_y == pytest.approx(radius, rel=0.01)
    half = smooth.semi_axes(smooth.approach(load))[1]
    found = [met_of(step, radius, spacing, draw)[0].osculating(smooth, load) for _ in range(20)]
    off = 2.0 * np.sqrt(np.mean([(radius / each.radius_y - 1.0) ** 2 for each in found]))
    printed_too = met_of(step, radius, spacing, draw)[0]
    told = printed_too.uncertain(half) / (0.5 * half**2 / radius)
    steps = [each.step for each in (printed_too.tread, printed_too.head)]
    count = np.count_nonzero(steps)  # a cone may fall by whole steps
    depth = 2.0 * step * np.sqrt(count * 45.0 / (48.0 * 2.0 * half / spacing))
    assert told == pytest.approx(depth / (0.5 * half**2 / radius))
    assert 0.2 * told < off < 1.1 * told


@pytest.mark.parametrize(
    ("step", "told"), [(1e-4, "0.1 mm"), (2e-5, "20 µm"), (1e-5, None), (1e-6, None), (0.0, None)]
)
def test_sections_that_are_printed_too_coarsely_say_so_in_the_check(step, told):
    _, case = met_of(step, 0.3, 1e-3, np.random.default_rng(5))
    with PhysicsWarning.caught() as caught:
        geometry_of(case)
    said = [str(each.message) for each in caught if "printed" in str(each.message)]
    assert len(said) == (told is not None)
    if told:
        how = "altogether" if step == 1e-4 else r"by up to \d+ %"
        assert re.fullmatch(
            f"wheel.profile and track.rail_profile: positions printed to {told} leave the radius of the "
            rf"contact across the path, [\d.]+ mm, uncertain {how}: the gap is [\d.]+ "
            "µm deep where they touch. Take tables with more digits.",
            said[0],
        )


def test_a_plane_a_cone_and_computed_heights_are_not_taken_for_printed_ones():
    y = np.arange(-40e-3, 40.01e-3, 1e-3)
    assert [across.printed_step(each) for each in (0.0 * y, -y / 10.0, y**2)] == [0.0, 0.0, 1e-6]
    assert across.printed_step(np.sqrt(0.3**2 - y**2)) == 0.0
    for step in across.PRINTED:
        assert across.printed_step(step * np.rint(y**2 / 1e-4)) == step


# --- a wheel and a rail as standards print them

Y, ACROSS = np.arange(-65.0, 60.01, 0.25), np.arange(-33.0, 33.01, 0.25)


def printed(shape, places, *, by=1.0, moved=0.0, mirrored=False, kept=(-np.inf, np.inf), unit=1e-3):
    """A section of a standard, its heights times a number, its places moved, turned round or left out, mm."""
    inside = (places >= kept[0]) & (places <= kept[1])
    y, z = places[inside] + moved, by * shape(places[inside])
    y, z = (-y[::-1], z[::-1]) if mirrored else (y, z)
    return Profile(unit * z, unit * 0.25, "", unit * float(y[0]))


BENCHMARK = np.array([
    (-38.170158, 5.3592530), (-33.878643, 3.1260143), (-25.818939, 1.3995600), (-18.025426, 0.54238254),
    (-8.1900282, 0.11197778), (-0.60326698, 6.1851353e-4), (4.5917391, 0.046529407), (14.478761, 0.95760114),
    (18.788262, 1.7500008), (24.607656, 4.7790722),
])  # fmt: skip
"""Places and depths, mm, of the rail of the Manchester contact benchmark, which stands inclined by 1:40."""
FLANGE = np.array([(-60.01, 26.90440), (-54.88, 27.99939), (-47.05, 25.19229), (-43.0, 21.402)])
"""Places and heights, mm, of wheel A of UIC 519."""


def test_printed_sections_are_those_of_public_files():
    turned = np.arctan(1 / 40)
    cos, sin = np.cos(turned), np.sin(turned)
    middle = np.array([-7.4917, -0.0937])  # of the head, as it stands
    y, z = (BENCHMARK * [1.0, -1.0] - middle).T
    np.testing.assert_allclose(
        cos * z - sin * y, printed_sections.head_60e1(cos * y + sin * z), rtol=0.0, atol=1e-3
    )
    np.testing.assert_allclose(printed_sections.s1002(FLANGE[:, 0]), FLANGE[:, 1], rtol=0.0, atol=1e-3)


def wheel_of(**how):
    return printed(printed_sections.s1002, Y, **how)


def rail_of(**how):
    return printed(printed_sections.head_60e1, ACROSS, **how)


def chosen(wheel, rail, rail_inclination="1:40", **keys):
    """A case whose window is chosen."""
    sideways = {} if rail_inclination is None else {"rail_inclination": rail_inclination}
    parts = {"wheel": HEARD["wheel"] | {"profile": wheel} | keys}
    parts |= {"track": HEARD["track"] | {"rail_profile": rail}, "sideways": sideways, "contact": {}}
    return WheelOnRail(**HEARD | parts)


@pytest.mark.parametrize("way", [(1.0, 1.0), (-1.0, 1.0), (1.0, -1.0), (-1.0, -1.0)], ids=str)
@pytest.mark.parametrize("inclination", [None, "0", "1:40", "1:20"])
def test_printed_sections_each_way_up_have_one_contact_that_the_chosen_window_holds(way, inclination):
    """S1002 on 60E1: convex, near the middle of the head, and the same whichever way heights count."""
    case = chosen(wheel_of(by=way[0]), rail_of(by=way[1]), inclination)
    right = chosen(wheel_of(), rail_of(), inclination)
    with PhysicsWarning.ignored():
        shape, expected = geometry_of(case), geometry_of(right)
    places = across.meeting_of(case).places
    assert places == pytest.approx(across.meeting_of(right).places, abs=1e-9)
    assert abs(places[1]) < 20e-3
    assert shape.semi_axes == pytest.approx(expected.semi_axes, rel=1e-6)
    assert 2.2 * max(shape.semi_axes) < case.contact.window


def test_printed_sections_along_their_arc_touch_as_those_at_even_places(tmp_path):
    """As instruments that follow the surface have them, 0.2 mm of it from point to point."""
    files = []
    for name, shape, places in (("w", printed_sections.s1002, Y), ("r", printed_sections.head_60e1, ACROSS)):
        y = np.arange(places[0], places[-1], 0.01)
        along = np.concatenate([[0.0], np.cumsum(np.hypot(np.diff(y), np.diff(shape(y))))])
        some = np.interp(np.arange(0.0, along[-1], 0.2), along, y)
        files.append(tmp_path / f"{name}.csv")
        files[-1].write_text(
            "y (mm);z (mm)\n" + "\n".join(f"{a:.4f};{b:.5f}" for a, b in zip(some, shape(some), strict=True))
        )
    found, even = chosen(*files), chosen(wheel_of(), rail_of())
    assert across.meeting_of(found).places == pytest.approx(across.meeting_of(even).places, abs=5e-5)
    with PhysicsWarning.ignored():
        shapes = [geometry_of(case).semi_axes for case in (found, even)]
    assert shapes[0] == pytest.approx(shapes[1], rel=5e-3)


@pytest.mark.parametrize(("wheel", "message"), [
    ({"by": 2.0}, r"a flange 56 mm high; allowed: .* to 42 mm. Are its heights diameters.* Halve"),
    ({"by": -2.0}, "a flange 56 mm high"),
    ({"moved": 70.0}, "the top of a flange at 15 mm; .*count from the back of the flange.* Subtract 70 mm"),
    ({"mirrored": True}, "a flange at 55 mm, on the field side"),
    ({"mirrored": True, "by": -1.0}, "a flange at 55 mm, on the field side"),
    ({"mirrored": True, "kept": (-25.0, 40.0)}, "rises to the field side by 1:21, where treads fall. Is it"),
    ({"unit": 1.0}, "a section 125 m wide"),
])  # fmt: skip
@pytest.mark.parametrize("inclination", ["0", "1:40"])
def test_a_printed_wheel_that_is_given_wrongly_is_refused_with_the_cause(wheel, message, inclination):
    with pytest.raises((CaseError, InputError), match=message):
        chosen(wheel_of(**wheel), rail_of(), inclination)


def told_of(case):
    with PhysicsWarning.caught() as caught:
        geometry_of(case)
    return " ".join(str(each.message) for each in caught)


def file_of_depths(folder, heights):
    """A head in a file whose heading says depth."""
    rows = (
        f"{1e3 * at:.6g};{1e3 * z:.9g}"
        for at, z in zip(np.linspace(-36e-3, 36e-3, 289), heights, strict=True)
    )
    (folder / "rail.csv").write_text("\n".join(["y (mm); depth (mm)", *rows]))
    return folder / "rail.csv"


@pytest.mark.parametrize("keys", [{"rail_inclination": "1:40"}, {}], ids=["as they lie", "levelled"])
@pytest.mark.parametrize("window", [{}, WINDOW], ids=["chosen", "given"])
def test_what_is_doubted_of_a_file_is_told_once_where_it_is_laid_out(keys, window, tmp_path):
    """However often the file is read before: to choose a window, to find where it touches."""
    track = HEARD["track"] | {"rail_profile": file_of_depths(tmp_path, HEAD.heights)}
    contact = HEARD["contact"] | window
    with PhysicsWarning.caught() as caught:
        case = WheelOnRail(**HEARD | {"track": track, "contact": contact, "sideways": keys})
    assert not caught
    told = [str(each.message) for each in prepare(case).caught]
    assert sum("'depth (mm)' is taken for heights" in each for each in told) == 1


def test_what_is_doubted_of_a_file_is_the_remedy_where_it_is_refused(tmp_path):
    spiked = HEAD.heights + 15e-3 * (np.arange(289) == 10)
    told = r"a section that overhangs.*If it counts into the material, change its sign"
    with pytest.raises(CaseError, match=told):
        case_of(rail=file_of_depths(tmp_path, spiked), rail_inclination="1:40")


def test_sections_that_are_hardly_meant_are_doubted():
    """Upside down without a flange to show it, places from an edge of the head, a diameter for a radius."""
    flat = {"kept": (-25.0, 40.0)}
    assert "the tread rises to the field side by 1:21" in told_of(
        chosen(wheel_of(by=-1.0, **flat), rail_of())
    )
    assert "the middle of the head lies at 36 mm" in told_of(chosen(wheel_of(), rail_of(moved=36.0)))
    assert "Is it the diameter?" in told_of(chosen(wheel_of(), rail_of(), radius="0.66 m"))
    with pytest.raises(InputError, match=r"falls by 1:7\.6, where treads fall by 1:40 to 1:15.*diameters"):
        told_of(chosen(wheel_of(by=2.0, **flat), rail_of()))
    levelled = told_of(chosen(wheel_of(by=2.0, **flat), rail_of(), None))
    assert "do they hold radii, no diameters" in levelled
    with pytest.raises(InputError, match=r"an edge of what is known.* Do both hold radii, no diameters\?"):
        told_of(chosen(wheel_of(by=2.0, kept=(-22.0, 22.0)), rail_of(), None))
    for wheel in (wheel_of(), wheel_of(**flat)):
        assert not told_of(chosen(wheel, rail_of()))


def test_a_flange_over_a_head_that_is_a_circle_is_told_as_the_cause():
    with pytest.raises((CaseError, InputError), match="A head that is a circle meets the flange"):
        chosen(wheel_of(), None)


def test_the_flange_of_an_outline_in_diameters_is_doubted():
    drawn = WheelSection.named("straight-web").outline(0.33)
    assert not list(doubts_of(drawn, 0.33))
    doubled = drawn * [2.0, 1.0]
    assert any("a flange 56 mm high" in each for each in doubts_of(doubled, 0.66))
