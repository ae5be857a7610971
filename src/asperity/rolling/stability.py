"""Whether a time step is stable with the contact, and what keeps it so.

For a force that is linear over each step the bodies move exactly. A force that alternates from step to step
meets their *alternating compliance*: inertia makes it negative, −h²/12m for a free mass. As the poles of
bodies and contact interlace on the unit circle, the coupled step is stable while 1/K + (alternating
compliance) is positive, K being what the contact opposes to an alternating approach. Each body states its
own (`asperity.rolling.bodies`); those of both add up. Where a strong damper on a light body violates that,
the contact is softened by just this compliance in series: then the step is stable whatever K is. For a free
mass that is Newmark's method with β = 1/4 instead of 1/6.

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

from asperity.errors import CoarseSamplingWarning
from asperity.kernels.pointforce import Prepared, evaluate_all
from asperity.laws.base import SteppedLaw

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
RISE = 4.0
"""How much stiffer than at rest a law without an end may become: Hertz's does under 64 times the load."""


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
    """Contact force, N, that makes no sense any more, by the load and the largest force of the law, N."""
    return RUNAWAY * max(load, force)
