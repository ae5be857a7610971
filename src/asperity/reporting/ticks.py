"""Axes drawn with one tick each: five artists for every tick are most of the time that a drawing takes."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from functools import partial
from typing import Any

import numpy as np
from matplotlib.axis import Axis, Tick, XAxis
from matplotlib.figure import Figure
from matplotlib.ticker import NullLocator
from matplotlib.transforms import Bbox
from numpy.typing import NDArray

_REPLACED = ("_update_ticks", "_get_ticklabel_bboxes", "draw")
"""How axes are asked for their ticks; those of a matplotlib that asks otherwise are drawn its own way."""


@contextmanager
def one_tick_each(figure: Figure) -> Iterator[None]:
    """Lay out and draw the axes of a figure from one tick each in the body of the ``with`` statement."""
    if not all(hasattr(Axis, name) for name in _REPLACED):
        yield
        return
    found: list[Any] = [axis for axes in figure.axes for axis in (axes.xaxis, axes.yaxis)]
    for axis in found:
        moved = _Moved(axis)
        vars(axis).update(
            zip(_REPLACED, (moved.ticks, moved.boxes, partial(_draw, axis, moved)), strict=True)
        )
    try:
        yield
    finally:
        for axis in found:
            for name in _REPLACED:
                del vars(axis)[name]


_EXTENTS: dict[tuple[Any, ...], NDArray[np.float64]] = {}
"""Extents (x0, y0, x1, y1) of labels from where they are anchored, in pixels, by what is written and how."""
_MOST = 10_000


class _Moved:
    """The places and labels of the ticks of an axis, and the tick that is moved from one to the next."""

    def __init__(self, axis: Any) -> None:
        self.axis = axis
        self.known: tuple[Any, ...] = ()
        self.rows: list[_Row] = []
        self.extents: tuple[list[Bbox], list[Bbox]] | None = None  # of their labels on either side

    def ticks(self) -> list[Tick]:
        """One tick of each row: what stands for all of them."""
        return [row.tick for row in self.current()]

    def boxes(self, ticks: list[Tick], renderer: Any) -> tuple[list[Bbox], list[Bbox]]:
        """Extents of the labels on either side of the axes, in pixels."""
        rows = self.current()
        if self.extents is None:
            found = ([row.box(side, renderer) for row in rows] for side in (0, 1))
            first, second = ([box for box in boxes if box is not None] for boxes in found)
            self.extents = first, second
        return self.extents

    def current(self) -> list[_Row]:
        """Rows of ticks for the limits and the place that the axes have now."""
        axis = self.axis
        now = (*axis.get_view_interval(), *axis.axes.bbox.bounds)
        if now != self.known:
            groups = (
                (axis.major, axis.get_majorticklocs, axis.get_major_ticks),
                (axis.minor, axis.get_minorticklocs, axis.get_minor_ticks),
            )
            self.rows = [
                row
                for group, places, ticks in groups
                if not isinstance(group.locator, NullLocator)
                and len((row := _row(axis, group.formatter, places(), ticks)).places)
            ]
            self.known, self.extents = now, None
        return self.rows


class _Row:
    """Ticks of one length: where they are, in data, what is written at them, and the one that is moved."""

    def __init__(self, axis: Axis, tick: Tick, places: NDArray[np.float64], labels: list[str]) -> None:
        self.tick, self.places, self.labels = tick, places, labels
        self.across = isinstance(axis, XAxis)

    def points(self, over: NDArray[np.float64]) -> NDArray[np.float64]:
        """Places along the axis and `over` across it, (n, 2)."""
        pair = (self.places, over) if self.across else (over, self.places)
        return np.column_stack(pair)

    def label(self, side: int) -> Any:
        """The text that writes the labels on one side of the axes; None where they are not shown."""
        label = (self.tick.label1, self.tick.label2)[side]
        return label if label.get_visible() else None

    def written(self, label: Any) -> Iterator[str]:
        """Each label that is not empty in turn, with the text that writes it moved to its place."""
        for text, place in zip(self.labels, self.places, strict=True):
            if text:
                (label.set_x if self.across else label.set_y)(place)
                label.set_text(text)
                yield text

    def box(self, side: int, renderer: Any) -> Bbox | None:
        """Extent of all the labels on one side, in pixels; None where there are none."""
        label = self.label(side)
        words = [] if label is None else [k for k, text in enumerate(self.labels) if text]
        if not words:
            return None
        looks = (
            label.get_figure().dpi,
            label.get_fontsize(),
            label.get_rotation(),
            label.get_ha(),
            label.get_va(),
        )
        if len(_EXTENTS) > _MOST:
            _EXTENTS.clear()
        for text in self.written(label):
            if (text, *looks) not in _EXTENTS:
                anchor = label.get_transform().transform(label.get_position())
                extent = label.get_window_extent(renderer).extents
                _EXTENTS[text, *looks] = extent - np.tile(anchor, 2)
        beside = label.get_position()[1 if self.across else 0]
        anchors = label.get_transform().transform(self.points(np.full(len(self.places), beside)))[words]
        extents = np.tile(anchors, 2) + [_EXTENTS[self.labels[k], *looks] for k in words]
        return Bbox([extents[:, :2].min(axis=0), extents[:, 2:].max(axis=0)])

    def draw(self, renderer: Any) -> None:
        """Draw the grid, the marks and the labels."""
        tick = self.tick
        if tick.gridline.get_visible():
            gap = np.full(len(self.places), np.nan)
            ends = [
                self.points(np.zeros_like(gap)),
                self.points(np.ones_like(gap)),
                np.column_stack((gap, gap)),
            ]
            tick.gridline.set_data(*np.stack(ends, axis=1).reshape(-1, 2).T)
            tick.gridline.draw(renderer)
        for mark in (tick.tick1line, tick.tick2line):
            if mark.get_visible():
                over = float(np.ravel(mark.get_ydata() if self.across else mark.get_xdata())[0])
                mark.set_data(*self.points(np.full(len(self.places), over)).T)
                mark.draw(renderer)
        for label in filter(None, (self.label(0), self.label(1))):
            for _ in self.written(label):
                label.draw(renderer)


def _row(axis: Axis, formatter: Any, places: Any, ticks: Any) -> _Row:
    places = np.asarray(places, dtype=float)
    labels = formatter.format_ticks(places)
    transform = axis.get_transform()
    low, high = sorted(transform.transform(axis.get_view_interval()))
    at = transform.transform(places)
    margin = 1e-10 * (high - low)
    inside = (at >= low - margin) & (at <= high + margin)
    shown = [label for label, is_inside in zip(labels, inside, strict=True) if is_inside]
    return _Row(axis, ticks(1)[0], places[inside], shown)


def _draw(axis: Any, moved: _Moved, renderer: Any) -> None:
    """Draw an axis, as `matplotlib.axis.Axis.draw` does."""
    if not axis.get_visible():
        return
    for row in moved.current():
        row.draw(renderer)
    axis._update_label_position(renderer)
    axis.label.draw(renderer)
    axis._update_offset_text_position(*moved.boxes([], renderer))
    axis.offsetText.set_text(axis.major.formatter.get_offset())
    axis.offsetText.draw(renderer)
