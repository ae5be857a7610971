"""The ball and the beam of a case."""

from __future__ import annotations

from asperity.contact import Hertz
from asperity.errors import InputError
from asperity.kinds.ball_on_beam.case import BallOnBeam
from asperity.reference.materials import contact_modulus
from asperity.scenarios.geometry import Geometry, geometry, parabola
from asperity.scenarios.scene import Scene
from asperity.scenes import schema
from asperity.structures.beam import Beam
from asperity.structures.body import Ball, Body

MODES_BEYOND = 4.0
"""Beam modes are kept up to this multiple of the highest frequency, where the case says nothing."""


def bodies_of(case: BallOnBeam) -> Scene:
    """Build ball and beam of a case; a beam without natural frequency in the range is refused."""
    beam = Beam.rectangular(
        case.beam.length,
        case.beam.width,
        case.beam.height,
        case.beam.material,
        support=case.beam.support,
        loss_factor=case.beam.loss_factor,
        highest_frequency=highest_mode(case),
        suspension_frequency=case.beam.suspension_frequency,
    )
    ball, of, over = ball_of(case), case.ball.material.name, case.beam.material.name
    article = "an" if over[0].lower() in "aeiou8" else "a"
    title = f"{of[0].upper()}{of[1:]} ball on {article} {over} beam"
    rolling = (Body.rigid(ball.mass, ball.static_load),)
    names = (schema.BEAM_DISPLACEMENT, schema.BALL_DISPLACEMENT)
    sensors = case.beam.sensor_positions
    degrees = {"ball": 1.0}
    return Scene(beam, rolling, title, sensors=sensors, degrees=degrees, displacements=names, like=case.kind)


def ball_of(case: BallOnBeam) -> Ball:
    """Build the ball of a case."""
    return Ball(case.ball.radius, case.ball.material, case.ball.load, case.ball.mass)


def highest_mode(case: BallOnBeam) -> float:
    """Frequency up to which beam modes are kept, Hz."""
    return case.beam.modes_up_to or MODES_BEYOND * case.numerics.highest_frequency


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
