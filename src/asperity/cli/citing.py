"""Say what to cite for a run."""

from __future__ import annotations

from pathlib import Path

from asperity.reporting.data import json_attribute, stated
from asperity.results import read_result
from asperity.schema import provenance
from asperity.terminal import say


def show_citations(run: Path) -> None:
    """Print the program in the version of a run, and the sources of what it computed, a line each."""
    tree = read_result(run)
    version = stated(tree, provenance.ASPERITY_VERSION)
    say(f"asperity {version}: rough contact reduced to a moving point force. The asperity developers.")
    for citation in json_attribute(tree, provenance.CITATIONS, []):
        say(str(citation))
