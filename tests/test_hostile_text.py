"""Text that people write: whatever it is, it is read or refused at once, with a message.

The texts here are so long that time with their square would be hours.
"""

import io
import os
import re
import tracemalloc
from contextlib import contextmanager

import numpy as np
import pytest
import xarray as xr
from hypothesis import given
from hypothesis import strategies as st

from asperity import text_files
from asperity.arguments import listed, shown
from asperity.case.any_case import entries
from asperity.case.cases import as_case, case_class, parse_case, read_case
from asperity.case.tables import LEVELS, read_levels, read_table
from asperity.case.toml import read_toml
from asperity.errors import CaseError, InputError
from asperity.parameters import Quantity
from asperity.results import GROUPS, read_result, save
from asperity.schema import VERSION
from asperity.studies.definition import load_study, study_of
from asperity.studies.recorded import read_signal
from asperity.surfaces.readers import read_surface
from asperity.surfaces.readers.headings import parsed_header, titles_of
from asperity.text_files import blocks_of_lines, even_rows, number_in
from asperity.units import quantity

BALL = 'kind = "ball-on-beam"\n'
ROUGH = '\n[surface]\nrms = "1 um"\n'
MANY = 300_000
LONG_NAME = "a" * 300
UM = {"height_unit": "um", "pixel": "1 um"}


# --- what is beyond all measure


def length(text, folder):
    return quantity(text, "m")


def toml(text, folder):
    return read_toml(text, "case", "case.toml")


def case(text, folder):
    return parse_case(BALL + text, folder / "case.toml")


def study(text, folder):
    file = folder / "study.toml"
    file.write_text('case = { kind = "ball-on-beam", surface = { rms = "1 um" } }\n[sweep]\n' + text)
    return load_study(file)


def levels(text, folder):
    file = folder / "levels.csv"
    file.write_text(text)
    return read_levels(file)


def heights(text, folder):
    file = folder / "line.txt"
    file.write_text(text)
    return read_surface(file, **UM)


PARTS, KEYS = "a key of more than 20 parts", "keys and values; allowed: a case with at most"
TWICE = r"sweep\.ball\.load: received the key more than once; .*one list"
REFUSED = [
    *((length, start + "1" * MANY + "_", "Write the number first") for start in ("", "1.", "1e", " ")),
    *((levels, mark * MANY + ", level (dB" + " " * MANY + "x)\n1, 2\n", "the heading")
      for mark in ("(", "[", "(a", "( ")),
    *((toml, text, "no TOML") for text in (
        "a" * MANY, "'" * MANY, '"' * MANY, "a" + " " * MANY, ("a." * 19 + "! ") * 25_000)),
    (case, ".".join("a" * 20_000) + " = 1", PARTS),
    (case, "[" + " . ".join("a" * 20_000) + "]", PARTS),
    (case, '"b c".' * 20_000 + "a = 1", PARTS),
    (case, "\n".join(f"ball.a{i} = 1" for i in range(20_000)), KEYS),
    (case, "\n".join(f"[s{i}]" for i in range(20_000)), KEYS),
    (case, "laws = [" + '"x", ' * 200_000 + "]", KEYS),
    (case, "laws = " + "[" * 300 + "]" * 300, "more than 10 deep"),
    (case, "a" * 100_000 + " = 1", "received an unknown key"),
    (case, '"\\u001b[31m" = 1', r"\\x1b\[31m: received an unknown key"),
    (case, f'surface.file = "{".".join(map(str, range(19)))}"', "There is no such file"),
    # a key is never taken for the place of an error
    *((case, f"a = {{ x = 1 }}\na.{key}.y = 2", "no TOML")
      for key in ("'at line 9999'", "'(at line 9999, column 1)'", "'\\'")),
    (case, f"seed = {'1' * 400}{ROUGH}", "seed: received 1111"),
    (study, 'ball.load = ["1 N"]\n"ball.load" = ["2 N", "3 N"]', TWICE),
    (study, '"ball.load" = ["1 N"]\n[sweep.ball]\nload = ["2 N"]', TWICE),
    (study, f"seed = {[*range(9999), 9998]}", "seed: received 9998 more than once"),
    (study, f"seed = {[1] * 200_000}", "sweep.seed: received 200000 values; allowed: at most 10000"),
    (study, "\n".join(f'"ball.a{i}" = [1]' for i in range(20_000)), "sweep: received more keys"),
    (study, "\n".join(f'"{i}" = {{ a = 1 }}' for i in range(20_000)), "sweep: received more keys"),
    (heights, "once upon a time\n" * 70_000, "more than 1 MiB of text that is no number; allowed: heights"),
    # marks between digits are no number
    (heights, "1.5;2\n1_0;4\n", "received '1_0;4' in line 2"),
    (levels, "0.1, 1_0\n0.08, 2\n", "in line 1"),
]  # fmt: skip


@pytest.mark.parametrize(("read", "text", "message"), REFUSED, ids=range(len(REFUSED)))
def test_what_is_beyond_all_measure_is_refused_in_few_words(tmp_path, read, text, message):
    assert re.search(message, refusal(read, text, tmp_path))


def refusal(attempt, *arguments):
    """Message of the error that an attempt ends in, which can be shown; empty if it succeeds."""
    try:
        attempt(*arguments)
    except InputError as error:
        message = str(error)
        message.encode("utf-8")
        short = message if len(message) < 5000 else pytest.fail("a long message")
        return "\n".join([short, *getattr(error, "errors", [])])  # those that are only counted, too
    return ""


@pytest.mark.parametrize("columns", [3, 9])
def test_long_headers_say_nothing(columns):
    for line in (
        "# unit" + " " * MANY + "(", "# dx" + " " * MANY + "1", "# pixel = " + "1" * MANY + "_ um",
        "# " + "(" * MANY, "# " + "( " * MANY + "um", "# " + "unit" * MANY, "# " + "[a " * MANY,
    ):  # fmt: skip
        assert "z" not in parsed_header([line], titles_of([line], None, columns))


def test_headers_are_read_across_white_space():
    found = parsed_header(["# height \t unit  =   um", "# pixel \t size :  1.5   um"], [])
    assert found == pytest.approx({"z": 1e-6, "dx": 1.5e-6, "dy": 1.5e-6})


def test_what_is_large_and_right_is_read(tmp_path):
    assert study(f"seed = {list(range(9999))}", tmp_path).shape == (9999,)
    with pytest.warns(match="100000 points"):
        line = heights("z (um)\n" + "1\n\n2\n" * 100_000, tmp_path)
    assert line.heights.shape == (300_000,)
    np.testing.assert_array_equal(np.isnan(line.heights[:6]), [False, True, False] * 2)
    assert heights("line_1\n2024_01_15\n____;____\n3;4\n5;6\n", tmp_path).heights.size == 2


def test_ten_errors_are_listed_and_the_rest_counted():
    with pytest.raises(CaseError) as caught:
        parse_case(BALL + "\n".join(f"a{i} = 1" for i in range(50)))
    lines = str(caught.value).splitlines()
    assert lines[0] == "case: 50 errors"
    assert len(lines) == 12
    assert lines[-1] == "  - and 40 more"


def nested(depth):
    value = []
    for _ in range(depth):
        value = [value]
    return value


def test_a_mapping_that_holds_itself_is_refused():
    own = {"kind": "ball-on-beam", "surface": {"rms": "1 um"}}
    own["ball"] = own
    assert "more than 10 deep" in refusal(as_case, own)
    assert "without end" in shown(nested(2000))


HOSTILE = [
    10**400, -(10**400), 5e-324, 1e308, -1e308, float("nan"), float("inf"), True, None, b"abc", object(),
    "5e-324 {}", "1e308 {}", "-1e308 {}", "1e-308 {}", "inf", "1" * 400 + " {}", "0." + "0" * 30 + "1 {}",
    "1_0 {}", [[]], [{}], {}, {"a": []}, [], nested(9), LONG_NAME, "a/" * 3000, "\0", "\ud800", "\x1b[31m",
    [None], ".", {"name": "a\0b"}, {1: 2}, "x" * 100_000, [1] * 3, ["1 {}"] * 3, ["5e-324 {}"], {"name": []},
    "/dev/null",
]  # fmt: skip


@pytest.mark.parametrize("kind", ["ball-on-beam", pytest.param("wheel-on-rail", marks=pytest.mark.long)])
def test_any_value_of_any_key_is_right_or_a_clear_error(kind):
    """In a case, and swept by a study."""
    base = {"kind": kind, "surface": {"rms": "1 um"}}
    for entry in entries(case_class(kind)):
        unit = entry.key.one.dimension if isinstance(entry.key.one, Quantity) else "m"
        section, _, name = entry.dotted.rpartition(".")
        for value in HOSTILE:
            value = value.replace("{}", unit) if isinstance(value, str) else value
            inside = base.get(section, {}) | {name: value}
            refusal(as_case, base | ({section: inside} if section else {name: value}))
            refusal(lambda swept: study_of(base, swept).members(), {entry.dotted: [value]})


# --- paths

READERS = [read_case, load_study, read_surface, read_result, lambda path: read_table(path, LEVELS)]


@pytest.fixture
def odd(tmp_path):
    """A folder with a pipe, a file, and a link to itself."""
    if hasattr(os, "mkfifo"):
        os.mkfifo(tmp_path / "pipe.csv")
    (tmp_path / "file").write_text("1")
    os.symlink("loop", tmp_path / "loop")
    return tmp_path


@pytest.mark.parametrize("read", READERS)
@pytest.mark.parametrize(("path", "message"), [
    ("pipe.csv", r"pipe\.csv: received a pipe or a device"),
    ("/proc/kmsg", "kmsg: received an empty file"),
    ("/dev/zero", "zero: received a pipe or a device"),
    (LONG_NAME, r"received a path that cannot be followed \(File name too long\)"),
    ("file/absent.csv", r"absent\.csv: received no such file"),
])  # fmt: skip
def test_what_is_no_regular_file_is_named_and_never_opened(odd, read, path, message):
    if path in ("pipe.csv", "/proc/kmsg", "/dev/zero") and not (odd / path).exists():
        pytest.skip("no such files here")
    assert re.search(message, refusal(read, odd / path))


@pytest.mark.parametrize(("name", "reason"), [
    ("loop", "It is a path that cannot be followed"),
    (LONG_NAME, r"It is a path that cannot be followed \(File name too long\)"),
    (".", "It is a folder"),
])  # fmt: skip
def test_files_of_a_case_are_regular(odd, name, reason):
    assert re.search(f"surface.file: .*{reason}", refusal(case, f'surface.file = "{name}"', odd))


@contextmanager
def within(most):
    """Nothing takes more memory than that, bytes."""
    tracemalloc.start()
    try:
        yield
        assert tracemalloc.get_traced_memory()[1] < most
    finally:
        tracemalloc.stop()


@pytest.mark.parametrize(
    ("read", "size", "message"),
    [
        (read_levels, 2**33, r"a\.txt: received more than 32 MiB; allowed: .* at most 32 MiB"),
        (lambda file: read_surface(file, **UM), 2**31, "received 2 GiB; allowed: at most 256 MiB of text"),
    ],
)
def test_no_more_of_a_file_is_read_than_it_may_have(tmp_path, read, size, message):
    with open(tmp_path / "a.txt", "wb") as sparse:
        sparse.truncate(size)
    with within(2**26):
        assert re.search(message, refusal(read, tmp_path / "a.txt"))


@pytest.mark.parametrize("text", ["1.5\n" * 40_000, "2;" * 80_000], ids=["a column", "a row"])
def test_heights_as_text_take_a_few_times_their_file(tmp_path, text):
    with within(2**20 + 16 * len(text)):  # a number of eight bytes for each two, and its copy
        heights(text, tmp_path)


def test_a_signal_as_text_takes_a_few_times_its_file(tmp_path):
    (tmp_path / "a.txt").write_text(text := "volt\n" + "1\n" * 200_000)
    with within(2**20 + 16 * len(text)):
        values, _ = read_signal(tmp_path / "a.txt", 1e3)
    assert values.shape == (200_000,)


PLAIN = st.lists(st.floats(allow_nan=False, allow_infinity=False).map(repr), min_size=1, max_size=3)


@given(
    rows=st.lists(PLAIN, min_size=1, max_size=4),
    wide=st.sampled_from([" ", "\t", " \t "]),
    comma=st.booleans(),
)
def test_rows_at_once_are_what_their_numbers_are_one_by_one(rows, wide, comma):
    """To the last bit; lines of several lengths are left to those who say which."""
    lines = [f"{wide.join(row)}\n" for row in rows]
    found = even_rows(
        [line.replace(".", ",") for line in lines] if comma else lines, None, "," if comma else "."
    )
    if len({len(row) for row in rows}) > 1:
        assert found is None
    else:
        assert found.tolist() == [[number_in(word) for word in row] for row in rows]


@pytest.mark.parametrize(
    "line", ["1_0", "nan", "1;;2", "1;2;", "", " ", "0x1", "1;2;3", "1 2", "1", "é", "١"]
)
def test_what_is_not_plain_is_left_to_those_who_say_what_it_is(line):
    assert even_rows(["1;2\n", f"{line}\n", "3;4\n"], ";") is None


@pytest.mark.parametrize("end", ["\n", "\r\n", "\r"])
def test_blocks_hold_whole_lines_whatever_ends_them(monkeypatch, end):
    monkeypatch.setattr(text_files, "_BLOCK", 5)
    monkeypatch.setattr(text_files, "_FIRST_BLOCK", 3)
    content = end.join(["a", "", "longer than a block", "b", end])
    assert [line for lines in blocks_of_lines(content) for line in lines] == list(io.StringIO(content, None))


# --- names in messages


def test_messages_are_text_on_one_line():
    message = str(InputError("a\x1b[31m", "b\u202e\nError: none", "c\x9b", "d\ud800"))
    assert message == "a\\x1b[31m: received b\\u202e\\nError: none; allowed: c\\x9b. d\\ud800"
    assert str(CaseError("a\x1b.toml", ["wrong"])) == "a\\x1b.toml: 1 error\n  - wrong"


MANY_NAMES = [f"array{i:03}" for i in range(300)]


@pytest.mark.parametrize(("names", "array", "message"), [
    (["\x1b[31ma", "b"], None, r"received \\x1b\[31ma, b; allowed: exactly one"),
    (MANY_NAMES, "x", "one of: array000, .*array009 and 290 more"),
])  # fmt: skip
def test_arrays_are_spelled_out_and_few_of_many_are_listed(tmp_path, names, array, message):
    np.savez(tmp_path / "maps.npz", **{name: np.eye(2) for name in names})
    with pytest.raises(InputError, match=message):
        read_surface(tmp_path / "maps.npz", array=array, **UM)
    assert listed(["a", "b" * 100]) == "a, " + "b" * 57 + "…"


def test_a_result_may_name_files_that_are_no_utf8(tmp_path):
    groups = {f"/{name}": xr.Dataset() for name in GROUPS}
    attributes = {"asperity_version": "1", "schema_version": VERSION, "case": 'file = "\udcff.npy"'}
    tree = xr.DataTree.from_dict(groups | {"/": xr.Dataset(attrs=attributes)})
    assert read_result(save(tree, tmp_path / "run.nc")).attrs["case"] == 'file = "\\udcff.npy"'
    assert tree.attrs["case"] == 'file = "\udcff.npy"'
