"""What is in a measured file: size, spacing, missing points, statistics with bandwidth, and a picture."""

from __future__ import annotations

import math
import re
from collections.abc import Iterable
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from asperity.errors import InputError
from asperity.files import atomic_write
from asperity.surfaces.readers.spelling import on_command_line, spelled
from asperity.terminal import say

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from asperity.surfaces.heightmap import HeightMap, Profile
    from asperity.surfaces.statistics import Statistic


def inspect(
    file: Path,
    picture: Path | None,
    *,
    array: str | None = None,
    index: int | None = None,
    lines: bool | None = None,
    **hints: Any,
) -> None:
    """Print what is in a measured file, and draw it.

    The ending of `picture` names its format; by default its name is made of those of file, array and map, in
    the working folder. `index` says which map of an ensemble, `lines` whether an array of two dimensions
    holds lines measured side by side; by default its shape tells. Hints are as `read_surface` takes them.
    """
    chosen = [str(part) for part in (array, index) if part is not None]
    if picture is None:
        picture = Path(
            "-".join([file.stem, *(re.sub(r"[^\w.]+", "-", part) for part in chosen), "surface.png"])
        )
    formats = (".png", ".pdf", ".svg")
    if picture.suffix.lower() not in formats:
        raise InputError("picture", f"'{picture}'", f"a name that ends in {', '.join(formats)}")
    if picture.resolve() == file.resolve():
        raise InputError("picture", f"'{picture}'", "another name than that of the measured file")
    with spelled(on_command_line):
        surfaces = read_measured(file, index, array=array, **hints)
    title = ", ".join(filter(None, [file.name, array, "" if index is None else f"map {index}"]))
    if side_by_side := _as_lines(surfaces, lines):
        _inspect_lines(side_by_side, title, picture, told=lines is not None)
        return
    say(f"{title}: {described(surfaces)}")
    first = surfaces[0].levelled()
    if len(surfaces) > 1:
        say(f"Statistics of the first of {len(surfaces)} maps; choose another one with --index.")
        title += f", the first of {len(surfaces)} maps"
    for line in statistics_lines(first):
        say(line)
    if line := homogeneity_line(first):
        say(line)
    say(f"Picture: {draw(first, title, picture).resolve()}")


def _as_lines(surfaces: list[HeightMap | Profile], told: bool | None) -> tuple[Profile, ...]:
    """Lines side by side, where the user or the shape of an array says so; else none."""
    from asperity.surfaces.heightmap import HeightMap
    from asperity.surfaces.parallel_lines import are_lines, lines_of

    first = surfaces[0]
    if len(surfaces) > 1 or not isinstance(first, HeightMap):
        return ()
    return lines_of(first) if (are_lines(first) if told is None else told) else ()


def _inspect_lines(lines: tuple[Profile, ...], title: str, picture: Path, *, told: bool) -> None:
    """Print what is in lines side by side, and draw them."""
    from asperity.reporting.texture import lines_picture
    from asperity.surfaces.statistics import line_statistics

    say(f"{title}: {described_lines(lines)}")
    if not told:
        say("Taken for lines measured side by side, by its shape; --map takes it for a map.")
    levelled = [line.levelled() for line in lines]
    found = line_statistics(levelled)
    say(f"Each line levelled; wavelengths {_band(found[0][0])}; mean (lowest to highest of a line):")
    for item, low, high in found:
        spread = " to ".join(_scaled(replace(item, value=value)) for value in (low, high))
        say(f"  {item.symbol:4} {_scaled(item):>12}  {item.meaning} ({spread})")
    figure = lines_picture([line.heights for line in levelled], lines[0].spacing, title)
    say(f"Picture: {_saved(figure, picture).resolve()}")


def read_measured(file: Path, index: int | None = None, **hints: Any) -> list[HeightMap | Profile]:
    """Read the map, the line, or all maps of an ensemble; hints are as `read_surface` takes them."""
    from asperity.surfaces.readers import read_surface, read_surfaces

    if index is not None:
        return [read_surface(file, index=index, **hints)]
    try:
        return [read_surface(file, **hints)]
    except InputError as error:
        if error.allowed != "one sample":
            raise
    return list(read_surfaces(file, **hints))


def described(surfaces: list[HeightMap | Profile]) -> str:
    """Say in one line what was read."""
    import numpy as np

    first = surfaces[0]
    sizes, spacings = np.atleast_1d(first.size), np.atleast_1d(first.spacing)
    kind = "map" if len(sizes) == 2 else "line"
    many = f"{len(surfaces)} {kind}s, each" if len(surfaces) > 1 else f"a {kind} of"
    points = " × ".join(map(str, first.shape))
    extent = f"{_lengths(sizes)}, {_lengths(spacings)} apart"
    missing = max(surface.missing_share for surface in surfaces)
    return f"{many} {points} points, {extent}, {missing:.2%} without a height"


def described_lines(lines: tuple[Profile, ...]) -> str:
    """Say in one line what lines side by side are."""
    first, missing = lines[0], sum(line.missing_share for line in lines) / len(lines)
    return (
        f"{len(lines)} parallel lines, each of {len(first.heights)} points, {_lengths([first.size])}, "
        f"{_lengths([first.spacing])} apart, {missing:.2%} without a height"
    )


def _lengths(metres: Iterable[float]) -> str:
    """Lengths in the one unit that suits the largest: ``"0.8 × 0.4 mm"``."""
    found = list(metres)
    units = ((1.0, 1.0, "m"), (0.05e-3, 1e3, "mm"), (0.0, 1e6, "µm"))
    scale, unit = next((scale, unit) for least, scale, unit in units if max(found) >= least)
    return " × ".join(f"{each * scale:.4g}" for each in found) + f" {unit}"


def statistics_lines(surface: HeightMap | Profile) -> list[str]:
    """Lines of a table of the roughness parameters of a levelled surface."""
    from asperity.surfaces.heightmap import HeightMap
    from asperity.surfaces.statistics import areal_statistics, profile_statistics

    found: list[Statistic]
    if isinstance(surface, HeightMap):
        found = areal_statistics(surface)
    else:
        found = profile_statistics(surface)
    head = f"Levelled; wavelengths {_band(found[0])}:"
    return [head, *(f"  {item.symbol:4} {_scaled(item):>12}  {item.meaning}" for item in found)]


def _band(item: Statistic) -> str:
    return " to ".join(_lengths([float(f"{wavelength:.3g}")]) for wavelength in item.bandwidth)


def _scaled(item: Statistic) -> str:
    if not math.isfinite(item.value):
        return "–"
    if item.unit == "rad":
        return f"{math.degrees(item.value):.0f}°"
    return f"{item.value * 1e6:.4g} µm" if item.unit == "m" else f"{item.value:.4g}"


def homogeneity_line(surface: HeightMap | Profile) -> str:
    """Say whether the texture of a map is the same everywhere; nothing of a line."""
    import numpy as np

    from asperity.surfaces.heightmap import HeightMap
    from asperity.surfaces.homogeneity import TILES, homogeneity

    if not isinstance(surface, HeightMap) or min(surface.shape) < 2 * max(TILES):
        return ""
    if not np.isfinite(surface.heights).all():
        return "Homogeneity and Std are those of a complete map: --fill fills points without a height."
    found = homogeneity(surface)
    tiles = " × ".join(map(str, found.tile_rms.shape))
    verdict = "the same everywhere, as far as chance tells"
    if not found.homogeneous:
        verdict = "not the same everywhere: a piece of it does not stand for another"
    return (
        f"Homogeneity: mean squares of {tiles} tiles vary by {100 * found.variation:.0f} %, of stationary "
        f"textures like it by {100 * found.expected:.0f} % (p = {found.p_value:.2g}): {verdict}"
    )


def draw(surface: HeightMap | Profile, title: str, picture: Path) -> Path:
    """Draw a levelled surface to a PNG, PDF or SVG file."""
    from asperity.reporting.texture import surface_picture
    from asperity.surfaces.heightmap import HeightMap

    spacing = surface.spacing if isinstance(surface, HeightMap) else (surface.spacing, surface.spacing)
    return _saved(surface_picture(surface.heights, spacing, title), picture)


def _saved(figure: Figure, picture: Path) -> Path:
    return atomic_write(
        picture, lambda file: figure.savefig(file, format=picture.suffix[1:].lower(), dpi=150)
    )
