"""Say what to cite for a run."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from asperity.reporting.page import literature
from asperity.results import read_result
from asperity.terminal import say


def show_citations(run: Path) -> dict[str, Any]:
    """Print the program in the version of a run, and the sources of what it computed, a line each."""
    sources = literature(read_result(run))
    for source in sources:
        say(source)
    return {"run": str(run.resolve()), "sources": sources, "warnings": []}
