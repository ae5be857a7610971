"""Commands to begin with: an example, a case file, measured files, wheels, bearings, creep."""

from pathlib import Path

import click

from asperity.cli import commands
from asperity.cli.commands import PATH, output
from asperity.cli.program import commands_of
from asperity.terminal import say

_begin = commands_of("Begin")


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


@_begin(
    "What is in a measured file: size, statistics, spectrum, picture.",
    params=commands.SURFACE,
    does="asperity.cli.surface.show_surface",
)
@click.argument("file", type=PATH)
@commands.picture("The picture. [default: NAME-surface.png here, with array and index in its name]")
def surface() -> None:
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


@_begin(
    "Modes of a wheel by the drawing of its section.",
    document=False,
    long_work=True,
    does="asperity.cli.wheel.show_wheel",
)
@click.argument("section")
@click.option("--highest", metavar="FREQUENCY", help="Upper end of the spectra. [default: 5 kHz]")
@commands.picture("Draw the section to a file, .svg, .pdf or .png.", "--picture")
@output("Table of the modes, which wheel.modes of a case names.", "table", "FILE")
def wheel() -> None:
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


@_begin(
    "What a bearing carries, its tones, and what its signal says.",
    params=commands.BEARING,
    long_work=True,
    does="asperity.cli.bearing.show_bearing",
)
@click.argument("bearing", metavar="NAME|FILE", required=False)
@click.argument("more", type=PATH, nargs=-1, metavar="[SIGNAL]...")
@commands.picture("Picture of the load zone, or of the envelope spectrum.")
def bearing() -> None:
    """Say how a bearing carries a load at rest, and its tones; or which of them a signal holds.

    A bearing has a NAME, or its dimensions stand in a FILE (TOML): balls, ball_diameter, pitch_diameter,
    inner_conformity, outer_conformity, clearance or contact_angle, preload, material, turning, radial, …; of
    a roller bearing rollers, roller_diameter, roller_length, pitch_diameter, contact_angle, crowning, …

    Several files of one measurement, at one speed, are judged one by one and all together.

    Examples
    --------
    # which bearings have a name, and where their balls are printed
    asperity bearing --list
    # its tones
    asperity bearing 6205 --speed '1797 1/min'
    # loads, contact ellipses, pressures, stiffness, too
    asperity bearing 6205 --radial '100 N' --speed '1797 1/min'
    # the same of a roller bearing
    asperity bearing NU205 --radial '2 kN' --speed '1800 1/min'
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
    # a speed that changes, by a tacho beside the signal
    asperity bearing 6205 --signal run-up.csv --column 1 --rate '12 kHz' --tacho 2 --tacho-reads '60 pulses'
    # several files of one measurement: each one, and all together
    asperity bearing 6205 --speed '1797 1/min' --signal run-1.wav run-2.wav run-3.wav
    """


@_begin(
    "Creep force over creepage of what rolls in a case.",
    params=commands.CREEP,
    document=False,
    long_work=True,
    does="asperity.cli.creep.show_creep",
)
@click.argument("case", type=PATH)
@commands.picture("Draw it to a file, .svg, .pdf or .png.")
def creep() -> None:
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
