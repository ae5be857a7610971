"""What the result of a body that rolls over another holds, as is usual, beside what all results hold."""

from __future__ import annotations

from asperity.schema.entry import Entry

OVER_DISPLACEMENT = Entry(
    "rolling",
    "over_displacement",
    ("law", "time"),
    "m",
    "displacement under the contact of what is rolled over, positive downwards",
)
ROLLING_DISPLACEMENT = Entry(
    "rolling",
    "rolling_displacement",
    ("law", "time"),
    "m",
    "displacement of what rolls, positive downwards",
)

KEPT: dict[Entry, dict[str, str]] = {}
"""What a study keeps of it."""
SHOWN: tuple[str, ...] = ()
"""What a study shows of it unasked."""
