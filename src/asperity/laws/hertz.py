"""`hertz`: smooth bodies, K s^1.5."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from asperity.laws.base import check_damping
from asperity.laws.spec import LawSpec, Look, Need, Variant

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

    from asperity.kernels.pointforce import Prepared
    from asperity.laws.materials import Materials
    from asperity.reduction.texture import StateTexture


@dataclass(frozen=True, eq=False)
class HertzLaw:
    """F = K (approach - h)^1.5, plus c times the approach rate in contact; never pulls.

    Parameters
    ----------
    stiffness : float
        Hertz constant K, N/m^1.5.
    texture : StateTexture or None
        Texture that the force follows, filtered or not, m; None for a smooth path.
    damping : float
        c, N s/m.
    plane : StateTexture, optional
        Plane from which the states of the texture count, m, as in `Areal`; the mean plane by default.

    Raises
    ------
    InputError
        If the constant is not positive or the damping is negative.
    """

    stiffness: float
    texture: StateTexture | None = None
    damping: float = 0.0
    name: str = "hertz"
    plane: StateTexture | None = None

    def __post_init__(self) -> None:
        from asperity.reduction.stiffness import ForceCurve

        check_damping(self.damping)
        ForceCurve.hertz(self.stiffness)

    def prepare(self, positions: ArrayLike) -> Prepared:
        """Lay the law out on positions (n,) of the contact, m."""
        from asperity.laws.layout import on_curve
        from asperity.reduction.stiffness import ForceCurve

        curve = ForceCurve.hertz(self.stiffness)
        return on_curve(curve, self.texture, positions, damping=self.damping, plane=self.plane)


def _build(materials: Materials) -> HertzLaw:
    """Build the law from the materials of a case; a filter is read by force, as rough contact is softer."""
    from asperity.reduction.stiffness import ForceCurve

    constant = materials.hertz_constant
    line = materials.line_on(ForceCurve.hertz(constant))
    return HertzLaw(constant, line, materials.damping, materials.name, materials.line_at_load)


LAW = LawSpec(
    "hertz",
    "Smooth bodies: Hertzian contact.",
    _build,
    look=Look("#2a93c4", (0, (1.5, 1.5)), "P"),
    variants=(
        Variant(
            "filtered",
            "Here with the filtered line texture.",
            frozenset({Need.FILTER}),
            look=Look("#2c3e91", (0, (1.5, 1.5, 4, 1.5)), "*"),
        ),
    ),
)
