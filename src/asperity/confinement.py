"""What a process may open from now on: the files that it was told of and its own programs, on Linux."""

import ctypes
import os
import sys
import sysconfig
from collections.abc import Iterable
from contextlib import suppress
from pathlib import Path
from typing import Any

_CREATE_RULESET, _ADD_RULE, _RESTRICT_SELF = 444, 445, 446
"""System calls of Landlock, the same on every kind of processor."""
_ASK_FOR_VERSION = 1
_PATH_BENEATH = 1
_NO_NEW_PRIVILEGES = 38
_EXECUTE = 1 << 0
_READ_FILE = 1 << 2
_READ_FOLDER = 1 << 3
_FILE_RIGHTS = {1: 13, 2: 14, 3: 15, 5: 16}
"""How many rights over files a version of Landlock knows, from the version that brought the last of them."""
_NETWORK_RIGHTS = {1: 0, 4: 2}
"""How many over TCP connections."""
_SYSTEM = ("/lib", "/lib64", "/usr/lib", "/usr/lib64", "/etc/ld.so.cache", "/dev/null", "/dev/urandom")
"""What a library is loaded from, and what it may ask for."""


class _Ruleset(ctypes.Structure):
    _fields_ = (("files", ctypes.c_uint64), ("network", ctypes.c_uint64))


class _PathBeneath(ctypes.Structure):
    _pack_ = 1
    _layout_ = "ms"
    _fields_ = (("allowed", ctypes.c_uint64), ("parent", ctypes.c_int32))


def confine(file: str, installed: Iterable[str] = ()) -> bool:
    """Open nothing from now on but a file, to read it, and what Python is made of; write and connect nowhere.

    `installed` are folders that packages are loaded from, beside those that Python knows itself. This holds
    for the rest of this process and for all that it starts, in Python and in every library, and cannot be
    taken back: the kernel refuses (Linux 5.13 or later, with Landlock). Returns whether it does; where there
    is no Landlock, everything stays as it was.
    """
    if sys.platform != "linux":
        return False
    call = ctypes.CDLL(None, use_errno=True).syscall
    call.restype = ctypes.c_long
    version = call(_CREATE_RULESET, None, ctypes.c_size_t(0), ctypes.c_uint32(_ASK_FOR_VERSION))
    if version < 1:
        return False
    handled = _Ruleset(_all_of(_FILE_RIGHTS, version), _all_of(_NETWORK_RIGHTS, version))
    size = ctypes.sizeof(handled) if version >= 4 else 8
    rules = call(_CREATE_RULESET, ctypes.byref(handled), ctypes.c_size_t(size), ctypes.c_uint32(0))
    if rules < 0:
        return False
    try:
        for path in (file, *_program_folders(installed), *_SYSTEM):
            _allow(call, rules, path)
        if ctypes.CDLL(None).prctl(_NO_NEW_PRIVILEGES, 1, 0, 0, 0):
            return False
        return call(_RESTRICT_SELF, ctypes.c_int(rules), ctypes.c_uint32(0)) == 0
    finally:
        os.close(rules)


def _all_of(rights: dict[int, int], version: int) -> int:
    """Bits of all rights that a version knows."""
    return (1 << max(count for since, count in rights.items() if since <= version)) - 1


def _allow(call: Any, rules: int, path: str) -> None:
    """Let a file be read, or all that is in a folder; what is not there needs no leave."""
    with suppress(OSError):
        opened = os.open(path, os.O_PATH | os.O_CLOEXEC)
        try:
            folder = os.path.isdir(path)
            rule = _PathBeneath(_READ_FILE | (_EXECUTE | _READ_FOLDER if folder else 0), opened)
            call(_ADD_RULE, ctypes.c_int(rules), _PATH_BENEATH, ctypes.byref(rule), ctypes.c_uint32(0))
        finally:
            os.close(opened)


def _program_folders(installed: Iterable[str]) -> set[str]:
    """Folders of Python, of its packages and of this one; not the current one, where people's files lie."""
    told = sysconfig.get_paths()
    folders = {told[name] for name in ("stdlib", "platstdlib", "purelib", "platlib")}
    folders |= {os.path.join(prefix, "lib") for prefix in (sys.prefix, sys.base_prefix)}
    here = os.path.realpath(os.curdir)
    elsewhere = {each for each in installed if each and os.path.realpath(each) != here}
    return folders | elsewhere | {str(Path(__file__).parent)}
