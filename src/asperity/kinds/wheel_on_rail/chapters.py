"""Chapters of the report of a wheel on a rail."""

from __future__ import annotations

from dataclasses import replace

from asperity.reporting.figure import Chapter
from asperity.scenes import chapters
from asperity.scenes.figures import force, motion
from asperity.scenes.figures.scene import TRACK_SCENE

CHAPTERS = (
    *chapters.NOISE,
    replace(
        chapters.FORCE,
        figures=(force.FORCE_ENVELOPE, force.FORCE_PEAK, force.LINEAR_SPECTRUM, force.FORCE_BANDS),
    ),
    Chapter("setup", "Scene", (TRACK_SCENE,)),
    chapters.TEXTURE,
    chapters.TRACK,
    Chapter("motion", "Motion", motion.RAIL),
    chapters.CONTACT,
    chapters.LAWS,
)
