"""Options that several commands have, and what a shell completes in their words."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from pathlib import Path

import click

from asperity.kinds import KINDS

PATH = click.Path(path_type=Path)


def run_folder(what: str = "Folder of the results.") -> Callable[..., Callable[..., object]]:
    """Where results go."""
    return click.option(
        "-o", "--output", "directory", type=PATH, metavar="FOLDER", help=f"{what} [default: runs/NAME]"
    )


overwrite = click.option("--overwrite", is_flag=True, help="Replace the run of another case in the folder.")
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


def _choose(device: str | None) -> None:
    if device is not None:
        from asperity.contact.batched import choose_device

        choose_device(device)


device = click.option(
    "--device",
    type=click.Choice(["cpu", "gpu"]),
    help="Where contacts are solved; gpu needs CuPy. [default: $ASPERITY_DEVICE, else cpu]",
    callback=lambda context, option, name: _choose(name),
    expose_value=False,
)


def templates() -> tuple[str, ...]:
    """List what 'asperity new' can write."""
    return (*KINDS, "study", "optimisation")


def complete_templates(context: click.Context, argument: click.Parameter, incomplete: str) -> list[str]:
    """Complete what 'asperity new' can write."""
    return [name for name in templates() if name.startswith(incomplete)]


def complete_laws(context: click.Context, option: click.Parameter, incomplete: str) -> list[str]:
    """Complete the name of a law."""
    from asperity.laws import names

    return [name for name in names() if name.startswith(incomplete)]


def complete_sweep(context: click.Context, option: click.Parameter, incomplete: str) -> list[str]:
    """Complete ``KEY=`` of a case, and the words of a key that takes words, behind its last comma."""
    key, mark, values = incomplete.partition("=")
    entries = _keys(context.params.get("study"))
    if not mark:
        return [f"{name}=" for name in entries if name.startswith(key)]
    before, comma, last = values.rpartition(",")
    words = entries.get(key.strip(), ())
    return [f"{key}={before}{comma}{word}" for word in words if word.startswith(last.strip())]


def _keys(case: Path | None) -> dict[str, Sequence[str]]:
    """Keys of the kind of a case, of all kinds where that cannot be told, with the words they take."""
    from asperity.config.describing import entries
    from asperity.config.values import value_kind

    found: dict[str, Sequence[str]] = {}
    for kind in _kinds(case):
        for entry in entries(KINDS[kind].case):
            taken = value_kind(entry.field.annotation, entry.field.metadata)
            known = getattr(taken, "known", getattr(taken, "words", ()))
            if entry.dotted != "kind":  # one kind in a study
                found[entry.dotted] = tuple(known)
    return found


def _kinds(case: Path | None) -> Sequence[str]:
    from asperity.config.parsing import read_toml
    from asperity.errors import InputError

    try:
        text = Path(case or "").read_text(encoding="utf-8")
        kind = str(read_toml(text, "case", str(case)).get("kind"))
    except (OSError, UnicodeError, InputError):
        return list(KINDS)
    return [kind] if kind in KINDS else list(KINDS)
