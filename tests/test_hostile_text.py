"""Text that people write: whatever it is, it is read or refused at once, with a message.

The texts here are so long that time with their square would be hours.
"""

import os
import tracemalloc
from pathlib import Path

import numpy as np
import pytest
import xarray as xr

from asperity.arguments import listed, no_file, shown
from asperity.case import PRESETS
from asperity.case.cases import as_case, case_class, load_case, parse_case
from asperity.case.describing import entries
from asperity.case.tables import LEVELS, read_levels, read_table
from asperity.case.toml import read_toml
from asperity.errors import CaseError, ComputationError, InputError
from asperity.files import alone_in, refuse_unwritable, write_bytes
from asperity.parameters import Quantity
from asperity.results import GROUPS, read_result, save
from asperity.schema import VERSION
from asperity.store import Store
from asperity.studies.definition import load_study, study_of
from asperity.surfaces.heightmap import HeightMap
from asperity.surfaces.likeness import likeness
from asperity.surfaces.readers import read_surface
from asperity.surfaces.readers.text import parsed_header
from asperity.text_files import number_in
from asperity.units import quantity

BALL = 'kind = "ball-on-beam"\n'
CASE = {"kind": "ball-on-beam", "surface": {"rms": "1 um"}}
MANY = 1_000_000
LONG_NAME = "a" * 300

proc = pytest.mark.skipif(not Path("/proc/kmsg").exists(), reason="no files of the kernel")
pipes = pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="no named pipes")


# --- long text


@pytest.mark.parametrize("start", ["", "1.", "1e", " "])
def test_long_quantities_are_refused(start):
    with pytest.raises(InputError, match="Write the number first"):
        quantity(start + "1" * MANY + "_", "m")


@pytest.mark.parametrize(
    "line",
    [
        "# unit" + " " * MANY + "(",
        "# dx" + " " * MANY + "1",
        "# pixel = " + "1" * MANY + "_ um",
        "# " + "(" * MANY,
        "# " + "( " * MANY + "um",
        "# " + "unit" * MANY,
        "# " + "[a " * MANY,
    ],
)
@pytest.mark.parametrize("columns", [3, 9])
def test_long_headers_say_nothing(line, columns):
    assert parsed_header([line], None, columns).height_unit is None


def test_headers_are_read_across_white_space():
    found = parsed_header(["# height \t unit  =   um", "# pixel \t size :  1.5   um"], None, 9)
    assert found.height_unit == pytest.approx(1e-6)
    assert found.spacing == pytest.approx((1.5e-6, 1.5e-6))


@pytest.mark.parametrize("mark", ["(", "[", "(a", "( "])
def test_headings_full_of_brackets_are_refused(tmp_path, mark):
    file = tmp_path / "levels.csv"
    file.write_text(mark * MANY + ", level (dB" + " " * MANY + "x)\n1, 2\n")
    with pytest.raises(InputError, match="the heading") as caught:
        read_levels(file)
    assert len(str(caught.value)) < 500


def test_many_empty_lines_between_heights_are_missing_points(tmp_path):
    file = tmp_path / "line.txt"
    file.write_text("z (um)\n" + "1\n\n2\n" * 200_000)
    with pytest.warns(match="200000 points"):
        line = read_surface(file, pixel="1 um")
    assert line.heights.shape == (600_000,)
    np.testing.assert_array_equal(np.isnan(line.heights[:6]), [False, True, False] * 2)


# --- large and deep cases


@pytest.mark.parametrize(
    ("text", "message"),
    [
        (".".join("a" * 20_000) + " = 1", "a key of more than 20 parts"),
        ("[" + " . ".join("a" * 20_000) + "]", "a key of more than 20 parts"),
        ('"b c".' * 200_00 + "a = 1", "a key of more than 20 parts"),
        ("\n".join(f"ball.a{i} = 1" for i in range(20_000)), "keys and values; allowed: a case with at most"),
        ("\n".join(f"[s{i}]" for i in range(20_000)), "keys and values"),
        ("laws = [" + '"x", ' * 200_000 + "]", "keys and values"),
        ("laws = " + "[" * 300 + "]" * 300, "more than 10 deep"),
    ],
)
def test_cases_beyond_all_measure_are_refused(text, message):
    with pytest.raises(InputError, match=message) as caught:
        parse_case(BALL + text)
    assert len(str(caught.value)) < 500


@pytest.mark.parametrize(
    "text", ["a" * MANY, "'" * MANY, '"' * MANY, "a" + " " * MANY, ("a." * 19 + "! ") * 25_000]
)
def test_parts_of_keys_are_counted_in_time(text):
    with pytest.raises(InputError, match="no TOML"):
        read_toml(text, "case", "case.toml")


def test_words_with_many_dots_are_no_keys():
    file = ".".join(str(n) for n in range(19))
    with pytest.raises(CaseError, match="There is no such file"):
        parse_case(f'{BALL}[surface]\nfile = "{file}"')


def test_ten_errors_are_listed_and_the_rest_counted():
    with pytest.raises(CaseError) as caught:
        parse_case(BALL + "\n".join(f"a{i} = 1" for i in range(50)))
    assert len(caught.value.errors) == 50
    lines = str(caught.value).splitlines()
    assert lines[0] == "case: 50 errors"
    assert len(lines) == 12
    assert lines[-1] == "  - and 40 more"


def test_a_mapping_that_holds_itself_is_refused():
    own = dict(CASE)
    own["ball"] = own
    with pytest.raises(InputError, match="more than 10 deep"):
        as_case(own)
    assert "without end" in shown(_nested(2000))


def _nested(depth):
    value = []
    for _ in range(depth):
        value = [value]
    return value


def test_a_long_key_is_shortened():
    with pytest.raises(CaseError) as caught:
        parse_case(BALL + "a" * 100_000 + " = 1")
    assert len(str(caught.value)) < 3000


@pytest.mark.parametrize("key", ["'at line 9999'", "'(at line 9999, column 1)'", "'\\'"])
def test_a_key_is_never_taken_for_the_place_of_an_error(key):
    with pytest.raises(InputError, match="no TOML"):
        parse_case(f"a = {{ x = 1 }}\na.{key}.y = 2")


HOSTILE = [
    10**400, -(10**400), 5e-324, 1e308, -1e308, float("nan"), float("inf"), True, None, b"abc", object(),
    "5e-324 {}", "1e308 {}", "-1e308 {}", "1e-308 {}", "inf", "1" * 400 + " {}", "0." + "0" * 30 + "1 {}",
    "1_0 {}", [[]], [{}], {}, {"a": []}, [], _nested(9), LONG_NAME, "a/" * 3000, "\0", "\ud800", "\x1b[31m",
    [None], ".", {"name": "a\0b"}, {1: 2}, "x" * 100_000, [1] * 3, ["1 {}"] * 3, ["5e-324 {}"], {"name": []},
    "/dev/null",
]  # fmt: skip


@pytest.mark.parametrize("kind", sorted(PRESETS))
def test_any_value_of_any_key_is_right_or_a_clear_error(kind):
    """In a case, and swept by a study."""
    base = {"kind": kind, "surface": {"rms": "1 um"}}
    for entry in entries(case_class(kind)):
        unit = entry.key.one.dimension if isinstance(entry.key.one, Quantity) else "m"
        section, _, name = entry.dotted.rpartition(".")
        for value in HOSTILE:
            if isinstance(value, str):
                value = value.replace("{}", unit)
            data = base | ({section: base.get(section, {}) | {name: value}} if section else {name: value})
            for message in (
                refusal(as_case, data),
                refusal(lambda data: study_of(base, data).members(), {entry.dotted: [value]}),
            ):
                assert len(message) < 5000
                message.encode("utf-8")


def refusal(attempt, data):
    """Message of the error that an attempt ends in; empty if it succeeds."""
    try:
        attempt(data)
    except InputError as error:
        return str(error)
    return ""


@pytest.mark.parametrize(
    ("key", "message"),
    [
        ('speed = "5e-324 m/s"', "speed: received '5e-324 m/s'.*between 1e-30 and 1e[+]30"),
        ('duration = "1e31 s"', "duration: .*between 1e-30 and 1e[+]30"),
        ('[numerics]\nhighest_frequency = "1e300 Hz"', "numerics.highest_frequency: .*between"),
        ("[numerics]\nrtol = 1e-300", "numerics.rtol: received 1e-300"),
        (f"seed = {'1' * 400}", "seed: received 1111"),
    ],
)
def test_absurd_numbers_are_named(key, message):
    with pytest.raises(CaseError, match=message):
        parse_case(f'{BALL}{key}\n[surface]\nrms = "1 um"')


# --- studies


def study(tmp_path, text):
    file = tmp_path / "study.toml"
    file.write_text('case = { kind = "ball-on-beam", surface = { rms = "1 um" } }\n[sweep]\n' + text)
    return load_study(file)


@pytest.mark.parametrize(
    "text",
    [
        'ball.load = ["1 N"]\n"ball.load" = ["2 N", "3 N"]',
        '"ball.load" = ["1 N"]\n[sweep.ball]\nload = ["2 N"]',
    ],
)
def test_a_key_that_is_swept_twice_is_refused(tmp_path, text):
    with pytest.raises(CaseError, match=r"sweep\.ball\.load: received the key more than once; .*one list"):
        study(tmp_path, text)


def test_a_study_may_have_thousands_of_seeds(tmp_path):
    found = study(tmp_path, f"seed = {list(range(9999))}")
    assert found.shape == (9999,)
    with pytest.raises(CaseError, match="seed: received 9998 more than once"):
        study(tmp_path, f"seed = {[*range(9999), 9998]}")


@pytest.mark.parametrize(
    ("text", "message"),
    [
        (f"seed = {[1] * 200_000}", "sweep.seed: received 200000 values; allowed: at most 10000"),
        ("\n".join(f'"ball.a{i}" = [1]' for i in range(20_000)), "sweep: received more keys"),
        ("\n".join(f'"{i}" = {{ a = 1 }}' for i in range(20_000)), "sweep: received more keys"),
    ],
)
def test_studies_beyond_all_measure_are_refused(tmp_path, text, message):
    with pytest.raises(CaseError) as caught:
        study(tmp_path, text)
    assert any(message in error for error in caught.value.errors)
    assert len(str(caught.value)) < 5000


# --- paths


@pytest.mark.parametrize(
    "read", [load_case, load_study, read_surface, read_result, lambda path: read_table(path, LEVELS)]
)
class TestPaths:
    """Whatever is no regular file is named, and never opened."""

    @pipes
    def test_a_pipe(self, tmp_path, read):
        os.mkfifo(tmp_path / "a.csv")
        with pytest.raises(InputError, match=r"a\.csv: received a pipe or a device"):
            read(tmp_path / "a.csv")

    @proc
    def test_a_file_of_the_kernel(self, read):
        with pytest.raises(InputError, match="kmsg: received an empty file"):
            read(Path("/proc/kmsg"))

    def test_an_endless_device(self, read):
        if not Path("/dev/zero").exists():
            pytest.skip("no such device")
        with pytest.raises(InputError, match="zero: received a pipe or a device"):
            read(Path("/dev/zero"))

    def test_a_name_that_is_too_long(self, tmp_path, read):
        with pytest.raises(
            InputError, match=r"received a path that cannot be followed \(File name too long\)"
        ):
            read(tmp_path / LONG_NAME)

    def test_an_absent_file(self, tmp_path, read):
        with pytest.raises(InputError, match=r"absent\.csv: received no such file"):
            read(tmp_path / "absent.csv")
        (tmp_path / "file").write_text("1")
        with pytest.raises(InputError, match=r"absent\.csv: received no such file"):
            read(tmp_path / "file" / "absent.csv")


@pipes
def test_files_of_a_case_are_regular(tmp_path):
    os.mkfifo(tmp_path / "map.npy")
    os.symlink("loop", tmp_path / "loop")
    for name, reason in (
        ("map.npy", "It is a pipe or a device"),
        ("loop", "It is a path that cannot be followed"),
        (LONG_NAME, r"It is a path that cannot be followed \(File name too long\)"),
        (".", "It is a folder"),
    ):
        with pytest.raises(CaseError, match=f"surface.file: .*{reason}"):
            parse_case(f'{BALL}[surface]\nfile = "{name}"', tmp_path / "case.toml")


def test_no_more_of_a_table_is_read_than_it_may_have(tmp_path):
    file = tmp_path / "levels.csv"
    with open(file, "wb") as sparse:
        sparse.truncate(2**33)
    tracemalloc.start()
    with pytest.raises(
        InputError, match=r"levels\.csv: received more than 10 MiB; allowed: .* at most 10 MiB"
    ):
        read_levels(file)
    assert tracemalloc.get_traced_memory()[1] < 2**26
    tracemalloc.stop()


@pytest.mark.parametrize("text", ["1.5\n" * 40_000, "2;" * 80_000], ids=["a column", "a row"])
def test_heights_as_text_take_a_few_times_their_file(tmp_path, text):
    (tmp_path / "line.txt").write_text(text)
    tracemalloc.start()
    read_surface(tmp_path / "line.txt", height_unit="um", pixel="1 mm")
    peak = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    assert peak < 2**20 + 16 * len(text)  # a number of eight bytes for each two, and its copy


def test_text_that_is_too_large_or_no_numbers_is_refused_with_a_number(tmp_path):
    with open(tmp_path / "large.txt", "wb") as sparse:
        sparse.truncate(2**31)
    with pytest.raises(InputError, match="received 2 GiB; allowed: at most 1 GiB of text"):
        read_surface(tmp_path / "large.txt", height_unit="um", pixel="1 mm")
    (tmp_path / "tale.txt").write_text("once upon a time\n" * 70_000)
    with pytest.raises(InputError, match="more than 1 MiB of text that is no number; allowed: heights as"):
        read_surface(tmp_path / "tale.txt", height_unit="um", pixel="1 mm")


def test_a_link_that_leads_nowhere_is_no_folder(tmp_path):
    (tmp_path / "link").symlink_to(tmp_path / "nowhere")
    for folder in (tmp_path / "link", tmp_path / "link" / "run"):
        with pytest.raises(InputError, match=r"link is a link that leads nowhere\); allowed: a folder that"):
            refuse_unwritable(folder, "folder of the results", "Choose another one with -o.")


def test_names_that_are_too_long_cannot_be_written(tmp_path):
    with pytest.raises(InputError, match=r"folder of the results: received .*File name too long.*with -o"):
        refuse_unwritable(tmp_path / LONG_NAME, "folder of the results", "Choose another one with -o.")
    with pytest.raises(InputError, match="a name that is too long"):
        write_bytes(tmp_path / f"{LONG_NAME}.png", b"")
    with pytest.raises(InputError, match="a name that is too long"), alone_in(tmp_path / LONG_NAME):
        pass
    assert Store(tmp_path / LONG_NAME).files() == []


# --- names in messages


def test_messages_are_text_on_one_line():
    message = str(InputError("a\x1b[31m", "b\u202e\nError: none", "c\x9b", "d\ud800"))
    assert message == "a\\x1b[31m: received b\\u202e\\nError: none; allowed: c\\x9b. d\\ud800"
    assert str(ComputationError("a\x1b", "b")) == "a\\x1b. Try: b."
    assert str(CaseError("a\x1b.toml", ["wrong"])) == "a\\x1b.toml: 1 error\n  - wrong"


def test_unknown_keys_and_arrays_are_spelled_out(tmp_path):
    with pytest.raises(CaseError, match=r"\\x1b\[31m: received an unknown key"):
        parse_case(BALL + '"\\u001b[31m" = 1')
    np.savez(tmp_path / "maps.npz", **{"\x1b[31ma": np.eye(4), "b": np.eye(4)})
    with pytest.raises(InputError, match=r"received \\x1b\[31ma, b; allowed: exactly one"):
        read_surface(tmp_path / "maps.npz", height_unit="um", pixel="1 um")


def test_few_of_many_names_are_listed(tmp_path):
    assert listed(["a", "b" * 100]) == "a, " + "b" * 57 + "…"
    np.savez(tmp_path / "maps.npz", **{f"array{i:03}": np.eye(2) for i in range(300)})
    with pytest.raises(InputError, match=r"array000, .*array009 and 290 more; allowed: exactly one"):
        read_surface(tmp_path / "maps.npz", height_unit="um", pixel="1 um")
    with pytest.raises(InputError, match=r"one of: array000, .*array009 and 290 more"):
        read_surface(tmp_path / "maps.npz", array="x", height_unit="um", pixel="1 um")


def test_a_result_may_name_files_that_are_no_utf8(tmp_path):
    groups = {f"/{name}": xr.Dataset() for name in GROUPS}
    groups["/"] = xr.Dataset(
        attrs={"asperity_version": "1", "schema_version": VERSION, "case": 'file = "\udcff.npy"'}
    )
    tree = xr.DataTree.from_dict(groups)
    assert read_result(save(tree, tmp_path / "run.nc")).attrs["case"] == 'file = "\\udcff.npy"'
    assert tree.attrs["case"] == 'file = "\udcff.npy"'


# --- numbers, and maps of nothing


@pytest.mark.parametrize("text", ["1_0", "1_000.5", b"1_0", "one", ""])
def test_marks_between_digits_are_no_number(text):
    with pytest.raises(ValueError, match=r"no number|could not convert"):
        number_in(text)


def test_marks_between_digits_are_refused_in_files(tmp_path):
    (tmp_path / "a.csv").write_text("1.5;2\n1_0;4\n")
    with pytest.raises(InputError, match=r"received '1_0;4' in line 2"):
        read_surface(tmp_path / "a.csv", height_unit="um", pixel="1 um")
    (tmp_path / "b.csv").write_text("line_1\n2024_01_15\n1_0;2\n3;4\n5;6\n")  # no heading of two columns
    with pytest.raises(InputError, match=r"received '1_0;2' in line 3"):
        read_surface(tmp_path / "b.csv", height_unit="um", pixel="1 um")
    (tmp_path / "c.csv").write_text("line_1\n2024_01_15\n____;____\n3;4\n5;6\n")
    assert read_surface(tmp_path / "c.csv", height_unit="um", pixel="1 um").heights.size == 2
    (tmp_path / "levels.csv").write_text("0.1, 1_0\n0.08, 2\n")
    with pytest.raises(InputError, match="in line 1"):
        read_levels(tmp_path / "levels.csv")
    assert no_file(tmp_path / "levels.csv") == ""


@pytest.mark.parametrize("height", [0.0, 5e-6])
def test_nothing_is_synthesised_from_a_plane(height):
    plane = HeightMap(np.full((32, 32), height), (1e-6, 1e-6), "plane.npy")
    with pytest.raises(InputError, match=r"maps: received a plane without roughness, plane\.npy"):
        likeness(plane)
