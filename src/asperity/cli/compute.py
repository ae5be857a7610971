"""Commands that compute cases: one, many, the quietest, and those that fit what was measured."""

from pathlib import Path
from typing import Any

import click

from asperity.cli import commands
from asperity.cli.commands import PATH, output
from asperity.cli.program import Document, commands_of
from asperity.errors import InputError

_compute = commands_of("Compute")


@_compute("Is a case valid, what will it compute, and how long?", long_work=True)
@click.argument("case", type=PATH)
@commands.run_folder
@commands.device
@click.option("--keys", is_flag=True, help="Show every key with its value, those at their defaults too.")
@commands.overwrite("the run of another case")
def check(case: Path, directory: Path, keys: bool, overwrite: bool) -> Document:
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
    refuse_full(loaded, directory)
    if not overwrite:
        refuse_other(loaded, directory)
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
def run(case: Path, directory: Path, **choices: bool) -> Document:
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

    return run_case(read_case(case), directory, source=str(case), **choices)


@_compute(
    "Compute a case for every combination of values of some keys.",
    params=[*commands.STUDY, *commands.SIGNALS],
    long_work=True,
)
@click.argument("study", type=PATH)
@commands.what_helps
@commands.run_folder
@commands.overwrite("another study")
@commands.device
def study(
    study: Path,
    vary: tuple[str, ...],
    draw: tuple[str, ...],
    what_helps: bool,
    directory: Path,
    **choices: Any,
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
    asperity study case.toml --vary "speed = 80, 200 km/h"
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
    # a set to train on, sizes drawn by chance
    asperity study bearing.toml --vary "seed = 1..9" --draw "fault.length = 1..3 mm" --signals set
    """
    from asperity.cli.studying import defined, run_study

    return run_study(defined(study, vary, draw, helps=what_helps), directory, **choices)


@_compute(
    "Find the texture that rolls quietest within bounds.",
    long_work=True,
    does="asperity.cli.optimising.run_optimisation",
)
@click.argument("optimisation", type=PATH)
@commands.run_folder
@commands.report
@commands.overwrite("another texture")
@commands.device
def optimise() -> None:
    """Find the texture that rolls quietest within bounds, or the roughest that keeps a level.

    Of a ball bearing, the roughest waves that keep velocities under limits. Searches with a cheap law and
    verifies with another. What was rolled is kept: interrupted, the same command goes on where it was.

    Examples
    --------
    # of a file that 'asperity new optimisation' began
    asperity optimise aim.toml -o quiet
    """


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
