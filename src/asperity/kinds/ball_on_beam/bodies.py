"""The ball and the beam of a case."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from asperity.contact import Hertz
from asperity.errors import InputError
from asperity.kinds.ball_on_beam.case import BallOnBeam
from asperity.reference.materials import contact_modulus
from asperity.scenarios.geometry import Geometry, geometry, parabola
from asperity.structures.beam import Beam
from asperity.structures.body import Ball
from asperity.structures.modal import driving_point

MODES_BEYOND = 4.0
"""Beam modes are kept up to this multiple of the highest frequency, where the case says nothing."""
PLACES = (0.3, 0.37, 0.45, 0.5, 0.6)
"""Places on the beam, in its lengths, over which a linear force is averaged: no mode has nodes at all."""


@dataclass(frozen=True, eq=False)
class Bodies:
    """What is rolled in a case."""

    ball: Ball
    beam: Beam


def bodies_of(case: BallOnBeam) -> Bodies:
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
    return Bodies(ball_of(case), beam)


def ball_of(case: BallOnBeam) -> Ball:
    """Build the ball of a case."""
    return Ball(case.ball.radius, case.ball.material, case.ball.load, case.ball.mass)


def highest_mode(case: BallOnBeam) -> float:
    """Frequency up to which beam modes are kept, Hz."""
    return case.beam.modes_up_to or MODES_BEYOND * case.numerics.highest_frequency


def square_transfer(bodies: Bodies, stiffness: float, frequency: NDArray[np.float64]) -> NDArray[np.float64]:
    """Mean square along the beam of the linear contact force per height of the texture (f,), (N/m)².

    The ball at rest at each of `PLACES`; stiffness of the contact, N/m; frequencies (f,), Hz.
    """
    places = bodies.beam.length * np.array(PLACES)
    return np.asarray(np.mean(np.abs(ball_transfer(bodies, stiffness, places, frequency)) ** 2, axis=0))


def ball_transfer(
    bodies: Bodies, stiffness: float, places: NDArray[np.float64], frequency: NDArray[np.float64]
) -> NDArray[np.complex128]:
    """Force of the linear contact per height of the texture (p, f), N/m, the ball at rest at places (p,), m.

    F/z = 1/(α_ball + 1/k + α_beam); stiffness k of the contact, N/m; frequencies (f,), Hz.
    """
    carried = 1.0 / stiffness - 1.0 / (bodies.ball.mass * (2.0 * np.pi * frequency) ** 2)
    found: NDArray[np.complex128] = 1.0 / (carried + driving_point(bodies.beam, frequency, places))
    return found


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
