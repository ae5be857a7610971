"""How errors and warnings leave the program: one clear message each, and an exit code."""

from __future__ import annotations

import sys
import traceback
import warnings
from typing import Any

import click

from asperity.errors import AsperityError

FAILED = 3
INTERRUPTED = 130


class Door(click.Group):
    """A group of commands that turns every error into a message and an exit code.

    0 done; 2 the input is wrong; 3 the computation failed; 130 interrupted.
    """

    def invoke(self, ctx: click.Context) -> Any:
        """Run the command."""
        with warnings.catch_warnings():
            warnings.simplefilter("always")
            warnings.showwarning = _WarningLines()
            try:
                return super().invoke(ctx)
            except (click.ClickException, click.exceptions.Exit, BrokenPipeError):
                raise
            except AsperityError as error:
                message, code = str(error), error.exit_code
            except (KeyboardInterrupt, click.Abort):
                message, code = "interrupted; run the same command again to continue", INTERRUPTED
            except MemoryError:
                remedy = "Try: a smaller window, a shorter duration or a coarser spacing"
                message, code = f"the memory of this machine is too small. {remedy}.", FAILED
            except Exception as error:
                what = f"the program failed with {type(error).__name__}: {error}"
                message, code = f"{what}. Try: asperity --debug …, which shows where.", FAILED
            if ctx.params.get("debug") and code != INTERRUPTED:
                click.echo(traceback.format_exc(), err=True)
        click.echo(message if code == INTERRUPTED else f"Error: {message}", err=True)
        ctx.exit(code)


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
            print(f"Warning: {message}", file=sys.stderr)
