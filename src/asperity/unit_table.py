"""Names of units and what each is, and the scale of a product of them, as ``"N s/mm"``."""

import math
import re
from collections.abc import Mapping
from fractions import Fraction
from functools import cache
from typing import NamedTuple

BASE = ("m", "kg", "s", "A", "K", "mol", "cd", "dB", "Np", "rad")
"""What units are made of."""
PREFIXES = {
    "y yocto": "1e-24", "z zepto": "1e-21", "a atto": "1e-18", "f femto": "1e-15", "p pico": "1e-12",
    "n nano": "1e-9", "u µ μ micro": "1e-6", "m milli": "1e-3", "c centi": "1e-2", "d deci": "1e-1",
    "da deca deka": "1e1", "h hecto": "1e2", "k kilo": "1e3", "M mega": "1e6", "G giga": "1e9",
    "T tera": "1e12", "P peta": "1e15", "E exa": "1e18", "Z zetta": "1e21", "Y yotta": "1e24",
}  # fmt: skip
UNITS = {
    "m meter metre": "1 m",
    "g gram gramme": "1e-3 kg",
    "s sec second": "1 s",
    "A ampere amp": "1 A",
    "K kelvin degC °C celsius": "1 K",
    "mol mole": "1 mol",
    "cd candela": "1 cd",
    "dB decibel": "1 dB",
    "Np neper": "1 Np",
    # numbers and angles
    "rad radian": "1 rad",
    "deg degree °": "1/180 pi rad",
    "arcmin arcminute": "1/10800 pi rad",
    "arcsec arcsecond": "1/648000 pi rad",
    "gon grad grade": "1/200 pi rad",
    "turn revolution cycle": "2 pi rad",
    "% percent": "1e-2",
    "ppm": "1e-6",
    # time
    "min minute": "60 s",
    "h hr hour": "3600 s",
    "d day": "86400 s",
    "week": "604800 s",
    "year yr": "31557600 s",
    # length, area, volume
    "micron µ μ": "1e-6 m",
    "angstrom": "1e-10 m",
    "in inch inches": "0.0254 m",
    "thou": "0.0000254 m",
    "ft foot feet": "0.3048 m",
    "yd yard": "0.9144 m",
    "mi mile": "1609.344 m",
    "nmi": "1852 m",
    "ha hectare": "1e4 m^2",
    "l L liter litre": "1e-3 m^3",
    "cc": "1e-6 m^3",
    # mass
    "t tonne": "1e3 kg",
    "lb pound": "0.45359237 kg",
    "oz ounce": "0.028349523125 kg",
    "ton": "907.18474 kg",
    "slug": "444822161526050/30480000000000 kg",
    # speed and rate
    "Hz hertz": "1 s^-1",
    "rpm": "1/30 pi rad s^-1",
    "mph": "0.44704 m s^-1",
    "kph": "1/3.6 m s^-1",
    "kt knot": "1852/3600 m s^-1",
    "Gal": "1e-2 m s^-2",
    # force and pressure
    "N newton": "1 kg m s^-2",
    "dyn dyne": "1e-5 kg m s^-2",
    "lbf": "4.4482216152605 kg m s^-2",
    "kip": "4448.2216152605 kg m s^-2",
    "kgf": "9.80665 kg m s^-2",
    "Pa pascal": "1 kg m^-1 s^-2",
    "bar": "1e5 kg m^-1 s^-2",
    "atm": "101325 kg m^-1 s^-2",
    "psi": "44482216152605/6451600000 kg m^-1 s^-2",
    "ksi": "44482216152605/6451600 kg m^-1 s^-2",
    "torr": "101325/760 kg m^-1 s^-2",
    "mmHg": "133.322387415 kg m^-1 s^-2",
    "P poise": "0.1 kg m^-1 s^-1",
    "St stokes": "1e-4 m^2 s^-1",
    "rayl": "1 kg m^-2 s^-1",
    # energy and power
    "J joule": "1 kg m^2 s^-2",
    "erg": "1e-7 kg m^2 s^-2",
    "eV": "1.602176634e-19 kg m^2 s^-2",
    "cal": "4.184 kg m^2 s^-2",
    "W watt": "1 kg m^2 s^-3",
    "hp horsepower": "745.6998715822702 kg m^2 s^-3",
    # electricity, of sensors
    "V volt": "1 kg m^2 s^-3 A^-1",
    "C coulomb": "1 A s",
    "ohm Ω": "1 kg m^2 s^-3 A^-2",
    "F farad": "1 kg^-1 m^-2 s^4 A^2",
    "H henry": "1 kg m^2 s^-2 A^-2",
    "T tesla": "1 kg s^-2 A^-1",
    "Wb weber": "1 kg m^2 s^-2 A^-1",
}
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
        added = (mine + power * its for mine, its in zip(self.exponents, other.exponents, strict=True))
        return Scale(self.factor * other.factor**power, self.of_pi + power * other.of_pi, tuple(added))


ONE = Scale(Fraction(1), 0, (0,) * len(BASE))


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
    last: Scale | None = None
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
            found = found.times(last, _AFTER[word] - 1)
            last = None
        else:
            match = _POWER.match(word)
            named = None if match is None else named_unit(match[1])
            if match is None or named is None:
                return None
            exponent = int(match[2]) if match[2] else {"²": 2, "³": 3}.get(match[3], 1)
            last = ONE.times(named, sign * power * exponent)
            found = found.times(last, 1)
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
    units = _units()
    prefixes = _prefixes()
    plural = _PLURAL.fullmatch(name)
    for each in (name, *([plural[1]] if plural else [])):
        if each in units:
            return units[each]
        for length in range(len(each) - 1, 0, -1):
            prefix = each[:length]
            rest = each[length:]
            if prefix in prefixes and rest in units and rest not in "%°":
                return units[rest]._replace(factor=units[rest].factor * prefixes[prefix])
    return None


@cache
def _prefixes() -> Mapping[str, Fraction]:
    return {name: Fraction(scale) for names, scale in PREFIXES.items() for name in names.split()}


@cache
def _units() -> Mapping[str, Scale]:
    base = {name: ONE._replace(exponents=tuple(int(each == name) for each in BASE)) for name in BASE}
    units: dict[str, Scale] = {}
    for names, definition in UNITS.items():
        number, *parts = definition.split()
        above, _, below = number.partition("/")
        scale = ONE._replace(factor=Fraction(above) / Fraction(below or 1))
        for part in parts:
            name, _, power = part.partition("^")
            if name == "pi":
                scale = scale._replace(of_pi=1)
            else:
                scale = scale.times(base[name], int(power or 1))
        units |= dict.fromkeys(names.split(), scale)
    return units
