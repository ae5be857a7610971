"""The run in time: force and approach by law and contact, loss of contact."""

from functools import partial

from asperity.schema import Attribute, Entry

_entry = partial(Entry, "rolling")
CONTACTS = "number of the contact, body by body, each from its rearmost"

LAW = _entry("law", "1", "contact law")
TIME = _entry("time", "s", "time since the run-in")
POSITION = _entry("position(time)", "m", "position of the first contact, in rolling direction")
TACHO = _entry("momentary_speed(time)", "m/s", "speed of the contacts at each time")
CONTACT = _entry("contact", "1", f"{CONTACTS}; of a bearing ball by ball, with the inner ring first")
OFFSET = _entry("offset(contact)", "m", "position of a contact ahead of that of the run")
STATIC_LOAD = _entry("static_load(contact)", "N", "static force of a contact")
CONTACT_FORCE = _entry("contact_force(law, contact, time)", "N", "contact force, compression positive")
RELATIVE_DISPLACEMENT = _entry(
    "relative_displacement(law, contact, time)", "m", "approach of the mean surfaces, positive closing"
)
CONTACT_LOSS_SHARE = _entry("contact_loss_share(law, contact)", "1", "share of the time without contact")
CONTACT_LOSS_EVENTS = _entry("contact_loss_events(law, contact)", "1", "losses of contact")
LONGEST_LOSS = _entry("longest_loss(law, contact)", "s", "longest time without contact")

LOSSES = (CONTACT_LOSS_SHARE, CONTACT_LOSS_EVENTS, LONGEST_LOSS)
FORCES = {
    "mean_force": "mean contact force",
    "rms_force": "rms of the contact force about its mean",
    "peak_force": "largest contact force",
}
"""Numbers that tables give of a contact force, N, and what they are."""
SPEED = Attribute("rolling", "speed", "m/s", "speed of the contacts; of one that changes the fastest")
