"""The moving point force: contact laws, one file and one line in the registry each.

What is known of a law before it is built is a `LawSpec`. Built from the materials of a case, a law is a
frozen description of the contact; ``law.prepare(positions)`` lays it out on the path, for the compiled
stepper (`asperity.kernels.pointforce.Prepared`) or for stepping from Python (`SteppedLaw`). Nothing here
imports compiled code before it is needed.
"""

from __future__ import annotations

from asperity.laws.areal import Areal as Areal
from asperity.laws.base import Law as Law
from asperity.laws.base import SteppedLaw as SteppedLaw
from asperity.laws.base import from_materials as from_materials
from asperity.laws.direct import Direct as Direct
from asperity.laws.hertz import HertzLaw as HertzLaw
from asperity.laws.linear import Linear as Linear
from asperity.laws.materials import Materials as Materials
from asperity.laws.printed import Printed as Printed
from asperity.laws.registry import baselines as baselines
from asperity.laws.registry import family_of as family_of
from asperity.laws.registry import in_role as in_role
from asperity.laws.registry import law_keys as law_keys
from asperity.laws.registry import names as names
from asperity.laws.registry import needs_of as needs_of
from asperity.laws.registry import reference as reference
from asperity.laws.registry import register as register
from asperity.laws.registry import spec_of as spec_of
from asperity.laws.registry import unregister as unregister
from asperity.laws.shifted import Shifted as Shifted
from asperity.laws.spec import LawSpec as LawSpec
from asperity.laws.spec import Look as Look
from asperity.laws.spec import Need as Need
from asperity.laws.spec import Role as Role
from asperity.laws.spec import Variant as Variant
from asperity.laws.table import Table as Table

__all__ = sorted(
    name for name, each in globals().items() if getattr(each, "__module__", "")[:9] == "asperity."
)
