"""The first screen of a page: what the reader asked, in numbers, and one light for validity."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from xarray import DataTree

from asperity.reporting.data import engineering, json_attribute, json_list, laws, of_law, present
from asperity.reporting.law_entries import law_entry
from asperity.reporting.tables import ReportTable, in_percent
from asperity.reporting.uncertainty import OFF, setting_names, setting_numbers
from asperity.schema import contact, convergence, provenance, rolling
from asperity.schema.rolling import CONTACT_FORCE
from asperity.spectra import nominal_frequency

IN_RANGE, NOTE, WARNING, OUT, UNKNOWN = "in range", "note", "warning", "out of range", "not checked"
_LOOKS = {
    IN_RANGE: ("good", "●"),
    NOTE: ("note", "●"),
    WARNING: ("warn", "▲"),
    OUT: ("out", "■"),
    UNKNOWN: ("none", "○"),
}
_ORDER = (OUT, WARNING, NOTE, UNKNOWN, IN_RANGE)
_TOLD = (OUT, WARNING, NOTE, IN_RANGE, UNKNOWN)
_JUDGED = {
    OUT: "Out of range",
    WARNING: "To be read with care",
    NOTE: "Valid",
    IN_RANGE: "Valid",
    UNKNOWN: "Not checked",
}


@dataclass(frozen=True)
class Light:
    """A check or a warning: what it is about, its number, the limit of this, and how it ended."""

    quantity: str
    value: str
    limit: str
    state: str  # one of the words above
    meaning: str = ""  # of being outside, and what to do

    @property
    def look(self) -> str:
        """Class of its look."""
        return _LOOKS[self.state][0]

    @property
    def shape(self) -> str:
        """Sign that differs between the states without colour."""
        return _LOOKS[self.state][1]


def lights(tree: DataTree) -> list[Light]:
    """All checks and warnings of a run, those that failed first."""
    checks = [*_findings(tree), *_expected(tree), *_settings(tree)]
    found = [*_warnings(tree, checks), *checks]
    return sorted(found, key=lambda light: _ORDER.index(light.state))


def validity(found: Sequence[Light]) -> Light:
    """All checks and warnings in one light, whose quantity is a sentence."""
    states = [light.state for light in found]
    counts = {state: states.count(state) for state in _ORDER}
    worst = next((state for state in _TOLD if counts[state]), UNKNOWN)
    checked = len(states) - counts[UNKNOWN]
    told = [_counted(state, counts[state], checked) for state in _TOLD if counts[state]]
    words = ", ".join(told) or "nothing was stored with this run"
    return Light(f"{_JUDGED[worst]}: {words}.", "", "", IN_RANGE if worst == NOTE else worst)


def _counted(state: str, count: int, checked: int) -> str:
    """Say how many checks ended so, of those that were made."""
    if state == IN_RANGE:
        share = f"all {count}" if count == checked else f"{count} of {checked}"
        return f"{share} checks in range" if checked > 1 else "the one check in range"
    return f"{count} {state}{'s' if count > 1 and state in (NOTE, WARNING) else ''}"


def _findings(tree: DataTree) -> Iterator[Light]:
    for entry in json_list(tree, contact.VALIDITY):
        quantity, value, limit, grade, meaning, remedy = (
            str(entry.get(key, "")) for key in ("quantity", "value", "limit", "grade", "meaning", "remedy")
        )
        outside = grade in _LOOKS
        state = grade if outside else IN_RANGE
        yield Light(quantity, value, limit, state, f"{meaning} {remedy}".strip() if outside else "")


def _warnings(tree: DataTree, checks: Sequence[Light]) -> Iterator[Light]:
    """Warnings on the physics, but for those that a check says as well."""
    for warning in json_list(tree, provenance.WARNINGS):
        message, grade = str(warning.get("message", "")), str(warning.get("grade", WARNING))
        if any(check.value and message.startswith(f"{check.quantity}: {check.value}") for check in checks):
            continue
        times = f"{count} times" if (count := warning.get("count", 1)) != 1 else ""
        yield Light(message[:1].upper() + message[1:], times, "", grade if grade in _LOOKS else WARNING)


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


MOST = 0.5
"""Share of the energy that deciding bands hold."""


@dataclass(frozen=True)
class HeadlineNumber:
    """A number at the top of the page: what it is, the number with its unit, and what to read beside it."""

    name: str
    value: str
    note: str


@dataclass(frozen=True)
class Answers:
    """What a chapter says at the top of the page."""

    lead: str = ""  # a sentence: what decides
    more: str = ""  # sentences beside it
    numbers: tuple[HeadlineNumber, ...] = ()
    tables: tuple[ReportTable, ...] = ()


def force_answers(tree: DataTree) -> Answers | None:
    """Force of the main law, and its losses of contact."""
    if not present(tree, rolling.CONTACT_FORCE):
        return None
    main = laws(tree, rolling.CONTACT_FORCE)[0]
    force = of_law(tree, rolling.CONTACT_FORCE, main, "time")
    lost = _loss(tree, main)
    return Answers(numbers=(_dynamic(force), *([lost] if lost else [])))


def _dynamic(force: NDArray[np.float64]) -> HeadlineNumber:
    mean, rms = float(np.nanmean(force)), float(np.nanstd(force))
    share = f"{in_percent(rms / mean)} of its mean of {engineering(mean, 'N')}; " if mean > 0 else ""
    top = engineering(float(np.nanmax(force)), "N")
    return HeadlineNumber("contact force varies by, rms", engineering(rms, "N"), f"{share}at most {top}")


def _loss(tree: DataTree, main: str) -> HeadlineNumber | None:
    if main not in laws(tree, rolling.CONTACT_LOSS_SHARE):
        return None
    if law_entry(tree, main).may_pull:
        return HeadlineNumber("time without contact", "–", f"{main} cannot lose it: its force may pull")
    share = float(of_law(tree, rolling.CONTACT_LOSS_SHARE, main))
    if not share:
        return HeadlineNumber("time without contact", "0 %", "contact is never lost")
    told = []
    if present(tree, rolling.CONTACT_LOSS_EVENTS):
        count = int(of_law(tree, rolling.CONTACT_LOSS_EVENTS, main))
        told.append(f"lost {'once' if count == 1 else f'{count} times'}")
    if present(tree, rolling.LONGEST_LOSS):
        told.append(f"longest {engineering(float(of_law(tree, rolling.LONGEST_LOSS, main)), 's')}")
    return HeadlineNumber("time without contact", in_percent(share), ", ".join(told))


def deciding_bands(bands: NDArray[np.float64], level: NDArray[np.float64]) -> str:
    """The fewest one-third octaves (b,), Hz, that hold half the energy of levels (b,), dB, in words."""
    energy = np.nan_to_num(10.0 ** (level / 10.0))
    loudest = np.argsort(-energy, kind="stable")
    held = np.cumsum(energy[loudest])
    kept = np.sort(loudest[: 1 + int(np.searchsorted(held, MOST * held[-1]))])
    runs = np.split(kept, np.flatnonzero(np.diff(kept) > 1) + 1)
    ends = [
        list(dict.fromkeys(nominal_frequency(float(bands[i])) for i in (run[0], run[-1]))) for run in runs
    ]
    return _listed([" to ".join(each) for each in ends])


def _listed(words: list[str]) -> str:
    """Words as a sentence lists them."""
    return " and ".join(filter(None, [", ".join(words[:-1]), words[-1]]))
