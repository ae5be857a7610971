"""Files are written completely or not at all, sealed where damage must show, and in a folder of one's own."""

import errno
import hashlib
import os
import re
import secrets
import shutil
import tempfile
from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager, nullcontext, suppress
from importlib import resources
from pathlib import Path
from typing import BinaryIO

from asperity.errors import AsperityError, ComputationError, InputError
from asperity.written_numbers import rounded

try:
    import fcntl
except ImportError:  # Windows: open files cannot be removed there, which does as well
    fcntl = None  # type: ignore[assignment]

_PART = re.compile(r"\..+\.[0-9a-f]{8}\.part")
_SEAL = b"\nasperity sha256 "
_SEAL_SIZE = len(_SEAL) + 64
_CHUNK = 2**20
_FULL = (errno.ENOSPC, errno.EDQUOT, errno.EFBIG) if hasattr(errno, "EDQUOT") else (errno.ENOSPC, errno.EFBIG)
_swept: set[Path] = set()


def packaged(name: str) -> str:
    """Text of a file that comes with the program, by its path in the package."""
    return resources.files("asperity").joinpath(name).read_text(encoding="utf-8")


def atomic_write(
    path: str | os.PathLike[str],
    write: Callable[[BinaryIO], object],
    *,
    sealed: bool = False,
    lasting: bool = True,
) -> Path:
    """Write a file completely or not at all; its folder is made if it is missing.

    `write` receives a binary file open for reading and writing, and fills it. An existing file is replaced in
    one step. A sealed file ends with a digest of all before it: see `is_sealed`. A lasting one is on the disk
    when this returns, and outlives a power cut. What cannot be written is a `ComputationError`.
    """
    path = Path(path)
    try:
        return replace(path, write, sealed=sealed, lasting=lasting)
    except OSError as error:
        raise _not_written(path, error) from error


def replace(
    path: Path, write: Callable[[BinaryIO], object], *, sealed: bool = False, lasting: bool = True
) -> Path:
    """Write a file as `atomic_write` does, for those who go on without it: failures are OSErrors."""
    path.parent.mkdir(parents=True, exist_ok=True)
    if path.parent not in _swept:  # what an earlier process left there
        _swept.add(path.parent)
        remove_left_overs(path.parent)
    file = _new_part(path)
    part = Path(file.name)
    try:
        with file:
            write(file)
            if sealed:
                file.write(_seal_of(file, file.seek(0, os.SEEK_END)))
            file.flush()
            if lasting:
                os.fsync(file.fileno())
            if fcntl is not None:  # while it is locked nobody takes it for a left-over
                os.replace(part, path)
        if fcntl is None:
            os.replace(part, path)
    finally:
        with suppress(OSError):
            part.unlink()
    return path


def write_bytes(path: str | os.PathLike[str], contents: bytes | memoryview, *, sealed: bool = False) -> Path:
    """Write what is in memory to a file, as `atomic_write` does, where the disk has space for it."""
    with suppress(OSError):
        require_space(Path(path), len(contents))
    return atomic_write(path, lambda file: file.write(contents), sealed=sealed)


def require_space(path: Path, size: float) -> None:
    """Refuse to begin what the disk cannot hold: about so many bytes, at a path that need not exist."""
    free = free_space(path)
    if size > free:
        raise _too_large(path, size, free)


def free_space(path: Path) -> int:
    """Free space of the disk that holds a path, or would hold it, in bytes."""
    return shutil.disk_usage(_existing(path)).free


def _existing(path: Path) -> Path:
    """First of a path and the folders above it that exists, if only as a link."""
    path = path.absolute()
    return next(place for place in (path, *path.parents) if place.exists() or place.is_symlink())


def final_place(path: Path) -> Path:
    """Where a file of a new folder ends up, see `together`."""
    return Path(*(part for part in path.parts if not _PART.fullmatch(part)))


def _not_written(path: Path, error: OSError) -> AsperityError:
    path = final_place(path)
    remedy = "another folder, or free space on this disk"
    why = error.strerror or str(error)
    if error.errno == errno.ENAMETOOLONG:
        return InputError(str(path), "a name that is too long", "names that the disk can hold")
    if error.errno == errno.EFBIG:
        why = "files may not grow as large here"
        remedy = "a larger limit on the size of files, as 'ulimit -f unlimited' sets it"
    elif error.errno in _FULL:
        with suppress(OSError):
            return _too_large(path, 0, free_space(path))
    return ComputationError(f"{path} could not be written ({why})", remedy)


def _too_large(path: Path, size: float, free: int) -> ComputationError:
    needed = f"{amount(size)} are needed, " if size > free else ""
    what = f"{final_place(path)} could not be written: the disk is full ({needed}{amount(free)} are free)"
    return ComputationError(what, "another folder, or free space on this disk")


def amount(size: float) -> str:
    """Write a number of bytes, as ``"1.5 MiB"``."""
    for unit, factor in (("GiB", 2**30), ("MiB", 2**20), ("KiB", 2**10)):
        if size >= factor:
            return f"{rounded(size / factor)} {unit}"
    return f"{size:.0f} bytes"


def _seal_of(file: BinaryIO, size: int) -> bytes:
    """Digest of the first `size` bytes of a file, as it stands at the file's end."""
    digest = hashlib.sha256()
    file.seek(0)
    while size > 0 and (chunk := file.read(min(_CHUNK, size))):
        digest.update(chunk)
        size -= len(chunk)
    file.seek(0, os.SEEK_END)
    return _SEAL + digest.hexdigest().encode()


def is_sealed(file: BinaryIO) -> bool | None:
    """Whether a file is, to the last bit, what `atomic_write` has sealed; None if it has no seal.

    The seal stands behind the end that archives (zip) and HDF5 files know of; their readers pass over it. It
    shows damage, not malice: anybody can make one. The file stands at its start afterwards.
    """
    size = file.seek(0, os.SEEK_END) - _SEAL_SIZE
    file.seek(max(size, 0))
    seal = file.read()
    same = _seal_of(file, size) == seal if size >= 0 and seal.startswith(_SEAL) else None
    file.seek(0)
    return same


def _new_part(path: Path) -> BinaryIO:
    """Open a new file beside a path, locked as one that is being written."""
    while True:
        temporary = path.with_name(f".{path.name}.{secrets.token_hex(4)}.part")
        file = open(temporary, "x+b")  # noqa: SIM115 (the caller closes it)
        if fcntl is None:
            return file
        with suppress(OSError):  # a file system without locks
            fcntl.flock(file, fcntl.LOCK_SH)
        if temporary.exists():  # else a sweep came between
            return file
        file.close()


def left_overs(folder: Path) -> list[Path]:
    """Files that an interrupted write left in a folder, and that nobody writes any more."""
    try:
        return sorted(path for path in folder.iterdir() if _PART.fullmatch(path.name) and _abandoned(path))
    except OSError:
        return []


def _abandoned(part: Path) -> bool:
    with suppress(OSError), _locked(part) as free:
        return bool(free)
    return False


def remove_left_overs(folder: Path) -> int:
    """Remove the left-overs of a folder; return how many there were."""
    return sum(map(discard, left_overs(folder)))


def discard(path: Path) -> bool:
    """Remove a file, if it can be; a part only where nobody writes it. Return whether it went."""
    with suppress(OSError), _locked(path) if _PART.fullmatch(path.name) else nullcontext(True) as free:
        if free and path.is_dir() and not path.is_symlink():
            shutil.rmtree(path)
        elif free:
            path.unlink()
        return bool(free)
    return False


@contextmanager
def _locked(path: Path, flags: int = os.O_RDONLY | getattr(os, "O_NONBLOCK", 0)) -> Iterator[bool | None]:
    """Lock a file or folder, if nobody else has; tell whether it is locked, None where none can be.

    A part must be removed while it is locked: a writer may have made it and be about to lock it.
    """
    if fcntl is None:  # an open file cannot be removed then
        yield True
        return
    descriptor = os.open(path, flags, 0o600)
    try:
        free = None
        with suppress(OSError):  # a file system without locks
            try:
                fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
                free = True
            except BlockingIOError:
                free = False
        yield free
    finally:
        os.close(descriptor)


@contextmanager
def together(folder: Path, last: str) -> Iterator[Path]:
    """Make a new folder whose files come to a folder together, at the end of the ``with`` statement.

    Until then, and if that fails, what is there stays as it is. The file called `last` comes last, and so
    says that all the others are there. Space is needed for both, the earlier files and the new ones.
    """
    remove_left_overs(folder)
    new = folder / f".new.{secrets.token_hex(4)}.part"
    try:
        new.mkdir(parents=True)
        with _locked(new):  # so that nobody takes it for a left-over
            yield new
            for file in sorted(filter(Path.is_file, new.rglob("*")), key=lambda file: file.name == last):
                target = folder / file.relative_to(new)
                target.parent.mkdir(parents=True, exist_ok=True)
                os.replace(file, target)
    except OSError as error:
        raise _not_written(folder, error) from error
    finally:
        shutil.rmtree(new, ignore_errors=True)


@contextmanager
def claimed_file(path: Path) -> Iterator[bool]:
    """Claim a file that is to be made, until it is; tell whether nobody else does.

    What stands for it is an empty file beside it, swept like a part if its process ends. Where such files
    cannot be made or locked, nobody claims any.
    """
    stand_in = path.with_name(f".{path.name}.{'0' * 8}.part")
    with ExitStack() as stack:
        free: bool | None = None
        with suppress(OSError):
            path.parent.mkdir(parents=True, exist_ok=True)
            free = stack.enter_context(_locked(stand_in, os.O_RDWR | os.O_CREAT))
        try:
            yield free is not False
        finally:
            if free is not False:
                with suppress(OSError):
                    stand_in.unlink()


@contextmanager
def alone_in(folder: Path) -> Iterator[None]:
    """Keep other runs out of a folder, which is made if it is missing.

    The folder itself is locked, so that nothing can be left in it; on Windows nothing is.
    """
    with ExitStack() as stack:
        try:
            made = not folder.exists()
            folder.mkdir(parents=True, exist_ok=True)
            free = stack.enter_context(_locked(folder))
        except OSError as error:
            raise _not_written(folder, error) from error
        if free is False:
            received = "a folder into which another run is writing"
            allowed = "a folder of its own for each run"
            remedy = "Wait for that run, or choose another folder with -o."
            raise InputError(str(folder), received, allowed, remedy)
        try:
            yield
        finally:
            if made:
                with suppress(OSError):  # it is removed only if it is empty
                    folder.rmdir()


def refuse_unwritable(folder: Path, what: str, remedy: str) -> None:
    """Refuse a folder into which nothing can be written, before there is anything to write; it is not made.

    The message says `what` it is for, and what to do. Where it is missing, the first folder above it that
    exists must take a new file.
    """
    where: Path | None = None
    try:
        where = _existing(folder)
        with tempfile.TemporaryFile(dir=where):
            return
    except OSError as error:  # also a name that is too long, a loop of links
        if error.errno in _FULL:
            raise _too_large(folder, 0, 0) from error
        why = error.strerror or str(error)
    if where is not None:
        link = "" if where.exists() else f"{where} is a link that leads nowhere"
        why = f"{where} is a file" if where.is_file() else link or f"{where}: {why}"
    raise InputError(what, f"{folder} ({why})", "a folder that can be written to", remedy)
