"""Squeal: whether what creeps on a rail is stable, by the roots of its linear equation over frequency.

Friction F_y on the wheel follows its sliding velocity w over the rail and the normal force N: δF_y = −β w +
κ δN. In line with the springs of the contact, and with A (2, 2) of `asperity.structures.lateral_rail`,
wheel and rail move by themselves where

    A_vv + iωβ (A_vv A_ll − A_vl²) − κ A_vl = 0,

e^{+iωt}. Creep that rises with the slip damps, β > 0; friction that falls has β < 0; κ couples vertical
into lateral motion. The loop is that of F. G. de Beer, M. H. A. Janssens and P. P. Kooijman, J. Sound Vib.
267 (2003) 497; its roots are found instead of its gain, each with a frequency and a growth rate.
"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from asperity.arguments import Complex, Indices
from asperity.structures.lateral_rail import at_springs
from asperity.structures.wheel_modes import WheelModes

BEGIN, STEP, WIDEST, CLOSE, LEAST, MOST = 1e-5, 1e-7, 0.03, 1e-11, 0.5, 80
"""Shares of a frequency: first distance of a root from its pole, step of the slope, longest step, error of a
root, and least real part of one that rings; most iterations."""
FREE_OF_AXLE = 2
"""Nodal diameters from which on a mode leaves the axle at rest: those that squeal. A wheel that is held at
its seat says little of the others, which move and bend the axle, and are damped by it."""


@dataclass(frozen=True)
class CreepingContact:
    """A contact that creeps, linear about its state.

    Parameters
    ----------
    normal, tangential : float
        k_N, and k_T in stick, N/m.
    damping : float
        β = −∂F_y/∂η/V, N s/m, of a creepage η at a rolling speed V.
    coupling : float
        κ = ∂F_y/∂N.
    """

    normal: float
    tangential: float
    damping: float
    coupling: float

    def equation(self, receptances: Complex, omega: Complex) -> Complex:
        """What is zero where wheel and rail move by themselves (n,), m/N."""
        (vv, vl), (_, ll) = at_springs(receptances, self.normal, self.tangential)
        return vv + 1j * omega * self.damping * (vv * ll - vl**2) - self.coupling * vl

    def force_ratio(self, receptances: Complex) -> Complex:
        """Normal over lateral force of such a motion (n,)."""
        answer = at_springs(receptances, self.normal, self.tangential)
        return -answer[0, 1] / answer[0, 0]

    def roots(self, receptances: Callable[[Complex], Complex], poles: Complex) -> Complex:
        """Angular frequencies (p,), rad/s, at which wheel and rail move by themselves, one near each pole.

        Those with a negative imaginary part grow. NaN where none was found.

        Parameters
        ----------
        receptances : callable
            Of wheel and rail together (2, 2, n), m/N, downwards and sideways, at frequencies (n,), rad/s.
        poles : ndarray (p,) of complex
            Of the wheel's modes, rad/s, with positive real parts.

        Notes
        -----
        O. Aberth, Math. Comput. 27 (1973) 339: Newton's method on the equation times all (ω − pole), over all
        (ω − root) of the other roots, so that no root is found twice.
        """
        at = poles * (1.0 + BEGIN * np.exp(1j * np.arange(len(poles))))
        own = np.eye(len(poles), dtype=bool)
        moved = np.ones(len(poles), dtype=bool)
        for _ in range(MOST):
            if not moved.any():
                break
            here = at[moved]
            ends = np.concatenate([here * (1.0 - STEP), here * (1.0 + STEP)])
            low, high = self.equation(receptances(ends), ends).reshape(2, -1)
            slope = (high - low) / (high + low) / (STEP * here)
            apart = np.where(own[moved], np.inf, here[:, None] - at)
            slope += np.sum(1.0 / (here[:, None] - poles) + 1.0 / (here[:, None] + poles.conj()), axis=1)
            slope -= np.sum(1.0 / apart + 1.0 / (here[:, None] + at.conj()), axis=1)
            change = 1.0 / slope
            change *= np.minimum(1.0, WIDEST * np.abs(here) / np.abs(change))
            at[moved] = here - change
            moved[moved] = np.abs(change) > CLOSE * np.abs(here)
        return np.where(moved | (at.real < LEAST * np.abs(at)), complex(np.nan, np.nan), at)


def poles_of(modes: WheelModes) -> Complex:
    """Angular frequencies (p,), rad/s, at which the modes of a wheel ring by themselves; they decay."""
    ratio = modes.damping_ratios
    return 2.0 * np.pi * modes.natural_frequencies * (np.sqrt(1.0 - ratio**2) + 1j * ratio)


def standing_modes(modes: WheelModes) -> Indices:
    """Number (p,) of the mode at rest that each mode of a turning wheel belongs to, from 1.

    With nodal diameters it is two waves, one behind the other (`WheelModes.turning`).
    """
    waves = modes.nodal_diameters > 0
    second = np.zeros(len(modes.nodal_diameters), dtype=bool)
    for n in range(1, len(waves)):
        second[n] = waves[n] and waves[n - 1] and not second[n - 1]
    return np.cumsum(~second)


def ringing_modes(modes: WheelModes, place: float, omega: Complex, forces: Complex) -> Indices:
    """Number (n,) of the mode of a wheel that holds most energy.

    In free motions of angular frequencies (n,), rad/s, with so much normal per lateral force (n,), at a place
    across the tread, m.
    """
    radial, axial = modes.at(place)
    poles = poles_of(modes)
    with np.errstate(divide="ignore", invalid="ignore"):  # at a pole its mode rings alone
        pushed = (np.multiply.outer(forces, radial) + axial) / (
            (omega[:, None] - poles) * (omega[:, None] + poles.conj())
        )
    return np.argmax(np.abs(pushed), axis=1)
