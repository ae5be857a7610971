"""Formats that libraries parse are read in a sandbox: see `asperity.sandbox`."""

import importlib
import warnings
from collections.abc import Callable
from dataclasses import asdict
from pathlib import Path
from typing import Any

import numpy as np

from asperity.arguments import listed, require, shown
from asperity.errors import InputError
from asperity.sandbox import Answer, sandboxed
from asperity.surfaces.heightmap import HeightMap, Profile
from asperity.surfaces.readers import guards
from asperity.surfaces.readers.hints import SPELLING, Hints, Spelling, spelled
from asperity.units import factor


def read_apart(module: str, kind: str) -> Callable[[Path, Hints], list[guards.Surface]]:
    """Make a reader of a format that calls the `read` of a module beside this one in a process of its own."""

    def read(path: Path, hints: Hints) -> list[guards.Surface]:
        request = [module, str(path.absolute()), asdict(hints), asdict(SPELLING.get())]
        described, arrays = sandboxed(surfaces_in, request, path.name, path.stat().st_size, kind)
        return [
            (HeightMap if heights.ndim == 2 else Profile)(heights, spacing, source)
            for (spacing, source), heights in zip(described, arrays, strict=True)
        ]

    return read


def surfaces_in(module: str, path: str, hints: dict[str, Any], spelling: dict[str, Any]) -> Answer:
    """Read a file as `read_apart` asks: spacings and sources of surfaces, and their heights."""
    reader = importlib.import_module(f"asperity.surfaces.readers.{module}")
    with spelled(Spelling(**spelling)):
        surfaces = reader.read(Path(path), Hints(**hints))
    return [(each.spacing, each.source) for each in surfaces], [each.heights for each in surfaces]


def read(path: Path, hints: Hints) -> list[guards.Surface]:
    """Read the channel of an instrument's file that the hints name, or the reader's default one.

    The other hints stand for a unit or a size that the file does not state. SurfaceTopography gives maps with
    the file's x as the first axis, which is kept.
    """
    # remarks of the package about itself
    with warnings.catch_warnings(action="ignore"), _opener(path)(path) as reader:
        channels = {channel.name: channel for channel in reader.channels}
        name = reader.default_channel.name if hints.array is None else hints.array
        allowed = f"one of: {listed(list(channels))}"
        require(name in channels, f"array in {path.name}", shown(name), allowed, "Choose a channel.")
        points, sized = channels[name].nb_grid_pts, channels[name].physical_sizes is not None
        few, allowed = (
            np.prod(points, dtype=float) <= guards.MAX_POINTS,
            f"at most {guards.MAX_POINTS} points",
        )
        require(few, path.name, f"{points} points", allowed, "Crop or split the measurement.")
        sizes = {} if sized or hints.pixel is None else {"physical_sizes": (1.0,) * len(points)}
        return _surfaces(channels[name].topography(**sizes), hints, f"{path.name}:{name}")


def _opener(path: Path) -> Any:
    try:
        from SurfaceTopography import open_topography
    except ImportError:
        received = f"a {path.suffix or 'nameless'} file, which asperity does not read itself"
        allowed = "text, CSV, npy, npz, netCDF, SDF, X3P; instrument files with SurfaceTopography"
        remedy = 'Install it: pip install "asperity[readers]".'
        raise InputError(path.name, received, allowed, remedy) from None
    return open_topography


def _surfaces(measured: Any, hints: Hints, source: str) -> list[guards.Surface]:
    received, allowed = "points at no uniform spacing", "a uniform line or map"
    require(measured.is_uniform, source, received, allowed, "Resample it at a uniform spacing first.")
    unit = None if measured.unit is None else factor(measured.unit, "m")
    heights = np.ma.filled(np.ma.asarray(measured.heights(), dtype=np.float64), np.nan)
    heights = heights * hints.heights_in(source, unit)
    lateral = hints.pixel_unit or unit
    dx, dy = np.broadcast_to(measured.pixel_size, 2)
    stated = None if lateral is None else (float(dx) * lateral, float(dy) * lateral)
    return guards.surfaces_of(heights, hints.spacing_in(source, stated), source)
