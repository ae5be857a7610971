"""Compiled kernels, kept on disk: verified before they are used, compiled again where there is a doubt.

What numba keeps are pickles, and machine code that is run as it is. So only files are read whose digest is
right, in a folder that nobody but the user can write to. A file is named by all that it depends on: what is
damaged, incomplete or of another version counts as missing.
"""

from __future__ import annotations

import hashlib
import os
import pickle
import re
import warnings
from collections.abc import Callable
from contextlib import suppress
from functools import cache
from pathlib import Path
from typing import Any

from numba.core.compiler import CompileResult
from numba.core.runtime.nrt import rtsys
from numba.core.serialize import dumps

from asperity.files import replace
from asperity.kernels.folders import VARIABLE, folders, stamp
from asperity.kernels.turns import end_turn, take_turn
from asperity.progress import COMPILATION
from asperity.store import is_private

DIGEST = 32
"""Bytes of a digest."""


SOURCES = stamp()
"""Folder of this version."""


class Kept:
    """What numba asks for the machine code of a function, and hands it to, signature by signature.

    Stands for `numba.core.caching.FunctionCache`, which trusts what it finds and fails where it cannot write;
    numba has no public way to put another in its place, nor to write its results: hence the private names.
    `inlined` says that nothing is left of it where other kernels call it, `entry` that Python can.
    """

    def __init__(self, function: Callable[..., Any], *, inlined: bool = False, entry: bool = True) -> None:
        self.inlined, self.entry = inlined, entry
        self.name = re.sub(r"[^\w.]", "", f"{function.__module__}.{function.__qualname__}")
        own = Path(function.__code__.co_filename)
        self.source = own.read_bytes() if own.is_file() else b""

    @property
    def cache_path(self) -> str:
        """The first of the folders."""
        return str(next(folders(), ""))

    def load_overload(self, signature: Any, context: Any) -> Any:
        """Load the machine code of a signature; None if it has to be compiled."""
        rtsys.initialize(context)  # what machine code calls; all that compiles takes a quarter of a second
        name = self.file_name(signature, context.codegen())
        found = _loaded(name, context)
        if found is None:
            COMPILATION.begin(name)
            found = _awaited(name, context)
            if found is not None:
                COMPILATION.end(name)
        return found

    def save_overload(self, signature: Any, result: Any) -> None:
        """Keep the machine code of a signature, in the first folder that takes it."""
        name = self.file_name(signature, result.codegen)
        COMPILATION.end(name)
        try:
            self._keep(name, result)
        finally:
            if (place := _place()) is not None:
                end_turn(place, name)

    def _keep(self, name: str, result: Any) -> None:
        if result.lifted or result.library.has_dynamic_globals:  # holds objects or addresses of this process
            return
        named = {function.name for function in result.library._final_module.functions}
        called = [(kernel, symbol) for kernel, (symbol, _) in _CALLED.items() if symbol in named]
        bare = result._replace(type_annotation="")  # types beside each line of the source, for people
        payload = dumps((called, bare._reduce()))
        _COMPILED.add(self.name)
        if not self.inlined:
            _CALLED[name] = result.fndesc.llvm_func_name, result.library
        if not any(_written(folder, name, payload) for folder in folders()):
            _warn_unkept()

    def file_name(self, signature: Any, codegen: Any) -> str:
        """Name of a signature's file: the function's name, and a digest of all that the code depends on."""
        known = repr((self.name, self.entry, str(signature), codegen.magic_tuple())).encode()
        return f"{self.name}-{hashlib.sha256(known + self.source).hexdigest()[:24]}"

    def enable(self) -> None:
        """Do nothing: it is always enabled."""

    def disable(self) -> None:
        """Do nothing: it is always enabled."""

    def flush(self) -> None:
        """Do nothing: what is out of date is not found."""


_CALLED: dict[str, tuple[str, Any]] = {}
"""Kernels of this process by the names of their files: symbol and library, but for those that are inlined."""


_COMPILED: set[str] = set()
"""Names of the functions that this process has compiled."""


def kept_names() -> set[str]:
    """Functions whose machine code is there, for any signature: in this process, or in one of the folders."""
    found = set(_COMPILED)
    for folder in folders():
        with suppress(OSError):
            found |= {name.partition("-")[0] for name in os.listdir(folder / SOURCES)}
    return found


def _loaded(name: str, context: Any) -> Any:
    """Load a file, after those of the kernels that it calls; None if one of them cannot be trusted.

    It calls them by their symbols, which another compilation may have named otherwise. Of those that are
    linked into it, it brings copies, whose last digits may differ. The linker takes the first it gets, which
    is that of the kernel itself where it has just been compiled.
    """
    for folder in folders():
        payload = _verified(folder / SOURCES, name)
        if payload is None:
            continue
        called, data = pickle.loads(payload)  # noqa: S301 (our own, see above)
        for other, symbol in called:
            if other not in _CALLED and _loaded(other, context) is None:
                return None
            if _CALLED[other][0] != symbol:
                return None
        result = CompileResult._rebuild(context, *data)
        _CALLED.setdefault(name, (result.fndesc.llvm_func_name, result.library))
        return result
    return None


def _awaited(name: str, context: Any) -> Any:
    """Take the turn to compile a kernel; load it if another process has kept it meanwhile, else None."""
    place = _place()
    if place is None:
        return None
    take_turn(place, name, COMPILATION.hear)
    found = _loaded(name, context)
    if found is not None:
        end_turn(place, name)
    return found


def _place() -> Path | None:
    """First folder of this version's kernels that can be written to, made if it is missing."""
    for root in folders():
        with suppress(OSError):
            folder = root / SOURCES
            folder.mkdir(mode=0o700, parents=True, exist_ok=True)
            if is_private(folder) and os.access(folder, os.W_OK):
                return folder
    return None


def _digest(name: str, payload: bytes) -> bytes:
    """Digest that tells a file from a damaged one, and from that of another kernel."""
    return hashlib.sha256(name.encode() + b"\0" + payload).digest()


def _verified(folder: Path, name: str) -> bytes | None:
    """Contents of a file, without its digest; None if there is none, or none that can be trusted."""
    if not (is_private(folder) and (folder / name).is_file()):  # a pipe might never end
        return None
    try:
        contents = (folder / name).read_bytes()
    except OSError:
        return None
    digest, payload = contents[:DIGEST], contents[DIGEST:]
    return payload if digest == _digest(name, payload) else None


def _written(root: Path, name: str, payload: bytes) -> bool:
    """Write a file completely or not at all; return whether it is there."""
    folder = root / SOURCES
    try:
        folder.mkdir(mode=0o700, parents=True, exist_ok=True)
        if not is_private(folder):
            return False
        replace(folder / name, lambda file: file.write(_digest(name, payload) + payload), lasting=False)
    except OSError:
        return False
    return True


@cache
def _warn_unkept() -> None:
    """Warn, once."""
    tried = " or ".join(str(folder) for folder in folders()) or "any folder"
    warnings.warn(
        f"compiled functions cannot be kept in {tried}: every start compiles them again, some 10 s. Let "
        f"${VARIABLE} name a folder that you alone can write to.",
        RuntimeWarning,
        stacklevel=2,
    )
