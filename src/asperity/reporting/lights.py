"""A light for each validity check: what was compared with which limit, in a word, a shape and a colour."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from xarray import DataTree

from asperity.reporting.convergence import OFF, setting_names, setting_numbers
from asperity.reporting.data import json_attribute, json_list, laws
from asperity.schema import contact, convergence, provenance
from asperity.schema.rolling import CONTACT_FORCE

IN_RANGE, NOTE, WARNING, OUT, UNKNOWN = "in range", "note", "warning", "out of range", "not checked"
_LOOKS = {
    IN_RANGE: ("good", "●"),
    NOTE: ("note", "●"),
    WARNING: ("warn", "▲"),
    OUT: ("out", "■"),
    UNKNOWN: ("none", "○"),
}


@dataclass(frozen=True)
class Light:
    """A check: the quantity, its number, the limit that this is compared with, and how it ended."""

    quantity: str
    value: str
    limit: str
    state: str  # one of the words above

    @property
    def look(self) -> str:
        """Class of its look."""
        return _LOOKS[self.state][0]

    @property
    def shape(self) -> str:
        """Sign that differs between the states without colour."""
        return _LOOKS[self.state][1]


def lights(tree: DataTree) -> list[Light]:
    """All checks of a run, those that failed first."""
    order = [OUT, WARNING, NOTE, UNKNOWN, IN_RANGE]
    found = [*_findings(tree), *_expected(tree), *_settings(tree)]
    return sorted(found, key=lambda light: order.index(light.state))


def counted(found: list[Light]) -> str:
    """Say how many checks ended how, as ``"8 of 9 checks in range, 1 warning"``."""
    states = [light.state for light in found]
    checked = len(states) - states.count(UNKNOWN)
    told = [f"{states.count(IN_RANGE)} of {checked} checks in range"]
    words = {OUT: "{} out of range", WARNING: "{} warning{s}", NOTE: "{} note{s}", UNKNOWN: "{} not checked"}
    for state, text in words.items():
        if count := states.count(state):
            told.append(text.format(count, s="" if count == 1 else "s"))
    return ", ".join(told)


def _findings(tree: DataTree) -> Iterator[Light]:
    for entry in json_list(tree, contact.VALIDITY):
        quantity, value, limit, grade = (
            str(entry.get(key, "")) for key in ("quantity", "value", "limit", "grade")
        )
        yield Light(quantity, value, limit, grade if grade in _LOOKS else IN_RANGE)


def _expected(tree: DataTree) -> Iterator[Light]:
    """The error that is expected of the main law."""
    main = next(iter(laws(tree, CONTACT_FORCE)), None)
    found = json_attribute(tree, provenance.EXPECTED_ERRORS, {})
    error = next((e for e in found.get("errors", []) if e["law"] == main), None)
    if error is None:
        return
    wanted, far = float(found["wanted"]), bool(found["off_map"])
    value = f"{error['error']:.1f} dB ({error['low']:.1f} to {error['high']:.1f})"
    state = IN_RANGE if error["high"] <= wanted else WARNING if error["error"] > wanted else NOTE
    quantity = f"expected distance of {main} from direct, rms over the one-third octaves"
    guess = ": a guess, off the map of law errors" if far else ""
    yield Light(quantity, value + guess, f"up to {wanted:g} dB", NOTE if far and state == IN_RANGE else state)


def _settings(tree: DataTree) -> Iterator[Light]:
    """What finer settings changed."""
    names, limit = setting_names(tree), f"up to {OFF:g} dB"
    if not names:
        yield Light("change of levels by finer settings", "not known: run with --converge", limit, UNKNOWN)
        return
    sizes = dict(zip(names, setting_numbers(tree, convergence.LARGEST_CHANGE).tolist(), strict=True))
    chance = sizes.get(convergence.PATH_LENGTH, np.nan)
    for name, size in sizes.items():
        if name == convergence.PATH_LENGTH:
            continue  # chance, not a setting
        quantity = f"change of levels by a finer setting: {name}"
        if not np.isfinite(size):
            yield Light(quantity, "not changed", limit, UNKNOWN)
        else:
            far = OUT if convergence.meaningless(size, chance) else WARNING
            yield Light(quantity, f"{size:.2f} dB", limit, IN_RANGE if size <= OFF else far)
