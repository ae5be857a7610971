"""`shifted`: the same state functions, kinematically consistent."""

from __future__ import annotations

from dataclasses import dataclass

from numpy.typing import ArrayLike

from asperity.kernels.pointforce import Prepared
from asperity.laws.base import check_damping, on_curve
from asperity.reduction.stiffness import ForceCurve
from asperity.reduction.texture import StateTexture


@dataclass(frozen=True, eq=False)
class Shifted:
    """F = f(approach - h(approach)), plus c times the approach rate in contact; never pulls.

    Parameters
    ----------
    curve : ForceCurve
        f(approach), the ensemble mean of the scanned samples.
    texture : StateTexture or None
        Line texture after the contact filter, h, m, positive away from contact.
    damping : float
        c, N s/m.

    Raises
    ------
    InputError
        If the damping is negative.
    """

    curve: ForceCurve
    texture: StateTexture | None
    damping: float = 0.0
    name: str = "shifted"

    def __post_init__(self) -> None:
        check_damping(self.damping)

    def prepare(self, positions: ArrayLike) -> Prepared:
        """Lay the law out on positions (n,) of the contact, m."""
        return on_curve(self.curve, self.texture, positions, damping=self.damping)
