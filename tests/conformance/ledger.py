"""What a row of the conformance ledger is, and how `CONFORMANCE.md` is written from all of them.

    python tests/conformance/ledger.py     # writes CONFORMANCE.md

Expected values come from outside: closed forms evaluated by mpmath, printed values, other programs.
"""

import csv
import importlib
import inspect
import math
import sys
import warnings
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from functools import cache
from pathlib import Path

import numpy as np

from asperity.errors import PhysicsWarning

sys.path[:0] = [str(Path(__file__).parent), str(Path(__file__).parents[1])]

ROOT = Path(__file__).parents[2]
PAGE = ROOT / "CONFORMANCE.md"
MEASURED = sorted((ROOT / "docs" / "evidence").glob("measured_*.csv"))
"""What pages of measurements found: columns what, source, measured, computed and deviation, as text."""
ROOMS = {
    "contacts": "Contact",
    "films": "Films of oil",
    "frictions": "Friction",
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


SIZES = {
    "µm": 1e-6, "mm": 1e-3, "nm": 1e-9, "1/mm": 1e3, "µm²": 1e-12, "µm³": 1e-18, "1e-3/m2": 1e-3,
    "kN": 1e3, "MPa": 1e6, "GPa": 1e9, "MPa²·10⁶": 1e18, "MN/m": 1e6, "GN/m": 1e9,
    "µm/N": 1e-6, "nm/N": 1e-9, "pm/N": 1e-12,
}  # fmt: skip
"""Units of rows that are not those of SI."""


@dataclass(frozen=True)
class Check:
    """One row: what is checked, where the expected value comes from, and how near it has to be.

    Both values are single numbers of any type, given in SI and kept in the unit. `tolerance` is relative to
    the expected value, absolute where `absolute` is set (in the unit).
    """

    quantity: str
    expected: float
    obtained: float
    unit: str = ""
    body: str = field(default="", kw_only=True)  # that has the quantity, where several rows are of one
    source: str = field(kw_only=True)
    tolerance: float = field(kw_only=True)
    absolute: bool = field(default=False, kw_only=True)

    def __post_init__(self) -> None:
        for name in ("expected", "obtained"):
            number = float(np.asarray(getattr(self, name)).item())
            object.__setattr__(self, name, number / SIZES.get(self.unit, 1.0))

    @property
    def what(self) -> str:
        return f"{self.body}: {self.quantity}" if self.body else self.quantity

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
    """Functions that yield checks, by module: all generators of it."""
    modules = {name: importlib.import_module(name) for name in ROOMS}
    return {
        name: [each for each in vars(module).values() if inspect.isgeneratorfunction(each)]
        for name, module in modules.items()
    }


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


def measured() -> str:
    """What was measured beside what was computed, as the pages of evidence wrote it; it may miss."""
    rows = []
    for file in MEASURED:
        with file.open(encoding="utf-8") as lines:
            rows += [f"| {' | '.join(each.values())} |" for each in csv.DictReader(lines)]
    head = """
## Measured

| what | measured by | measured | computed | deviation |
|---|---|---:|---:|---:|"""
    return "\n".join([head, *rows])


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
the closed form. What was measured has none: deviations stand there as they are, misses with the rest, as the
commands of the pages of evidence wrote them.
"""
    return head + "\n".join([*parts, measured()]) + "\n"


if __name__ == "__main__":
    PAGE.write_text(page(), encoding="utf-8")
