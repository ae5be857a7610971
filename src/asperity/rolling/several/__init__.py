"""Several contacts at once: any bodies roll over one structure, each contact under a law of its own."""

from asperity.rolling.several.energy import Ledger
from asperity.rolling.several.roll import FirstContact, RolledBodies, first_contact, roll_bodies

__all__ = ["FirstContact", "Ledger", "RolledBodies", "first_contact", "roll_bodies"]
