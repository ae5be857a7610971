"""Several runs beside each other: figures and tables of `asperity.compare`, as its page has them."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from asperity.reporting.comparison_page import compared_sections, summary
from asperity.scenes import comparing
from asperity.serving.blocks import told_blocks


def numbered_names(names: Sequence[str]) -> list[str]:
    """Names of runs, each once: those that stand there already are numbered."""
    found: list[str] = []
    for name in names:
        number, own = 1, name
        while own in found:
            number += 1
            own = f"{name} ({number})"
        found.append(own)
    return found


def compared_runs(paths: list[str], names: list[str]) -> dict[str, Any]:
    """A sentence, and what the page of the comparison shows below it."""
    found = comparing.comparison_of(paths, numbered_names(names))
    blocks = [block for section in compared_sections(found) for block in section.blocks]
    return {"summary": summary(found), **told_blocks(blocks)}


def write_beside(paths: list[str], names: list[str], folder: str) -> dict[str, Any]:
    """Write the page of a comparison, with its table, into a folder."""
    comparing.compare(*paths, names=numbered_names(names), path=folder)
    return {}
