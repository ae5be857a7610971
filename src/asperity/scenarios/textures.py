"""The textures of a case: samples that are reduced, and the path that is rolled over."""

from __future__ import annotations

import math
import warnings
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from asperity.config import BallOnBeamCase
from asperity.errors import InputError, ShortRecordWarning
from asperity.reference.rail_roughness import iso_3095_limit
from asperity.surfaces.heightmap import HeightMap, Profile
from asperity.surfaces.levelling import band_limit, level, resample
from asperity.surfaces.readers import read_surface, read_surfaces
from asperity.surfaces.synthesis import from_bands, from_map, self_affine

STRIP_WINDOWS = 8
"""Length of a synthesised strip for the filters, in windows."""

FORM_DEGREE = {"plane": 1, "quadratic": 2}


@dataclass(frozen=True, eq=False)
class Textures:
    """Everything rough in a case, on the grid of the contact solution.

    Attributes
    ----------
    maps : tuple of HeightMap
        Samples for the stiffness; empty where only a line is given.
    strips : tuple of HeightMap, shape (n, ny)
        Strips for the filters, as wide as the window.
    path : HeightMap or None, shape (rows, ny)
        Texture of the path with its neighbourhood; None where the path is a line.
    line : ndarray, shape (rows,)
        Line texture of the path, m, peaks positive.
    margin : int
        Rows before the place where the ball starts.
    missing_share : float
        Share of points without a height in the measured file.
    origin : str
        Where samples and path come from, in one sentence.
    """

    maps: tuple[HeightMap, ...]
    strips: tuple[HeightMap, ...]
    path: HeightMap | None
    line: NDArray[np.float64]
    margin: int
    missing_share: float
    origin: str


def window_cells(case: BallOnBeamCase) -> int:
    """Cells along the window's side: odd, so that the ball's lowest point lies on a cell."""
    return 2 * (case.contact.cells // 2) + 1


def gather(case: BallOnBeamCase, margin: int) -> Textures:
    """Read or synthesise all textures of a case.

    Parameters
    ----------
    case : BallOnBeamCase
        The case.
    margin : int
        Rows needed before the start of the path and beyond its end.

    Returns
    -------
    Textures
        Samples, strips and path.

    Raises
    ------
    InputError
        If a file does not hold what the case needs of it.
    """
    seeds = [int(s) for s in np.random.SeedSequence(case.seed).generate_state(case.contact.samples + 1)]
    ny, spacing = window_cells(case), case.contact.spacing
    rows = math.ceil(case.rolled_time * case.speed / spacing) + 1 + 2 * margin
    missing, origin = 0.0, ""
    maps: tuple[HeightMap, ...] = ()
    strips: tuple[HeightMap, ...] = ()
    path = None
    if case.surface.file is not None:
        maps, missing = _measured(case)
        strips, strip_origin = _strips_of(maps, case, ny, seeds[1:])
        path, path_origin = _path_of(maps, (rows, ny), seeds[0])
        origin = f"{len(maps)} measured from {case.surface.file.name}; {strip_origin}; {path_origin}"
    elif case.surface.rms is not None:
        strips = tuple(_synthesised(case, (_strip_rows(case, ny), ny), seed) for seed in seeds[1:])
        maps, path = strips, _synthesised(case, (rows, ny), seeds[0])
        origin = "samples and path synthesised: self-affine, Gaussian"
    if case.surface.has_line:
        line, line_origin = _line(case, rows, 2 * margin + 2, seeds[0])
        path, origin = None, "; ".join(filter(None, [origin, line_origin]))
    elif path is not None:
        line = path.heights[:, ny // 2]
    return Textures(maps, strips, path, line, margin, missing, origin)


def _measured(case: BallOnBeamCase) -> tuple[tuple[HeightMap, ...], float]:
    """Maps of the file, levelled and on the contact grid, and the share of missing points."""
    surface, hints = case.surface, {}
    assert surface.file is not None
    for name in ("array", "height_unit", "pixel"):
        if getattr(surface, name) is not None:
            hints[name] = getattr(surface, name)
    found: Sequence[HeightMap | Profile]
    if surface.index is not None:
        found = [read_surface(surface.file, index=surface.index, fill=surface.fill, **hints)]
    else:
        found = read_surfaces(surface.file, fill=surface.fill, **hints)
    result, degree = [], FORM_DEGREE[surface.form]
    for measured in found:
        if not isinstance(measured, HeightMap):
            remedy = "A single line can be the path: give it as surface.line."
            raise InputError("surface.file", "a line of heights", "maps of heights", remedy)
        if measured.missing_share > 0.0:
            received = f"{100 * measured.missing_share:.2g} % of the points without a height"
            raise InputError("surface.file", received, "complete maps", "Set fill = true in [surface].")
        if max(measured.spacing) > case.contact.spacing * (1 + 1e-9):
            warnings.warn(
                f"the map's points are {max(measured.spacing) * 1e6:.3g} µm apart, more than contact.spacing "
                f"= {case.contact.spacing * 1e6:.3g} µm: shorter waves are missing. Coarsen contact.spacing.",
                ShortRecordWarning,
                stacklevel=2,
            )
        on_grid = level(resample(level(measured, degree), case.contact.spacing), degree)
        longest, shortest = surface.band
        limited = longest is not None or shortest is not None
        result.append(band_limit(on_grid, longest=longest, shortest=shortest) if limited else on_grid)
    return tuple(result), float(np.mean([m.missing_share for m in found]))


def _strip_rows(case: BallOnBeamCase, ny: int) -> int:
    wanted = case.contact.sample_length
    return STRIP_WINDOWS * ny if wanted is None else math.ceil(wanted / case.contact.spacing)


def _strips_of(
    maps: tuple[HeightMap, ...], case: BallOnBeamCase, ny: int, seeds: list[int]
) -> tuple[tuple[HeightMap, ...], str]:
    """Strips for the filters: cut from the maps where these are long enough, else in their likeness."""
    rows = _strip_rows(case, ny)
    longest = min(m.shape[0] for m in maps)
    if case.contact.sample_length is None and longest >= rows // 2:
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


def _path_of(maps: tuple[HeightMap, ...], shape: tuple[int, int], seed: int) -> tuple[HeightMap, str]:
    first = maps[0]
    if first.shape[0] >= shape[0] and first.shape[1] >= shape[1]:
        middle = (first.shape[1] - shape[1]) // 2
        heights = first.heights[: shape[0], middle : middle + shape[1]]
        return HeightMap(heights - heights.mean(), first.spacing, first.source), "path cut from the first"
    return from_map(maps, shape, seed), "path synthesised in their likeness"


def _synthesised(case: BallOnBeamCase, shape: tuple[int, int], seed: int) -> HeightMap:
    surface, spacing = case.surface, case.contact.spacing
    longest, shortest = surface.band
    assert surface.rms is not None
    assert longest is not None
    assert shortest is not None
    return self_affine(
        shape,
        (spacing, spacing),
        rms=surface.rms,
        hurst=surface.hurst,
        longest=longest,
        shortest=shortest,
        anisotropy=surface.anisotropy,
        seed=seed,
    )


def _line(case: BallOnBeamCase, rows: int, least: int, seed: int) -> tuple[NDArray[np.float64], str]:
    spacing = case.contact.spacing
    if case.surface.spectrum is not None:
        wavelengths, levels = iso_3095_limit()
        # a line that closes on itself: longer than the path and than the longest band
        points = max(rows, math.ceil(1.2 * wavelengths.max() / spacing))
        profile = from_bands(points, spacing, wavelengths, levels + case.surface.level, seed)
        return profile.heights[:rows], f"path of ISO 3095:2013 limit {case.surface.level:+g} dB"
    assert case.surface.line is not None
    measured = read_surface(case.surface.line)
    if not isinstance(measured, Profile):
        remedy = "Give a map as surface.file."
        raise InputError("surface.line", "a map of heights", "a line of heights", remedy)
    if measured.missing_share > 0.0:
        raise InputError("surface.line", "points without a height", "a complete line", "Fill it first.")
    profile = level(resample(level(measured), spacing))
    length = profile.heights.size * spacing
    if case.duration is None:
        rows = min(rows, profile.heights.size)  # the run lasts as long as the line
    if profile.heights.size < rows or rows < least:
        raise InputError(
            "surface.line",
            f"{length:.4g} m",
            f"at least {max(rows, least) * spacing:.4g} m: the path and a window at both ends",
            "Give a shorter duration, or a longer line.",
        )
    return profile.heights[:rows], f"path measured, {case.surface.line.name}"
