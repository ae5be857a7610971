"""What is in a measured file: size, spacing, missing points, statistics with bandwidth, and a picture."""

from __future__ import annotations

import math
import re
from collections.abc import Iterable
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from asperity.arguments import shown
from asperity.errors import InputError
from asperity.files import atomic_write
from asperity.surfaces.readers.spelling import on_command_line, spelled
from asperity.terminal import say
from asperity.units import quantity

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from asperity.cli.surface_spectra import Spectra
    from asperity.surfaces.heightmap import HeightMap, Profile
    from asperity.surfaces.statistics import Statistic


def inspect(
    file: Path,
    picture: Path | None,
    *,
    array: str | None = None,
    index: int | None = None,
    lines: bool | None = None,
    rotate: str | None = None,
    psd: bool = False,
    **hints: Any,
) -> dict[str, Any]:
    """Print what is in a measured file, and draw it; return what a program wants to know.

    The ending of `picture` names its format; by default its name is made of those of file, array and map, in
    the working folder. `index` says which map of an ensemble, `lines` whether an array of two dimensions
    holds lines measured side by side; by default its shape tells. `rotate` is the direction to roll in, with
    its unit or in degrees; `psd` says whether the spectra go to a CSV file beside the picture. Hints are as
    `read_surface` takes them.
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
    direction = None if rotate is None else _angle(rotate)
    with spelled(on_command_line):
        surfaces = read_measured(file, index, array=array, **hints)
    if direction is not None:
        surfaces = [_turned(surface, direction) for surface in surfaces]
    title = ", ".join(filter(None, [file.name, array, "" if index is None else f"map {index}"]))
    told = {"file": str(file.resolve()), "array": array, "index": index, **_sizes(surfaces), "warnings": []}
    if side_by_side := _as_lines(surfaces, lines):
        return told | _inspect_lines(side_by_side, title, picture, told=lines is not None, psd=psd)
    return told | _inspect_first(surfaces, title, picture, psd=psd)


def _inspect_first(
    surfaces: list[HeightMap | Profile], title: str, picture: Path, *, psd: bool
) -> dict[str, Any]:
    """Print what is in the first of maps, or in a line, and draw it."""
    from asperity.cli.surface_spectra import spectra_of

    say(f"{title}: {described(surfaces)}")
    first = surfaces[0].levelled()
    if len(surfaces) > 1:
        say(f"Statistics of the first of {len(surfaces)} maps; choose another one with --index.")
        title += f", the first of {len(surfaces)} maps"
    found = statistics_of(first)
    for line in statistics_lines(found):
        say(line)
    homogeneous, line = homogeneity_of(first)
    if line:
        say(line)
    spectra = spectra_of(first)
    drawn = draw(first, title, picture, spectra)
    say(f"Picture: {drawn.resolve()}")
    return {
        "statistics": [_documented(item) for item in found],
        "homogeneity": homogeneous,
        "files": {"picture": str(drawn.resolve())} | _written_spectra(spectra, first, picture, wanted=psd),
    }


def _written_spectra(
    spectra: Spectra, surface: HeightMap | Profile | None, picture: Path, *, wanted: bool
) -> dict[str, str]:
    """Write the spectra beside the picture, where that is wanted; they need complete heights."""
    from asperity.cli.surface_spectra import write_spectra

    if not wanted:
        return {}
    if not spectra:
        raise InputError("--psd", "points without a height", "complete heights", "Fill them with --fill.")
    name = f"{picture.stem.removesuffix('-surface')}-psd.csv"
    path = write_spectra(spectra, surface, picture.with_name(name))
    say(f"Spectra: {path.resolve()}")
    return {"psd": str(path.resolve())}


def _angle(text: str) -> float:
    """An angle with its unit, or in degrees, in rad."""
    allowed = "an angle, as 30 (degrees) or '0.5 rad'"
    try:
        angle = math.radians(float(text))
    except ValueError:
        try:
            angle = quantity(text, "rad")
        except InputError:
            raise InputError("--rotate", shown(text), allowed) from None
    if not math.isfinite(angle):
        raise InputError("--rotate", shown(text), allowed)
    return angle


def _turned(surface: HeightMap | Profile, direction: float) -> HeightMap | Profile:
    """A map as it lies when it is rolled over in a direction."""
    from asperity.surfaces.heightmap import HeightMap
    from asperity.surfaces.rotation import rotated

    if not isinstance(surface, HeightMap):
        raise InputError("--rotate", "a line", "a height map", "Leave it out.")
    return rotated(surface, direction)


def _sizes(surfaces: list[HeightMap | Profile]) -> dict[str, Any]:
    """Number of surfaces, and points, sizes and spacings, m, of each."""
    import numpy as np

    first = surfaces[0]
    return {
        "count": len(surfaces),
        "shape": first.shape,
        "size": np.atleast_1d(first.size),
        "spacing": np.atleast_1d(first.spacing),
        "missing_share": max(surface.missing_share for surface in surfaces),
    }


def _documented(item: Statistic) -> dict[str, Any]:
    return {
        "symbol": item.symbol,
        "value": item.value,
        "unit": item.unit,
        "bandwidth": item.bandwidth,
        "meaning": item.meaning,
    }


def _as_lines(surfaces: list[HeightMap | Profile], told: bool | None) -> tuple[Profile, ...]:
    """Lines side by side, where the user or the shape of an array says so; else none."""
    from asperity.surfaces.heightmap import HeightMap
    from asperity.surfaces.parallel_lines import are_lines, lines_of

    first = surfaces[0]
    if len(surfaces) > 1 or not isinstance(first, HeightMap):
        return ()
    return lines_of(first) if (are_lines(first) if told is None else told) else ()


def _inspect_lines(
    lines: tuple[Profile, ...], title: str, picture: Path, *, told: bool, psd: bool
) -> dict[str, Any]:
    """Print what is in lines side by side, and draw them."""
    from asperity.cli.surface_spectra import spectra_of_lines
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
    spectra = spectra_of_lines(levelled)
    figure = lines_picture([line.heights for line in levelled], lines[0].spacing, title, spectra)
    drawn = _saved(figure, picture)
    say(f"Picture: {drawn.resolve()}")
    return {
        "statistics": [_documented(item) | {"lowest": low, "highest": high} for item, low, high in found],
        "homogeneity": None,
        "files": {"picture": str(drawn.resolve())} | _written_spectra(spectra, None, picture, wanted=psd),
    }


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


def statistics_of(surface: HeightMap | Profile) -> list[Statistic]:
    """Roughness parameters of a levelled surface."""
    from asperity.surfaces.heightmap import HeightMap
    from asperity.surfaces.statistics import areal_statistics, profile_statistics

    return areal_statistics(surface) if isinstance(surface, HeightMap) else profile_statistics(surface)


def statistics_lines(found: list[Statistic]) -> list[str]:
    """Lines of a table of roughness parameters."""
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


def homogeneity_of(surface: HeightMap | Profile) -> tuple[dict[str, Any] | None, str]:
    """Whether the texture of a map is the same everywhere, as numbers and in words; nothing of a line."""
    import numpy as np

    from asperity.surfaces.heightmap import HeightMap
    from asperity.surfaces.homogeneity import TILES, homogeneity

    if not isinstance(surface, HeightMap) or min(surface.shape) < 2 * max(TILES):
        return None, ""
    if not np.isfinite(surface.heights).all():
        return None, "Homogeneity, Std and spectra are those of a complete map: --fill fills missing points."
    found = homogeneity(surface)
    tiles = " × ".join(map(str, found.tile_rms.shape))
    verdict = "the same everywhere, as far as chance tells"
    if not found.homogeneous:
        verdict = "not the same everywhere: a piece of it does not stand for another"
    line = (
        f"Homogeneity: mean squares of {tiles} tiles vary by {100 * found.variation:.0f} %, of stationary "
        f"textures like it by {100 * found.expected:.0f} % (p = {found.p_value:.2g}): {verdict}"
    )
    numbers = {
        "variation": found.variation,
        "expected": found.expected,
        "p_value": found.p_value,
        "homogeneous": bool(found.homogeneous),
    }
    return numbers, line


def draw(surface: HeightMap | Profile, title: str, picture: Path, spectra: Spectra) -> Path:
    """Draw a levelled surface and its spectra to a PNG, PDF or SVG file."""
    from asperity.reporting.texture import surface_picture
    from asperity.surfaces.heightmap import HeightMap

    spacing = surface.spacing if isinstance(surface, HeightMap) else (surface.spacing, surface.spacing)
    return _saved(surface_picture(surface.heights, spacing, title, spectra), picture)


def _saved(figure: Figure, picture: Path) -> Path:
    return atomic_write(
        picture, lambda file: figure.savefig(file, format=picture.suffix[1:].lower(), dpi=150)
    )
