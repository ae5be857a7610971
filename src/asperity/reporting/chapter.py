"""What a chapter of the report consists of, and those that all kinds of case share."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from xarray import DataTree

from asperity.reporting.contact_figures import FILTER, LOADING, PRESSURE
from asperity.reporting.headline import Answers
from asperity.reporting.part import Part
from asperity.reporting.running_in import HEIGHTS, condition_table, passes_table
from asperity.reporting.tables import ReportTable, population_table, practice_table, reference_table
from asperity.reporting.uncertainty import changes_table, settings_table, uncertainty_table


@dataclass(frozen=True)
class Chapter:
    """What a chapter can hold: its figures, then its tables."""

    name: str
    title: str
    parts: tuple[Part, ...]
    tables: tuple[Callable[[DataTree], ReportTable | None], ...] = ()
    answers: Callable[[DataTree], Answers | None] | None = None  # what the top of the page says of it
    summary: tuple[Part, ...] = ()  # figures of which a summary shows the first that can be drawn


CONTACT = Chapter(
    "contact", "Contact", (PRESSURE, HEIGHTS), (population_table, condition_table, passes_table)
)
LAWS = Chapter("laws", "How the contact laws work", (LOADING, *FILTER), (practice_table, reference_table))
UNCERTAINTY = Chapter(
    "uncertainty",
    "Uncertainty",
    (),
    (uncertainty_table, settings_table, changes_table),
)
