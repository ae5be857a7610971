"""Charts as a browser gets them: numbers within a hair, once, in little room, and harmless."""

import base64
import json
import zlib

import numpy as np
import pytest
from report_reading import HOSTILE

from asperity.reporting import payload
from asperity.reporting.chart import BLUE, COLOURS, Axis, Boxes, Chart, Field, Line, Note, Panel
from asperity.reporting.figure import Lines, Series
from asperity.reporting.payload import LEVELS, LONG, charts_json
from asperity.reporting.tables import numbers_table

X, LOG = Axis("x / m"), Axis("y / Pa", log=True)


def chart(*marks, y=X, **kwargs):
    return Chart((Panel(X, y, marks),), **kwargs)


def read(charts):
    """What was laid out, its arrays unpacked as the script unpacks them."""
    found = json.loads(charts_json(charts, COLOURS))
    plain, start, arrays = zlib.decompress(base64.b64decode(found["data"])), 0, []
    for how in found["arrays"]:
        count, planes = how["count"], 0 if "start" in how else 2 if "low" in how else 4
        raw = np.frombuffer(plain[start : start + planes * count], np.uint8).reshape(planes, count)
        start += planes * count
        if "start" in how:
            arrays.append(how["start"] + how["step"] * np.arange(count))
        elif "low" in how:
            changes = raw[0].astype(np.int64) | raw[1].astype(np.int64) << 8
            levels = np.cumsum(np.cumsum(changes)) & 0xFFFF
            arrays.append(np.where(levels, how["low"] + how["size"] * (levels - 1), np.nan))
        else:
            arrays.append(np.ascontiguousarray(raw.T).view("<f4").ravel())
    assert start == len(plain)
    return found["charts"], arrays


def line_of(numbers, y=X):
    """Numbers of a line as the browser has them."""
    charts, arrays = read({"a": chart(Line(np.arange(float(len(numbers))) ** 2, numbers), y=y)})
    return arrays[charts["a"]["panels"][0]["marks"][0]["y"]]


def numbers(count, seed=1):
    """Numbers of no order, some of them missing."""
    found = np.random.default_rng(seed).standard_normal(count) * 10.0 + 1e3
    found[:: max(count // 7, 2)] = np.nan
    return found


@pytest.mark.parametrize("count", [1, 2, 5, 900, 1001, 40_000])
def test_lines_are_in_single_precision_and_long_ones_within_half_a_level(count):
    there, here = numbers(count), line_of(numbers(count))
    half = 0.51 * np.ptp(there[~np.isnan(there)]) / LEVELS if count > LONG else 0.0
    np.testing.assert_allclose(here, there, rtol=0.0 if half else 1e-7, atol=half)


@pytest.mark.parametrize(
    ("kept", "y"),
    [(np.full(2000, 7.0), X), (np.full(2000, np.nan), X),
     (10.0 ** np.random.default_rng(2).uniform(-30, 3, 5000), LOG)],
)  # fmt: skip
def test_what_never_changes_and_what_stands_on_a_logarithmic_axis_keeps_its_digits(kept, y):
    np.testing.assert_allclose(line_of(kept, y), kept, rtol=1e-7)


def test_arrays_are_kept_once_and_equal_steps_as_such():
    time, force = np.linspace(0.0, 3.0, 30_001), numbers(30_001)
    one, two = Line(time, force, "one"), Line(time, force, "two")
    charts, arrays = read({"a": chart(one), "b": chart(one, two)})
    assert [len(array) for array in arrays] == [30_001, 30_001]
    np.testing.assert_allclose(arrays[charts["b"]["panels"][0]["marks"][1]["x"]], time, atol=1e-12)
    assert len(charts_json({"a": chart(one)}, COLOURS)) < 2.7 * 30_001


def test_a_chart_of_many_numbers_keeps_their_extremes(monkeypatch):
    monkeypatch.setattr(payload, "MOST", 6000)
    x, signal = np.linspace(0, 1, 40_000), numbers(40_000)
    signal[[12_345, 23_456]] = 2e3, -2e3
    charts, arrays = read({"a": chart(Line(x, signal), Line(x, 2 * signal))})
    mark = charts["a"]["panels"][0]["marks"][0]
    at, kept = arrays[mark["x"]], arrays[mark["y"]]
    assert 2 * len(kept) <= 6000
    assert (np.nanmin(kept), np.nanmax(kept)) == pytest.approx((-2e3, 2e3), abs=0.2)
    assert at[np.nanargmax(kept)] == pytest.approx(x[12_345], abs=2 * (at[1] - at[0]))


def test_fields_are_as_fine_as_can_be_seen():
    heights = np.add.outer(np.arange(2000.0), np.arange(100.0))
    heights[0, 0] = np.nan
    field = Field((0, 1), (0, 1), heights, "height / µm", 0.0, 2100.0)
    charts, arrays = read({"a": chart(field)})
    told = charts["a"]["panels"][0]["marks"][0]["values"]
    kept = arrays[told["array"]].reshape(told["shape"])
    assert kept.shape == (667, 100)
    assert np.isnan(kept[0, 0])
    np.testing.assert_allclose(kept[1:], heights[3::3], atol=0.51 * np.nanmax(heights) / 1022)


def test_endless_boxes_and_colours_reach_the_page_and_notes_without_a_place_do_not():
    box = Boxes(np.zeros(1), np.ones(1), np.array([-np.inf]), np.array([np.inf]), colour=BLUE, edge="#123456")
    charts, arrays = read({"a": chart(box, Note("here", np.nan, 1.0))})
    (mark,) = charts["a"]["panels"][0]["marks"]
    colour = f"--c{list(COLOURS).index(BLUE)}"
    assert (mark["kind"], mark["colour"], mark["edge"]) == ("boxes", colour, "#123456")
    assert (arrays[mark["low"]][0], arrays[mark["high"]][0]) == (-np.inf, np.inf)


def test_nothing_in_the_data_ends_their_element():
    words = f"</script>{HOSTILE}<!--"
    marks = Line(np.zeros(2), np.zeros(2), words, law=words), Note(words, 0.0, 0.0)
    text = charts_json({words: Chart((Panel(Axis(words), X, marks, title=words),))}, COLOURS)
    assert "<" not in text
    assert json.loads(text)["charts"][words]["panels"][0]["marks"][1]["text"] == words


def test_the_table_of_a_figure_is_thinned_and_says_so():
    x = np.arange(100.0)
    lines = [Series(f"z(y={n} m)", "m", np.where(x > 90, np.nan, -1e-6 * n)) for n in range(40)]
    table = numbers_table(Lines(Series("x", "m", x), lines).columns())
    assert (len(table.rows), len(table.head)) == (24, 12)
    assert table.note == "24 of 100 rows and 12 of 41 columns; the CSV file has all."
    assert [cell.text for cell in (table.rows[0][-1], table.rows[-1][-1])] == ["−3.9·10⁻⁵", "–"]
    foremost = [line.heading for line in lines[7:9]]
    assert set(foremost) < set(numbers_table(Lines(Series("x", "m", x), lines).columns(), foremost).head)
    assert len(numbers_table(Lines(None, lines).columns(), [line.heading for line in lines]).head) == 12
    assert numbers_table(Lines(None, [Series("a", "m", np.ones(1))]).columns()).note == ""
