"""Foreign files are opened in a sandbox: a process with limits of time and memory, which may hang or end."""

import importlib
import json
import os
import signal
import subprocess
import sys
from collections.abc import Callable
from contextlib import suppress
from threading import Thread
from typing import Any, BinaryIO

import numpy as np
from numpy.typing import NDArray

from asperity.errors import InputError, reason
from asperity.files import amount

Answer = tuple[Any, list[NDArray[Any]]]
"""What JSON can hold, and arrays of numbers or words."""
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
_OUT_OF_TIME = -getattr(signal, "SIGXCPU", 24)
_ONE_THREAD = dict.fromkeys(("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS", "MKL_NUM_THREADS"), "1")
_START = (
    "import sys, json; sys.path[:] = json.loads(sys.argv[1]); import asperity.sandbox as box; box.answer()"
)


def sandboxed(
    function: Callable[..., Answer], arguments: list[Any], source: str, size: int, kind: str
) -> Answer:
    """Call a function of a module in a process of its own, and return what it returns.

    Its arguments are what JSON can hold. `source`, `size` and `kind` are name, bytes and format, as
    ``"netCDF-4"``, of the file that it opens, for messages. An `InputError` is what the function raised; or
    says that it took more time or memory than it may, or that its process ended.
    """
    seconds = SECONDS + size / BYTES_PER_SECOND
    command = [sys.executable, "-c", _START, json.dumps(sys.path)]
    request = [function.__module__, function.__name__, arguments, max(MEMORY, 4 * size), int(seconds) + 1]
    pipe, environment = subprocess.PIPE, os.environ | _ONE_THREAD
    with subprocess.Popen(command, stdin=pipe, stdout=pipe, stderr=pipe, env=environment) as process:
        try:
            told, words = process.communicate(json.dumps(request).encode(), PATIENCE * seconds)
            code = process.returncode
        except subprocess.TimeoutExpired:
            code, told, words = _OUT_OF_TIME, b"", b""
        finally:  # an interrupt, too, leaves nothing behind
            process.kill()
            process.wait()
    if code == 0:
        return received(told)
    message = words.decode(errors="replace").strip().rpartition("\n")[2]
    if code == _REFUSED:
        raise InputError(*json.loads(message))
    if code == _FAILED:
        found = f"{json.loads(message)} while it was opened"
    elif code == _OUT_OF_TIME:
        found = f"a file that takes more than {seconds:.0f} s to open"
    else:
        found = f"a file that ends the program that opens it (code {code})"
    remedy = "It is damaged, or not of this format; export it again."
    raise InputError(source, found, f"an intact {kind} file", remedy)


def answer() -> None:
    """Answer the request on standard input, as the process that `sandboxed` starts."""
    module, name, arguments, memory, seconds = json.load(sys.stdin)
    limit_process(memory, seconds)
    try:
        send(getattr(importlib.import_module(module), name)(*arguments), sys.stdout.buffer)
    except InputError as error:
        _leave([error.what, str(error.received), error.allowed, error.remedy], _REFUSED)
    except MemoryError:
        _leave(f"more than {amount(memory)} of memory were needed", _FAILED)
    except Exception as error:  # whatever a library makes of malformed bytes
        _leave(reason(error), _FAILED)


def _leave(message: object, code: int) -> None:
    sys.stderr.write(f"\n{json.dumps(message)}")
    sys.stderr.flush()
    os._exit(code)  # what a library holds is not taken apart


def send(answer: Answer, to: BinaryIO) -> None:
    """Write a line that says what is in an answer, then the bytes of its arrays."""
    description, arrays = answer
    plain = [np.asarray(each.astype(str) if each.dtype == object else each, order="C") for each in arrays]
    head = [description, [(each.dtype.str, each.shape) for each in plain]]
    to.write(json.dumps(head, default=lambda value: value.tolist()).encode() + b"\n")
    for each in plain:
        to.write(each.reshape(-1).view(np.uint8).data)
    to.flush()


def received(answer: bytes) -> Answer:
    """Read what `send` wrote."""
    start, arrays = answer.index(b"\n") + 1, []
    description, kinds = json.loads(answer[:start])
    for kind, shape in kinds:
        each = np.frombuffer(answer, kind, int(np.prod(shape)), start).reshape(shape)
        arrays.append(each.copy())  # where the processor reads it fast, and it may be changed
        start += each.nbytes
    return description, arrays


def limit_process(memory: int, seconds: int = 0) -> None:
    """Limit the address space of this process, bytes, and its time, where the system can."""
    try:
        import resource
    except ImportError:  # Windows; the time is limited from outside as well
        return
    for kind, value in ((resource.RLIMIT_AS, memory), (resource.RLIMIT_CPU, seconds)):
        _, hard = resource.getrlimit(kind)
        if value and (hard == resource.RLIM_INFINITY or hard >= value):
            resource.setrlimit(kind, (value, hard))


def end_with_parent() -> None:
    """End this process when the one that started it ends, however it does: standard input ends then."""

    def listen() -> None:
        with suppress(OSError, ValueError):
            while os.read(0, 4096):
                pass
        os._exit(1)

    Thread(target=listen, daemon=True).start()
