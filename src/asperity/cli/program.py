"""The program to which all commands belong, and what it says of itself."""

from collections.abc import Callable
from typing import Any

import click

from asperity import __version__
from asperity.cli.commands import Program

Document = dict[str, Any]
"""What a command says to programs."""


@click.group(cls=Program, document=False, context_settings={"help_option_names": ["-h", "--help"]})
@click.version_option(__version__, prog_name="asperity")
@click.option("--debug", is_flag=True, help="Show where in the program an error arose.")
def main(debug: bool) -> None:
    """Roll a body over a rough surface: 3-D contact, reduced to a point force, and its vibration.

    Kinds of case: KINDS.

    Exit codes: 0 done, 2 the input is wrong, 3 the computation failed, 130 interrupted.
    'asperity COMMAND --help' shows examples of each command.

    Examples
    --------
    # see what comes out: a page to open in a browser
    asperity demo
    # a commented case; change what you know
    asperity new KIND > case.toml
    # valid? how long will it take? which law?
    asperity check case.toml
    # results, report and CSVs in runs/case
    asperity run case.toml
    """


def commands_of(section: str) -> Callable[..., Any]:
    """Make commands that the program lists in a section, each under a sentence."""
    return lambda words, **settings: main.command(section=section, short_help=words, **settings)
