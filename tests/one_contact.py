"""One body rolls on one contact: the records of `roll_bodies` without the dimension for contacts."""

from types import SimpleNamespace

from asperity.rolling.roll import roll_bodies
from asperity.structures.body import Body
from asperity.structures.rail_poles import RailBetween

OF_CONTACTS = (
    "positions", "contact_force", "relative_displacement", "over_displacement", "rolling_displacement",
    "in_contact", "contact_loss",
)  # fmt: skip


def first_contact(every):
    """What the first contact of bodies that have rolled recorded, beside what all of them did."""
    own = {name: getattr(every, name)[0] for name in OF_CONTACTS}
    lost = 1.0 - own["in_contact"].mean()
    return SimpleNamespace(**vars(every) | own, position=own["positions"], contact_loss_share=lost)


def roll_ball(beam, ball, law, **path):
    """A ball over a beam, as `roll_bodies`."""
    body = Body.rigid(ball.mass, ball.static_load)
    return first_contact(roll_bodies(beam, [body], [law], positions=[0.0], **path))


def roll_wheel(rail, wheel, law, **path):
    """A wheel along a track, by poles or scattered, as `roll_bodies`."""
    between = RailBetween(rail, {})
    own = {"positions": [0.0], "speed": between.kernel.speed, "time_step": between.kernel.time_step}
    return first_contact(roll_bodies(between, [wheel.body], [law], **own, **path))
