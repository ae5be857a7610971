"""Bodies have rolled under one law: the first contact is the record that all kinds of case have."""

from __future__ import annotations

from dataclasses import dataclass

from asperity.rolling.rolled import Rolled
from asperity.rolling.several import RolledBodies


@dataclass(frozen=True, eq=False)
class FirstContact(Rolled):
    """What the first contact recorded, and beside it what all of them did."""

    every: RolledBodies


def first_of(every: RolledBodies) -> FirstContact:
    """Take the first contact of bodies that have rolled."""
    return FirstContact(
        time=every.time,
        position=every.positions[0],
        contact_force=every.contact_force[0],
        relative_displacement=every.relative_displacement[0],
        in_contact=every.in_contact[0],
        contact_loss=every.contact_loss[0],
        evaluations=every.evaluations,
        unconverged_steps=every.unconverged_steps,
        outcome=every.outcome,
        every=every,
    )
