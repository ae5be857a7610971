"""The ball on the contact grid."""

from __future__ import annotations

from asperity.contact import Hertz
from asperity.kinds.ball_on_beam.bodies import ball_of
from asperity.kinds.ball_on_beam.case import BallOnBeam
from asperity.reference.materials import contact_modulus
from asperity.scenarios.geometry import Geometry, geometry, parabola


def geometry_of(case: BallOnBeam) -> Geometry:
    """Lay out the ball of a case on the contact grid, under its load.

    Parameters
    ----------
    case : BallOnBeam
        The case.

    Returns
    -------
    Geometry
        Shape of the ball.
    """
    modulus = contact_modulus(case.ball.material, case.beam.material)
    return ball_geometry(case, ball_of(case).static_load, modulus)


def ball_geometry(case: BallOnBeam, load: float, modulus: float) -> Geometry:
    """Lay out the ball of a case on the contact grid.

    Parameters
    ----------
    case : BallOnBeam
        The case.
    load : float
        Working load, N.
    modulus : float
        Contact modulus E*, Pa.

    Returns
    -------
    Geometry
        Shape of the ball.
    """
    radius, contact = case.ball.radius, case.contact
    hertz = Hertz(modulus, radius, radius)
    return geometry(contact, parabola(contact, radius), hertz, load, smallest_radius=radius, body="ball")
