"""What to cite for a run: the program, and the sources of the methods and data it used."""

from __future__ import annotations

from xarray import DataTree

from asperity.reporting.data import json_attribute, stated
from asperity.schema import provenance


def literature(tree: DataTree) -> list[str]:
    """The program in the version of a run, then the sources of what it computed, one text each."""
    version = stated(tree, provenance.ASPERITY_VERSION) or "of unknown version"
    own = f"asperity {version}: rough contact reduced to a moving point force. The asperity developers."
    return [own, *(str(text) for text in json_attribute(tree, provenance.CITATIONS, []))]
