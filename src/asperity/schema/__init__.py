"""What a result file holds: each variable and attribute once, for who writes it and for who draws it.

One module per group holds what all kinds of case share; what one kind adds stands in the module `schema`
of its folder. ``docs/result_file.md`` lists it all.
"""

from __future__ import annotations

from collections.abc import Iterator
from types import ModuleType

from asperity.schema.entry import Attribute, Entry, Values, entry, group, tree

VERSION = 2
"""Of the schema, in every result. Raise it where a name, dimension, unit or meaning changes or goes."""

__all__ = ["VERSION", "Attribute", "Entry", "Values", "contents_of", "entry", "group", "tree"]


def contents_of(*modules: ModuleType) -> tuple[list[Entry], list[Attribute]]:
    """Entries and attributes that modules define, in their order."""
    items = list(dict.fromkeys(item for module in modules for item in _items(module)))
    entries = [item for item in items if isinstance(item, Entry)]
    return entries, [item for item in items if isinstance(item, Attribute)]


def _items(module: ModuleType) -> Iterator[Entry | Attribute]:
    for value in vars(module).values():
        for item in value.values() if isinstance(value, dict) else (value,):
            if isinstance(item, Entry | Attribute):
                yield item
