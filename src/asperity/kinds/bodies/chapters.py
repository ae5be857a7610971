"""Chapters of the report of bodies that roll."""

from __future__ import annotations

from asperity.kinds.ball_on_beam.answers import acceleration_answers
from asperity.kinds.ball_on_beam.figures.acceleration import ACCELERATION
from asperity.kinds.ball_on_beam.figures.energy import energy_table
from asperity.kinds.bodies.figures.contacts import CONTACTS, contacts_table
from asperity.kinds.bodies.figures.motion import MOTION
from asperity.kinds.bodies.figures.scene import BODIES_SCENE
from asperity.reporting.chapter import CONTACT, LAWS, Chapter
from asperity.scenarios.usual.chapters import FORCE, TEXTURE

CHAPTERS = (
    Chapter(
        "acceleration",
        "Acceleration of the structure",
        ACCELERATION,
        answers=acceleration_answers,
        summary=ACCELERATION[:1],
    ),
    Chapter("motion", "Motion of the bodies", MOTION, summary=MOTION),
    FORCE,
    Chapter("contacts", "All contacts", CONTACTS, (contacts_table,)),
    Chapter("setup", "Scene", (BODIES_SCENE,)),
    TEXTURE,
    Chapter("energy", "Energy", (), (energy_table,)),
    CONTACT,
    LAWS,
)
