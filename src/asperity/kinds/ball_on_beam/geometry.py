"""The ball on the contact grid."""

from __future__ import annotations

from asperity.contact import Hertz
from asperity.errors import InputError
from asperity.kinds.ball_on_beam.bodies import ball_of
from asperity.kinds.ball_on_beam.case import BallOnBeam
from asperity.reference.materials import contact_modulus
from asperity.scenarios.geometry import Geometry, geometry, parabola


def geometry_of(case: BallOnBeam) -> Geometry:
    """Lay out the ball of a case on the contact grid, under its load."""
    modulus = contact_modulus(case.ball.material, case.beam.material)
    return ball_geometry(case, ball_of(case).static_load, modulus)


def ball_geometry(case: BallOnBeam, load: float, modulus: float) -> Geometry:
    """Lay out the ball of a case on the contact grid, under a load, N, with a contact modulus E*, Pa.

    Refused is a contact that is not small against the ball, wider than the beam's section, or not held by the
    window.
    """
    radius, contact = case.ball.radius, case.contact
    hertz = Hertz(modulus, radius, radius)
    shape = geometry(contact, parabola(contact, radius), hertz, load, smallest_radius=radius, body="ball")
    width = 2.0 * max(shape.semi_axes)
    for key, side in (("beam.width", case.beam.width), ("beam.height", case.beam.height)):
        if side < width:
            allowed = f"at least {width * 1e6:.3g} um, the width of the smooth contact under {load:.3g} N"
            remedy = "A beam smaller than its contact is no elastic half-space: enlarge it, or press less."
            raise InputError(key, f"{side * 1e6:.3g} um", allowed, remedy)
    return shape.within_window()
