"""What a contact law is once it is built: two protocols."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any, Protocol, TypeGuard, runtime_checkable

from asperity.errors import InputError

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

    from asperity.kernels.pointforce import Prepared


@runtime_checkable
class SteppedLaw(Protocol):
    """A law on a path that is evaluated from Python, one solution of the contact at a time."""

    def evaluate(self, step: int, approach: float) -> tuple[float, float]:
        """Elastic force, N, and dF/d(approach), N/m, at a step of the path."""
        ...

    def accept(self, step: int) -> None:
        """Keep the last evaluation of this step as the start of the next."""
        ...

    def state(self) -> dict[str, NDArray[Any]]:
        """What `restore` needs to go on from here exactly."""
        ...

    def restore(self, state: dict[str, NDArray[Any]]) -> None:
        """Go on from a saved state."""
        ...

    def warn_of_flaws(self) -> None:
        """Warn of evaluations that went wrong on the way."""
        ...


class SettlingLaw(SteppedLaw, Protocol):
    """A stepped law that finds its force together with what the bodies yield to it."""

    def settle(self, step: int, approach: float, compliance: float) -> float:
        """Elastic force F, N, at `approach` − `compliance` F: approach without force, m, compliance, m/N."""
        ...


def settles(law: object) -> TypeGuard[SettlingLaw]:
    """Whether a law is a `SettlingLaw`; asked in every step, where `isinstance` would take half as long."""
    return hasattr(law, "settle")


@runtime_checkable
class Law(Protocol):
    """A contact law: contact force from approach, approach rate and position on the path."""

    @property
    def name(self) -> str:
        """Name in the registry and in results."""
        ...

    @property
    def damping(self) -> float:
        """Contact damping, N s/m."""
        ...

    def prepare(self, positions: ArrayLike) -> Prepared | SteppedLaw:
        """Lay the law out on the positions (n,) of the contact, m."""
        ...


def check_damping(damping: float) -> None:
    """Refuse a contact damping, N s/m, that is negative or not finite."""
    if not (math.isfinite(damping) and damping >= 0.0):
        raise InputError("contact damping (N s/m)", damping, "zero or a finite positive number")
