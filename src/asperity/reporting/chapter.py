"""What a chapter of the report consists of, and those that all kinds of case share."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from xarray import DataTree

from asperity.reporting import convergence
from asperity.reporting.contact_figures import CONTACT as CONTACT_PARTS
from asperity.reporting.headline import HeadlineNumber
from asperity.reporting.part import Part
from asperity.reporting.running_in import HEIGHTS, condition_table, passes_table
from asperity.reporting.tables import ReportTable, population_table
from asperity.reporting.uncertainty import uncertainty_table


@dataclass(frozen=True)
class Chapter:
    """What a chapter can hold: its figures, then its tables."""

    name: str
    title: str
    parts: tuple[Part, ...]
    tables: tuple[Callable[[DataTree], ReportTable | None], ...] = ()
    # a number for the top of the page, in place of the change of the force level
    headline: Callable[[DataTree], HeadlineNumber | None] | None = None


CONTACT = Chapter(
    "contact",
    "Contact",
    (*CONTACT_PARTS, HEIGHTS),
    (population_table, condition_table, passes_table),
)
UNCERTAINTY = Chapter(
    "uncertainty",
    "Uncertainty",
    (),
    (uncertainty_table, convergence.settings_table, convergence.changes_table),
)
