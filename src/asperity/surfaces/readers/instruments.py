"""Formats that libraries parse are read in a sandbox: see `asperity.sandbox`."""

from __future__ import annotations

import importlib
import warnings
from collections.abc import Callable
from dataclasses import asdict
from pathlib import Path
from typing import Any

import numpy as np

from asperity.arguments import listed, shown
from asperity.errors import InputError
from asperity.sandbox import Answer, sandboxed
from asperity.surfaces.heightmap import HeightMap, Profile
from asperity.surfaces.readers.guards import MAX_POINTS, Hints, Surface, hostile
from asperity.surfaces.readers.headers import current, spelled, spelling_of
from asperity.units import factor


def read_apart(module: str, kind: str) -> Callable[[Path, Hints], list[Surface]]:
    """Make a reader of a format that calls the `read` of a module beside this one in a process of its own."""

    def read(path: Path, hints: Hints) -> list[Surface]:
        request = [module, str(path.absolute()), asdict(hints), current()]
        description, arrays = sandboxed(surfaces_in, request, path.name, path.stat().st_size, kind)
        return [
            HeightMap(heights, tuple(spacing), source)
            if heights.ndim == 2
            else Profile(heights, spacing, source)
            for (spacing, source), heights in zip(description, arrays, strict=True)
        ]

    return read


def surfaces_in(module: str, path: str, hints: dict[str, Any], style: list[Any]) -> Answer:
    """Read a file as `read_apart` asks: spacings and sources of surfaces, and their heights."""
    reader = importlib.import_module(f"asperity.surfaces.readers.{module}")
    given = Hints(**hints)
    if given.spacing is not None:
        given = Hints(**(hints | {"spacing": tuple(given.spacing)}))
    with spelled(spelling_of(style)):
        surfaces = reader.read(Path(path), given)
    return [(each.spacing, each.source) for each in surfaces], [each.heights for each in surfaces]


def read(path: Path, hints: Hints) -> list[Surface]:
    """Read the channel of an instrument's file that the hints name, or the reader's default one.

    The other hints stand for a unit or a size that the file does not state. SurfaceTopography gives maps with
    the file's x as the first axis, which is kept.
    """
    opener = _opener(path)
    with hostile(path.name, "known instrument"), warnings.catch_warnings():
        warnings.simplefilter("ignore")  # remarks of the package about itself
        with opener(path) as reader:
            channel = _channel(reader, hints.array, path.name)
            if np.prod(channel.nb_grid_pts, dtype=float) > MAX_POINTS:
                received, allowed = f"{channel.nb_grid_pts} points", f"at most {MAX_POINTS} points"
                raise InputError(path.name, received, allowed, "Crop or split the measurement.")
            missing_size = hints.spacing is not None and channel.physical_sizes is None
            sizes = {"physical_sizes": (1.0,) * len(channel.nb_grid_pts)} if missing_size else {}
            return [_surface(channel.topography(**sizes), hints, f"{path.name}:{channel.name}")]


def _opener(path: Path) -> Any:
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            from SurfaceTopography import open_topography
    except ImportError:
        received = f"a {path.suffix or 'nameless'} file, which asperity does not read itself"
        allowed = "text, CSV, npy, npz, netCDF, SDF, X3P; instrument files with SurfaceTopography"
        remedy = 'Install it: pip install "asperity[readers]".'
        raise InputError(path.name, received, allowed, remedy) from None
    return open_topography


def _channel(reader: Any, name: str | None, source: str) -> Any:
    if name is None:
        return reader.default_channel
    named = {channel.name: channel for channel in reader.channels}
    if name not in named:
        raise InputError(
            f"array in {source}", shown(name), f"one of: {listed(list(named))}", "Choose a channel."
        )
    return named[name]


def _surface(measured: Any, hints: Hints, source: str) -> Surface:
    if not measured.is_uniform:
        remedy = "Resample it at a uniform spacing first."
        raise InputError(source, "points at no uniform spacing", "a uniform line or map", remedy)
    unit = None if measured.unit is None else factor(measured.unit, "m")
    heights = np.ma.filled(np.ma.asarray(measured.heights(), dtype=np.float64), np.nan)
    heights = heights * hints.heights_in(source, unit)
    lateral = hints.lateral_factor or unit
    pixel = np.broadcast_to(measured.pixel_size, 2)
    stated = None if lateral is None else (float(pixel[0]) * lateral, float(pixel[1]) * lateral)
    spacing = hints.spacing_in(source, stated)
    if heights.ndim == 1:
        return Profile(heights, spacing[0], source)
    return HeightMap(heights, spacing, source)
