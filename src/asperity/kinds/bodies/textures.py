"""The textures of bodies that roll: that of the path, and one of its own around each of them."""

from __future__ import annotations

import math
from dataclasses import replace
from functools import partial
from typing import Any

import numpy as np
from numpy.typing import NDArray

from asperity.config.content import name_of
from asperity.config.tables import TableSource, read_levels
from asperity.errors import InputError
from asperity.kinds.bodies.case import Bodies
from asperity.kinds.wheel_on_rail.defects import flat_along
from asperity.kinds.wheel_on_rail.textures import FULL_TURN, JOIN, warn_of_defects
from asperity.reference import cnossos
from asperity.scenarios.geometry import Geometry, window_cells
from asperity.scenarios.laws import OwnContact
from asperity.scenarios.records import Grid, read_lines, spectrum_strip
from asperity.scenarios.textures import Textures
from asperity.scenes.textures import gather, warn_of_start
from asperity.surfaces.heightmap import HeightMap, Profile
from asperity.surfaces.levelling import level, resample
from asperity.surfaces.measured_lines import lines_of
from asperity.surfaces.strip import raised
from asperity.surfaces.synthesis import close

EQUAL = 1e-9
"""Relative difference of loads that are the same."""


def textures_of(case: Bodies) -> Textures:
    """Gather the texture of the path that all contacts roll over, with that of the first body on it."""
    ahead = max(case.body.offsets)
    textures = gather(case, window_cells(case.contact), ahead)
    if case.body.roughness is not None or case.body.line is not None:
        turns = [_turn(case, k) for k in range(len(textures.strips) + 1)]
        pairs = zip(textures.strips, turns[1:], strict=True)
        strips = tuple(_with_turn(strip, turn) for strip, turn in pairs)
        maps = strips if textures.maps is textures.strips else textures.maps
        origin = f"{textures.origin}; what rolls: {_named(case)}, around its circumference"
        textures = replace(textures, maps=maps, strips=strips, origin=origin)
    return _of_contact(case, 0, textures)


def warn_of(case: Bodies, shape: Geometry, textures: Textures) -> None:
    """Warn of a record that holds the start, and of laws that do not see a flat."""
    warn_of_start(case, "set settling, or start farther on")
    if case.body.flat is not None:
        warn_of_defects(case, shape, case.body.flat)


def contacts_of(case: Bodies, loads: NDArray[np.float64]) -> tuple[list[int], list[OwnContact]]:
    """Which of the contacts differ from the first: for each, which one it equals; and those that differ.

    Loads (c,), N. Zero stands for the first contact, k for the k-th of the others.
    """
    which: list[int] = []
    others: list[OwnContact] = []
    known: list[tuple[int, float]] = [(0, float(loads[0]))]
    for contact, load in enumerate(loads):
        texture = contact if _differs(case, contact) else 0
        found = next(
            (
                k
                for k, (own, at) in enumerate(known)
                if own == texture and math.isclose(at, load, rel_tol=EQUAL)
            ),
            None,
        )
        if found is None:
            found = len(known)
            known.append((texture, float(load)))
            others.append(OwnContact(partial(_of_contact, case, texture), float(load)))
        which.append(found)
    return which, others


def _differs(case: Bodies, contact: int) -> bool:
    """Whether the body of a contact bears another texture than that of the first."""
    body = case.body
    flat = body.flat is not None and (contact + 1 in body.flat_contacts or 1 in body.flat_contacts)
    return body.roughness is not None or body.line is not None or flat


def _of_contact(case: Bodies, contact: int, first: Textures) -> Textures:
    """Textures of a contact, from those of the path or of the first: the turn of its own body is there."""
    bare = np.zeros(len(first.line))
    before, own = first.parts.get("wheel", bare), _around(case, first, contact)
    turned = _raised(first, own - before)
    parts = {"rail": first.line - before, "wheel": own}
    return replace(turned, parts=parts, **_flat(case, contact, first))


def _flat(case: Bodies, contact: int, textures: Textures) -> dict[str, Any]:
    """Heights of a flat on the body of a contact along the path, and of the body's centre rolling over it."""
    if case.body.flat is None or contact + 1 not in case.body.flat_contacts:
        return {"defects": None, "trajectory": None}
    spacing, start = case.contact.spacing, case.record_start + case.body.offsets[contact]
    position = textures.start + spacing * np.arange(len(textures.line), dtype=np.float64)
    turn = round(case.body.circumference / spacing)
    found = flat_along(case.body, position - start, turn * spacing, case.speed * case.rolled_time)
    return dict(zip(("defects", "trajectory"), found, strict=True))


def _raised(textures: Textures, added: NDArray[np.float64]) -> Textures:
    """Add heights that are the same all across, (rows,), m, to the path and its line."""
    path = None if textures.path is None else raised(textures.path, added)
    return replace(textures, path=path, line=textures.line + added)


def _around(case: Bodies, textures: Textures, contact: int) -> NDArray[np.float64]:
    """Heights of the turning body of a contact at the rows of the path, m."""
    if case.body.roughness is None and case.body.line is None:
        return np.zeros(len(textures.line))
    turn = _turn(case, contact)
    return turn[np.arange(len(textures.line)) % len(turn)]


def _turn(case: Bodies, contact: int) -> NDArray[np.float64]:
    """Heights around the circumference of the body of a contact, m: another texture of each."""
    spacing, around = case.contact.spacing, case.body.circumference
    points = round(around / spacing)
    if case.body.line is not None:
        return _measured_turn(case, contact)
    wavelength, levels, name = _levels(case)
    seed = int(np.random.SeedSequence([case.seed, 1, contact]).generate_state(1)[0])
    grid = Grid(points, 2, spacing)  # of lines that are alike
    levels = levels + case.body.roughness_level
    strip = spectrum_strip(wavelength, levels, grid, lateral=math.inf, seed=seed, name=name)
    return np.ascontiguousarray(strip.heights[:, 0])


def _measured_turn(case: Bodies, contact: int) -> NDArray[np.float64]:
    """The measured line of a contact, once around and closed on itself, m."""
    measured = read_lines(case.body, "body")
    lines = (measured,) if isinstance(measured, Profile) else lines_of(measured)
    line, whole, spacing = lines[contact % len(lines)], case.body.circumference, case.contact.spacing
    length = len(line.heights) * line.spacing
    if line.missing_share > 0.0 or length < (1.0 - FULL_TURN) * whole:
        received = f"{length:.4g} m" + ", with gaps" * bool(line.missing_share)
        allowed = f"a full turn of body.radius, {whole:.4g} m, or up to {100 * FULL_TURN:g} % less, complete"
        raise InputError("body.line", received, allowed, "Does body.radius fit what was measured?")
    once = line.heights[: round(whole / line.spacing)] if length > (1.0 + FULL_TURN) * whole else line.heights
    fine = resample(level(Profile(once, line.spacing), 0), spacing).heights
    return close(fine[:, None], round(JOIN / spacing))[:, 0]


def _named(case: Bodies) -> str:
    return f"measured, {name_of(case.body.line)}" if case.body.line is not None else _levels(case)[2]


def _levels(case: Bodies) -> tuple[NDArray[np.float64], NDArray[np.float64], str]:
    """Wavelengths, m, and levels, dB re 1 µm, of what rolls, and a name."""
    given = case.body.roughness
    assert given is not None
    if isinstance(given, str):
        return *cnossos.wheel_roughness(given), given
    table: TableSource = given
    return *read_levels(table), name_of(table)


def _with_turn(strip: HeightMap, turn: NDArray[np.float64]) -> HeightMap:
    """Add a body's texture to a sample."""
    rows = strip.shape[0]
    added = np.resize(turn, rows)
    return HeightMap(strip.heights + (added - added.mean())[:, None], strip.spacing, strip.source)
