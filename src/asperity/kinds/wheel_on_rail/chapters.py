"""Chapters of the report of a wheel on a rail."""

from __future__ import annotations

from asperity.reporting.chapter import CONTACT, LAWS, Chapter
from asperity.reporting.force_figures import FORCE_ENVELOPE
from asperity.reporting.headline import force_answers
from asperity.reporting.tables import (
    homogeneity_table,
    loss_table,
    statistics_table,
)
from asperity.reporting.texture_figures import TEXTURE
from asperity.scenes.figures.force import FORCE_BANDS, FORCE_PEAK, FORCE_SPECTRUM
from asperity.scenes.figures.loss_factors import LOSS_FACTORS
from asperity.scenes.figures.noise import NOISE, sound_power_table
from asperity.scenes.figures.pass_by import PASS_BY_PART, pass_by_table
from asperity.scenes.figures.radiated import RADIATED, radiated_table
from asperity.scenes.figures.rail_motion import MOTION
from asperity.scenes.figures.roughness import ROUGHNESS_LEVELS
from asperity.scenes.figures.track import TRACK
from asperity.scenes.figures.track_scene import TRACK_SCENE
from asperity.scenes.sound_answers import noise_answers, pass_by_answers

SOUND = (
    Chapter(
        "noise",
        "Rolling noise",
        (RADIATED, *NOISE),
        (radiated_table, sound_power_table),
        noise_answers,
        (RADIATED, *NOISE[::-1]),
    ),
    Chapter("pass_by", "Pass-by", (PASS_BY_PART,), (pass_by_table,), pass_by_answers, (PASS_BY_PART,)),
)
TEXTURE_OF_PARTS = Chapter(
    "texture",
    "Texture",
    (ROUGHNESS_LEVELS, *TEXTURE),
    (statistics_table, homogeneity_table),
    summary=(ROUGHNESS_LEVELS, *TEXTURE[::-1]),
)
RAIL = (
    Chapter("track", "Track and wheel", (*TRACK, LOSS_FACTORS)),
    Chapter("motion", "Motion", MOTION),
)
CHAPTERS = (
    *SOUND,
    Chapter(
        "force",
        "Contact force",
        (FORCE_ENVELOPE, FORCE_PEAK, FORCE_SPECTRUM, FORCE_BANDS),
        (loss_table,),
        force_answers,
        (FORCE_BANDS,),
    ),
    Chapter("setup", "Scene", (TRACK_SCENE,)),
    TEXTURE_OF_PARTS,
    *RAIL,
    CONTACT,
    LAWS,
)
