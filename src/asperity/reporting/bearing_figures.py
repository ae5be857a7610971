"""Figures of a ball bearing: what each ball carries, and the envelope spectrum of its signal."""

from collections.abc import Mapping

import numpy as np

from asperity.reporting import chart
from asperity.reporting.chart import BLUE, GREEN, MUTED, VERMILLION, Axis, Chart, Line, Mark, Numbers, Panel

COLOURS = {"outer": BLUE, "inner": VERMILLION, "ball": GREEN}
"""Of the parts of a bearing."""
CONTEXT = 1.15
"""How far beyond the highest line the spectrum is drawn."""


def load_zone_chart(
    azimuth: Numbers, loads: Mapping[str, Numbers], cage: Numbers, displacement: Numbers, stiffness: Numbers
) -> Chart:
    """Loads of the balls, N, over their azimuth (Z,), rad; and what varies as the cage turns (m,), rad.

    That is the displacement of the inner ring, m, and its stiffness, N/m, both along the radial load.
    """
    degrees = np.degrees(np.angle(np.exp(1j * azimuth)))
    order = np.argsort(degrees)
    looks = {"inner": (VERMILLION, (), 1.3, "o"), "outer": (BLUE, (5.0, 1.5), 1.3, "s")}
    marks = tuple(
        Line(degrees[order], load[order], f"on the {ring} ring", *looks[ring]) for ring, load in loads.items()
    )
    turned = np.degrees(cage)
    ticks = tuple((angle, f"{angle:g}") for angle in (-180.0, -90.0, 0.0, 90.0, 180.0))
    around = Axis("azimuth from the radial load / °", -185.0, 185.0, ticks=ticks)
    along = Axis("angle of the cage / °", float(turned[0]), float(turned[-1]))
    moved, stiff = (Line(turned, each, colour=BLUE) for each in (1e6 * displacement, 1e-6 * stiffness))
    zone = Panel(around, Axis("load of a ball / N", low=0.0), marks, "load zone, a ball right below the load")
    below = Panel(along, Axis("displacement / µm"), (moved,), "inner ring while a ball passes", height=2.6)
    return Chart((zone, below, Panel(along, Axis("stiffness / (MN/m)"), (stiff,), height=2.6, beside=True)))


def envelope_chart(
    spectrum: tuple[Numbers, Numbers],
    tones: Mapping[str, float],
    found: Mapping[str, Numbers],
    unit: str,
    speed: float,
) -> Chart:
    """Envelope spectrum over frequency, Hz, with tones expected and harmonics found of each part (h, 2).

    Opposite stand multiples of the speed, turns per second.
    """
    highest = CONTEXT * max([5.0 * max(tones.values()), *(float(lines[-1, 0]) for lines in found.values())])
    frequency, amplitude = (each[spectrum[0] <= highest] for each in spectrum)
    marks: list[Mark] = [Line(frequency, amplitude, colour=MUTED, width=0.8)]
    for part, tone in tones.items():
        named = f"{part}: {tone:.1f} Hz and multiples, expected"
        at = tone * np.arange(1.0, 6.0)
        marks.append(chart.Rules(at[at < highest], label=named, colour=COLOURS[part], dashes=(2.0, 2.0)))
    for part, lines in found.items():
        marks.append(Line(lines[:, 0], lines[:, 1], f"{part}: found", COLOURS[part], width=0.0, marker="o"))
    along = Axis("frequency / Hz", 0.0, highest, second=chart.Second("orders of the speed", 1.0 / speed))
    across = Axis(f"amplitude of the envelope / {unit}", low=0.0)
    return Chart((Panel(along, across, tuple(marks), height=4.2),))
