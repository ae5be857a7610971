"""What a study computes: one case, and lists or ranges of values for some of its keys."""

import json
import math
import re
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from functools import lru_cache
from pathlib import Path
from typing import Any

import numpy as np

from asperity.arguments import FilePath, require, shown
from asperity.case import cases, form, toml
from asperity.case.any_case import AnyCase, entry_of
from asperity.case.form import case_key, content, file_digest
from asperity.errors import CaseError, InputError
from asperity.parameters import Origin
from asperity.studies.axes import VARIANT, SweptAxis, VariantAxis, as_in_toml, flat, variant_axis, written_out
from asperity.studies.draws import Draw, drawn_values
from asperity.written_numbers import NUMBER, count_of

_RANGE = re.compile(
    rf"\s*({NUMBER})\s*\.\.\s*({NUMBER})\s*((?:1/)?[^\d\s,][^,]{{0,40}})?(?:,\s*(\d{{1,5}})\s*(steps|ratios))?\s*"
)
_BETWEEN = re.compile(r",(?!\s*\d+\s*(?:steps|ratios)\s*(?:,|$))")
"""Commas between the values of a list, but for that before the number of steps."""
_WITH_UNIT = re.compile(rf"(?>{NUMBER})\s*((?:1/)?[^\d\s.,][^.,]*)")
MOST_VALUES = 10_000


def separated(values: str) -> list[str]:
    """Values that commas separate, each range one of them; bare numbers have the unit of the last value."""
    *before, last = (each.strip() for each in _BETWEEN.split(values))
    unit = _WITH_UNIT.fullmatch(last)
    if unit and all(re.fullmatch(NUMBER, each) for each in before):
        before = [f"{each} {unit[1]}" for each in before]
    return [*before, last]


def expanded(what: str, values: object) -> object:
    """The values of a key, each range among them written out; what is neither text nor a list stays.

    From the first to the last value: ``steps`` counts values that are equally far apart, ``ratios`` values of
    which each is as many times the one before. Without them every whole number is a value.
    """
    if isinstance(values, str) and _RANGE.fullmatch(values):
        values = [values]
    if not isinstance(values, list | tuple):
        return values
    return [one for value in values for one in _values(what, value)]


def _values(what: str, value: Any) -> list[Any]:
    match = _RANGE.fullmatch(value) if isinstance(value, str) else None
    if match is None:
        return [value]
    low = float(match[1])
    high = float(match[2])
    unit = (match[3] or "").strip()
    numbers = _numbers(what, value, low, high, match[4], match[5], unit)
    bare = [int(number) if number == int(number) else number for number in numbers]
    return [f"{number} {unit}" for number in bare] if unit else bare


def _numbers(
    what: str, value: str, low: float, high: float, count: str | None, way: str | None, unit: str
) -> list[float]:
    given = shown(value)
    require(math.isfinite(high - low), what, given, "ends that a computer can hold")
    if count is None:
        whole = not unit and low == int(low) and high == int(high) and low < high < low + MOST_VALUES
        remedy = f"Say how many, as '{value.strip()}, 6 steps', or 6 ratios."
        require(whole, what, given, "a range with its number of values", remedy)
        return np.arange(low, high + 1.0).tolist()
    allowed = f"two different ends and 2 to {MOST_VALUES} values"
    remedy = "Both ends count: the least is 2 steps."
    require(2 <= int(count) <= MOST_VALUES and low != high, what, given, allowed, remedy)
    if way == "steps":
        found = np.linspace(low, high, int(count))
    else:
        require(low * high > 0.0, what, given, "ends above zero for equal ratios", "Write steps instead.")
        found = np.geomspace(low, high, int(count))
    return [float(f"{number:.10g}") for number in found]


MOST_MEMBERS = 10_000
MOST_KEYS = 100  # that are swept: more than a case has
FORMAT = 7
"""Raise it when more is kept of a member, or when what is kept no longer means what it meant."""
TEMPLATE = """\
# A case for every combination of the values of some keys. Run it with: asperity study STUDY
# The case: its path, from the folder of this file, or a section [case] with its keys.

case = "case.toml"

[sweep]                         # keys of the case, each with a list of values as they stand in a case
speed = ["20 m/s", "56 m/s"]    # or a range: "80..300 km/h, 6 steps", both ends among the 6 values
seed = "1..3"                   # every whole number; "6 ratios" in place of steps: equal ratios
# "contact.spacing" = ["4 um", "8 um"]
# [sweep.variant."light and slow"]  # named changes of several keys, each compared with the case as it is:
# speed = "times 0.8"             # times, plus or minus what it has, or any value
# wheel.load = "50 kN"
# [draw]                        # keys of which each case gets a value by chance, or one of a list
# radial = "50..500 N, ratios"
"""


@dataclass(frozen=True, eq=False)
class Member:
    """One case of a study."""

    index: tuple[int, ...]  # its place on the axes
    values: dict[str, Any]  # the swept keys with their values as they stand in TOML
    case: AnyCase | None  # None if its values do not fit together
    error: CaseError | None  # why there is no case
    key: str  # names its result by everything the result depends on
    drawn: dict[str, Any] = field(default_factory=dict)  # the keys that are drawn, likewise

    @property
    def label(self) -> str:
        """Its values, for people."""
        return ", ".join(f"{name} = {written_out(value)}" for name, value in self.values.items())


@dataclass(frozen=True, eq=False)
class Study:
    """A case, and lists of values for some of its keys."""

    data: dict[str, Any]  # keys and values of the case, sections as dicts
    origin: Origin  # where they come from
    axes: tuple[SweptAxis | VariantAxis, ...]  # the keys that are swept, and named changes
    draws: tuple[Draw, ...] = ()  # the keys that are drawn for each member

    @property
    def text(self) -> str:
        """The case in TOML, without the keys that are swept; what stands in memory is described."""
        return toml.toml_text(self.data)

    @property
    def shape(self) -> tuple[int, ...]:
        """Number of values of each swept key."""
        return tuple(len(axis.values) for axis in self.axes)

    @property
    def sweep(self) -> dict[str, Any]:
        """Swept keys with their values, and named changes, as they stand in TOML."""
        return {axis.name: axis.told for axis in self.axes}

    @property
    def drawn(self) -> dict[str, Any]:
        """Keys that are drawn, with what they are drawn from, as they stand in TOML."""
        return {draw.name: draw.told for draw in self.draws}

    def members(self) -> list[Member]:
        """List all cases; the last key varies fastest. A `CaseError` says that none is valid.

        Lengths that are chosen for each of them are the same for all, so that all roll over one surface.
        """
        digest_of = lru_cache(maxsize=None)(file_digest)
        found = [self._member(index, digest_of, {}) for index in np.ndindex(self.shape)]
        valid = [member.case for member in found if member.case is not None]
        if valid and (shared := valid[0].shared_keys(valid)):
            found = [self._member(member.index, digest_of, shared) for member in found]
        errors = [member.error for member in found if member.error is not None]
        if len(errors) == len(found):
            messages = dict.fromkeys(message for error in errors for message in error.errors)
            raise CaseError(self.origin.source, list(messages))
        return found

    def _member(
        self, index: tuple[int, ...], digest_of: Callable[[Path], str], shared: Mapping[str, float]
    ) -> Member:
        values = {axis.name: axis.written[i] for axis, i in zip(self.axes, index, strict=True)}
        try:
            case, data = self._case(values)
            drawn = drawn_values(self.draws, case, values)
            case = cases.case_of(_with_values(data, drawn), self.origin) if drawn else case
            case = case.with_(**shared)
        except CaseError as error:
            return Member(index, values, None, error, "")
        return Member(index, values, case, None, case_key("member", FORMAT, case, of_file=digest_of), drawn)

    def _case(self, values: Mapping[str, Any]) -> tuple[AnyCase, dict[str, Any]]:
        """The case with values of the swept keys and what a variant changes of that, and its keys."""
        drawn = {draw.name: draw.first for draw in self.draws if not draw.entry.section}
        swept = {key: value for key, value in values.items() if key != VARIANT}
        data = _with_values(self.data, drawn | swept)
        case = cases.case_of(data, self.origin)
        for axis in self.axes:
            if isinstance(axis, VariantAxis) and (keys := axis.keys(values[VARIANT], case)):
                varied = _with_values(data, keys)
                changed = cases.case_of(varied, self.origin)
                if changed == case:
                    raise CaseError(values[VARIANT], ["nothing changes: the case is so already"])
                return changed, varied
        return case, data


def load_study(path: FilePath) -> Study:
    """Read a study from a TOML file: ``case``, a path or a section, ``[sweep]``, and perhaps ``[draw]``.

    All errors of keys and values are reported at once.
    """
    remedy = "Check the path, or write a study with 'asperity new study > study.toml'."
    data, base, origin = cases.read_with_case(path, "study", remedy)
    if unknown := sorted(data.keys() - {"sweep", "draw"}):
        errors = [InputError(name, "an unknown key", "case, [sweep] and [draw]") for name in unknown]
        raise CaseError(str(path), list(map(str, errors)))
    return _checked(base, origin, data.get("sweep", {}), path, data.get("draw", {}))


def study_of(
    case: FilePath | Mapping[str, Any] | AnyCase,
    sweep: Mapping[str, Any],
    draw: Mapping[str, Any] | None = None,
) -> Study:
    """Make a study of a case.

    Parameters
    ----------
    case : path, mapping or case object
        The case, as `asperity.run` takes it.
    sweep : mapping of str to list
        Keys with lists of values, in SI or as text with a unit: ``{"contact.spacing": ["4 um", "8 um"]}``;
        or with a range as text: ``{"speed": "80..300 km/h, 6 steps"}`` has six values, both ends among them,
        ``"60..1900 MN/m, 6 ratios"`` six in equal ratios, and ``"1..20"`` every whole number.
    draw : mapping of str, optional
        Keys of which each member gets a value by chance: between two ends, ``{"radial": "50..500 N"}``, with
        equal chances of equal ratios, ``"0.2..3 mm, ratios"``, or one of a list; of a speed with a jitter,
        ``"1200..1800 1/min ± 0.5 %"``, by whose rms it wanders in the record. A member draws the same again;
        what a case does not have, as the length of a fault of a sound bearing, is not drawn.

    Returns
    -------
    Study
        The study, with all its values read.

    Raises
    ------
    InputError
        If the file is missing or no TOML.
    CaseError
        With all errors at once, if keys or values are wrong.
    """
    return _checked(*cases.keys_and_origin(case), sweep, "study", draw or {})


def _checked(data: dict[str, Any], origin: Origin, sweep: object, source: FilePath, draw: object) -> Study:
    """Read swept and drawn values, or say all that is wrong with them."""
    if not isinstance(sweep, Mapping) or not sweep:
        received = "nothing" if not sweep else shown(sweep)
        example = 'Write [sweep] and below it, for instance, speed = ["20 m/s", "56 m/s"].'
        raise CaseError(str(source), [str(InputError("sweep", received, "a key with its values", example))])
    errors: list[InputError] = []
    axes: dict[str, SweptAxis | VariantAxis] = {}
    for dotted, values in flat(sweep):
        if len(axes) + len(errors) >= MOST_KEYS:
            errors.append(InputError("sweep", "more keys", f"at most {MOST_KEYS} keys"))
            break
        try:
            remedy = "Put all values into one list."
            require(dotted not in axes, dotted, "the key more than once", "each key once", remedy)
            if dotted == VARIANT:
                axes[dotted], found = variant_axis(cases.case_class(data.get("kind")), values, origin)
                errors += [error.about(f"sweep.{error.what}") for error in found]
            else:
                axes[dotted] = _axis(data.get("kind"), dotted, values, origin)
        except InputError as error:
            errors.append(error if error.what == "kind" else error.about(f"sweep.{error.what}"))
    lengths = [len(axis.values) for axis in axes.values()]
    if (count := math.prod(lengths)) > MOST_MEMBERS:
        received = f"{' × '.join(map(str, lengths))} = {count_of(count, 'member')}"
        remedy = "Split the study: what is finished is kept."
        errors.append(InputError("sweep", received, f"at most {MOST_MEMBERS} members", remedy))
    draws, wrong = _draws(data.get("kind"), draw, axes, origin)
    errors += wrong
    if errors:
        raise CaseError(str(source), list(dict.fromkeys(map(str, errors))))
    return Study(data, origin, tuple(axes.values()), draws)


def _draws(
    kind: object, given: object, axes: Mapping[str, Any], origin: Origin
) -> tuple[tuple[Draw, ...], list[InputError]]:
    """Read the keys that are drawn, and list what is wrong with them."""
    if not isinstance(given, Mapping):
        return (), [InputError("draw", shown(given), "keys, each with what it is drawn from")]
    found = dict[str, Draw]()
    errors = list[InputError]()
    for dotted, source in flat(given):
        if len(found) + len(errors) >= MOST_KEYS:
            errors.append(InputError("draw", "more keys", f"at most {MOST_KEYS} keys"))
            break
        try:
            twice = dotted in axes or dotted in found
            require(not twice, dotted, "the key more than once", "each key once, swept or drawn")
            found[dotted] = Draw.read(cases.case_class(kind), dotted, source, origin)
        except InputError as error:
            errors.append(error if error.what == "kind" else error.about(f"draw.{error.what}"))
    return tuple(found.values()), errors


def _axis(kind: object, dotted: str, values: object, origin: Origin) -> SweptAxis:
    remedy = "Write a study for each kind."
    require(dotted != "kind", "kind", "a swept key", "one kind of case in a study", remedy)
    entry = entry_of(cases.case_class(kind), dotted)
    if isinstance(values, np.ndarray) and values.ndim == 1:
        values = values.tolist()
    values = expanded(dotted, values)
    if not isinstance(values, list | tuple):
        allowed = "a list of values, or a range as '80..300 km/h, 6 steps'"
        raise InputError(dotted, shown(values), allowed, "Put the values into [ ].")
    require(values, dotted, "an empty list", "one value or more", "Remove the key for that of the case.")
    received = count_of(len(values), "value")
    allowed = f"at most {MOST_MEMBERS}"
    require(len(values) <= MOST_MEMBERS, dotted, received, allowed, "Split the study.")
    read: dict[str, Any] = {}  # in their order
    for number, value in enumerate(values, 1):
        try:
            found = entry.read(value, origin)
        except InputError as error:
            raise error.about(f"{dotted}[{number}]") from None
        told = json.dumps(content(found))
        require(told not in read, dotted, f"{shown(value)} more than once", "each value once")
        read[told] = found
    written = (as_in_toml(value, found, entry) for value, found in zip(values, read.values(), strict=True))
    return SweptAxis(entry, tuple(written), tuple(read.values()))


def _with_values(data: Mapping[str, Any], values: Mapping[str, Any]) -> dict[str, Any]:
    """Keys of a case with other values for some of them."""
    changed = form.numbered(data)
    for dotted, value in values.items():
        section, _, name = dotted.rpartition(".")
        if not section:
            changed[name] = value
        elif isinstance(changed.setdefault(section, {}), Mapping):
            changed[section] = {**changed[section], name: value}
    return changed
