"""What rolls, on the contact grid: elliptic, in a groove, or on a raceway."""

from __future__ import annotations

import math

from asperity.contact.hertz import check_half_space, groove_gap
from asperity.kinds.bodies.bodies import bodies_of
from asperity.kinds.bodies.case import Bodies
from asperity.kinds.bodies.smooth import raceway_radius, radius_across, smooth_contact
from asperity.kinds.bodies.textures import loads_of
from asperity.scenarios.geometry import Geometry, across_window, geometry, parabola


def geometry_of(case: Bodies) -> Geometry:
    """Lay out what rolls on the contact grid, under the static load of its first contact."""
    load = float(loads_of(bodies_of(case).rolling)[0])
    return body_geometry(case, load)


def body_geometry(case: Bodies, load: float) -> Geometry:
    """Lay out what rolls on the contact grid, under a load, N.

    In a groove the gap is that of circle in circle, and the half-space is asked for the angle that it fills.
    """
    body, hertz = case.body, smooth_contact(case)
    groove = body.groove_radius
    if groove is None:
        smallest = min(body.radius, body.across, radius_across(case), abs(raceway_radius(case)))
        section = parabola(case.contact, hertz.radius_y)
    else:
        smallest = math.inf  # looked at below
        section = groove_gap(across_window(case.contact), body.across, groove)
        _check_groove(case, load, groove)
    shape = geometry(case.contact, section, hertz, load, smallest_radius=smallest, body="body")
    return shape.within_window()


def _check_groove(case: Bodies, load: float, groove: float) -> None:
    """Hold the contact under the load, and in the highest state given, to the half-space in a groove."""
    hertz, top = smooth_contact(case), case.contact.approaches
    asked = [(hertz.approach(load), f"a working load of {load:.3g} N")]
    if top is not None:
        asked.append((top[-1], f"an approach of {top[-1] * 1e6:.3g} µm"))
    for approach, cause in asked:
        check_half_space(
            hertz.semi_axes(approach),
            case.body.across,
            groove_radius=groove,
            raceway_radius=raceway_radius(case),
            groove_width=case.body.groove_width,
            cause=cause,
        )
