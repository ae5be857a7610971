"""`hertz`: smooth bodies, K s^1.5."""

from __future__ import annotations

from dataclasses import dataclass

from numpy.typing import ArrayLike

from asperity.kernels.pointforce import Prepared
from asperity.laws.base import check_damping, on_curve
from asperity.reduction.stiffness import ForceCurve
from asperity.reduction.texture import StateTexture


@dataclass(frozen=True, eq=False)
class Hertz:
    """F = K (approach - h)^1.5, plus c times the approach rate in contact; never pulls.

    Parameters
    ----------
    stiffness : float
        Hertz constant K, N/m^1.5.
    texture : StateTexture or None
        Texture that the force follows, filtered or not, m; None for a smooth path.
    damping : float
        c, N s/m.

    Raises
    ------
    InputError
        If the constant is not positive or the damping is negative.
    """

    stiffness: float
    texture: StateTexture | None = None
    damping: float = 0.0
    name: str = "hertz"

    def __post_init__(self) -> None:
        check_damping(self.damping)
        ForceCurve.hertz(self.stiffness)

    def prepare(self, positions: ArrayLike) -> Prepared:
        """Lay the law out on positions (n,) of the contact, m."""
        return on_curve(ForceCurve.hertz(self.stiffness), self.texture, positions, damping=self.damping)
