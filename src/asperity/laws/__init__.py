"""The moving point force: contact laws, one file and one line in the registry each.

What is known of a law before it is built is a `LawSpec`. Built from the materials of a case, a law is a
frozen description of the contact; ``law.prepare(positions)`` lays it out on the path, for the compiled
stepper (`asperity.kernels.pointforce.Prepared`) or for stepping from Python (`SteppedLaw`). Nothing here
imports compiled code before it is needed.
"""

from asperity.laws.areal import Areal
from asperity.laws.direct import Direct
from asperity.laws.hertz import HertzLaw
from asperity.laws.linear import Linear
from asperity.laws.printed import Printed
from asperity.laws.registry import (
    baselines,
    family_of,
    in_role,
    law_keys,
    names,
    needs_of,
    reference,
    register,
    spec_of,
    unregister,
)
from asperity.laws.shifted import Shifted
from asperity.laws.spec import Law, LawSpec, Look, Materials, Need, Role, SteppedLaw, Variant, from_materials
from asperity.laws.table import Table

__all__ = [
    "Areal", "Direct", "HertzLaw", "Law", "LawSpec", "Linear", "Look", "Materials", "Need", "Printed", "Role",
    "Shifted", "SteppedLaw", "Table", "Variant", "baselines", "family_of", "from_materials", "in_role",
    "law_keys", "names", "needs_of", "reference", "register", "spec_of", "unregister",
]  # fmt: skip
