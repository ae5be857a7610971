"""Ball bearings by name: what makers and authors print of their inside, as ``bearings.toml`` holds it."""

import difflib
import math
import tomllib
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from decimal import Decimal
from itertools import groupby
from typing import Any

from asperity.arguments import shown
from asperity.errors import InputError
from asperity.files import packaged

NEAR = 3
"""Names that are told where one is not known, at most."""
TONES = ("cage", "outer", "inner", "ball")
"""Tones as they are printed, the ball's that of a spot, which meets both rings in a turn."""


@dataclass(frozen=True)
class ListedBearing:
    """A bearing whose balls are printed, lengths in m and angles in rad; None where nothing is printed.

    Parameters
    ----------
    name, maker : str
        Name in a case, and the designation of its maker.
    citation, prints : str
        Where it is printed, and what.
    balls : int
        Z.
    ball_diameter, pitch_diameter : float
        D and d_m; this one is the mean of bore and outside diameter unless it is printed.
    is_pitch_printed : bool
        Whether it is.
    contact_angle : float or None
        Of angular contact bearings.
    bore, outside_diameter, width : float or None
        Boundary dimensions.
    tones : tuple of float
        `TONES` in turns of the shaft, where they are printed.
    """

    name: str
    maker: str
    citation: str
    prints: str
    balls: int
    ball_diameter: float
    pitch_diameter: float
    is_pitch_printed: bool
    contact_angle: float | None
    bore: float | None
    outside_diameter: float | None
    width: float | None
    tones: tuple[float, ...]

    @property
    def dimensions(self) -> dict[str, Any]:
        """Keywords of `asperity.BallBearing`."""
        found = {name: getattr(self, name) for name in ("balls", "ball_diameter", "pitch_diameter")}
        return found if self.contact_angle is None else found | {"contact_angle": self.contact_angle}

    @property
    def sentence(self) -> str:
        """What is printed where, and what is not."""
        pitch = (
            "" if self.is_pitch_printed else "the pitch diameter is the mean of bore and outside diameter, "
        )
        chosen = "grooves" if self.contact_angle else "grooves and clearance"
        printed = f"{self.maker}, {self.prints} as printed by {self.citation}"
        return f"{printed}; {pitch}{chosen} chosen here or given."

    @property
    def cells(self) -> tuple[str, ...]:
        """A row of `COLUMNS`: – where nothing is printed, a pitch diameter that is not in ( )."""
        sides = (self.bore, self.outside_diameter, self.width)
        boundary = " × ".join(_millimetres(each) for each in sides if each is not None) or "–"
        pitch = _millimetres(self.pitch_diameter)
        angle = "–" if self.contact_angle is None else f"{math.degrees(self.contact_angle):g}°"
        balls = str(self.balls), _millimetres(self.ball_diameter)
        return (
            *(self.name, self.maker, boundary, *balls),
            *(pitch if self.is_pitch_printed else f"({pitch})", angle),
        )


COLUMNS = ("name", "maker's", "d × D × B / mm", "balls", "ball / mm", "pitch / mm", "angle")
"""Of a table of them."""
PITCH = "Pitch diameters in ( ) are not printed: they are the mean of bore and outside diameter."


def by_citation(of: Iterable[ListedBearing]) -> Iterator[tuple[str, str, list[ListedBearing]]]:
    """Bearings of each source: its citation, what it prints, and they."""
    for (citation, prints), group in groupby(of, lambda each: (each.citation, each.prints)):
        yield citation, prints, list(group)


def _millimetres(length: float) -> str:
    return f"{1e3 * length:.6g}"


def _metres(millimetres: Decimal | int) -> float:
    """Exactly the number that is written, in m."""
    return float(Decimal(millimetres).scaleb(-3))


def _printed(row: Mapping[str, Any], symbol: str) -> float | None:
    """A length of a row, m, if it is printed."""
    return _metres(row[symbol]) if symbol in row else None


def _pitch_diameter(row: Mapping[str, Any]) -> float:
    """As it is printed, or the mean of bore and outside diameter, m."""
    return _metres(row["Dpw"] if "Dpw" in row else Decimal(row["d"] + row["D"]) / 2)


def _read() -> dict[str, ListedBearing]:
    """All bearings of the file, by name."""
    found: dict[str, ListedBearing] = {}
    for source in tomllib.loads(packaged("reference/bearings.toml"), parse_float=Decimal)["source"]:
        angle = source.get("contact_angle")
        for row in source["bearings"]:
            found[row["name"]] = ListedBearing(
                name=row["name"],
                maker=row["maker"],
                citation=source["citation"],
                prints=source["prints"],
                balls=row["Z"],
                ball_diameter=_metres(row["Dw"]),
                pitch_diameter=_pitch_diameter(row),
                is_pitch_printed="Dpw" in row,
                contact_angle=None if angle is None else math.radians(angle),
                bore=_printed(row, "d"),
                outside_diameter=_printed(row, "D"),
                width=_printed(row, "B"),
                tones=tuple(map(float, row.get("tones", ()))),
            )
    return found


LISTED: Mapping[str, ListedBearing] = _read()
"""All bearings by name, as they stand in the file."""
LISTING = "asperity bearing --list"
"""The command that prints them."""


def near_names(word: object) -> tuple[str, ...]:
    """Names that a word may mean: those that it holds, or of which it is the maker's, else the nearest."""
    asked = str(word).casefold().strip()
    names = {name.casefold(): name for name in LISTED}
    makers = {each.maker.casefold(): each.name for each in LISTED.values()}
    held = [name for folded, name in names.items() if folded in asked]
    held += [name for maker, name in makers.items() if asked in maker.split(" ", 1)[-1:] or asked == maker]
    near = difflib.get_close_matches(asked[:40], list(names), n=NEAR, cutoff=0.6)
    return tuple(dict.fromkeys(held))[:NEAR] or tuple(names[each] for each in near)


def named_bearings(word: object = "") -> str:
    """Sentence about the names that there are, those first that a word may mean."""
    near = near_names(word) if word else ()
    meant = f"Did you mean {' or '.join(near)}? " if near else ""
    return f"{meant}{len(LISTED)} bearings have a name: {LISTING}."


def listed_bearing(name: object) -> ListedBearing:
    """A bearing by its name; an `InputError` tells near ones."""
    if not isinstance(name, str) or name not in LISTED:
        raise InputError("bearing", shown(name), "a bearing that has a name", named_bearings(name))
    return LISTED[name]
