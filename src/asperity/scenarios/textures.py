"""The textures of a case: samples that are reduced, and the path that is rolled over."""

from __future__ import annotations

import math
import warnings
from dataclasses import dataclass, field
from typing import cast

import numpy as np
from numpy.typing import NDArray

from asperity.config.sections import ContactCase, Surface
from asperity.errors import InputError, ShortRecordWarning
from asperity.scenarios.geometry import window_cells
from asperity.scenarios.records import read_maps
from asperity.surfaces.heightmap import HeightMap, Profile
from asperity.surfaces.levelling import band_limit, level, resample
from asperity.surfaces.statistics import rms_slope
from asperity.surfaces.steps import QUARTER, rotated
from asperity.surfaces.strip import LongStrip, Strip, raised
from asperity.surfaces.synthesis import (
    Continuation,
    extend,
    from_map,
    long_self_affine,
    long_strip_like,
    self_affine,
)

STRIP_WINDOWS = 16
"""Length of a strip for the filters, in windows: few bins of its spectra span the fall of a filter else."""
FEWEST_WINDOWS = 4
"""Least length of maps that strips are cut from, in windows, where the case does not ask for more."""

READ_POINTS = 2**18
"""Points of a path that are read in one go (2 MiB)."""

MOST_POINTS = 2.0**27
"""Points of a measured map on the contact grid (1 GiB)."""


@dataclass(frozen=True, eq=False)
class Textures:
    """Everything rough in a case, on the grid of the contact solution."""

    maps: tuple[HeightMap, ...]  # samples for the stiffness; empty where only a line is given
    strips: tuple[HeightMap, ...]  # (n, ny) each, for the filters, as wide as the window
    # (rows, ny), texture of the path with its neighbourhood; None where the path is a line
    path: Strip | None
    line: NDArray[np.float64]  # (rows,), texture of the path, m, peaks positive
    start: float  # position of the first row, m
    before: int  # rows of the path before the place where the record starts
    beyond: int  # rows beyond its end
    missing_share: float  # of points without a height in the measured file
    origin: str  # where samples and path come from, in one sentence
    # line textures that `line` is the sum of, by the body that bears them, m
    parts: dict[str, NDArray[np.float64]] = field(default_factory=dict)
    # (rows,), heights of defects along the path, m; neither in `line` nor in `path`
    defects: NDArray[np.float64] | None = None
    trajectory: NDArray[np.float64] | None = None  # (rows,), height of the rolling body's centre over them, m
    # whether heights beside the line are a texture of their own, not carried over from lines
    areal: bool = True
    # measured ones that a texture is interpolated between, by the body that bears them, m
    lines: dict[str, tuple[Profile, ...]] = field(default_factory=dict)
    untouched: Textures | None = None  # as they were before running-in; None where they still are

    @property
    def rms_slope(self) -> float:
        """Rms slope of the samples on the contact grid."""
        return float(np.sqrt(np.mean([rms_slope(sample) ** 2 for sample in self.maps])))

    @property
    def recorded(self) -> slice:
        """Rows over which the record runs."""
        return slice(self.before, len(self.line) - self.beyond)

    @property
    def widest_window(self) -> float:
        """Widest window that measured samples allow, m; synthesised ones are as wide as is asked for."""
        if self.untouched is not None:
            return self.untouched.widest_window
        if self.maps is self.strips:
            return math.inf
        cells = min(min(sample.shape) for sample in self.maps)
        return (cells - (cells + 1) % 2) * self.maps[0].spacing[0]  # windows have a middle cell

    @property
    def followed(self) -> NDArray[np.float64]:
        """Line texture with the trajectory over defects, m, peaks positive, shape (rows,)."""
        return self.line if self.trajectory is None else self.line + self.trajectory

    @property
    def surface(self) -> Strip:
        """The path with its defects, shape (rows, ny)."""
        assert self.path is not None
        return self.path if self.defects is None else raised(self.path, self.defects)


def measured_maps(surface: Surface, spacing: float) -> tuple[tuple[HeightMap, ...], float]:
    """Read the maps of a case's file, complete, levelled and on the contact grid of a spacing, m.

    With the share of points that had no height in the file.
    """
    found = read_maps(surface)
    result = []
    for measured in found:
        if not isinstance(measured, HeightMap):
            remedy = "A single line can be the path: give it as surface.line."
            raise InputError("surface.file", "a line of heights", "maps of heights", remedy)
        if measured.missing_share > 0.0:
            received = f"{100 * measured.missing_share:.2g} % of the points without a height"
            raise InputError("surface.file", received, "complete maps", "Set fill = true in [surface].")
        points = math.prod(measured.size) / spacing**2
        if points > MOST_POINTS:
            sides = " × ".join(f"{1e3 * side:.4g} mm" for side in measured.size)
            received = f"maps of {sides}, {points:.2g} points at contact.spacing = {spacing * 1e6:.3g} um"
            remedy = "Is the pixel in µm, not mm? Else cut the map, or coarsen contact.spacing."
            raise InputError("surface.file", received, f"at most {MOST_POINTS:.2g} points", remedy)
        if max(measured.spacing) > spacing * (1 + 1e-9):
            warnings.warn(
                f"the map's points are {max(measured.spacing) * 1e6:.3g} µm apart, more than contact.spacing "
                f"= {spacing * 1e6:.3g} µm: shorter waves are missing. Coarsen contact.spacing.",
                ShortRecordWarning,
                stacklevel=2,
            )
        along = _in_direction(level(measured, surface.form), surface.direction, spacing)
        on_grid = level(resample(along, spacing), surface.form)
        longest, shortest = surface.longest, surface.shortest
        limited = longest is not None or shortest is not None
        result.append(band_limit(on_grid, longest=longest, shortest=shortest) if limited else on_grid)
    return tuple(result), float(np.mean([m.missing_share for m in found]))


def _in_direction(measured: HeightMap, direction: float, spacing: float) -> HeightMap:
    """Turn a levelled map into the direction of rolling; no wave that the spacing, m, holds suffers."""
    if direction % QUARTER:
        measured = resample(measured, 0.5 * spacing)
    return rotated(measured, direction)


def direction_words(surface: Surface, maps: tuple[HeightMap, ...]) -> str:
    """Say in which direction measured maps are rolled over, if not along x, and what is left of the first."""
    if not surface.direction:
        return ""
    length, width = maps[0].size
    return (
        f", rolled over at {math.degrees(surface.direction):.4g}° to their x axis, on the largest rectangle "
        f"inside: {1e3 * length:.3g} mm × {1e3 * width:.3g} mm"
    )


def strip_rows(contact: ContactCase) -> int:
    """Rows of the contact grid in a strip for the filters."""
    wanted = contact.sample_length
    return STRIP_WINDOWS * window_cells(contact) if wanted is None else math.ceil(wanted / contact.spacing)


def strips_of(
    maps: tuple[HeightMap, ...], contact: ContactCase, seeds: list[int]
) -> tuple[tuple[HeightMap, ...], str]:
    """Take strips for the filters from measured maps, one for each seed, and say how.

    Cut from the maps where these are long enough, else synthesised in their likeness.
    """
    rows, ny = strip_rows(contact), window_cells(contact)
    longest = min(m.shape[0] for m in maps)
    if contact.sample_length is None and longest >= FEWEST_WINDOWS * ny:
        rows = min(rows, longest)
    if longest >= rows and min(m.shape[1] for m in maps) >= ny:
        cut = []
        for i in range(len(seeds)):
            heights = maps[i % len(maps)].heights
            share = (i // len(maps) + 0.5) / math.ceil(len(seeds) / len(maps))
            first = round(share * (heights.shape[1] - ny))
            cut.append(HeightMap(heights[:rows, first : first + ny], maps[0].spacing, maps[0].source))
        return tuple(level(strip) for strip in cut), "filter strips cut from them"
    strips = tuple(level(from_map(maps, (rows, ny), seed)) for seed in seeds)
    return strips, "filter strips synthesised in their likeness"


def cut_from(path: Strip, contact: ContactCase, duration: float, *, first: int = 0) -> tuple[HeightMap, ...]:
    """Cut strips for stiffness and filters from a path, spread evenly; one flat one if all are.

    The path of a run of a duration, s, from row `first` on.
    """
    rows, length = strip_rows(contact), path.shape[0] - first
    if length < rows:
        raise InputError(
            "duration",
            f"{duration:g} s, a path of {length * contact.spacing:.4g} m with its run-in",
            f"at least {rows * contact.spacing:.4g} m, the strips from which filters are estimated",
            "Roll longer, or lower contact.sample_length.",
        )
    count, spacing = contact.samples, (contact.spacing, contact.spacing)
    firsts = first + np.linspace(0, length - rows, count + 2)[1:-1].round().astype(int)
    found = tuple(level(HeightMap(path.rows(int(i), int(i) + rows), spacing)) for i in firsts)
    return found if any(strip.heights.any() for strip in found) else found[:1]


def path_of(
    maps: tuple[HeightMap, ...],
    shape: tuple[int, int],
    seed: int,
    run_in: int,
    before: int,
    continuation: str | None = None,
) -> tuple[Strip, str]:
    """Take the path (rows, ny) from measured maps, and say how.

    Cut from the first map where it is large enough, but for the run-in, whose rows are mirrored where it is
    too short. Else the first map is mirrored, or repeated, from behind the run-in on, where the case asks for
    that `continuation`; or the path is synthesised in their likeness, the same at every speed from the row
    `before` on, where the record starts.
    """
    first = maps[0]
    if first.shape[0] >= shape[0] - run_in and first.shape[1] >= shape[1]:
        middle = (first.shape[1] - shape[1]) // 2
        heights = first.heights[: shape[0], middle : middle + shape[1]]
        origin = "path cut from the first" + mirrored_words(heights, shape[0])
        path = mirrored_before(heights - heights.mean(), shape[0])
        return HeightMap(path, first.spacing, first.source), origin
    if continuation in ("mirror", "repeat"):
        return _continued(first, shape, run_in, cast(Continuation, continuation))
    return long_strip_like(maps, shape, seed, before=before), "path synthesised in their likeness"


def _continued(
    first: HeightMap, shape: tuple[int, int], run_in: int, how: Continuation
) -> tuple[HeightMap, str]:
    """Mirror or repeat the middle of a map along a path (rows, ny); a repeated one closes over a window."""
    rows, ny = shape
    if first.shape[1] < ny or rows * ny > MOST_POINTS:
        received = (
            f"{first.size[1] * 1e3:.4g} mm across" if first.shape[1] < ny else f"{rows * ny:.2g} points"
        )
        allowed = f"a map as wide as the window, and paths of at most {MOST_POINTS:.2g} points"
        raise InputError("surface.continuation", received, allowed, "Leave it out, or roll shorter.")
    middle = (first.shape[1] - ny) // 2
    heights = first.heights[:, middle : middle + ny]
    fade = min(ny, len(heights) // 2) if how == "repeat" else 0
    path = extend(
        heights - heights.mean(), rows, how, spacing=first.spacing[0], start=-run_in, crossfade=fade
    )
    return HeightMap(path, first.spacing, first.source), f"path cut from the first, {how}ed"


def mirrored_before(heights: NDArray[np.float64], rows: int) -> NDArray[np.float64]:
    """Put the mirror image of a texture (n, ...) before it, for a run-in over what was not measured.

    The texture is at the end of the (rows, ...), mirrored at its first point as often as it takes.
    """
    before = [(max(rows - len(heights), 0), 0), *((0, 0) for _ in heights.shape[1:])]
    return np.pad(heights, before, mode="reflect")


def mirrored_words(heights: NDArray[np.float64], rows: int) -> str:
    """Say that a run-in is mirrored, where it is."""
    return ", its mirror image for the run-in" if len(heights) < rows else ""


def middle_line(strip: Strip) -> NDArray[np.float64]:
    """Take the line (rows,) in the middle of a strip, m."""
    rows, ny = strip.shape
    piece = max(1, READ_POINTS // ny)
    lines = [strip.rows(i, min(i + piece, rows))[:, ny // 2].copy() for i in range(0, rows, piece)]
    return np.concatenate(lines)


def synthesised(surface: Surface, spacing: float, shape: tuple[int, int], seed: int) -> HeightMap:
    """Synthesise a self-affine, Gaussian texture (rows, ny) on a spacing, m."""
    return self_affine(shape, (spacing, spacing), **_self_affine_keys(surface), seed=seed)


def synthesised_path(
    surface: Surface, spacing: float, shape: tuple[int, int], seed: int, before: int
) -> LongStrip:
    """Synthesise a self-affine path as `synthesised` does, the same at every speed from row `before` on."""
    keys = _self_affine_keys(surface)
    return long_self_affine(shape, (spacing, spacing), **keys, seed=seed, before=before)


def _self_affine_keys(surface: Surface) -> dict[str, float]:
    longest, shortest = surface.longest, surface.shortest
    assert surface.rms is not None
    assert longest is not None
    assert shortest is not None
    keys = {"rms": surface.rms, "hurst": surface.hurst, "anisotropy": surface.anisotropy, "lay": surface.lay}
    return keys | {"longest": longest, "shortest": shortest}
