"""Chapters of the report of any scene: what a result lacks is left out."""

from __future__ import annotations

from dataclasses import replace

from xarray import DataTree

from asperity.reporting import contact_figures, headline, tables, texture_figures, uncertainty
from asperity.reporting.figure import Chapter
from asperity.scenes.acceleration_answers import acceleration_answers
from asperity.scenes.figures import contacts, force, motion, noise, roughness, scene, track

_FORCE = Chapter(
    "force",
    "Contact force",
    (force.FORCE_ENVELOPE, force.FORCE_PIECE, force.FORCE_SPECTRUM, force.FORCE_BANDS),
    (tables.loss_table,),
    headline.force_answers,
    (force.FORCE_BANDS,),
)
_FORCE_OVER_TRACK = replace(
    _FORCE, figures=(force.FORCE_ENVELOPE, force.FORCE_PEAK, force.LINEAR_SPECTRUM, force.FORCE_BANDS)
)
_SCENES = {"ball-on-beam": scene.BEAM_SCENE, "wheel-on-rail": scene.TRACK_SCENE}


def chapters_of(tree: DataTree) -> tuple[Chapter, ...]:
    """Chapters for a result: those of a track first, where one is rolled over."""
    kind = tree["scenario"].attrs.get("kind", "") if "scenario" in tree else ""
    return (
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
        Chapter(
            "acceleration",
            "Acceleration",
            motion.ACCELERATION,
            answers=acceleration_answers,
            summary=motion.ACCELERATION[:1],
        ),
        Chapter("motion", "Motion of the bodies", (motion.BODIES,), summary=(motion.BODIES,)),
        _FORCE_OVER_TRACK if "track" in tree.children else _FORCE,
        Chapter("contacts", "All contacts", contacts.CONTACTS, (contacts.contacts_table,)),
        Chapter("setup", "Scene", (_SCENES.get(kind, scene.BODIES_SCENE),)),
        Chapter(
            "texture",
            "Texture",
            (roughness.ROUGHNESS, *texture_figures.TEXTURE),
            (tables.statistics_table, tables.homogeneity_table),
            summary=(roughness.ROUGHNESS, *texture_figures.TEXTURE[::-1]),
        ),
        Chapter("track", "Track and wheel", (*track.TRACK, track.LOSS_FACTORS)),
        Chapter("rail", "Motion of the rail", motion.RAIL),
        Chapter("energy", "Energy", (), (motion.energy_table,)),
        Chapter(
            "contact",
            "Contact",
            (contact_figures.PRESSURE, texture_figures.RUNNING_IN),
            (tables.population_table, tables.condition_table, tables.passes_table),
        ),
        Chapter(
            "laws",
            "How the contact laws work",
            (contact_figures.LOADING, contact_figures.FILTER, contact_figures.PRINTED_FILTER),
            (tables.practice_table, tables.reference_table),
        ),
        Chapter(
            "uncertainty",
            "Uncertainty",
            (),
            (uncertainty.uncertainty_table, uncertainty.settings_table, uncertainty.changes_table),
        ),
    )
