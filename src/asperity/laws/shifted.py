"""`shifted`: the same state functions, kinematically consistent."""

from __future__ import annotations

from dataclasses import dataclass

from asperity.laws import spec


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
    """

    curve: spec.ForceCurve
    texture: spec.StateTexture | None
    damping: float = 0.0
    name: str = "shifted"
    plane: spec.StateTexture | None = None

    def prepare(self, positions: spec.ArrayLike) -> spec.Prepared:
        """Lay the law out on positions (n,) of the contact, m."""
        from asperity.laws.layout import on_curve

        return on_curve(self.curve, self.texture, positions, damping=self.damping, plane=self.plane)


UNFILTERED = spec.Variant(
    "unfiltered",
    "Here without the filter.",
    {spec.Need.SAMPLES},
    look=spec.Look("#b01b3c", (0, (3, 1.5, 3, 1.5, 1, 1.5)), "d"),
)
LAW = spec.LawSpec(
    "shifted",
    "The state functions, shifted by the filtered line texture: follows slow bumps.",
    spec.from_materials(Shifted, texture="line", plane="line_at_load"),
    {spec.Need.SAMPLES, spec.Need.FILTER},
    look=spec.Look("#c8500a", (0, (6, 1.5)), "s"),
    variants=(UNFILTERED,),
)
