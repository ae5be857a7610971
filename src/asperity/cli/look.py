"""Commands that show what was computed, and what is around it: the page, pictures, sounds, what is kept."""

import importlib.util
from pathlib import Path

import click

from asperity.cli import commands
from asperity.cli.commands import PATH, WholeNumber, output
from asperity.cli.program import Document, commands_of, main
from asperity.errors import InputError
from asperity.terminal import say

_look = commands_of("Look, listen and compare")
_around = commands_of("Around it")


@_look("A page in the browser: set cases, press, roll, watch, listen.", document=False)
@click.option(
    "--port",
    type=WholeNumber(0, 65535),
    default=0,
    help="Port of this machine. [default: one that is free]",
)
@output(
    "Folder of surfaces and runs; those of an earlier time are found again.",
    default=Path("asperity-page"),
    show_default=True,
)
def serve(port: int, directory: Path) -> None:
    """Serve a page on this machine: set cases, press the contact, roll, watch, compare and listen.

    Prints the address, which holds a token: whoever has it may use the page. Needs the extra app.

    Examples
    --------
    # open the address that it prints; Ctrl-C ends it
    asperity serve
    # a folder and a port of your choice
    asperity serve -o shared/bearing --port 8080
    """
    missing = [name for name in ("starlette", "uvicorn") if importlib.util.find_spec(name) is None]
    if missing:
        remedy = 'Install them: python -m pip install "asperity[app]".'
        raise InputError("asperity serve", f"no {' and no '.join(missing)}", "the extra app", remedy)
    from asperity.serving.server import serve_folder

    serve_folder(directory, port)
    say("Ended; runs and surfaces are kept.", err=True)


@_look(
    "Write the report of a run again, or a summary of one page.",
    name="report",
    document=False,
    does="asperity.cli.results.report_again",
)
@commands.run_argument
@click.option(
    "--summary", is_flag=True, help="Result, three figures, validity and origin on one sheet of A4."
)
@output("Folder of the report. [default: that of the run]")
def report_again() -> None:
    """Write the report of a RUN (run.nc, or its folder) again, or a summary of it on one sheet of paper.

    Examples
    --------
    # one sheet of A4 for a client: runs/case/summary.html
    asperity report runs/case --summary
    # the page and its CSVs, from what run.nc holds
    asperity report runs/case -o page
    """


@_look(
    "Draw the figures of a run to files, for a paper.",
    document=False,
    does="asperity.cli.results.draw_figures",
)
@commands.run_argument
@click.argument("names", nargs=-1, metavar="[NAME]...")
@click.option(
    "--format",
    type=click.Choice(["svg", "pdf", "png"]),
    default="svg",
    show_default=True,
    help="Of the files; words stay words in SVG and PDF.",
)
@output("Folder of the figures. [default: figures, beside the run]")
def figures() -> None:
    """Draw the figures of a RUN (run.nc, or its folder) to files: all of them, or those with a NAME.

    A name is that of a CSV file, which holds the numbers of the figure, or its title in the report.

    Examples
    --------
    # all of them, as SVG, into runs/case/figures
    asperity figures runs/case
    # two, by the names of their CSV files
    asperity figures runs/case --format pdf force_bands scene
    # by its title, or the beginning of it
    asperity figures runs/case 'contact force levels' -o paper
    """


@_look(
    "What differs between runs: cases, levels, force, stiffness.",
    document=False,
    does="asperity.cli.results.compare_runs",
)
@click.argument("runs", nargs=-1, type=PATH, required=True)
@output(
    "Folder of comparison.html and comparison.csv, or the page itself, ….html.",
    default=Path("comparison"),
    show_default=True,
)
def compare() -> None:
    """Compare RUNS (run.nc, or their folders) with the first of them: one page and one table.

    What differs in the cases; levels and their differences in each one-third octave and in dB(A); force, loss
    of contact, stiffness, filters and verdicts.

    Examples
    --------
    # page and table in 'comparison'
    asperity compare runs/smooth runs/rough
    # three runs, into a folder of your choice
    asperity compare runs/a runs/b runs/c -o what-if
    """


@_look(
    "Write what a run sounds like, as WAV files.",
    params=commands.LISTEN,
    does="asperity.cli.results.write_sounds",
)
@commands.run_argument
@output("Folder of the sounds. [default: sounds, beside the run]")
def listen() -> None:
    """Write what a RUN sounds like (run.nc, or its folder): a WAV file for each law and place, 48 kHz.

    Examples
    --------
    # into runs/case/sounds, all on one scale
    asperity listen runs/case
    # equally loud, so that only the sound differs
    asperity listen runs/case --matched
    """


@_look(
    "Write signals of a run as programs of measurement read them.",
    params=commands.WRITTEN,
    does="asperity.cli.results.write_measured",
)
@commands.run_argument
@output("Folder of the signals. [default: signals, beside the run]")
def signals() -> None:
    """Write force, acceleration, pressure, speed and spectra of a RUN (run.nc, or its folder) to files.

    Examples
    --------
    # all of them in one universal file (UFF 58), in SI: runs/case/signals/signals.uff
    asperity signals runs/case
    # the accelerometer as WAV of 24 bits; the value of full scale stands in the file and in signals.csv
    asperity signals runs/case --format wav --what ring_acceleration
    """


@_look("Say what to cite for a run.")
@commands.run_argument
def cite(run: Path) -> Document:
    """Say what to cite for a RUN (run.nc, or its folder): the program and its sources.

    Examples
    --------
    # the program in its version, and the sources of the run
    asperity cite runs/case
    """
    from asperity.reporting.page import literature
    from asperity.results import read_result

    sources = literature(read_result(run))
    for source in sources:
        say(source)
    return {"run": run.resolve(), "sources": sources}


# --- around it


@_around("Show or delete what is kept between runs.", does="asperity.cli.results.show_cache")
@click.option("--clear", is_flag=True, help="Delete what is kept; it is computed again when it is needed.")
def cache() -> None:
    """Show what is kept: finished pieces of work, compiled functions, and what interrupted runs left.

    Work is kept in $ASPERITY_CACHE, by default in the cache folder of the system.

    Examples
    --------
    # what is kept, where, and how much it is
    asperity cache
    # delete it; it is computed again when it is needed
    asperity cache --clear
    """


@_around("Let the shell complete commands, files, kinds and laws.", document=False)
@click.argument("shell", type=click.Choice(["bash", "zsh", "fish"]))
def completion(shell: str) -> None:
    """Print what makes a SHELL complete commands, options, files, kinds of case and laws.

    It works in shells that are opened after one of the lines below.

    Examples
    --------
    # bash 4.4 or later
    echo 'eval "$(asperity completion bash)"' >> ~/.bashrc
    # zsh, below the line with compinit
    echo 'eval "$(asperity completion zsh)"' >> ~/.zshrc
    # fish
    asperity completion fish > ~/.config/fish/completions/asperity.fish
    """
    from click.shell_completion import get_completion_class

    kind = get_completion_class(shell)
    assert kind is not None
    say(kind(main, {}, "asperity", "_ASPERITY_COMPLETE").source(), lines=True)
