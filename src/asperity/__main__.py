"""Where the program starts: ``asperity``, or ``python -m asperity``."""

import os
import sys

from asperity.interrupts import interruptible


def start(name: str = "asperity") -> None:
    """Run the command line; an interrupt is told in a word, even while modules are imported."""
    try:
        with interruptible():
            from asperity.cli import main

            main(prog_name=name)
    except KeyboardInterrupt:
        if sys.stderr is not None:  # it is closed
            sys.stderr.write("interrupted\n")
            sys.stderr.flush()
        os._exit(130)  # half-imported modules have nothing to put in order


if __name__ == "__main__":
    start("python -m asperity")
