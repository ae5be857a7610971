"""The moving point force: contact laws, one file and one line in the registry each.

What is known of a law before it is built is a `LawSpec`. Built from the materials of a case, a law is a
frozen description of the contact; ``law.prepare(positions)`` lays it out on the path, for the compiled
stepper (`asperity.kernels.pointforce.Prepared`) or for stepping from Python (`SteppedLaw`). Nothing here
imports compiled code before it is needed.
"""

from __future__ import annotations

from asperity.laws.areal import Areal
from asperity.laws.base import Law, SteppedLaw
from asperity.laws.direct import Direct
from asperity.laws.hertz import HertzLaw
from asperity.laws.linear import Linear
from asperity.laws.materials import Materials
from asperity.laws.printed import Printed
from asperity.laws.registry import (
    baselines,
    in_role,
    names,
    needs_of,
    reference,
    register,
    spec_of,
    unregister,
)
from asperity.laws.shifted import Shifted
from asperity.laws.spec import LawSpec, Look, Need, Role, Variant
from asperity.laws.table import Table

__all__ = [
    "Areal",
    "Direct",
    "HertzLaw",
    "Law",
    "LawSpec",
    "Linear",
    "Look",
    "Materials",
    "Need",
    "Printed",
    "Role",
    "Shifted",
    "SteppedLaw",
    "Table",
    "Variant",
    "baselines",
    "in_role",
    "names",
    "needs_of",
    "reference",
    "register",
    "spec_of",
    "unregister",
]
