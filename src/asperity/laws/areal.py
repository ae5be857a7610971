"""`areal`: the force follows the texture averaged over the contact area."""

from dataclasses import dataclass

from asperity.laws import shifted, spec


@dataclass(frozen=True, eq=False)
class Areal(shifted.Shifted):
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

    name: str = "areal"


LAW = spec.LawSpec(
    "areal",
    "Force on the texture averaged over the contact by the flat-punch weight.",
    spec.from_materials(Areal, texture="areal"),
    {spec.Need.SAMPLES, spec.Need.AREAL},
    look=spec.Look("#0067a5", "-", "o"),
)
