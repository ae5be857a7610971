"""Unit strings, at the door only: everything behind it is SI floats."""

import math
import re
from decimal import Decimal
from functools import cache, lru_cache

from asperity.errors import InputError
from asperity.unit_table import ONE, is_known, scale_of, symbols

_NUMBER = re.compile(
    r"\s*+([+-]?(?:[0-9]++\.?[0-9]*+|\.[0-9]++)(?:[eE][+-]?[0-9]++)?|[+-]?inf|nan)(?![0-9.,_])\s*+(.*)",
    re.IGNORECASE | re.DOTALL,
)
_POWER = r"(?:(?:\^|\*\*)?-?[1-9]|[²³])?"
_UNIT = re.compile(rf"[A-Za-zµμΩ°%]+{_POWER}(?:\s*[ */·]\s*[A-Za-zµμΩ°%]+{_POWER})*")
_IN_BRACKETS = re.compile(r"[(\[]((?:[^()\[\]]|\([^()\[\]]*\))*)[)\]]")
_NUMERATOR, _DENOMINATOR = re.compile(r"^\(([^()]*)\)(?=/)"), re.compile(r"/ ?\(([^()]*)\)")
IN_WORDS = {
    "m": ("a length", "25 mm"),
    "s": ("a time", "0.5 s"),
    "m/s": ("a speed", "1 m/s"),
    "kg": ("a mass", "0.5 kg"),
    "N": ("a force", "5 N"),
    "Pa": ("a pressure", "3 GPa"),
    "Pa s/m^2": ("a flow resistivity", "200 kPa s/m^2"),
    "kg/m^3": ("a density", "2700 kg/m^3"),
    "Hz": ("a frequency", "5 kHz"),
    "N s/m": ("a damping constant", "10 N s/m"),
    "N/m": ("a stiffness", "300 MN/m"),
    "N m": ("a rotational stiffness per rad", "500 kN m"),
    "N m^2": ("a bending stiffness", "4.7 MN m^2"),
    "kg/m": ("a mass per length", "60 kg/m"),
    "kg m": ("a rotary inertia per length", "0.24 kg m"),
    "kg m^2": ("a moment of inertia", "1500 kg m^2"),
    "dB": ("a level", "+0 dB"),
    "rad": ("an angle", "30 deg"),
    "rad/m": ("an angle per length", "0.1 rad/m"),
    "m^3/J": ("a wear rate", "7e-4 mm^3/J"),
    "m^2/s": ("a kinematic viscosity", "68 mm^2/s"),
    "degC": ("a temperature", "70 degC"),
    "Pa^-1": ("a pressure-viscosity coefficient", "20 GPa^-1"),
}
"""What is measured in an SI unit, and an example."""
_LONGEST = 40  # characters
_LONGEST_QUANTITY = 200  # characters: a number to the last bit and its unit have 70

_PREFIXED = ("m", "s", "Hz", "N", "Pa", "m/s", "N/m", "N s/m", "N m^2")
LEAST_NUMBER, MOST_NUMBER = 1e-3, 1e5
"""A quantity keeps its unit while its number lies between these."""
_TYPED = {"m/s": ("km/h",)}
"""Units without a prefix in which people type a quantity."""
_PREFIXES = {"n": 1e-9, "u": 1e-6, "µ": 1e-6, "m": 1e-3, "k": 1e3, "M": 1e6, "G": 1e9}
_TURNS = ("1/min", "rpm", "r/min", "min^-1", "min⁻¹")
"""Turns, where Hz are meant."""
_CELSIUS = ("degC", "°C", "celsius")
"""Names of the scale of temperatures."""


_WRITTEN = (
    "km/h", "mm/s", "N/mm", "kN/mm", "kg/m", "kg/m^3", "mm^2", "N s/mm", "kN s/m", "deg", "rad", "kg", "t"
)  # fmt: skip
"""Units that people write beside SI units and their prefixes."""


@lru_cache(maxsize=256)
def factor(unit: str, dimension: str) -> float:
    """SI value of one unit, as ``"um"``, ``"µm"``, ``"N s/m"``, compatible with an SI unit, as ``"m"``.

    As dimension ``"dB"`` allows ``"dB"`` alone, ``"degC"`` degrees Celsius alone.
    """
    unit = unit.strip()
    if unit == dimension:
        return 1.0
    if dimension == "Hz" and unit in _TURNS:
        return 1.0 / 60.0
    allowed = f"a unit that converts to {dimension}" if dimension else "no unit"
    if "dB" in (unit, dimension):  # a level is not a multiple of a physical unit
        raise InputError("unit", repr(unit), allowed, f"Write the quantity as in '1 {dimension}'.")
    if dimension == "degC":  # its zero is none of K, and differences are not meant
        if unit in _CELSIUS:
            return 1.0
        raise InputError("unit", repr(unit), '"degC"', "Write degrees Celsius, as in '70 degC'.")
    misread = unit.lower().endswith(("mph", "kph")) and len(unit) > 3  # "kmph" is no thousand miles per hour
    remedy = "Write names, '/', '*' and powers, as in 'kg/m^3'."
    if len(unit) <= _LONGEST and not misread and _UNIT.fullmatch(unit):
        found = scale_of(unit)
        wanted = scale_of(dimension) or ONE
        if found is not None and found.converts(wanted):
            return (found.of_turns() if dimension == "Hz" else found).value
        remedy = _spelled_otherwise(unit, dimension)
        if found is not None:
            such = f"Write the quantity with such a unit, as in '1 {dimension}'."
            remedy = such if dimension else "Leave the unit away."
    raise InputError("unit", repr(unit[:_LONGEST]), allowed, _meant(unit, dimension) or remedy)


def _meant(unit: str, dimension: str) -> str:
    """Sentence that names units of a dimension with these letters, ``"km/h"`` for ``"kmh"``; or nothing."""
    prefixes = (*_PREFIXES, "") if dimension in _PREFIXED else ("",)
    letters = _letters(unit)
    alike = [each for each in (*_WRITTEN, *(p + dimension for p in prefixes)) if _letters(each) == letters]
    found = [f'"{each}"' for each in dict.fromkeys(alike) if _converts(each, dimension)]
    return f"Did you mean {' or '.join(found)}?" if found else ""


def _spelled_otherwise(unit: str, dimension: str) -> str:
    """Sentence that names the part of a unit that is unknown, and those that fit in its place."""
    unknown = [name for name in re.findall(r"[A-Za-zµμΩ°%]+", unit) if not is_known(name)]
    if len(unknown) != 1:
        return "Check its spelling."
    (name,) = unknown
    fitting = [each for each in symbols() if _converts(unit.replace(name, each), dimension)]
    known = f" Known in its place: {', '.join(fitting)}." if fitting else ""
    if name == unit:
        return f"Check its spelling.{known}"
    return f"'{name}' in it is unknown: check its spelling.{known}"


def _converts(unit: str, dimension: str) -> bool:
    """Whether a unit is one of a dimension."""
    found = scale_of(unit)
    return found is not None and found.converts(scale_of(dimension) or ONE)


def _letters(unit: str) -> str:
    """Its letters, small; ``per`` and its ``p`` between letters stand for a stroke."""
    text = unit[:_LONGEST].replace("µ", "u").replace("μ", "u").lower()
    return re.sub(r"[^a-z0-9]", "", re.sub(r"(?<=[a-z])(per|p)(?=[a-z]$|hr?$)", "", text)).replace("hr", "h")


@lru_cache(maxsize=1024)
def quantity(text: str, dimension: str) -> float:
    """SI value of a quantity written with its unit, as ``"25 mm"``; ``"inf"`` needs no unit.

    The unit is compatible with the SI unit `dimension`: ``""`` for a pure number, ``"dB"`` for a level.
    """
    received = repr(text if len(text) <= _LONGEST else text[:_LONGEST] + "…")
    allowed = f"a number and a unit, as '1 {dimension}'" if dimension else "a number"
    match = _NUMBER.fullmatch(text) if len(text) <= _LONGEST_QUANTITY else None
    value, unit = (float(match[1]), match[2].strip()) if match else (math.nan, "")
    infinite = match is not None and "inf" in match[1].lower()
    if match is None:
        remedy = "Write the number first, with a decimal point, then the unit."
    elif math.isnan(value):
        remedy = "NaN is not a value; give a number."
    elif dimension and not unit and not infinite:
        remedy = "Add the unit."
    else:
        if unit and math.isfinite(value):
            # in decimal, so that 0.18 mm, 180 um and 0.00018 are one number
            value = float(Decimal(match[1]) * Decimal(repr(factor(unit, dimension))))
        if infinite or math.isfinite(value):
            return value
        remedy = "The number is too large; 'inf' stands for infinity."
    raise InputError("quantity", received, allowed, remedy)


def unit_in(text: str) -> str:
    """Unit of a quantity as it is written, ``"km/h"`` of ``"50 km/h"``; empty if it names none."""
    match = _NUMBER.fullmatch(text) if len(text) <= _LONGEST_QUANTITY else None
    return "" if match is None else match[2].strip()


def unit_in_brackets(heading: str) -> str:
    """Unit that the heading of a column names, ``"cm"`` of ``"wavelength (cm)"``; empty without one.

    Without brackets of its own: ``"m/s/N"`` of ``"mobility [(m/s)/N]"``, ``"m/N/s"`` of ``"Y (m/(N s))"``.
    """
    match = _IN_BRACKETS.search(heading)
    unit = _NUMERATOR.sub(r"\1", " ".join(match[1].split())) if match else ""
    return _DENOMINATOR.sub(
        lambda below: "/" + re.sub(r" ?[ *·] ?", "/", below[1].strip().replace("Ns", "N s")), unit
    )


def written(value: float, dimension: str, unit: str, *, exactly: bool = False) -> str:
    """Write a quantity in SI with its unit, as `quantity` reads it: ``"25 mm"``; infinity is ``"inf"``.

    `dimension` is the SI unit, `unit` the preferred one; another prefix is taken where its number would be
    far from one, or whose number is that which was typed: ``"143 km/h"``. `exactly` says that the text has to
    be read as the very same number; it has six digits otherwise.
    """
    if math.isinf(value):
        return "inf" if value > 0 else "-inf"
    if math.isnan(value):
        return f"nan {unit}"
    unit = _suited(value, dimension, unit)
    sign = "+" if dimension == "dB" else ""
    # what was written as 50 nm is not 0.05 um to the last bit
    units = [unit, *(_prefixed(value, dimension) if dimension in _PREFIXED else ())]
    units += [*_TYPED.get(dimension, ()), dimension]
    longer = [*((form, each) for form in (".12g", ".15g") for each in units), ("", unit), ("", dimension)]
    for form, each in [*(("g", each) for each in units), *(longer if exactly else ())]:
        text = f"{value / factor(each, dimension):{sign}{form}} {each}"
        if quantity(text, dimension) == value:
            return text
    if not exactly:
        return f"{value / factor(unit, dimension):{sign}g} {unit}"
    raise AssertionError(f"{value!r} {dimension} cannot be written")  # the last form has every bit


def _suited(value: float, dimension: str, unit: str) -> str:
    """The unit, or the same with a prefix that brings the number near one."""
    size = abs(value / factor(unit, dimension))
    if size == 0.0 or LEAST_NUMBER <= size < MOST_NUMBER or dimension not in _PREFIXED:
        return unit
    fitting = _prefixed(value, dimension)
    return fitting[0] if fitting else dimension


def _prefixed(value: float, dimension: str) -> list[str]:
    """Units of a dimension with the prefixes that bring a number near one, the smallest above one first."""
    prefixes = {"": 1.0, **{name: scale for name, scale in _PREFIXES.items() if name != "µ"}}
    sizes = {name + dimension: abs(value) / scale for name, scale in prefixes.items()}
    fitting = [name for name, size in sizes.items() if LEAST_NUMBER <= size < MOST_NUMBER]
    return sorted(fitting, key=lambda name: (sizes[name] < 1.0, abs(math.log(sizes[name]))))


@cache
def limits_in(within: str) -> tuple[str, str, str]:
    """Limits and reason of a text as ``"1 mm to 1 km: beams lie between"``."""
    limits, _, reason = within.partition(": ")
    least, _, most = limits.partition(" to ")
    return least, most, reason
