"""How errors and warnings leave the program: one clear message each, and an exit code."""

from __future__ import annotations

import atexit
import gc
import io
import sys
import traceback
import warnings
from collections.abc import Sequence
from typing import Any

import click

from asperity.cli import plain_text
from asperity.errors import AsperityError
from asperity.interrupts import interruptible, was_interrupted
from asperity.printable import printable
from asperity.terminal import say, standard_streams

FAILED = 3
INTERRUPTED = 130
_INTERRUPTED = "interrupted; run the same command again to continue"
COLLECT_AFTER = 1_000_000
"""New objects until unused ones are sought: imports and figures make many, and few are ever unused."""


class Door(click.Group):
    """A group of commands that turns every error into a message and an exit code.

    0 done; 2 the input is wrong; 3 the computation failed; 130 interrupted.
    """

    def main(
        self,
        args: Sequence[str] | None = None,
        prog_name: str | None = None,
        complete_var: str | None = None,
        standalone_mode: bool = True,
        **extra: Any,
    ) -> Any:
        """Run the program, with standard streams that need no reader."""
        with standard_streams(errors=plain_text.NAME):  # a pipe without − gets - and goes on
            try:
                code = super().main(args, prog_name, complete_var, standalone_mode=False, **extra)
            except click.ClickException as error:
                usage = io.StringIO()
                error.show(usage)
                say(usage.getvalue(), err=True, lines=True)
                code = error.exit_code
            except click.Abort:  # before a command has begun, or after its end
                say(_INTERRUPTED, err=True)
                code = INTERRUPTED
        if standalone_mode:
            sys.exit(code)
        return code

    def invoke(self, ctx: click.Context) -> Any:
        """Run the command."""
        gc.set_threshold(COLLECT_AFTER)
        atexit.register(gc.freeze)  # a last search for unused objects would take a second
        with interruptible(), warnings.catch_warnings():
            warnings.simplefilter("always")
            warnings.showwarning = _WarningLines()
            try:
                return super().invoke(ctx)
            except (click.ClickException, click.exceptions.Exit):
                raise
            except (KeyboardInterrupt, click.Abort):
                say(_INTERRUPTED, err=True)
                ctx.exit(INTERRUPTED)
            except Exception as error:
                if was_interrupted():  # and an import has made another error of it
                    say(_INTERRUPTED, err=True)
                    ctx.exit(INTERRUPTED)
                message, code = _outcome(error)
                if ctx.params.get("debug"):
                    say(traceback.format_exc(), err=True, lines=True)
                say(f"Error: {message}", err=True, lines=True)
                ctx.exit(code)


def _outcome(error: Exception) -> tuple[str, int]:
    """Message and exit code of an error."""
    if isinstance(error, AsperityError):
        return str(error), error.exit_code
    if isinstance(error, MemoryError):
        remedy = "a smaller contact.window, a shorter duration or a coarser contact.spacing"
        return f"the memory of this machine is too small. Try: {remedy}.", FAILED
    what = printable(f"the program failed with {type(error).__name__}: {error}")
    return f"{what}. Try: asperity --debug …, which shows where.", FAILED


class _WarningLines:
    """Print each warning once, on one line."""

    def __init__(self) -> None:
        self.shown: set[str] = set()

    def __call__(
        self,
        message: Warning | str,
        category: type[Warning],
        filename: str,
        lineno: int,
        file: Any = None,
        line: str | None = None,
    ) -> None:
        """Print `message`, unless it has been printed before."""
        if str(message) not in self.shown and not issubclass(category, DeprecationWarning | ImportWarning):
            self.shown.add(str(message))
            say(f"Warning: {message}", err=True)
