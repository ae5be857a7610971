"""Surfaces that were uploaded: streamed to disk, never held in memory; refused where none can read them."""

from __future__ import annotations

import asyncio
import re
import warnings
from collections.abc import AsyncIterator
from pathlib import Path, PurePosixPath
from typing import Any

import numpy as np

from asperity.errors import InputError, MissingPointsWarning
from asperity.files import amount, require_space
from asperity.serving.kept_runs import folder_of, kept_in, new_identifier, remove_kept
from asperity.surfaces.heightmap import HeightMap, Profile
from asperity.surfaces.readers import read_surface
from asperity.surfaces.readers.hints import in_case, spelled
from asperity.units import written

LARGEST_UPLOAD = 256 * 2**20
"""Bytes of a file, at most."""
LARGEST_TOTAL = 2 * 2**30
"""Bytes of all files that are kept, at most."""
STALLED, SLOWEST = 30.0, 20 * 2**10
"""Time, s, that may pass without a byte, and rate, in bytes/s, below which a file is not waited for."""
_LONGEST = 100  # characters of its name
_DEVICE = re.compile(r"(con|prn|aux|nul|com\d|lpt\d)(\.|$)", re.IGNORECASE)
"""Names that stand for a device on Windows, whatever their ending."""
_HINTS = {name: name for name in ("array", "height_unit", "pixel", "index", "fill", "spikes")}
_ADVISED = "in [surface]"


class TooLarge(InputError):
    """A file that is larger than may be uploaded."""


def too_large(size: int) -> TooLarge:
    """Error about a file of so many bytes, or more."""
    allowed = f"at most {amount(LARGEST_UPLOAD)}"
    remedy = "Crop or thin the measurement; 'asperity run' reads larger files from disk."
    return TooLarge("the file", f"{amount(size)} or more", allowed, remedy)


def safe_name(name: str) -> str:
    """Name of an uploaded file that leads nowhere else; its ending stays, for it names the format."""
    last = PurePosixPath(name.replace("\\", "/")).name
    cleaned = re.sub(r"[^\w.+-]", "_", last, flags=re.ASCII).lstrip(".")
    found = cleaned[-_LONGEST:].strip(".") or "surface"
    return f"_{found}" if _DEVICE.match(found) else found


async def receive(
    root: Path, name: str, announced: int | None, pieces: AsyncIterator[bytes], largest: int = LARGEST_UPLOAD
) -> Path:
    """Write a file that comes in pieces into a folder of its own below the root.

    What is too large, alone or with all that is there, is refused when it is announced, bytes, or else as
    soon as more has come; what stalls is not waited for.

    Raises
    ------
    TooLarge
        If it is too large; nothing is left of it.
    InputError
        If it is empty, or stalls.
    ComputationError
        If the disk has no space for it.
    """
    left = LARGEST_TOTAL - sum(file.stat().st_size for file in root.rglob("*") if file.is_file())

    def check(size: int) -> None:
        if size > largest:
            raise too_large(size)
        if size > left:
            received, allowed = "more surfaces", f"{amount(LARGEST_TOTAL)} of them"
            raise TooLarge("the surfaces kept", received, allowed, "Delete those that no run uses.")

    check(announced or 1)
    require_space(root, float(announced or 0))
    folder = root / new_identifier()
    folder.mkdir(parents=True)
    try:
        size, now = 0, asyncio.get_running_loop().time
        begun = now()
        with open(folder / safe_name(name), "xb") as file:
            async with asyncio.timeout(STALLED) as patience:
                async for piece in pieces:
                    size += len(piece)
                    check(size)
                    file.write(piece)
                    patience.reschedule(min(now(), begun + size / SLOWEST) + STALLED)
        if not size:
            raise InputError("the file", "an empty file", "a file with heights", "Export it again.")
    except TimeoutError:
        remove_kept(folder)
        received = f"nothing more for {STALLED:.0f} s, or less than {amount(SLOWEST)} in a second"
        raise InputError("the file", received, "one that comes", "Upload it again.") from None
    except BaseException:
        remove_kept(folder)
        raise
    return folder / safe_name(name)


def surface_named(root: Path, identifier: str) -> Path | None:
    """File of an uploaded surface."""
    folder = folder_of(root, identifier)
    files = sorted(folder.iterdir()) if folder is not None else []
    return next((file for file in files if file.is_file() and not file.name.startswith(".")), None)


def identifier_of(root: Path, path: str) -> str | None:
    """Identifier of an uploaded surface by its path; None of any other file."""
    folder = Path(path).parent
    known = folder.parent == root and surface_named(root, folder.name) == Path(path)
    return folder.name if known else None


def uploaded(root: Path) -> list[dict[str, str]]:
    """Surfaces that were uploaded, the latest first."""
    found = ((folder.name, surface_named(root, folder.name)) for folder in kept_in(root))
    return [{"id": identifier, "name": file.name} for identifier, file in found if file is not None]


def examined(path: str) -> dict[str, Any]:
    """Say what is in an uploaded file, or what a case has to say of it; an `InputError` if none reads it."""
    try:
        with spelled(in_case("surface", _HINTS)), warnings.catch_warnings():
            warnings.simplefilter("ignore", MissingPointsWarning)  # said below
            return {"words": _words(read_surface(path, index=0)), "needs": ""}
    except InputError as error:
        if _ADVISED not in error.remedy:
            raise
        return {"words": "", "needs": str(error).replace(path, Path(path).name)}


def _words(first: HeightMap | Profile) -> str:
    kind = "map" if isinstance(first, HeightMap) else "line"
    points = " × ".join(map(str, first.shape))
    apart = " × ".join(dict.fromkeys(written(float(d), "m", "um") for d in np.atleast_1d(first.spacing)))
    lost = f", {first.missing_share:.2%} without a height: set fill" if first.missing_share else ""
    return f"{kind} of {points} points, {apart} apart{lost}"
