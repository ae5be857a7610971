"""Sections as standards print them: the wheel S1002 (EN 13715) and the head of 60E1 (EN 13674-1).

S1002 has the parts and coefficients, to the last digit, of H. Netter (DLR Oberpfaffenhofen), which teaching
and programs hand on; its flange is that of wheel A in UIC 519, whose tread is another. The head has the radii
of the rail of the Manchester contact benchmark (``MBench_UIC60_v3.prr`` of CONTACT), turned back by its 1:40,
and arcs that meet where its do.
"""

import numpy as np

_TREAD = (0.0, -3.358537058e-2, 1.565681624e-3, -2.810427944e-5, 5.844240864e-8, -1.562379023e-8,
          5.309217349e-15, -5.957839843e-12, 2.646656573e-13)  # fmt: skip
_ROOT = (-4.320221063e3, -1.038384026e3, -1.065501873e2, -6.051367875, -2.054332446e-1, -4.169739389e-3,
         -4.687195829e-5, -2.252755540e-7)  # fmt: skip
_PARTS = (  # from the back of the flange to the field side, mm
    (-62.765, lambda s: 9.519259302 + np.sqrt(20.5**2 - (s + 49.5) ** 2)),
    (-49.663, lambda s: 16.0 + np.sqrt(12.0**2 - (s + 55.0) ** 2)),
    (-39.764, lambda s: 8.834924130 + np.sqrt(20.0**2 - (s + 58.558326413) ** 2)),
    (-38.427, lambda s: -93.576667419 - 2.747477419 * s),
    (-35.0, lambda s: 16.446 - np.sqrt(13.0**2 - (s + 26.210665) ** 2)),
    (-26.0, lambda s: np.polynomial.polynomial.polyval(s, _ROOT)),
    (32.158, lambda s: np.polynomial.polynomial.polyval(s, _TREAD)),
    (60.001, lambda s: 1.364323640 - 0.066666667 * s),
)
_ARCS = ((300.0, 10.5), (80.0, 25.988), (13.0, 36.0))
"""Radii of the head of a 60E1 rail, and how far from its middle they reach, mm."""


def s1002(places):
    """Heights out of the material, mm, at places from the running circle, mm, positive to the field side."""
    heights, low = np.full(len(places), np.nan), -np.inf
    for high, shape in _PARTS:
        here = (places >= low) & (places < high)
        heights[here] = shape(places[here])
        low = high
    return heights


def head_60e1(places):
    """Heights out of the material, mm, of the head at places from its middle, mm: arcs that touch."""
    away, heights = np.abs(places), np.full(len(places), np.nan)
    radius, begin = _ARCS[0][0], 0.0
    centre = np.array([0.0, -radius])
    for radius_here, reach in _ARCS:
        end = np.array([begin, centre[1] + np.sqrt(radius**2 - (begin - centre[0]) ** 2)])
        centre, radius = end - radius_here * (end - centre) / radius, radius_here
        here = (away >= begin) & (away <= reach)
        heights[here] = centre[1] + np.sqrt(radius**2 - (away[here] - centre[0]) ** 2)
        begin = reach
    return heights
