"""Chapters of the report of a ball on a beam."""

from __future__ import annotations

from asperity.reporting.chapter import CONTACT, Chapter
from asperity.reporting.spectrum_figures import SPECTRUM
from asperity.reporting.tables import (
    energy_table,
    homogeneity_table,
    loss_table,
    reference_table,
    statistics_table,
)
from asperity.reporting.texture import TEXTURE
from asperity.reporting.time_figures import TIME

CHAPTERS = (
    Chapter("texture", "Texture", TEXTURE, (statistics_table, homogeneity_table)),
    CONTACT,
    Chapter("force", "Contact force", (*TIME, *SPECTRUM[:2]), (reference_table, loss_table)),
    Chapter("acceleration", "Acceleration", SPECTRUM[2:]),
    Chapter("energy", "Energy", (), (energy_table,)),
)
