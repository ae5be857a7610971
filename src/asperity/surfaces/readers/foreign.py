"""Formats that libraries parse are read apart: see `asperity.apart`."""

from __future__ import annotations

import importlib
from collections.abc import Callable
from dataclasses import asdict
from pathlib import Path
from typing import Any, BinaryIO

from asperity.apart import apart, received, send
from asperity.surfaces.heightmap import HeightMap, Profile
from asperity.surfaces.readers import spelling
from asperity.surfaces.readers.hints import Hints, Surface


def read_apart(module: str, kind: str) -> Callable[[Path, Hints], list[Surface]]:
    """Make a reader of a format that calls the `read` of a module beside this one in a process of its own."""

    def read(path: Path, hints: Hints) -> list[Surface]:
        request = [module, str(path.absolute()), asdict(hints), spelling.current()]
        answer = apart(f"{__name__}:serve", request, path.name, path.stat().st_size, kind)
        description, arrays = received(answer)
        return [
            HeightMap(heights, tuple(spacing), source)
            if heights.ndim == 2
            else Profile(heights, spacing, source)
            for (spacing, source), heights in zip(description, arrays, strict=True)
        ]

    return read


def serve(module: str, path: str, hints: dict[str, Any], style: list[Any], answers: BinaryIO) -> None:
    """Read a file as `read_apart` asks, and send its surfaces to the binary file `answers`."""
    reader = importlib.import_module(f"asperity.surfaces.readers.{module}")
    given = Hints(**hints)
    if given.spacing is not None:
        given = Hints(**(hints | {"spacing": tuple(given.spacing)}))
    with spelling.spelled(spelling.spelling_of(style)):
        surfaces = reader.read(Path(path), given)
    send(
        answers,
        [[surface.spacing, surface.source] for surface in surfaces],
        [surface.heights for surface in surfaces],
    )
