"""What a row of the conformance ledger is, and how `CONFORMANCE.md` is written from all of them.

    python tests/conformance/ledger.py     # writes CONFORMANCE.md

Expected values come from outside: closed forms evaluated by mpmath, printed values, other programs.
"""

from __future__ import annotations

import importlib
import math
import sys
import warnings
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import cache
from pathlib import Path

from asperity.errors import PhysicsWarning

sys.path.insert(0, str(Path(__file__).parent))

PAGE = Path(__file__).parents[2] / "CONFORMANCE.md"
ROOMS = {
    "contacts": "Contact",
    "reductions": "Contact filters, laws and rolling",
    "bodies": "Beams, balls and wheels",
    "together": "Several contacts at once",
    "tracks": "Track",
    "lines": "Spectra, weighting and bands",
    "textures": "Roughness: processing, statistics, files",
    "noises": "Railway tables and sound power",
    "radiations": "Sound radiation from vibration",
    "passings": "Pass-by",
}
"""Modules of this folder that hold the checks, and their headings."""


@dataclass(frozen=True)
class Check:
    """One row: what is checked, where the expected value comes from, and how near it has to be.

    `tolerance` is relative to the expected value, absolute where `absolute` is set (in the unit).
    """

    what: str
    source: str
    expected: float
    obtained: float
    tolerance: float
    unit: str = ""
    absolute: bool = False

    @property
    def deviation(self) -> float:
        """Difference, in the sense of the tolerance."""
        difference = abs(self.obtained - self.expected)
        return difference if self.absolute else difference / abs(self.expected)

    @property
    def holds(self) -> bool:
        return math.isfinite(self.obtained) and self.deviation <= self.tolerance


Checks = Callable[[], Iterator[Check]]


def all_checks() -> dict[str, list[Checks]]:
    """Functions that yield checks, by module."""
    return {name: list(importlib.import_module(name).CHECKS) for name in ROOMS}


@cache
def made(function: Checks) -> tuple[Check, ...]:
    """Rows of one function, computed once."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", PhysicsWarning)  # a row shows what a warning would doubt
        return tuple(function())


def digits(check: Check) -> tuple[str, str]:
    """Expected and obtained value with as many digits as the tolerance leaves meaning."""
    size = abs(check.expected) or check.tolerance or 1.0
    allowed = check.tolerance if check.absolute else check.tolerance * size
    count = 6 if allowed == 0 else min(12, max(3, 2 - math.floor(math.log10(allowed / size))))
    return tuple(f"{value + 0.0:.{count}g}" for value in (check.expected, check.obtained))


def row(check: Check) -> str:
    expected, obtained = digits(check)
    unit = f" {check.unit}" if check.unit else ""
    tolerance = f"{check.tolerance:.2g}{unit if check.absolute else ''}"
    return f"| {check.what} | {check.source} | {expected}{unit} | {obtained}{unit} | {tolerance} |"


def page() -> str:
    """The ledger as it is computed now."""
    parts, count = [], 0
    for name, functions in all_checks().items():
        checks = [check for function in functions for check in made(function)]
        count += len(checks)
        lines = [f"\n## {ROOMS[name]}\n", "| what | source | expected | obtained | tolerance |"]
        lines += ["|---|---|---:|---:|---:|", *map(row, checks)]
        parts.append("\n".join(lines))
    head = f"""# Conformance

{count} numbers of this program beside those of closed forms, standards, publications and other programs.
Written by `python tests/conformance/ledger.py`, checked by every run of the tests. Tolerances without a unit
are relative; where one is above rounding, the row says why: the grid, the digits printed, or the limits of
the closed form.
"""
    return head + "\n".join(parts) + "\n"


if __name__ == "__main__":
    PAGE.write_text(page(), encoding="utf-8")
