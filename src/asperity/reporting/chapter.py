"""What a chapter of the report consists of, and those that all kinds of case share."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from xarray import DataTree

from asperity.reporting import convergence
from asperity.reporting.contact_figures import CONTACT as CONTACT_PARTS
from asperity.reporting.part import Part
from asperity.reporting.running_in import HEIGHTS, condition_table, passes_table
from asperity.reporting.tables import ReportTable, population_table, validity_table


@dataclass(frozen=True)
class Chapter:
    """What a chapter can hold: its figures, then its tables."""

    name: str
    title: str
    parts: tuple[Part, ...]
    tables: tuple[Callable[[DataTree], ReportTable | None], ...] = ()


CONTACT = Chapter(
    "contact",
    "Contact",
    (*CONTACT_PARTS, HEIGHTS),
    (validity_table, population_table, condition_table, passes_table),
)
CONVERGENCE = Chapter(
    "convergence", "Convergence", (), (convergence.settings_table, convergence.changes_table)
)
