"""`linear`: the contact linearised at its working point."""

from __future__ import annotations

from dataclasses import dataclass

from asperity.laws import spec


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
    """

    force: float
    stiffness: float
    approach: float = 0.0
    texture: spec.StateTexture | None = None
    damping: float = 0.0
    name: str = "linear"

    def prepare(self, positions: spec.ArrayLike) -> spec.Prepared:
        """Lay the law out on positions (n,) of the contact, m; refuse numbers out of range."""
        from asperity.laws.layout import on_curve
        from asperity.reduction.stiffness import ForceCurve

        curve = ForceCurve.linear(self.force, self.stiffness, self.approach)
        return on_curve(curve, self.texture, positions, damping=self.damping, damped_in_flight=True)


def _build(materials: spec.Materials) -> Linear:
    """Build the law from the materials of a case."""
    approach, stiffness = materials.working_point
    # one state: a texture that changed with it would not be linear
    of_case = materials.line_at_load, materials.damping, materials.name
    return Linear(materials.load, stiffness, approach, *of_case)


FILTERED = spec.Variant(
    "filtered",
    "Here with the filtered line texture.",
    {spec.Need.FILTER},
    spec.Role.PRACTICE,
    spec.Look("#6b3e12", (0, (8, 1.5, 1, 1.5)), "p"),
)
LAW = spec.LawSpec(
    "linear",
    "The contact linearised at its working point; it never lets go.",
    _build,
    may_pull=True,
    role=spec.Role.BARE,
    look=spec.Look("#96700a", (0, (3, 1.5)), "X"),
    variants=(FILTERED,),
)
