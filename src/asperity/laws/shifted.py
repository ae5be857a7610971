"""`shifted`: the same state functions, kinematically consistent."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from asperity.laws.base import check_damping
from asperity.laws.spec import LawSpec, Look, Need, Variant

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

    from asperity.kernels.pointforce import Prepared
    from asperity.laws.materials import Materials
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
    plane : StateTexture, optional
        Plane from which the states of the texture count, m, as in `Areal`; the mean plane by default.

    Raises
    ------
    InputError
        If the damping is negative.
    """

    curve: ForceCurve
    texture: StateTexture | None
    damping: float = 0.0
    name: str = "shifted"
    plane: StateTexture | None = None

    def __post_init__(self) -> None:
        check_damping(self.damping)

    def prepare(self, positions: ArrayLike) -> Prepared:
        """Lay the law out on positions (n,) of the contact, m."""
        from asperity.laws.layout import on_curve

        return on_curve(self.curve, self.texture, positions, damping=self.damping, plane=self.plane)


def _build(materials: Materials) -> Shifted:
    """Build the law from the materials of a case."""
    return Shifted(materials.curve, materials.line, materials.damping, materials.name, materials.line_at_load)


LAW = LawSpec(
    "shifted",
    "The state functions, shifted by the filtered line texture: follows slow bumps.",
    _build,
    frozenset({Need.SAMPLES, Need.FILTER}),
    look=Look("#c8500a", (0, (6, 1.5)), "s"),
    variants=(
        Variant(
            "unfiltered",
            "Here without the filter.",
            frozenset({Need.SAMPLES}),
            look=Look("#b01b3c", (0, (3, 1.5, 3, 1.5, 1, 1.5)), "d"),
        ),
    ),
)
