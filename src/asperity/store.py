"""What has been computed once is kept: a content-addressed cache on disk."""

import hashlib
import json
import os
import re
import sys
import tempfile
import threading
import time
import warnings
import zipfile
from collections.abc import Callable, Iterator, Mapping
from contextlib import AbstractContextManager, suppress
from dataclasses import dataclass, field
from functools import partial
from pathlib import Path
from typing import Any, BinaryIO

import numpy as np

from asperity.arguments import NDArray, no_file
from asperity.errors import ComputationError, InputError
from asperity.files import amount, atomic_write, claimed_file, is_sealed, left_overs

FORMAT = 2  # raise it when a stored result no longer means what it meant
LARGEST_FILE = 4 * 2**30  # bytes; an archive that claims to unpack to more is not ours
_HOLDING = threading.Lock()
PATIENCE = 0.02  # how often is looked for what another process makes, s
MOST_HELD = 2**26  # bytes; what no disk takes is held in memory up to here
_FIRST = b"__key__.npy"
"""First member of each archive, whose name stands within …"""
_HEAD = 64
"""… so many bytes; and its value, four bytes a character, within …"""
_KEY = 1024
"""… so many, unless it is longer."""
_PART = re.compile(r"\.[\w-]+\.npz\.[0-9a-f]{8}\.part", re.ASCII)
KERNELS = "ASPERITY_KERNELS"
"""Names the folder of compiled kernels; by default they lie in the cache."""


def content_key(name: str, *parts: object) -> str:
    """Name of a result by what it was computed from: `name` and a SHA-256.

    Over dtypes, shapes and bytes of the arrays among the parts, the JSON of the rest (numbers, text, truth
    values, None, lists and dicts of these) and the version of the format.
    """
    digest = hashlib.sha256(f"asperity {FORMAT} {name}".encode())
    for part in parts:
        _feed(digest, part)
    return f"{name}-{digest.hexdigest()}"


def _feed(digest: Any, part: object) -> None:
    if isinstance(part, np.ndarray):
        if part.dtype.hasobject:
            raise TypeError("an array of objects has no content that can be named")
        digest.update(f"\0array {part.dtype.str} {part.shape}\0".encode())
        digest.update(np.ascontiguousarray(part).data if part.size else b"")
    elif isinstance(part, Mapping):
        digest.update(f"\0dict {len(part)}\0".encode())
        for key in sorted(part):
            _feed(digest, str(key))
            _feed(digest, part[key])
    elif isinstance(part, list | tuple):
        digest.update(f"\0list {len(part)}\0".encode())
        for item in part:
            _feed(digest, item)
    else:
        value = part.item() if isinstance(part, np.generic) else part
        digest.update(b"\0" + json.dumps(value, ensure_ascii=False).encode() + b"\0")


Make = Callable[[], Mapping[str, NDArray[Any]]]
"""Makes what is to be kept."""


@dataclass(frozen=True)
class Store:
    """Folder of results, each in one file named by what it was computed from.

    By default the folder is ``$ASPERITY_CACHE``, else ``asperity`` in the user's cache folder. Files are
    ``.npz`` without pickled objects, written atomically and sealed with a digest. A file that is damaged, or
    was not written by a `Store`, counts as missing. Any number of processes may read and write the same
    folder. Where it cannot be written, results are held in memory, with one warning.
    """

    root: Path = field(default_factory=lambda: default_root())
    _held: dict[str, dict[str, NDArray[Any]]] = field(
        default_factory=dict, init=False, repr=False, compare=False
    )

    def __post_init__(self) -> None:
        object.__setattr__(self, "root", Path(self.root))

    def path(self, key: str) -> Path:
        """File that holds, or would hold, the result called `key` (as `content_key` makes it)."""
        if not key or not all(character.isalnum() or character in "-_" for character in key):
            raise InputError("key of a stored result", repr(key), "letters, digits, '-' and '_'")
        return self.root / f"{key}.npz"

    def get(self, key: str) -> dict[str, NDArray[Any]] | None:
        """Look up the arrays that `put` stored; None if there is nothing, or nothing that can be trusted."""
        path = self.path(key)
        if key in self._held:
            return dict(self._held[key])
        if no_file(path):  # a pipe might never end
            return None
        try:
            with open(path, "rb") as file:
                if not is_sealed(file):
                    return None
                with zipfile.ZipFile(file) as archive:
                    if sum(entry.file_size for entry in archive.infolist()) > LARGEST_FILE:
                        return None
                file.seek(0)
                with np.load(file, allow_pickle=False) as arrays:
                    found = {name: arrays[name] for name in arrays.files}
        except Exception:  # a forged seal, an unreadable disk: errors of any kind
            return None
        if str(found.pop("__key__", "")) != key:
            return None
        return found

    def put(self, key: str, arrays: Mapping[str, NDArray[Any]]) -> None:
        """Keep arrays of plain dtypes under a key from `content_key`.

        If the file cannot be written, a warning says that they are held in memory, for this store alone; a
        `ComputationError` that memory already holds much that could not be written.
        """
        contents = {"__key__": np.array(key), **{name: np.asarray(value) for name, value in arrays.items()}}
        if any(value.dtype.hasobject for value in contents.values()):
            raise TypeError("arrays of objects cannot be stored")
        path = self.path(key)
        try:
            save = partial(_write_archive, contents)
            atomic_write(path, save, sealed=True, lasting=False)  # what is damaged counts as missing
        except ComputationError as error:
            with _HOLDING:  # threads put at once, and one of them warns
                self._hold(key, {name: value for name, value in contents.items() if name != "__key__"}, error)

    def _hold(self, key: str, arrays: dict[str, NDArray[Any]], error: ComputationError) -> None:
        """Hold in memory what the disk does not take."""
        held = self._held | {key: arrays}
        size = sum(value.nbytes for result in held.values() for value in result.values())
        if size > MOST_HELD:
            raise ComputationError(
                f"{error.what}, and memory already holds {amount(MOST_HELD)} that are kept nowhere",
                error.remedy,
            ) from error
        if not self._held:
            warnings.warn(
                f"{error.what}: finished work is not kept, and a run that is interrupted starts again. Let "
                "$ASPERITY_CACHE name a folder that can be written to.",
                RuntimeWarning,
                stacklevel=3,
            )
        self._held[key] = {name: value.copy() for name, value in arrays.items()}

    def claim(self, key: str) -> AbstractContextManager[bool]:
        """Try to be the only process, and thread, that makes the result called `key`; tells whether it is.

        A claim ends with the context, or with its process. Where files cannot be locked all are free.
        """
        return claimed_file(self.path(key))

    def files(self) -> list[Path]:
        """List the files that stores have written to the folder, not what others keep there, by name."""
        try:
            return sorted(filter(_is_kept, self.root.glob("*.npz"))) if self.root.is_dir() else []
        except OSError:  # a name that is too long
            return []

    def left_overs(self) -> list[Path]:
        """List what writing of such files left there, when it was interrupted."""
        return [part for part in left_overs(self.root) if _PART.fullmatch(part.name) and _is_file(part)]

    def size(self) -> int:
        """Total size of the files, in bytes."""
        return sum(path.stat().st_size for path in self.files())


def _write_archive(contents: Mapping[str, NDArray[Any]], file: BinaryIO) -> None:
    """Write arrays as `numpy.savez` does, and leave nothing open where the disk is full."""
    with zipfile.ZipFile(file, "w") as archive:
        for name, value in contents.items():
            with archive.open(f"{name}.npy", "w", force_zip64=True) as member:
                np.lib.format.write_array(member, value, allow_pickle=False)


def _is_kept(path: Path) -> bool:
    """Whether a store has written a file: an archive that begins with its key, by which it is still named."""
    name = path.stem.encode(f"utf-32-{sys.byteorder[0]}e")
    try:
        with open(path, "rb") as file:
            head = file.read(_KEY + len(name))
            return _is_file(path) and _FIRST in head[:_HEAD] and name in head
    except OSError:
        return False


def _is_file(path: Path) -> bool:
    return path.is_file() and not path.is_symlink()


def made(
    cache: Store | None, key: str, make: Make, meanwhile: Callable[[], object] = lambda: time.sleep(PATIENCE)
) -> dict[str, NDArray[Any]]:
    """Return what a cache keeps under a key; make it first where nobody does, or wait for who makes it.

    `meanwhile` is called as long as another makes it. Without a cache it is made.
    """
    if cache is None:
        return dict(make())
    while True:
        if (kept := cache.get(key)) is not None:
            return kept
        with cache.claim(key) as free:
            if free and (kept := cache.get(key)) is None:
                found = dict(make())
                cache.put(key, found)
                return found
        if not free:
            meanwhile()


@dataclass(frozen=True)
class Checkpoint:
    """State of an interrupted run under its name in a cache, so that the same run goes on where it was."""

    cache: Store
    key: str

    def load(self) -> dict[str, NDArray[Any]] | None:
        """Return what was saved last, or None."""
        return self.cache.get(self.key)

    def save(self, arrays: Mapping[str, NDArray[Any]]) -> None:
        """Replace what was saved."""
        self.cache.put(self.key, arrays)


def default_root() -> Path:
    """Folder of the cache: ``$ASPERITY_CACHE``, else ``asperity`` in the user's cache folder.

    Where the user has no home, one of the user's own among the temporary files; it must not belong to
    another.
    """
    if chosen := os.environ.get("ASPERITY_CACHE"):
        return Path(chosen)
    try:
        if sys.platform == "win32":
            local = os.environ.get("LOCALAPPDATA")
            return Path(local or Path.home() / "AppData" / "Local") / "asperity" / "cache"
        if sys.platform == "darwin":
            return Path.home() / "Library" / "Caches" / "asperity"
        return Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache") / "asperity"
    except RuntimeError:  # no home: a container, or an account without an entry
        folder = temporary_folder()
        if folder.exists() and not is_private(folder):
            raise InputError(
                "cache", folder, "a folder that you alone can write to", "Set $ASPERITY_CACHE to another."
            ) from None
        return folder


def temporary_folder() -> Path:
    """Folder of this user's own among the temporary files; it need not exist."""
    return Path(tempfile.gettempdir()).absolute() / f"asperity-{_user()}"


def kernel_folders() -> Iterator[Path]:
    """Folders to try for compiled kernels: ``$ASPERITY_KERNELS`` or the cache, then the temporary files."""
    with suppress(OSError, ValueError):
        yield Path(os.environ.get(KERNELS) or default_root() / "kernels").absolute()
    with suppress(OSError):
        yield temporary_folder() / "kernels"


def _user() -> int:
    return os.getuid() if sys.platform != "win32" else 0


def is_private(folder: Path) -> bool:
    """Whether nobody but the user, and the administrator, can write to a folder.

    False also if there is no such folder. On Windows every folder counts as private.
    """
    try:
        status = folder.stat()
    except OSError:
        return False
    if sys.platform == "win32":
        return folder.is_dir()
    return folder.is_dir() and status.st_uid in (0, _user()) and not status.st_mode & 0o022
