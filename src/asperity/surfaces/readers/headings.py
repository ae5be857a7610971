"""Headings of heights as text: titles of columns, units, and sizes that lines above the numbers state."""

import re
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from asperity.arguments import Array, require
from asperity.errors import InputError
from asperity.surfaces.readers.hints import advice
from asperity.units import factor, quantity

_NUMBER = r"[-+]?\d++(?:[.,]\d*+)?(?:[eE][-+]?\d++)?"
# For lines in which one blank stands for all white space: whatever the line, they need time like its length.
_BRACKET = re.compile(r"[\[(] ?([^\s\[\]()\d]{1,20}) ?[\])]")
_WEIGHTED = re.compile(r"[(\[]?\bdB ?[(\[]? ?[A-Z] ?[)\]]+", re.IGNORECASE)
"""Decibels of a weighting, as in dB(A) or [dB (C)]."""
_SECTION = re.compile(r"\[ ?[^\s\[\]]{4,} ?\]")
"""``[Data]``, the heading of a section."""
_UNIT_LINE = re.compile(r"(.*?)\bunits?\b ?[:=]? ?[\[(]?([^\s\[\]();,]{1,20})", re.IGNORECASE)
_ANY_UNIT = re.compile(
    r"(.*?)\b(?:units?|(?:wert|mess)?einheit(?:en)?|unités?|unidad(?:es)?)\b ?[:=,;]? ?(\S+?)[,; ]*",
    re.IGNORECASE,
)
"""``Unit,um,``, ``Einheit: µm``: those of which any other word is none."""
_PIXEL_LINE = re.compile(
    r"((?:[xy][ _-])?(?:pixel[ _]?(?:size)?|(?:point |data )?spacing|step[ _](?:size|width)|increment"
    r"|sampl(?:e|ing)[ _](?:spacing|interval|distance|pitch)|(?:measur(?:ing|ement)[ _]?)?pitch"
    r"|xy calibration|(?:mess)?punktabstand|schrittweite|pas (?:de mesure|d'échantillonnage))(?:[ _-][xy])?"
    r"|d[xy]|delta[ _]?[xy])"
    rf" ?[:=;,]? ?({_NUMBER})[ ,;]*([^\s\d;,/]{{1,20}})(?:/(?:pixel|px|point))?[;,]*",
    re.IGNORECASE,
)
_VALUE_LINE = re.compile(rf"([^:=;\d]{{1,40}}?) ?[:=;] ?(?:({_NUMBER}) ?)?([^\s\d;,:=]{{1,20}})[;,]*")
"""``Width: 12.0 µm``, or of ``Value units: m`` the unit alone."""
_WIDTH = {
    "width",
    "breite",
    "largeur",
    "larghezza",
    "ancho",
    "anchura",
    "largura",
    "šířka",
    "szerokość",
    "ширина",
}
_HEIGHT = {"height", "höhe", "hauteur", "altezza", "alto", "altura", "výška", "wysokość", "высота"}
_LATERAL_WORDS = {"x", "y", "xy", "lateral", "horiz", "horizontal", "length", "distance", "position", "pixel"}
_BEHIND_IN = re.compile(r"(?:.*\bin |[^/]*/) ?(\S+)", re.IGNORECASE)
_LENGTH = re.compile(
    r"[npuµμmc]?m|å|angstr[oö]ms?|microns?|mils?|inch(?:es)?|(?:nano|pico|mi[ck]ro|milli|centi)?m[eè]t(?:er|re)s?",
    re.IGNORECASE,
)
_TRUTH = re.compile(r"[\[(]? ?(?:1 ?/ ?0|0 ?/ ?1|bool(?:ean)?|true/false) ?[\])]?", re.IGNORECASE)
_VALID = re.compile(r"\W*(?:is[ _])?(valid|validity|validité|gültig|gueltig|valide)\b", re.IGNORECASE)
_INVALID = re.compile(r"\W*(?:is[ _])?(invalid|ungültig|ungueltig|missing|bad|masked)\b", re.IGNORECASE)
_COUNT = re.compile(
    r"\W*(?:no|nr|num(?:ber)?|n°|index|idx|id|i|#|point|punkt|sample|row|zeile)?\W*$", re.IGNORECASE
)
_X = re.compile(r"\W*(?:x|lateral|position|pos|distance|weg|abstand|horizontal)(?![a-z0-9])", re.IGNORECASE)
_Y = re.compile(r"\W*y(?![a-z0-9])", re.IGNORECASE)
_DEPTHS = "depths?|tiefen?|profondeurs?|profondità|profundidad(?:es)?"
_DEPTH = re.compile(rf"\W*(?:{_DEPTHS})(?![a-z])", re.IGNORECASE)
_Z = re.compile(
    rf"\W*(?:z\d*|heights?|höhe|hoehe|hauteur|altezza|altura|profile?|raw|total[ _]profile|{_DEPTHS})"
    r"(?![a-z])",
    re.IGNORECASE,
)
"""Titles of the places and of the heights of points."""
_BESIDE = re.compile(
    r"\W*(?:(?:z|heights?)[ _.-]?)?(?:std(?:[ _.-]?dev)?|stdev|sd|sigma|err(?:or)?s?|uncertainty"
    r"|standard[ _](?:deviation|error)|standardabweichung|(?:mess)?unsicherheit|écart[ -]type|incertitude"
    r"|waviness|roughness|filtered|smoothed|fit(?:ted)?|residuals?"
    r"|welligkeit|rauheit|gefiltert|ondulation|rugosité"
    r"|quality|status|flags?|confidence|intensity|temp(?:erature)?|speed|time|date"
    r"|qualität|qualitaet|güte|intensität|temperatur|geschwindigkeit|zeit|datum|qualité|température|vitesse|temps"
    r")(?![a-z])",
    re.IGNORECASE,
)
"""Titles of what stands beside heights and is none: how sure they are, parts of them, circumstances."""
MOST_TITLE = 200
"""Characters of a title."""
MOST_WORDS = 4
"""Words of a title whose last is its unit."""


@dataclass(frozen=True)
class Title:
    """Title of a column."""

    name: str
    unit: str  # as it is written; empty without one


def titles_of(lines: Sequence[str], delimiter: str | None, columns: int) -> list[Title]:
    """Titles of several columns, of which at least one names a unit, from the lines above them; else none.

    Units stand in brackets, behind "in" or a stroke, as the last word of a title (``Lateral um``), or in a
    line of their own below the titles. The last line of titles counts, whose empty cells at the end are left
    out. The delimiter of the columns is None for white space.
    """
    if columns < 2:
        return []
    rows = [_cells(text, delimiter, columns) for text in lines if len(text) <= MOST_TITLE * columns]
    for number in range(len(rows) - 1, -1, -1):
        cells = rows[number]
        if len(cells) != columns:
            continue
        if units := _units_alone(cells):
            above = (row for row in reversed(rows[:number]) if len(row) == columns)
            names = next(above, [""] * columns)
            return [Title(name, unit) for name, unit in zip(names, units, strict=True)]
        titles = [Title(cell, _unit_of(cell)) for cell in cells]
        if any(title.unit for title in titles):
            return titles
    return []


def _cells(text: str, delimiter: str | None, columns: int) -> list[str]:
    """Cells of a line, as many as there are columns if they can be told apart."""
    plain = uncommented(text)
    ways = [plain.split(delimiter)] if delimiter else [re.split(r"\t|\s{2,}", plain), plain.split()]
    for cells in ways:
        found = [" ".join(cell.strip().strip('"').split()) for cell in cells]
        while found and not found[-1]:
            found.pop()
        if len(found) == columns:
            return found
    line = " ".join(plain.split())
    ends = [match.end() for match in _BRACKET.finditer(line)]
    if len(ends) != columns:
        return []
    return [line[start:end].strip(" ,;") for start, end in zip([0, *ends[:-1]], ends, strict=True)]


def uncommented(text: str) -> str:
    """Line without the mark of a comment before it."""
    return text.strip().lstrip("#%/!").strip()


def _units_alone(cells: list[str]) -> list[str]:
    """Units of a line that holds nothing else; none of another line."""
    bare = [cell.strip("[]() ") for cell in cells]
    known = [bool(_LENGTH.fullmatch(unit) or _TRUTH.fullmatch(unit) or unit in ("", "-")) for unit in bare]
    return bare if all(known) and any(_LENGTH.fullmatch(unit) for unit in bare) else []


def _brackets(text: str) -> list[str]:
    """What stands in brackets, the A of dB(A) with its decibels: it is no ångström."""
    return _BRACKET.findall(_WEIGHTED.sub("[dB]", text))


def _unit_of(title: str) -> str:
    """Unit that a title names; empty without one."""
    if brackets := _brackets(title):
        return str(brackets[-1])
    if any(mark.isdigit() for mark in title):
        return ""
    *before, last = re.split(r"[ _]", title) if title else [""]
    behind = _BEHIND_IN.fullmatch(title)
    for word in (behind[1] if behind else "", last if before else ""):
        if _LENGTH.fullmatch(word):
            return word
    return ""


def columns_of_heights(table: Array, titles: list[Title]) -> tuple[Array, list[Title]]:
    """Columns of a table, and their titles, in the order x, y, z where titles say which these are.

    Left out are numbers of the points, columns without a title and a height, and what else stands beside
    x, y and z; beside heights that are named also how sure they are, and their filtered parts. All else is
    kept where titles name several heights, or do not name them.
    """
    names = [title.name for title in titles]
    kept = [place for place, name in enumerate(names) if name or not np.isnan(table[:, place]).all()]
    if len(kept) > 2:
        kept = [place for place in kept if not _COUNT.match(names[place]) or not _counts(table[:, place])]
    plain = [place for place in kept if not _BESIDE.match(names[place])]
    if any(_Z.match(names[place]) or _is_line(titles[place]) for place in plain):
        kept = plain
    found = [[place for place in kept if role.match(names[place])] for role in (_X, _Y, _Z)]
    if len(found[0]) == len(found[2]) == 1 and len(found[1]) < 2:
        others = [place for place in kept if [place] not in found]
        valid = [n for n in others if _VALID.match(names[n]) or _INVALID.match(names[n])]
        if not any(_LENGTH.fullmatch(titles[place].unit) for place in others):
            kept = [*found[0], *found[1], *valid, *found[2]]
    return (table[:, kept], [titles[place] for place in kept]) if kept else (table, titles)


def _is_line(title: Title) -> bool:
    """Whether a column is in a unit of length, and no place."""
    is_place = _X.match(title.name) or _Y.match(title.name)
    return bool(_LENGTH.fullmatch(title.unit)) and not is_place


def depth_named(lines: Sequence[str], titles: list[Title], delimiter: str | None, columns: int) -> str:
    """Title of heights that is one of depths; empty of any other.

    Titles are those of columns that are taken; without any, lines above the numbers are looked at.
    """
    if titles:
        names = [titles[-1].name]
    else:
        short = (line for line in lines if len(line) <= MOST_TITLE * columns)
        names = [cells[-1] for line in short if (cells := _cells(line, delimiter, columns))]
    return next((name for name in names if _DEPTH.match(name)), "")


def is_depth(name: str) -> bool:
    """Whether the name of an array of heights is one of depths."""
    return bool(_DEPTH.match(re.split(r"[/.]", name)[-1]))


def _counts(numbers: Array) -> bool:
    """Whether numbers count on by one."""
    return bool((np.diff(numbers) == 1.0).all() and numbers[0] in (0.0, 1.0))


def without_invalid(table: Array, titles: list[Title]) -> tuple[Array, list[Title]]:
    """Heights without those that a column of ones and zeros calls invalid, and without that column."""
    for number, title in enumerate(titles):
        named = _VALID.match(title.name) or _INVALID.match(title.name)
        flags = table[:, number]
        if not named or not np.isin(flags, (0.0, 1.0)).all():
            continue
        valid = flags == (0.0 if _INVALID.match(title.name) else 1.0)
        rest = np.delete(table, number, axis=1)
        rest[~valid, -1] = np.nan
        return rest, [*titles[:number], *titles[number + 1 :]]
    return table, titles


FINER = 100.0
"""Least ratio of the unit of positions to that of heights at which several columns are lines: mm to µm."""


def units_of_lines(titles: list[Title]) -> tuple[float, float] | None:
    """Units of positions and of heights, m, of three columns or more whose titles are those of lines.

    Each title has a unit: the first a much larger one, all others the same. None for any other heading.
    """
    if len(titles) < 3:
        return None
    try:
        along, *heights = (length_named(title.unit) for title in titles)
    except (InputError, ValueError):
        return None
    return (along, heights[0]) if len(set(heights)) == 1 and along >= FINER * heights[0] else None


def parsed_header(lines: Sequence[str], titles: list[Title]) -> dict[str, float]:
    """Find units and sizes in the lines above the numbers.

    Understood are column titles with units (``x [mm]; z (µm)``, ``Height (nm)``), lines such as ``# unit:
    um``, ``height unit = nm``, ``lateral unit: mm`` (a bare ``unit`` is that of the heights), ``# pixel:
    1.5 um``, ``dx = 1 mm``, and ``Width: 12 µm`` with ``Height: 5 µm`` of a map, as Gwyddion writes them.

    Returns lengths in m, where the lines do not leave them out: of one unit of ``x``, ``y`` and ``z``, the
    distances ``dx`` and ``dy`` of neighbouring points, which are the same where only one is given, and
    ``width`` and ``height`` of a map whose rows of numbers lie along its width.
    """
    cleaned = [" ".join(uncommented(each).split()) for each in lines]
    stated: dict[str, float] = {}
    pixels: dict[str, float] = {}
    for text in cleaned:
        match = _UNIT_LINE.match(text) or _ANY_UNIT.fullmatch(text)
        if match and (_UNIT_LINE.match(text) or _LENGTH.fullmatch(match[2])):
            stated |= dict.fromkeys("xy" if _is_lateral(match[1]) else "z", length_named(match[2]))
        if match := _PIXEL_LINE.fullmatch(text):
            axis = re.findall(r"(?:^|[^a-z]|delta|d)([xy])(?![a-z])", match[1].lower())
            pixels[f"d{axis[0]}" if axis else match[1].lower()] = _quantity(match[2], match[3])
    stated |= _extent(lines, cleaned)
    units = _column_units(titles) or _unit_of_one(cleaned, titles)
    stated |= ({"y": units["x"]} if "x" in units else {}) | units
    if pixels:
        dx = pixels.get("dx", next(iter(pixels.values())))
        stated |= {"dx": dx, "dy": pixels.get("dy", dx)}
    return stated


def _column_units(titles: list[Title]) -> dict[str, float]:
    """Units of the titles of two columns x, z or of three, x, y, z."""
    axes = {2: "xz", 3: "xyz"}.get(len(titles), "")
    return {axis: length_named(title.unit) for axis, title in zip(axes, titles, strict=False) if title.unit}


def _unit_of_one(lines: list[str], titles: list[Title]) -> dict[str, float]:
    """Unit of heights that one title names, of a single column or of all of a matrix."""
    for text in reversed([] if titles else lines):
        units = _brackets(text)
        if units and _SECTION.fullmatch(text) and not _LENGTH.fullmatch(units[0]):
            continue
        if len(units) == 1 and not _is_lateral(text):
            return {"z": length_named(units[0])}
        few = len(text) <= MOST_TITLE and len(text.split()) <= MOST_WORDS
        if few and not units and not _is_lateral(text) and (unit := _unit_of(text)):
            return {"z": length_named(unit)}
    return {}


def _extent(lines: Sequence[str], cleaned: list[str]) -> dict[str, float]:
    """Width and height of a map, and the unit of its heights, by their names or as Gwyddion orders them."""
    values = [_VALUE_LINE.fullmatch(text) for text in cleaned]
    found: dict[str, float] = {}
    for value in values:
        for name, words in (("width", _WIDTH), ("height", _HEIGHT)):
            if value and value[2] and value[1].lower() in words:
                found[name] = _quantity(value[2], value[3])
    if len(found) == 2:
        return found
    comments = [number for number, text in enumerate(lines) if text.lstrip().startswith("#")]
    stepped = any(_PIXEL_LINE.fullmatch(text) for text in cleaned)
    if (
        comments != [0, 1, 2, 3] or len(lines) != 4 or stepped
    ):  # channel, width, height, unit; in any language
        return {}
    _, width, height, unit = values
    lengths = [each for each in (width, height) if each and each[2] and _LENGTH.fullmatch(each[3])]
    if len(lengths) < 2 or not unit or unit[2] or not _LENGTH.fullmatch(unit[3]):
        return {}
    sizes = [_quantity(each[2], each[3]) for each in lengths]
    return {"width": sizes[0], "height": sizes[1], "z": length_named(unit[3])}


def _is_lateral(words: str) -> bool:
    return not _LATERAL_WORDS.isdisjoint(re.findall(r"[a-z]+", words.lower()))


def _quantity(number: str, unit: str) -> float:
    value = quantity(f"{number.replace(',', '.')} {unit}", "m")
    require(
        value > 0.0, "length in the header", f"{number} {unit}", "a length above zero", "Correct the header."
    )
    return value


OWN_NAMES = dict.fromkeys(("Å", "\u212b", "å", "A"), 1e-10) | dict.fromkeys(("mil", "mils", "MIL"), 25.4e-6)
"""Lengths, m, whose names elsewhere are none, or mean something else."""


def length_named(unit: str) -> float:
    """Length, m, of a unit that a heading names, as instruments spell it."""
    if unit in OWN_NAMES:
        return OWN_NAMES[unit]
    try:
        spelt = unit.lower().replace("mikro", "micro").replace("è", "e").replace("ö", "o")
        return factor(unit if len(unit) <= 3 else spelt, "m")
    except InputError as error:
        correct = "Correct the header"
        remedy = advice("height_unit", "um", f"{correct}, or leave the bracket out and give", f"{correct}.")
        raise InputError("unit in the header", repr(unit), "a unit of length", remedy) from error
