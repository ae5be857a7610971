"""`printed`: the thesis' force as printed, Eqs. 2.1 and 2.2."""

from __future__ import annotations

from dataclasses import dataclass

from asperity.laws import spec


@dataclass(frozen=True, eq=False)
class Printed:
    """F = k_c(r) (r - h(r)) + c dr/dt while r > h; F = c dr/dt otherwise (thesis Eqs. 2.1, 2.2).

    The secant stiffness multiplies the texture while the approach sees the tangent: under a
    constant load the body follows only 1/(1+n) of a slow bump when k_c ~ r^n. States count from the mean
    plane: on waves of several approaches the filter is read where the contact is not. The damper goes on
    acting in flight.

    Parameters
    ----------
    curve : ForceCurve
        f(approach); k_c(r) = f/r.
    texture : StateTexture or None
        Filtered line texture h, m, positive away from contact.
    datum : float
        d0 of r = approach + d0, m; at least minus the first touch of the curve, so that r > 0 in contact.
    damping : float
        c, N s/m.
    """

    curve: spec.ForceCurve
    texture: spec.StateTexture | None
    datum: float
    damping: float = 0.0
    name: str = "printed"

    def prepare(self, positions: spec.ArrayLike) -> spec.Prepared:
        """Lay the law out on positions (n,) of the contact, m."""
        from asperity.laws.layout import on_curve

        following = self.curve, self.texture, positions
        return on_curve(*following, datum=self.datum, damping=self.damping, damped_in_flight=True)


UNFILTERED = spec.Variant(
    "unfiltered",
    "Here without the filter.",
    {spec.Need.SAMPLES, spec.Need.DATUM},
    look=spec.Look("#6750b8", (0, (6, 1.5, 1.5, 1.5, 1.5, 1.5)), ">"),
)
LAW = spec.LawSpec(
    "printed",
    "The thesis as printed: states from the mean plane, secant stiffness times the filtered line texture.",
    spec.from_materials(Printed, texture="line"),
    {spec.Need.SAMPLES, spec.Need.DATUM, spec.Need.FILTER},
    normalise="low-wavenumber",
    look=spec.Look("#a8458f", (0, (6, 1.5, 1.5, 1.5)), "^"),
    variants=(UNFILTERED,),
)
