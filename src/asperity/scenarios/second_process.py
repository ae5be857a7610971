"""A second process that compiles the contact while the first one does something else.

The compiler takes one function at a time in a process. What the second compiles, the first loads; what both
need at once, one of them compiles (`asperity.kernels.turns`).
"""

from __future__ import annotations

import os
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

from asperity.kernels.folders import is_kept
from asperity.threads import processors

LAST = "asperity.kernels.scanning.solve_positions"
"""What is compiled last."""
CODE = (
    "from asperity.apart import end_with_parent; end_with_parent(); "
    "from asperity.scenarios.compiling import compile_beside; compile_beside()"
)
_running = False


@contextmanager
def contact_compiled_beside() -> Iterator[None]:
    """Compile the contact in a second process, unless it is on disk, while the ``with`` statement runs."""
    global _running
    if _running or processors() < 2 or is_kept(LAST) or (other := _started()) is None:
        yield
        return
    with other:
        _running = True
        try:
            yield
        finally:
            _running = False
            other.kill()  # what it has not kept yet is not needed


def _started() -> subprocess.Popen[bytes] | None:
    """Start it; None where no process can be started, as inside another program."""
    environment = os.environ | {"PYTHONPATH": os.pathsep.join(filter(None, sys.path))}
    streams: dict[str, Any] = {"stdin": subprocess.PIPE}
    streams |= {"stdout": subprocess.DEVNULL, "stderr": subprocess.DEVNULL}
    try:
        return subprocess.Popen([sys.executable, "-W", "ignore", "-c", CODE], env=environment, **streams)
    except OSError:
        return None
