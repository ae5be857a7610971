"""What is rolled over and what rolls: what a structure must offer to be rolled in time.

The contact force F, N, compression positive, pushes the two bodies apart. Each answers at the contact with a
displacement u, m, positive *the way the force pushes it*: downwards for what is rolled over, upwards for what
rolls. With u of the one and w of the other the approach of the mean surfaces is δ = −(u + w), and the law
says F(δ). As both count along their own force, the same structure can stand on either side.

From step n−1 to step n, the time step h later, F goes linearly from F₋ to F. A linear structure then is at

    u_n = ũ_n + α_n F,

where ũ_n, the *free* displacement, follows from its state and F₋ alone (the force falls to zero within the
step), and α_n > 0, the *direct compliance*, m/N, is what one newton at the end of the step displaces at once.
For a free mass m under a load P that acts against F, for instance,

    ũ_n = u_(n−1) + h u̇_(n−1) + h²/m (F₋/3 − P/2),    α = h²/6m.

Both bodies and the law leave one scalar equation, F = F(−ũ − w̃ − (α_u + α_w) F), which
`asperity.rolling.pair` solves in each step.

A structure is a frozen description, as `RolledOver` or `Rolls`; laid on a path it becomes a `Side` of the
contact, which has a state. One file holds both; `asperity.rolling.ball` is the shortest.
"""

from __future__ import annotations

from typing import Any, Protocol

from numpy.typing import NDArray

from asperity.rolling.path import Path


class Side(Protocol):
    """One body while the contact passes: its state of motion, advanced step by step.

    For each step `free` is asked first, with the force at its start, then `complete` is called once with the
    same. Digits may depend on the step and the state only, not on where a run was taken up.
    """

    @property
    def displacement(self) -> float:
        """At the contact, now, m, along the force."""
        ...

    @property
    def velocity(self) -> float:
        """Rate of that displacement as the contact moves on, now, m/s."""
        ...

    def free(self, step: int, before: float) -> float:
        """Displacement at the end of a step while the force falls from `before`, N, to zero over it, m."""
        ...

    def compliance(self, step: int) -> float:
        """Displacement at the end of a step for each newton that is reached there, m/N."""
        ...

    def complete(self, step: int, before: float, force: float) -> None:
        """Advance to the end of a step, over which the force goes linearly from `before` to `force`, N."""
        ...

    def state(self) -> dict[str, NDArray[Any]]:
        """Copies of all that `restore` needs to go on from here exactly."""
        ...

    def restore(self, state: dict[str, NDArray[Any]]) -> None:
        """Go on from a saved state."""
        ...


class RolledOver(Protocol):
    """What is rolled over."""

    def laid(self, path: Path, load: float) -> Side:
        """Let it carry a load, N, at the start of the path, at rest or as under a load that has long rolled.

        Refused are a path that leaves it, and one of another speed or time step than it was made for.
        """
        ...

    def alternating_compliance(self, path: Path) -> float:
        """Least displacement under a force that alternates between +1 N and −1 N from step to step, m/N.

        Negative where inertia governs; of a spring, its compliance. `asperity.rolling.stability` needs it.
        """
        ...


class Rolls(Protocol):
    """What rolls: it is pressed on the other body by a constant load."""

    @property
    def load(self) -> float:
        """Static contact force, N."""
        ...

    def placed(self, path: Path, displacement: float, velocity: float) -> Side:
        """Place it under its load with a displacement, m, and velocity, m/s, at the contact, else at rest."""
        ...

    def alternating_compliance(self, path: Path) -> float:
        """As of `RolledOver`."""
        ...
