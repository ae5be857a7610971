"""How errors and warnings leave the program: one clear message each, and an exit code."""

from __future__ import annotations

import gc
import io
import sys
import traceback
import warnings
from collections.abc import Mapping, Sequence
from types import MappingProxyType
from typing import Any

import click

from asperity.cli import plain_text
from asperity.cli.documents import say_failure, say_outcome
from asperity.cli.teaching import Examples, Taught, write_examples, write_sections
from asperity.errors import TOO_MUCH_MEMORY, AsperityError, ComputationError
from asperity.interrupts import interruptible, was_interrupted
from asperity.printable import printable
from asperity.terminal import Manner, manner, say, speaking, standard_streams

FAILED = 3
INTERRUPTED = 130
_INTERRUPTED = "interrupted; run the same command again to continue"
COLLECT_AFTER = 1_000_000
"""New objects until unused ones are sought: imports and figures make many, and few are ever unused."""


class Door(click.Group):
    """A group of commands that turns every error into a message and an exit code.

    0 done; 2 the input is wrong; 3 the computation failed; 130 interrupted. With ``--json`` what a command
    returns, or why it failed, is one document on standard output.
    """

    command_class = Taught

    def __init__(
        self,
        *arguments: Any,
        sections: Mapping[str, Sequence[str]] = MappingProxyType({}),
        examples: Examples = (),
        **settings: Any,
    ) -> None:
        super().__init__(*arguments, **settings)
        self.sections, self.examples = sections, examples

    def main(
        self,
        args: Sequence[str] | None = None,
        prog_name: str | None = None,
        complete_var: str | None = None,
        standalone_mode: bool = True,
        **extra: Any,
    ) -> Any:
        """Run the program, with standard streams that need no reader."""
        args = sys.argv[1:] if args is None else list(args)
        wanted = Manner(document="--json" in args)  # known before anything can be wrong
        with (
            standard_streams(errors=plain_text.NAME),
            speaking(wanted),
        ):  # a pipe without − gets - and goes on
            try:
                code = super().main(args, prog_name, complete_var, standalone_mode=False, **extra)
            except click.ClickException as error:
                usage = io.StringIO()
                error.show(usage)
                say(usage.getvalue(), err=True, lines=True)
                code = _failed(_name_of(args), error.exit_code, error.format_message())
            except click.Abort:  # before a command has begun, or after its end
                say(_INTERRUPTED, err=True)
                code = _failed(_name_of(args), INTERRUPTED, _INTERRUPTED)
        if standalone_mode:
            sys.exit(code)
        return code

    def invoke(self, ctx: click.Context) -> Any:
        """Run the command."""
        gc.set_threshold(COLLECT_AFTER)
        with interruptible(), warnings.catch_warnings():
            warnings.simplefilter("always")
            warnings.showwarning = lines = _WarningLines()
            try:
                content = super().invoke(ctx)
                if manner().document:
                    met = [{"grade": "warning", "message": message} for message in lines.shown]
                    told = content | {"warnings": content["warnings"] + met}
                    say_outcome(str(ctx.invoked_subcommand), told)
            except (click.ClickException, click.exceptions.Exit):
                raise
            except (KeyboardInterrupt, click.Abort) as error:
                say(_INTERRUPTED, err=True)
                ctx.exit(_failed(ctx.invoked_subcommand, INTERRUPTED, _INTERRUPTED, error))
            except Exception as error:
                if was_interrupted():  # and an import has made another error of it
                    say(_INTERRUPTED, err=True)
                    ctx.exit(_failed(ctx.invoked_subcommand, INTERRUPTED, _INTERRUPTED, error))
                message, code = _outcome(error)
                if ctx.params.get("debug"):
                    say(traceback.format_exc(), err=True, lines=True)
                say(f"Error: {message}", err=True, lines=True)
                ctx.exit(_failed(ctx.invoked_subcommand, code, message, error))
            return None

    def format_commands(self, ctx: click.Context, formatter: click.HelpFormatter) -> None:
        """List the commands in the order of the work."""
        write_sections(formatter, self.commands, self.sections)

    def format_epilog(self, ctx: click.Context, formatter: click.HelpFormatter) -> None:
        """Write the examples."""
        write_examples(formatter, self.examples)


def _name_of(args: Sequence[str]) -> str:
    """The command among the words of a command line; empty where there is none."""
    return next((word for word in args if not word.startswith("-")), "")


def _failed(command: str | None, code: int, message: str, error: BaseException | None = None) -> int:
    """Say so in a document, if one is wanted; return the exit code."""
    try:
        if manner().document:
            say_failure(command or "", code, message, error)
    except ComputationError as unheard:
        say(f"Error: {unheard}", err=True, lines=True)
        return FAILED
    return code


def _outcome(error: Exception) -> tuple[str, int]:
    """Message and exit code of an error."""
    if isinstance(error, AsperityError):
        return str(error), error.exit_code
    if isinstance(error, MemoryError):
        return TOO_MUCH_MEMORY, FAILED
    what = printable(f"the program failed with {type(error).__name__}: {error}")
    return f"{what}. Try: asperity --debug …, which shows where.", FAILED


class _WarningLines:
    """Print each warning once, on one line."""

    def __init__(self) -> None:
        self.shown: dict[str, None] = {}

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
            self.shown[str(message)] = None
            say(f"Warning: {message}", err=True)
