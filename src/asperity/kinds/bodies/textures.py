"""The textures of bodies that roll: that of the path, and one of its own around each of them."""

from __future__ import annotations

import math
from dataclasses import replace
from functools import partial

import numpy as np
from numpy.typing import NDArray

from asperity.config.content import name_of
from asperity.config.tables import TableSource, read_levels
from asperity.kinds.bodies.case import Bodies
from asperity.reference import cnossos
from asperity.scenarios.chain import Further, warn_of_start
from asperity.scenarios.geometry import Geometry, window_cells
from asperity.scenarios.records import Grid, spectrum_strip
from asperity.scenarios.textures import Textures
from asperity.scenes.textures import gather
from asperity.surfaces.heightmap import HeightMap
from asperity.surfaces.strip import raised

EQUAL = 1e-9
"""Relative difference of loads that are the same."""


def textures_of(case: Bodies) -> Textures:
    """Gather the texture of the path that all contacts roll over, with that of the first body on it."""
    ahead = max(case.body.offsets)
    textures = gather(case, window_cells(case.contact), ahead)
    if case.body.roughness is None:
        return textures
    turns = [_turn(case, k) for k in range(len(textures.strips) + 1)]
    strips = tuple(_with_turn(strip, turn) for strip, turn in zip(textures.strips, turns[1:], strict=True))
    maps = strips if textures.maps is textures.strips else textures.maps
    name = _levels(case)[2]
    origin = f"{textures.origin}; what rolls: {name}, around its circumference"
    sampled = replace(textures, maps=maps, strips=strips, origin=origin)
    return _raised(sampled, _around(case, textures, 0))


def warn_of(case: Bodies, shape: Geometry, textures: Textures) -> None:
    """Warn of a record that holds the start."""
    warn_of_start(case, "set settling, or start farther on")


def contacts_of(case: Bodies, loads: NDArray[np.float64]) -> tuple[list[int], list[Further]]:
    """Which of the contacts differ from the first: for each, which one it equals; and those that differ.

    Loads (c,), N. Zero stands for the first contact, k for the k-th of the others.
    """
    which: list[int] = []
    others: list[Further] = []
    known: list[tuple[int, float]] = [(0, float(loads[0]))]
    for contact, load in enumerate(loads):
        texture = contact if case.body.roughness is not None else 0
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
            others.append(Further(partial(_of_contact, case, texture), float(load)))
        which.append(found)
    return which, others


def _of_contact(case: Bodies, contact: int, first: Textures) -> Textures:
    """Textures of a contact from those of the first: the turn of its own body stands for the other one's."""
    if not contact:
        return first
    return _raised(first, _around(case, first, contact) - _around(case, first, 0))


def _raised(textures: Textures, added: NDArray[np.float64]) -> Textures:
    """Add heights that are the same all across, (rows,), m, to the path and its line."""
    path = None if textures.path is None else raised(textures.path, added)
    return replace(textures, path=path, line=textures.line + added)


def _around(case: Bodies, textures: Textures, contact: int) -> NDArray[np.float64]:
    """Heights of the turning body of a contact at the rows of the path, m."""
    turn = _turn(case, contact)
    return turn[np.arange(len(textures.line)) % len(turn)]


def _turn(case: Bodies, contact: int) -> NDArray[np.float64]:
    """Heights around the circumference of the body of a contact, m: another texture of each."""
    spacing = case.contact.spacing
    points = round(2.0 * math.pi * case.body.radius / spacing)
    wavelength, level, name = _levels(case)
    seed = int(np.random.SeedSequence([case.seed, 1, contact]).generate_state(1)[0])
    grid = Grid(points, 2, spacing)  # of lines that are alike
    level = level + case.body.roughness_level
    strip = spectrum_strip(wavelength, level, grid, lateral=math.inf, seed=seed, name=name)
    return np.ascontiguousarray(strip.heights[:, 0])


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
