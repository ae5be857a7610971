"""Chapters of the report of bodies that roll."""

from __future__ import annotations

from asperity.kinds.ball_on_beam.figures.acceleration import ACCELERATION
from asperity.kinds.ball_on_beam.figures.energy import energy_table
from asperity.kinds.bodies.figures.contacts import CONTACTS, contacts_table
from asperity.kinds.bodies.figures.motion import MOTION
from asperity.kinds.bodies.figures.scene import BODIES_SCENE
from asperity.reporting.chapter import Chapter
from asperity.scenarios.usual import chapters

CHAPTERS = (
    Chapter("setup", "Scene", (BODIES_SCENE,)),
    *chapters.CHAPTERS,
    Chapter("contacts", "All contacts", CONTACTS, (contacts_table,)),
    Chapter("motion", "Motion of the bodies", MOTION),
    Chapter("acceleration", "Acceleration of the structure", ACCELERATION),
    Chapter("energy", "Energy", (), (energy_table,)),
)
