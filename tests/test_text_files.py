"""Comma-separated text: exact numbers, and words that no spreadsheet runs."""

import csv
import io
import math

import numpy as np
import pytest

from asperity.reporting.figure import columns_text
from asperity.text_files import csv_text, write_csv


@pytest.mark.parametrize("word", ["=cmd|' /C calc'!A0", "+1+1", "-2+3", "@SUM(A1)"])
def test_words_that_look_like_formulas_are_escaped(word):
    text = csv_text([word, "b"], [[word, -1.5]])
    heading, row = csv.reader(io.StringIO(text, newline=""))
    assert heading == [f"'{word}", "b"]
    assert row == [f"'{word}", "-1.5"]


def test_numbers_are_exact_and_missing_ones_empty():
    """Of figures as of studies."""
    numbers = [-0.1, 1 / 3, 5e-324, 1e308, -3.0]
    text = csv_text(["n", "m"], [(number, math.nan) for number in numbers])
    assert columns_text({"n": np.array(numbers), "m": np.full(5, np.nan)}) == text
    heading, *rows = csv.reader(io.StringIO(text))
    assert heading == ["n", "m"]
    assert [(float(number), missing) for number, missing in rows] == [(number, "") for number in numbers]


def test_a_word_stays_in_its_field(tmp_path):
    words = ["\t=1", "\r=1", "a\r\nb", "\ud800", 'a,"b"']
    file = write_csv(tmp_path / "a.csv", ["a"], [[word] for word in words])
    with open(file, newline="", encoding="utf-8") as opened:
        shown = [row[0] for row in csv.reader(opened)]
    assert shown == ["a", "\\t=1", "\\r=1", "a\\r\\nb", "\\ud800", 'a,"b"']
