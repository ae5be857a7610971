"""Pages that are written from what the project holds, so that nothing is told twice: before every build.

Pages of the repository keep the links that lead somewhere there; here they lead to the page that holds the
file, or to the file itself.
"""

from __future__ import annotations

import importlib
import inspect
import os
import re
from collections import Counter
from collections.abc import Iterator
from pathlib import Path
from types import GenericAlias, ModuleType

import click

from asperity.case import PRESETS
from asperity.case.cases import template
from asperity.cli import main
from asperity.laws import Need, names, spec_of
from asperity.reference.bearings import COLUMNS, LISTED, PITCH, by_citation

DOCS = Path(__file__).parents[1]
ROOT, WRITTEN = DOCS.parent, DOCS / "generated"
COPIED = {
    "CONFORMANCE.md": "conformance",
    "benchmarks/README.md": "benchmarks",
    "ARCHITECTURE.md": "architecture",
    "CONTRIBUTING.md": "contributing",
    "CHANGELOG.md": "changelog",
    "SECURITY.md": "security",
}
"""Pages that stand elsewhere in the repository, and their names here."""
HOMES = {ROOT / source: WRITTEN / f"{name}.md" for source, name in COPIED.items()} | {
    ROOT / "README.md": DOCS / "start/index.md",
    ROOT / "examples": WRITTEN / "gallery/index.rst",
}
NEEDS = {
    Need.SAMPLES: "samples",
    Need.DATUM: "the datum",
    Need.FILTER: "the contact filter",
    Need.AREAL: "texture beside the line",
    Need.SCAN: "a scan of the whole path",
    Need.SURFACE: "texture beside the line",
}
LINK = re.compile(r"\]\((?![a-z]+:|#)([^)#\s]+)(#[^)]*)?\)")
IMPORT = re.compile(r"^ *from (asperity[\w.]*) import ([\w, ]+)$", re.MULTILINE)
KEY = re.compile(r"^(?P<unset># )?(?P<key>\w+) = (?P<value>.*?) +# (?P<note>.*)$")


def relinked(text: str, place: Path, page: Path) -> str:
    """Text of a file in the folder `place`, its links as they have to be on `page`."""

    def leading(match: re.Match[str]) -> str:
        target = (place / match[1]).resolve()
        found = HOMES.get(target, target)
        return f"]({Path(os.path.relpath(found, page.parent)).as_posix()}{match[2] or ''})"

    return LINK.sub(leading, text)


def copied() -> Iterator[tuple[str, str]]:
    """Pages of the repository."""
    for source, name in COPIED.items():
        path = ROOT / source
        yield name, relinked(path.read_text(encoding="utf-8"), path.parent, WRITTEN / f"{name}.md")


def commands() -> str:
    """Every command with its help."""
    parts = ["# Commands", "What `asperity COMMAND --help` says.", *help_of(main, "asperity")]
    for name, command in sorted(main.commands.items()):
        parts += [f"## {name}", *help_of(command, f"asperity {name}")]
    return "\n\n".join(parts)


def help_of(command: click.Command, name: str) -> list[str]:
    """Help of a command, as text."""
    context = click.Context(command, info_name=name, max_content_width=90, terminal_width=90)
    return [f"```text\n{command.get_help(context)}\n```"]


def keys_of(kind: str) -> str:
    """Every key of the case file of a kind."""
    title, *lines = template(kind).splitlines()
    parts = [f"# Keys of {kind}", title.lstrip("# ").split(". ")[0] + "."]
    parts += [
        f"`asperity new {kind}` writes this as a case file. Keys in *italics* have no fixed default: an "
    ]
    parts[-1] += "example stands there."
    rows: list[str] = []
    for line in lines:
        if line.startswith("["):
            section, meaning = line.split("]", 1)
            parts += ["\n".join(rows)] * bool(rows)
            parts += [f"## {section}]", meaning.lstrip(" #").capitalize() + "."]
            rows = []
        elif (found := KEY.match(line)) is not None:
            rows += ["| key | value | meaning |", "|---|---|---|"] * (not rows)
            name = f"*`{found['key']}`*" if found["unset"] else f"`{found['key']}`"
            note = found["note"].replace("|", "\\|")
            rows.append(f"| {name} | `{found['value']}` | {note} |")
    return "\n\n".join([*parts, "\n".join(rows)])


def agreement() -> str:
    """How many numbers of each chapter of the conformance page are held against what."""
    rows = ["| subject | numbers | sources |", "|---|---:|---|"]
    text = (ROOT / "CONFORMANCE.md").read_text(encoding="utf-8")
    for heading, body in re.findall(r"^## (.*?)\n(.*?)(?=^## |\Z)", text, re.MULTILINE | re.DOTALL):
        cells = [line.split(" | ") for line in body.splitlines()[3:] if line.startswith("| ")]
        sources = Counter(re.split(r"[;,]", row[1])[0].strip() for row in cells)
        named = "; ".join(f"{source}: {count}" for source, count in sources.most_common(6))
        rows.append(f"| {heading} | {len(cells)} | {named}{' …' * (len(sources) > 6)} |")
    return "\n".join(rows)


def laws() -> str:
    """Every law and variant, as its specification states it."""
    rows = ["| law | what it is | needs of the surface |", "|---|---|---|"]
    for name in names():
        spec = spec_of(name)
        needs = ", ".join(NEEDS[need] for need in Need if need in spec.needs) or "the line alone"
        rows.append(f"| `{name}` | {spec.meaning} | {needs} |")
    return "\n".join(rows)


def bearings() -> str:
    """Every bearing that has a name, source by source."""
    parts: list[str] = []
    for citation, prints, group in by_citation(LISTED.values()):
        rows = [COLUMNS, ("---",) * len(COLUMNS), *(each.cells for each in group)]
        parts += [f"**{citation}.** Printed: {prints}.", ""]
        parts += [*(f"| {' | '.join(row)} |" for row in rows), ""]
    return "\n".join([*parts, PITCH])


MODULES = {
    "asperity": "Cases, runs, surfaces, contacts and structures",
    "asperity.laws": "Contact laws",
    "asperity.rolling": "Rolling",
    "asperity.surfaces.synthesis": "Surfaces that are drawn",
    "asperity.spectra": "Spectra and levels",
    "asperity.diagnostics": "Faults of bearings",
    "asperity.errors": "Errors and warnings",
}
"""Modules whose public names are told of, and their headings."""
EXTENDING = (
    "asperity.case.rolled_over.RolledOver",
    "asperity.case.scene.Case",
    "asperity.parameters.key",
    "asperity.parameters.optional",
    "asperity.reporting.figure.Chapter",
    "asperity.scenes.observer.Observer",
    "asperity.schema.Entry",
    "asperity.surfaces.readers.SurfaceFormat",
)
"""What packages of one's own are made of."""


def imported() -> list[str]:
    """Names below the package that README, pages and examples import: whoever copies them relies on these."""
    pages = [ROOT / "README.md", *DOCS.glob("*.md"), *DOCS.glob("*/*.md"), *(ROOT / "examples").glob("*.py")]
    found = {
        f"{module}.{name.split()[0]}"
        for page in pages if page.parent != WRITTEN
        for module, names in IMPORT.findall(page.read_text(encoding="utf-8"))
        for name in names.split(",")
    }  # fmt: skip
    return sorted(found)


def api() -> str:
    """Tables of all public names, each with a page."""
    parts = ["Names in Python", "===============", ""]
    parts += ["What is named here is kept; everything else may change. All quantities are in SI.", ""]
    for name, heading in MODULES.items():
        module = importlib.import_module(name)
        offered = getattr(module, "__all__", None) or sorted(
            each for each, value in vars(module).items()
            if inspect.isfunction(value) and value.__module__ == name and not each.startswith("_")
        )  # fmt: skip
        shown = [each for each in offered if not each.startswith("__")]
        shown = [each for each in shown if not isinstance(getattr(module, each), ModuleType | GenericAlias)]
        parts += [heading, "-" * len(heading), "", ".. autosummary::", "   :toctree: api", ""]
        parts += [*(f"   {name}.{each}" for each in shown), ""]
    further = [name for name in imported() if name.rpartition(".")[0] not in MODULES]
    others = {
        "What packages of your own are made of": EXTENDING,
        "What pages and examples use beside these": [name for name in further if name not in EXTENDING],
    }
    for heading, told in others.items():
        parts += [heading, "-" * len(heading), "", ".. autosummary::", "   :toctree: api", ""]
        parts += [*(f"   {name}" for name in told), ""]
    return "\n".join(parts)


def write(app: object) -> None:
    """Write all pages whose text has changed."""
    pages = {f"{name}.md": text for name, text in copied()}
    pages["commands.md"] = commands()
    pages |= {f"keys-{kind}.md": keys_of(kind) for kind in PRESETS}
    pages |= {"api.rst": api(), "parts/laws.md": laws(), "parts/conformance.md": agreement()}
    pages["parts/bearings.md"] = bearings()
    (WRITTEN / "parts").mkdir(parents=True, exist_ok=True)
    for name, text in pages.items():
        path = WRITTEN / name
        if not path.is_file() or path.read_text(encoding="utf-8") != text + "\n":
            path.write_text(text + "\n", encoding="utf-8", newline="\n")


def relink(app: object, name: str, source: list[str]) -> None:
    """Let the links of a page that is written by hand lead to pages."""
    if not name.startswith("generated/"):
        source[0] = relinked(source[0], (DOCS / name).parent, DOCS / name)


def setup(app):
    """Tell Sphinx."""
    app.connect("builder-inited", write, priority=100)
    app.connect("source-read", relink)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
