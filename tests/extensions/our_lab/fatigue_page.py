"""A chapter of the report: for how long the force exceeds a value."""

import numpy as np

from asperity.reporting import chart
from asperity.reporting.figure import Chapter, Of, Series, figure
from asperity.schema.rolling import CONTACT_FORCE

FORCES = Of(CONTACT_FORCE, "{law}")


def share(tree):
    """Shares of the time, to which the sorted forces belong."""
    count = len(next(FORCES(tree)).values)
    yield Series("share of the time", "1", np.arange(count) / count)


@figure("Forces in order", share, FORCES)
def sorted_force(tree, lines):
    """The force of each law, sorted."""
    axes = chart.Axis("share of the time", 0.0, 1.0), chart.Axis("contact force / N")
    sorted_lines = [chart.Line(lines.at, np.sort(s.values), s.label, law=s.law) for s in lines.lines]
    yield chart.Panel(*axes, tuple(sorted_lines))
    yield "Of every law."


CHAPTER = Chapter("fatigue", "How long it bears which load", (sorted_force,))
