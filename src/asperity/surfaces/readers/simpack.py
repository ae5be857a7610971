"""Profiles of wheels and rails as Simpack writes them, and CONTACT reads them: ``.prw`` and ``.prr``."""

import re
from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np

from asperity.arguments import Array, require
from asperity.surfaces.heightmap import Profile
from asperity.surfaces.readers import guards, positions
from asperity.surfaces.readers.hints import Hints
from asperity.text_files import lines_in, number_or_nan, read_text
from asperity.written_numbers import count_of

LARGEST = 1 << 24
"""Bytes of a file; those of programs have some 20 kB."""
HEAD = 1 << 13
"""Bytes in which the header begins."""
POINTS = {"point.begin": True, "point.end": False}
"""Lines between which points stand."""
UNAPPLIED = ("shift.y", "shift.z", "rotate", "mirror.y", "mirror.z")
"""What the program does with points once it has read them."""
OUT_OF_MATERIAL = {0: -1.0, 1: 1.0}
"""Direction of heights by the type, rail or wheel: the one z of both points downwards."""
_KEY = re.compile(r"([a-z][a-z.]{0,40}) *= *'?([^ '!]{1,40})")


def holds_profile(path: Path) -> bool:
    """Whether a file has the header of such a profile."""
    with path.open("rb") as stream:
        return b"header.begin" in stream.read(HEAD)


def read(path: Path, hints: Hints) -> list[guards.Surface]:
    """Read the points of a profile, in any order, onto even places, see `positions.made_even`.

    Heights are out of the material: of a wheel its z, which points downwards, of a rail the other way.
    Lengths are in the unit that the file states, else in m. Shifts, turns and mirrors that it leaves to the
    program are refused.
    """
    hints.refuse(path.name, "Simpack")
    text = read_text(path, path.name, "a Simpack profile", largest=LARGEST, latin=True)
    stated: dict[str, float] = {}
    points: list[Array] = []
    inside = False
    for line in lines_in(text):
        words = line.partition("!")[0].strip()
        inside = POINTS.get(words, inside)
        if inside and words and words not in POINTS:
            points.append(_point(words.split(), path.name))
        elif match := _KEY.match(words):
            stated.setdefault(match[1], number_or_nan(match[2]))
    require(len(points) > 1, path.name, count_of(len(points), "point"), "two or more", guards.EXPORT)
    return [_section(np.array(points), stated, path.name)]


def _point(words: Sequence[str], source: str) -> Array:
    """Place and height of a point, whose weight may follow."""
    point = np.array([number_or_nan(word) for word in words])
    right = len(point) in (2, 3) and bool(np.isfinite(point).all())
    received = repr(" ".join(words)[:60])
    require(right, f"points of {source}", received, "y, z, and perhaps a weight", guards.EXPORT)
    return point[:2]


def _section(points: Array, stated: Mapping[str, float], source: str) -> Profile:
    kind = stated.get("type", np.nan)
    allowed = "0, a rail, or 1, a wheel"
    require(kind in OUT_OF_MATERIAL, f"type in {source}", f"{kind:g}", allowed, guards.EXPORT)
    per_metre = stated.get("units.len.f", 1.0)
    usual = 0.0 < per_metre <= 1e9
    require(usual, f"units.len.f in {source}", f"{per_metre:g}", "a number above 0, to 1e9", guards.EXPORT)
    for key in UNAPPLIED:
        remedy = "Apply it to the points, and export them."
        require(stated.get(key, 0.0) == 0.0, f"{key} in {source}", f"{stated.get(key, 0.0):g}", "0", remedy)
    y, z = points.T / per_metre
    heights, step = positions.made_even(y, OUT_OF_MATERIAL[int(kind)] * z, source)
    return Profile(heights, step, source, float(y.min()))
