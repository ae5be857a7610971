"""What a contact law is once it is built: two protocols, and how one is built from materials."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import fields
from typing import TYPE_CHECKING, Any, Protocol, TypeGuard, runtime_checkable

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

    from asperity.kernels.pointforce import Prepared
    from asperity.laws.materials import Materials


@runtime_checkable
class SteppedLaw(Protocol):
    """A law on a path that is evaluated from Python, one solution of the contact at a time."""

    def evaluate(self, step: int, approach: float) -> tuple[float, float]:
        """Elastic force, N, and dF/d(approach), N/m, at a step of the path."""

    def accept(self, step: int) -> None:
        """Keep the last evaluation of this step as the start of the next."""

    def state(self) -> dict[str, NDArray[Any]]:
        """What `restore` needs to go on from here exactly."""

    def restore(self, state: dict[str, NDArray[Any]]) -> None:
        """Go on from a saved state."""

    def warn_of_flaws(self) -> None:
        """Warn of evaluations that went wrong on the way."""


class SettlingLaw(SteppedLaw, Protocol):
    """A stepped law that finds its force together with what the bodies yield to it."""

    def settle(self, step: int, approach: float, compliance: float) -> float:
        """Elastic force F, N, at `approach` − `compliance` F: approach without force, m, compliance, m/N."""


def settles(law: object) -> TypeGuard[SettlingLaw]:
    """Whether a law is a `SettlingLaw`; asked in every step, where `isinstance` would take half as long."""
    return hasattr(law, "settle")


@runtime_checkable
class Law(Protocol):
    """A contact law: contact force from approach, approach rate and position on the path."""

    @property
    def name(self) -> str:
        """Name in the registry and in results."""

    @property
    def damping(self) -> float:
        """Contact damping, N s/m."""

    def prepare(self, positions: ArrayLike) -> Prepared | SteppedLaw:
        """Lay the law out on the positions (n,) of the contact, m."""


def from_materials(law: Callable[..., Law], **materials: str) -> Callable[[Materials], Law]:
    """Builder of a law: its fields are the materials of the same names, or of those that are named.

    Parameters
    ----------
    law : type
        A frozen dataclass, as `Shifted`.
    **materials : str
        Of fields that are called otherwise, as ``texture="line"``: their materials.

    Returns
    -------
    callable
        What `LawSpec` takes as its ``build``.
    """

    def build(of_case: Materials) -> Law:
        named = {each.name: materials.get(each.name, each.name) for each in fields(law)}  # type: ignore[arg-type]
        return law(**{field: getattr(of_case, material) for field, material in named.items()})

    return build
