"""Creepage of a ball that rolls in a groove: by the groove's form across (Heathcote), and by spin."""

import math

import numpy as np

from asperity.arguments import Array, ArrayLike
from asperity.quadrature import gauss

PURE_ROLLING = 2.0 * math.sin(math.pi / 18.0)
"""Place across where a ball in a groove rolls purely, over the half axis: 0.347.

Where all else slips and no force drives the ball, the load between both lines is half of the whole:
t − t³/3 = 1/3. K. L. Johnson, Contact Mechanics (1985), section 8.5, prints 0.35.
"""
RADII, ANGLES = 24, 96
"""Places in a contact over which sliding is summed, along a radius of the ellipse and around it."""
CHORD = 48
"""Places on a chord of the contact along the path over which it is summed."""


def contact_curvature(ball_radius: float, groove_radius: float) -> float:
    """Curvature across of the surface that a ball and its groove share, 1/m: the mean of both.

    T. A. Harris and M. N. Kotzalas, Advanced Concepts of Bearing Technology (2007): R = 2 r D/(2 r + D).
    """
    return 0.5 * (1.0 / ball_radius + 1.0 / groove_radius)


def conformal_creepage(across: ArrayLike, half_axis: ArrayLike, curvature: float, along: float) -> Array:
    """Creepage of a ball by the form of its groove, at places across a contact.

    Parameters
    ----------
    across : array_like (...)
        Places y from the middle of the contact, m.
    half_axis : array_like (...)
        Half axis a of the contact across, m.
    curvature : float
        Of the surface that both share across, 1/m, see `contact_curvature`.
    along : float
        Relative radius R_x of ball and raceway along, m: 1/R_x = 1/R ± 1/R_r.

    Returns
    -------
    ndarray (...)
        Velocity of the ball less that of the raceway over that of rolling, ξ = (y₀² − y²) κ/2R_x, with the
        lines of pure rolling at y₀ = `PURE_ROLLING` a: the middle of a ball runs ahead, its sides lag.
    """
    y, a = np.broadcast_arrays(np.asarray(across, dtype=float), np.asarray(half_axis, dtype=float))
    return ((PURE_ROLLING * a) ** 2 - y**2) * curvature / (2.0 * along)


def spin_moment(load: ArrayLike, half_axes: tuple[ArrayLike, ArrayLike]) -> Array:
    """Moment of friction of a contact that spins about its normal, over the coefficient of friction, N m.

    Parameters
    ----------
    load : array_like (...)
        Q, N.
    half_axes : (array_like, array_like)
        Along and across (...), m.

    Returns
    -------
    ndarray (...)
        (3/8) Q a E, with the larger half axis a and the complete elliptic integral of the second kind E.
    """
    from scipy.special import ellipe

    b, a = np.sort(np.broadcast_arrays(*half_axes), axis=0)
    slender = 1.0 - (b / np.where(a > 0.0, a, 1.0)) ** 2
    return 0.375 * np.asarray(load, dtype=float) * a * ellipe(slender)


def sliding_speed(
    load: ArrayLike,
    half_axes: tuple[ArrayLike, ArrayLike],
    spin: ArrayLike,
    curvature: float,
    along: float,
) -> Array:
    """Pressure times sliding, summed over a contact that slips everywhere, over the speed of rolling, N.

    Times speed and coefficient of friction it is the most heat that friction can make in steady rolling: no
    traction does more work on a rigid slip, and what is elastic adds none over the contact.

    Parameters
    ----------
    load : array_like (...)
        N.
    half_axes : (array_like, array_like)
        Along and across (...), m.
    spin : array_like (...)
        Spin creepage, rad/m.
    curvature, along : float
        As in `conformal_creepage`.

    Returns
    -------
    ndarray (...)
        ∫ p |s| dA over Hertz's pressure p, with the creepage s = (ξ(y) − φ y, φ x).
    """
    Q, b, a, phi = np.broadcast_arrays(load, *half_axes, spin)
    depth, weights = gauss(RADII)  # sqrt(1 − ρ²), of which ρ dρ is linear
    around = 2.0 * np.pi * (np.arange(ANGLES) + 0.5) / ANGLES
    radius = np.sqrt(1.0 - depth**2)[:, None]
    x = b[..., None, None] * radius * np.cos(around)
    y = a[..., None, None] * radius * np.sin(around)
    slip = _slip((x, y), a[..., None, None], phi[..., None, None], curvature, along).mean(axis=-1)
    return 3.0 * Q * (slip @ (weights * depth**2))


def sliding_across(
    load: ArrayLike,
    half_axes: tuple[ArrayLike, ArrayLike],
    spin: ArrayLike,
    curvature: float,
    along: float,
    shares: ArrayLike,
) -> Array:
    """Pressure times sliding, summed along the path, at places across a contact that slips everywhere, N/m.

    Times Archard's coefficient over the hardness it is the depth that one passing of the contact wears.

    Parameters
    ----------
    load, half_axes, spin, curvature, along
        As of `sliding_speed`, whose sum over places across it is.
    shares : array_like (k,)
        Places across over the half axis, from -1 to 1.

    Returns
    -------
    ndarray (..., k)
        ∫ p |s| dx, zero at both ends; by Gauss and Chebyshev, whose weight is that of Hertz's pressure.
    """
    Q, b, a, phi = (each[..., None, None] for each in np.broadcast_arrays(load, *half_axes, spin))
    share = np.asarray(shares, dtype=float)[:, None]
    chord = 1.0 - share**2
    around = np.pi * np.arange(1, CHORD + 1) / (CHORD + 1)
    x = b * np.sqrt(chord) * np.cos(around)
    slip = _slip((x, a * share), a, phi, curvature, along)
    rise = 1.5 * (Q / a * chord)[..., 0]
    return rise * (slip @ np.sin(around) ** 2) / (CHORD + 1)


def _slip(place: tuple[Array, Array], half_axis: Array, spin: Array, curvature: float, along: float) -> Array:
    """Sliding over the speed of rolling |(ξ(y) − φ y, φ x)| at places x and y in a contact, m."""
    x, y = place
    lengthwise = conformal_creepage(y, half_axis, curvature, along) - spin * y
    return np.hypot(lengthwise, spin * x)
