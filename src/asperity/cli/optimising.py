"""Finds a texture into a folder: its case, its bands as table and on a page, the runs before and after."""

import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from asperity import files
from asperity.case import toml
from asperity.case.any_case import AnyCase, function_named
from asperity.case.beside import refused
from asperity.case.form import Section, content, file_digest, in_toml
from asperity.cli.commands import mark_of, refuse_other_case, require_writable
from asperity.cli.running import warn, warnings_of
from asperity.optimising.definition import load_aim
from asperity.optimising.kinds import optimisation_of, searched
from asperity.progress import progress_bar
from asperity.reporting import page
from asperity.results import save
from asperity.scenes.report import PAGE as REPORT
from asperity.scenes.report import write_page
from asperity.schema import provenance
from asperity.terminal import say, say_files
from asperity.text_files import write_csv
from asperity.written_numbers import capital

FILES = {
    "case": "case.toml",
    "texture": "texture.csv",
    "table": "bands.csv",
    "page": "bands.html",
    "before": "before/run.nc",
    "after": "after/run.nc",
}

WRITTEN = {"texture": "texture", "table": "bands"}
"""Tables to which the page has links, and their words."""


@dataclass(frozen=True, eq=False)
class ToldOptimisation:
    """What is said of an optimisation, as its kind tells it."""

    document: dict[str, Any]  # for programs; its columns head the table of bands
    rows: Sequence[Sequence[Any]]  # of that table
    title: str
    blocks: Sequence[page.Block]  # of the page
    # headings and rows of further tables, by their names among the `FILES`
    tables: Mapping[str, tuple[Sequence[str], Sequence[Sequence[Any]]]] = field(default_factory=dict)


def run_optimisation(
    optimisation: Path, directory: Path, *, report: bool = True, overwrite: bool = False
) -> dict[str, Any]:
    """Find a texture and write it to a folder, with the runs before and after it.

    `overwrite` says whether a texture in the folder may be replaced, and `report` whether the runs get pages.
    """
    case, aim = load_aim(optimisation)
    written = {what: directory / name for what, name in FILES.items()}
    require_writable(directory)
    asked = json.dumps([content(each, file_digest) for each in (case, aim)])
    if not overwrite:
        refuse_other_case("texture", asked, written["case"], "optimisation")
    with files.alone_in(directory), progress_bar() as progress:
        found = searched(case, aim, progress)
        told: ToldOptimisation = function_named(optimisation_of(case).told_by)(found)
        with files.together(directory, last=FILES["case"]) as new:
            keys = in_toml(found.case, in_memory=lambda *_: FILES["texture"])
            text = toml.toml_text({"kind": found.case.kind, **keys})
            found.result_after.attrs[provenance.CASE.name] = text  # its texture is no longer in memory alone
            found.result_after.attrs.pop(provenance.IN_MEMORY.name, None)
            _written(found, told, _remake(case, aim), new, report=report)
            files.write_bytes(new / FILES["case"], f"{mark_of('texture', asked, text)}{text}".encode())
            written = {what: path for what, path in written.items() if (new / FILES[what]).exists()}
    warn(met := warnings_of(found.result_before))
    say(found.sentence)
    say_files(written)
    return {
        "summary": found.sentence,
        "settled": found.settled,
        **told.document,
        "rows": told.rows,
        "warnings": met,
        "files": written,
    }


def _remake(case: AnyCase, aim: Section) -> page.Remake:
    """Case and aim as files that find the same texture."""
    asked = toml.toml_text({"case": "case.toml", **in_toml(aim, in_memory=refused)})
    texts = {"case.toml": case.to_toml(), "optimisation.toml": asked}
    return page.Remake("asperity optimise optimisation.toml", texts)


def _written(
    found: Any, told: ToldOptimisation, remake: page.Remake, directory: Path, *, report: bool
) -> None:
    """Write the runs before and after, with their reports, and all that is said of what was found."""
    for what, tree in (("before", found.result_before), ("after", found.result_after)):
        run = save(tree, directory / FILES[what])
        if report:
            write_page(tree, run.with_name(REPORT))
    tables = {**told.tables, "table": (told.document["columns"], told.rows)}
    for what, (heading, rows) in tables.items():
        write_csv(directory / FILES[what], heading, rows)
    links = {f"{words} (CSV)": FILES[what] for what, words in WRITTEN.items() if what in tables}
    links["case"] = FILES["case"]
    if report:
        links |= {f"report {what}": f"{what}/{REPORT}" for what in ("before", "after")}
    text = page.figures_page(told.title, capital(found.sentence), told.blocks, links, remake)
    files.write_bytes(directory / FILES["page"], text.encode())
