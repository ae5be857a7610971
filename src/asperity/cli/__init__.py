"""The command line. Its help imports nothing heavy: every command imports what it needs when it runs."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import click

from asperity import __version__
from asperity.cli.door import Door
from asperity.kinds import KINDS
from asperity.terminal import say

_case = click.argument("case", type=click.Path(path_type=Path))
_output = click.option(
    "-o",
    "--output",
    "directory",
    type=click.Path(path_type=Path),
    help="Folder of the results. [default: runs/NAME]",
)
_overwrite = click.option("--overwrite", is_flag=True, help="Replace the run of another case in the folder.")
_report = click.option(
    "--report/--no-report", default=True, show_default=True, help="Write the HTML page and CSVs."
)
_converge = click.option(
    "--converge",
    is_flag=True,
    help="Compute again with each setting made finer: grid, window, samples, …, and say what that changes.",
)
_device = click.option(
    "--device",
    type=click.Choice(["cpu", "gpu"]),
    help="Where contacts are solved; gpu needs CuPy. [default: $ASPERITY_DEVICE, else cpu]",
    callback=lambda context, option, name: _choose(name),
    expose_value=False,
)


def _choose(device: str | None) -> None:
    if device is not None:
        from asperity.contact.device import choose_device

        choose_device(device)


def _study_options(command: Callable[..., None]) -> Callable[..., None]:
    """Options of the commands that compute a study."""
    for option in (
        _device,
        click.option("--overwrite", is_flag=True, help="Replace another study in the folder."),
        click.option("--scheduler", metavar="ADDRESS", help="Compute on the Dask cluster of this scheduler."),
        click.option("--workers", type=int, help="Processes of this machine. [default: one per processor]"),
        _output,
    ):
        command = option(command)
    return command


_HELP = f"""Roll a body over a rough surface: 3-D contact, reduced to a point force, and its vibration.

Start with 'asperity demo', then 'asperity new {next(iter(KINDS))} > case.toml' and 'asperity run case.toml'.

Kinds of case: {", ".join(KINDS)}.

Exit codes: 0 done, 2 the input is wrong, 3 the computation failed, 130 interrupted.
"""


@click.group(cls=Door, help=_HELP, context_settings={"help_option_names": ["-h", "--help"]})
@click.version_option(__version__, prog_name="asperity")
@click.option("--debug", is_flag=True, help="Show where in the program an error arose.")
def main(debug: bool) -> None:
    """Take the options that stand before a command."""


@main.command()
@click.option(
    "-o",
    "--output",
    "directory",
    default=Path("asperity-demo"),
    show_default=True,
    type=click.Path(path_type=Path),
)
@_overwrite
def demo(directory: Path, overwrite: bool) -> None:
    """Run a small example that needs no input, and say where its report lies."""
    from asperity.cli.running import run_into
    from asperity.kinds.cases import demo_case

    run_into(demo_case(), directory, overwrite=overwrite)


def _templates(context: click.Context, argument: click.Parameter, incomplete: str) -> list[str]:
    """Complete what 'asperity new' can write."""
    return [name for name in (*KINDS, "study") if name.startswith(incomplete)]


@main.command()
@click.argument("kind", metavar="|".join((*KINDS, "study")), shell_complete=_templates)
def new(kind: str) -> None:
    """Write a commented case, or a study of one, to standard output."""
    from asperity.kinds.cases import not_a_kind, template

    if kind not in (names := (*KINDS, "study")):
        raise not_a_kind(kind, names)
    if kind == "study":
        from asperity.studies.definition import TEMPLATE

        say(TEMPLATE, lines=True)
    else:
        say(template(kind), lines=True)


@main.command()
@_case
@_output
@_converge
@_device
@_overwrite
def check(case: Path, directory: Path | None, converge: bool, overwrite: bool) -> None:
    """Check a case: show its values, what will be computed, and how long that takes.

    Refuses whatever 'asperity run' would refuse, and tries small pieces of the work to expect its time.
    """
    from asperity.cli.planning import show_plan
    from asperity.cli.running import refuse_folder
    from asperity.kinds.cases import load_case
    from asperity.running import prepare_case

    loaded = load_case(case)
    refuse_folder(loaded, directory or Path("runs") / case.stem, overwrite=overwrite)
    show_plan(prepare_case(loaded, str(case)), str(case), converge=converge)


@main.command()
@_case
@_output
@_report
@_converge
@_device
@_overwrite
def run(case: Path, directory: Path | None, report: bool, converge: bool, overwrite: bool) -> None:
    """Compute a case: writes run.nc, report.html and the CSV of every figure."""
    from asperity.cli.running import run_into
    from asperity.kinds.cases import load_case

    target = directory or Path("runs") / case.stem
    run_into(load_case(case), target, source=str(case), report=report, overwrite=overwrite, converge=converge)


@main.command()
@click.argument("study", type=click.Path(path_type=Path))
@click.option(
    "--vary",
    multiple=True,
    metavar="KEY=VALUES",
    help="STUDY is a case: a key and its values, as 'speed = 20 m/s, 200 km/h'. May be repeated.",
)
@_study_options
def study(
    study: Path,
    vary: tuple[str, ...],
    directory: Path | None,
    workers: int | None,
    scheduler: str | None,
    overwrite: bool,
) -> None:
    """Compute a case for every combination of the values of some keys: writes study.nc and study.csv.

    'asperity new study' writes a commented study; with --vary, a case needs none. Members that are finished
    are kept: the same command goes on where it was, and tries members again that failed.
    """
    from asperity.cli.studying import study_into, varied
    from asperity.studies.definition import load_study

    study_into(
        varied(study, vary) if vary else load_study(study),
        directory or Path("runs") / study.stem,
        workers=workers,
        scheduler=scheduler,
        overwrite=overwrite,
    )


@main.command()
@click.argument("file", type=click.Path(path_type=Path))
@click.option("--array", help="Name of the array, where the file holds several.")
@click.option(
    "--index", type=int, help="Which map of an ensemble, from 0. [default: all, the first one pictured]"
)
@click.option("--height-unit", help="Unit of heights that carry none, as 'um'.")
@click.option("--pixel", help="Distance of points that carry none, as '1.5625 um'.")
@click.option("--pixel-unit", help="Unit of coordinates that carry none, as 'mm'.")
@click.option("--decimal", metavar="MARK", help="Decimal mark of a text, '.' or ',', where it is in doubt.")
@click.option("--transpose", is_flag=True, help="Exchange x and y: roll along the other direction.")
@click.option("--fill", is_flag=True, help="Fill points without a height.")
@click.option("--spikes", is_flag=True, help="Take spikes for points without a height.")
@click.option(
    "--lines/--map",
    default=None,
    help="Take an array for lines measured side by side, or for a map. [default: by its shape]",
)
@click.option(
    "-o",
    "--output",
    "picture",
    type=click.Path(path_type=Path),
    help="The picture. [default: NAME-surface.png here, with array and index in its name]",
)
def surface(
    file: Path,
    array: str | None,
    index: int | None,
    height_unit: str | None,
    pixel: str | None,
    pixel_unit: str | None,
    decimal: str | None,
    transpose: bool,
    fill: bool,
    spikes: bool,
    lines: bool | None,
    picture: Path | None,
) -> None:
    """Say what is in a measured FILE: size, spacing, missing points, statistics, and a picture."""
    from asperity.cli.inspecting import inspect

    inspect(
        file,
        picture,
        array=array,
        index=index,
        lines=lines,
        height_unit=height_unit,
        pixel=pixel,
        pixel_unit=pixel_unit,
        decimal=decimal,
        transpose=transpose,
        fill=fill,
        spikes=spikes,
    )


@main.command()
@click.argument("run", type=click.Path(path_type=Path))
@click.option(
    "--what", metavar="NAME", help="Variable of 'rolling' in the run. [default: acceleration, else velocity]"
)
@click.option(
    "--matched", is_flag=True, help="Make all as loud as each other. [default: louder laws are louder]"
)
@click.option(
    "-o",
    "--output",
    "directory",
    type=click.Path(path_type=Path),
    help="Folder of the sounds. [default: sounds, beside the run]",
)
def listen(run: Path, what: str | None, matched: bool, directory: Path | None) -> None:
    """Write what a RUN sounds like (run.nc, or its folder): a WAV file for each law and place, 48 kHz."""
    from asperity.cli.listening import listen_into

    listen_into(run, directory, what, matched=matched)


@main.command()
@click.argument("run", type=click.Path(path_type=Path))
def cite(run: Path) -> None:
    """Say what to cite for a RUN (run.nc, or its folder): the program and its sources."""
    from asperity.cli.citing import show_citations

    show_citations(run)


@main.command()
@click.option("--port", type=int, default=0, help="Port of this machine. [default: one that is free]")
@click.option(
    "-o",
    "--output",
    "directory",
    default=Path("asperity-page"),
    show_default=True,
    type=click.Path(path_type=Path),
    help="Folder of surfaces and runs; those of an earlier time are found again.",
)
def serve(port: int, directory: Path) -> None:
    """Serve a page on this machine: set cases, press the contact, roll, watch, compare and listen.

    Prints the address, which holds a token: whoever has it may use the page. Needs the extra app.
    """
    from asperity.cli.serving import serve_page

    serve_page(directory, port)


@main.command()
@click.option("--clear", is_flag=True, help="Delete what is kept; it is computed again when it is needed.")
def cache(clear: bool) -> None:
    """Show what is kept: finished pieces of work, compiled functions, and what interrupted runs left."""
    from asperity.cli.keeping import clear_kept, show_kept

    clear_kept() if clear else show_kept()


@main.command()
@click.argument("shell", type=click.Choice(["bash", "zsh", "fish"]))
def completion(shell: str) -> None:
    """Print what makes a shell complete commands: put 'eval "$(asperity completion bash)"' into ~/.bashrc.

    For fish: asperity completion fish > ~/.config/fish/completions/asperity.fish
    """
    from click.shell_completion import get_completion_class

    kind = get_completion_class(shell)
    assert kind is not None
    say(kind(main, {}, "asperity", "_ASPERITY_COMPLETE").source(), lines=True)
