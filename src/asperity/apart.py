"""Foreign files are opened apart: in a process with limits of time and memory, which may hang or end."""

from __future__ import annotations

import importlib
import json
import os
import signal
import subprocess
import sys
from contextlib import suppress
from threading import Thread
from typing import Any, BinaryIO

from asperity.errors import InputError
from asperity.files import amount

SECONDS = 20.0
"""Processor time that a file has to be opened in, plus …"""
BYTES_PER_SECOND = 20e6
"""… its size over this."""
PATIENCE = 5.0
"""How many times as long that may take where other work is done beside it."""
MEMORY = 8 * 2**30
"""Bytes of address space that opening a file may need, or four times its size if that is more."""
_REFUSED = 2
_FAILED = 3
_OUT_OF_TIME = -getattr(signal, "SIGXCPU", 0) or None
_MOST_WORDS = 300

_START = (
    "import sys, json; sys.path[:] = json.loads(sys.argv[1]); from asperity.apart import answer; answer()"
)


def apart(function: str, arguments: list[Any], source: str, size: int, kind: str) -> bytes:
    """Call a function in a process of its own, and return its answer.

    The function, as ``"asperity.results:check"``, receives the arguments, which JSON can hold, and a binary
    file to which it writes. `source`, `size` and `kind` are name, bytes and format, as ``"netCDF-4"``, of the
    file that it opens, for messages. An `InputError` is what the function raised; or says that it took more
    time or memory than it may, or that its process ended.
    """
    seconds = SECONDS + size / BYTES_PER_SECOND
    command = [sys.executable, "-c", _START, json.dumps(sys.path)]
    request = json.dumps([function, arguments, max(MEMORY, 4 * size), int(seconds) + 1]).encode()
    environment = os.environ | {"OPENBLAS_NUM_THREADS": "1", "OMP_NUM_THREADS": "1", "MKL_NUM_THREADS": "1"}
    allowed = f"an intact {kind} file"
    pipe = subprocess.PIPE
    with subprocess.Popen(command, stdin=pipe, stdout=pipe, stderr=pipe, env=environment) as process:
        try:
            answers, told = process.communicate(request, timeout=PATIENCE * seconds)
        except subprocess.TimeoutExpired:
            raise InputError(source, _too_long(seconds), allowed, _DAMAGED) from None
        finally:  # an interrupt, too, leaves nothing behind
            process.kill()
            process.wait()
    if process.returncode == 0:
        return answers
    if process.returncode == _OUT_OF_TIME:
        raise InputError(source, _too_long(seconds), allowed, _DAMAGED)
    words = told.decode(errors="replace").strip().rpartition("\n")[2]
    if process.returncode == _REFUSED:
        raise InputError(*json.loads(words))
    if process.returncode == _FAILED:
        raise InputError(source, f"{json.loads(words)} while it was opened", allowed, _DAMAGED)
    received = f"a file that ends the program that opens it (code {process.returncode})"
    raise InputError(source, received, allowed, _DAMAGED)


_DAMAGED = "It is damaged, or not of this format; export it again."


def _too_long(seconds: float) -> str:
    return f"a file that takes more than {seconds:.0f} s to open"


def answer() -> None:
    """Answer the request on standard input, as the process that `apart` starts."""
    function, arguments, memory, seconds = json.load(sys.stdin)
    _limit(memory, seconds)
    module, _, name = function.partition(":")
    try:
        getattr(importlib.import_module(module), name)(*arguments, sys.stdout.buffer)
        sys.stdout.buffer.flush()
    except InputError as error:
        _leave([error.what, str(error.received), error.allowed, error.remedy], _REFUSED)
    except MemoryError:
        _leave(f"more than {amount(memory)} of memory were needed", _FAILED)
    except Exception as error:  # whatever a library makes of malformed bytes
        _leave(reason(error), _FAILED)


def reason(error: BaseException) -> str:
    """Name an error of a library and its words, but no page of raw bytes."""
    words = " ".join("".join(c if c.isprintable() else " " for c in str(error)).split())
    cut = f"{words[:_MOST_WORDS]} …" if len(words) > _MOST_WORDS else words
    return f"{type(error).__name__} ({cut})" if cut else type(error).__name__


def _leave(message: object, code: int) -> None:
    sys.stderr.write(f"\n{json.dumps(message)}")
    sys.stderr.flush()
    os._exit(code)  # what a library holds is not taken apart


def _limit(memory: int, seconds: int) -> None:
    """Limit the memory and time of this process, where the system can."""
    limit_memory(memory)
    _limit_resource("RLIMIT_CPU", seconds)


def limit_memory(memory: int) -> None:
    """Limit the address space of this process, bytes, where the system can."""
    _limit_resource("RLIMIT_AS", memory)


def _limit_resource(name: str, value: int) -> None:
    try:
        import resource
    except ImportError:  # Windows; the time is limited from outside as well
        return
    kind = getattr(resource, name)
    _, hard = resource.getrlimit(kind)
    if hard in (resource.RLIM_INFINITY,) or hard >= value:
        resource.setrlimit(kind, (value, hard))


def end_with_parent() -> None:
    """End this process when the one that started it ends, however it does: standard input ends then."""

    def listen() -> None:
        with suppress(OSError, ValueError):
            while os.read(0, 4096):
                pass
        os._exit(1)

    Thread(target=listen, daemon=True).start()


def send(answers: BinaryIO, description: object, arrays: list[Any]) -> None:
    """Write a description, what JSON can hold, and arrays of float64 as the answer of such a function."""
    import numpy as np

    shapes = [list(array.shape) for array in arrays]
    answers.write(json.dumps([description, shapes]).encode() + b"\n")
    for array in arrays:
        answers.write(np.ascontiguousarray(array, dtype=np.float64).data)


def received(answers: bytes) -> tuple[Any, list[Any]]:
    """Read the description and the arrays that `send` wrote."""
    import numpy as np

    start = answers.index(b"\n") + 1
    description, shapes = json.loads(answers[:start])
    arrays = []
    for shape in shapes:
        count = int(np.prod(shape))
        arrays.append(np.frombuffer(answers, np.float64, count, start).reshape(shape))
        start += 8 * count
    return description, arrays
