"""The run in time: force and approach by law, loss of contact."""

from __future__ import annotations

from functools import partial

from asperity.schema.entry import Attribute, Entry

_entry = partial(Entry, "rolling")

LAW = _entry("law", ("law",), "1", "contact law")
TIME = _entry("time", ("time",), "s", "time since the run-in")
POSITION = _entry("position", ("time",), "m", "position of the contact, in rolling direction")
CONTACT_FORCE = _entry("contact_force", ("law", "time"), "N", "contact force")
RELATIVE_DISPLACEMENT = _entry(
    "relative_displacement", ("law", "time"), "m", "approach of the mean surfaces, positive closing"
)
CONTACT_LOSS_SHARE = _entry("contact_loss_share", ("law",), "1", "share of the time without contact")
CONTACT_LOSS_EVENTS = _entry("contact_loss_events", ("law",), "1", "losses of contact")
LONGEST_LOSS = _entry("longest_loss", ("law",), "s", "longest time without contact")

SPEED = Attribute("rolling", "speed", "m/s", "speed of the contact")
