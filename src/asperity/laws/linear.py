"""`linear`: the contact linearised at its working point."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from asperity.laws.base import check_damping
from asperity.laws.spec import LawSpec, Look, Need, Role, Variant

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

    from asperity.kernels.pointforce import Prepared
    from asperity.laws.materials import Materials
    from asperity.reduction.texture import StateTexture


@dataclass(frozen=True, eq=False)
class Linear:
    """F = P + k (approach - s0 - h) + c times the approach rate, in contact or not; may pull.

    Parameters
    ----------
    force : float
        P at the working point, N.
    stiffness : float
        Tangent stiffness k at the working point, N/m.
    approach : float
        s0 at the working point, m.
    texture : StateTexture or None
        Texture that the force follows, filtered or not, m; None for a smooth path.
    damping : float
        c, N s/m.

    Raises
    ------
    InputError
        If the stiffness is not positive or the damping is negative.
    """

    force: float
    stiffness: float
    approach: float = 0.0
    texture: StateTexture | None = None
    damping: float = 0.0
    name: str = "linear"

    def __post_init__(self) -> None:
        from asperity.reduction.stiffness import ForceCurve

        check_damping(self.damping)
        ForceCurve.linear(self.force, self.stiffness, self.approach)

    def prepare(self, positions: ArrayLike) -> Prepared:
        """Lay the law out on positions (n,) of the contact, m."""
        from asperity.laws.layout import on_curve
        from asperity.reduction.stiffness import ForceCurve

        return on_curve(
            ForceCurve.linear(self.force, self.stiffness, self.approach),
            self.texture,
            positions,
            damping=self.damping,
            damped_in_flight=True,
        )


def _build(materials: Materials) -> Linear:
    """Build the law from the materials of a case."""
    approach, stiffness = materials.working_point
    # one state: a texture that changed with it would not be linear
    return Linear(
        materials.load, stiffness, approach, materials.line_at_load, materials.damping, materials.name
    )


LAW = LawSpec(
    "linear",
    "The contact linearised at its working point; it never lets go.",
    _build,
    may_pull=True,
    role=Role.BARE,
    look=Look("#96700a", (0, (3, 1.5)), "X"),
    variants=(
        Variant(
            "filtered",
            "Here with the filtered line texture.",
            frozenset({Need.FILTER}),
            Role.PRACTICE,
            Look("#6b3e12", (0, (8, 1.5, 1, 1.5)), "p"),
        ),
    ),
)
