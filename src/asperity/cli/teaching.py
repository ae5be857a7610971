"""Help that teaches: examples at the end of each command's help, and commands in the order of the work."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import click

from asperity.terminal import change_manner

Examples = Sequence[tuple[str, str]]
"""Command lines, each with what it does."""


class Taught(click.Command):
    """A command whose help ends with examples.

    `document` says that it has a form for programs, with ``--json``; `long_work` that it can be told to say
    less or more of what it does.
    """

    def __init__(
        self,
        *arguments: Any,
        examples: Examples = (),
        document: bool = False,
        long_work: bool = False,
        **settings: Any,
    ) -> None:
        super().__init__(*arguments, **settings)
        self.examples = examples
        self.params += _document_option() if document else []
        self.params += _loudness_options() if long_work else []

    def format_epilog(self, ctx: click.Context, formatter: click.HelpFormatter) -> None:
        """Write the examples."""
        write_examples(formatter, self.examples)


def write_examples(formatter: click.HelpFormatter, examples: Examples) -> None:
    """Write command lines that can be copied, each under what it does."""
    if not examples:
        return
    formatter.write("\nExamples:\n")
    for line, meaning in examples:
        formatter.write(f"  # {meaning}\n  {line}\n")


def write_sections(
    formatter: click.HelpFormatter,
    commands: Mapping[str, click.Command],
    sections: Mapping[str, Sequence[str]],
) -> None:
    """List commands under the titles of their sections; those of none come last."""
    placed = {name for names in sections.values() for name in names}
    others = {"More": [name for name in commands if name not in placed]}
    width = max(map(len, commands))
    for title, names in (*sections.items(), *others.items()):
        rows = [
            (name.ljust(width), commands[name].get_short_help_str(100)) for name in names if name in commands
        ]
        if rows:
            with formatter.section(title):
                formatter.write_dl(rows)


def _document_option() -> list[click.Parameter]:
    words = "Print one JSON document, as docs/json.md describes, for programs."
    return [_manner_flag("--json", "document", words=words)]


def _loudness_options() -> list[click.Parameter]:
    quiet = "Show no progress and no remarks; warnings and errors stay."
    verbose = "Show what each piece of the work took, and how long the compiler."
    return [
        _manner_flag("-q", "--quiet", words=quiet),
        _manner_flag("-v", "--verbose", words=verbose),
    ]


def _manner_flag(*names: str, words: str) -> click.Option:
    """An option that changes how the program speaks, and which its command need not know."""

    def change(context: click.Context, option: click.Parameter, wanted: bool) -> None:
        if wanted and option.name is not None:
            change_manner(**{option.name: True})

    return click.Option(names, is_flag=True, expose_value=False, callback=change, help=words)
