"""Chapters of the report of bodies that roll."""

from __future__ import annotations

from dataclasses import replace

from asperity.kinds.wheel_on_rail.chapters import RAIL, SOUND, TEXTURE_OF_PARTS
from asperity.reporting.chapter import CONTACT, LAWS, Chapter
from asperity.scenes.acceleration_answers import acceleration_answers
from asperity.scenes.chapters import FORCE
from asperity.scenes.figures.acceleration import ACCELERATION
from asperity.scenes.figures.bodies_scene import BODIES_SCENE
from asperity.scenes.figures.body_motion import MOTION
from asperity.scenes.figures.contacts import CONTACTS, contacts_table
from asperity.scenes.figures.energy import energy_table
from asperity.scenes.figures.force import FORCE_BANDS

CHAPTERS = (
    *SOUND,
    Chapter(
        "acceleration",
        "Acceleration of the structure",
        ACCELERATION,
        answers=acceleration_answers,
        summary=ACCELERATION[:1],
    ),
    Chapter("motion", "Motion of the bodies", MOTION, summary=MOTION),
    replace(FORCE, parts=(*FORCE.parts[:-1], FORCE_BANDS), summary=(FORCE_BANDS,)),
    Chapter("contacts", "All contacts", CONTACTS, (contacts_table,)),
    Chapter("setup", "Scene", (BODIES_SCENE,)),
    TEXTURE_OF_PARTS,
    RAIL[0],
    replace(RAIL[1], name="rail", title="Motion of the rail"),
    Chapter("energy", "Energy", (), (energy_table,)),
    CONTACT,
    LAWS,
)
