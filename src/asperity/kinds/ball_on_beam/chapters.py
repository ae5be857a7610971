"""Chapters of the report of a ball on a beam."""

from __future__ import annotations

from asperity.reporting.chapter import CONTACT, LAWS, Chapter
from asperity.scenes.acceleration_answers import acceleration_answers
from asperity.scenes.chapters import FORCE, TEXTURE
from asperity.scenes.figures.acceleration import ACCELERATION
from asperity.scenes.figures.beam_scene import BEAM_SCENE
from asperity.scenes.figures.energy import energy_table

CHAPTERS = (
    Chapter(
        "acceleration", "Acceleration", ACCELERATION, answers=acceleration_answers, summary=ACCELERATION[:1]
    ),
    FORCE,
    Chapter("setup", "Scene", (BEAM_SCENE,)),
    TEXTURE,
    Chapter("energy", "Energy", (), (energy_table,)),
    CONTACT,
    LAWS,
)
