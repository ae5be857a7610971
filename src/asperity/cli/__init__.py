"""The command line. Its help imports nothing heavy: every command imports what it needs when it runs."""

import importlib.util
from collections.abc import Callable
from pathlib import Path
from typing import Any

import click

from asperity import __version__
from asperity.cli import commands
from asperity.cli.commands import PATH, Program, output
from asperity.errors import InputError
from asperity.terminal import say

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


def _listed(section: str) -> Callable[..., Any]:
    """Make commands that the program lists in a section, each under a sentence."""
    return lambda words, **settings: main.command(section=section, short_help=words, **settings)


_begin, _compute = _listed("Begin"), _listed("Compute")
_look, _around = _listed("Look, listen and compare"), _listed("Around it")


# --- begin


@_begin("Run a small example that needs no input.", document=False, long_work=True)
@output("Folder of the results.", default=Path("asperity-demo"), show_default=True)
@commands.again
@commands.overwrite("the run of another case")
def demo(directory: Path, again: bool, overwrite: bool) -> None:
    """Run a small example that needs no input, and say where its report lies.

    A steel ball rolls over a rough steel beam: texture, contact, force, vibration and six contact laws.

    Examples
    --------
    # some seconds; open asperity-demo/report.html afterwards
    asperity demo
    """
    from asperity.case.cases import demo_case
    from asperity.cli.running import run_case

    run_case(demo_case(), directory, again=again, overwrite=overwrite)


@_begin("Write a commented case, or a study, to begin with.", document=False)
@click.argument(
    "kind", metavar="|".join(commands.templates()), shell_complete=commands.completed(commands.templates)
)
@commands.laws
def new(kind: str, laws: tuple[str, ...]) -> None:
    """Write a commented case, a study of one or its optimisation, to standard output.

    Every key stands in it with its meaning, what is allowed and its default; keys that need not be given
    stand behind a '#'.

    Examples
    --------
    # every key, with meaning, limits and default
    asperity new KIND > case.toml
    # with laws of your choice
    asperity new bodies --law areal --law linear > case.toml
    # many cases: lists of values for some keys
    asperity new study > study.toml
    # what helps against noise, or in a bearing: a list of changes, for one's own to be added
    asperity new what-helps > helps.toml
    # the quietest texture of a case, within bounds
    asperity new optimisation > aim.toml
    """
    from asperity.case.cases import not_a_kind, template
    from asperity.case.ready_lists import READY_LISTS
    from asperity.optimising.templates import AIM_TEMPLATES
    from asperity.studies.definition import TEMPLATE

    if kind not in commands.templates():
        raise not_a_kind(kind, commands.templates())
    others = {"study": lambda: TEMPLATE, **AIM_TEMPLATES, **READY_LISTS}
    say(others[kind]() if kind in others else template(kind, laws), lines=True)


@_begin("What is in a measured file: size, statistics, spectrum, picture.", params=commands.SURFACE)
@click.argument("file", type=PATH)
@commands.picture("The picture. [default: NAME-surface.png here, with array and index in its name]")
def surface(file: Path, picture: Path | None, **choices: Any) -> Document:
    """Say what is in a measured FILE: size, spacing, missing points, statistics, and a picture.

    The picture shows heights, their distribution and their power spectral density along x and along y. Std is
    the direction in which the texture varies most (ISO 25178-2); the lay is at right angles to it.

    Examples
    --------
    # size, missing points, statistics, direction; a picture with spectrum
    asperity surface beam.x3p
    # one map
    asperity surface maps.npz --array polished --index 2 --height-unit um --pixel '1.5 um'
    # turned to the lay; the spectra as CSV
    asperity surface beam.x3p --direction '30 deg' --psd
    # decimal commas
    asperity surface track.csv --decimal , --height-unit um --pixel '1 mm'
    # filtered, kept
    asperity surface beam.x3p --form quartic --shortest '8 um' --store recipe.toml
    """
    from asperity.cli.surface import show_surface

    return show_surface(file, picture, **choices)


@_begin("Modes of a wheel by the drawing of its section.", document=False, long_work=True)
@click.argument("section")
@click.option("--highest", metavar="FREQUENCY", help="Upper end of the spectra. [default: 5 kHz]")
@commands.picture("Draw the section to a file, .svg, .pdf or .png.", "--picture")
@output("Table of the modes, which wheel.modes of a case names.", "table", "FILE")
def wheel(section: str, highest: str | None, table: Path | None, picture: Path | None) -> None:
    """Find the modes of a wheel by its SECTION: a named one, an outline (CSV), or a case with a drawn wheel.

    An outline is a closed polygon in a file with the columns 'radius (mm), axial place (mm)', the latter from
    the running circle, positive away from the flange. Modes go up to 1.25 times the upper end of the spectra.

    Examples
    --------
    # frequencies, nodal diameters, damping, modal masses
    asperity wheel straight-web
    # of an outline of your own, as a table and with a picture
    asperity wheel outline.csv -o modes.csv --picture section.svg
    # of a case, with its dimensions and its damping
    asperity wheel case.toml --highest '8 kHz'
    """
    from asperity.cli.wheel import show_wheel

    show_wheel(section, highest, table, picture)


@_begin(
    "What a ball bearing carries, its tones, and what its signal says.",
    params=commands.BEARING,
    long_work=True,
)
@click.argument("bearing", metavar="NAME|FILE", required=False)
@click.argument("more", type=PATH, nargs=-1, metavar="[SIGNAL]...")
@commands.picture("Picture of the load zone, or of the envelope spectrum.")
def bearing(
    bearing: str | None,
    more: tuple[Path, ...],
    picture: Path | None,
    signal: tuple[Path, ...],
    **choices: Any,
) -> Document:
    """Say how a ball bearing carries a load at rest, and its tones; or which of them a signal holds.

    A bearing has a NAME, or its dimensions stand in a FILE (TOML): balls, ball_diameter, pitch_diameter,
    inner_conformity, outer_conformity, clearance or contact_angle, preload, material, turning, radial, …

    Several files of one measurement, at one speed, are judged one by one and all together.

    Examples
    --------
    # which bearings have a name, and where their balls are printed
    asperity bearing --list
    # loads, contact ellipses, pressures, stiffness, tones
    asperity bearing 6205 --radial '100 N' --speed '1797 1/min'
    # films of oil, too
    asperity bearing 6205 --radial '100 N' --speed '1797 1/min' --oil 'ISO VG 68' --temperature '60 degC'
    # loads of the balls as a picture
    asperity bearing own.toml --axial '50 N' -o load.png
    # a data sheet
    asperity bearing own.toml --axial '50 N' --sheet own.html
    # is there a fault? lines of the envelope beside those expected
    asperity bearing 6205 --speed '1797 1/min' --signal run.npz --rate '12 kHz' -o envelope.png
    # stiffness over load and speed, for a program of rotors
    asperity bearing 7205C --axial '100..500 N, 5 steps' --speed '0..9000 1/min, 4 steps' --table k.csv
    # how large each wave may be alone, for a limit of each band
    asperity bearing 6205 --axial '150 N' --speed '1800 1/min' --limits '50 um/s, 30 um/s, none'
    # several files of one measurement: each one, and all together
    asperity bearing 6205 --speed '1797 1/min' --signal run-1.wav run-2.wav run-3.wav
    """
    from asperity.cli.bearing import show_bearing

    return show_bearing(bearing, signal, more, picture, **choices)


@_begin(
    "Creep force over creepage of what rolls in a case.",
    params=commands.CREEP,
    document=False,
    long_work=True,
)
@click.argument("case", type=PATH)
@commands.picture("Draw it to a file, .svg, .pdf or .png.")
def creep(case: Path, picture: Path | None, **choices: Any) -> None:
    """Find the creep force of what rolls in a CASE under its working load, in steady rolling.

    The smooth contact and the samples of the case, with Kalker's linear theory and FASTSIM beside them.

    Examples
    --------
    # a table, smooth and rough
    asperity creep case.toml
    # the lateral force of an angle of attack, drawn and as CSV
    asperity creep case.toml --direction lateral --friction 0.4 -o creep.svg --table creep.csv
    # what roughness does to tangential stiffness and creep, at which load
    asperity creep case.toml --states --points 6 -o states.svg
    """
    from asperity.cli.creep import show_creep

    show_creep(case, picture=picture, **choices)


# --- compute


@_compute("Is a case valid, what will it compute, and how long?", long_work=True)
@click.argument("case", type=PATH)
@commands.run_folder
@commands.device
@click.option("--keys", is_flag=True, help="Show every key with its value, those at their defaults too.")
@commands.overwrite("the run of another case")
def check(case: Path, directory: Path | None, keys: bool, overwrite: bool) -> Document:
    """Check a CASE: say what is doubtful, what will be computed, and how long that takes.

    Refuses whatever 'asperity run' would refuse, tries small pieces of the work to expect its time, and says
    which law to take and how far the others are off.

    Examples
    --------
    # doubts, laws, time, and the keys that are not at their defaults
    asperity check case.toml
    # every key with its value and what it is
    asperity check case.toml --keys
    # the expected seconds, for a script
    asperity check case.toml --json | jq .work.seconds
    """
    from asperity.case.cases import read_case
    from asperity.cli.running import refuse_full, refuse_other, show_plan

    loaded = read_case(case)
    target = directory or Path("runs") / case.stem
    refuse_full(loaded, target)
    if not overwrite:
        refuse_other(loaded, target)
    return show_plan(loaded, str(case), every_key=keys)


@_compute("Compute a case: results, report and CSVs.", long_work=True)
@click.argument("case", type=PATH)
@commands.run_folder
@commands.report
@commands.converge
@commands.what_helps
@commands.device
@commands.again
@commands.overwrite("the run of another case")
def run(case: Path, directory: Path | None, **choices: bool) -> Document:
    """Compute a CASE: writes run.nc, report.html and the CSV of every figure.

    Finished pieces of work are kept: a run that was interrupted goes on where it was. One that is finished
    says so, as long as case, files and program are the same.

    Examples
    --------
    # into runs/case; the same command again goes on after an interruption
    asperity run case.toml
    # and how far grid, window, time step … matter
    asperity run case.toml -o runs/stiff --converge
    # and what would make it quieter, of a track
    asperity run case.toml --what-helps
    # what it found, for a script
    asperity run case.toml --json | jq .verdict
    """
    from asperity.case.cases import read_case
    from asperity.cli.running import run_case

    return run_case(read_case(case), directory or Path("runs") / case.stem, source=str(case), **choices)


@_compute(
    "Compute a case for every combination of values of some keys.", params=commands.STUDY, long_work=True
)
@click.argument("study", type=PATH)
@commands.what_helps
@commands.run_folder
@commands.signals
@commands.overwrite("another study")
@commands.device
def study(
    study: Path, vary: tuple[str, ...], what_helps: bool, directory: Path | None, **choices: Any
) -> Document:
    """Compute a case for every combination of the values of some keys, into one table.

    Writes study.csv and study.nc: band levels, dB(A), peak force and lost contact of every law, the sound of
    a wheel, what running-in changed, swept keys in the units you typed; study.html with a figure for each
    swept key; and with several seeds their mean and scatter.

    'asperity new study' writes a commented study; with --vary, a case needs none. Members that are finished
    are kept: the same command goes on where it was, and tries members again that failed.

    Examples
    --------
    # two speeds, one table
    asperity study case.toml --vary "speed = 20 m/s, 200 km/h"
    # mean and scatter over four textures, at two speeds
    asperity study case.toml --vary "seed = 1, 2, 3, 4" --vary "speed = 20 m/s, 56 m/s"
    # six speeds, both ends among them
    asperity study case.toml --vary "speed = 80..300 km/h, 6 steps"
    # equal ratios; one quantity as a column and a figure
    asperity study case.toml --vary "contact.spacing = 5..20 um, 3 ratios" --show working_stiffness
    # what helps? One table, split by source
    asperity study case.toml --what-helps
    # a study file, on four processes
    asperity study study.toml -o runs/grid --workers 4
    # labelled signals of faulty bearings, behind a measured path
    asperity study bearing.toml --vary "fault.length = 0.1..0.5 mm, 5 steps" --signals set --path path.wav
    """
    from asperity.cli.studying import run_study, varied
    from asperity.studies.definition import load_study

    definition = varied(study, vary, helps=what_helps) if vary or what_helps else load_study(study)
    return run_study(definition, directory or Path("runs") / study.stem, **choices)


@_compute("Find the texture that rolls quietest within bounds.", long_work=True)
@click.argument("optimisation", type=PATH)
@commands.run_folder
@commands.report
@commands.overwrite("another texture")
@commands.device
def optimise(optimisation: Path, directory: Path | None, **choices: bool) -> Document:
    """Find the texture that rolls quietest within bounds, or the roughest that keeps a level.

    Of a ball bearing, the roughest waves that keep velocities under limits. Searches with a cheap law and
    verifies with another. What was rolled is kept: interrupted, the same command goes on where it was.

    Examples
    --------
    # of a file that 'asperity new optimisation' began
    asperity optimise aim.toml -o quiet
    """
    from asperity.cli.optimising import run_optimisation

    return run_optimisation(optimisation, directory or Path("runs") / optimisation.stem, **choices)


@_compute("Fit keys of a case to what was measured.", params=commands.FIT, long_work=True)
@click.argument("case", type=PATH)
@click.argument("more", type=PATH, nargs=-1, metavar="[FILE]...")
@output("Folder of fitted.toml, its page and its table. [default: that of the case]")
@commands.overwrite("another fit")
@commands.device
def fit(
    case: Path, more: tuple[Path, ...], measured: tuple[Path, ...], directory: Path | None, **choices: Any
) -> Document:
    """Fit keys of a CASE to what was measured: decay rates, mobility, levels in bands, spectra, stiffness.

    Says first which keys the data do not determine, then values with 95 % intervals; writes the case with
    them, fitted.toml, and measured against fitted on a page. Finished searches are kept: interrupted, the
    same command goes on where it was.

    Examples
    --------
    # pads, ballast and rail from decay rates (EN 15461)
    asperity fit track.toml --to decay_rates.csv
    # of one section of a table with a measurement in each line; one key alone
    asperity fit track.toml --to all.csv --where section=B5 --free track.pad_stiffness
    # with a range of one's own
    asperity fit track.toml --to decay_rates.csv --free 'track.pad_loss_factor = 0.05..0.35' -o fits
    # to what the case itself names
    asperity fit case.toml --json | jq .fitted
    """
    from asperity.cli.fitting import fit_case

    if more and not measured:
        received = " and ".join([str(case), *map(str, more)])
        raise InputError("case", received, "one", "Files of what was measured follow --to.")
    return fit_case(case, (*measured, *more), directory, **choices)


# --- look, listen and compare


@_look("A page in the browser: set cases, press, roll, watch, listen.", document=False)
@click.option(
    "--port",
    type=click.IntRange(0, 65535),
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


@_look("Write the report of a run again, or a summary of one page.", name="report", document=False)
@commands.run_argument
@click.option(
    "--summary", is_flag=True, help="Result, three figures, validity and origin on one sheet of A4."
)
@output("Folder of the report. [default: that of the run]")
def report_again(run: Path, summary: bool, directory: Path | None) -> None:
    """Write the report of a RUN (run.nc, or its folder) again, or a summary of it on one sheet of paper.

    Examples
    --------
    # one sheet of A4 for a client: runs/case/summary.html
    asperity report runs/case --summary
    # the page and its CSVs, from what run.nc holds
    asperity report runs/case -o page
    """
    from asperity.cli.results import report_again as write_report

    write_report(run, directory, summary=summary)


@_look("Draw the figures of a run to files, for a paper.", document=False)
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
def figures(run: Path, names: tuple[str, ...], format: str, directory: Path | None) -> None:
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
    from asperity.cli.results import draw_figures

    draw_figures(run, directory, format, names)


@_look("What differs between runs: cases, levels, force, stiffness.", document=False)
@click.argument("runs", nargs=-1, type=PATH, required=True)
@output(
    "Folder of comparison.html and comparison.csv, or the page itself, ….html.",
    default=Path("comparison"),
    show_default=True,
)
def compare(runs: tuple[Path, ...], directory: Path) -> None:
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
    from asperity.cli.results import compare_runs

    compare_runs(runs, directory)


@_look("Write what a run sounds like, as WAV files.", params=commands.LISTEN)
@commands.run_argument
@output("Folder of the sounds. [default: sounds, beside the run]")
def listen(run: Path, what: str | None, matched: bool, directory: Path | None) -> Document:
    """Write what a RUN sounds like (run.nc, or its folder): a WAV file for each law and place, 48 kHz.

    Examples
    --------
    # into runs/case/sounds, all on one scale
    asperity listen runs/case
    # equally loud, so that only the sound differs
    asperity listen runs/case --matched
    """
    from asperity.cli.results import write_sounds

    return write_sounds(run, directory, what, matched=matched)


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


@_around("Show or delete what is kept between runs.")
@click.option("--clear", is_flag=True, help="Delete what is kept; it is computed again when it is needed.")
def cache(clear: bool) -> Document:
    """Show what is kept: finished pieces of work, compiled functions, and what interrupted runs left.

    Work is kept in $ASPERITY_CACHE, by default in the cache folder of the system.

    Examples
    --------
    # what is kept, where, and how much it is
    asperity cache
    # delete it; it is computed again when it is needed
    asperity cache --clear
    """
    from asperity.cli.results import show_cache

    return show_cache(clear=clear)


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
