"""`areal`: the force follows the texture averaged over the contact area."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from asperity.laws import base, spec

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

    from asperity.kernels.pointforce import Prepared
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
    """

    curve: ForceCurve
    texture: StateTexture
    damping: float = 0.0
    plane: StateTexture | None = None
    name: str = "areal"

    def prepare(self, positions: ArrayLike) -> Prepared:
        """Lay the law out on positions (n,) of the contact, m; refuse a damping that is negative."""
        from asperity.laws.layout import on_curve

        return on_curve(self.curve, self.texture, positions, damping=self.damping, plane=self.plane)


LAW = spec.LawSpec(
    "areal",
    "Force on the texture averaged over the contact by the flat-punch weight.",
    base.from_materials(Areal, texture="areal"),
    {spec.Need.SAMPLES, spec.Need.AREAL},
    look=spec.Look("#0067a5", "-", "o"),
)
