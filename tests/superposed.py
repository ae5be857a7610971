"""A rail on supports, computed by hand: the rail that is free, supports, and their reactions superposed."""

import numpy as np
from scipy.linalg import toeplitz


def euler_free(rail, omega, foundation=0.0):
    """Receptance as printed in textbooks; a continuous foundation takes from the inertia."""
    bending = rail.bending_stiffness * (1.0 + 1j * rail.rail_loss_factor)
    k = ((rail.mass_per_length * omega**2 - foundation) / bending) ** 0.25
    return lambda x: -(1j * np.exp(-1j * k * np.abs(x)) + np.exp(-k * np.abs(x))) / (4.0 * bending * k**3)


def timoshenko_free(rail, omega, foundation=0.0):
    """Receptance from the conditions at the force: no rotation, shear force one half."""
    loss = 1.0 + 1j * rail.rail_loss_factor
    bending, shear = loss * rail.bending_stiffness, loss * rail.shear_stiffness
    mass, inertia = rail.mass_per_length * omega**2 - foundation, rail.rotary_inertia * omega**2
    # S(w'' - theta') + mass w = 0, B theta'' + S(w' - theta) + inertia theta = 0, with exp(p x)
    uncoupled = np.polymul([shear, 0.0, mass], [bending, 0.0, inertia - shear])
    roots = np.roots(np.polyadd(uncoupled, [shear**2, 0.0, 0.0]))
    p = roots[roots.real < 0.0]
    rotation = (shear * p**2 + mass) / (shear * p)  # theta/w
    amplitude = np.linalg.solve([rotation, shear * (p - rotation)], [0.0, -0.5])
    return lambda x: np.exp(np.multiply.outer(np.abs(x), p)) @ amplitude


def free_rail(rail, omega, foundation=0.0):
    free = euler_free if rail.shear_stiffness is None else timoshenko_free
    return free(rail, omega, foundation)


def supports_by_hand(rail, omega, pad_share=1.0, ballast_share=1.0):
    """K from the two equations of motion of sleeper and pad, whose shares have their damping scaled, too."""
    pad, ballast = (
        share
        * getattr(rail, f"{part}_stiffness")
        * (1.0 + 1j * (getattr(rail, f"{part}_loss_factor") or 0.0))
        + 1j * omega * share * (getattr(rail, f"{part}_damping") or 0.0)
        for part, share in (("pad", pad_share), ("ballast", ballast_share))
    )
    sleeper = pad / (pad + ballast - rail.sleeper_mass * omega**2)  # motion per motion of the rail
    return pad * (1.0 - sleeper)


def superposed(free, stiffness, at, pairs):
    """Receptances of a free rail at places per force at others, on supports (n,) at places (n,), m."""
    row = free(at - at[0])
    even = np.ptp(np.diff(at)) < 1e-9
    matrix = np.eye(len(at)) + (toeplitz(row, row) if even else free(at[:, None] - at)) * stiffness
    moved = np.linalg.solve(matrix, np.stack([free(at - x0) for _, x0 in pairs], axis=1))
    found = zip(pairs, moved.T, strict=True)
    return np.array([free(np.array(x - x0)) - free(x - at) @ (stiffness * each) for (x, x0), each in found])
