"""Foreign files are opened in a sandbox: a process with limits, which reads one file and may hang or end."""

import importlib
import json
import os
import signal
import subprocess
import sys
from collections.abc import Callable, Sequence
from contextlib import suppress
from pathlib import Path
from threading import Event, Thread, Timer
from typing import IO, Any, BinaryIO

import numpy as np
from numpy.typing import NDArray

from asperity.confinement import confine
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
    "import sys, json; installed = sys.path[:]; sys.path[:] = json.loads(sys.argv[1]); "
    "from asperity.garbage import seek_seldom; seek_seldom(); "
    "import asperity.sandbox as box; box.answer(installed)"
)


def sandboxed(
    function: Callable[..., Answer],
    path: Path,
    arguments: list[Any],
    *,
    source: str,
    kind: str,
    packages: Sequence[str] = (),
) -> Answer:
    """Call a function of a module with the path of a file, in a process that can open no other file.

    What it returns is returned. Its other arguments are what JSON can hold; `source` and `kind` are name and
    format of the file, as ``"netCDF-4"``, for messages. `packages` are those that the function needs: they
    are loaded before the process is confined (see `asperity.confinement`), and may be missing. An
    `InputError` is what the function raised; or says that it took more time or memory than it may, or that
    its process ended.
    """
    file = str(path.absolute())
    size = path.stat().st_size
    seconds = SECONDS + size / BYTES_PER_SECOND
    limits = [max(MEMORY, 4 * size), int(seconds) + 1]
    request = [function.__module__, function.__name__, file, arguments, list(packages), *limits]
    code, found, words = _asked(json.dumps(request).encode(), PATIENCE * seconds)
    if code == 0 and found is not None:
        return found
    message = words.decode(errors="replace").strip().rpartition("\n")[2]
    if code == _REFUSED:
        raise InputError(*json.loads(message))
    if code == _FAILED:
        found_there = f"{json.loads(message)} while it was opened"
    elif code == _OUT_OF_TIME:
        found_there = f"a file that takes more than {seconds:.0f} s to open"
    else:
        found_there = f"a file that ends the program that opens it (code {code})"
    remedy = "It is damaged, or not of this format; export it again."
    raise InputError(source, found_there, f"an intact {kind} file", remedy)


def _asked(request: bytes, patience: float) -> tuple[int, Answer | None, bytes]:
    """Exit code, answer and last words of a process that is given a request and so many seconds."""
    command = [sys.executable, "-c", _START, json.dumps(sys.path)]
    pipe = subprocess.PIPE
    environment = os.environ | _ONE_THREAD
    late = Event()
    words = bytearray()
    with subprocess.Popen(command, stdin=pipe, stdout=pipe, stderr=pipe, env=environment) as process:
        assert process.stdin is not None
        assert process.stdout is not None
        hears = Thread(target=_collect, args=(process.stderr, words), daemon=True)

        def lose_patience() -> None:
            late.set()
            process.kill()

        waits = Timer(patience, lose_patience)
        waits.daemon = True
        found = None
        try:
            hears.start()
            waits.start()
            with suppress(OSError):  # it has ended already
                process.stdin.write(request)
                process.stdin.close()
            with suppress(ValueError, EOFError):  # it ended before it had said all
                found = received(process.stdout)
            hears.join()
            code = process.wait()
        finally:  # an interrupt, too, leaves nothing behind
            waits.cancel()
            process.kill()
            process.wait()
    return _OUT_OF_TIME if late.is_set() else code, found, bytes(words)


def _collect(stream: IO[bytes] | None, words: bytearray) -> None:
    with suppress(OSError, ValueError):
        words.extend(stream.read() if stream else b"")


def answer(installed: Sequence[str]) -> None:
    """Answer the request on standard input, as the process that `sandboxed` starts.

    `installed` are the folders of packages that Python knew when it was started.
    """
    module, name, path, arguments, packages, memory, seconds = json.load(sys.stdin)
    function = getattr(importlib.import_module(module), name)
    for package in packages:
        with suppress(ImportError):  # who needs it says so
            importlib.import_module(package)
    confine(path, installed)
    limit_process(memory, seconds)
    try:
        send(function(path, *arguments), sys.stdout.buffer)
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


def received(answer: IO[bytes]) -> Answer:
    """Read what `send` wrote, each array once, where it stays; a ValueError if that is not all there."""
    description, kinds = json.loads(answer.readline())
    arrays = []
    for kind, shape in kinds:
        each = np.empty(shape, kind)  # where the processor reads it fast, and it may be changed
        bytes_of_it = each.reshape(-1).view(np.uint8).data
        while bytes_of_it:
            count = answer.readinto(bytes_of_it)  # type: ignore[attr-defined]
            if not count:
                raise ValueError("an answer that ends before its numbers do")
            bytes_of_it = bytes_of_it[count:]
        arrays.append(each)
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
