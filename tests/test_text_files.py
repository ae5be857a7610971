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
    numbers = [-0.1, 1 / 3, 5e-324, 1e308, -3, True]
    row = next(csv.reader(io.StringIO(csv_text(["n"] * 7, [[*numbers, math.nan]]).partition("\n")[2])))
    assert [float(field) for field in row[:5]] == numbers[:5]
    assert row[6] == ""


def test_figures_and_studies_share_one_writer():
    columns = {"x [m]": np.array([0.5, np.nan]), "F [N]": np.array([-1.0, 2.0])}
    assert columns_text(columns) == csv_text(list(columns), [(0.5, -1.0), (math.nan, 2.0)])
    assert columns_text(columns) == "x [m],F [N]\n0.5,-1.0\n,2.0\n"


def test_a_word_stays_in_its_field(tmp_path):
    words = ["\t=1", "\r=1", "a\r\nb", "\ud800", 'a,"b"']
    file = write_csv(tmp_path / "a.csv", ["a"], [[word] for word in words])
    with open(file, newline="", encoding="utf-8") as opened:
        shown = [row[0] for row in csv.reader(opened)]
    assert shown == [
        "a",
        "\\t=1",
        "\\r=1",
        "a\\r\\nb",
        "\\ud800",
        'a,"b"',
    ]
