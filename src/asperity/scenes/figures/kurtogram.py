"""How impulsive a record is in bands of several widths."""

import numpy as np

from asperity.diagnostics import Kurtogram
from asperity.diagnostics.kurtogram import LEAST_POWER
from asperity.reporting import chart

LEVELS = 48
"""Columns of a kurtogram: a multiple of all numbers of bands."""


def kurtogram_panel(found: Kurtogram, chosen: tuple[float, float]) -> chart.Panel:
    """How impulsive a record is in bands of several widths, and of which one the envelope is taken."""
    counts = np.unique(found.count).astype(int)
    highest = 1e-3 * float(found.high.max())
    judged = np.where(found.power >= LEAST_POWER, found.kurtosis, np.nan)
    values = np.stack([np.repeat(judged[found.count == n], LEVELS // n) for n in counts], axis=1)
    levels = tuple((row + 0.5, f"{n}") for row, n in enumerate(counts))
    top = max(float(np.nanmax(values)), 1.0)
    shown = chart.Field(
        (0.0, highest), (0.0, float(len(counts))), values, "kurtosis − 2 of the band", 0.0, top
    )
    edges = chart.Rules(1e-3 * np.array(chosen), "x", "band of the envelope", chart.VERMILLION, (), 1.6)
    along = chart.Axis("frequency / kHz", 0.0, highest)
    title = f"Kurtogram, of bands that hold {100 * LEAST_POWER:g} % of the power or more"
    across = chart.Axis("number of bands", 0.0, float(len(counts)), ticks=levels)
    return chart.Panel(along, across, (shown, edges), title, height=3.0)
