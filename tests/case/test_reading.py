"""Cases as they are read: defaults of each kind, what follows from what is given, and the template."""

import math
import sys
import tomllib

import numpy as np
import pytest
from case_texts import case_text

from asperity import BallOnBeam, Bodies
from asperity.case.cases import parse_case, read_case, template
from asperity.errors import InputError
from asperity.laws import names

WHEEL = 'kind = "wheel-on-rail"\n[surface]\nspectrum = "iso3095"\n'
DEFAULTS = {
    "ball-on-beam": {
        "speed": 1.0, "seed": 1, "duration": None, "start": None, "settling": None, "time_step": 1e-5,
        "laws": ("areal", "linear-filtered"),
        "surface.hurst": 0.8, "surface.longest": 1.6e-3, "surface.shortest": 40e-6,
        "ball.radius": 0.025, "ball.mass": None, "ball.load": None,
        "beam.length": 1.0, "beam.width": 0.05, "beam.height": 0.01,
        "beam.sensor_positions": (0.2, 0.35, 0.5, 0.65, 0.8),
        "contact.spacing": 10e-6, "contact.window": 0.5e-3, "contact.damping": 0.0, "contact.hardness": None,
        "numerics.highest_frequency": 5e3, "numerics.rtol": 1e-6,
        "settled_time": 0.2, "record_start": 0.2, "rolled_time": 0.8,
    },
    "wheel-on-rail": {
        "speed": 56.0, "seed": 1, "start": 0.0, "duration": 1.0, "settling": 0.3,
        "laws": ("areal", "linear-filtered"),
        "surface.lateral": 1.0, "surface.level": 0.0, "surface.continuation": "refuse",
        "wheel.radius": 0.46, "wheel.mass": 600.0, "wheel.load": 65e3, "wheel.transverse_radius": math.inf,
        "track.name": "x2000", "track.overrides": {}, "track.rail_head_radius": 0.3,
        "contact.spacing": 5e-4, "contact.window": 0.02, "contact.cells": 40, "contact.samples": 8,
        "numerics.highest_frequency": 5e3, "numerics.kernel": "poles", "numerics.poles": None,
        "noise.wheel_width": 0.135, "noise.sleeper_length": 2.6, "noise.sleeper_width": 0.25,
        "rolled_time": 1.0, "rolled_range": (-16.8, 56.0),
    },
}  # fmt: skip


def value(case, dotted):
    for name in dotted.split("."):
        case = getattr(case, name)
    return case


@pytest.mark.parametrize("kind", DEFAULTS)
def test_a_minimal_case_has_the_documented_defaults(kind):
    case = parse_case(case_text(kind))
    for dotted, expected in DEFAULTS[kind].items():
        numbers = np.asarray(expected).dtype.kind == "f"
        assert value(case, dotted) == (pytest.approx(expected) if numbers else expected), dotted


GIVEN = {
    "ball-on-beam": (
        """laws = ["direct", "table"]
        [surface] file = "map.npy" | pixel = "1.5625 um" | index = 2 | fill = true | direction = "30 deg"
        [beam] length = "0.8 m" | support = "free" | sensors = ["0 m", "0.8 m"]
        [contact] window = "0.64 mm" | spacing = "10 um" | approaches = ["-0.5 um", "0 um"]
        [numerics] time_step = "5 us\"""",
        {
            "laws": ("direct", "table"), "surface.index": 2, "surface.fill": True,
            "surface.pixel": 1.5625e-6, "surface.direction": math.pi / 6, "beam.support": "free",
            "beam.sensor_positions": (0.0, 0.8), "contact.approaches": (-5e-7, 0.0), "contact.cells": 64,
            "time_step": 5e-6,
        },
    ),
    "wheel-on-rail": (
        """speed = "200 km/h" | start = "3 m" | duration = "0.5 s" | settling = "0 s"
        [surface] spectrum = "levels.csv" | level = "+3 dB" | lateral = "inf"
        [wheel] line = "wheels.csv" | processing = ["spikes", "curvature"] | modes = "modes.csv"
        [track] pad_stiffness = "250 MN/m" | ballast_loss_factor = 0.4 | points = ["9 m", "9.325 m"]
        rail_profile = "rail.csv" | decay_rates = "rates.csv" | mobility = "mobility.csv"
        [noise] rail_radiation = "ratios.csv" | vehicle_length = "20 m" | measured_bands = "bands.csv\"""",
        {
            "speed": 200 / 3.6, "rolled_range": (3.0, 3.0 + 100 / 3.6), "surface.lateral": math.inf,
            "surface.level": 3.0, "wheel.processing": ("spikes", "curvature"),
            "point_positions": (9.0, 9.325), "track.pad_stiffness": 250e6, "track.ballast_damping": None,
        },
    ),
}  # fmt: skip


@pytest.mark.parametrize("kind", GIVEN)
def test_what_is_given_is_in_si(kind, source):
    text, expected = GIVEN[kind]
    case = parse_case(case_text(kind, text), source)
    for dotted, wanted in expected.items():
        found = value(case, dotted)
        assert found == wanted or found == pytest.approx(wanted), dotted
    if kind == "wheel-on-rail":
        built = case.track.model()
        assert (built.pad_stiffness, built.ballast_damping) == (250e6, None)


@pytest.mark.parametrize("kind", ["ball-on-beam", "wheel-on-rail"])
@pytest.mark.parametrize("law", names())
@pytest.mark.parametrize(
    "surface", ['spectrum = "iso3095"', 'rms = "1 um"', 'line = "line.csv"', "smooth = true"]
)
def test_a_law_may_be_asked_for_where_its_texture_is_known(law, surface, kind, source):
    """Over a rail, whose lines lie in strips, each one; over a beam what needs no more than a line."""
    text = case_text(kind, f'laws = ["{law}"] | [surface] {surface}')
    bare = kind == "ball-on-beam" and surface[:4] in ("spec", "line")
    if not bare or law in ("hertz", "hertz-filtered", "linear", "linear-filtered"):
        assert parse_case(text, source).laws == (law,)
    else:
        with pytest.raises(InputError, match=rf'"{law}" (with a path given as a line|without samples)'):
            parse_case(text, source)


def test_a_line_takes_laws_out_of_the_default_that_need_more_than_a_line(source):
    beside = parse_case(case_text("ball-on-beam", '[surface] rms = "1 um" | line = "line.csv"'), source)
    assert beside.laws == ("shifted", "linear-filtered")
    alone = parse_case(case_text("ball-on-beam", '[surface] spectrum = "iso3095"'))
    assert alone.laws == ("hertz-filtered", "linear-filtered")


@pytest.mark.parametrize("text", [
    '[surface] corrugation = "25 um" | corrugation_wavelength = "40 mm"',
    '[surface] joint_depth = "1 mm"',
    '[surface] | [wheel] roughness = "disc"',
    '[surface] | [wheel] line = "wheels.csv"',
    '[surface] | [wheel] flat_depth = "0.5 mm"',
])  # fmt: skip
def test_any_defect_or_roughness_is_a_texture(text, source):
    case = parse_case(case_text("wheel-on-rail", text), source)
    assert case.surface.has_texture or case.wheel.has_own_texture or case.wheel.flat


def test_points_are_by_default_over_a_sleeper_and_at_mid_span_in_the_middle_of_the_run():
    sleeper, mid_span = parse_case(case_text("wheel-on-rail", 'start = "3 m"')).point_positions
    assert sleeper / 0.6 == pytest.approx(round(sleeper / 0.6))
    assert mid_span - sleeper == pytest.approx(0.3)
    assert abs(sleeper - 31.0) <= 0.3


@pytest.mark.parametrize(("kind", "speed", "spacing", "highest", "wanted"), [
    ("ball-on-beam", "1 m/s", "12 um", "5 kHz", 1e-5),
    ("ball-on-beam", "3 m/s", "2 um", "5 kHz", 1e-5),
    ("ball-on-beam", "0.1 m/s", "8 um", "1 kHz", 5e-5),
    ("wheel-on-rail", "7 m/s", "0.5 mm", "5 kHz", 25e-6),
    ("wheel-on-rail", "56 m/s", "1 mm", "5 kHz", 25e-6),
])  # fmt: skip
def test_the_default_time_step_is_on_the_grid_where_that_is_near(kind, speed, spacing, highest, wanted):
    waves, on_grid = "2 mm" if kind == "wheel-on-rail" else "32 um", spacing != "1 mm"
    text = f'speed = "{speed}" | [surface] rms = "0.5 um" | shortest = "{waves}" | '
    text += f'[contact] spacing = "{spacing}" | [numerics] highest_frequency = "{highest}"'
    case = parse_case(case_text(kind, text))
    cells = case.speed * case.time_step / case.contact.spacing
    assert 0.5 < case.time_step / wanted <= 2**0.5 * (1 + 1e-9)
    assert (cells == pytest.approx(round(cells)) or 1 / cells == pytest.approx(round(1 / cells))) is on_grid


@pytest.mark.parametrize(("top", "settled", "start", "rolled"), [
    ("", 0.2, 0.2, 0.8),
    ('speed = "5 m/s"', 0.05, 0.25, 0.15),  # a quarter of the beam at most
    ('duration = "30 ms"', 0.05, 0.05, 0.03),
    ('duration = "0.12 s"', 0.12, 0.12, 0.12),
    ('duration = "0.9 s"', 0.1, 0.1, 0.9),  # records keep their length
    ('start = "0.47 m" | duration = "30 ms"', 0.05, 0.47, 0.03),
    ('start = "20 mm" | duration = "30 ms"', 0.02, 0.02, 0.03),  # no beam before its start
    ('settling = "0.4 s"', 0.4, 0.4, 0.6),
    ('start = "0.6 m" | settling = "0.6 s" | duration = "0.4 s"', 0.6, 0.6, 0.4),
])  # fmt: skip
def test_a_ball_settles_before_its_record(top, settled, start, rolled):
    case = parse_case(case_text("ball-on-beam", top))
    assert (case.settled_time, case.record_start, case.rolled_time) == pytest.approx((settled, start, rolled))
    first, last = case.rolled_range
    assert first == pytest.approx(start - case.speed * settled, abs=1e-12)
    assert -1e-12 < first < last <= 1.0 + 1e-12


def test_a_flat_is_given_by_depth_length_or_both():
    """l = √(8 R d): 40 mm long on a wheel of 0.46 m is 0.4348 mm deep."""

    def flat(keys):
        return parse_case(case_text("wheel-on-rail", f"[wheel] {keys}")).wheel.flat

    assert flat('mass = "600 kg"') is None
    assert flat('flat_length = "40 mm" | flat_position = "1 m"') == pytest.approx((0.04**2 / 3.68, 0.04))
    assert flat('flat_depth = "0.4 mm"') == pytest.approx((0.4e-3, np.sqrt(3.68 * 0.4e-3)))
    both = 'flat_depth = "0.4 mm" | flat_length = "38 mm"'
    assert flat(both) == pytest.approx((0.4e-3, np.sqrt(3.68 * 0.4e-3)))
    worn = flat('flat_depth = "0.4 mm" | flat_length = "60 mm" | flat_shape = "worn"')
    assert worn == pytest.approx((0.4e-3, 0.06))


def test_a_case_is_read_from_its_file_whatever_its_editor_puts_before_it(source):
    source.write_text(case_text("ball-on-beam", '[surface] file = "map.npy"'), encoding="utf-8-sig")
    assert read_case(source).surface.file == source.parent / "map.npy"


# --- the template, the demonstration and the list of parameters


@pytest.mark.parametrize(("kind", "plain", "differing"), [
    ("ball-on-beam",
     BallOnBeam(duration=0.12, settling=0.3, surface={"rms": 1e-7}, ball={"load": 50.0}),
     ["duration", "settling", "surface.rms", "ball.load"]),
    ("wheel-on-rail", parse_case(case_text("wheel-on-rail", '[wheel] roughness = "disc"')),
     ["surface.spectrum", "wheel.roughness"]),
    ("bodies", Bodies(duration=0.12, settling=0.3, surface={"rms": "0.1 um"}, body={"load": 50}),
     ["duration", "settling", "surface.rms", "body.load"]),
])  # fmt: skip
def test_the_template_is_a_case_with_the_defaults_and_explains_each_key(kind, plain, differing):
    case, comments = parse_case(template(kind)), {}
    assert case == plain
    assert [item["key"] for item in case.parameters() if not item["is_default"]] == differing
    for line in template(kind).splitlines():
        code, _, comment = line.removeprefix("# ").partition("  # ")
        if " = " in code and comment:
            comments[code.split(" = ")[0]] = comment
            tomllib.loads(code)  # what is commented out is TOML as well
    assert {item["key"].split(".")[-1] for item in case.parameters()} <= comments.keys()
    assert {"file", "array", "spectrum", "hardness", "time_step"} <= comments.keys()
    assert all("default" in comment for comment in comments.values())


@pytest.mark.parametrize(("kind", "wanted", "others"), [
    ("ball-on-beam", "load mass sensors approaches hardness filter_taps time_step sample_length duration",
     "rms settling"),
    ("wheel-on-rail",
     "corrugation corrugation_wavelength corrugation_bandwidth joint_depth joint_position flat_depth "
     "flat_length bending_stiffness mass_per_length rail_loss_factor shear_stiffness rotary_inertia "
     "pad_stiffness pad_damping sleeper_mass ballast_stiffness ballast_loss_factor sleeper_spacing "
     "points time_step",
     "spectrum roughness laws"),  # those that the template writes are not those over a flat
])  # fmt: skip
def test_keys_that_the_template_holds_in_comments_work(kind, wanted, others, source):
    beginnings = tuple(f"# {key} =" for key in wanted.split())
    lines = template(kind).splitlines()
    text = "\n".join(line.removeprefix("# ") if line.startswith(beginnings) else line for line in lines)
    listed = parse_case(text, source).parameters()
    changed = {item["key"].split(".")[-1] for item in listed if not item["is_default"]}
    assert changed == {*wanted.split(), *others.split()}


def test_parameters_are_listed_with_units_and_marked():
    text = 'speed = "1000 mm/s" | [ball] radius = "12 mm" | [beam] sensors = ["0.5 m"] | support = "clamped"'
    listed = {item["key"]: item for item in parse_case(case_text("ball-on-beam", text)).parameters()}
    shown = {"value": "12 mm", "default": "25 mm", "is_default": False, "note": "rolling radius"}
    assert listed["ball.radius"] == {"key": "ball.radius", **shown}
    expected = {
        "speed": ("1 m/s", True),
        "beam.sensors": ("0.5 m", False),
        "ball.load": ("the weights", True),
    }
    assert {key: (listed[key]["value"], listed[key]["is_default"]) for key in expected} == expected
    assert not {"surface.file", "surface.level", "surface.array", "beam.suspension_frequency"} & listed.keys()


@pytest.mark.parametrize(("kind", "sections", "most"), [
    ("ball-on-beam", """
laws = ["areal", "shifted", "printed", "table", "linear-filtered", "linear"]
surface = {rms = "0.1 um", hurst = 0.8, anisotropy = 1.0, lay = "0 deg"}
ball = {radius = "25 mm", material = "steel", load = "50 N"}
beam = {length = "10 m", width = "50 mm", height = "10 mm", material = "steel", support = "free"}
contact = {samples = 8, damping = "0 N s/m", datum = "samples", linearise = "hertz", hardness = "3 GPa"}
numerics = {highest_frequency = "5 kHz"}""", 543),
    ("wheel-on-rail", """
laws = ["areal", "linear-filtered"]
start = "1 m"
surface = {rms = "5 um", hurst = 0.8, longest = "60 mm", shortest = "2 mm"}
contact = {spacing = "0.5 mm", window = "30 mm", samples = 4, damping = "0 N s/m"}
numerics = {highest_frequency = "5 kHz"}
wheel = {radius = "0.46 m", mass = "600 kg", load = "65 kN", material = "steel", transverse_radius = "inf"}
track = {pad_stiffness = "300 MN/m", sleeper_spacing = "0.6 m", sleeper_mass = "150 kg"}""", 837),
])  # fmt: skip
def test_reading_a_case_of_24_keys_again_takes_few_calls(kind, sections, most):
    """Of Python functions, those of the reader of TOML left out: what follows of keys is worked out once.

    At most a third of what was called when each was asked for again and again: 1,630 and 2,512.
    """
    head = f'kind = "{kind}"\nspeed = "20 m/s"\nseed = 3\nduration = "0.12 s"\nsettling = "50 ms"'
    text = head + sections
    data = tomllib.loads(text)
    held = [each for each in data.values() if isinstance(each, dict)]
    assert len(data) + sum(len(each) - 1 for each in held) == 24
    parse_case(text)
    calls = 0

    def count(frame, event, argument):
        nonlocal calls
        calls += event == "call" and "tomllib" not in frame.f_code.co_filename

    before = sys.getprofile()
    sys.setprofile(count)
    try:
        parse_case(text)
    finally:
        sys.setprofile(before)
    assert 200 < calls < most
