"""`hertz`: smooth bodies, K s^1.5."""

from __future__ import annotations

from dataclasses import dataclass

from asperity.laws import spec


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
    """

    stiffness: float
    texture: spec.StateTexture | None = None
    damping: float = 0.0
    name: str = "hertz"
    plane: spec.StateTexture | None = None

    def prepare(self, positions: spec.ArrayLike) -> spec.Prepared:
        """Lay the law out on positions (n,) of the contact, m; refuse numbers out of range."""
        from asperity.laws.layout import on_curve
        from asperity.reduction.stiffness import ForceCurve

        curve = ForceCurve.hertz(self.stiffness)
        return on_curve(curve, self.texture, positions, damping=self.damping, plane=self.plane)


def _build(materials: spec.Materials) -> HertzLaw:
    """Build the law from the materials of a case; a filter is read by force, as rough contact is softer."""
    from asperity.reduction.stiffness import ForceCurve

    line = materials.line_on(ForceCurve.hertz(materials.hertz_constant))
    of_case = materials.damping, materials.name, materials.line_at_load
    return HertzLaw(materials.hertz_constant, line, *of_case)


FILTERED = spec.Variant(
    "filtered",
    "Here with the filtered line texture.",
    {spec.Need.FILTER},
    look=spec.Look("#2c3e91", (0, (1.5, 1.5, 4, 1.5)), "*"),
)
LAW = spec.LawSpec(
    "hertz",
    "Smooth bodies: Hertzian contact.",
    _build,
    look=spec.Look("#2a93c4", (0, (1.5, 1.5)), "P"),
    variants=(FILTERED,),
)
