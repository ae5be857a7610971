"""Say what to cite for a run."""

from __future__ import annotations

from pathlib import Path

from asperity.reporting.literature import literature
from asperity.results import read_result
from asperity.terminal import say


def show_citations(run: Path) -> None:
    """Print the program in the version of a run, and the sources of what it computed, a line each."""
    for source in literature(read_result(run)):
        say(source)
