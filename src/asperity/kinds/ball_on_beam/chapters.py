"""Chapters of the report of a ball on a beam."""

from __future__ import annotations

from asperity.kinds.ball_on_beam.figures.acceleration import ACCELERATION
from asperity.kinds.ball_on_beam.figures.energy import energy_table
from asperity.kinds.ball_on_beam.figures.scene import BEAM_SCENE
from asperity.reporting.chapter import Chapter
from asperity.scenarios.usual import chapters

CHAPTERS = (
    Chapter("setup", "Scene", (BEAM_SCENE,)),
    *chapters.CHAPTERS,
    Chapter("acceleration", "Acceleration", ACCELERATION),
    Chapter("energy", "Energy", (), (energy_table,)),
)
