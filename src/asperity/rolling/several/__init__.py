"""Several contacts at once: any bodies roll over one structure, each contact under a law of its own."""

from asperity.rolling.several.energy import Ledger
from asperity.rolling.several.roll import RolledBodies, roll_bodies

__all__ = ["Ledger", "RolledBodies", "roll_bodies"]
