"""Figures drawn while a run still computes, from what is already known of its result."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from contextlib import suppress
from typing import NamedTuple

from xarray import DataTree

from asperity.reporting.data import Looks, noted
from asperity.reporting.page import Picture, picture
from asperity.reporting.part import Part


class DrawnAhead(NamedTuple):
    """A picture, and all that was looked at for it: a result that says the same has the same picture."""

    picture: Picture
    looks: Looks


def drawn_ahead(known: DataTree, parts: Sequence[Part], enough: Callable[[], bool]) -> dict[str, DrawnAhead]:
    """Draw figures from what is known of a result, one after the other until it is enough, by name."""
    found = {}
    for part in parts:
        if enough():
            break
        with noted() as looks, suppress(Exception):  # what it failed for may not be known yet
            found[part.name] = DrawnAhead(picture(known, part), looks)
    return found
