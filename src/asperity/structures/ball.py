"""A rigid ball with its weight, or with a given load."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from asperity.errors import InputError
from asperity.reference.materials import Material

GRAVITY = 9.80665  # m/s^2, standard acceleration of free fall, CGPM 1901


@dataclass(frozen=True)
class Ball:
    """Rigid solid ball.

    Parameters
    ----------
    radius : float
        m.
    material : Material
        Gives the mass.
    load : float, optional
        Constant force that presses the ball down, N; its weight if not given.
    given_mass : float, optional
        Mass, kg, instead of that of a solid ball.

    Raises
    ------
    InputError
        If radius, load or mass is not a finite positive number.

    Examples
    --------
    >>> from asperity import Ball, material
    >>> ball = Ball(25e-3, material("steel"))
    >>> round(ball.mass, 3), round(ball.static_load, 2)  # kg, N
    (0.514, 5.04)
    """

    radius: float
    material: Material
    load: float | None = None
    given_mass: float | None = None

    def __post_init__(self) -> None:
        if not (np.isfinite(self.radius) and self.radius > 0.0):
            raise InputError("ball radius (m)", self.radius, "a finite positive number")
        if self.load is not None and not (np.isfinite(self.load) and self.load > 0.0):
            raise InputError("ball load (N)", self.load, "a finite positive number")
        if self.given_mass is not None and not (np.isfinite(self.given_mass) and self.given_mass > 0.0):
            raise InputError("ball mass (kg)", self.given_mass, "a finite positive number")

    @property
    def mass(self) -> float:
        """Mass, kg."""
        if self.given_mass is not None:
            return self.given_mass
        return 4.0 / 3.0 * np.pi * self.radius**3 * self.material.density

    @property
    def weight(self) -> float:
        """Weight under standard gravity, N."""
        return self.mass * GRAVITY

    @property
    def static_load(self) -> float:
        """The given load, or else the weight, N."""
        return self.weight if self.load is None else self.load
