"""The moving point force: contact laws, one file each.

Every law is a frozen description of the contact; ``law.prepare(positions)`` lays it out on the
path, for the compiled stepper (`asperity.kernels.pointforce.Prepared`) or for stepping from
Python (`asperity.laws.base.SteppedLaw`).
"""

from __future__ import annotations

from typing import NamedTuple

from asperity.laws.areal import Areal
from asperity.laws.base import Law, Prepared, SteppedLaw, force
from asperity.laws.direct import Direct
from asperity.laws.hertz import Hertz
from asperity.laws.linear import Linear
from asperity.laws.printed import Printed
from asperity.laws.shifted import Shifted
from asperity.laws.table import Table


class Entry(NamedTuple):
    """A law in the registry: its class and what it means, in one sentence."""

    law: type
    meaning: str


LAWS: dict[str, Entry] = {
    "printed": Entry(Printed, "The thesis as printed: secant stiffness times the filtered line texture."),
    "shifted": Entry(
        Shifted, "The state functions, shifted by the filtered line texture: follows slow bumps."
    ),
    "areal": Entry(Areal, "Force on the texture averaged over the contact by the flat-punch weight."),
    "table": Entry(Table, "The scanned three-dimensional contact force, looked up."),
    "direct": Entry(Direct, "The three-dimensional contact, solved in every time step: the reference."),
    "hertz": Entry(Hertz, "Smooth bodies: Hertzian contact."),
    "linear": Entry(Linear, "The contact linearised at its working point; it never lets go."),
}

__all__ = [
    "LAWS",
    "Areal",
    "Direct",
    "Entry",
    "Hertz",
    "Law",
    "Linear",
    "Prepared",
    "Printed",
    "Shifted",
    "SteppedLaw",
    "Table",
    "force",
]
