"""Chapters that every report has."""

from __future__ import annotations

from asperity.reporting.chapter import CONTACT, Chapter
from asperity.reporting.spectrum_figures import FORCE_BANDS, FORCE_SPECTRUM
from asperity.reporting.tables import (
    homogeneity_table,
    loss_table,
    practice_table,
    reference_table,
    statistics_table,
)
from asperity.reporting.texture import TEXTURE
from asperity.reporting.time_figures import FORCE_ENVELOPE, FORCE_PIECE

CHAPTERS = (
    Chapter("texture", "Texture", TEXTURE, (statistics_table, homogeneity_table)),
    CONTACT,
    Chapter(
        "force",
        "Contact force",
        (FORCE_ENVELOPE, FORCE_PIECE, FORCE_SPECTRUM, FORCE_BANDS),
        (practice_table, reference_table, loss_table),
    ),
)
