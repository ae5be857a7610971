"""Figures as files: what matplotlib draws of a chart, what a drawing is as SVG, which figures are meant."""

from dataclasses import replace
from io import BytesIO

import numpy as np
import pytest

from asperity.ranks import Ranked
from asperity.reporting import chart
from asperity.reporting.chart import BLUE, Area, Axis, Boxes, Chart, Field, Line, Note, Panel, Rules, Second
from asperity.reporting.figure import PageFigure, chosen_figures, write_chart, write_figures
from asperity.reporting.panels import frequency_axis, wavenumber_axis, words_axis
from asperity.reporting.paper import draw, save_figure
from asperity.reporting.texture_figures import height_scale, lines_chart, surface_chart
from refusals import refusals

X = np.array([0.0, 1.0, 2.0])
Y = np.array([1.0, np.nan, 4.0])
ONE, TWO = np.array([0.5]), np.array([1.5])
ALL, MAP = np.array([np.inf]), np.arange(6.0).reshape(3, 2)


def axes_of(*marks, x=Axis("x / m", 0.0, 2.0), y=Axis("y / N", -5.0, 5.0), **place):  # noqa: B008
    return draw(Chart((Panel(x, y, marks, **place),))).axes[0]


def corners(axes):
    return axes.collections[0].get_paths()[0].vertices[:4]


def across(axes):
    return [segment[:, 0].tolist() for segment in axes.collections[0].get_segments()]


@pytest.mark.parametrize(
    ("mark", "drawn", "expected"),
    [
        (Line(X, Y, "force", BLUE, (3.0, 1.0)), lambda a: a.lines[0].get_xydata(), np.column_stack([X, Y])),
        (Line(X, Y, marker="^", width=0), lambda a: a.lines[0].get_linestyle() == "None", True),
        (Area(X, X - 1, X + 1), lambda a: a.collections[0].get_datalim(a.transData).bounds, (0, -1, 2, 4)),
        (Boxes(ONE, TWO, -ONE, ONE, hatch="/"), corners, [[0.5, -0.5], [0.5, 0.5], [1.5, 0.5], [1.5, -0.5]]),
        (Boxes(ONE, ALL, -ALL, ALL), corners, [[0.5, -5], [0.5, 5], [2, 5], [2, -5]]),
        (Rules(np.array([0.5, 1.0])), across, [[0.5, 0.5], [1, 1]]),
        (Rules(ONE, "y", short=True), across, [[0.0, 0.04]]),
        (Note("here", 1.0, 0.5, y_share=True), lambda a: a.texts[0].xy, (1.0, 0.5)),
        (Field((0, 2), (0, 1), MAP, "h / m", 0, 5), lambda a: a.images[0].get_array(), MAP.T),
        (chart.Shape(X, X, fill=BLUE), lambda a: a.patches[0].get_xy()[:3], np.column_stack([X, X])),
    ],
    ids=lambda value: type(value).__name__ if not callable(value) else "",
)
def test_numbers_of_a_mark_arrive(mark, drawn, expected):
    np.testing.assert_array_equal(np.ma.filled(drawn(axes_of(mark)), np.nan), expected)


def ticks(axes, way="x"):
    axes.figure.draw_without_rendering()
    side = getattr(axes, f"{way}axis")
    low, high = sorted(side.get_view_interval())
    inside = (label for label in side.get_ticklabels() if low <= label.get_position()[way == "y"] <= high)
    return [label.get_text() for label in inside]


@pytest.mark.parametrize(("axis", "named"), [
    (frequency_axis(20, 1200), "31.5 63 125 250 500 1k"),
    (wavenumber_axis(10, 1e4), "10¹ 10² 10³ 10⁴"),
    (Axis("loss factor", 0.01, 0.6, log=True), "0.01 0.02 0.05 0.1 0.2 0.5"),
    (words_axis(["areal", "linear"]), "areal linear"),
    (Axis("down", 1.0, -1.0), "1.00 0.75 0.50 0.25 0.00 −0.25 −0.50 −0.75 −1.00"),
])  # fmt: skip
def test_an_axis_names_its_ticks(axis, named):
    axes = axes_of(Line(ONE, ONE), x=axis)
    assert sorted(ticks(axes)) == sorted(named.split())
    assert (axis.low, axis.high) == axes.get_xlim()


def test_an_axis_opposite_shows_what_it_is_scaled_to():
    top = axes_of(x=wavenumber_axis(10, 1e4)).child_axes[0]
    assert ticks(top)[:4] == ["100 µm", "200 µm", "500 µm", "1 mm"]
    orders = replace(frequency_axis(20, 1200), second=Second("orders", 0.05))
    assert ticks(axes_of(x=orders).child_axes[0]) == ["1", "2", "5", "10", "20", "50"]
    state = Axis("approach", 0.0, 4.0, second=Second("state", offset=1.0))
    opposite = axes_of(x=state).child_axes[0]
    assert ticks(opposite)[0] == "1.0"
    assert opposite.get_xlim() == (1.0, 5.0)


def test_axes_reach_as_far_as_the_marks_and_panels_share_a_legend():
    line = Line(X, Y, "areal", BLUE)
    free = Panel(Axis("x"), Axis("y"), (line, Boxes(ONE, TWO, -ALL, ALL)))
    upper, lower = draw(Chart((free, free))).axes
    assert upper.get_xlim() == (0.0, 2.0)
    assert upper.get_ylim() == pytest.approx((0.88, 4.12))
    assert [text.get_text() for text in upper.get_legend().get_texts()] == ["areal"]
    assert lower.get_legend() is None


@pytest.mark.parametrize(("format", "begin"), [("svg", b"<?xml"), ("pdf", b"%PDF"), ("png", b"\x89PNG")])
def test_the_same_numbers_make_the_same_file(format, begin):
    files = BytesIO(), BytesIO()
    for file in files:
        panel = Panel(Axis("x"), Axis("y"), (Line(X, Y, "a & <b>"),))
        save_figure(draw(Chart((panel,)), "title"), file, format)
    one, two = (file.getvalue() for file in files)
    assert one == two
    assert one.startswith(begin)
    assert format != "svg" or b"a &amp; &lt;b&gt;" in one  # words stay words


@pytest.mark.parametrize(("heights", "spacing"), [
    (np.random.default_rng(1).normal(0, 1e-6, (80, 60)), (1e-6, 2e-6)),
    (np.zeros((8, 8)), (1e-6, 1e-6)),
    (np.where(np.eye(40) > 0, np.nan, np.arange(40) * 1e-9), (1e-6, 1e-6)),
], ids=["map", "flat", "missing"])  # fmt: skip
def test_a_surface_is_drawn(heights, spacing, tmp_path):
    chart = surface_chart(heights, spacing, {})
    assert write_chart(chart, "<b>", tmp_path / "s.png").stat().st_size > 10_000
    if heights.size > 2000:  # drawn from the normal distribution
        normal = chart.panels[1].marks[-1]
        assert np.trapezoid(normal.y, normal.x) == pytest.approx(1.0, abs=0.01)
    unit, *_ = height_scale(Ranked([heights]))
    reached = unit * chart.panels[2].marks[0].y[[0, -1]]  # by none, and by all
    assert reached == pytest.approx([np.nanmax(heights), np.nanmin(heights)])


def test_lines_stand_below_each_other(tmp_path):
    rng = np.random.default_rng(0)
    lines = [rng.normal(0, 1e-5, n) for n in (400, 400, 300)]
    lines[0][5:9] = np.nan
    chart = lines_chart(lines, 1e-3, {})
    assert [name for _, name in chart.panels[0].y.ticks] == ["1", "2", "3"]
    assert write_chart(chart, "lines", tmp_path / "lines.PNG").read_bytes()[:4] == b"\x89PNG"


def part(name, title):
    panel = Panel(Axis("x"), Axis("y"), (Line(X, Y),))
    return PageFigure(name, title, "", Chart((panel,)))


PARTS = [
    part("force_bands", "Contact force levels in one-third octaves"),
    part("force_psd", "Contact force against frequency"),
    part("scene", "The scene"),
]


@pytest.mark.parametrize(("names", "found"), [
    ([], ["force_bands", "force_psd", "scene"]),
    (["scene", "force_psd", "scene"], ["scene", "force_psd"]),
    (["the SCENE"], ["scene"]),
    (["contact force levels"], ["force_bands"]),
])  # fmt: skip
def test_figures_are_found_by_name_and_title(names, found):
    assert [part.name for part in chosen_figures(PARTS, names)] == found


test_a_wrong_name_is_told_with_the_nearest = refusals(
    (PARTS, "force_band", r"'force_band'.* scene\. Did you mean \"force_bands\"\?"),
    (PARTS, "contact force", r"Say which: force_bands, force_psd\."),  # both begin so
    (PARTS, "xyz", r"a figure of this result, by name or title: force_bands, force_psd, scene\.$"),
    (PARTS, None, "received None"),
    ([], "force", "it has none"),
    of=lambda parts, name: chosen_figures(parts, [name]),
)


def test_figures_are_files_under_their_names(tmp_path):
    files = write_figures(PARTS[:2], tmp_path, "pdf")
    assert files == [tmp_path / "force_bands.pdf", tmp_path / "force_psd.pdf"]
    assert all(file.read_bytes().startswith(b"%PDF") for file in files)


def test_levels_of_spectra_are_over_their_reference():
    """(1 mm/s²)²/Hz is 60 dB re (1 µm/s²)²/Hz, and nothing has no level."""
    np.testing.assert_allclose(chart.decibels(np.array([1e-6, 0.0]), 1e-12), [60.0, np.nan], rtol=1e-12)
