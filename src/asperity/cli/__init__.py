"""The command line. Its help imports nothing heavy: every command imports what it needs when it runs."""

from __future__ import annotations

import os
from collections.abc import Callable
from pathlib import Path
from typing import Any

import click

from asperity import __version__
from asperity.cli.door import Door
from asperity.cli.options import (
    PATH,
    again,
    complete_laws,
    complete_sweep,
    complete_templates,
    converge,
    device,
    overwrite,
    report,
    run_folder,
    templates,
)
from asperity.kinds import KINDS
from asperity.terminal import say

_HELP = f"""Roll a body over a rough surface: 3-D contact, reduced to a point force, and its vibration.

Kinds of case: {", ".join(KINDS)}.

Exit codes: 0 done, 2 the input is wrong, 3 the computation failed, 130 interrupted.
'asperity COMMAND --help' shows examples of each command.
"""
_EXAMPLES = (
    ("asperity demo", "see what comes out: a page to open in a browser"),
    (f"asperity new {next(iter(KINDS))} > case.toml", "a commented case; change what you know"),
    ("asperity check case.toml", "valid? how long will it take? which law?"),
    ("asperity run case.toml", "results, report and CSVs in runs/case"),
)
_SECTIONS = {
    "Begin": ("demo", "new", "surface"),
    "Compute": ("check", "run", "study", "optimise"),
    "Look, listen and compare": ("serve", "report", "figures", "compare", "listen", "cite"),
    "Around it": ("cache", "completion"),
}


@click.group(
    cls=Door,
    help=_HELP,
    sections=_SECTIONS,
    examples=_EXAMPLES,
    context_settings={"help_option_names": ["-h", "--help"]},
)
@click.version_option(__version__, prog_name="asperity")
@click.option("--debug", is_flag=True, help="Show where in the program an error arose.")
def main(debug: bool) -> None:
    """Take the options that stand before a command."""


@main.command(
    long_work=True,
    short_help="Run a small example that needs no input.",
    examples=[("asperity demo", "some seconds; open asperity-demo/report.html afterwards")],
)
@click.option(
    "-o",
    "--output",
    "directory",
    default=Path("asperity-demo"),
    show_default=True,
    type=PATH,
    metavar="FOLDER",
    help="Folder of the results.",
)
@again
@overwrite
def demo(directory: Path, again: bool, overwrite: bool) -> None:
    """Run a small example that needs no input, and say where its report lies.

    A steel ball rolls over a rough steel beam: texture, contact, force, vibration and six contact laws.
    """
    from asperity.cli.running import run_into, told_of_earlier
    from asperity.kinds.cases import demo_case

    there = not again and os.path.lexists(directory / "run.nc")
    if there and told_of_earlier(demo_case(), directory, report=True):
        return
    run_into(demo_case(), directory, overwrite=overwrite)


@main.command(
    short_help="Write a commented case, or a study, to begin with.",
    examples=[
        (f"asperity new {next(iter(KINDS))} > case.toml", "every key, with meaning, limits and default"),
        (f"asperity new {list(KINDS)[-1]} --law areal --law linear > case.toml", "with laws of your choice"),
        ("asperity new study > study.toml", "many cases: lists of values for some keys"),
        ("asperity new optimisation > aim.toml", "the quietest texture of a case, within bounds"),
    ],
)
@click.argument("kind", metavar="|".join(templates()), shell_complete=complete_templates)
@click.option(
    "--law",
    "laws",
    multiple=True,
    metavar="LAW",
    shell_complete=complete_laws,
    help="A law of the contact force, the first the main one. May be repeated.",
)
def new(kind: str, laws: tuple[str, ...]) -> None:
    """Write a commented case, a study of one or its optimisation, to standard output.

    Every key stands in it with its meaning, what is allowed and its default; keys that need not be given
    stand behind a '#'.
    """
    from asperity.kinds.cases import not_a_kind, template

    if kind not in templates():
        raise not_a_kind(kind, templates())
    if kind == "optimisation":
        from asperity.optimising.definition import assignment_template

        say(assignment_template(), lines=True)
    elif kind == "study":
        from asperity.studies.definition import TEMPLATE

        say(TEMPLATE, lines=True)
    else:
        say(template(kind, laws), lines=True)


@main.command(
    document=True,
    long_work=True,
    short_help="Is a case valid, what will it compute, and how long?",
    examples=[
        ("asperity check case.toml", "values (those that differ from the default in bold), work, time"),
        ("asperity check case.toml --converge", "and the time of computing it with finer settings"),
        ("asperity check case.toml --json | jq .work.seconds", "the expected seconds, for a script"),
    ],
)
@click.argument("case", type=PATH)
@run_folder()
@converge
@device
@overwrite
def check(case: Path, directory: Path | None, converge: bool, overwrite: bool) -> dict[str, Any]:
    """Check a CASE: show its values, what will be computed, and how long that takes.

    Refuses whatever 'asperity run' would refuse, tries small pieces of the work to expect its time, and says
    which law to take and how far the others are off.
    """
    from asperity.cli.planning import show_plan
    from asperity.cli.running import refuse_folder
    from asperity.kinds.cases import load_case

    loaded = load_case(case)
    refuse_folder(loaded, directory or Path("runs") / case.stem, overwrite=overwrite)
    return show_plan(loaded, str(case), converge=converge)


@main.command(
    document=True,
    long_work=True,
    short_help="Compute a case: results, report and CSVs.",
    examples=[
        ("asperity run case.toml", "into runs/case; the same command again goes on after an interruption"),
        ("asperity run case.toml -o runs/stiff --converge", "and how far grid, window, time step … matter"),
        ("asperity run case.toml --json | jq .verdict", "what it found, for a script"),
    ],
)
@click.argument("case", type=PATH)
@run_folder()
@report
@converge
@device
@again
@overwrite
def run(
    case: Path, directory: Path | None, report: bool, converge: bool, again: bool, overwrite: bool
) -> dict[str, Any]:
    """Compute a CASE: writes run.nc, report.html and the CSV of every figure.

    Finished pieces of work are kept: a run that was interrupted goes on where it was. One that is finished
    says so, as long as case, files and program are the same.
    """
    from asperity.cli.running import run_into, told_of_earlier
    from asperity.kinds.cases import load_case

    target = directory or Path("runs") / case.stem
    words: dict[str, Any] = {"report": report, "source": str(case), "converge": converge}
    there = not again and os.path.lexists(target / "run.nc")
    if there and (found := told_of_earlier(load_case(case), target, **words)):
        return found
    return run_into(load_case(case), target, overwrite=overwrite, **words)


@main.command(
    document=True,
    long_work=True,
    short_help="Compute a case for every combination of values of some keys.",
    examples=[
        ('asperity study case.toml --vary "speed = 20 m/s, 200 km/h"', "two speeds, one table"),
        (
            'asperity study case.toml --vary "seed = 1, 2, 3, 4" --vary "speed = 20 m/s, 56 m/s"',
            "mean and scatter over four textures, at two speeds",
        ),
        (
            'asperity study case.toml --vary "speed = 80..300 km/h, 6 steps"',
            "six speeds, both ends among them",
        ),
        (
            'asperity study case.toml --vary "contact.spacing = 5..20 um, 3 ratios" --show working_stiffness',
            "equal ratios; one quantity as a column and a figure",
        ),
        ("asperity study study.toml -o runs/grid --workers 4", "a study file, on four processes"),
    ],
)
@click.argument("study", type=PATH)
@click.option(
    "--vary",
    multiple=True,
    metavar="KEY=VALUES",
    shell_complete=complete_sweep,
    help="STUDY is a case: a key and its values, as 'speed = 20 m/s, 200 km/h', or a range, as "
    "'80..300 km/h, 6 steps', '60..1900 MN/m, 6 ratios', '1..20'. May be repeated.",
)
@click.option(
    "--show",
    multiple=True,
    metavar="NAMES",
    help="Columns of the table and quantities of the figures, as in the headings of study.csv, with commas. "
    "May be repeated. [default: the usual ones]",
)
@run_folder()
@click.option("--workers", type=int, help="Processes of this machine. [default: one per processor]")
@click.option("--scheduler", metavar="ADDRESS", help="Compute on the Dask cluster of this scheduler.")
@click.option("--overwrite", is_flag=True, help="Replace another study in the folder.")
@device
def study(
    study: Path,
    vary: tuple[str, ...],
    show: tuple[str, ...],
    directory: Path | None,
    workers: int | None,
    scheduler: str | None,
    overwrite: bool,
) -> dict[str, Any]:
    """Compute a case for every combination of the values of some keys, into one table.

    Writes study.csv and study.nc: band levels, dB(A), peak force and lost contact of every law, the sound of
    a wheel, what running-in changed, swept keys in the units you typed; study.html with a figure for each
    swept key; and with several seeds their mean and scatter.

    'asperity new study' writes a commented study; with --vary, a case needs none. Members that are finished
    are kept: the same command goes on where it was, and tries members again that failed.
    """
    from asperity.cli.studying import study_into, varied
    from asperity.studies.definition import load_study

    return study_into(
        varied(study, vary) if vary else load_study(study),
        directory or Path("runs") / study.stem,
        workers=workers,
        scheduler=scheduler,
        overwrite=overwrite,
        show=show,
    )


_surface_options: tuple[Callable[..., Any], ...] = (
    click.option("--array", help="Name of the array, where the file holds several."),
    click.option(
        "--index", type=int, help="Which map of an ensemble, from 0. [default: all, the first one pictured]"
    ),
    click.option("--height-unit", metavar="UNIT", help="Unit of heights that carry none, as 'um'."),
    click.option("--pixel", metavar="LENGTH", help="Distance of points that carry none, as '1.5625 um'."),
    click.option("--pixel-unit", metavar="UNIT", help="Unit of coordinates that carry none, as 'mm'."),
    click.option("--decimal", metavar="MARK", help="Decimal mark of a text, '.' or ',', where in doubt."),
    click.option("--transpose", is_flag=True, help="Exchange x and y: roll along the other direction."),
    click.option(
        "--direction",
        "--rotate",
        "direction",
        metavar="ANGLE",
        help="Roll in this direction, from x towards y, as '30 deg'; a bare number is in degrees.",
    ),
    click.option("--fill", is_flag=True, help="Fill points without a height."),
    click.option("--crop", metavar="LENGTHS", help="Keep a piece: '0 mm, 0 mm, 1 mm, 0.5 mm' (x, y, sides)."),
    click.option("--form", metavar="FORM", help="Remove plane, quadratic, sphere or cylinder."),
    click.option("--longest", metavar="LENGTH", help="Nesting index of the L-filter (ISO 16610-21, -61)."),
    click.option("--shortest", metavar="LENGTH", help="Nesting index of the S-filter, likewise Gaussian."),
    click.option("--recipe", type=PATH, help="Do what a stored recipe says; options are stronger."),
    click.option("--store", type=PATH, help="Store all that was done as a recipe that a case can name."),
    click.option("--spikes", is_flag=True, help="Take spikes for points without a height."),
    click.option(
        "--lines/--map",
        default=None,
        help="Take an array for lines measured side by side, or for a map. [default: by its shape]",
    ),
    click.option("--psd", is_flag=True, help="Write the spectra of the picture as CSV beside it."),
    click.option(
        "-o",
        "--output",
        "picture",
        type=PATH,
        help="The picture. [default: NAME-surface.png here, with array and index in its name]",
    ),
)


def _with_surface_options(command: Callable[..., Any]) -> Callable[..., Any]:
    for option in reversed(_surface_options):
        command = option(command)
    return command


@main.command(
    document=True,
    long_work=True,
    short_help="Find the texture that rolls quietest within bounds.",
    examples=[
        ("asperity optimise aim.toml -o quiet", "of a file that 'asperity new optimisation' began"),
    ],
)
@click.argument("optimisation", type=PATH)
@run_folder()
@report
@click.option("--overwrite", is_flag=True, help="Replace another texture in the folder.")
@device
def optimise(optimisation: Path, directory: Path | None, report: bool, overwrite: bool) -> dict[str, Any]:
    """Find the texture that rolls quietest within bounds, or the roughest that keeps a level.

    Searches with a cheap law and verifies with another, before and after. Textures that were rolled over are
    kept: interrupted, the same command goes on where it was.
    """
    from asperity.cli.optimising import optimise_into

    return optimise_into(
        optimisation, directory or Path("runs") / optimisation.stem, report=report, overwrite=overwrite
    )


@main.command(
    document=True,
    short_help="What is in a measured file: size, statistics, spectrum, picture.",
    examples=[
        ("asperity surface beam.x3p", "size, missing points, statistics, direction; a picture with spectrum"),
        ("asperity surface maps.npz --array polished --index 2 --height-unit um --pixel '1.5 um'", "one map"),
        ("asperity surface beam.x3p --direction '30 deg' --psd", "turned to the lay; the spectra as CSV"),
        ("asperity surface track.csv --decimal , --height-unit um --pixel '1 mm'", "decimal commas"),
        ("asperity surface beam.x3p --form sphere --shortest '8 um' --store recipe.toml", "filtered, kept"),
    ],
)
@click.argument("file", type=PATH)
@_with_surface_options
def surface(file: Path, picture: Path | None, **choices: Any) -> dict[str, Any]:
    """Say what is in a measured FILE: size, spacing, missing points, statistics, and a picture.

    The picture shows heights, their distribution and their power spectral density along x and along y. Std is
    the direction in which the texture varies most (ISO 25178-2); the lay is at right angles to it.
    """
    from asperity.cli.inspecting import inspect

    return inspect(file, picture, **choices)


@main.command(
    document=True,
    short_help="What differs between runs: cases, levels, force, stiffness.",
    examples=[
        ("asperity compare runs/smooth runs/rough", "page and table in 'comparison'"),
        ("asperity compare runs/a runs/b runs/c --law table -o what-if", "three runs, by one law"),
    ],
)
@click.argument("runs", nargs=-1, type=PATH, required=True)
@click.option(
    "--law",
    "laws",
    multiple=True,
    metavar="LAW",
    shell_complete=complete_laws,
    help="Compare this law alone, the first as the main one. May be repeated. [default: all that runs have]",
)
@click.option(
    "-o",
    "--output",
    "directory",
    type=PATH,
    default=Path("comparison"),
    show_default=True,
    metavar="FOLDER",
    help="Folder of comparison.html and comparison.csv, or the page itself, ….html.",
)
def compare(runs: tuple[Path, ...], laws: tuple[str, ...], directory: Path) -> dict[str, Any]:
    """Compare RUNS (run.nc, or their folders) with the first of them: one page and one table.

    What differs in the cases; levels and their differences in each one-third octave and in dB(A); force, loss
    of contact, stiffness, filters and verdicts.
    """
    from asperity.cli.comparing import compare_into

    return compare_into(runs, directory, laws)


@main.command(
    "report",
    document=True,
    short_help="Write the report of a run again, or a summary of one page.",
    examples=[
        ("asperity report runs/case --summary", "one sheet of A4 for a client: runs/case/summary.html"),
        ("asperity report runs/case -o page", "the page and its CSVs, from what run.nc holds"),
    ],
)
@click.argument("run", type=PATH)
@click.option(
    "--summary", is_flag=True, help="Result, three figures, validity and origin on one sheet of A4."
)
@click.option(
    "-o",
    "--output",
    "directory",
    type=PATH,
    metavar="FOLDER",
    help="Folder of the report. [default: that of the run]",
)
def report_again(run: Path, summary: bool, directory: Path | None) -> dict[str, Any]:
    """Write the report of a RUN (run.nc, or its folder) again, or a summary of it on one sheet of paper."""
    from asperity.cli.reporting import report_into

    return report_into(run, directory, summary=summary)


@main.command(
    document=True,
    short_help="Draw the figures of a run to files, for a paper.",
    examples=[
        ("asperity figures runs/case", "all of them, as SVG, into runs/case/figures"),
        ("asperity figures runs/case --format pdf force_bands scene", "two, by the names of their CSV files"),
        (
            "asperity figures runs/case 'contact force levels' -o paper",
            "by its title, or the beginning of it",
        ),
    ],
)
@click.argument("run", type=PATH)
@click.argument("names", nargs=-1, metavar="[NAME]...")
@click.option(
    "--format",
    type=click.Choice(["svg", "pdf", "png"]),
    default="svg",
    show_default=True,
    help="Of the files; words stay words in SVG and PDF.",
)
@click.option(
    "-o",
    "--output",
    "directory",
    type=PATH,
    metavar="FOLDER",
    help="Folder of the figures. [default: figures, beside the run]",
)
def figures(run: Path, names: tuple[str, ...], format: str, directory: Path | None) -> dict[str, Any]:
    """Draw the figures of a RUN (run.nc, or its folder) to files: all of them, or those with a NAME.

    A name is that of a CSV file, which holds the numbers of the figure, or its title in the report.
    """
    from asperity.cli.reporting import figures_into

    return figures_into(run, directory, format, names)


@main.command(
    document=True,
    short_help="Write what a run sounds like, as WAV files.",
    examples=[
        ("asperity listen runs/case", "into runs/case/sounds, all on one scale"),
        ("asperity listen runs/case --matched", "equally loud, so that only the sound differs"),
    ],
)
@click.argument("run", type=PATH)
@click.option(
    "--what",
    metavar="NAME",
    help="Variable of 'rolling' in the run, or pass_by_pressure, 7.5 m from a track. "
    "[default: acceleration, else velocity]",
)
@click.option(
    "--matched", is_flag=True, help="Make all as loud as each other. [default: louder laws are louder]"
)
@click.option(
    "-o",
    "--output",
    "directory",
    type=PATH,
    metavar="FOLDER",
    help="Folder of the sounds. [default: sounds, beside the run]",
)
def listen(run: Path, what: str | None, matched: bool, directory: Path | None) -> dict[str, Any]:
    """Write what a RUN sounds like (run.nc, or its folder): a WAV file for each law and place, 48 kHz."""
    from asperity.cli.reporting import listen_into

    return listen_into(run, directory, what, matched=matched)


@main.command(
    document=True,
    short_help="Say what to cite for a run.",
    examples=[("asperity cite runs/case", "the program in its version, and the sources of the run")],
)
@click.argument("run", type=PATH)
def cite(run: Path) -> dict[str, Any]:
    """Say what to cite for a RUN (run.nc, or its folder): the program and its sources."""
    from asperity.cli.citing import show_citations

    return show_citations(run)


@main.command(
    short_help="A page in the browser: set cases, press, roll, watch, listen.",
    examples=[
        ("asperity serve", "open the address that it prints; Ctrl-C ends it"),
        (
            "asperity serve -o shared/bearing --port 8080",
            "a folder and a port of your choice",
        ),
    ],
)
@click.option("--port", type=int, default=0, help="Port of this machine. [default: one that is free]")
@click.option(
    "-o",
    "--output",
    "directory",
    default=Path("asperity-page"),
    show_default=True,
    type=PATH,
    metavar="FOLDER",
    help="Folder of surfaces and runs; those of an earlier time are found again.",
)
def serve(port: int, directory: Path) -> None:
    """Serve a page on this machine: set cases, press the contact, roll, watch, compare and listen.

    Prints the address, which holds a token: whoever has it may use the page. Needs the extra app.
    """
    from asperity.cli.serving import serve_page

    serve_page(directory, port)


@main.command(
    document=True,
    short_help="Show or delete what is kept between runs.",
    examples=[
        ("asperity cache", "what is kept, where, and how much it is"),
        ("asperity cache --clear", "delete it; it is computed again when it is needed"),
    ],
)
@click.option("--clear", is_flag=True, help="Delete what is kept; it is computed again when it is needed.")
def cache(clear: bool) -> dict[str, Any]:
    """Show what is kept: finished pieces of work, compiled functions, and what interrupted runs left.

    Work is kept in $ASPERITY_CACHE, by default in the cache folder of the system.
    """
    from asperity.cli.keeping import show_kept

    return show_kept(clear=clear)


@main.command(
    short_help="Let the shell complete commands, files, kinds and laws.",
    examples=[
        ("""echo 'eval "$(asperity completion bash)"' >> ~/.bashrc""", "bash 4.4 or later"),
        ("""echo 'eval "$(asperity completion zsh)"' >> ~/.zshrc""", "zsh, below the line with compinit"),
        ("asperity completion fish > ~/.config/fish/completions/asperity.fish", "fish"),
    ],
)
@click.argument("shell", type=click.Choice(["bash", "zsh", "fish"]))
def completion(shell: str) -> None:
    """Print what makes a SHELL complete commands, options, files, kinds of case, keys and laws.

    It works in shells that are opened after one of the lines below.
    """
    from click.shell_completion import get_completion_class

    kind = get_completion_class(shell)
    assert kind is not None
    say(kind(main, {}, "asperity", "_ASPERITY_COMPLETE").source(), lines=True)
