"""The case: every key, every default, and one test for each thing that can be wrong."""

import math
import tomllib

import pytest
from hypothesis import given
from hypothesis import strategies as st

from asperity.case.cases import demo_case, load_case, parse_case, template
from asperity.errors import CaseError, InputError
from asperity.laws import names

MINIMAL = 'kind = "ball-on-beam"\n[surface]\nrms = "0.5 um"\n'


def case_with(top="", surface='rms = "0.5 um"', **sections):
    """Text of a case from pieces."""
    lines = ['kind = "ball-on-beam"', top, "[surface]", surface]
    for title, keys in sections.items():
        lines += [f"[{title}]", keys]
    return "\n".join(lines)


def errors_of(text):
    with pytest.raises(CaseError) as caught:
        parse_case(text, "case.toml")
    assert caught.value.exit_code == 2
    return caught.value.errors


def only_error(text):
    errors = errors_of(text)
    assert len(errors) == 1, errors
    return errors[0]


@pytest.fixture
def map_file(tmp_path):
    (tmp_path / "map.npy").write_bytes(b"heights")
    (tmp_path / "line.csv").write_bytes(b"heights")
    return tmp_path / "case.toml"


def test_a_minimal_case_has_the_documented_defaults():
    case = parse_case(MINIMAL)
    assert case.speed == 1.0
    assert case.laws == ("areal", "shifted", "printed", "table", "linear-filtered", "linear")
    assert case.seed == 1
    assert (case.surface.rms, case.surface.hurst) == (pytest.approx(5e-7), 0.8)
    assert (case.surface.longest, case.surface.shortest) == pytest.approx((1.6e-3, 40e-6))
    assert case.ball.radius == pytest.approx(0.025)
    assert case.ball.mass is case.ball.load is None
    assert (case.beam.length, case.beam.width, case.beam.height) == pytest.approx((1.0, 0.05, 0.01))
    assert case.beam.sensor_positions == pytest.approx((0.2, 0.35, 0.5, 0.65, 0.8))
    assert (case.contact.spacing, case.contact.window) == pytest.approx((10e-6, 0.5e-3))
    assert (case.contact.damping, case.contact.hardness, case.contact.approaches) == (0.0, None, None)
    assert (case.numerics.highest_frequency, case.numerics.rtol) == (5000.0, 1e-6)
    assert parse_case(case.text) == case
    assert case.duration is case.start is case.settling is None
    assert (case.settled_time, case.record_start, case.rolled_time) == pytest.approx((0.2, 0.2, 0.8))


def test_every_key_of_the_interface_is_understood(map_file):
    text = case_with(
        'speed = "2 m/s"\nlaws = ["direct", "table"]\nseed = 7\nduration = "0.2 s"\nstart = "0.1 m"',
        'file = "map.npy"\narray = "polished"\nheight_unit = "um"\npixel = "1.5625 um"\nindex = 2\n'
        'fill = true\ndirection = "30 deg"',
        ball='radius = "12.5 mm"\nmaterial = "steel"\nmass = "60 g"\nload = "5 N"',
        beam='length = "0.8 m"\nwidth = "5 cm"\nheight = "1 cm"\nmaterial = "steel"\nsupport = "free"\n'
        'loss_factor = 0.01\nsuspension_frequency = "3 Hz"\nsensors = ["0 m", "0.8 m"]',
        contact='spacing = "10 um"\nwindow = "0.64 mm"\nsamples = 5\napproaches = ["-0.5 um", "0 um"]\n'
        'damping = "3 N s/m"\nhardness = "3 GPa"\nnormalise = "tangent"\nlinearise = "rough"\n'
        'filter_degree = 4\nfilter_taps = 64\nsample_length = "2 mm"',
        numerics='highest_frequency = "4 kHz"\ntime_step = "5 us"\nrtol = 1e-8',
    )
    case = parse_case(text, map_file)
    assert case.surface.file == map_file.parent / "map.npy"
    assert (case.surface.array, case.surface.index, case.surface.fill) == ("polished", 2, True)
    assert case.surface.pixel == pytest.approx(1.5625e-6)
    assert case.surface.direction == pytest.approx(math.pi / 6)
    assert case.laws == ("direct", "table")
    assert (case.ball.mass, case.ball.load) == pytest.approx((0.06, 5.0))
    assert (case.beam.support, case.beam.suspension_frequency) == ("free", 3.0)
    assert case.beam.sensor_positions == (0.0, 0.8)
    assert case.contact.approaches == pytest.approx((-5e-7, 0.0))
    assert (case.contact.hardness, case.contact.cells, case.contact.filter_taps) == (3e9, 64, 64)
    assert (case.contact.normalise, case.contact.linearise) == ("tangent", "rough")
    assert case.time_step == pytest.approx(5e-6)


def test_a_case_is_frozen():
    case = parse_case(MINIMAL)
    with pytest.raises(AttributeError, match="speed of BallOnBeam does not change"):
        case.speed = 2.0
    with pytest.raises(AttributeError, match=r"radius of Rolling does not change"):
        case.ball.radius = 2.0


@pytest.mark.parametrize(
    ("speed", "spacing"), [("1 m/s", "8 um"), ("1 m/s", "12 um"), ("3 m/s", "2 um"), ("0.1 m/s", "8 um")]
)
def test_the_default_time_step_keeps_positions_on_the_grid(speed, spacing):
    surface = 'rms = "0.5 um"\nshortest = "32 um"'
    numerics = 'highest_frequency = "1 kHz"' if speed == "0.1 m/s" else ""
    case = parse_case(
        case_with(f'speed = "{speed}"', surface, contact=f'spacing = "{spacing}"', numerics=numerics)
    )
    cells = case.speed * case.time_step / case.contact.spacing
    assert cells == pytest.approx(round(cells)) or 1 / cells == pytest.approx(round(1 / cells))
    wanted = 1 / (20 * case.numerics.highest_frequency)
    assert wanted / 2 < case.time_step <= wanted * 2**0.5 * (1 + 1e-9)


def test_a_line_takes_laws_out_of_the_default_that_need_more_than_a_line(map_file):
    assert parse_case(case_with("", 'rms = "1 um"\nline = "line.csv"'), map_file).laws == (
        "shifted",
        "printed",
        "linear-filtered",
        "linear",
    )
    smooth = parse_case(case_with("", 'spectrum = "iso3095"\nlevel = "+10 dB"'))
    assert smooth.laws == ("hertz-filtered", "linear-filtered", "linear")


# --- the run-in of a ball


@pytest.mark.parametrize(
    ("top", "settled", "start", "rolled"),
    [
        ("", 0.2, 0.2, 0.8),
        ('speed = "5 m/s"', 0.05, 0.25, 0.15),  # a quarter of the beam at most
        ('duration = "30 ms"', 0.05, 0.05, 0.03),
        ('duration = "0.12 s"', 0.12, 0.12, 0.12),
        ('duration = "0.9 s"', 0.1, 0.1, 0.9),  # records keep their length
        ('duration = "1 s"', 0.0, 0.0, 1.0),
        ('start = "0.47 m"\nduration = "30 ms"', 0.05, 0.47, 0.03),
        ('start = "20 mm"\nduration = "30 ms"', 0.02, 0.02, 0.03),  # no beam before its start
        ('start = "0.1 m"', 0.1, 0.1, 0.9),
        ('settling = "0.4 s"', 0.4, 0.4, 0.6),
        ('settling = "0 s"', 0.0, 0.0, 1.0),
        ('start = "0.6 m"\nsettling = "0.6 s"\nduration = "0.4 s"', 0.6, 0.6, 0.4),
    ],
)
def test_a_ball_settles_before_its_record(top, settled, start, rolled):
    case = parse_case(case_with(top))
    found = (case.settled_time, case.record_start, case.rolled_time)
    assert found == pytest.approx((settled, start, rolled))
    first, last = case.rolled_range
    assert first == pytest.approx(start - case.speed * settled, abs=1e-12)
    assert -1e-12 < first < last <= 1.0 + 1e-12


def test_a_run_in_that_begins_before_the_beam_is_refused():
    text = case_with('start = "0.1 m"\nsettling = "0.3 s"\nduration = "0.1 s"')
    with pytest.raises(
        CaseError, match=r"settling: received 0\.3 s, which begins at -0\.2 m; .* at most 0\.1 s"
    ):
        parse_case(text)
    with pytest.raises(
        CaseError, match=r"start, after settling: received 2 m; allowed: a position on the beam"
    ):
        parse_case(case_with('settling = "2 s"'))


# --- the template, the demonstration and the list of parameters


def test_the_template_is_a_case_with_the_defaults():
    case = parse_case(template("ball-on-beam"))
    keys = {"duration": 0.12, "settling": 0.05, "surface.rms": 1e-7, "ball.load": 50.0}
    assert case == parse_case(MINIMAL).with_(**keys)
    assert [item["key"] for item in case.parameters() if not item["is_default"]] == list(keys)


def test_the_template_explains_every_key_on_one_line():
    keys = {}
    for line in template("ball-on-beam").splitlines():
        code, _, comment = line.removeprefix("# ").partition("  # ")
        if " = " in code and comment:
            keys[code.split(" = ")[0]] = comment
            tomllib.loads(code)  # what is commented out is TOML as well
    names = {item["key"].split(".")[-1] for item in parse_case(MINIMAL).parameters()}
    assert names <= keys.keys()
    assert {
        "file",
        "array",
        "spectrum",
        "level",
        "suspension_frequency",
        "hardness",
        "time_step",
    } <= keys.keys()
    assert all("default" in comment for comment in keys.values())


def test_every_commented_key_of_the_template_works(map_file):
    (map_file.parent / "beam.x3p").write_bytes(b"heights")
    wanted = (
        "load",
        "mass",
        "sensors",
        "approaches",
        "hardness",
        "filter_taps",
        "time_step",
        "sample_length",
        "duration",
    )
    lines = template("ball-on-beam").splitlines()
    text = "\n".join(
        line.removeprefix("# ") if line.startswith(tuple(f"# {key} =" for key in wanted)) else line
        for line in lines
    )
    case = parse_case(text, map_file)
    changed = {item["key"].split(".")[-1] for item in case.parameters() if not item["is_default"]}
    assert changed == {*wanted, "rms", "settling"}


def test_there_is_no_template_of_another_kind():
    with pytest.raises(InputError, match='allowed: "ball-on-beam", "wheel-on-rail"'):
        template("ball-on-rail")


def test_the_demonstration_is_a_case():
    case = demo_case()
    assert {"areal", "shifted", "printed", "table", "linear"} <= set(case.laws)
    assert case.rolled_time <= 0.2


def test_parameters_are_listed_with_units_and_marked():
    text = case_with(
        'speed = "1000 mm/s"', ball='radius = "12 mm"', beam='sensors = ["0.5 m"]\nsupport = "clamped"'
    )
    listed = {item["key"]: item for item in parse_case(text).parameters()}
    assert listed["ball.radius"] == {
        "key": "ball.radius",
        "value": "12 mm",
        "default": "25 mm",
        "is_default": False,
        "note": "rolling radius",
    }
    assert listed["speed"]["is_default"]
    assert listed["speed"]["value"] == "1 m/s"
    assert not listed["beam.sensors"]["is_default"]
    assert listed["beam.sensors"]["value"] == "0.5 m"
    assert listed["ball.load"]["value"] == "the weights"
    assert listed["ball.load"]["is_default"]
    assert not {"surface.file", "surface.level", "surface.array", "beam.suspension_frequency"} & listed.keys()


# --- what can be wrong


def test_all_errors_are_reported_at_once():
    text = case_with(
        'speed = "-1 m/s"\nspede = 1',
        ball='radius = "25"\nlods = "5 N"',
        beam="loss_factor = nan",
        contact="samples = 0",
    )
    errors = errors_of(text)
    for name in (
        "speed: ",
        "spede: ",
        "ball.radius: ",
        "ball.lods: ",
        "beam.loss_factor: ",
        "contact.samples: ",
    ):
        assert sum(error.startswith(name) for error in errors) == 1
    assert len(errors) == 6


@pytest.mark.parametrize(
    ("section", "key", "message"),
    [
        ("ball", 'radius = "25"', "ball.radius: received '25'; allowed: a length greater than 0"),
        ("ball", "radius = 0.025", 'Add unit and quotes: "0.025 m" if it is in SI units (m).'),
        ("contact", "damping = 3", '"3 N s/m" if it is in SI units (N s/m).'),
        ("ball", 'radius = "25 kg"', "a length greater than 0"),
        ("ball", 'radius = "25 mmm"', "Check its spelling"),
        ("ball", 'radius = "0 mm"', "greater than 0"),
        ("ball", 'radius = "-1 mm"', "greater than 0"),
        ("ball", 'radius = "nan mm"', "NaN is not a value"),
        ("ball", 'radius = "inf"', "Give a finite value"),
        ("ball", "radius = true", "ball.radius: received True"),
        ("ball", 'radius = ["25 mm"]', "ball.radius: received ['25 mm']"),
        ("ball", 'radius = "2,5 mm"', "decimal point"),
        ("ball", 'material = "steal"', 'Did you mean "steel"?'),
        ("ball", 'load = "0 N"', "a force greater than 0"),
        ("ball", 'lode = "5 N"', 'keys of [ball]: radius, material, mass, load. Did you mean "load"?'),
        ("ball", "seed = 3", "Move it to the top of the case, above the first section."),
        ("ball", 'damping = "1 N s/m"', "Move it to [contact]."),
        ("beam", 'support = "pinned"', '"simply-supported", "free", "clamped"'),
        ("beam", "loss_factor = -0.1", "a number at least 0 and at most 0.5"),
        ("beam", 'loss_factor = "0.1"', "Write it without quotes and unit"),
        ("beam", 'sensors = "0.5 m"', "beam.sensors: received '0.5 m'; allowed: a list, each a length"),
        ("beam", 'sensors = ["0.5 m", 3]', "beam.sensors[2]: received 3"),
        ("beam", "sensors = []", "at least one position"),
        (
            "beam",
            'sensors = ["1.2 m"]',
            "beam.sensors: received 1.2 m; allowed: positions on the beam, 0 to 1 m",
        ),
        ("beam", 'sensors = ["-0.2 m"]', "a length at least 0"),
        ("beam", 'suspension_frequency = "3 Hz"', 'only together with support = "free"'),
        (
            "contact",
            'window = "20 um"',
            "contact.window: received 20 um, 2 cells of 10 um; allowed: 8 to 2048 cells",
        ),
        ("contact", 'window = "25 mm"', "2500 cells"),
        ("contact", 'approaches = ["1 um"]', "at least 2"),
        (
            "contact",
            'approaches = ["1 um", "0 um"]',
            "contact.approaches: received 1 um, 0 um; allowed: increasing",
        ),
        ("contact", 'approaches = ["1 um", "1 um"]', "increasing"),
        ("contact", "filter_taps = 63", "an even number"),
        ("contact", "filter_degree = 6.5", "a whole number at least 1 and at most 20"),
        ("contact", 'sample_length = "0.6 mm"', "at least two windows, 1000 um"),
        ("contact", 'damping = "-1 N s/m"', "at least 0"),
        ("contact", 'hardness = "3"', "a pressure greater than 0"),
        ("contact", 'normalise = "none"', '"low-wavenumber", "tangent"'),
        ("contact", 'linearise = "smooth"', '"hertz", "rough"'),
        (
            "contact",
            'spacing = "100 um"\nwindow = "1 mm"',
            "100 um at 1 m/s and 5000 Hz; allowed: at most speed / (2.5 highest_frequency) = 80 um",
        ),
        ("numerics", 'time_step = "0.1 ms"', "numerics.time_step: received 100 us"),
        ("numerics", 'time_step = "1 ns"', "1e+09 time steps; allowed: at most 1e+08"),
        ("numerics", "rtol = 0", "a number greater than 0 and at most 0.01"),
        ("numerics", "rtol = inf", "rtol: received inf"),
        ("numerics", "rtol = 1" + "0" * 400, "at most 0.01"),
    ],
)
def test_messages_of_sections(section, key, message):
    assert any(message in error for error in errors_of(case_with(**{section: key})))


@pytest.mark.parametrize(
    ("top", "message"),
    [
        ('speed = "0 m/s"', "a speed greater than 0"),
        ("laws = []", "laws: received an empty list; allowed: at least one law"),
        ('laws = ["arreal"]', "laws[1]: received 'arreal'; allowed: \"areal\""),
        ('laws = ["arreal"]', 'Did you mean "areal"?'),
        ('laws = "areal"', "laws: received 'areal'; allowed: a list"),
        ('laws = ["areal", "areal"]', 'laws: received "areal" more than once; allowed: each law once'),
        ("seed = -1", "a whole number at least 0"),
        ("seed = 1.5", "a whole number"),
        ("seed = 0x" + "F" * 9000, "received a huge number"),
        ('start = "1 m"', "start: received 1 m; allowed: a position on the beam"),
        ('duration = "1.5 s"', "duration: received 1.5 s, which ends at 1.5 m; allowed: at most 1 s"),
        ("duration = 1979-05-27", "duration: received datetime.date(1979, 5, 27)"),
        ("ball = 3", "ball: received 3; allowed: a section [ball]"),
        ('[balls]\nradius = "1 mm"', "balls: received an unknown key; allowed: keys at the top of a case"),
        ('[balls]\nradius = "1 mm"', 'Did you mean "ball"?'),
        (
            '[ball]\nradius = "0.2 mm"\n[contact]\nwindow = "0.5 mm"',
            "contact.window: received 0.5 mm; allowed: at most the smallest diameter of the bodies, 0.4 mm",
        ),
    ],
)
def test_messages_of_the_top(top, message):
    assert any(message in error for error in errors_of(case_with(top)))


@pytest.mark.parametrize(
    ("surface", "message"),
    [
        ("", "surface: received no texture; allowed: file, rms, line, spectrum or a defect in [surface]"),
        ('file = "map.npy"\nrms = "1 um"', "surface: received both file and rms; allowed: one of them"),
        ('file = "absent.npy"', "absent.npy"),
        ('file = ""', "the path of an existing file"),
        ('file = "a\\u0000b"', "the path of an existing file"),
        ('line = "line.csv"\nspectrum = "iso3095"', "surface: received both line and spectrum"),
        ('spectrum = "iso3095"\nlevel = "+6"', "Add the unit"),
        ('spectrum = "iso"', '"iso3095"'),
        (
            'rms = "1 um"\nlevel = "+6 dB"',
            "surface.level: received 6.0; allowed: only together with spectrum",
        ),
        ('rms = "1 um"\npixel = "1 um"', "surface.pixel: received 1e-06; allowed: only together with file"),
        ('file = "map.npy"\nhurst = 0.7', "surface.hurst: received 0.7; allowed: only together with rms"),
        ('file = "map.npy"\nheight_unit = "s"', 'a unit of length, as "um"'),
        ('file = "map.npy"\nheight_unit = 1e-6', 'a unit of length, as "um"'),
        ('file = "map.npy"\narray = ""', "a text in quotes"),
        ('file = "map.npy"\nfill = "yes"', "true or false"),
        ('file = "map.npy"\nindex = -1', "a whole number at least 0"),
        ('file = "map.npy"\ndirection = 30', 'Add unit and quotes: "30 rad" if it is in SI units (rad)'),
        ('file = "map.npy"\ndirection = "400 deg"', "surface.direction: received"),
        (
            'rms = "1 um"\ndirection = "90 deg"',
            "surface.direction: received 1.5707963267948966; allowed: only",
        ),
        ('rms = "1 um"\nhurst = 1.5', "a number greater than 0 and at most 1"),
        (
            'rms = "1 um"\nlongest = "10 um"\nshortest = "16 um"',
            "surface.longest: received 10 um with shortest 16 um",
        ),
        (
            'rms = "1 um"\nshortest = "10 um"\n[contact]\nspacing = "8 um"',
            "surface.shortest: received 10 um on a spacing of 8 um",
        ),
        ('rms = "1 um"\nanisotropy = 0', "a number greater than 0"),
    ],
)
def test_messages_of_the_surface(surface, message, map_file):
    with pytest.raises(CaseError) as caught:
        parse_case(case_with("", surface), map_file)
    assert message in str(caught.value)


def test_laws_that_need_more_texture_than_there_is(map_file):
    for law in ("areal", "table", "direct"):
        text = case_with(f'laws = ["{law}"]', 'rms = "1 um"\nline = "line.csv"')
        with pytest.raises(CaseError, match=f'"{law}" with a path given as a line'):
            parse_case(text, map_file)
    text = case_with('laws = ["shifted"]', 'line = "line.csv"')
    with pytest.raises(CaseError, match='"shifted" without samples of the surface'):
        parse_case(text, map_file)
    assert parse_case(case_with('laws = ["hertz", "linear"]', 'line = "line.csv"'), map_file).surface.has_line


def test_rough_linearisation_needs_samples():
    text = 'kind = "ball-on-beam"\n[surface]\nspectrum = "iso3095"\n[contact]\nlinearise = "rough"\n'
    with pytest.raises(CaseError, match=r'contact\.linearise: received "rough" without samples'):
        parse_case(text)


@pytest.mark.parametrize("law", names())
def test_every_law_may_be_asked_for(law):
    assert parse_case(case_with(f'laws = ["{law}"]')).laws == (law,)


@pytest.mark.parametrize(
    ("kind", "message"),
    [
        ("", "kind: received nothing"),
        ('kind = "wheel-on-rial"', 'Did you mean "wheel-on-rail"?'),
        ('kind = "ball-on-beem"', 'Did you mean "ball-on-beam"?'),
        ("kind = 3", 'kind: received 3; allowed: "ball-on-beam"'),
    ],
)
def test_messages_of_the_kind(kind, message):
    assert message in only_error(f'{kind}\n[surface]\nrms = "1 um"')


def test_text_that_is_no_toml_is_named_with_its_line():
    with pytest.raises(InputError, match=r"case\.toml: received no TOML .*line 3"):
        parse_case('kind = "ball-on-beam"\n[surface]\nrms = 0.5 um', "case.toml")


@pytest.mark.parametrize("text", ["a = " + "[" * 5000, "a = " + "1" * 5000, "a = 1\na = 2", "\0"])
def test_hostile_text_is_refused(text):
    with pytest.raises(InputError):
        parse_case(text)


@given(st.text(max_size=40))
def test_any_quantity_is_a_value_or_a_clear_error(text):
    quoted = "'''\n" + text.replace("'''", "") + "'''"
    try:
        radius = parse_case(case_with(ball=f"radius = {quoted}")).ball.radius
    except InputError:
        radius = 1.0
    assert math.isfinite(radius)
    assert radius > 0


def test_a_case_is_read_from_its_file(map_file):
    map_file.write_text(case_with("", 'file = "map.npy"'), encoding="utf-8-sig")
    assert load_case(map_file).surface.file == map_file.parent / "map.npy"


def test_a_missing_case_is_named(tmp_path):
    with pytest.raises(InputError, match=r"absent\.toml: received no such file"):
        load_case(tmp_path / "absent.toml")


def test_a_case_that_is_too_large_or_no_text_is_refused(tmp_path):
    (tmp_path / "large.toml").write_bytes(b"#" * 2**21)
    with pytest.raises(InputError, match="more than 1 MiB"):
        load_case(tmp_path / "large.toml")
    (tmp_path / "binary.toml").write_bytes(b"kind = \xff")
    with pytest.raises(InputError, match="no UTF-8 in line 1"):
        load_case(tmp_path / "binary.toml")
