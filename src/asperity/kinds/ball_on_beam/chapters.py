"""Chapters of the report of a ball on a beam."""

from __future__ import annotations

from asperity.reporting.figure import Chapter
from asperity.scenes import chapters
from asperity.scenes.figures.scene import BEAM_SCENE

CHAPTERS = (
    chapters.ACCELERATION,
    chapters.FORCE,
    Chapter("setup", "Scene", (BEAM_SCENE,)),
    chapters.TEXTURE,
    chapters.ENERGY,
    chapters.CONTACT,
    chapters.LAWS,
)
