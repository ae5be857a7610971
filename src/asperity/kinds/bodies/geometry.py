"""What rolls, on the contact grid: elliptic, in a groove, or on a raceway."""

from __future__ import annotations

import math

from asperity.kinds.bodies.bodies import bodies_of
from asperity.kinds.bodies.case import Bodies
from asperity.kinds.bodies.smooth import smooth_contact
from asperity.kinds.bodies.textures import loads_of
from asperity.scenarios.geometry import Geometry, geometry, parabola


def geometry_of(case: Bodies) -> Geometry:
    """Lay out what rolls on the contact grid, under the static load of its first contact."""
    load = float(loads_of(bodies_of(case).rolling)[0])
    return body_geometry(case, load)


def body_geometry(case: Bodies, load: float) -> Geometry:
    """Lay out what rolls on the contact grid, under a load, N."""
    hertz = smooth_contact(case)
    section = parabola(case.contact, hertz.radius_y)
    smallest = min(case.body.radius, case.body.across, *_hollows(case))
    shape = geometry(case.contact, section, hertz, load, smallest_radius=smallest, body="body")
    return shape.within_window()


def _hollows(case: Bodies) -> list[float]:
    """Radii of groove and raceway, which the contact must be small against as well, m."""
    radii = (case.body.groove_radius, case.body.raceway_radius)
    return [radius for radius in radii if radius is not None and math.isfinite(radius)]
