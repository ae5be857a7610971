"""What a result says of its laws: their look, whether they may pull, what they are to each other."""

from __future__ import annotations

import colorsys
import re
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

from xarray import DataTree

from asperity.reporting.chart import COLOURS, LAW_COLOURS, Dashes
from asperity.reporting.data import json_list, present
from asperity.schema import Entry, provenance
from asperity.schema.spectra import FORCE_LEVEL_DIFFERENCES

_MARKERS = "os^v<>DdPXpHh8*"
_LIGHT = 0.68
"""Least lightness of a law's colour on dark screens."""


@dataclass(frozen=True)
class LawEntry:
    """A law as a result describes it; one that it does not describe looks like this."""

    name: str
    meaning: str = ""
    colour: str = "#6f7a85"
    dashes: Dashes = (4, 1, 1, 1, 1, 1)
    marker: str = "<"
    may_pull: bool = False
    needs: frozenset[str] = frozenset()
    role: str = ""


def law_entries(tree: DataTree) -> dict[str, LawEntry]:
    """Laws that the result describes, by name, in the order of the case."""
    return read_entries(json_list(tree, provenance.LAWS))


def read_entries(told: Iterable[Mapping[str, Any]]) -> dict[str, LawEntry]:
    """Laws by name with what of them can be drawn; no two have the same colour."""
    entries = list(map(_read, told))
    taken: set[str] = set()
    spare = iter([colour for colour in LAW_COLOURS if colour not in {entry.colour for entry in entries}])
    for n, entry in enumerate(entries):
        if entry.colour in taken:
            entries[n] = replace(entry, colour=next(spare, entry.colour))
        taken.add(entry.colour)
    return {entry.name: entry for entry in entries}


def _read(entry: Mapping[str, Any]) -> LawEntry:
    """An entry with what of it can be drawn."""
    usual, name = LawEntry(""), str(entry.get("name", ""))
    colour, dashes, marker = (entry.get(key) for key in ("colour", "dashes", "marker"))
    needs = entry.get("needs")
    return LawEntry(
        name,
        str(entry.get("meaning", "")),
        colour if isinstance(colour, str) and re.fullmatch("#[0-9a-f]{6}", colour) else usual.colour,
        usual.dashes if (found := _dashes(dashes)) is None else found,
        marker if isinstance(marker, str) and len(marker) == 1 and marker in _MARKERS else usual.marker,
        entry.get("may_pull") is True,
        frozenset(map(str, needs)) if isinstance(needs, list) else usual.needs,
        str(entry.get("role", "")),
    )


def _dashes(dashes: Any) -> Dashes | None:
    """Dashes of JSON, whose pairs are lists."""
    match dashes:
        case "-":
            return ()
        case [int() | float(), [*lengths]] if lengths and all(_is_length(n) for n in lengths):
            return tuple(map(float, lengths))
        case _:
            return None


def _is_length(number: Any) -> bool:
    return isinstance(number, int | float) and 0 < number < 1e3


def law_entry(tree: DataTree, law: str) -> LawEntry:
    """Look up a law, described or not."""
    return law_entries(tree).get(law, LawEntry(law))


def law_style(tree: DataTree, law: str, main: str) -> dict[str, Any]:
    """Look of a line of a law, as `chart.Line` takes it; the main law is drawn thicker."""
    return line_style(law_entry(tree, law), 2.2 if law == main else 1.25)


def line_style(entry: LawEntry, width: float) -> dict[str, Any]:
    """Look of a line, as `chart.Line` takes it."""
    return {"colour": entry.colour, "dashes": entry.dashes, "width": width, "law": entry.name}


def law_colours(tree: DataTree) -> dict[str, str]:
    """All colours of a page, light and dark: those of the style, and those of laws that bring their own."""
    return page_colours(entry.colour for entry in law_entries(tree).values())


def page_colours(colours: Iterable[str]) -> dict[str, str]:
    """Colours of the style and others, light and dark."""
    return COLOURS | {colour: _on_dark(colour) for colour in colours if colour not in COLOURS}


def _on_dark(colour: str) -> str:
    """The same hue, light enough for a dark screen."""
    hue, light, saturation = colorsys.rgb_to_hls(*(int(colour[i : i + 2], 16) / 255 for i in (1, 3, 5)))
    rgb = colorsys.hls_to_rgb(hue, max(light, _LIGHT), saturation)
    return "#" + "".join(f"{round(255 * part):02x}" for part in rgb)


def pulling(tree: DataTree) -> list[str]:
    """Laws whose contact pulls as well as it pushes, so that it cannot be lost."""
    return [name for name, entry in law_entries(tree).items() if entry.may_pull]


def baselines_among(tree: DataTree, names: Sequence[str]) -> list[str]:
    """Those of the laws `names` that all others are compared with, the one of practice first."""
    roles = {law_entry(tree, name).role: name for name in names}
    return [roles[role] for role in FORCE_LEVEL_DIFFERENCES if role in roles]


def differences(tree: DataTree) -> dict[Entry, str]:
    """Variables of force level differences to the linear laws, with the law each compares with."""
    laws = {entry.role: entry.name for entry in law_entries(tree).values()}
    held = {role: entry for role, entry in FORCE_LEVEL_DIFFERENCES.items() if present(tree, entry)}
    return {entry: laws[role] for role, entry in held.items() if role in laws}
