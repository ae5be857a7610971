"""Ctrl-C, and the signals with which systems end a program, as one kind of interrupt."""

import _thread
import signal
import sys
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from importlib.machinery import ExtensionFileLoader
from types import FrameType
from typing import Any

_SIGNALS = ("SIGINT", "SIGTERM", "SIGHUP", "SIGBREAK")
_COMPILERS = ("numba", "llvmlite")
_received: list[int] = []
_held: list[int] = []
_holding = 0


@contextmanager
def interruptible() -> Iterator[None]:
    """Let every such signal raise KeyboardInterrupt while the body of the ``with`` statement runs."""
    _received.clear()
    told = sys.unraisablehook
    sys.unraisablehook = lambda lost: _again(lost, told)
    try:
        with handled(_interrupt):
            yield
    finally:
        sys.unraisablehook = told


@contextmanager
def handled(handler: Callable[[int, FrameType | None], object]) -> Iterator[None]:
    """Have a function called by every such signal while the body of the ``with`` statement runs.

    A signal that is ignored stays so, as with nohup, or in the background of a shell. Python calls handlers
    in the main thread; in another one nothing changes.
    """
    earlier: dict[int, Any] = {}
    if threading.current_thread() is threading.main_thread():
        for number in (getattr(signal, name) for name in _SIGNALS if hasattr(signal, name)):
            if signal.getsignal(number) is not signal.SIG_IGN:
                earlier[number] = signal.signal(number, handler)
    try:
        yield
    finally:
        for number, before in earlier.items():
            signal.signal(number, before)


def _interrupt(number: int, frame: FrameType | None) -> None:
    _received.append(number)
    if _holding:
        _held.append(number)
    elif _loads_machine_code(frame):
        _interrupt_soon(number)
    else:
        raise KeyboardInterrupt


def _loads_machine_code(frame: FrameType | None) -> bool:
    """Whether a compiled module is set up, or a kernel compiled: half of it may end the process."""
    while frame is not None:
        if frame.f_globals.get("__name__", "").partition(".")[0] in _COMPILERS:
            return True
        loads = frame.f_code.co_name in ("create_module", "exec_module")
        if loads and isinstance(frame.f_locals.get("self"), ExtensionFileLoader):
            return True
        frame = frame.f_back
    return False


def _again(lost: Any, otherwise: Callable[[Any], object]) -> None:
    """Interrupt once more where Python lets no error through, as in callbacks of weak references."""
    if lost.exc_type is None or not issubclass(lost.exc_type, KeyboardInterrupt):
        otherwise(lost)
        return
    _interrupt_soon(_received[-1] if _received else signal.SIGINT)


def _interrupt_soon(number: int) -> None:
    again = threading.Timer(0.02, _raise_in_main, [number])
    again.daemon = True
    again.start()


def _raise_in_main(number: int) -> None:
    if sys.platform == "win32":
        _thread.interrupt_main(number)
    else:  # this wakes it from a system call as well
        signal.pthread_kill(threading.main_thread().ident or 0, number)


def was_interrupted() -> bool:
    """Whether an interrupt came, even if an import has made another error of it."""
    return bool(_received)


@contextmanager
def no_interrupt_for_children() -> Iterator[None]:
    """Let processes started here receive neither Ctrl-C nor a hang-up; what comes meanwhile waits.

    They inherit the mask of this thread. A signal may still reach another thread, and its handler the main
    one: half a start would leave a process that nobody knows.
    """
    global _holding
    before = None
    _holding += 1
    try:
        if sys.platform != "win32":
            before = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT, signal.SIGHUP})
        yield
    finally:
        if before is not None:
            signal.pthread_sigmask(signal.SIG_SETMASK, before)
        _holding -= 1
        if _held and not _holding:
            number = _held[-1]
            _held.clear()
            _raise_in_main(number)
