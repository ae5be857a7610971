"""Chapters of the report of a ball on a beam."""

from __future__ import annotations

from asperity.kinds.ball_on_beam.answers import acceleration_answers
from asperity.kinds.ball_on_beam.figures.acceleration import ACCELERATION
from asperity.kinds.ball_on_beam.figures.energy import energy_table
from asperity.kinds.ball_on_beam.figures.scene import BEAM_SCENE
from asperity.reporting.chapter import CONTACT, LAWS, Chapter
from asperity.scenarios.usual.chapters import FORCE, TEXTURE

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
