"""Numbers for people have no exponent of a computer, and two ends that read alike are told once."""

import ast
import re
import textwrap
from itertools import pairwise

import pytest
import xarray as xr

from asperity.reporting.data import typed_words
from asperity.written_numbers import (
    between,
    capital,
    count_of,
    engineering,
    in_newtons,
    plain,
    rounded,
    unbroken,
    with_article,
)
from package_source import MODULES, SOURCE, nodes_of


@pytest.mark.parametrize(
    ("value", "digits", "written"),
    [
        (4670.4, 3, "4670"), (65e3, 3, "65000"), (123456.0, 3, "123000"), (999_999.0, 3, "1·10⁶"),
        (1.234e-4, 3, "0.000123"), (-6.06e-6, 3, "-6.06·10⁻⁶"), (2.5e8, 2, "2.5·10⁸"), (0.5, 3, "0.5"),
        (0.0, 3, "0"), (56.0, 3, "56"), (float("nan"), 3, "nan"), (float("inf"), 3, "inf"),
    ],
)  # fmt: skip
def test_digits_are_written_out(value, digits, written):
    assert rounded(value, digits) == written
    assert plain(value, digits) == written.replace("-", "−")


def test_areas_are_in_a_unit_that_is_read():
    """The next one begins at a hundredth of it."""
    found = [engineering(each, "m²") for each in (1.34e-7, 9.1e-5, 4.2e-9, 0.0, 2.5e-14, 3.0)]
    assert found == ["0.134 mm²", "91.0 mm²", "4200 µm²", "0 m²", "0.0250 µm²", "3.00 m²"]


def test_a_sentence_begins_with_a_capital_and_keeps_its_names():
    assert capital("sound power by CNOSSOS-EU") == "Sound power by CNOSSOS-EU"
    assert capital("") == ""
    assert capital("contact.spacing = 1 mm is coarse") == "contact.spacing = 1 mm is coarse"


def test_a_number_and_its_unit_are_on_one_line_of_a_title():
    """The title of an envelope's picture broke "97 / % sure"."""
    told = "cwru.mat: the outer ring, 107.7 Hz, resolved to 0.5 Hz: 97 % sure"
    for width in range(12, len(told)):
        rows = textwrap.fill(unbroken(told), width).splitlines()
        assert not [row for row in rows if row.startswith(("%", "Hz"))]


def test_ends_counts_and_forces_are_in_words():
    assert (between("0.6", "0.6"), between("0.6", "0.7")) == ("0.6", "0.6 to 0.7")
    assert [count_of(n, "sample") for n in (0, 1, 8)] == ["0 samples", "1 sample", "8 samples"]
    things = ("frequency", "bay", "pass")
    assert [count_of(2, thing) for thing in things] == ["2 frequencies", "2 bays", "2 passes"]
    named = ("study", "optimisation", "envelope line")
    assert [with_article(each) for each in named] == ["a study", "an optimisation", "an envelope line"]
    assert [in_newtons(each) for each in (5.04, 65e3, 999.6)] == ["5.04 N", "65 kN", "1000 N"]


@pytest.mark.parametrize(
    ("values", "factor", "unit", "words"),
    [
        ([80 / 3.6, 85.7232 / 3.6, 120 / 3.6], 1 / 3.6, "km/h", ["80 km/h", "85.72 km/h", "120 km/h"]),
        ([80.001, 80.002], 1.0, "m/s", ["80.001 m/s", "80.002 m/s"]),  # as many digits as tell them apart
        ([123456.0, 7.0], 1.0, "N", ["123456 N", "7 N"]),
    ],
)
def test_swept_values_have_as_many_digits_as_tell_them_apart(values, factor, unit, words):
    attrs = {"units": "1", "typed_unit": unit, "typed_factor": factor}
    assert typed_words(xr.DataArray(values, dims="key", attrs=attrs)) == words


ALWAYS, UNITS = re.compile(r"\.[1-3]g"), re.compile(r" (N|Hz|1/min|µm|um|µs|us)(?![\w/^])")
"""Digits that a usual number has more of before its point, and units in which numbers are that large."""


def written_by_the_language(nodes):
    """Numbers in the texts of a module of which Python may write ``1e+02``, but for what is read again."""
    read_again = {
        id(each) for call in nodes if isinstance(call, ast.Call)
        and isinstance(call.func, ast.Name) and call.func.id in ("float", "int") for each in call.args
    }  # fmt: skip
    for text in nodes:
        if not isinstance(text, ast.JoinedStr) or id(text) in read_again:
            continue
        for part, follows in pairwise([*text.values, ast.Constant("")]):
            spec = part.format_spec if isinstance(part, ast.FormattedValue) else None
            form = (
                "".join(each.value for each in spec.values if isinstance(each, ast.Constant)) if spec else ""
            )
            unit = follows.value if isinstance(follows, ast.Constant) else ""
            if ALWAYS.fullmatch(form) or (re.fullmatch(r"\.[4-6]g", form) and UNITS.match(unit)):
                yield f"{part.lineno}: {ast.unparse(part.value)}:{form}{unit}"


def test_no_number_in_a_text_is_written_as_a_computer_does():
    """``{points:.2g} points`` reads 2.9e+09 points, ``{share:.2g} %`` 1e+02 %: `rounded` writes them out."""
    found = [
        f"{path.relative_to(SOURCE)}, line {told}"
        for path in MODULES
        if "kernels" not in path.parts
        for told in written_by_the_language(nodes_of(path))
    ]
    assert not found
    texts = ast.parse('f"{share:.2g} % of {force:.4g} N", float(f"{x:.3g}")')
    assert len(list(written_by_the_language([*ast.walk(texts)]))) == 2


COUNTED = re.compile(r"^(len\(.*\)|.*\.size|np\.count_nonzero\(.*\)|missing|removed|filled)$")
"""What is counted in a message, and may be one."""
MORE_THAN_ONE = ("scenes/figures/sideways.py", "scenes/population.py", "surfaces/readers/belief.py")
"""Modules that ask for more than one before."""


def test_one_of_a_thing_is_not_many():
    """These were read: "received 1 waves", "1 points have no height", "1 samples"."""
    plural = []
    for file in MODULES:
        name = file.relative_to(SOURCE).as_posix()
        for node in nodes_of(file):
            values = node.values if isinstance(node, ast.JoinedStr) and name not in MORE_THAN_ONE else ()
            for told, after in pairwise(values[:2]):  # further on, "at most" and "all" may stand before
                if isinstance(told, ast.FormattedValue) and isinstance(after, ast.Constant):
                    many = re.match(r" (?!(is|has|was|times|keys)\b)\w+s( (?!of )|$)", after.value)
                    if many and COUNTED.match(ast.unparse(told.value)):
                        plural.append(f"{name}:{told.lineno}: {ast.unparse(told.value)}{after.value}")
    assert not plural
