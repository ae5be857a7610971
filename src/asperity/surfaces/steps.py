"""What is done to a measured surface once it is read, in one order: cut, form, filters, direction."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TypeVar

from asperity.arguments import FORMS as POLYNOMIALS
from asperity.errors import InputError
from asperity.surfaces.heightmap import HeightMap, Profile
from asperity.surfaces.levelling import Surface, band_limit, level, remove_form
from asperity.surfaces.readers.headers import spell
from asperity.surfaces.rotation import rotated

S = TypeVar("S", HeightMap, Profile, HeightMap | Profile)
FORMS = (*POLYNOMIALS, "sphere", "cylinder")


def stepped(
    surface: S,
    *,
    crop: Sequence[float] | None = None,
    form: str | None = None,
    longest: float | None = None,
    shortest: float | None = None,
    direction: float | None = None,
) -> S:
    """Cut a piece, remove a form, filter, and turn into the direction of rolling; None leaves a step out.

    `crop` is x, y and the two lengths of the piece of a map, position and length of that of a line, m; `form`
    one of "plane", "quadratic", "sphere", "cylinder"; `longest` and `shortest` are the nesting
    indices, m, of the L- and S-filter, see `levelling.band_limit`; `direction` is the angle, rad, of
    `rotation.rotated`.
    """
    if isinstance(surface, Profile):
        if direction is not None:
            raise InputError(spell("direction"), "a line", "a height map", "Leave it out.")
        return _finished(_line_piece(surface, crop), form, longest, shortest)
    done = _finished(_map_piece(surface, crop), form, longest, shortest)
    return done if direction is None else rotated(done, direction)


def _finished(surface: Surface, form: str | None, longest: float | None, shortest: float | None) -> Surface:
    if form == "sphere":
        surface = remove_form(surface, "sphere")
    elif form == "cylinder":
        surface = remove_form(surface, "cylinder")
    elif form is not None:
        surface = level(surface, form)
    if longest is None and shortest is None:
        return surface
    return band_limit(surface, longest, shortest)


def _map_piece(surface: HeightMap, crop: Sequence[float] | None) -> HeightMap:
    if crop is None:
        return surface
    if len(crop) != 4:
        raise InputError(spell("crop"), f"{len(crop)} lengths", "four of a map: x, y and both sides")
    return surface.crop((crop[0], crop[1]), (crop[2], crop[3]))


def _line_piece(surface: Profile, crop: Sequence[float] | None) -> Profile:
    if crop is None:
        return surface
    if len(crop) != 2:
        raise InputError(
            "crop", f"{len(crop)} lengths", "two of a line: where the piece begins, and its length"
        )
    return surface.crop(crop[0], crop[1])
