"""Whether a time step is stable with the contact, and what keeps it so.

For a force that is linear over each step the bodies move exactly. A force that alternates from step to step
meets their *alternating compliance*: inertia makes it negative, −h²/12m for a free mass. As the poles of
bodies and contact interlace on the unit circle, the coupled step is stable while 1/K + (alternating
compliance) is positive, K being what the contact opposes to an alternating approach. Where a strong damper
on a light body violates that, the contact is softened by just this compliance in series: then the step is
stable whatever K is. For a free mass that is Newmark's method with β = 1/4 instead of 1/6.

A contact that opens and closes asks for more. A free mass m under forces that are linear over steps h meets
them as impulses hF between which it flies: with x + h²F/6m for its place x it moves by the leapfrog, on the
stiffness k = 1/(1/K + h²/6m). Over an impact the leapfrog keeps v² − (k/m)|ab|, with a and b the places at
the ends of the step in which the contact closes, or opens; |ab| is v²h²/4 at most. An impact may therefore
return more energy than it receives, by a factor up to 1/(1 − kh²/4m): without bound where the step is barely
stable, by 2 for kh² = 2m. A contact softened by h²/3m, four times the above, is never stiffer than that; a
rigid one then returns what it receives.
"""

from __future__ import annotations

import warnings

import numpy as np
from numpy.typing import NDArray

from asperity.errors import CoarseSamplingWarning
from asperity.kernels.modal import modal_coefficients
from asperity.kernels.pointforce import Prepared, evaluate_all
from asperity.laws.base import SteppedLaw
from asperity.structures.moving_kernel import MovingKernel
from asperity.structures.wheel import Wheel

MARGIN = 0.5
"""Share of the bound up to which a step is taken as it is."""
RETURNED = 0.25
"""Share of the bound up to which an impact on the contact as it is returns twice its energy at most."""
RIGID = 4.0
"""Times the compliance that keeps a step stable: with it an impact on a rigid contact returns its energy."""
RESOLVED = 0.9 * np.pi
"""Angle by which a mode may turn in a step to be followed."""
NEGLIGIBLE = 0.01
"""Share of the contact's compliance that may be added without a word."""
RUNAWAY = 1e4
"""Times the load, or the largest force that the law was made for, that no contact force reaches."""
PLACES = 256
"""Positions at which mode shapes are looked at."""
RISE = 4.0
"""How much stiffer than at rest a law without an end may become: Hertz's does under 64 times the load."""


def beam_step(natural: NDArray, damping_ratio: NDArray, time_step: float) -> NDArray:
    """Exact step of a beam's modes, as `asperity.kernels.modal.modal_coefficients` has it.

    Parameters
    ----------
    natural : ndarray (modes,)
        Natural angular frequencies, rad/s.
    damping_ratio : ndarray (modes,)
        Damping ratios.
    time_step : float
        s.

    Returns
    -------
    ndarray (8, modes)
        Of modes that turn by more than RESOLVED in a step only the static answer to the force at its end:
        sampled, they would seem slow, and move the wrong way.
    """
    coefficients = modal_coefficients(natural, damping_ratio, time_step)
    damped = natural * np.sqrt(np.maximum(1.0 - damping_ratio**2, 0.0))
    fast = damped * time_step > RESOLVED
    coefficients[:, fast] = 0.0
    coefficients[3, fast] = 1.0 / natural[fast] ** 2
    return coefficients


def modes_and_ball(coefficients: NDArray, shapes: NDArray, mass: float, time_step: float) -> float:
    """Least alternating compliance of a beam and a ball.

    Parameters
    ----------
    coefficients : ndarray (8, modes)
        From `asperity.kernels.modal.modal_coefficients`.
    shapes : ndarray (places, modes)
        Mode shapes under the contact, kg^-1/2.
    mass : float
        Of the ball, kg.
    time_step : float
        s.

    Returns
    -------
    float
        m/N.
    """
    a = coefficients
    # q and q' change their sign from step to step, as the force does
    determinant = (1.0 + a[0]) * (1.0 + a[5]) - a[1] * a[4]
    each = ((a[3] - a[2]) * (1.0 + a[5]) - a[1] * (a[7] - a[6])) / determinant
    return float((shapes**2 @ each).min()) - time_step**2 / (12.0 * mass)


def rail_and_wheel(kernel: MovingKernel, wheel: Wheel) -> float:
    """Least alternating compliance of a rail and a wheel.

    Parameters
    ----------
    kernel : MovingKernel
        Of the rail, for a time step.
    wheel : Wheel
        Its mass and resonances.

    Returns
    -------
    float
        m/N.
    """
    signs = (-1.0) ** np.arange(kernel.weights.shape[1])
    step = kernel.time_step
    decay, before, now = wheel_step(wheel, step)
    flexible = 2.0 * float(np.sum((now - before) / (1.0 + decay)).real)
    return float((kernel.weights @ signs).min()) + flexible - step**2 / (12.0 * wheel.mass)


def wheel_step(wheel: Wheel, time_step: float) -> tuple[NDArray, NDArray, NDArray]:
    """Exact step of a wheel's resonances for a force that is linear over it: q' = s q + r F.

    Parameters
    ----------
    wheel : Wheel
        Its poles s and residues r.
    time_step : float
        s.

    Returns
    -------
    decay, before, now : ndarray of complex
        Factors of the states, and of the forces at start and end of the step, m/N; of fast ones as in
        `beam_step`.
    """
    phase = wheel.poles * time_step
    growth = np.expm1(phase)
    now = wheel.residues * (growth - phase) / (wheel.poles * phase)
    before = wheel.residues * growth / wheel.poles - now
    slow = np.abs(phase.imag) <= RESOLVED
    parts = np.exp(phase), before, np.where(slow, now, -wheel.residues / wheel.poles)
    decay, before, now = (part.astype(complex) for part in parts)
    return np.where(slow, decay, 0.0), np.where(slow, before, 0.0), now


def largest_stiffness(prepared: Prepared | SteppedLaw, at_rest: tuple[float, float]) -> tuple[float, float]:
    """Largest stiffness and force of a law within what it was made for.

    Parameters
    ----------
    prepared : Prepared or SteppedLaw
        The law on the path.
    at_rest : tuple of float
        Approach, m, and stiffness, N/m, under the load.

    Returns
    -------
    stiffness, force : float
        N/m, N; the force is zero where it is not known.
    """
    if not isinstance(prepared, Prepared):
        return RISE * at_rest[1], 0.0
    if not np.isfinite(prepared.upper):
        return (1.0 if prepared.exponent == 1.0 else RISE) * at_rest[1], 0.0
    height = prepared.values.max(axis=1) if not len(prepared.slopes) else 0.0
    force, stiffness = evaluate_all(prepared, prepared.planes + height + prepared.upper)
    return max(at_rest[1], float(stiffness.max())), float(force.max())


def softening(compliance: float, stiffness: float, damping: float, at_rest: float, time_step: float) -> float:
    """Compliance in series with the contact that keeps a time step stable.

    Parameters
    ----------
    compliance : float
        Least alternating compliance of the bodies, m/N.
    stiffness : float
        Largest stiffness of the contact, N/m.
    damping : float
        Of the contact, N s/m.
    at_rest : float
        Stiffness of the contact at rest, N/m.
    time_step : float
        s.

    Returns
    -------
    float
        m/N; zero if the step is stable as it is.

    Warns
    -----
    CoarseSamplingWarning
        If it is not, and the contact becomes softer by more than NEGLIGIBLE.
    """
    lacking = -compliance
    opposed = lacking * (stiffness + 4.0 * damping / time_step)
    impact = lacking * stiffness > RETURNED
    if opposed <= MARGIN and not impact:
        return 0.0
    softer = RIGID * lacking if impact else lacking
    if softer * at_rest < NEGLIGIBLE:
        return softer
    shorter = opposed / MARGIN if damping > 0.0 else 1.0
    enough = time_step / max(shorter, np.sqrt(lacking * stiffness / RETURNED))
    warnings.warn(
        f"the time step of {time_step:.2g} s is too long for a contact as stiff, or as damped, on bodies as "
        f"light: it is kept stable by softening the contact by {100 * softer * at_rest:.2g} %, "
        f"and motion near {0.5 / time_step:.2g} Hz is distorted; take at most {enough:.2g} s",
        CoarseSamplingWarning,
        stacklevel=3,
    )
    return softer


def largest_force(load: float, force: float) -> float:
    """Contact force that makes no sense any more.

    Parameters
    ----------
    load : float
        Static load, N.
    force : float
        Largest force that the law was made for, N.

    Returns
    -------
    float
        N.
    """
    return RUNAWAY * max(load, force)
