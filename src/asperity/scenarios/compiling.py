"""Compilation of the kernels ahead of the work, so that the first run says what it waits for."""

from __future__ import annotations

import os
import subprocess
import sys
import warnings
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any

import numpy as np

from asperity.contact import HalfSpace
from asperity.errors import PhysicsWarning
from asperity.kernels.options import is_kept
from asperity.progress import COMPILATION, Progress
from asperity.threads import processors

MESSAGE = "compiled functions"


def call_kernels(progress: Progress, stepping: Any, rolling: Callable[[], None]) -> None:
    """Call every kernel of a kind of case once on next to nothing: it is compiled now, or loaded from disk.

    `stepping` is the one whose compilation takes longest; `rolling`, a function of a module, rolls a few
    steps, so that all that is stepped is compiled.
    """
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", PhysicsWarning)
        progress(0, 2, MESSAGE)
        with _beside(stepping, rolling):
            x = np.arange(-4.0, 5.0) ** 2
            HalfSpace((9, 9), (1.0, 1.0), 1.0).solve(np.add.outer(x, x), approach=5.0)
        progress(1, 2, MESSAGE)
        rolling()
        press_and_displace()
        progress(2, 2, MESSAGE)


@contextmanager
def _beside(stepping: Any, rolling: Callable[[], None]) -> Iterator[None]:
    """Compile the rolling in a second process beside the contact, where it is not on disk yet.

    The compiler takes one function at a time in a process; what the second one compiles, the first loads.
    """
    if processors() < 2 or is_kept(stepping):
        yield
        return
    name = rolling.__name__
    pressing = press_and_displace.__name__
    code = (
        f"from {rolling.__module__} import {name}; {name}(); from {__name__} import {pressing}; {pressing}()"
    )
    environment = os.environ | {"PYTHONPATH": os.pathsep.join(filter(None, sys.path))}
    quiet: dict[str, Any] = {"stdout": subprocess.DEVNULL, "stderr": subprocess.DEVNULL}
    with subprocess.Popen([sys.executable, "-W", "ignore", "-c", code], env=environment, **quiet) as other:
        try:
            yield
        except BaseException:
            other.kill()
            raise
        COMPILATION.begin(name)  # waiting for it is compiling, too
        other.wait()
        COMPILATION.end(name)


def press_and_displace() -> None:
    """Find the stiffness of a contact, and what a pressure displaces."""
    half_space = HalfSpace((9, 9), (1.0, 1.0), 1.0)
    half_space.tangent_stiffness(np.ones((9, 9)))
    half_space.displacement(np.ones((9, 9)))
