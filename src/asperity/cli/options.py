"""Options that several commands have, and what a shell completes in their words."""

from collections.abc import Callable, Iterable
from pathlib import Path
from typing import Any

import click

from asperity.errors import InputError

PATH = click.Path(path_type=Path)
PICTURES = (".svg", ".pdf", ".png")
Completion = Callable[[click.Context, click.Parameter, str], list[str]]


def output(help: str, name: str = "directory", metavar: str | None = "FOLDER", **more: Any) -> Any:
    """Where results go."""
    return click.option("-o", "--output", name, type=PATH, metavar=metavar, help=help, **more)


def picture(help: str, *names: str) -> Any:
    """The file of a picture, whose ending says in which format it is drawn."""
    words = names or ("-o", "--output")
    return click.option(*words, "picture", type=PATH, metavar="FILE", help=help, callback=_drawable)


def _drawable(context: click.Context, option: click.Parameter, path: Path | None) -> Path | None:
    if path is not None and path.suffix.lower() not in PICTURES:
        raise InputError("picture", f"'{path}'", f"a name that ends in {', '.join(PICTURES)}")
    return path


run_argument = click.argument("run", type=PATH)
run_folder = output("Folder of the results. [default: runs/NAME]")
again = click.option(
    "--again", is_flag=True, help="Compute even what this program has computed already from the same files."
)
report = click.option(
    "--report/--no-report", default=True, show_default=True, help="Write the HTML page and CSVs."
)
converge = click.option(
    "--converge",
    is_flag=True,
    help="Compute again with each setting made finer: grid, window, samples, …, and say what that changes.",
)
what_helps = click.option(
    "--what-helps",
    is_flag=True,
    help="Over a track: what pads, roughness, speed … do to the sound of rail, sleepers and wheel.",
)


def overwrite(what: str) -> Any:
    """Whether what a folder holds already may be replaced."""
    return click.option("--overwrite", is_flag=True, help=f"Replace {what} in the folder.")


SIGNALS = {
    "signals": ("FOLDER", "Of ball bearings: write the acceleration of each, and labels.csv."),
    "format": ("FORMAT", "Of these signals: nc, npy or wav. [default: nc]"),
    "path": ("FILE", "Impulse response of a path to the sensor: .npy, .wav or a table."),
    "path-rate": ("FREQUENCY", "Its sampling rate, as '48 kHz'."),
    "noise": ("LEVEL", "Noise: '20 dB' below the signal, or an rms, '0.5 m/s^2'."),
}


def signals(function: Any) -> Any:
    """What a study writes of each bearing, and what lies between it and the record."""
    for name, (metavar, help) in reversed(SIGNALS.items()):
        function = click.option(f"--{name}", metavar=metavar, help=help)(function)
    return function


def _choose_device(context: click.Context, option: click.Parameter, name: str | None) -> None:
    if name is not None:
        from asperity.contact.batched import choose_device

        choose_device(name)


device = click.option(
    "--device",
    type=click.Choice(["cpu", "gpu"]),
    help="Where contacts are solved; gpu needs CuPy. [default: $ASPERITY_DEVICE, else cpu]",
    callback=_choose_device,
    expose_value=False,
)


def completed(names: Callable[[], Iterable[str]]) -> Completion:
    """Complete one of some names."""
    return lambda context, parameter, begun: [name for name in names() if name.startswith(begun)]


def _laws() -> Iterable[str]:
    from asperity.laws import names

    return names()


laws = click.option(
    "--law",
    "laws",
    multiple=True,
    metavar="LAW",
    shell_complete=completed(_laws),
    help="A law of the contact force, the first the main one. May be repeated.",
)


SURFACE = [
    click.Option(["--array"], help="Name of the array, where the file holds several."),
    click.Option(
        ["--index"], type=int, help="Which map of an ensemble, from 0. [default: all, the first one pictured]"
    ),
    click.Option(["--height-unit"], metavar="UNIT", help="Unit of heights that carry none, as 'um'."),
    click.Option(["--pixel"], metavar="LENGTH", help="Distance of points that carry none, as '1.5625 um'."),
    click.Option(["--pixel-unit"], metavar="UNIT", help="Unit of coordinates that carry none, as 'mm'."),
    click.Option(["--decimal"], metavar="MARK", help="Decimal mark of a text, '.' or ',', where in doubt."),
    click.Option(["--transpose"], is_flag=True, help="Exchange x and y: roll along the other direction."),
    click.Option(
        ["--direction", "--rotate", "direction"],
        metavar="ANGLE",
        help="Roll in this direction, from x towards y, as '30 deg'.",
    ),
    click.Option(["--fill"], is_flag=True, help="Fill points without a height."),
    click.Option(
        ["--crop"], metavar="LENGTHS", help="Keep a piece: '0 mm, 0 mm, 1 mm, 0.5 mm' (x, y, sides)."
    ),
    click.Option(["--form"], metavar="FORM", help="Remove plane, quadratic or quartic."),
    click.Option(["--longest"], metavar="LENGTH", help="Nesting index of the L-filter (ISO 16610-21, -61)."),
    click.Option(["--shortest"], metavar="LENGTH", help="Nesting index of the S-filter, likewise Gaussian."),
    click.Option(["--recipe"], type=PATH, help="Do what a stored recipe says; options are stronger."),
    click.Option(["--store"], type=PATH, help="Store all that was done as a recipe that a case can name."),
    click.Option(["--spikes"], is_flag=True, help="Take spikes for points without a height."),
    click.Option(
        ["--lines/--map"],
        default=None,
        help="Take an array for lines measured side by side, or for a map. [default: by its shape]",
    ),
    click.Option(["--psd"], is_flag=True, help="Write the spectra of the picture as CSV beside it."),
]
"""Hints on a measured file, and steps that are taken with it: keys of a recipe."""
BEARING = [
    click.Option(["--radial"], metavar="FORCE", help="Radial load on the inner ring, as '100 N'."),
    click.Option(["--axial"], metavar="FORCE", help="Axial load on it."),
    click.Option(["--speed"], metavar="SPEED", help="Of the ring that turns, as '1800 1/min'."),
    click.Option(["--clearance"], metavar="LENGTH", help="Diametral clearance, as '10 um'."),
    click.Option(["--signal"], type=PATH, help="Acceleration of it: .npz, .npy, .wav or text."),
    click.Option(["--rate"], metavar="FREQUENCY", help="Sampling rate of the signal, as '12 kHz'."),
    click.Option(["--array"], help="Name of the signal, where a file holds several."),
    click.Option(["--column"], type=int, help="Number of its column, from 1, where there are several."),
    click.Option(
        ["--band"], help="Frequencies of the envelope: 'all', or as '2 kHz, 4 kHz'. [default: found]"
    ),
]
"""What a bearing carries, and where its signal is."""
