"""Figures of a fit: what was measured, and what a case predicts before and after."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from asperity.arguments import Array
from asperity.reporting import chart, panels
from asperity.reporting.chart import Area, Axis, Drawn, Line, Panel

MOST_PANELS = 8
"""Measurements that are drawn; the CSV file has all."""
TWICE = 1.96
"""Standard deviations of a 95 % interval."""


@dataclass(frozen=True, eq=False)
class Compared:
    """A measurement beside what is predicted of it, all (n,); values are levels or magnitudes.

    Parameters
    ----------
    what, units, axis, title : str
        The quantity, its units, its axis with the unit, and where it comes from.
    at, measured, before, fitted : ndarray (n,)
        Places along the axis, and values there.
    deviation : ndarray (n,)
        Standard deviation of what was measured, dB.
    decade : float
        dB that ten times a value is; 0 of levels.
    """

    what: str
    units: str
    axis: str
    title: str
    at: Array
    measured: Array
    before: Array
    fitted: Array
    deviation: Array
    decade: float

    @property
    def is_banded(self) -> bool:
        """Whether its places are one-third octaves."""
        places = 10.0 * np.log10(self.at)
        return "Hz" in self.axis and bool(np.abs(places - np.rint(places)).max() < 1e-6)

    @property
    def ends(self) -> tuple[Array, Array]:
        """Ends of the 95 % interval of what was measured."""
        by = TWICE * self.deviation
        if not self.decade:
            return self.measured - by, self.measured + by
        return self.measured * 10.0 ** (-by / self.decade), self.measured * 10.0 ** (by / self.decade)


def fit_figure(found: Sequence[Compared], *, stated: bool) -> Drawn:
    """Panels of measurements, each with what is predicted before and after."""
    shown = found[:MOST_PANELS]
    for each in shown:
        marker = "o" if len(each.at) <= 60 else ""
        low, high = each.ends
        marks = (
            Area(each.at, low, high, colour=chart.INK, opacity=0.15),
            Line(each.at, each.before, "before", chart.BLUE, (1.5, 1.5), 1.3),
            Line(each.at, each.fitted, "fitted", chart.VERMILLION, (), 1.8),
            Line(each.at, each.measured, "measured", chart.INK, (), 1.0, marker),
        )
        values = [each.measured, each.before, each.fitted]
        label = f"{each.what} / {each.units}"
        y = panels.log_axis(label, values) if each.decade else panels.levels_axis(label, values, span=60.0)
        yield Panel(_along(each), y, marks, each.title, height=3.4)
    band = "the scatter of what was measured" if stated else "an uncertainty that is usual for it"
    yield f"Shaded: 95 % by {band}."
    yield chart.part_shown(len(shown), len(found), "measurements")


def _along(each: Compared) -> Axis:
    if each.is_banded and len(each.at) <= 40:
        return panels.band_axis(each.at)
    low = float(each.at.min())
    high = float(each.at.max())
    if "Hz" in each.axis and low > 0.0:
        return panels.frequency_axis(low, high)
    return Axis(each.axis.replace(" (", " / ").replace(")", ""), low, high)
