"""`printed`: the thesis' force as printed, Eqs. 2.1 and 2.2."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from asperity.errors import InputError
from asperity.laws.base import check_damping
from asperity.laws.spec import LawSpec, Look, Need, Variant

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

    from asperity.kernels.pointforce import Prepared
    from asperity.laws.materials import Materials
    from asperity.reduction.stiffness import ForceCurve
    from asperity.reduction.texture import StateTexture


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
        d0 of r = approach + d0, m; at least minus the first touch of the curve.
    damping : float
        c, N s/m.

    Raises
    ------
    InputError
        If the datum leaves r <= 0 in contact, or the damping is negative.
    """

    curve: ForceCurve
    texture: StateTexture | None
    datum: float
    damping: float = 0.0
    name: str = "printed"

    def __post_init__(self) -> None:
        check_damping(self.damping)
        lowest = -self.curve.first_touch
        if not self.datum >= lowest * (1.0 - 1e-9):
            remedy = "Take the highest first touch of all samples as the datum."
            raise InputError("datum of the state (m)", self.datum, f"at least {lowest:.6g}", remedy)

    def prepare(self, positions: ArrayLike) -> Prepared:
        """Lay the law out on positions (n,) of the contact, m."""
        from asperity.kernels.pointforce import SECANT
        from asperity.laws.layout import on_curve

        return on_curve(
            self.curve,
            self.texture,
            positions,
            form=SECANT,
            datum=self.datum,
            damping=self.damping,
            damped_in_flight=True,
        )


def _build(materials: Materials) -> Printed:
    """Build the law from the materials of a case."""
    return Printed(materials.curve, materials.line, materials.datum, materials.damping, materials.name)


LAW = LawSpec(
    "printed",
    "The thesis as printed: states from the mean plane, secant stiffness times the filtered line texture.",
    _build,
    frozenset({Need.SAMPLES, Need.DATUM, Need.FILTER}),
    normalise="low-wavenumber",
    look=Look("#a8458f", (0, (6, 1.5, 1.5, 1.5)), "^"),
    variants=(
        Variant(
            "unfiltered",
            "Here without the filter.",
            frozenset({Need.SAMPLES, Need.DATUM}),
            look=Look("#6750b8", (0, (6, 1.5, 1.5, 1.5, 1.5, 1.5)), ">"),
        ),
    ),
)
