"""Every row of the ledger holds, and `CONFORMANCE.md` says what is computed now."""

import re
from functools import partial

import ledger
import pytest

FUNCTIONS = [
    pytest.param(function, id=f"{name}-{function.__name__}")
    for name, functions in ledger.all_checks().items()
    for function in functions
]


@pytest.mark.parametrize("function", FUNCTIONS)
def test_every_row_holds(function):
    checks = ledger.made(function)
    assert checks
    for check in checks:
        assert check.holds, ledger.row(check)


def cells(line):
    return [cell.strip() for cell in re.split(r"(?<!\\)\|", line)[1:-1]]


def test_the_page_is_not_stale():
    """All columns are as they are written now; what was obtained may differ by what machines differ."""
    written = [line for line in ledger.PAGE.read_text(encoding="utf-8").splitlines() if line.startswith("| ")]
    now = [line for line in ledger.page().splitlines() if line.startswith("| ")]
    assert len([line for line in written if not line.startswith("| what")]) >= 100
    assert [cells(line)[:3] + cells(line)[4:] for line in written] == [
        cells(line)[:3] + cells(line)[4:] for line in now
    ]


def test_a_row_that_does_not_hold_is_seen():
    force = partial(ledger.Check, "force", 1.0, source="Hertz", tolerance=0.01)
    assert not force(1.1).holds
    assert not force(float("nan")).holds
    assert ledger.Check("level", 0.0, 0.04, "dB", source="0 dB", tolerance=0.05, absolute=True).holds
