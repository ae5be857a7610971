"""Whether a time step is stable with the contact, and what keeps it so.

For a force that is linear over each step the bodies move exactly. A force that alternates from step to step
meets their *alternating compliance*: inertia makes it negative, −h²/12m for a free mass. As the poles of
bodies and contact interlace on the unit circle, the coupled step is stable while 1/K + (alternating
compliance) is positive, K being what the contact opposes to an alternating approach. Each body states its
own; those of both add up. Where a strong damper on a light body violates that,
the contact is softened by this compliance in series, and a tenth more, since on the bound itself nothing
damps the alternation: then the step is stable whatever K is. For a free mass that is Newmark's method with
β = 0.258 instead of 1/6.

A contact that opens and closes asks for more. A free mass m under forces that are linear over steps h meets
them as impulses hF between which it flies: with x + h²F/6m for its place x it moves by the leapfrog, on the
stiffness k = 1/(1/K + h²/6m). Over an impact the leapfrog keeps v² − (k/m)|ab|, with a and b the places at
the ends of the step in which the contact closes, or opens; |ab| is v²h²/4 at most. An impact may therefore
return more energy than it receives, by a factor up to 1/(1 − kh²/4m): without bound where the step is barely
stable, by 2 for kh² = 2m. What makes a contact no stiffer than that is a compliance of h²/3m − 1/K, four
times the alternating one less that of the contact; a rigid contact then returns what it receives. Modes are
such masses; an endless rail carries impacts away.
"""

from __future__ import annotations

import warnings
from collections.abc import Iterable

import numpy as np

from asperity.arguments import Array
from asperity.errors import CoarseSamplingWarning
from asperity.kernels.pointforce import Prepared, evaluate_all
from asperity.laws.base import SteppedLaw

MARGIN = 0.5
"""Share of the bound up to which a step is taken as it is."""
STABLE = 1.1
"""Alternating compliances with which a step is stable on a rigid contact."""
ELASTIC = 4.0
"""Alternating compliances with which an impact on a rigid contact returns its energy."""
NEGLIGIBLE = 0.01
"""Share of the contact's compliance that may be added without a word."""
Limit = tuple[str, float, float]
"""What must be resolved: its name, its frequency, Hz, and the time steps in a period that it takes."""
RISE = 4.0
"""How much stiffer than at rest a contact may become: Hertz's does under 64 times the load."""


def largest_values(law: Prepared | SteppedLaw, at_rest: float) -> tuple[float, float, float]:
    """Largest stiffness, N/m, stiffness in impacts, N/m, and force, N, of a law within what it was made for.

    `at_rest` is the stiffness under the load, N/m. The stiffness in impacts is zero of a contact that never
    opens, the force where it is not known.
    """
    stiffness, force = at_rest, 0.0
    if not isinstance(law, Prepared):
        stiffness = RISE * at_rest
    elif np.isfinite(law.upper):
        height = law.values.max(axis=1) if not len(law.slopes) else 0.0
        forces, slopes, _ = evaluate_all(law, law.planes + height + law.upper, 0)
        stiffness, force = max(at_rest, float(slopes.max())), float(forces.max())
    opens = not (isinstance(law, Prepared) and law.bilateral)
    return stiffness, max(stiffness, RISE * at_rest) if opens else 0.0, force


def softening(
    alternating: Array,
    thrown: Array,
    stiffness: Array,
    impacts: Array,
    damping: Array,
    at_rest: Array,
    time_step: float,
) -> Array:
    """Compliances in series with contacts (n,), m/N, that keep a time step stable, s, and impacts elastic.

    Zero if they are so already. Least alternating compliances of both bodies, and of what throws them apart,
    m/N; the largest stiffness of the contacts, that of impacts, and that at rest, N/m; damping in N s/m. Of
    contacts that become softer by more than NEGLIGIBLE, the one that does most is warned of.
    """
    opposed = -alternating * (stiffness + 4.0 * damping / time_step) / MARGIN
    impact = ELASTIC * -thrown * impacts
    rigid = np.where(impact > 1.0, (impact - 1.0) / np.where(impacts > 0.0, impacts, 1.0), 0.0)
    softer = np.maximum(np.where(opposed > 1.0, STABLE * -alternating, 0.0), rigid)
    worst = int(np.argmax(softer * at_rest))
    share = float(softer[worst] * at_rest[worst])
    if share >= NEGLIGIBLE:
        stable = opposed if damping[worst] > 0.0 else np.sqrt(np.maximum(opposed, 0.0))
        shorter = max(stable[worst], np.sqrt(max(impact[worst], 0.0)))
        warnings.warn(
            f"the time step of {time_step:.2g} s is too long for a contact as stiff, or as damped, on bodies "
            f"as light: it is kept stable by softening the contact by {100 * share:.2g} %, and motion near "
            f"{0.5 / time_step:.2g} Hz is distorted; take at most {time_step / shorter:.2g} s",
            CoarseSamplingWarning,
            stacklevel=4,
        )
    return softer


def contact_resonance(stiffness: Array, direct: Array, alternating: Array, time_step: float) -> Array:
    """Natural frequencies, Hz, of bodies on contacts, N/m, from their two compliances in a time step, m/N.

    A mass m has α = h²/6m and β = −h²/12m, a spring of compliance c has α = β = c.
    """
    inverse_mass = np.maximum(4.0 * (direct - alternating), 0.0) / time_step**2
    compliance = np.maximum(direct + 2.0 * alternating, 0.0) / 3.0
    return np.asarray(np.sqrt(inverse_mass * stiffness / (1.0 + stiffness * compliance)) / (2.0 * np.pi))


def warn_if_coarse(time_step: float, limits: Iterable[Limit]) -> None:
    """Compare the time step with the periods that it must resolve."""
    for what, frequency, least in limits:
        if frequency * time_step * least > 1.0:
            warnings.warn(
                f"{what}, {frequency:.4g} Hz, has {1.0 / (frequency * time_step):.3g} time steps in a "
                f"period, fewer than {least:.0f}: its response is distorted; "
                f"take a time step of at most {1.0 / (least * frequency):.2g} s",
                CoarseSamplingWarning,
                stacklevel=4,
            )
