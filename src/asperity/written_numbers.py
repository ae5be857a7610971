"""Numbers as people write them: without a computer's exponents, units with prefixes, one thing singular."""

import math
import re
from collections.abc import Sequence

PREFIXES = {-12: "p", -9: "n", -6: "µ", -3: "m", 0: "", 3: "k", 6: "M", 9: "G", 12: "T"}
NUMBER = r"[+-]?(?:\d++\.?\d*+|\.\d++)(?:[eE][+-]?\d++)?"
"""Regular expression of a number in a text."""
SUPERSCRIPT = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")
_SMALLEST, _LARGEST = 1e-4, 1e6
"""Sizes between which all digits are written out."""
_BEFORE_A_UNIT = re.compile(
    r"(?<=\d) (?=(?:[kM]?N|k?Hz|dB|%|[µmk]?m|m/s|km/h|[GM]?Pa|[µm]?s|mm²|µm²|g)(?!\w))"
)


def rounded(value: float, digits: int = 3) -> str:
    """Write a number with so many digits, without zeros at its end: ``"4670"``, or ``"6.1·10⁻⁶"``."""
    short = f"{value:.{digits}g}"
    if "e" not in short:
        return short
    number = float(short)
    if _SMALLEST <= abs(number) < _LARGEST:
        places = max(0, digits - 1 - math.floor(math.log10(abs(number))))
        written = f"{number:.{places}f}"
        return written.rstrip("0").rstrip(".") if "." in written else written
    mantissa, _, exponent = short.partition("e")
    return f"{mantissa}·10{str(int(exponent)).translate(SUPERSCRIPT)}"


def plain(value: float, digits: int = 3) -> str:
    """Write a number as `rounded` does, with a true minus sign."""
    return rounded(value, digits).replace("-", "−")


def signed(value: float, places: int = 1) -> str:
    """Write a difference with its sign, but for one that is rounded to zero; a dash where there is none."""
    if not math.isfinite(value):
        return "–"
    number = round(float(value), places)
    return f"{number:+.{places}f}".replace("-", "−") if number else f"{0.0:.{places}f}"


def engineering(value: float, unit: str, digits: int = 3) -> str:
    """Write `value`, in the SI `unit`, with a prefix: ``engineering(3.1e-7, "m")`` is ``"310 nm"``."""
    if not math.isfinite(value):
        return "–"
    if unit in ("", "1"):
        return plain(value, digits)
    if unit == "rad":
        return f"{math.degrees(value):.0f}°"
    power = 2 if unit == "m²" else 1  # a prefix on a squared unit is squared with it
    value += 0.0  # no minus before zero
    least = 2 * (
        power - 1
    )  # areas change the unit at a factor of a million: 0.134 mm² is read, 134000 µm² is not
    exponent = 0 if value == 0 else 3 * math.floor((math.floor(math.log10(abs(value))) + least) / (3 * power))
    exponent = min(max(exponent, -12 if power == 1 else -9), 0 if power == 2 else 12)
    scaled = value / 10.0 ** (exponent * power)
    places = 0 if scaled == 0 else max(0, digits - 1 - math.floor(math.log10(abs(scaled))))
    return f"{scaled:.{places}f} {PREFIXES[exponent]}{unit}".replace("-", "−")


def in_newtons(newtons: float) -> str:
    """Write a force in N or kN with three digits: ``"65 kN"``."""
    return f"{rounded(newtons)} N" if abs(newtons) < 1e3 else f"{rounded(newtons / 1e3)} kN"


def between(low: str, high: str) -> str:
    """Two ends in words; one of them where both are written alike: ``"0.6 to 0.7"``, ``"0.6"``."""
    return low if low == high else f"{low} to {high}"


def with_article(noun: str) -> str:
    """A thing, with the article that its first letter asks for: ``"an optimisation"``."""
    return f"{'an' if noun[0].lower() in 'aeio' else 'a'} {noun}"


def capital(sentence: str) -> str:
    """Begin a sentence with a capital; names in it stay as they are written: ``"CNOSSOS-EU"``.

    So does a key of a case at its beginning, ``"contact.spacing = …"``.
    """
    first = sentence.partition(" ")[0].rstrip(".:,")
    is_key = "." in first or "_" in first
    return sentence if is_key else f"{sentence[:1].upper()}{sentence[1:]}"


def count_of(count: int, thing: str) -> str:
    """A number of things: ``"1 sample"``, ``"8 samples"``, ``"2 frequencies"``, ``"2 passes"``."""
    stem = re.sub(r"(?<![aeiou])y$", "ie", thing)
    return f"{count} {thing}" if count == 1 else f"{count} {stem}{'es' if stem.endswith('s') else 's'}"


def in_a_row(words: Sequence[str]) -> str:
    """Words one after the other, "and" before the last: ``"pads, ballast and rail"``."""
    *first, last = words
    return f"{', '.join(first)} and {last}" if first else last


def unbroken(text: str) -> str:
    """Keep numbers and their units on one line, by spaces that do not break."""
    return _BEFORE_A_UNIT.sub("\u00a0", text)
