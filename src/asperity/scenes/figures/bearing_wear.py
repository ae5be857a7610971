"""Wear of the raceways of a ball bearing on its page: depth over the angle around them."""

import numpy as np
from xarray import DataTree

from asperity.reporting import chart, data
from asperity.reporting.figure import Lines, Of, figure
from asperity.scenes.figures.bearing import AROUND, RINGS
from asperity.schema import bearing
from asperity.written_numbers import rounded

HOURS = 1000.0
"""Time in which depths are told, h."""


@figure(
    "Wear of the raceways",
    Of(bearing.RACEWAY_ANGLE),
    Of(bearing.WEAR_RATE, "{ring} ring"),
    Of(bearing.WORN_AREA_RATE, "{ring} ring"),
)
def raceway_wear(tree: DataTree, lines: Lines) -> chart.Drawn:
    """Depth that each raceway loses where its groove wears most, over the angle around it."""
    degrees = np.degrees(np.angle(np.exp(1j * lines.at)))
    order = np.argsort(degrees)
    depths = data.values(tree, bearing.WEAR_RATE) * 3600.0 * HOURS / 1e-6
    drawn = tuple(
        chart.Line(degrees[order], depth[order], f"{ring} ring", *RINGS[ring], 1.6)
        for ring, depth in zip(data.words(tree, bearing.RING), depths, strict=True)
    )
    across = chart.Axis(f"depth in {HOURS:g} h / µm", low=0.0)
    yield chart.Panel(AROUND, across, drawn, height=3.6)
    volumes = data.values(tree, bearing.WORN_VOLUME_RATE) * 3600.0 * HOURS / 1e-9
    told = zip(data.words(tree, bearing.RING), volumes, strict=True)
    lost = " and ".join(f"{rounded(float(volume), 2)} mm³ of the {ring} ring" for ring, volume in told)
    slips = "if all of each contact slips: the most there is"
    if data.present(tree, bearing.FRICTION_HEAT):
        slips = "by what slips with the friction of the case"
    yield (
        f"By Archard's law under the static load, {slips}, where the groove wears most. "
        f"In {HOURS:g} h of running so it is {lost}. A ring that stands still wears "
        "where it is loaded; one that turns meets all loads everywhere."
    )
