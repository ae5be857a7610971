"""Folders in which compiled kernels are kept, and what lies there."""

from __future__ import annotations

import hashlib
import os
import sys
from collections.abc import Iterator
from contextlib import suppress
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path

from asperity.files import left_overs
from asperity.store import default_root, is_private, temporary_folder

VARIABLE = "ASPERITY_KERNELS"
"""Names the folder of kept kernels; by default they lie in the cache."""
STAMP = 16
"""Digits that name the folder of a version of the kernels."""


def folders() -> Iterator[Path]:
    """Folders to try for kernels: ``$ASPERITY_KERNELS`` or the cache, then the temporary files."""
    with suppress(OSError, ValueError):
        yield Path(os.environ.get(VARIABLE) or default_root() / "kernels").absolute()
    with suppress(OSError):
        yield temporary_folder() / "kernels"


def stamp() -> str:
    """Name of the folder of these kernels: by what they are made of, as one may be compiled into another."""
    versions = f"{version('numba')} {version('llvmlite')} {sys.version}"
    digest = hashlib.sha256(versions.encode())
    for source in sorted(Path(__file__).parent.glob("*.py")):
        digest.update(source.read_bytes())
    return digest.hexdigest()[:STAMP]


def is_kept(function: str) -> bool:
    """Whether the machine code of a kernel lies in one of the folders, without importing the compiler."""
    with suppress(OSError, PackageNotFoundError):
        return any(any((folder / stamp()).glob(f"{function}-*")) for folder in folders())
    return False


def kept_files(folder: Path) -> tuple[list[Path], list[Path]]:
    """Compiled kernels of all versions in one of `folders`, and parts that interrupted writes left."""
    kernels: list[Path] = []
    parts: list[Path] = []
    try:
        places = list(folder.glob("[0-9a-f]" * STAMP))
    except OSError:  # a name that is too long
        return [], []
    for place in places:
        if is_private(place):
            kernels += [file for file in place.iterdir() if not file.name.startswith(".")]
            parts += left_overs(place)
    return sorted(kernels), sorted(parts)
