"""Axes drawn with one tick each look as matplotlib draws them."""

import re
from io import StringIO

import numpy as np
from matplotlib.figure import Figure
from matplotlib.ticker import FuncFormatter, MultipleLocator

from asperity.reporting.style import frequency_axis, legend_above, side_by_side, styled, wavenumber_axis
from asperity.reporting.svg import drawing_of
from asperity.reporting.ticks import one_tick_each


@styled()
def axes_of_every_sort():
    figure, (left, right) = side_by_side(4.0, (1, 1.4))
    left.plot([20, 5000], [3e-9, 8e-9], label="one")  # its axis writes a factor above
    frequency_axis(left, 20, 5000)
    left.set_ylabel("receptance / (m/N)")
    legend_above(left)
    image = right.pcolormesh(np.geomspace(1, 1e4, 5), np.arange(5.0), np.arange(16.0).reshape(4, 4))
    figure.colorbar(image, ax=right, label="height")
    wavenumber_axis(right, 1, 1e4)
    right.yaxis.set_major_locator(MultipleLocator(2))
    right.yaxis.set_minor_locator(MultipleLocator(0.5))
    right.yaxis.set_minor_formatter(FuncFormatter(lambda y, _: "quarter" if y == 2.5 else ""))
    right.tick_params(axis="y", labelrotation=90, labelright=True, right=True)
    right.invert_yaxis()
    return figure


def texts(body):
    return re.findall(r"<text ([^>]*)>([^<]*)</text>", body)


def test_every_word_stands_where_matplotlib_puts_it(monkeypatch):
    ours = drawing_of(axes_of_every_sort(), "figure")
    monkeypatch.setattr("asperity.reporting.ticks._REPLACED", ("a name of another matplotlib",))
    plain = drawing_of(axes_of_every_sort(), "figure")
    assert ours.box == plain.box
    assert sorted(texts(ours.body)) == sorted(texts(plain.body))
    assert {"quarter", "1e−9", "125", "10⁴"} <= {text for _, text in texts(ours.body)}


def drawn(figure, *, plain):
    text = StringIO()
    if plain:
        figure.savefig(text, format="svg")
    else:
        with one_tick_each(figure):
            figure.savefig(text, format="svg")
    return text.getvalue()


def test_grid_and_marks_are_those_of_matplotlib():
    """As many marks, and the same ends of the lines of the grid."""

    def figure():
        made = Figure()
        axes = made.subplots()
        axes.plot([0, 1], [2, 4])
        axes.grid(visible=True)
        return made

    plain, ours = drawn(figure(), plain=True), drawn(figure(), plain=False)
    count = plain.count("<use ")
    assert count > 10
    assert ours.count("<use ") == count
    line = r"M ([\d.]+ [\d.]+) \s*L ([\d.]+ [\d.]+) "
    assert set(re.findall(line, plain)) - set(re.findall(line, ours)) == set()


def test_an_axis_is_as_before_once_it_is_drawn():
    figure = axes_of_every_sort()
    before = [dict.fromkeys(vars(axes.xaxis)) for axes in figure.axes]
    with one_tick_each(figure):
        assert "draw" in vars(figure.axes[0].xaxis)
    assert [dict.fromkeys(vars(axes.xaxis)) for axes in figure.axes] == before
    assert [tick.get_text() for tick in figure.axes[0].get_xticklabels()]
