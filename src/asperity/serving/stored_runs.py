"""What the page keeps on disk: runs and surfaces, each in a folder of its own that is named at random."""

import asyncio
import json
import re
import secrets
import shutil
from collections.abc import AsyncIterator, Callable
from contextlib import suppress
from datetime import datetime
from pathlib import Path, PurePosixPath
from typing import Any

from asperity.case.toml import LARGEST_CASE
from asperity.errors import InputError, printable
from asperity.files import amount, require_space, write_bytes
from asperity.text_files import read_text

CASE = "case.toml"
RESULT = "run.nc"
REPORT = "report.html"
SOUNDS = "sounds"
OUTCOME = "outcome.json"
_FACTS = "run.json"
_IDENTIFIER = re.compile(r"[0-9a-f]{16}")
_OFFERED = re.compile(r"(sounds/)?[\w.+-]+\.(nc|toml|html|csv|wav|svg|png)")
LONGEST_NAME = 80
LARGEST_UPLOAD = 256 * 2**20
"""Bytes of a file, at most."""
LARGEST_TOTAL = 2 * 2**30
"""Bytes of all files that are kept, at most."""
STALLED = 30.0
"""Time that may pass without a byte, s."""
SLOWEST = 20 * 2**10
"""Rate below which a file is not waited for, bytes/s."""
_LONGEST = 100  # characters of the name of a file
_DEVICE = re.compile(r"(con|prn|aux|nul|com\d|lpt\d)(\.|$)", re.IGNORECASE)
"""Names that stand for a device on Windows, whatever their ending."""


# --- folders


def folder_of(root: Path, identifier: str) -> Path | None:
    """Folder of what is kept under an identifier; None if there is none, or it is none."""
    if not _IDENTIFIER.fullmatch(identifier):
        return None
    folder = root / identifier
    return folder if folder.is_dir() and not folder.is_symlink() else None


def is_own(folder: Path, name: str) -> bool:
    """Whether a folder holds a file of that name, by itself: no link on the way leads elsewhere."""
    file = folder / name
    return file.is_file() and file.resolve() == folder.resolve() / name


def own_folder(folder: Path) -> Path:
    """A folder to be written into, made anew where a link to another stands in its place."""
    if folder.is_symlink():
        folder.unlink()
    return folder


def kept_in(root: Path) -> list[Path]:
    """Folders that are kept there, the latest first."""
    found = [folder for each in root.glob("*") if (folder := folder_of(root, each.name))]
    return sorted(found, key=lambda folder: folder.stat().st_mtime_ns, reverse=True)


def remove_kept(folder: Path) -> None:
    """Delete a run, or a surface, with all its files."""
    shutil.rmtree(folder, ignore_errors=True)


def remove_unnamed(root: Path, runs: Path) -> None:
    """Delete what no case of a run names."""
    named = ""
    for folder in kept_in(runs):
        with suppress(InputError):
            named += case_of_run(folder)
    for folder in kept_in(root):
        if folder.name not in named:
            remove_kept(folder)


# --- runs


def keep_run(root: Path, case: str, *, kind: str, name: str, changed: str) -> str:
    """Make the folder of a new run with its case in TOML, and what a list of runs says of it."""
    folder = root / secrets.token_hex(8)
    now = datetime.now().astimezone()
    facts = {
        "kind": kind,
        "name": printable(" ".join(name.split()))[:LONGEST_NAME] or f"{now:%d %b, %H:%M:%S}",
        "changed": changed,
        "created": now.isoformat(timespec="milliseconds"),
    }
    write_bytes(folder / _FACTS, json.dumps(facts, ensure_ascii=False).encode())
    write_bytes(folder / CASE, case.encode())
    return folder.name


def told_of(folder: Path) -> dict[str, Any]:
    """What a run is, and what became of it: done, failed, cancelled, or interrupted where nobody knows."""
    told = dict.fromkeys(("kind", "changed", "created", "message"), "")
    told |= {"name": folder.name, "state": "interrupted"} | _read(folder, _FACTS)
    outcome = {"state": "done"} if is_own(folder, RESULT) else _read(folder, OUTCOME)
    return told | outcome | {"id": folder.name}


def _read(folder: Path, name: str) -> dict[str, str]:
    """Words that were kept by their names; none of a file that is missing or damaged."""
    if not is_own(folder, name):
        return {}
    try:
        found = json.loads(read_text(folder / name, name, "JSON", largest=LARGEST_CASE))
    except (InputError, ValueError, RecursionError):
        return {}
    words = found.items() if isinstance(found, dict) else ()
    return {name: printable(word, lines=True) for name, word in words if isinstance(word, str)}


def case_of_run(folder: Path) -> str:
    """Text of the case of a run; an `InputError` if it is missing or damaged."""
    source = f"the case of {folder.name}"
    allowed = "a case"
    if (folder / CASE).exists() and not is_own(folder, CASE):
        raise InputError(source, "a link to another file", allowed)
    return read_text(folder / CASE, source, allowed, largest=LARGEST_CASE)


def write_outcome(folder: Path, state: str, message: str = "") -> None:
    """Write what became of a run that is not done, and why."""
    text = json.dumps({"state": state, "message": message}, ensure_ascii=False)
    write_bytes(folder / OUTCOME, text.encode())


def file_of_run(folder: Path, name: str) -> Path | None:
    """A file of a run that may be looked at: of its folder or its sounds, and nothing else."""
    offered = _OFFERED.fullmatch(name) and ".." not in name
    return folder / name if offered and is_own(folder, name) else None


def sounds_of_run(folder: Path) -> list[str]:
    """Names of the sounds of a run that may be listened to."""
    found = sorted(file.name for file in (folder / SOUNDS).glob("*.wav"))
    return [name for name in found if file_of_run(folder, f"{SOUNDS}/{name}")]


# --- surfaces: streamed to disk, never held in memory


class TooLarge(InputError):
    """A file that is larger than may be uploaded."""


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
            remedy = "Crop or thin the measurement; 'asperity run' reads larger files from disk."
            allowed = f"at most {amount(LARGEST_UPLOAD)}"
            raise TooLarge("the file", f"{amount(size)} or more", allowed, remedy)
        if size > left:
            allowed = f"{amount(LARGEST_TOTAL)} of them"
            remedy = "Delete those that no run uses."
            raise TooLarge("the surfaces kept", "more surfaces", allowed, remedy)

    check(announced or 1)
    require_space(root, float(announced or 0))
    file = root / secrets.token_hex(8) / safe_name(name)
    file.parent.mkdir(parents=True)
    try:
        await _write_pieces(file, pieces, check)
    except BaseException:
        remove_kept(file.parent)
        raise
    return file


async def _write_pieces(file: Path, pieces: AsyncIterator[bytes], check: Callable[[int], None]) -> None:
    """Write the pieces of a file as they come, while their number of bytes passes a check."""
    size = 0
    now = asyncio.get_running_loop().time
    begun = now()
    try:
        with open(file, "xb") as opened:
            async with asyncio.timeout(STALLED) as patience:
                async for piece in pieces:
                    size += len(piece)
                    check(size)
                    opened.write(piece)
                    patience.reschedule(min(now(), begun + size / SLOWEST) + STALLED)
    except TimeoutError:
        received = f"nothing more for {STALLED:.0f} s, or less than {amount(SLOWEST)} in a second"
        raise InputError("the file", received, "one that comes", "Upload it again.") from None
    if not size:
        raise InputError("the file", "an empty file", "a file with heights", "Export it again.")


def surface_named(root: Path, identifier: str) -> Path | None:
    """File of an uploaded surface."""
    folder = folder_of(root, identifier)
    if folder is None:
        return None
    files = sorted(folder.iterdir())
    return next((file for file in files if is_own(folder, file.name) and not file.name.startswith(".")), None)


def identifier_of(root: Path, path: str) -> str | None:
    """Identifier of an uploaded surface by its path; None of any other file."""
    folder = Path(path).parent
    known = folder.parent == root and surface_named(root, folder.name) == Path(path)
    return folder.name if known else None


def uploaded(root: Path) -> list[dict[str, str]]:
    """Surfaces that were uploaded, the latest first."""
    found = ((folder.name, surface_named(root, folder.name)) for folder in kept_in(root))
    return [{"id": identifier, "name": file.name} for identifier, file in found if file is not None]
