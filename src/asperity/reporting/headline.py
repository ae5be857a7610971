"""The first screen of a page: what the reader asked, in numbers, and one light for validity."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from xarray import DataTree

from asperity.arguments import Array
from asperity.reporting import data
from asperity.reporting.tables import OFF, ReportTable, error_on_map, setting_names, setting_numbers
from asperity.schema import contact, convergence, provenance, rolling
from asperity.spectra import energy_of, nominal_frequency
from asperity.written_numbers import capital

IN_RANGE = "in range"
NOTE = "note"
WARNING = "warning"
OUT = "out of range"
UNKNOWN = "not checked"
_LOOKS = {
    OUT: ("out", "■", "Out of range"),
    WARNING: ("warn", "▲", "To be read with care"),
    NOTE: ("note", "●", "Valid"),
    UNKNOWN: ("none", "○", "Not checked"),
    IN_RANGE: ("good", "●", "Valid"),
}
"""Class and sign of a check that ended so, and what is said of a run; the gravest first."""
_TOLD = (OUT, WARNING, NOTE, IN_RANGE, UNKNOWN)


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
    return sorted([*_warnings(tree, checks), *checks], key=lambda light: list(_LOOKS).index(light.state))


def validity(found: Sequence[Light]) -> Light:
    """All checks and warnings in one light, whose quantity is a sentence."""
    states = [light.state for light in found]
    checked = len(states) - states.count(UNKNOWN)
    told = [_counted(state, states.count(state), checked) for state in _TOLD if state in states]
    worst = next((state for state in _TOLD if state in states), UNKNOWN)
    words = ", ".join(told) or "nothing was stored with this run"
    return Light(f"{_LOOKS[worst][2]}: {words}.", "", "", IN_RANGE if worst == NOTE else worst)


def _counted(state: str, count: int, checked: int) -> str:
    """Say how many checks ended so, of those that were made."""
    if state == IN_RANGE:
        share = f"all {count}" if count == checked else f"{count} of {checked}"
        return f"{share} checks in range" if checked > 1 else "the one check in range"
    return f"{count} {state}{'s' if count > 1 and state in (NOTE, WARNING) else ''}"


def _findings(tree: DataTree) -> Iterator[Light]:
    for entry in data.json_list(tree, contact.VALIDITY):
        quantity, value, limit, grade, meaning, remedy = (
            str(entry.get(key, "")) for key in ("quantity", "value", "limit", "grade", "meaning", "remedy")
        )
        outside = grade in _LOOKS
        told = f"{meaning} {remedy}".strip() if outside else ""
        yield Light(quantity, value, limit, grade if outside else IN_RANGE, told)


def _warnings(tree: DataTree, checks: Sequence[Light]) -> Iterator[Light]:
    """Warnings on the physics, but for those that a check says as well."""
    for warning in data.json_list(tree, provenance.WARNINGS):
        message = str(warning.get("message", ""))
        grade = str(warning.get("grade", WARNING))
        if not any(
            check.value and message.startswith(f"{check.quantity}: {check.value}") for check in checks
        ):
            times = f"{count} times" if (count := warning.get("count", 1)) != 1 else ""
            yield Light(capital(message), times, "", grade if grade in _LOOKS else WARNING)


def _expected(tree: DataTree) -> Iterator[Light]:
    """The error that is expected of the main law."""
    main = next(iter(data.laws(tree, rolling.CONTACT_FORCE)), None)
    if expected := error_on_map(tree, main):
        error, value, found = expected
        wanted = float(found["wanted"])
        far = bool(found["off_map"])
        state = IN_RANGE if error["high"] <= wanted else WARNING if error["error"] > wanted else NOTE
        quantity = f"expected distance of {main} from direct, rms over the one-third octaves"
        guess = ": a guess, off the map of law errors" if far else ""
        state = NOTE if far and state == IN_RANGE else state
        yield Light(quantity, value + guess, f"up to {wanted:g} dB", state)


def _settings(tree: DataTree) -> Iterator[Light]:
    """What finer settings changed."""
    names = setting_names(tree)
    limit = f"up to {OFF:g} dB"
    if not names:
        yield Light("change of levels by finer settings", "not known: run with --converge", limit, UNKNOWN)
    sizes = dict(zip(names, setting_numbers(tree, convergence.LARGEST_CHANGE).tolist(), strict=True))
    chance = sizes.pop(convergence.PATH_LENGTH, np.nan)  # no setting
    for name, size in sizes.items():
        value = "not changed"
        state = UNKNOWN
        if np.isfinite(size):
            far = OUT if convergence.meaningless(size, chance) else WARNING
            value = f"{size:.2f} dB"
            state = IN_RANGE if size <= OFF else far
        yield Light(f"change of levels by a finer setting: {name}", value, limit, state)


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


def force_answers(tree: DataTree) -> Answers:
    """Force of the main law at all contacts, and its losses of contact."""
    data.leave_to_bearing(tree)
    main = data.main_law(tree, rolling.CONTACT_FORCE)
    forces = data.of_contacts(tree, rolling.CONTACT_FORCE, main)
    count = len(forces)
    largest = np.nanmax(forces, axis=1)
    mean, rms, _ = data.force_numbers(tree, main).values()
    rms *= bool(np.ptp(forces, axis=1).any())  # of what does not vary, the mean is rounded
    top = data.engineering(float(largest.max()), "N") + _at_contact(int(largest.argmax()), count)
    whose = "its" if count == 1 else "their"
    share = ""
    if mean > 0:
        share = f"{data.in_percent(rms / mean)} of {whose} mean of {data.engineering(mean, 'N')}; "
    varies = data.engineering(rms, "N")
    what = "contact force varies" if count == 1 else f"forces of {count} contacts vary"
    dynamic = HeadlineNumber(f"{what} by, rms", varies, f"{share}at most {top}")
    return Answers(numbers=(dynamic, *_loss(tree, main)))


def _at_contact(place: int, count: int) -> str:
    """Name a contact where there are several."""
    return f" at contact {place + 1}" if count > 1 else ""


def _loss(tree: DataTree, main: str) -> Iterator[HeadlineNumber]:
    """Loss of contact, of several contacts at that which is lost longest."""
    if main not in data.laws(tree, rolling.CONTACT_LOSS_SHARE):
        return
    found, worst = data.loss_numbers(tree, main)
    share, events, longest = found.values()
    lost = "once" if events == 1 else f"{events:.0f} times"
    value = data.in_percent(share)
    told = f"lost {lost}, longest {data.engineering(longest, 's')}"
    told += _at_contact(worst, tree["rolling"].sizes.get(rolling.CONTACT.name, 1))
    if data.law_entry(tree, main).may_pull:
        value = "–"
        told = f"{main} cannot lose it: its force may pull"
    elif not share:
        value = "0 %"
        told = "contact is never lost"
    yield HeadlineNumber("time without contact", value, told)


def deciding_bands(bands: Array, level: Array) -> str:
    """The fewest one-third octaves (b,), Hz, that hold half the energy of levels (b,), dB, in words.

    As ``"the band of 1.6 kHz"``, ``"the bands of 500 Hz and 800 Hz to 1.25 kHz"``.
    """
    energy = np.nan_to_num(energy_of(level))
    loudest = np.argsort(-energy, kind="stable")
    held = np.cumsum(energy[loudest])
    kept = np.sort(loudest[: 1 + int(np.searchsorted(held, MOST * held[-1]))])
    runs = np.split(kept, np.flatnonzero(np.diff(kept) > 1) + 1)
    ends = [dict.fromkeys(nominal_frequency(float(bands[i])) for i in (run[0], run[-1])) for run in runs]
    words = [" to ".join(each) for each in ends]
    listed = " and ".join(filter(None, [", ".join(words[:-1]), words[-1]]))
    return f"the {'band' if kept.size == 1 else 'bands'} of {listed}"
