"""One body rolls on one contact: the records of `roll_bodies` without the dimension for contacts.

With laws that Python steps, a checkpoint in memory, rough paths, and differences over the largest value.
"""

from types import SimpleNamespace

import numpy as np
from numpy.testing import assert_allclose

from asperity.kernels.pointforce import evaluate_all
from asperity.reduction.texture import StateTexture
from asperity.rolling.roll import roll_bodies
from asperity.structures.body import Body
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


def rough(rms, spacing, start, points=4000, seed=2):
    """A texture of waves longer than thirty points."""
    steps = np.random.default_rng(seed).standard_normal(points)
    heights = np.convolve(steps, np.hanning(30), mode="same")
    return StateTexture.unfiltered(rms * heights / heights.std(), spacing, start)


def same(found, expected, rel=1e-9):
    assert_allclose(found, expected, rtol=0.0, atol=rel * np.abs(expected).max())


def rigid_bar(mass, inertia, places, load):
    """A rigid body that heaves and pitches about the middle of its contacts, and presses with a load."""
    places, none = np.asarray(places, dtype=float), np.zeros((2, 2))
    lever = np.stack([np.ones_like(places), places - places.mean()], axis=1)
    return Body(np.diag([mass, inertia]), none, none, lever, np.array([load, 0.0]), places)
