"""One body rolls on one contact: the records of `roll_bodies` without the dimension for contacts.

With laws that Python steps, and a checkpoint in memory.
"""

from types import SimpleNamespace

import numpy as np

from asperity.kernels.pointforce import evaluate_all
from asperity.rolling.roll import roll_bodies
from asperity.structures.rail_poles import RailBetween

OF_CONTACTS = (
    "positions", "contact_force", "relative_displacement", "over_displacement", "rolling_displacement",
    "in_contact", "flights",
)  # fmt: skip


def first_contact(every):
    """What the first contact of bodies that have rolled recorded, beside what all of them did."""
    own = {name: getattr(every, name)[0] for name in OF_CONTACTS}
    lost = 1.0 - own["in_contact"].mean()
    return SimpleNamespace(**vars(every) | own, position=own["positions"], contact_loss_share=lost)


def roll_ball(beam, ball, law, **path):
    """One body over a beam, as `roll_bodies`."""
    return first_contact(roll_bodies(beam, [ball], [law], positions=[0.0], **path))


def roll_wheel(rail, wheel, law, **path):
    """A wheel along a track, by poles or scattered, as `roll_bodies`."""
    between = RailBetween(rail, {})
    own = {"positions": [0.0], "speed": between.kernel.speed, "time_step": between.kernel.time_step}
    return first_contact(roll_bodies(between, [wheel.body], [law], **own, **path))


class Shelf:
    """A checkpoint in memory, which holds what was saved last."""

    arrays = None

    def load(self):
        return self.arrays

    def save(self, arrays):
        self.arrays = {name: np.array(value) for name, value in arrays.items()}


class Stepped:
    """A law that Python steps, with the force of another one."""

    name = "stepped"

    def __init__(self, law):
        self.law, self.damping = law, law.damping

    def prepare(self, positions):
        self.prepared, self.accepted, self.warned = self.law.prepare(positions), 0, 0
        return self

    def evaluate(self, step, approach):
        force, slope, _ = evaluate_all(self.prepared, np.array([approach]), step)
        return force[0], slope[0]

    def accept(self, step):
        self.accepted += 1

    def state(self):
        return {"accepted": np.array(self.accepted)}

    def restore(self, state):
        self.accepted = int(state["accepted"])

    def warn_of_flaws(self):
        self.warned += 1
