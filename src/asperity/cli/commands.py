"""What commands are made of: options that several have; their help, errors, exit codes and documents."""

import inspect
import io
import sys
import textwrap
import traceback
import warnings
from collections.abc import Callable, Iterable, Iterator, Mapping
from contextlib import contextmanager, suppress
from functools import partial
from itertools import groupby
from pathlib import Path
from typing import Any

import click

from asperity import __version__, errors, files
from asperity.case import kinds
from asperity.errors import InputError, printable
from asperity.garbage import seek_seldom
from asperity.interrupts import interruptible, was_interrupted
from asperity.terminal import (
    Manner,
    change_manner,
    manner,
    require_output,
    say,
    say_document,
    speaking,
    standard_streams,
)

TEMPLATES = ("study", "what-helps", "what-helps-in-bearings", "what-helps-in-roller-bearings", "optimisation",
             "optimisation-of-bearings")  # fmt: skip
"""What 'asperity new' writes beside cases."""
PATH = click.Path(path_type=Path)
PICTURES = (".svg", ".pdf", ".png")
Completion = Callable[[click.Context, click.Parameter, str], list[str]]
FORMAT = 1
"""Of documents (``docs/reference/json.md``): raised where a name or meaning in them changes or goes."""
FAILED = 3
INTERRUPTED = 130
_INTERRUPTED = "interrupted; run the same command again to continue"


def templates() -> tuple[str, ...]:
    """List what 'asperity new' can write."""
    return (*kinds(), *TEMPLATES)


class WholeNumber(click.IntRange):
    """A whole number between two, which are told in words."""

    name = "integer"

    def _describe_range(self) -> str:
        return f"{self.min} to {self.max}"


class Command(click.Command):
    """A command whose help ends with the examples of its docstring, where KIND is the first kind of case.

    Parameters
    ----------
    section : str
        Under which the program lists it.
    document : bool
        Whether it has a form for programs, with ``--json``: it then returns what stands in the document.
    long_work : bool
        Whether it can be told to say less or more of what it does.
    does : str
        Function that does it, by its module and name, which takes arguments and options by their names;
        it is imported when it runs. Without one the command does what stands below its help.
    """

    def __init__(
        self,
        *arguments: Any,
        section: str = "More",
        document: bool = True,
        long_work: bool = False,
        does: str = "",
        **settings: Any,
    ) -> None:
        super().__init__(*arguments, **settings)
        self.section = section
        if does:
            self.callback = partial(_do, does)
        text = inspect.cleandoc(self.help or "").replace("KINDS", ", ".join(kinds()))
        text = text.replace("KIND", next(iter(kinds())))
        self.help, _, self.examples = text.partition("\n\nExamples\n--------\n")
        if document:
            words = "Print one JSON document, as docs/reference/json.md describes, for programs."
            self.params.append(_manner_option("--json", "document", help=words))
        if long_work:
            quiet = "Show no progress and no remarks; warnings and errors stay."
            verbose = "Show what each piece of the work took, and how long the compiler."
            self.params.append(_manner_option("-q", "--quiet", help=quiet))
            self.params.append(_manner_option("-v", "--verbose", help=verbose))

    def parse_args(self, ctx: click.Context, args: list[str]) -> list[str]:
        """Read what stands behind the command; what it does not take is refused, with what it does."""
        ctx.allow_extra_args = True
        left = super().parse_args(ctx, args)
        if left and not isinstance(self, click.Group):
            words = [str(each.name).upper() for each in self.params if isinstance(each, click.Argument)]
            behind = " and ".join(words) or "the command"
            allowed = " and ".join([*words, "options"])
            received = " ".join(f"'{each}'" for each in left)
            ctx.fail(f"received {received} behind {behind}; allowed: {allowed}. {self._way_out(left[0])}")
        return left

    def _way_out(self, word: str) -> str:
        """What to do with a word that is one too many."""
        if Path(word).exists():
            return "Give the command once for each file."
        if any("--output" in each.opts for each in self.params):
            return f"What it writes has its name behind -o: -o {word}"
        return f"What it says goes into a file behind '>': > {word}"

    def format_epilog(self, ctx: click.Context, formatter: click.HelpFormatter) -> None:
        """Write command lines that can be copied, each under what it does."""
        if self.examples:
            formatter.write(f"\nExamples:\n{textwrap.indent(self.examples, '  ')}\n")


def _do(function: str, **given: Any) -> Any:
    """What a function makes of arguments and options, which is imported now."""
    from asperity.case.any_case import function_named

    return function_named(function)(**given)


def _manner_option(*names: str, help: str) -> click.Option:
    """An option that changes how the program speaks, and which its command need not know."""

    def change(context: click.Context, option: click.Parameter, wanted: bool) -> None:
        if wanted:
            change_manner(**{str(option.name): True})

    return click.Option(names, is_flag=True, expose_value=False, callback=change, help=help)


class Program(Command, click.Group):
    """A group of commands that turns every error into one clear message and an exit code.

    0 done; 2 the input is wrong; 3 the computation failed; 130 interrupted. With ``--json`` what a command
    returns, or why it failed, is one document on standard output.
    """

    command_class = Command

    def main(self, args: Any = None, *, standalone_mode: bool = True, **extra: Any) -> Any:  # type: ignore[override]
        """Run the program, with standard streams that need no reader."""
        args = sys.argv[1:] if args is None else list(args)
        name = next((word for word in args if not word.startswith("-")), "")
        seek_seldom()
        wanted = Manner(document="--json" in args)  # known before anything can be wrong
        with standard_streams(), speaking(wanted), interruptible(), _warnings_in_lines() as warned:
            try:
                content = super().main(args, standalone_mode=False, **extra)
                code = content if isinstance(content, int) else 0
                if code == 0:
                    require_output()
                if isinstance(content, Mapping) and manner().document:
                    met = [{"grade": "warning", "message": message} for message in warned]
                    told = {**content, "warnings": [*content.get("warnings", ()), *met]}
                    if files := {what: path.resolve() for what, path in content.get("files", {}).items()}:
                        told["files"] = files
                    _say_document(name, code, told)
            except (click.ClickException, click.Abort, errors.ComputationError) as error:
                code = _failed(error, name)
        if standalone_mode:
            sys.exit(code)
        return code

    def invoke(self, ctx: click.Context) -> Any:
        """Run the command; click would end with some errors itself, or write a line of its own."""
        try:
            return super().invoke(ctx)
        except (click.ClickException, click.exceptions.Exit):
            raise
        except (Exception, KeyboardInterrupt) as error:
            ctx.exit(_failed(error, str(ctx.invoked_subcommand), debug=ctx.params["debug"]))

    def format_commands(self, ctx: click.Context, formatter: click.HelpFormatter) -> None:
        """List the commands in the order of the work, section by section."""
        width = max(map(len, self.commands))
        listed = [command for command in self.commands.values() if isinstance(command, Command)]
        for title, commands in groupby(listed, lambda command: command.section):
            with formatter.section(title):
                rows = [(str(each.name).ljust(width), each.get_short_help_str(100)) for each in commands]
                formatter.write_dl(rows)


def _failed(error: BaseException, command: str, *, debug: bool = False) -> int:
    """Say what went wrong, in words and, if one is wanted, in a document; return the exit code."""
    if isinstance(error, click.ClickException):
        usage = io.StringIO()
        error.show(usage)
        told = usage.getvalue()
        message = error.format_message()
        code = error.exit_code
    elif isinstance(error, KeyboardInterrupt | click.Abort) or was_interrupted():
        told = message = _INTERRUPTED  # even where an import has made another error of it
        code = INTERRUPTED
    else:
        message = f"the program failed with {type(error).__name__}: {error}"
        code = FAILED
        message = f"{printable(message)}. Try: asperity --debug …, which shows where."
        if isinstance(error, errors.AsperityError):
            message = str(error)
            code = error.exit_code
        elif isinstance(error, MemoryError):
            message = errors.TOO_MUCH_MEMORY
        told = f"Error: {message}"
        if debug:
            say(traceback.format_exc(), err=True, lines=True)
    say(told, err=True, lines=True)
    if manner().document:
        kind = "UsageError" if isinstance(error, click.ClickException) else "ProgramError"
        kind = type(error).__name__ if isinstance(error, errors.AsperityError) else kind
        try:
            _say_document(command, code, {"error": {"message": message, "kind": kind}})
        except errors.ComputationError as unheard:
            return _failed(unheard, command)
    return code


def _say_document(command: str, code: int, content: Mapping[str, Any]) -> None:
    say_document(
        {"format": FORMAT, "asperity": __version__, "command": command, "exit_code": code, **content}
    )


@contextmanager
def _warnings_in_lines() -> Iterator[dict[str, None]]:
    """Print each warning once, on one line; gives those that were printed."""
    printed: dict[str, None] = {}

    def show(message: Warning | str, category: type[Warning], *place: Any, **more: Any) -> None:
        if str(message) not in printed and not issubclass(category, DeprecationWarning | ImportWarning):
            printed[str(message)] = None
            say(f"Warning: {message}", err=True)

    with warnings.catch_warnings(action="always"):
        warnings.showwarning = show
        yield printed


# --- options that several commands have


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


def _run_folder(context: click.Context, option: click.Parameter, folder: Path | None) -> Path:
    """A folder of one's choice, or by default one in ``runs`` with the name of what is computed."""
    computed = next(each for each in context.command.params if isinstance(each, click.Argument))
    return folder or Path("runs") / context.params[str(computed.name)].stem


run_folder = output("Folder of the results. [default: runs/NAME]", callback=_run_folder)
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
    help="Over a track: what pads, roughness, speed … do to the sound of rail, sleepers and wheel; in a "
    "bearing what clearance, preload, waves … do to its velocities.",
)


def overwrite(what: str) -> Any:
    """Whether what a folder holds already may be replaced."""
    return click.option("--overwrite", is_flag=True, help=f"Replace {what} in the folder.")


def require_writable(folder: Path, of: str = "results") -> None:
    """Refuse a folder of what a command writes that cannot be written to."""
    files.refuse_unwritable(folder, f"folder of the {of}", "Choose another folder with -o.")


def taken_folder(directory: Path, received: str, what: str) -> InputError:
    """Error about a folder whose results are those of something else than this."""
    remedy = "Choose another folder with -o, or replace it with --overwrite."
    return InputError(str(directory), received, f"a new folder, or that of the same {what}", remedy)


def mark_of(what: str, asked: str, text: str) -> str:
    """First line of a case that was found: it tells what it answers, and whether it was changed since."""
    from asperity.store import content_key

    return f"# {content_key(what, asked, text)}\n"


def taken_file(file: Path, by: str) -> InputError:
    """Error about a file that is not what this command has written there before."""
    remedy = f"Choose another folder with -o, or replace {file.name} with --overwrite."
    allowed = f"a folder without {file.name}, or with that of the same {by}"
    return InputError(str(file), f"one of another {by}, or of somebody", allowed, remedy)


def refuse_other_case(what: str, asked: str, case: Path, by: str) -> None:
    """Let a command replace the case that it has found itself; any other one in the folder stays."""
    from asperity.case import toml

    if not case.exists():
        return
    mark = ""
    text = ""
    with suppress(InputError):
        mark, _, text = toml.read_definition(case, "case", "").partition("\n")
    if f"{mark}\n" != mark_of(what, asked, text):
        raise taken_file(case, by)


def _choose_device(context: click.Context, option: click.Parameter, name: str | None) -> None:
    if name is not None:
        from asperity.contact.batched import choose_device

        choose_device(name)


device = click.option(
    "--device",
    type=click.Choice(["cpu", "gpu"]),
    help="Where contacts are solved; gpu needs CuPy, and is written, not yet run on a device. "
    "[default: $ASPERITY_DEVICE, else cpu]",
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


def _option(names: str, help: str, value: str | None = None, **more: Any) -> click.Option:
    """An option by its names, with blanks between, and the word for its value."""
    return click.Option(names.split(), metavar=value, help=help, **more)


def _flag(names: str, help: str) -> click.Option:
    """An option that is given or not."""
    return click.Option(names.split(), is_flag=True, help=help)


SURFACE = [
    _option("--array", "Name of the array, where the file holds several."),
    _option("--index", "Which map of an ensemble, from 0. [default: all, the first one pictured]", type=int),
    _option("--height-unit", "Unit of heights that carry none, as 'um'.", "UNIT"),
    _option("--pixel", "Distance of points that carry none, as '1.5625 um'.", "LENGTH"),
    _option("--pixel-unit", "Unit of coordinates that carry none, as 'mm'.", "UNIT"),
    _option("--decimal", "Decimal mark of a text, '.' or ',', where in doubt.", "MARK"),
    _flag("--transpose", "Exchange x and y: roll along the other direction."),
    _option(
        "--direction --rotate direction", "Roll in this direction, from x towards y, as '30 deg'.", "ANGLE"
    ),
    _flag("--fill", "Fill points without a height."),
    _option("--crop", "Keep a piece: '0 mm, 0 mm, 1 mm, 0.5 mm' (x, y, sides).", "LENGTHS"),
    _option("--form", "Remove plane, quadratic or quartic.", "FORM"),
    _option("--longest", "Nesting index of the L-filter (ISO 16610-21, -61).", "LENGTH"),
    _option("--shortest", "Nesting index of the S-filter, likewise Gaussian.", "LENGTH"),
    _option("--recipe", "Do what a stored recipe says; options are stronger.", type=PATH),
    _option("--store", "Store all that was done as a recipe that a case can name.", type=PATH),
    _flag("--spikes", "Take spikes for points without a height."),
    _option(
        "--lines/--map",
        "Take an array for lines measured side by side, or for a map. [default: by its shape]",
        default=None,
    ),
    _flag("--psd", "Write the spectra of the picture as CSV beside it."),
]
"""Hints on a measured file, and steps that are taken with it: keys of a recipe."""
BEARING = [
    _option("--radial", "Radial load on the inner ring, as '100 N'.", "FORCE"),
    _option("--axial", "Axial load on it.", "FORCE"),
    _option("--tilt", "Tilt of an inner ring on rollers in the plane of the radial load.", "ANGLE"),
    _option("--speed", "Of the ring that turns, as '1800 1/min'.", "SPEED"),
    _option("--clearance", "Diametral clearance, as '10 um'.", "LENGTH"),
    _option("--oil", "Oil in the contacts, as 'ISO VG 68': films.", "GRADE"),
    _option("--temperature", "Of the oil. [default: '70 degC']", "DEGREES"),
    _option(
        "--signal",
        "Acceleration of it: .npz, .npy, .mat, .wav, .uff, .parquet or text; more files may follow.",
        type=PATH,
        multiple=True,
    ),
    _option(
        "--rate", "Sampling rate of the signal, as '12 kHz', unless times beside it give it.", "FREQUENCY"
    ),
    _option("--array", "Name of the signal, where a file holds several."),
    _option("--column", "Number of its column, from 1, where there are several.", type=int),
    _option(
        "--tacho",
        "Column of a tacho or a speed beside it, by number, or its array: it is read over angle.",
        "COLUMN",
    ),
    _option(
        "--tacho-reads",
        "What the tacho reads: '1/min', 'Hz', or '60 pulses' in a turn. [default: as its heading says]",
        "WHAT",
    ),
    _option("--band", "Frequencies of the envelope: 'all', or as '2 kHz, 4 kHz'. [default: found]"),
    _option(
        "--known",
        "Part that is known to have a fault: whether the record shows it is said.",
        type=click.Choice(["outer", "inner", "ball", "roller"]),
    ),
    _option(
        "--table",
        "Write stiffness and damping matrices over lists or ranges of --radial, --axial and --speed, as "
        "'100..500 N, 5 steps': .csv, or .json with elements for ROSS.",
        "FILE",
        type=PATH,
    ),
    _option("--damping contact_damping", "Of each contact, for --table, as '20 N s/m'."),
    _option("--cage-angle", "Angles of the cage for --table, as '0..40 deg, 5 steps'. [default: means]"),
    _option("--load-direction", "Of the radial load from x towards y, for --table, as '-90 deg'."),
    _option(
        "--sheet",
        "Write its data sheet, .html: geometry, stiffness over load, tones; of the folder of a run in "
        "place of NAME also its bands by part.",
        "FILE",
        type=PATH,
    ),
    _option(
        "--limits",
        "Largest rms radial velocities in the bands of ISO 15242, as '50 um/s, 30 um/s, none': list how "
        "large each wave of each part may be alone.",
        "VELOCITIES",
    ),
    _option("--outer-mass", "Of the free outer ring, for --limits, as '60 g'."),
    _flag("--list listed", "List all NAMEs, and where they are printed."),
]
"""What a bearing carries, and where its signal is."""
CREEP = [
    _option(
        "--direction",
        "Creepage that grows; spin makes a lateral force. [default: longitudinal]",
        type=click.Choice(["longitudinal", "lateral", "spin"]),
    ),
    _option("--friction", "Coefficient of friction. [default: the case's; 0.3]", type=float),
    _option("--points", "Points up to full slip, or states. [default: 16; 6 states]", type=int),
    _flag("--states", "Instead: stiffness in stick, and creep as it begins, over load."),
    _option("--table", "Write it to a file, CSV.", type=PATH),
]
STUDY = [
    _option(
        "--vary",
        "STUDY is a case: a key and its values, as 'speed = 80, 200 km/h', or a range, as "
        "'80..300 km/h, 6 steps', '60..1900 MN/m, 6 ratios', '1..20'. May be repeated.",
        "KEY=VALUES",
        multiple=True,
    ),
    _option(
        "--draw",
        "A key of which each member gets a value by chance: '50..500 N', '0.2..3 mm, ratios', one of a "
        "list, or a speed that wanders in the record, '1200..1800 1/min ± 0.5 %'. May be repeated.",
        "KEY=SPAN",
        multiple=True,
    ),
    _option(
        "--show",
        "Columns of the table and quantities of the figures, as in the headings of study.csv, with "
        "commas. May be repeated. [default: the usual ones]",
        "NAMES",
        multiple=True,
    ),
    _option("--workers", "Processes of this machine. [default: one per processor]", type=int),
    _option("--scheduler", "Compute on the Dask cluster of this scheduler.", "ADDRESS"),
]
SIGNALS = [
    _option("--signals", "Of ball bearings: write the acceleration of each, and labels.csv.", "FOLDER"),
    _option(
        "--format",
        "Of these signals: nc, npy, wav, uff, or parquet, which bearing-datasets opens. [default: nc]",
        "FORMAT",
    ),
    _option(
        "--path",
        "Impulse response of a path to the sensor: .npy, .wav or table; or drawn: '1..6 kHz, 3 resonances'.",
        "PATH",
    ),
    _option("--path-rate", "Its sampling rate, as '48 kHz'.", "FREQUENCY"),
    _option(
        "--noise", "Noise: '20 dB' below the signal, an rms, '0.5 m/s^2', or drawn: '0..30 dB'.", "LEVEL"
    ),
]
"""What a study writes of each bearing, and what lies between it and the record."""
FIT = [
    _option(
        "--to measured",
        "Table of what was measured; more may follow. [default: what the case names]",
        "FILE",
        type=PATH,
        multiple=True,
    ),
    _option(
        "--free",
        "A key that may change, or 'KEY = 100..2000 MN/m'. May be repeated. "
        "[default: those that decide most]",
        "KEY",
        multiple=True,
    ),
    _option(
        "--where",
        "Of a table with a measurement in each line those where a column holds this. May be repeated.",
        "COLUMN=VALUE",
        multiple=True,
    ),
    _option("--as what", "What files hold, where no heading tells it.", "QUANTITY"),
    _option("--starts", "Places from which is searched. [default: 8, of runs 1]", type=WholeNumber(1, 100)),
]
WRITTEN = [
    _option(
        "--format",
        "One universal file (dataset 58), or a WAV file for each signal.",
        type=click.Choice(["uff", "wav"]),
        default="uff",
        show_default=True,
    ),
    _option("--what", "One variable of the run, as contact_force. [default: all but displacements]", "NAME"),
]
LISTEN = [
    _option(
        "--what",
        "Variable of 'rolling' in the run, or pass_by_pressure, 7.5 m from a track. "
        "[default: acceleration, else velocity]",
        "NAME",
    ),
    _flag("--matched", "Make all as loud as each other. [default: louder laws are louder]"),
]
