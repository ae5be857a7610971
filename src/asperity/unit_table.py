"""Names of units and what each is, and the scale of a product of them, as ``"N s/mm"``."""

import math
import re
import tomllib
from collections.abc import Mapping
from fractions import Fraction
from functools import cache, lru_cache
from typing import NamedTuple

from asperity.files import packaged

BASE = ("m", "kg", "s", "A", "K", "mol", "cd", "dB", "Np", "rad")
"""What units are made of."""
_TABLES = tomllib.loads(packaged("units.toml"))
PREFIXES: dict[str, str] = _TABLES["prefixes"]
UNITS: dict[str, str] = _TABLES["units"]
"""Names of units, and each in SI: a number, perhaps ``pi``, and base units."""
_POWER = re.compile(r"([A-Za-zµμΩ°%]+)(?:(?:\^|\*\*)?(-?[1-9])|([²³]))?$")
_WORDS = {"square": 2, "sq": 2, "cubic": 3}
_AFTER = {"squared": 2, "cubed": 3}
_PLURAL = re.compile("([a-z]{2,})s")
"""Names have plurals, symbols of one letter and those of people have none: Pas are none."""


class Scale(NamedTuple):
    """A unit: its factor to SI, a fraction times a power of π, and exponents of the base units."""

    factor: Fraction
    of_pi: int
    exponents: tuple[int, ...]

    @property
    def value(self) -> float:
        """The factor, to the last bit where no π is in it."""
        return math.pi**self.of_pi * self.factor.numerator / self.factor.denominator

    def converts(self, dimension: "Scale") -> bool:
        """Whether it is one of a dimension, where an angle is a number."""
        return self.exponents[:-1] == dimension.exponents[:-1]

    def of_turns(self) -> "Scale":
        """The same with turns for the angle in it, as frequencies count."""
        angle = self.exponents[-1]
        return Scale(self.factor / Fraction(2) ** angle, self.of_pi - angle, (*self.exponents[:-1], 0))

    def times(self, other: "Scale", power: int) -> "Scale":
        """The product with a power of another unit."""
        added = [mine + power * its for mine, its in zip(self.exponents, other.exponents, strict=True)]
        return Scale(self.factor * other.factor**power, self.of_pi + power * other.of_pi, tuple(added))


ONE = Scale(Fraction(1), 0, (0,) * len(BASE))


@lru_cache(maxsize=256)
def scale_of(unit: str) -> Scale | None:
    """Scale of a product or quotient of powers of units; None where a name is unknown or misplaced.

    A blank, ``*`` and ``·`` multiply, ``/`` and ``per`` divide by the one unit that follows.
    """
    words = (
        re.sub(r"\s*(\*\*|\^)\s*", "^", unit).replace("·", " ").replace("*", " ").replace("/", " / ").split()
    )
    found = ONE
    sign = 1
    power = 1
    pending = bool(words)
    last: tuple[Scale, int] | None = None
    for word in words:
        if word in ("/", "per"):
            if pending or sign < 0:
                return None
            sign = -1
            pending = True
        elif word in _WORDS and power == 1:
            power = _WORDS[word]
            pending = True
        elif word in _AFTER and last is not None:
            named, exponent = last
            found = found.times(named, (_AFTER[word] - 1) * exponent)
            last = None
        else:
            match = _POWER.match(word)
            unit_named = None if match is None else named_unit(match[1])
            if match is None or unit_named is None:
                return None
            exponent = int(match[2]) if match[2] else {"²": 2, "³": 3}.get(match[3], 1)
            last = unit_named, sign * power * exponent
            found = found.times(*last)
            sign = 1
            power = 1
            pending = False
    return None if pending else found


def symbols() -> list[str]:
    """The first name of each unit, without prefixes."""
    return [names.split()[0] for names in UNITS]


def is_known(name: str) -> bool:
    """Whether a word in a unit is one of these units, or a word that stands between them."""
    return name in ("per", *_WORDS, *_AFTER) or named_unit(name) is not None


@cache
def named_unit(name: str) -> Scale | None:
    """Scale of one unit by its name, with a prefix or in the plural; None where there is none."""
    plural = _PLURAL.fullmatch(name)
    for each in (name, *([plural[1]] if plural else [])):
        if each in _DEFINED:
            return _defined(_DEFINED[each])
        for length in range(len(each) - 1, 0, -1):
            prefix = each[:length]
            rest = each[length:]
            if prefix in _PREFIXES and rest in _DEFINED and rest not in "%°":
                scale = _defined(_DEFINED[rest])
                return scale._replace(factor=scale.factor * Fraction(_PREFIXES[prefix]))
    return None


def _one_by_one(table: Mapping[str, str]) -> dict[str, str]:
    return {name: definition for names, definition in table.items() for name in names.split()}


_PREFIXES = _one_by_one(PREFIXES)
_DEFINED = _one_by_one(UNITS)


@cache
def _defined(definition: str) -> Scale:
    """A unit as the table defines it, read where it is first asked for."""
    number, *parts = definition.split()
    above, _, below = number.partition("/")
    exponents = dict.fromkeys(BASE, 0)
    of_pi = 0
    for part in parts:
        name, _, power = part.partition("^")
        if name == "pi":
            of_pi = 1
        else:
            exponents[name] += int(power or 1)
    return Scale(Fraction(above) / Fraction(below or 1), of_pi, tuple(exponents.values()))
