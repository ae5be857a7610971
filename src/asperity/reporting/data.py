"""Looking into a result tree: what is there, or nothing; and its numbers in words."""

import colorsys
import json
import math
import re
from collections.abc import Callable, Iterable, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from typing import Any, TypeVar

import numpy as np
from xarray import DataArray, DataTree

from asperity.arguments import Array, Flags, shown
from asperity.errors import InputError
from asperity.reporting import chart
from asperity.schema import Attribute, Entry, bearing, provenance, rolling, spectra
from asperity.spectra import nominal, say_little
from asperity.units import quantity
from asperity.written_numbers import PREFIXES as PREFIXES
from asperity.written_numbers import SUPERSCRIPT, rounded
from asperity.written_numbers import between as between
from asperity.written_numbers import engineering as engineering
from asperity.written_numbers import plain as plain
from asperity.written_numbers import signed as signed

SOME = 64
"""Numbers among which a finite one is sought before it is among all."""

Made = TypeVar("Made")


class Missing(KeyError):
    """A result lacks what is asked for, or has nothing of it to show."""


def refuse_no_result(result: object) -> None:
    """Refuse what is no result of a run."""
    if not isinstance(result, DataTree):
        raise InputError("result", shown(result), "what asperity.run or asperity.open_result returned")


def unless_missing(make: Callable[[DataTree], Made | None], tree: DataTree) -> Made | None:
    """What is made of a result; None where this lacks what it takes."""
    with suppress(Missing):
        return make(tree)
    return None


def _is_stored(tree: DataTree, entry: Entry) -> bool:
    """Whether a result has the variable of an entry, with a finite number if it is one of numbers."""
    group = tree.children.get(entry.group)
    if group is None or (found := group.variables.get(entry.name)) is None:
        return False
    numbers = found.values.reshape(-1)
    is_of_words = numbers.dtype.kind not in "fiu"
    return is_of_words or bool(np.isfinite(numbers[:SOME]).any() or np.isfinite(numbers).any())


def stored_variable(tree: DataTree, entry: Entry) -> DataArray | None:
    """Variable of an entry, or None if it is missing or holds no finite number."""
    if not _is_stored(tree, entry):
        return None
    found: DataArray = tree.children[entry.group].dataset[entry.name]
    return found


def variable_of(tree: DataTree, entry: Entry) -> DataArray:
    """Variable of an entry, or `Missing`, its dimensions in the order of the schema."""
    found = stored_variable(tree, entry)
    if found is None:
        raise Missing(entry.path)
    return found.transpose(*entry.dims, missing_dims="ignore")


def values(tree: DataTree, entry: Entry) -> Array:
    """Numbers of an entry, which must exist."""
    return np.asarray(variable_of(tree, entry).values, dtype=float)


def words(tree: DataTree, entry: Entry) -> list[str]:
    """Words of a variable; none where it is missing."""
    found = stored_variable(tree, entry)
    return [] if found is None else [str(word) for word in found.values]


def present(tree: DataTree, *entries: Entry) -> bool:
    """Whether every one of `entries` is a variable with at least one finite number."""
    return all(_is_stored(tree, entry) for entry in entries)


def is_of_bearing(tree: DataTree) -> bool:
    """Whether a result is that of a ball bearing, whose contacts go round on their raceways."""
    return present(tree, bearing.BALL_LOAD)


def leave_to_bearing(tree: DataTree) -> None:
    """Leave out, as `Missing`, what is told of contacts on a path: a bearing has chapters of its own."""
    if is_of_bearing(tree):
        raise Missing(bearing.BALL_LOAD.path)


def missing(tree: DataTree, *entries: Entry) -> str:
    """Say of which of these variables values are missing, and why; nothing where none is."""
    found = [each for entry in entries if (each := stored_variable(tree, entry)) is not None]
    reasons: dict[str, list[str]] = {}
    for each in found:
        if "missing" in each.attrs:
            name = f"the {each.attrs['long_name'].replace(': ', ', ')}"
            reasons.setdefault(each.attrs["missing"], []).append(name)
    return " ".join(f"Gaps in {' and in '.join(names)}: {reason}." for reason, names in reasons.items())


def stated(tree: DataTree, attribute: Attribute) -> Any:
    """Value of an attribute, or None."""
    if attribute.group and attribute.group not in tree.children:
        return None
    return (tree[attribute.group] if attribute.group else tree).attrs.get(attribute.name)


def at_its_fastest(tree: DataTree) -> str:
    """Of which speed of the contacts frequencies are, where it changes in a run."""
    if not present(tree, rolling.TACHO):
        return ""
    fastest = number(tree, rolling.SPEED)
    changes = bool(np.ptp(values(tree, rolling.TACHO)))
    return f", at the fastest, {rounded(fastest, 5)} m/s" if changes and fastest else ""


def number(tree: DataTree, attribute: Attribute) -> float | None:
    """Finite number in an attribute, or None."""
    try:
        result = float(stated(tree, attribute))
    except (TypeError, ValueError):
        return None
    return result if math.isfinite(result) else None


def case_words(tree: DataTree, key: str) -> str:
    """Value of a key of the case in words; nothing where it is unknown."""
    parameters = json_list(tree, provenance.PARAMETERS)
    return str(next((item.get("value", "") for item in parameters if item.get("key") == key), ""))


def case_quantity(tree: DataTree, key: str, dimension: str) -> float | None:
    """Finite value of a key of the case in SI units, ``"m"`` or another, or None."""
    with suppress(InputError):
        found = quantity(case_words(tree, key), dimension)
        return found if math.isfinite(found) else None
    return None


def json_attribute(tree: DataTree, attribute: Attribute, empty: Any) -> Any:
    """JSON text in an attribute, decoded; `empty` if it is missing, damaged or of another kind."""
    try:
        found = json.loads(stated(tree, attribute))
    except (TypeError, ValueError):
        return empty
    return found if isinstance(found, type(empty)) else empty


def json_list(tree: DataTree, attribute: Attribute) -> list[dict[str, Any]]:
    """Entries of a list in an attribute, each a mapping; none if it is missing or damaged."""
    return [entry for entry in json_attribute(tree, attribute, []) if isinstance(entry, dict)]


def with_numbers(found: DataArray, dim: str) -> list[int]:
    """Places along a dimension at which a variable has finite numbers."""
    rest = [other for other in found.dims if other != dim]
    return [int(place) for place in np.flatnonzero(found.notnull().any(rest).values)]


def laws(tree: DataTree, entry: Entry) -> list[str]:
    """Laws that a variable has finite numbers for, in the order of the case, the main law first."""
    found = stored_variable(tree, entry)
    return [] if found is None else [str(found["law"].values[n]) for n in with_numbers(found, "law")]


def held_laws(tree: DataTree, entry: Entry) -> list[str]:
    """The same of a variable that must have numbers for one."""
    if found := laws(tree, entry):
        return found
    raise Missing(entry.path)


def main_law(tree: DataTree, entry: Entry) -> str:
    """The first law that a variable, which must exist, has finite numbers for."""
    return held_laws(tree, entry)[0]


def of_law(tree: DataTree, entry: Entry, law: str) -> Array:
    """Numbers of one law, at the first of several contacts, other dimensions in the order of the schema."""
    found = variable_of(tree, entry)
    row = [str(name) for name in found["law"].values].index(law)
    return np.asarray(
        found.isel({"law": row, rolling.CONTACT.name: 0}, missing_dims="ignore").values, dtype=float
    )


def of_contacts(tree: DataTree, entry: Entry, law: str) -> Array:
    """Numbers of one law at all contacts, these first (c, …)."""
    found = variable_of(tree, entry).sel(law=law)
    several = rolling.CONTACT.name in found.dims
    return np.asarray((found if several else found.expand_dims(rolling.CONTACT.name)).values, dtype=float)


def force_numbers(tree: DataTree, law: str) -> dict[str, float]:
    """Mean, rms and largest force of one law over all contacts, N, named as in `rolling.FORCES`.

    The rms is about the mean of each contact.
    """
    forces = of_contacts(tree, rolling.CONTACT_FORCE, law)
    mean = float(np.nanmean(np.nanmean(forces, axis=1)))
    rms = float(np.sqrt(np.nanmean(np.nanvar(forces, axis=1))))
    return dict(zip(rolling.FORCES, (mean, rms, float(np.nanmax(forces))), strict=True))


def loss_numbers(tree: DataTree, law: str) -> tuple[dict[str, float], int]:
    """Loss of contact of one law, named as in `rolling.LOSSES`, where it is lost longest, and that place."""
    losses = [of_contacts(tree, entry, law) for entry in rolling.LOSSES]
    worst = int(np.argmax(np.nan_to_num(losses[0], nan=-1.0)))
    names = (entry.name for entry in rolling.LOSSES)
    return dict(zip(names, (float(each[worst]) for each in losses), strict=True)), worst


def contact_numbers(tree: DataTree) -> dict[str, tuple[DataArray, str, str]]:
    """Numbers of the force and of its losses by law, their units, and what they are, of how many contacts."""
    count = _contacts_of(tree)
    every, worst = (f", of {count} contacts", ", where it is lost longest") if count > 1 else ("", "")
    told = {name: (rolling.CONTACT_FORCE, f"{what}{every}") for name, what in rolling.FORCES.items()}
    told |= {entry.name: (entry, f"{entry.long_name}{worst}") for entry in rolling.LOSSES}
    found = {law: force_numbers(tree, law) for law in laws(tree, rolling.CONTACT_FORCE)}
    lost = {law: loss_numbers(tree, law)[0] for law in laws(tree, rolling.CONTACT_LOSS_SHARE)}
    return {
        name: (_by_law(found if name in rolling.FORCES else lost, name), entry.units, what)
        for name, (entry, what) in told.items()
    }


def _by_law(numbers: Mapping[str, Mapping[str, float]], name: str) -> DataArray:
    return DataArray([each[name] for each in numbers.values()], {"law": list(numbers)}, "law")


def _contacts_of(tree: DataTree) -> int:
    return tree["rolling"].sizes.get(rolling.CONTACT.name, 1) if "rolling" in tree.children else 1


def of_first_contact(tree: DataTree) -> str:
    """Say of what is shown of the first of several contacts on a path that it is."""
    count = _contacts_of(tree)
    others = count > 1 and not is_of_bearing(tree)  # of which levels are those of all
    return f"Of contact 1 of {count}; the others are in the chapter All contacts." if others else ""


def doubtful(tree: DataTree, product: Entry) -> Flags:
    """Bands whose levels say little: the `product` of bandwidth and averaging time is small.

    Of force levels also those that still hold the start of the record.
    """
    (dim,) = product.dims
    if not present(tree, product):
        return np.zeros(tree[product.group].sizes[dim], dtype=bool)
    known = product is spectra.BAND_TIME_PRODUCT and present(tree, spectra.START_SHARE)
    start = values(tree, spectra.START_SHARE) if known else 0.0
    return say_little(values(tree, product), start)


# --- numbers in words


def in_percent(share: float) -> str:
    """Write a share in per cent."""
    return f"{100 * share:.1f} %" if share >= 0.01 or share == 0 else f"{rounded(100 * share, 2)} %"


def written_units(units: str) -> str:
    """Units of a variable as a reader writes them."""
    return units.replace("uPa", "µPa").replace("m/s2", "m/s²").replace("1e-6 m", "1 µm")


def length_unit(extent: float) -> tuple[float, str]:
    """Unit in which a length of `extent` m reads well: its size in m and its symbol."""
    for size, symbol in ((1.0, "m"), (1e-3, "mm"), (1e-6, "µm")):
        if extent >= 0.5 * size:
            return size, symbol
    return 1e-9, "nm"


def force_unit(largest: float) -> tuple[float, str]:
    """Unit in which forces up to `largest` N read well: its size in N and its symbol."""
    return (1e3, "kN") if largest >= 5e3 else (1.0, "N")


PREFIXED = ("m", "N", "N/m", "Pa", "s", "Hz", "W", "J", "m/s")
"""Units before which a prefix is read."""


def unit_of_quantity(name: str, units: str, numbers: Array) -> tuple[float, str]:
    """Unit in which a quantity of a study reads well: its size in SI, and its symbol, empty of a count."""
    if units == "1":
        return (0.01, "%") if name.endswith("share") else (1.0, "")
    largest = float(np.max(np.abs(numbers), initial=0.0, where=np.isfinite(numbers)))
    if units not in PREFIXED or not largest:
        return 1.0, written_units(units)
    power = min(max(3 * math.floor(math.log10(largest) / 3), -9), 9)
    return 10.0**power, f"{PREFIXES[power]}{units}"


def time_unit(duration: float) -> tuple[float, str]:
    """Unit in which a time of `duration` s reads well: its size in s and its symbol."""
    return (1.0, "s") if duration >= 0.5 else (1e-3, "ms")


def power_of_ten(value: float) -> str:
    """Write a power of ten with superscripts: ``"10⁻¹⁶"``."""
    return "10" + str(round(math.log10(value))).translate(SUPERSCRIPT)


def nominal_band(centre: float) -> str:
    """Nominal name of the one-third octave with the exact `centre` in Hz (IEC 61260-1), as ``"31.5"``."""
    name = nominal(centre)
    return f"{name / 1000:g}k" if name >= 1000 else f"{name:g}"


TYPED_UNIT = "typed_unit"
"""Attribute of a coordinate: the unit in which the values of a swept key were written, where it is no SI."""
TYPED_FACTOR = "typed_factor"
"""The same unit in SI."""


def typed_unit(key: DataArray) -> str:
    """Unit of a swept key as it was typed; empty for words."""
    return "" if key.dtype.kind == "U" else str(key.attrs.get(TYPED_UNIT, key.attrs["units"]))


def typed_values(key: DataArray) -> list[Any]:
    """Values of a swept key in the unit in which they were typed."""
    size = float(key.attrs.get(TYPED_FACTOR, 1.0))
    found: list[Any] = key.values.tolist()
    return found if key.dtype.kind == "U" or size == 1.0 else [float(f"{v / size:.12g}") for v in found]


def typed_words(key: DataArray) -> list[str]:
    """Values of a swept key in words, each with its unit: ``"50 km/h"``."""
    unit = typed_unit(key).removesuffix("1")
    values = typed_values(key)
    numbers = [value for value in values if not isinstance(value, str)]
    digits = next((n for n in (4, 5) if len({_whole(v, n) for v in numbers}) == len(set(numbers))), 6)
    return [v if isinstance(v, str) else f"{_whole(v, digits)} {unit}".strip() for v in values]


def _whole(value: float, digits: int) -> str:
    """Write a number with so many digits, and with all that stand before the point."""
    return rounded(value, max(digits, len(f"{abs(value):.0f}")))


def moment(instant: object) -> str:
    """A moment of ISO 8601 in universal time as people write it; other words as they are."""
    found = re.fullmatch(r"(\d{4}-\d\d-\d\d)T(\d\d:\d\d):\d\d\+00:00", str(instant or ""))
    return f"{found[1]}, {found[2]} UTC" if found else str(instant or "")


# --- laws: their look, whether they may pull, what they are to each other

_MARKERS = "os^v<>DdPXpHh8*"
_LIGHT = 0.68
"""Least lightness of a law's colour on dark screens."""


@dataclass(frozen=True)
class LawEntry:
    """A law as a result describes it; one that it does not describe looks like this."""

    name: str
    meaning: str = ""
    colour: str = "#6f7a85"
    dashes: chart.Dashes = (4, 1, 1, 1, 1, 1)
    marker: str = "<"
    may_pull: bool = False
    needs: frozenset[str] = frozenset()
    role: str = ""

    def style(self, width: float) -> dict[str, Any]:
        """Look of a line, as `chart.Line` takes it."""
        return {"colour": self.colour, "dashes": self.dashes, "width": width, "law": self.name}


def law_entries(tree: DataTree) -> dict[str, LawEntry]:
    """Laws that the result describes, by name, in the order of the case."""
    return read_entries(json_list(tree, provenance.LAWS))


def read_entries(told: Iterable[Mapping[str, Any]]) -> dict[str, LawEntry]:
    """Laws by name with what of them can be drawn; no two have the same colour."""
    entries = list(map(_read, told))
    taken: set[str] = set()
    spare = iter([colour for colour in chart.LAW_COLOURS if colour not in {e.colour for e in entries}])
    for n, entry in enumerate(entries):
        if entry.colour in taken:
            entries[n] = replace(entry, colour=next(spare, entry.colour))
        taken.add(entry.colour)
    return {entry.name: entry for entry in entries}


def _read(told: Mapping[str, Any]) -> LawEntry:
    """An entry with what of it can be drawn: a result may be anybody's."""
    found: dict[str, Any] = {key: str(told.get(key, "")) for key in ("name", "meaning", "role")}
    colour, marker, needs = (told.get(key) for key in ("colour", "marker", "needs"))
    if isinstance(colour, str) and re.fullmatch("#[0-9a-f]{6}", colour):
        found["colour"] = colour
    if isinstance(marker, str) and len(marker) == 1 and marker in _MARKERS:
        found["marker"] = marker
    if isinstance(needs, list):
        found["needs"] = frozenset(map(str, needs))
    match told.get("dashes"):
        case "-":
            found["dashes"] = ()
        case [int() | float(), [*lengths]] if lengths and all(map(_is_length, lengths)):
            found["dashes"] = tuple(map(float, lengths))
    return LawEntry(**found, may_pull=told.get("may_pull") is True)


def _is_length(length: Any) -> bool:
    return isinstance(length, int | float) and 0 < length < 1e3


def law_entry(tree: DataTree, law: str) -> LawEntry:
    """Look up a law, described or not."""
    return law_entries(tree).get(law, LawEntry(law))


def law_style(tree: DataTree, law: str, main: str) -> dict[str, Any]:
    """Look of a line of a law, as `chart.Line` takes it; the main law is drawn thicker."""
    return law_entry(tree, law).style(2.2 if law == main else 1.25)


def law_colours(tree: DataTree) -> dict[str, str]:
    """All colours of a page, light and dark: those of the style, and those of laws that bring their own."""
    return page_colours(entry.colour for entry in law_entries(tree).values())


def page_colours(colours: Iterable[str]) -> dict[str, str]:
    """Colours of the style and others, light and dark."""
    return chart.COLOURS | {colour: _on_dark(colour) for colour in colours if colour not in chart.COLOURS}


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
    return [roles[role] for role in spectra.FORCE_LEVEL_DIFFERENCES if role in roles]


def unticked_laws(tree: DataTree) -> list[str]:
    """Laws that a page shows once they are ticked: all but the main one and that of practice.

    None where that of practice is the main one, or was not rolled.
    """
    entries = list(law_entries(tree).values())
    practice = {entry.name for entry in entries if entry.role == spectra.PRACTICE}
    if not practice or entries[0].name in practice:
        return []
    return [entry.name for entry in entries[1:] if entry.name not in practice]


def differences(tree: DataTree) -> dict[Entry, str]:
    """Variables of force level differences to the linear laws, with the law each compares with."""
    of_role = {entry.role: entry.name for entry in law_entries(tree).values()}
    held = {role: entry for role, entry in spectra.FORCE_LEVEL_DIFFERENCES.items() if present(tree, entry)}
    return {entry: of_role[role] for role, entry in held.items() if role in of_role}
