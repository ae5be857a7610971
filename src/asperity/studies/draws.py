"""Values that a study draws by chance for each of its members, each the same again in the same study."""

import re
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from asperity.arguments import require, shown
from asperity.case.any_case import AnyCase, CaseKey, entry_of
from asperity.case.form import Section
from asperity.case.speed import Speed
from asperity.errors import InputError
from asperity.parameters import FROM_PYTHON, Origin
from asperity.speeds import SpeedCourse
from asperity.store import content_key
from asperity.studies.axes import Nothing, value_of, written_out
from asperity.units import factor, unit_in
from asperity.written_numbers import NUMBER

_SPAN = re.compile(rf"\s*({NUMBER})\s*\.\.\s*({NUMBER})\s*((?:1/)?[^\d\s,][^,]{{0,40}}?)?\s*(,\s*ratios)?\s*")
_JITTER = re.compile(rf"(.*?)\s*(?:±|\+-)\s*({NUMBER})\s*%\s*")
MOST_JITTER = 0.2
"""Share by which a speed may wander, at most."""
STEP = 0.1
"""Time from point to point of a speed that wanders, s, at least …"""
MOST_POINTS = 500
"""… and so many of them."""


def chance(*of: Any) -> np.random.Generator:
    """Random numbers that are the same wherever they are asked for the same, and other ones elsewhere."""
    digest = content_key("chance", *of).partition("-")[2]
    return np.random.default_rng([int(digest[n : n + 8], 16) for n in range(0, 32, 8)])


@dataclass(frozen=True)
class Span:
    """From where to where a number is drawn.

    Attributes
    ----------
    low, high : float
        Ends, in a unit.
    unit : str
        The unit; empty for none.
    in_ratios : bool
        Whether equal ratios have equal chances, in place of equal differences.
    """

    low: float
    high: float
    unit: str
    in_ratios: bool = False

    @classmethod
    def read(cls, what: str, text: str) -> "Span | None":
        """Read ``"1200..1800 1/min"`` or ``"0.2..3 mm, ratios"``; None where it is nothing of that kind."""
        match = _SPAN.fullmatch(text)
        if match is None:
            return None
        low = float(match[1])
        high = float(match[2])
        ratios = match[4] is not None
        require(np.isfinite(high - low) and low != high, what, shown(text), "two different ends")
        require(not ratios or low * high > 0.0, what, shown(text), "ends above zero for equal ratios")
        return cls(low, high, (match[3] or "").strip(), ratios)

    def drawn(self, random: np.random.Generator) -> float:
        """Draw a number, of ten digits."""
        share = float(random.random())
        if self.in_ratios:
            found = self.low * (self.high / self.low) ** share
        else:
            found = self.low + share * (self.high - self.low)
        return float(f"{found:.10g}")

    def in_si(self, of: str) -> "Span":
        """The same in SI, by a unit of the same kind."""
        scale = factor(self.unit, of)
        return Span(scale * self.low, scale * self.high, of, self.in_ratios)


@dataclass(frozen=True, eq=False)
class Draw:
    """A key whose value is drawn for each member.

    Attributes
    ----------
    entry : CaseKey
        The key.
    told : str or list
        What it is drawn from, as it stands in TOML.
    source : Span or tuple
        A span, or values of which one is drawn.
    jitter : float
        Rms share by which a speed wanders in a record about what is drawn; 0 for a constant one.
    """

    entry: CaseKey
    told: Any
    source: Span | tuple[Any, ...]
    jitter: float = 0.0

    @classmethod
    def read(cls, model: type[Section], dotted: str, given: Any, origin: Origin) -> "Draw":
        """Read what a key is drawn from; an `InputError` says what is wrong with it."""
        require(dotted != "kind", "kind", "a key that is drawn", "one kind of case in a study")
        entry = entry_of(model, dotted)
        text, jitter = _jitter(entry, given)
        span = Span.read(dotted, text) if isinstance(text, str) else None
        if span is not None and not (
            not span.unit and {span.low, span.high} <= {int(span.low), int(span.high)}
        ):
            for end in (span.low, span.high):
                entry.read(_written(end, span.unit), origin)
            return cls(entry, given, span, jitter)
        if span is not None:
            values: Any = list(range(int(span.low), int(span.high) + 1))
        else:
            values = text if isinstance(text, list | tuple) else None
        if not values:
            allowed = "a span as '0.2..3 mm', or a list of values of which one is drawn"
            raise InputError(dotted, shown(given), allowed)
        for value in values:
            entry.read(value, origin)
        return cls(entry, given, tuple(values), jitter)

    @property
    def name(self) -> str:
        """The key with its section."""
        return self.entry.dotted

    @property
    def first(self) -> Any:
        """The least that may be drawn, or the first of a list, as it stands in TOML."""
        if isinstance(self.source, Span):
            return _written(self.source.low, self.source.unit)
        return self.source[0]

    def number(self, drawn: Any) -> float:
        """What was drawn, in SI, the mean of a speed that wanders; NaN of words."""
        if self.entry.unit is None:
            return float("nan")
        found = self.entry.read(drawn, FROM_PYTHON)
        return float(found.speeds.mean() if isinstance(found, SpeedCourse) else found)

    def value(self, case: AnyCase, random: np.random.Generator) -> Any:
        """What is drawn for a case, as it stands in TOML."""
        if isinstance(self.source, Span):
            drawn: Any = _written(self.source.drawn(random), self.source.unit)
        else:
            drawn = self.source[int(random.integers(len(self.source)))]
        if not self.jitter:
            return drawn
        duration: float | None = getattr(case, "duration", None)
        allowed = "one with its duration"
        remedy = "Give the case its duration."
        received = "a case without a duration"
        require(duration is not None, f"jitter of {self.name}", received, allowed, remedy)
        return _wandering(drawn, self.jitter, float(duration or 0.0), random)


def _jitter(entry: CaseKey, given: Any) -> tuple[Any, float]:
    """What a key is drawn from without its jitter, and that as a share."""
    match = _JITTER.fullmatch(given) if isinstance(given, str) else None
    if match is None:
        return given, 0.0
    allowed = "a jitter of a speed alone, of a case whose speed may change"
    require(isinstance(entry.key.kind, Speed), entry.dotted, shown(given), allowed)
    share = 0.01 * float(match[2])
    allowed = f"a jitter above 0 %, at most {MOST_JITTER:.0%}"
    require(0.0 < share <= MOST_JITTER, entry.dotted, shown(given), allowed)
    return (match[1] if _SPAN.fullmatch(match[1]) else [match[1]]), share


def _written(number: float, unit: str) -> Any:
    bare = int(number) if number == int(number) else number
    return f"{bare} {unit}" if unit else bare


def _wandering(mean: str, share: float, duration: float, random: np.random.Generator) -> str:
    """A speed that wanders about a mean: straight between points each of which is drawn, no farther than
    three times their rms."""
    count = min(max(int(np.ceil(duration / STEP)), 2), MOST_POINTS)
    unit = unit_in(mean)
    number = float(mean.removesuffix(unit))
    off = np.clip(random.standard_normal(count + 1), -3.0, 3.0)
    points = zip(number * (1.0 + share * off), np.linspace(0.0, duration, count + 1), strict=True)
    return ", ".join(f"{speed:.8g} {unit} at {time:.8g} s" for speed, time in points)


def drawn_values(draws: tuple[Draw, ...], case: AnyCase, values: Mapping[str, Any]) -> dict[str, Any]:
    """What is drawn for the case with some values of the swept keys: each key that it has anything of.

    A fault's length is not drawn of a bearing without a fault.
    """
    told = {name: written_out(value) for name, value in values.items()}
    found = {}
    for draw in draws:
        try:
            value_of(case, draw.entry)
        except Nothing:
            continue
        found[draw.name] = draw.value(case, chance(draw.name, told))
    return found
