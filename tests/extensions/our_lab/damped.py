"""A law with a key of its own: the areal law, with a damper in the contact besides."""

from asperity.laws import Areal, LawSpec, Look, Need
from asperity.parameters import Quantity, key


def build(materials):
    """The law of the materials of a case."""
    damping = materials.damping + materials.parameters["viscosity"]
    return Areal(materials.curve, materials.areal, damping, plane=materials.plane, name="damped")


LAW = LawSpec(
    "damped",
    "As areal, with a damper of its own.",
    build,
    needs={Need.SAMPLES, Need.AREAL},
    look=Look("#7f3b08", "-", "p"),
    parameters={"viscosity": key(Quantity("N s/m", at_least=0.0), "0 N s/m", "damper in the contact")},
)
