"""Sideways stiffness of a contact that sticks."""

import numpy as np

from asperity.arguments import Array, positive
from asperity.reference.materials import Material

ANGLES = 1024
"""Of the trapezoidal rule around the contact, which is exact for ellipses up to 1:50."""


def stick_stiffness(semi_axes: tuple[float, float], materials: tuple[Material, Material]) -> float:
    """Lateral force per lateral approach of two bodies that stick all over an elliptic contact, N/m.

    Parameters
    ----------
    semi_axes : (float, float)
        Along and across the path, m: the force acts across it.
    materials : (Material, Material)
        Of both bodies.

    Returns
    -------
    float
        1/Σ c of the compliances c = ∫₀^2π R(θ) (1 − ν cos²θ) dθ/(8π G a b) of both bodies, with the radius
        R of the ellipse at an angle θ from the path.

    Raises
    ------
    InputError
        If a semi-axis is not positive.

    Notes
    -----
    R. D. Mindlin, J. Appl. Mech. 16 (1949) 259: the traction T/(2πab √(1 − x²/a² − y²/b²)) moves the contact
    as a whole; here by Cerruti's solution in its middle. Of two like bodies on a circle it is
    2(1 − ν)/(2 − ν) of the normal stiffness. Without slip at the edge, where the traction is infinite, and
    without what rolling lets creep: stiffer than a contact that rolls on, most at low frequency.
    """
    along, across = (positive("semi-axis of the contact (m)", each) for each in semi_axes)
    angle = 2.0 * np.pi * np.arange(ANGLES) / ANGLES
    radius: Array = 1.0 / np.hypot(np.cos(angle) / along, np.sin(angle) / across)
    compliance = 0.0
    for material in materials:
        shear = 0.5 * material.youngs_modulus / (1.0 + material.poisson_ratio)
        mean = np.mean(radius * (1.0 - material.poisson_ratio * np.cos(angle) ** 2))
        compliance += float(mean) / (4.0 * shear * along * across)
    return 1.0 / compliance
