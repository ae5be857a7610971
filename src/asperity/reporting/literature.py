"""What to cite for a run: the program, and the sources of the methods and data it used."""

from __future__ import annotations

import re

from xarray import DataTree

from asperity.reporting.data import json_attribute, stated
from asperity.schema import provenance

_OF_A_KEY = re.compile(r"([a-z_]+): (.+)", re.DOTALL)
"""Where the value of a key comes from: ``"pad_damping: published together with …"``."""


def literature(tree: DataTree) -> list[str]:
    """The program in the version of a run, then the sources of what it computed, one text each."""
    version = stated(tree, provenance.ASPERITY_VERSION) or "of unknown version"
    own = f"asperity {version}: rough contact reduced to a moving point force. The asperity developers."
    return [own, *(source for source in _sources(tree) if not _OF_A_KEY.fullmatch(source))]


def origins(tree: DataTree) -> dict[str, list[str]]:
    """Keys of the case whose values a named set gave, by where these come from."""
    found: dict[str, list[str]] = {}
    for told in filter(None, map(_OF_A_KEY.fullmatch, _sources(tree))):
        found.setdefault(told[2], []).append(told[1])
    return found


def _sources(tree: DataTree) -> list[str]:
    return [str(text) for text in json_attribute(tree, provenance.CITATIONS, [])]
