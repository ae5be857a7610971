"""The case of a wheel on a rail: every key, every default, and one test for each thing that can be wrong."""

import math
import tomllib

import numpy as np
import pytest

from asperity.case.cases import load_case, parse_case, template
from asperity.case.tables import (
    read_levels,
    read_mode_shapes,
    read_modes,
    read_ratios,
    read_receptance,
)
from asperity.case.wheel_on_rail import WheelOnRail
from asperity.errors import CaseError, InputError
from asperity.laws import names

INTERFACE = """
kind = "wheel-on-rail"
speed = "56 m/s"
seed = 1

[surface]
spectrum = "iso3095"
level = "+0 dB"

[wheel]
radius = "0.46 m"
mass = "600 kg"
load = "65 kN"
transverse_radius = "inf"

[track]
name = "nordborg"
rail_head_radius = "0.3 m"
"""
LEVELS = "wavelength (mm), level (dB re 1 um)\n100, 3\n80, 2\n63, 1\n50, 0\n"


def case_with(top="", surface='spectrum = "iso3095"', **sections):
    """Text of a case from pieces."""
    lines = ['kind = "wheel-on-rail"', top, "[surface]", surface]
    for title, keys in sections.items():
        lines += [f"[{title}]", keys]
    return "\n".join(lines)


@pytest.fixture
def folder(tmp_path, monkeypatch):
    """A folder with the files that cases name."""
    monkeypatch.chdir(tmp_path)
    (tmp_path / "levels.csv").write_text(LEVELS)
    (tmp_path / "ratios.csv").write_text("frequency (kHz), ratio\n0.1, 0.01\n1, 0.8\n")
    (tmp_path / "modes.csv").write_text(
        "frequency (Hz), ratio, mass (kg)\n2000, 1e-4, 300\n3100, 1e-4, 250\n"
    )
    rows = "frequency (Hz), real (m/N), imaginary (m/N)\n"
    rows += "".join(f"{100 * n}, {-1e-9 / n:.3g}, -1e-11\n" for n in range(1, 30))
    (tmp_path / "receptance.csv").write_text(rows)
    for name in ("lines.npz", "map.npy", "tread.csv", "rail.csv"):
        (tmp_path / name).write_bytes(b"heights")
    return tmp_path


def errors_of(text, source="case.toml"):
    with pytest.raises(CaseError) as caught:
        parse_case(text, source)
    assert caught.value.exit_code == 2
    return caught.value.errors


# --- what a case holds


def test_the_case_of_the_interface():
    case = parse_case(INTERFACE)
    assert isinstance(case, WheelOnRail)
    assert (case.speed, case.wheel.radius, case.wheel.mass, case.wheel.load) == (56.0, 0.46, 600.0, 65e3)
    assert case.wheel.transverse_radius == math.inf
    assert (case.track.name, case.track.rail_head_radius) == ("nordborg", 0.3)
    assert case.surface.spectrum == "iso3095"
    assert case.track_model().bending_stiffness == pytest.approx(4.725e6)


def test_a_minimal_case_has_the_documented_defaults():
    case = parse_case(case_with())
    assert (case.speed, case.start, case.duration, case.settling, case.seed) == (56.0, 0.0, 1.0, 0.3, 1)
    assert case.laws == ("areal", "shifted", "printed", "linear-filtered", "linear")
    assert (case.contact.spacing, case.contact.window, case.contact.cells) == pytest.approx((5e-4, 0.02, 40))
    assert case.contact.samples == 8
    assert (case.surface.lateral, case.surface.level, case.surface.continuation) == (1.0, 0.0, "refuse")
    assert (case.track.name, case.track.overrides) == ("x2000", {})
    assert (case.numerics.highest_frequency, case.numerics.kernel, case.numerics.poles) == (
        5e3,
        "poles",
        None,
    )
    noise = case.noise
    assert (noise.track_pad, noise.wheel_transfer, noise.rail_radiation, noise.axles) == (None,) * 4
    assert case.axles == 1
    widths = (noise.rail_foot_width, noise.rail_head_width, noise.wheel_width)
    assert widths == pytest.approx((0.15, 0.072, 0.135))
    assert (noise.sleeper_length, noise.sleeper_width) == pytest.approx((2.6, 0.25))
    assert case.rolled_time == 1.0
    assert case.rolled_range == pytest.approx((-16.8, 56.0))


def test_every_key_is_understood(folder):
    text = case_with(
        'speed = "200 km/h"\nlaws = ["direct", "table"]\nstart = "3 m"\nduration = "0.5 s"\nsettling = "0 s"',
        'spectrum = "levels.csv"\nlevel = "+3 dB"\nlateral = "inf"\n'
        'accept_levels = true\ncorrugation = "25 um"\ncorrugation_wavelength = "40 mm"\n'
        'corrugation_bandwidth = 0.3\njoint_depth = "1 mm"\njoint_length = "0.8 m"\njoint_position = "9 m"',
        wheel='radius = "0.4 m"\nmass = "500 kg"\nload = "50 kN"\ntransverse_radius = "2 m"\n'
        'modes = "modes.csv"\nline = "lines.npz"\nline_array = "worn"\nline_unit = "um"\n'
        'line_spacing = "1 mm"\nline_distance = "5 mm"\nprocessing = ["spikes", "curvature"]\n'
        'flat_depth = "0.5 mm"\nflat_shape = "worn"\nflat_position = "1 m"',
        track='name = "uic60"\nbending_stiffness = "6 MN m^2"\nmass_per_length = "61 kg/m"\n'
        'rail_loss_factor = 0.01\nshear_stiffness = "240 MN"\nrotary_inertia = "0.2 kg m"\n'
        'pad_stiffness = "250 MN/m"\npad_damping = "20 kN s/m"\nsleeper_mass = "140 kg"\n'
        'ballast_stiffness = "100 MN/m"\nballast_loss_factor = 0.4\nsleeper_spacing = "0.65 m"\n'
        'rail_profile = "rail.csv"\npoints = ["9 m", "9.325 m"]',
        contact='spacing = "0.4 mm"\nwindow = "16 mm"',
        numerics='highest_frequency = "4 kHz"\ntime_step = "20 us"\nkernel = "poles"\npoles = 80',
        noise='track_pad = "soft"\nwheel_transfer = "920 mm"\naxles = 4\nrail_foot_width = "140 mm"\n'
        'rail_head_width = "70 mm"\nrail_radiation = "ratios.csv"\nsleeper_length = "2.4 m"\n'
        'sleeper_width = "0.2 m"\nwheel_width = "140 mm"',
    )
    case = parse_case(text, folder / "case.toml")
    assert case.speed == pytest.approx(200 / 3.6)
    assert case.surface.spectrum == folder / "levels.csv"
    assert case.surface.lateral == math.inf
    assert (case.surface.corrugation, case.surface.corrugation_wavelength) == pytest.approx((25e-6, 0.04))
    assert case.wheel.processing == ("spikes", "curvature")
    assert (case.wheel.flat_depth, case.wheel.flat_shape) == (pytest.approx(5e-4), "worn")
    track = case.track_model()
    assert (track.bending_stiffness, track.mass_per_length) == pytest.approx((6e6, 61.0))
    assert (track.shear_stiffness, track.rotary_inertia) == pytest.approx((240e6, 0.2))
    assert (track.pad_stiffness, track.pad_damping, track.sleeper_mass) == pytest.approx((250e6, 20e3, 140))
    assert (track.ballast_stiffness, track.ballast_loss_factor) == pytest.approx((100e6, 0.4))
    assert track.ballast_damping is None
    assert case.point_positions == pytest.approx((9.0, 9.325))
    assert (case.numerics.poles, case.time_step) == (80, pytest.approx(20e-6))
    assert case.rolled_range[0] == 3.0


@pytest.mark.parametrize("law", names())
@pytest.mark.parametrize(
    "surface", ['spectrum = "iso3095"', 'rms = "1 um"', 'line = "lines.npz"', "smooth = true"]
)
def test_every_law_may_be_asked_for_over_every_texture(law, surface, folder):
    assert parse_case(case_with(f'laws = ["{law}"]', surface), folder / "case.toml").laws == (law,)


@pytest.mark.parametrize(
    ("surface", "wheel"),
    [
        ('corrugation = "25 um"\ncorrugation_wavelength = "40 mm"', ""),
        ('joint_depth = "1 mm"', ""),
        ("", 'roughness = "disc"'),
        ("", 'line = "lines.npz"'),
        ("", 'flat_depth = "0.5 mm"'),
        ("smooth = true", 'roughness = "cast-iron"'),
    ],
)
def test_any_defect_or_roughness_is_a_texture(surface, wheel, folder):
    case = parse_case(case_with("", surface, wheel=wheel), folder / "case.toml")
    assert case.surface.has_texture or case.wheel.has_own_texture or case.wheel.flat


def test_points_are_by_default_over_a_sleeper_and_at_mid_span_in_the_middle_of_the_run():
    sleeper, mid_span = parse_case(case_with('start = "3 m"')).point_positions
    assert sleeper / 0.6 == pytest.approx(round(sleeper / 0.6))
    assert mid_span - sleeper == pytest.approx(0.3)
    assert abs(sleeper - 31.0) <= 0.3


@pytest.mark.parametrize(
    ("speed", "spacing", "on_grid"),
    [
        ("56 m/s", "0.5 mm", True),
        ("20 m/s", "0.5 mm", True),
        ("7 m/s", "0.5 mm", True),
        ("56 m/s", "1 mm", False),
    ],
)
def test_the_default_time_step_is_on_the_grid_where_that_is_near(speed, spacing, on_grid):
    surface = 'rms = "1 um"\nshortest = "2 mm"'
    case = parse_case(case_with(f'speed = "{speed}"', surface, contact=f'spacing = "{spacing}"'))
    cells = case.speed * case.time_step / case.contact.spacing
    assert 1 / 1.2 <= case.time_step / 25e-6 <= 1.2
    assert (cells == pytest.approx(round(cells)) or 1 / cells == pytest.approx(round(1 / cells))) is on_grid


# --- template


def test_the_template_is_a_case_with_the_defaults():
    case = parse_case(template("wheel-on-rail"))
    plain = parse_case(case_with(wheel='roughness = "disc"'))
    assert case == plain
    assert [item["key"] for item in case.parameters() if not item["is_default"]] == [
        "surface.spectrum",
        "wheel.roughness",
    ]


def test_the_template_explains_every_key_on_one_line():
    keys = {}
    for line in template("wheel-on-rail").splitlines():
        code, _, comment = line.removeprefix("# ").partition("  # ")
        if " = " in code and comment:
            keys[code.split(" = ")[0]] = comment
            tomllib.loads(code)  # what is commented out is TOML as well
    names = {item["key"].split(".")[-1] for item in parse_case(case_with()).parameters()}
    assert names <= keys.keys()
    assert {
        "line",
        "corrugation",
        "joint_depth",
        "flat_depth",
        "modes",
        "pad_damping",
        "points",
    } <= keys.keys()
    assert all("default" in comment for comment in keys.values())


def test_every_commented_quantity_of_the_template_works():
    wanted = (
        *("corrugation", "corrugation_wavelength", "corrugation_bandwidth", "joint_depth", "joint_position"),
        *(
            "flat_depth",
            "flat_length",
            "bending_stiffness",
            "mass_per_length",
            "rail_loss_factor",
            "shear_stiffness",
        ),
        *("rotary_inertia", "pad_stiffness", "pad_damping", "sleeper_mass", "ballast_stiffness"),
        *("ballast_loss_factor", "sleeper_spacing", "points", "time_step"),
    )
    lines = template("wheel-on-rail").splitlines()
    prefixes = tuple(f"# {key} =" for key in wanted)
    text = "\n".join(line.removeprefix("# ") if line.startswith(prefixes) else line for line in lines)
    found = {item["key"].split(".")[-1] for item in parse_case(text).parameters() if not item["is_default"]}
    # the laws that the template writes down are not those over a flat
    assert found == {*wanted, "spectrum", "roughness", "laws"}


def test_a_flat_is_given_by_depth_length_or_both():
    """l = √(8 R d): 40 mm long on a wheel of 0.46 m is 0.4348 mm deep."""

    def flat(keys):
        return parse_case(case_with(wheel=keys)).wheel.flat

    assert flat("") is None
    assert flat('flat_length = "40 mm"\nflat_position = "1 m"') == pytest.approx((0.04**2 / 3.68, 0.04))
    assert flat('flat_depth = "0.4 mm"') == pytest.approx((0.4e-3, np.sqrt(3.68 * 0.4e-3)))
    both = 'flat_depth = "0.4 mm"\nflat_length = "38 mm"'
    assert flat(both) == pytest.approx((0.4e-3, np.sqrt(3.68 * 0.4e-3)))
    worn = 'flat_depth = "0.4 mm"\nflat_length = "60 mm"\nflat_shape = "worn"'
    assert flat(worn) == pytest.approx((0.4e-3, 0.06))


def test_wheel_and_rail_may_be_of_own_materials():
    own = '{ youngs_modulus = "100 GPa", poisson_ratio = 0.34, density = "8.5 g/cm^3" }'
    case = parse_case(case_with(wheel=f"material = {own}", track=f"material = {own}"))
    assert case.wheel.material == case.track.material
    assert case.wheel.material.density == pytest.approx(8500.0)


# --- what can be wrong


@pytest.mark.parametrize(
    ("section", "keys", "message"),
    [
        ("wheel", 'radius = "inf"', "wheel.radius: received 'inf'"),
        ("wheel", 'transverse_radius = "0 m"', 'a length greater than 0, or "inf", with its unit'),
        ("wheel", 'transverse_radius = "-inf"', "wheel.transverse_radius: received '-inf'"),
        ("wheel", 'modes = "modes.csv"\nreceptance = "receptance.csv"', "wheel: received both modes and rec"),
        ("wheel", 'profile = "tread.csv"\ntransverse_radius = "1 m"', "both profile and transverse_radius"),
        ("wheel", 'roughness = "disc"\nline = "lines.npz"', "wheel: received both roughness and line"),
        ("wheel", 'roughness = "disk"', 'Did you mean "disc"?'),
        ("wheel", 'roughness_level = "+3 dB"', "only together with roughness"),
        ("wheel", 'flat_shape = "worn"', "only together with flat_depth or flat_length"),
        (
            "wheel",
            'flat_depth = "0.4 mm"\nflat_length = "60 mm"',
            "wheel.flat_length: received 60 mm beside a depth of 0.4 mm; allowed: 38.37 mm, the chord "
            "sqrt(8 radius flat_depth), within 5%. The chord of this length is 0.978 mm deep. "
            'A worn flat may be longer: flat_shape = "worn".',
        ),
        (
            "wheel",
            'flat_depth = "0.4 mm"\nflat_length = "30 mm"\nflat_shape = "worn"',
            "wheel.flat_length: received 30 mm beside a depth of 0.4 mm; allowed: 38.37 mm, the chord "
            "sqrt(8 radius flat_depth), to the radius",
        ),
        (
            "wheel",
            'flat_length = "0.2 m"',
            "wheel.flat_length: received 200 mm; allowed: at most 130.1 mm, where the depth of its chord",
        ),
        ("wheel", 'flat_depth = "5 mm"', "received 5 mm; allowed: at most 0.01 of the radius, 4.6 mm"),
        (
            "wheel",
            'flat_depth = "1 mm"\nflat_position = "3 m"',
            "wheel.flat_position: received 3 m; allowed: less than the circumference, 2.89 m",
        ),
        ("wheel", 'line_distance = "5 mm"', "only together with line"),
        ("wheel", 'line = "lines.npz"\nprocessing = ["spike"]', 'Did you mean "spikes"?'),
        ("wheel", 'line = "lines.npz"\nprocessing = ["spikes", "spikes"]', '"spikes" more than once'),
        ("track", 'name = "x200"', 'Did you mean "x2000"?'),
        (
            "track",
            'pad_damping = "18 kN s/m"\npad_loss_factor = 0.2',
            "track.pad_damping: received 18000 N s/m and pad_loss_factor = 0.2; allowed: one of them",
        ),
        (
            "track",
            'ballast_damping = "48 kN s/m"\nballast_loss_factor = 0.4',
            "damping is either viscous or by a loss factor",
        ),
        ("track", 'shear_stiffness = "240 MN"', "track: received no rotary_inertia"),
        ("track", 'bending_stiffness = "6 MN m"', "a bending stiffness greater than 0"),
        ("track", 'pad_stiffness = "300 MN"', 'a stiffness greater than 0, with its unit, as "300 MN/m"'),
        ("track", 'mass_per_length = "60 kg"', "a mass per length"),
        ("track", 'rotary_inertia = "1 kg"', "a rotary inertia per length"),
        ("track", 'rail_profile = "rail.csv"\nrail_head_radius = "0.3 m"', "both rail_head_radius and rail_"),
        ("track", "points = []", "track.points: received an empty list"),
        ("track", 'points = ["60 m"]', "received 60 m; allowed: positions that are passed, 0 m to 56 m"),
        ("contact", 'window = "1 m"', "contact.window: received 1000 mm; allowed: at most the smallest dia"),
        ("contact", 'spacing = "5 mm"\nwindow = "50 mm"', "allowed: at most speed / (2.5 highest_frequency)"),
        ("numerics", "poles = 99", "numerics.poles: received 99; allowed: an even number"),
        ("numerics", 'kernel = "scatter"\npoles = 50', 'only together with kernel = "poles"'),
        ("numerics", 'kernel = "pole"', 'Did you mean "poles"?'),
        ("numerics", 'time_step = "0.1 ms"', "numerics.time_step: received 100 us"),
        ("noise", 'track_pad = "stiff"', '"soft", "medium", "hard"'),
        ("noise", 'wheel_transfer = "800 mm"', '"920 mm", "840 mm", "680 mm", "1200 mm"'),
        ("noise", 'rail_radiation = "none.csv"', "noise.rail_radiation: received"),
        ("noise", 'rail_foot_width = "150 m"', "noise.rail_foot_width: received"),
        ("noise", "axles = 0", "a whole number at least 1"),
        ("ball", 'radius = "1 mm"', "ball: received an unknown key"),
    ],
)
def test_messages_of_sections(section, keys, message, folder):
    text = case_with('duration = "1 s"', **{section: keys})
    if section == "contact" and "1 m" in keys:
        text = text.replace('window = "1 m"', 'window = "1 m"\nspacing = "1 mm"')
    assert any(message in error for error in errors_of(text, folder / "case.toml"))


@pytest.mark.parametrize(
    ("top", "message"),
    [
        ('speed = "500 m/s"', "speed: received 500 m/s; allowed: zero or more, below the critical speed"),
        ('settling = "-1 s"', "settling: received '-1 s'; allowed: a time at least 0"),
        (
            'duration = "0.1 ms"',
            "duration: received 0.0001 s, in which 5.6 mm are rolled; allowed: at least con",
        ),
        ('duration = "1 h"', "time steps; allowed: at most 1e+08"),
        ("laws = []", "laws: received an empty list"),
        ('laws = ["linear", "linear"]', 'laws: received "linear" more than once'),
    ],
)
def test_messages_of_the_top(top, message):
    assert any(message in error for error in errors_of(case_with(top)))


def test_a_path_shorter_than_the_filters_is_refused():
    text = case_with('duration = "2 ms"', contact="filter_taps = 400")
    assert any("at least contact.filter_taps spacings, 200 mm" in error for error in errors_of(text))


@pytest.mark.parametrize(
    ("surface", "message"),
    [
        (
            "",
            "surface: received no texture; allowed: file, rms, line, spectrum or a defect in [surface];",
        ),
        ("", "or set smooth = true."),
        ('smooth = true\nspectrum = "iso3095"', "surface.smooth: received true beside a texture"),
        ('file = "map.npy"\nrms = "1 um"', "surface: received both file and rms"),
        ('line = "lines.npz"\nspectrum = "iso3095"', "surface: received both line and spectrum"),
        ('spectrum = "iso3059"', 'Did you mean "iso3095"?'),
        (
            'spectrum = "absent.csv"',
            '"cnossos-average", or the path of a table of wavelengths and levels. There',
        ),
        ("spectrum = 3", "surface.spectrum: received 3"),
        ('spectrum = "iso3095"\nlateral = 0', 'a number greater than 0, or "inf"'),
        ('rms = "1 um"\nlateral = 2', "only together with spectrum"),
        (
            'rms = "1 um"\nshortest = "0.5 mm"\n[contact]\nspacing = "0.5 mm"',
            "surface.shortest: received 500 um on a spacing of 500 um",
        ),
        ('line = "lines.npz"\ncontinuation = "refused"', '"refuse", "mirror", "repeat"'),
        ('line = "lines.npz"\nline_unit = "kg"', 'a unit of length, as "um"'),
        ('corrugation = "25 um"', "surface.corrugation: received no corrugation_wavelength"),
        ('smooth = true\ncorrugation_wavelength = "40 mm"', "only together with corrugation"),
        (
            'corrugation = "25 um"\ncorrugation_wavelength = "0.5 mm"',
            "surface.corrugation_wavelength: received 0.5 mm on a spacing of 0.5 mm; allowed: at least two",
        ),
        ('smooth = true\njoint_length = "1 m"', "only together with joint_depth"),
        (
            'joint_depth = "1 mm"\njoint_position = "60 m"',
            "surface.joint_position: received 60 m; allowed: a position that is rolled over, -16.8 m to 56 m",
        ),
        (
            'spectrum = "iso3095"\nlevel = "+70 dB"',
            "received a level of 70 dB re 1 um; allowed: -60 to 60 dB",
        ),
    ],
)
def test_messages_of_the_surface(surface, message, folder):
    assert any(message in error for error in errors_of(case_with("", surface), folder / "case.toml"))


# --- tables


HEADING = "wavelength (m), level (dB)\n"
ASKED = "a heading with the units in brackets. Add the line 'wavelength (m), level (dB)' above the numbers"


def test_levels_are_read_with_their_units(folder):
    wavelengths, levels = read_levels(folder / "levels.csv")
    assert wavelengths == pytest.approx([0.1, 0.08, 0.063, 0.05])
    assert levels == pytest.approx([3, 2, 1, 0])


@pytest.mark.parametrize(
    "text",
    [
        "wavelength (m), level (dB)\n0.08 2\n0.1 3\n",
        "measured [mm],of [dB re 1 um]\n100,3\n80,2\n",
        "# lathe 3\n# wavelength (m); level (dB)\n0,1; 3\n0,08; 2  # the shorter one\n",
        "\ufeffwavelength [cm];level [dB]\r\n10;3\r\n8;2\r\n",
    ],
)
def test_levels_are_read_in_the_ways_they_are_written(text, tmp_path):
    (tmp_path / "levels.txt").write_text(text, encoding="utf-8")
    wavelengths, levels = read_levels(tmp_path / "levels.txt")
    assert wavelengths == pytest.approx([0.1, 0.08])
    assert levels == pytest.approx([3, 2])


@pytest.mark.parametrize(
    ("text", "message"),
    [
        (HEADING + "0.1, 3\n0.063, 1\n", "a gap in the bands between 100 mm and 63 mm"),
        (HEADING + "0.1, 3\n0.09, 1\n", "bands closer than one-third octaves between 100 mm and 90 mm"),
        (HEADING + "0.1, 3\n0.1, 1\n", "bands closer than one-third octaves"),
        (HEADING + "0.1, 3\n0, 1\n", "a wavelength of 0 m"),
        (
            HEADING + "0.1, 3\n0.08\n",
            "'0.08' in line 3; allowed: a table with the columns wavelength (m), level (dB)",
        ),
        (HEADING + "0.1, 3\n0.08, nan\n", "'0.08, nan' in line 3"),
        (HEADING + "0.1, 3\n0.08, inf\n", "'0.08, inf' in line 3"),
        ("wavelength (kg), level (dB)\n0.1, 3\n", "the heading 'wavelength (kg)'; allowed: wavelength in m"),
        ("100, 3\n80, 2\n", f"no heading; allowed: {ASKED}"),
        ("# from the lab (PDF)\n100, 3\n80, 2\n", f"no heading; allowed: {ASKED}"),
        ("wavelength, level (dB)\n100, 3\n", f"the heading 'wavelength, level (dB)'; allowed: {ASKED}"),
        ("wavelength_mm, level_dB\n100, 3\n", f"the heading 'wavelength_mm, level_dB'; allowed: {ASKED}"),
        ("level [dB], wavelength [mm]\n3, 100\n", "'level [dB]' for the wavelength; allowed: columns in the"),
        ("wavelength (m), level (dB re 1 nm)\n0.1, 3\n", "the heading 'level (dB re 1 nm)'"),
        ("# nothing\n", "no line of numbers"),
        ("100 mm, 3\n80 mm, 2\n", "'100 mm, 3' in line 1"),
    ],
)
def test_tables_that_are_wrong(text, message, folder):
    (folder / "levels.csv").write_text(text)
    with pytest.raises(InputError) as caught:
        read_levels(folder / "levels.csv")
    assert message in str(caught.value)
    for surface, wheel, key in (
        ('spectrum = "levels.csv"', "", "surface.spectrum"),
        ("", 'roughness = "levels.csv"', "wheel.roughness"),
    ):
        errors = errors_of(case_with("", surface, wheel=wheel), folder / "case.toml")
        assert errors[0].startswith(f"{key}: received ")
        assert "in levels.csv" in errors[0]


def test_a_table_that_is_no_text_or_too_large(tmp_path):
    path = tmp_path / "levels.csv"
    path.write_bytes(b"\xff\xfe\x00")
    with pytest.raises(InputError, match="no UTF-16 in line 1"):
        read_levels(path)
    path.write_bytes(b"#" * (10 * 2**20 + 1))
    with pytest.raises(InputError, match="more than 10 MiB"):
        read_levels(path)


def test_levels_in_another_unit_ask_for_it(folder):
    (folder / "levels.csv").write_text(HEADING + "0.1, -95\n0.08, -96\n")
    text = case_with("", 'spectrum = "levels.csv"', wheel='roughness = "levels.csv"')
    errors = errors_of(text, folder / "case.toml")
    assert [error.partition(":")[0] for error in errors] == ["surface.spectrum", "wheel.roughness"]
    assert "Is the unit right? If these levels are meant, set surface.accept_levels = true." in errors[0]
    accepted = text.replace("[surface]", "[surface]\naccept_levels = true")
    assert parse_case(accepted, folder / "case.toml").surface.accept_levels


MODAL = "frequency (Hz), damping ratio, modal mass (kg)"


def test_modes_are_read(folder):
    frequency, ratio, mass = read_modes(folder / "modes.csv")
    assert (list(frequency), list(ratio), list(mass)) == ([2000, 3100], [1e-4, 1e-4], [300, 250])


@pytest.mark.parametrize(
    ("row", "message"),
    [
        ("0, 0.1, 300", "a frequency of 0; allowed: greater than 0 Hz"),
        ("2000, 0, 300", "a damping ratio of 0; allowed: greater than 0 and less than 1"),
        ("2000, 1, 300", "a damping ratio of 1"),
        ("2000, 0.1, -3", "a modal mass of -3; allowed: greater than 0 kg"),
        ("2000, 0.1", "'2000, 0.1' in line 2"),
    ],
)
def test_modes_that_are_wrong(row, message, folder):
    (folder / "modes.csv").write_text(f"{MODAL}{', -, -, -' * (row.count(',') > 2)}\n{row}\n")
    errors = errors_of(case_with(wheel='modes = "modes.csv"'), folder / "case.toml")
    assert errors[0].startswith("wheel.modes: received ")
    assert message.partition(";")[0] in errors[0]
    with pytest.raises(InputError) as caught:
        read_modes(folder / "modes.csv")
    assert message in str(caught.value)


def test_modes_say_how_they_move_the_wheel(folder):
    text = "frequency (kHz), damping, modal mass (kg), diameters, axial, radial\n2, 1e-4, 300, 2, 4, 0.5\n"
    (folder / "modes.csv").write_text(text)
    assert read_mode_shapes(folder / "modes.csv").tolist() == [[2.0, 4.0, 0.5]]
    assert [list(each) for each in read_modes(folder / "modes.csv")] == [[2000.0], [1e-4], [300.0]]
    (folder / "modes.csv").write_text(MODAL + "\n2000, 1e-4, 300\n")
    assert read_mode_shapes(folder / "modes.csv") is None
    assert read_mode_shapes(np.array([[2000.0, 1e-4, 300.0, 2.0, 4.0, 0.5]])).tolist() == [[2.0, 4.0, 0.5]]


@pytest.mark.parametrize(
    ("row", "message"),
    [
        (
            "2000, 0.1, 300, 1.5, 4, 0.5",
            "a number of nodal diameters of 1.5; allowed: a whole number",
        ),
        ("2000, 0.1, 300, -1, 4, 0.5", "a number of nodal diameters of -1"),
        ("2000, 0.1, 300, 2, -4, 0.5", "an rms velocity of -4; allowed: zero or more, per radial velocity"),
        ("2000, 0.1, 300, 2, 4", "or with these and nodal diameters (1), axial velocity over the disc (1)"),
        ("2000, 0.1, 300, 2, 4, 1\n2100, 0.1, 300", "'2100, 0.1, 300' in line 3"),
    ],
)
def test_shapes_of_modes_that_are_wrong(row, message, folder):
    (folder / "modes.csv").write_text(f"{MODAL}{', -, -, -' * (row.count(',') > 2)}\n{row}\n")
    errors = errors_of(case_with(wheel='modes = "modes.csv"'), folder / "case.toml")
    assert len(errors) == 1
    assert errors[0].startswith("wheel.modes: received ")
    assert message.partition(";")[0] in errors[0]
    with pytest.raises(InputError) as caught:
        read_modes(folder / "modes.csv")
    assert message in str(caught.value)


def test_modes_as_an_array_have_three_columns_or_six():
    with pytest.raises(CaseError, match=r"an array of shape \(n, 3\) or \(n, 6\) of real numbers"):
        WheelOnRail(surface={"spectrum": "iso3095"}, wheel={"modes": np.ones((2, 4))})


def test_radiation_ratios_are_read(folder):
    frequency, ratio = read_ratios(folder / "ratios.csv")
    assert (list(frequency), list(ratio)) == ([100.0, 1000.0], [0.01, 0.8])


@pytest.mark.parametrize(
    ("rows", "message"),
    [
        ("100, 0.1\n100, 0.2", "frequencies that do not rise; allowed: rising frequencies, all above 0 Hz"),
        ("0, 0.1\n100, 0.2", "frequencies that do not rise"),
        ("100, 0\n200, 0.2", "a radiation ratio of 0; allowed: greater than 0"),
    ],
)
def test_radiation_ratios_that_are_wrong(rows, message, folder):
    (folder / "ratios.csv").write_text("frequency (Hz), ratio\n" + rows)
    errors = errors_of(case_with(noise='rail_radiation = "ratios.csv"'), folder / "case.toml")
    assert errors[0].startswith("noise.rail_radiation: received ")
    with pytest.raises(InputError) as caught:
        read_ratios(folder / "ratios.csv")
    assert message in str(caught.value)


def test_a_receptance_is_read(folder):
    frequency, receptance = read_receptance(folder / "receptance.csv")
    assert frequency == pytest.approx(100 * np.arange(1, 30))
    assert receptance[0] == pytest.approx(-1e-9 - 1e-11j)


@pytest.mark.parametrize(
    ("rows", "message"),
    [
        (["100, 1, 1"] * 3, "3 frequencies; allowed: at least 10"),
        (["100, 1, 1"] * 12, "frequencies that do not rise"),
        (
            [f"{n}, 1, 1" for n in range(12)],
            "frequencies that do not rise; allowed: rising frequencies, all above",
        ),
    ],
)
def test_receptances_that_are_wrong(rows, message, folder):
    (folder / "receptance.csv").write_text("\n".join(["f (Hz), real (m/N), imaginary (m/N)", *rows]))
    errors = errors_of(case_with(wheel='receptance = "receptance.csv"'), folder / "case.toml")
    assert errors[0].startswith("wheel.receptance: received ")
    with pytest.raises(InputError) as caught:
        read_receptance(folder / "receptance.csv")
    assert message in str(caught.value)


def test_columns_of_one_unit_in_another_order_are_refused(folder):
    rows = "\n".join(f"{n}, 1, 1" for n in range(1, 12))
    (folder / "receptance.csv").write_text(f"frequency (Hz), imaginary (m/N), real (m/N)\n{rows}")
    with pytest.raises(InputError, match=r"the heading 'imaginary \(m/N\)' for the real part; .* Exchange"):
        read_receptance(folder / "receptance.csv")


def test_a_case_is_read_from_its_file(folder):
    (folder / "case.toml").write_text(case_with("", 'spectrum = "levels.csv"'), encoding="utf-8-sig")
    assert load_case(folder / "case.toml").surface.spectrum == folder / "levels.csv"


def test_the_parameters_show_the_values_of_the_named_track():
    listed = {item["key"]: item for item in parse_case(case_with()).parameters()}
    assert listed["track.sleeper_spacing"]["value"] == "0.6 m"
    assert listed["track.pad_stiffness"]["value"].endswith(" MN/m")
    assert listed["track.rail_loss_factor"]["value"] == "0.02"
    assert listed["track.pad_stiffness"]["is_default"]
    assert "track.pad_loss_factor" not in listed  # x2000 has viscous pads
    own = parse_case(case_with(track='pad_stiffness = "123 MN/m"'))
    assert {item["key"]: item["value"] for item in own.parameters()}["track.pad_stiffness"] == "123 MN/m"


def test_a_load_below_the_weight_of_the_wheel_is_refused():
    """600 kg × 9.80665 m/s²."""
    message = "wheel.load: received 5 kN; allowed: at least 5.88399 kN, the weight of 600 kg on the contact"
    assert any(message in error for error in errors_of(case_with(wheel='load = "5 kN"')))
    assert parse_case(case_with(wheel='load = "5 kN"\nmass = "400 kg"')).wheel.mass == 400.0
