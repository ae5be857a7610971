"""What has been computed once is kept: a content-addressed cache on disk, and atomic writing of any file."""

from __future__ import annotations

import hashlib
import json
import os
import secrets
import sys
import tempfile
import zipfile
import zlib
from collections.abc import Callable, Mapping
from contextlib import suppress
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, BinaryIO, Protocol

import numpy as np
from numpy.typing import NDArray

from asperity.errors import ComputationError, InputError

FORMAT = 1  # raise it when a stored result no longer means what it meant
LARGEST_FILE = 4 * 2**30  # bytes; an archive that claims to unpack to more is not ours


def atomic_write(path: str | os.PathLike[str], write: Callable[[BinaryIO], object]) -> Path:
    """Write a file completely or not at all.

    Parameters
    ----------
    path : path
        The file to write; its folder is made if it is missing. An existing file is replaced in one step.
    write : callable
        Receives a binary file open for reading and writing, and fills it.

    Returns
    -------
    Path
        The file written.

    Raises
    ------
    ComputationError
        If the folder cannot be made or the file not be written.
    """
    path = Path(path)
    temporary = path.with_name(f".{path.name}.{secrets.token_hex(4)}.part")
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        with open(temporary, "x+b") as file:
            write(file)
            file.flush()
            os.fsync(file.fileno())
        os.replace(temporary, path)
    except OSError as error:
        raise ComputationError(
            f"{path} could not be written ({error.strerror or error})",
            "another folder, or free space on this disk",
        ) from error
    finally:
        with suppress(OSError):
            temporary.unlink(missing_ok=True)
    return path


def content_key(name: str, *parts: object) -> str:
    """Name of a result by what it was computed from.

    Parameters
    ----------
    name : str
        What is computed, as ``"scan"``.
    *parts : array, number, str, bool, None, or lists and dicts of these
        Everything that the result depends on.

    Returns
    -------
    str
        `name` and a SHA-256 over dtypes, shapes and bytes of the arrays, the JSON of the rest and the
        version of the format.
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


class Cache(Protocol):
    """Where finished work is kept: `Store` is one."""

    def get(self, key: str) -> dict[str, NDArray[Any]] | None:
        """Return what was put under the key, or None."""

    def put(self, key: str, arrays: Mapping[str, NDArray[Any]]) -> None:
        """Keep arrays under the key."""


@dataclass(frozen=True)
class Store:
    """Folder of results, each in one file named by what it was computed from.

    Parameters
    ----------
    root : Path, optional
        The folder; by default ``$ASPERITY_CACHE``, else ``asperity`` in the user's cache folder.

    Notes
    -----
    Files are ``.npz`` without pickled objects, written atomically. A file that is damaged, or was not
    written by a `Store`, counts as missing. Any number of processes may read and write the same folder.
    """

    root: Path = field(default_factory=lambda: default_root())

    def __post_init__(self) -> None:
        object.__setattr__(self, "root", Path(self.root))

    def path(self, key: str) -> Path:
        """File that holds, or would hold, the result called `key` (as `content_key` makes it)."""
        if not key or not all(character.isalnum() or character in "-_" for character in key):
            raise InputError("key of a stored result", repr(key), "letters, digits, '-' and '_'")
        return self.root / f"{key}.npz"

    def get(self, key: str) -> dict[str, NDArray[Any]] | None:
        """Look up a result.

        Parameters
        ----------
        key : str
            From `content_key`.

        Returns
        -------
        dict of arrays or None
            What `put` stored under `key`; None if there is nothing, or nothing that can be trusted.
        """
        path = self.path(key)
        try:
            with open(path, "rb") as file:
                with zipfile.ZipFile(file) as archive:
                    if sum(entry.file_size for entry in archive.infolist()) > LARGEST_FILE:
                        return None
                file.seek(0)
                with np.load(file, allow_pickle=False) as arrays:
                    found = {name: arrays[name] for name in arrays.files}
        except (OSError, ValueError, EOFError, KeyError, NotImplementedError, RuntimeError, MemoryError):
            return None
        except (zipfile.BadZipFile, zlib.error, SyntaxError, OverflowError, TypeError):
            return None
        if str(found.pop("__key__", "")) != key:
            return None
        return found

    def put(self, key: str, arrays: Mapping[str, NDArray[Any]]) -> None:
        """Keep a result.

        Parameters
        ----------
        key : str
            From `content_key`.
        arrays : mapping of str to array
            The result; plain dtypes only.

        Raises
        ------
        ComputationError
            If the file cannot be written.
        """
        contents = {"__key__": np.array(key), **{name: np.asarray(value) for name, value in arrays.items()}}
        if any(value.dtype.hasobject for value in contents.values()):
            raise TypeError("arrays of objects cannot be stored")
        atomic_write(self.path(key), lambda file: np.savez(file, **contents))  # type: ignore[arg-type]

    def files(self) -> list[Path]:
        """List the files of this store, sorted by name."""
        return sorted(self.root.glob("*.npz")) if self.root.is_dir() else []

    def size(self) -> int:
        """Total size of the files, in bytes."""
        return sum(path.stat().st_size for path in self.files())

    def clear(self) -> int:
        """Delete all results and what interrupted writes left; return how many results went."""
        files = self.files()
        left_overs = list(self.root.glob(".*.npz.*.part")) if self.root.is_dir() else []
        for path in [*files, *left_overs]:
            path.unlink(missing_ok=True)
        return len(files)


def default_root() -> Path:
    """Folder of the cache.

    Returns
    -------
    Path
        ``$ASPERITY_CACHE``, else ``asperity`` in the user's cache folder; where the user has no home, one of
        the user's own among the temporary files.

    Raises
    ------
    InputError
        If that one belongs to somebody else.
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
    """Folder of this user's own among the temporary files.

    Returns
    -------
    Path
        It need not exist.
    """
    return Path(tempfile.gettempdir()).absolute() / f"asperity-{_user()}"


def _user() -> int:
    return os.getuid() if sys.platform != "win32" else 0


def is_private(folder: Path) -> bool:
    """Whether nobody but the user, and the administrator, can write to a folder.

    Parameters
    ----------
    folder : Path
        The folder.

    Returns
    -------
    bool
        False also if there is no such folder. On Windows every folder counts as private.
    """
    try:
        status = folder.stat()
    except OSError:
        return False
    if sys.platform == "win32":
        return folder.is_dir()
    return folder.is_dir() and status.st_uid in (0, _user()) and not status.st_mode & 0o022
