"""The case of a ball bearing: what follows from its keys, what is refused, what it reads."""

import math
import re
from copy import deepcopy

import numpy as np
import pytest

from asperity.case.cases import as_case, parse_case, template
from asperity.errors import CaseError, InputError
from asperity.scenarios.prepared_bearing import expected, prepare_bearing
from asperity.scenes.computed_bearing import bearing_rings
from asperity.structures.modal import ModalStructure
from asperity.structures.ring import Ring
from asperity.studies.definition import study_of
from refusals import refusals

CASE = {"kind": "ball-bearing", "bearing": {"name": "6205"}, "axial": "100 N"}
TIGHT = {"name": "6205", "clearance": "-4 um"}
PIT = {"on": "outer", "length": "0.18 mm", "depth": "0.1 mm"}


test_what_cannot_be_is_told = refusals(
    ({"axial": "0 N"}, r"radial: received none; allowed: a radial or axial load"),
    ({"bearing": {"name": "6205", "balls": 20}}, r"bearing\.balls: received 20 of 7.94 mm .* side by side"),
    ({"bearing": {"balls": 9}}, r"bearing\.name: received none, and no ball_diameter and no"),
    ({"bearing": {"name": "6205", "clearance": "-0.2 mm"}}, r"bearing\.clearance: .* which presses the ball"),
    ({"bearing": TIGHT, "axial": "0 N", "radial": "0 N", "speed": "60000 1/min"},
     r"speed: received 60000 1/min, which lifts balls off .* allowed: less than \d+ 1/min"),
    ({"axial": "100 N", "radial": "0 N", "speed": "500 Hz"},
     r'30000 1/min, by which balls push the outer ring off with 117 N along .* 27800 1/.* write "500 1/min"'),
    ({"axial": "100 kN"}, r"of one ball on the inner ring, a contact that fills 0\.79 rad of the groove"),
    ({"laws": ["hertz", "hertz"]}, r'laws: received "hertz" more than once'),
    ({"laws": ["prinetd"]}, r'laws\[1\]: received \'prinetd\'; .*"table", "direct", "hertz"'),
    ({"cage_slip": [0.1]}, "at least 2"),
    ({"cage_slip": [0.1, 0.05]}, r"cage_slip: received 0.1, 0.05; allowed: two values that do not fall"),
    ({"envelope_band": ["2 kHz", "30 kHz"]}, r"envelope_band: received up to 30000 Hz; .* 25600 Hz"),
    ({"envelope_band": ["2 kHz", "2.1 kHz"]}, r"received a width of 100 Hz; .* fastest tone, 16"),
    ({"duration": "10 ms"}, r"duration: received 10 ms; allowed: at least .* slowest tone comes 5 times"),
    ({"duration": "1000 s", "time_step": "1 us"}, r"received 9.2·10⁹ time steps of balls; allowed: at most"),
    ({"shaft": {"radial_stiffness": "0 N/m"}}, r"shaft\.radial_stiffness: received 0 N/m of \[shaft\]"),
    ({"housing": {"width": "10 mm"}}, r"housing\.width: received 0.01 m; allowed: only together with lobes"),
    ({"inner_raceway": {"waves": [3]}}, r"inner_raceway\.waves: received 1 wave and 0 amplitudes"),
    ({"fault": {"length": "0.2 mm"}}, r'fault\.on: received nothing; allowed: "outer", "inner", "ball"'),
    (
        {"fault": {"on": "outer"}},
        r"fault\.length of a fault, a pit: received nothing; "
        r"allowed: a length along the path, as 0.18 mm. Give its length",
    ),
    (
        {"fault": {"on": "outer", "shape": "map", "length": "1 mm"}},
        r"fault\.length of a fault, a map: received one; allowed: none: a map has its own. Remove its length",
    ),
    ({"fault": PIT | {"on": "ball", "ball": 10}}, r"fault\.ball: received 10; allowed: 1 to 9"),
    ({"fault": PIT | {"ball": 2}}, r'fault\.ball: received 2; allowed: only together with on = "ball"'),
    ({"fault": [{}, PIT]}, r"fault\.on: received nothing; .* Or remove the section"),
    ({"fault": [PIT, {"on": "inner"}]}, r"fault\[2\]\.length of a fault, a pit: received nothing"),
    ({"fault": PIT, "fault[3]": PIT}, r"fault\[3\]: received one without fault\[2\]"),
    ({"shaft": [{}, {}]}, r"shaft\[2\]: received an unknown key"),
    of=lambda keys: as_case(CASE | keys),
    error=CaseError,
)  # fmt: skip


test_what_no_raceway_has_is_refused = refusals(
    (
        {"outer_raceway": {"waviness": "0.5 mm"}},
        r"outer_raceway.waviness: .* all around.* at most 100.* unit",
    ),
    ({"balls": {"waves": [1], "amplitudes": ["0.5 mm"]}}, r"balls.amplitudes: received 500 µm"),
    (
        {"inner_raceway": {"roughness": "90 um", "shortest": "50 um"}},
        r"inner_raceway.roughness: .* all around",
    ),
    of=lambda keys: prepare_bearing(as_case(CASE | keys)),
    error=(CaseError, InputError),
)


@pytest.mark.parametrize(
    "keys", [{"housing": {"axial_stiffness": "10 MN/m"}}, {"centrifugal": False}, {"axial": "150 N"}]
)
def test_an_outer_ring_that_is_held_or_loaded_more_is_not_pushed_off(keys):
    assert not list(as_case(CASE | {"speed": "500 Hz"} | keys).problems())


@pytest.mark.parametrize(
    ("keys", "told"),
    [
        ({"speed": "450 Hz"}, r'speed = 450 Hz is 27000 1/min, 1.1·10⁶.* Then write "450 1/min"'),
        (
            {"fault": PIT | {"shape": "spall", "length": "17 mm", "width": "1 mm"}},
            r"raceway is 17 mm long, .* are 16\.36 mm",
        ),
        ({"outer_raceway": {"waves": [4], "amplitudes": ["50 um"]}}, r"Waves all around of ± 50 µm are"),
        ({"bearing": {"name": "6205", "clearance": "-100 um"}}, r"-100 µm alone presses .* a looser fit"),
        ({"bearing": {"name": "6205", "clearance": "-20 um"}}, r"-20 µm presses every .* GPa, .* unit right"),
        ({"axial": "6 kN"}, r"Lower the load"),
    ],
)
def test_what_hardly_anybody_means_is_told(keys, told):
    """A speed in Hz, a spall that holds two balls, waves of many approaches, a fit that presses."""
    caught = [str(each.message) for each in prepare_bearing(as_case(CASE | keys)).caught]
    assert any(re.search(told, each) for each in caught), caught
    if "fit" in told:
        assert not any("Lower the load" in each for each in caught)


def test_a_bare_speed_is_asked_for_in_turns_per_minute():
    text = 'kind = "ball-bearing"\nspeed = 1800\naxial = "1 N"\n[bearing]\nname = "6205"\n'
    with pytest.raises(CaseError, match=r'as "1800 1/min".*"1800 Hz" if .* \(Hz\), "1800 1/min" if in that'):
        parse_case(text)


def test_an_ordinary_bearing_is_not_doubted():
    plain = CASE | {"outer_raceway": {"waviness": "0.5 um"}, "fault": PIT, "radial": "100 N"}
    assert not prepare_bearing(as_case(plain)).caught
    tight = {"bearing": {"name": "6205", "clearance": "-8 um"}}  # as spindles have it
    assert not prepare_bearing(as_case(plain | tight)).caught
    eccentric = {"inner_raceway": {"waves": [1], "amplitudes": ["30 um"]}}  # moves the ring, not the balls
    assert not prepare_bearing(as_case(CASE | eccentric)).caught


def test_the_commented_case_is_a_case_of_smooth_parts():
    case = parse_case(template("ball-bearing"))
    assert (case.bearing.name, case.axial, case.has_smooth_balls, case.faults) == ("6205", 100.0, True, {})
    assert parse_case(case.to_toml()) == case
    assert case.with_(fault={"on": "ball", "length": 1e-4, "depth": 1e-5}).has_smooth_balls is False


def test_several_faults_are_a_list_whose_sections_have_numbers(tmp_path):
    on_ball = PIT | {"on": "ball", "ball": 3}
    case = as_case(CASE | {"fault": [PIT, on_ball, PIT | {"on": "inner"}]})
    assert case.to_toml().count("[[fault]]") == 3
    assert parse_case(case.to_toml()) == case == deepcopy(case)
    assert [each.on for each in case.faults.values()] == ["outer", "ball", "inner"]
    assert {"fault.length", "fault[2].ball", "fault[3].on"} <= {each["key"] for each in case.parameters()}
    deeper = case.with_(**{"fault[3].depth": "0.2 mm"})
    assert [each.depth for each in deeper.faults.values()] == pytest.approx([1e-4, 1e-4, 2e-4])
    assert list(case.with_(**{"fault[3]": None}).faults) == ["fault", "fault[2]"]
    assert case.with_known(speed=25.0).faults == case.faults
    assert case.with_(fault=[on_ball]) == as_case(CASE | {"fault": on_ball})  # one is as it always was
    assert case.with_(fault=None) == as_case(CASE)
    (tmp_path / "case.toml").write_text(case.to_toml())
    third = {"fault[4].on": "outer", "fault[4].length": "1 mm", "fault[4].depth": "10 um"}
    found = study_of(tmp_path / "case.toml", {"fault[2].ball": [1, 9], "variant": {"one more": third}})
    told = [(member.case.faults["fault[2]"].ball, len(member.case.faults)) for member in found.members()]
    assert told == [(1, 3), (1, 4), (9, 3), (9, 4)]


def test_the_time_step_divides_a_sample_and_resolves_a_ball_between_the_rings():
    case = as_case(CASE)
    of, at_rest = case.bearing.bearing, case.static  # dQ/dδ = 1.5 Q^(1/3) K^(2/3) of Hertz
    loads = (of.inner_contact, at_rest.inner_load), (of.outer_contact, at_rest.outer_load)
    stiffness = sum(1.5 * each.max() ** (1 / 3) * law.stiffness_constant ** (2 / 3) for law, each in loads)
    mass = math.pi / 6.0 * 7.94e-3**3 * of.ball_material.density
    resonance = math.sqrt(stiffness / mass) / (2.0 * math.pi)
    assert case.ball_resonance == pytest.approx(resonance, rel=1e-9)
    assert case.step == pytest.approx(1.0 / (51_200.0 * case.steps_per_sample), rel=1e-12)
    assert 0.1 / resonance / (1.0 + 1.0 / case.steps_per_sample) <= case.step <= 0.1 / resonance
    assert case.with_(time_step="10 us").step == pytest.approx(1.0 / (51_200.0 * 2), rel=1e-12)
    slow = case.with_(sampling_rate="1 MHz", envelope_band=None)
    assert slow.step == pytest.approx(1e-6 / math.ceil(10.0 / 2.56), rel=1e-12)


def test_centrifugal_force_is_what_the_outer_ring_carries_beside_the_inner_one():
    turning = as_case(CASE | {"axial": "0 N", "radial": "50 N"})
    (_, inner), (_, outer) = turning.contacts
    resting = turning.with_(centrifugal=False).contacts
    assert resting[0][1] == pytest.approx(resting[1][1], rel=1e-9)
    of = turning.bearing.bearing
    cosine = 1.0 - 10e-6 / (2.0 * 0.04 * 7.94e-3)  # of the free contact angle, by the clearance
    cage = 15.0 * (1.0 - 7.94 / 39.04 * cosine)
    lift = 0.5 * of.ball_mass * 39.04e-3 * (2.0 * math.pi * cage) ** 2
    assert outer - inner == pytest.approx(lift, rel=1e-6)


def trace(path, turned=360.0, drift=0.0):
    angle = np.linspace(0.0, turned, 361)
    deviation = 3.0 * np.cos(np.radians(5.0 * angle)) + drift * angle / 360.0
    rows = "\n".join(f"{a},{d}" for a, d in zip(angle, deviation, strict=True))
    path.write_text(f"angle (deg),deviation (um)\n{rows}\n")
    return path


RING = Ring.bending(0.06, 25e-3, 300.0, 0.3, most_lobes=3, damping_ratio=0.01)


def table_of_modes(path, until=360, last=1.0, lowest=None, angle="angle (deg)"):
    """Lobes cos nψ and sin nψ of a ring, in kHz, degrees and with their modal masses."""
    psi = np.arange(0.0, until + 1.0, 5.0)
    shapes = np.cos(np.outer(np.radians(psi), RING.lobes) - RING.phases)
    shapes[-1] *= last
    frequency = RING.frequencies / 1e3
    frequency[0] = frequency[0] if lowest is None else lowest
    head = [["frequency (kHz)", *frequency], ["damping ratio", *RING.damping], [angle, *"abcd"]]
    rows = [["modal mass (kg)", *RING.radial**-2.0], *head, *np.column_stack([psi, shapes])]
    path.write_text("\n".join(",".join(map(str, row)) for row in rows))
    return str(path)


def test_rings_bend_in_the_modes_of_a_file(tmp_path):
    """As the ring does whose modes they are, in closed form."""
    file = table_of_modes(tmp_path / "around.csv")
    case = as_case(CASE | {"housing": {"modes": file}, "shaft": {"modes": file}})
    assert parse_case(case.to_toml()) == case
    rings, psi = bearing_rings(case), np.linspace(-1.0, 9.0, 40)
    for found in (rings.inner_bending, rings.outer_bending):
        assert found.natural_frequencies == pytest.approx(RING.frequencies, rel=1e-12)
        assert found.damping_ratios == pytest.approx(RING.damping)
        expected = math.cos(case.static.contact_angle) / math.cos(0.3) * RING.shapes(psi)[0]
        assert found.shapes(psi)[0] == pytest.approx(expected, abs=2e-4 * np.abs(expected).max())
    angles = np.linspace(0.0, 2.0 * np.pi, 73)
    held = ModalStructure(angles, RING.frequencies, RING.damping, RING.shapes(angles)[0] / math.cos(0.3))
    assert as_case(CASE | {"housing": {"modes": held}}).housing.bending(0.0).extent == (-math.inf, math.inf)


def bytes_of_modes(path):
    path.write_bytes(b"\x00\x89HDF")
    return str(path)


test_files_that_do_not_go_around_are_refused = refusals(
    ("modes", table_of_modes, {"until": 355}, r"6\.19592 \(angles of modes \(rad\)\); allowed: 0 to 2π"),
    ("modes", table_of_modes, {"last": 0.9}, r"apart \(modes around a circle\); .* Repeat the first row"),
    (
        "modes",
        table_of_modes,
        {"lowest": 0.0},
        r"housing.modes: received one of 0 Hz; .* modes that bend",
    ),
    ("modes", table_of_modes, {"angle": "position (mm)"}, r"angle \(rad\) and mode shapes"),
    ("modes", table_of_modes, {"angle": "angle"}, r"no unit of the angle"),
    ("modes", bytes_of_modes, {}, r"housing.modes: received"),
    ("trace", trace, {"drift": 2.0}, r"outer_raceway.trace.*ends that differ by 2 um"),
    ("trace", trace, {"turned": 300.0}, "300 deg in around.csv; allowed: one turn, 360 deg"),
    of=lambda key, write, how, tmp_path: as_case(
        CASE | {{"modes": "housing"}.get(key, "outer_raceway"): {key: write(tmp_path / "around.csv", **how)}}
    ),
    error=CaseError,
)


def test_a_plan_says_how_many_balls_speed_lifts_off_the_inner_ring():
    """At rest those near the load; fast those alone that are pressed by more than the centrifugal force."""
    case = as_case(CASE | {"axial": "0 N", "radial": "100 N", "speed": "60000 1/min"})
    touching, resting = (
        (each.static.inner_load > 0.0).sum(axis=1) for each in (case, case.with_(centrifugal=False))
    )
    rest = resting.mean()
    assert rest > touching.mean() + 0.3
    told = dict(expected(prepare_bearing(case))[0])["balls that touch both rings"]
    assert told == f"{touching.mean():.3g} of 9 on average, {touching.min()} or more; at rest {rest:.3g}"


def test_a_roundness_trace_is_read_with_its_units(tmp_path):
    case = as_case(CASE | {"outer_raceway": {"trace": str(trace(tmp_path / "round.csv"))}})
    waves = np.abs(case.outer_raceway.texture().line(4096, 1))
    assert waves[5] == pytest.approx(3e-6, rel=1e-3)
    assert np.delete(waves, 5).max() < 1e-9


test_a_fault_off_the_raceway_is_refused_before_the_run = refusals(
    ({"on": "outer", "length": "0.2 mm", "depth": "10 um", "offset": "5 mm"}, r"fault.offset: received 5 mm"),
    (
        {"on": "inner", "length": "5 mm", "depth": "10 um", "count": 90},
        r"fault.length: received 5 mm, 90",
    ),
    of=lambda fault: prepare_bearing(as_case(CASE | {"fault": fault})),
)


def test_a_bearing_without_a_name_has_defaults_that_are_told():
    sizes = {"rollers": 13, "roller_diameter": "7 mm", "roller_length": "8 mm", "pitch_diameter": "39 mm"}
    given = sizes | {"taper": "4 deg", "contact_angle": "14 deg", "crowning": "logarithmic"}
    keys = {"kind": "roller-bearing", "radial": "1 kN", "axial": "1 kN", "bearing": given}
    rows = {row["key"].removeprefix("bearing."): row for row in as_case(keys).parameters()}
    told = {name: (rows[name]["value"], rows[name]["default"]) for name in ("taper", "slices", "crowning")}
    assert told == {"taper": ("4 deg", "0 deg"), "slices": ("41", "41"), "crowning": ("logarithmic",) * 2}
    assert rows["crowning"]["is_default"]
    assert not rows["rollers"]["is_default"]
    sizes = {"balls": 9, "ball_diameter": "7.94 mm", "pitch_diameter": "39 mm"}
    of_balls = as_case({"kind": "ball-bearing", "radial": "1 kN", "bearing": sizes}).parameters()
    rows = {row["key"]: row["value"] for row in of_balls}
    assert rows["bearing.arch_angle"] == "grooves of one arc"
    assert rows["bearing.inner_conformity"] == "0.52"


def test_a_key_without_its_companion_is_told_once_with_its_unit():
    """Not again by the bearing that is made of it."""
    rib = {"rib_stiffness": "300 MN/m", "rib_height": "1 mm"}
    with pytest.raises(CaseError) as caught:
        as_case({"kind": "roller-bearing", "radial": "1 kN", "bearing": {"name": "NU205"} | rib})
    assert [str(each) for each in caught.value.errors] == [
        "bearing.rib_height: received 0.001 m; allowed: only together with taper.",
        "bearing.rib_stiffness: received 300 MN/m; allowed: only together with taper.",
    ]
