"""`areal`: the force follows the texture averaged over the contact area."""

from __future__ import annotations

from dataclasses import dataclass

from numpy.typing import ArrayLike

from asperity.kernels.pointforce import Prepared
from asperity.laws.base import check_damping, on_curve
from asperity.reduction.stiffness import ForceCurve
from asperity.reduction.texture import StateTexture


@dataclass(frozen=True, eq=False)
class Areal:
    """F = f(approach - h_a(approach)), plus c times the approach rate in contact; never pulls.

    h_a is the areal texture: the heights convolved with the flat-punch pressure on the ellipse of
    the Hertzian semi-axes at the mean force of the state.

    Parameters
    ----------
    curve : ForceCurve
        f(approach), the ensemble mean of the scanned samples.
    texture : StateTexture
        Areal texture h_a, m, positive away from contact.
    damping : float
        c, N s/m.
    plane : StateTexture, optional
        Plane that the patch feels under the working load, m: states count from it, so that waves longer
        than the patch do not change its size.

    Raises
    ------
    InputError
        If the damping is negative.
    """

    curve: ForceCurve
    texture: StateTexture
    damping: float = 0.0
    plane: StateTexture | None = None
    name: str = "areal"

    def __post_init__(self) -> None:
        check_damping(self.damping)

    def prepare(self, positions: ArrayLike) -> Prepared:
        """Lay the law out on positions (n,) of the contact, m."""
        return on_curve(self.curve, self.texture, positions, damping=self.damping, plane=self.plane)
