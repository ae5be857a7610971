"""What is in a measured file: size, spacing, missing points, statistics with bandwidth, and a picture."""

from __future__ import annotations

import re
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from asperity.errors import InputError
from asperity.store import atomic_write
from asperity.surfaces.readers.spelling import on_command_line, spelled

if TYPE_CHECKING:
    from asperity.surfaces.heightmap import HeightMap, Profile
    from asperity.surfaces.statistics import Statistic


def inspect(
    file: Path, picture: Path | None, *, array: str | None = None, index: int | None = None, **hints: Any
) -> None:
    """Print what is in a measured file, and draw it.

    Parameters
    ----------
    file : Path
        The measured file.
    picture : Path or None
        Where the picture goes; the ending names its format. By default a name made of those of file, array
        and map, in the working folder.
    array : str, optional
        Name of the array.
    index : int, optional
        Which map of an ensemble.
    **hints
        What else the file does not say itself, as `read_surface` takes it.
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
        surfaces = read(file, index, array=array, **hints)
    title = ", ".join(filter(None, [file.name, array, "" if index is None else f"map {index}"]))
    click.echo(f"{title}: {described(surfaces)}")
    first = surfaces[0].levelled()
    if len(surfaces) > 1:
        click.echo(f"Statistics of the first of {len(surfaces)} maps; choose another one with --index.")
        title += f", the first of {len(surfaces)} maps"
    for line in statistics_lines(first):
        click.echo(line)
    click.echo(f"Picture: {draw(first, title, picture).resolve()}")


def read(file: Path, index: int | None = None, **hints: Any) -> list[HeightMap | Profile]:
    """Read the map, the line, or all maps of an ensemble.

    Parameters
    ----------
    file : Path
        The measured file.
    index : int, optional
        Which map of an ensemble; all of them by default.
    **hints
        As `read_surface` takes them.

    Returns
    -------
    list of HeightMap or Profile
    """
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
    area = " × ".join(f"{size * 1e3:.4g}" for size in sizes)
    apart = " × ".join(f"{spacing * 1e6:.4g}" for spacing in spacings)
    missing = max(surface.missing_share for surface in surfaces)
    return f"{many} {points} points, {area} mm, {apart} µm apart, {missing:.2%} without a height"


def statistics_lines(surface: HeightMap | Profile) -> list[str]:
    """Lines of a table of the roughness parameters of a levelled surface."""
    from asperity.surfaces.heightmap import HeightMap
    from asperity.surfaces.statistics import areal_statistics, profile_statistics

    found: list[Statistic]
    if isinstance(surface, HeightMap):
        found = areal_statistics(surface)
    else:
        found = profile_statistics(surface)
    shortest, longest = found[0].bandwidth
    head = f"Levelled; wavelengths {shortest * 1e6:.3g} µm to {longest * 1e3:.3g} mm:"
    return [head, *(f"  {item.symbol:4} {_scaled(item):>12}  {item.meaning}" for item in found)]


def _scaled(item: Statistic) -> str:
    return f"{item.value * 1e6:.4g} µm" if item.unit == "m" else f"{item.value:.4g}"


def draw(surface: HeightMap | Profile, title: str, picture: Path) -> Path:
    """Draw a levelled surface.

    Parameters
    ----------
    surface : HeightMap or Profile
        Levelled heights.
    title : str
        Heading.
    picture : Path
        The file, PNG, PDF or SVG.

    Returns
    -------
    Path
        The file written.
    """
    from asperity.report import surface_picture
    from asperity.surfaces.heightmap import HeightMap

    spacing = surface.spacing if isinstance(surface, HeightMap) else (surface.spacing, surface.spacing)
    figure = surface_picture(surface.heights, spacing, title)
    return atomic_write(
        picture, lambda file: figure.savefig(file, format=picture.suffix[1:].lower(), dpi=150)
    )
