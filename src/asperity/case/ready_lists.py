"""Ready lists of what may make a case quieter: a study as a commented text, and its named changes."""

from collections.abc import Callable, Mapping
from functools import partial
from typing import Any

from asperity.case import toml
from asperity.files import packaged

OVER_TRACKS, IN_BEARINGS = "what_helps.toml", "what_helps_in_bearings.toml"
"""Of what is heard beside a track, and of a ball bearing."""
IN_ROLLER_BEARINGS = "what_helps_in_roller_bearings.toml"

NamedChanges = Mapping[str, Mapping[str, Any]]
"""Changes of keys of a case, by what they are called."""


def ready_list(name: str = OVER_TRACKS) -> str:
    """A study of what helps, as a commented text."""
    return packaged(f"case/{name}")


def listed_changes(name: str) -> NamedChanges:
    """Changes that a ready list names."""
    changes: NamedChanges = toml.read_toml(ready_list(name), "study", name)["sweep"]["variant"]
    return changes


READY_LISTS: Mapping[str, Callable[[], str]] = {
    "what-helps": ready_list,
    "what-helps-in-bearings": partial(ready_list, IN_BEARINGS),
    "what-helps-in-roller-bearings": partial(ready_list, IN_ROLLER_BEARINGS),
}
"""By the words of ``asperity new``."""
