"""Chapters of the report of bodies that roll."""

from __future__ import annotations

from dataclasses import replace

from asperity.reporting.figure import Chapter
from asperity.scenes import chapters
from asperity.scenes.figures import contacts, motion
from asperity.scenes.figures.scene import BODIES_SCENE

CHAPTERS = (
    *chapters.NOISE,
    replace(chapters.ACCELERATION, title="Acceleration of the structure"),
    Chapter("motion", "Motion of the bodies", (motion.BODIES,), summary=(motion.BODIES,)),
    chapters.FORCE,
    Chapter("contacts", "All contacts", contacts.CONTACTS, (contacts.contacts_table,)),
    Chapter("setup", "Scene", (BODIES_SCENE,)),
    chapters.TEXTURE,
    chapters.TRACK,
    Chapter("rail", "Motion of the rail", motion.RAIL),
    chapters.ENERGY,
    chapters.CONTACT,
    chapters.LAWS,
)
