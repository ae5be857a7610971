"""Chapters of the report: those that kinds of case share, and of a kind that has none of its own."""

from __future__ import annotations

from asperity.reporting import contact_figures, headline, tables, texture_figures, uncertainty
from asperity.reporting.figure import Chapter
from asperity.scenes.acceleration_answers import acceleration_answers
from asperity.scenes.figures import force, motion, noise, roughness, track

FORCE = Chapter(
    "force",
    "Contact force",
    (force.FORCE_ENVELOPE, force.FORCE_PIECE, force.FORCE_SPECTRUM, force.FORCE_BANDS),
    (tables.loss_table,),
    headline.force_answers,
    (force.FORCE_BANDS,),
)
ACCELERATION = Chapter(
    "acceleration",
    "Acceleration",
    motion.ACCELERATION,
    answers=acceleration_answers,
    summary=motion.ACCELERATION[:1],
)
TEXTURE = Chapter(
    "texture",
    "Texture",
    (roughness.ROUGHNESS, *texture_figures.TEXTURE),
    (tables.statistics_table, tables.homogeneity_table),
    summary=(roughness.ROUGHNESS, *texture_figures.TEXTURE[::-1]),
)
NOISE = (
    Chapter(
        "noise",
        "Rolling noise",
        (noise.RADIATED, *noise.NOISE),
        (noise.radiated_table, noise.sound_power_table),
        noise.noise_answers,
        (noise.RADIATED, *noise.NOISE[::-1]),
    ),
    Chapter(
        "pass_by",
        "Pass-by",
        (noise.PASS_BY,),
        (noise.pass_by_table,),
        noise.pass_by_answers,
        (noise.PASS_BY,),
    ),
)
TRACK = Chapter("track", "Track and wheel", (*track.TRACK, track.LOSS_FACTORS))
ENERGY = Chapter("energy", "Energy", (), (motion.energy_table,))
CONTACT = Chapter(
    "contact",
    "Contact",
    (contact_figures.PRESSURE, texture_figures.RUNNING_IN),
    (tables.population_table, tables.condition_table, tables.passes_table),
)
LAWS = Chapter(
    "laws",
    "How the contact laws work",
    (contact_figures.LOADING, contact_figures.FILTER, contact_figures.PRINTED_FILTER),
    (tables.practice_table, tables.reference_table),
)
UNCERTAINTY = Chapter(
    "uncertainty",
    "Uncertainty",
    (),
    (uncertainty.uncertainty_table, uncertainty.settings_table, uncertainty.changes_table),
)
CHAPTERS = (FORCE, TEXTURE, CONTACT, LAWS)
"""Of a kind that has none of its own."""
