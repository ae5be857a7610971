"""Where the program starts: ``asperity``, or ``python -m asperity``."""

import atexit
import os
import sys

from asperity.interrupts import interruptible, was_interrupted

_code = 1


def start(name: str = "asperity") -> None:
    """Run the command line; an interrupt is told in a word, even while modules are imported."""
    atexit.register(_leave)  # the first to be registered is the last to be called
    try:
        with interruptible():
            from asperity.cli import main

            main(prog_name=name)
    except SystemExit as end:
        global _code
        _code = end.code if isinstance(end.code, int) else int(end.code is not None)
        raise
    except BaseException:  # an import may have made another error of the interrupt
        if not was_interrupted():
            raise
        if sys.stderr is not None:  # it is closed
            sys.stderr.write("interrupted\n")
            sys.stderr.flush()
        os._exit(130)  # half-imported modules have nothing to put in order


def _leave() -> None:
    """End without taking Python apart: that takes a tenth of a second, and threads may fail in it."""
    try:
        for stream in (sys.stdout, sys.stderr):
            if stream is not None:  # it is closed
                stream.flush()
    except (OSError, ValueError):
        return  # Python has an exit code of its own for that
    os._exit(_code)


if __name__ == "__main__":
    start("python -m asperity")
