"""Chapters of texture and force that kinds of case share."""

from __future__ import annotations

from asperity.reporting.chapter import CONTACT, LAWS, Chapter
from asperity.reporting.force_figures import FORCE_BANDS, FORCE_ENVELOPE, FORCE_PIECE, FORCE_SPECTRUM
from asperity.reporting.headline import force_answers
from asperity.reporting.tables import (
    homogeneity_table,
    loss_table,
    statistics_table,
)
from asperity.reporting.texture_figures import TEXTURE as TEXTURE_PARTS

FORCE = Chapter(
    "force",
    "Contact force",
    (FORCE_ENVELOPE, FORCE_PIECE, FORCE_SPECTRUM, FORCE_BANDS),
    (loss_table,),
    force_answers,
    (FORCE_BANDS,),
)
TEXTURE = Chapter(
    "texture", "Texture", TEXTURE_PARTS, (statistics_table, homogeneity_table), summary=TEXTURE_PARTS[::-1]
)
CHAPTERS = (FORCE, TEXTURE, CONTACT, LAWS)
"""Of a kind that has none of its own."""
