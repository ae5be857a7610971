"""Finds a texture into a folder: its case, its bands as table and on a page, the runs before and after."""

import json
from pathlib import Path
from typing import Any

import numpy as np

from asperity import files
from asperity.arguments import Array
from asperity.case import any_case, toml
from asperity.case.form import content, file_digest
from asperity.cli.commands import mark_of, refuse_other_case
from asperity.cli.optimising_bearing import document_of_bearing, page_of_bearing, rows_of_bearing
from asperity.laws import spec_of
from asperity.optimising.bearing import OptimisedBearing
from asperity.optimising.definition import load_aim
from asperity.optimising.kinds import searched
from asperity.optimising.running import Optimised
from asperity.progress import progress_bar
from asperity.reporting import data, page, study_figures
from asperity.reporting.figure import PageFigure
from asperity.reporting.tables import ReportTable, number_cells, table, text_cells
from asperity.results import save
from asperity.scenes.report import PAGE as REPORT
from asperity.scenes.report import write_page
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


def run_optimisation(
    path: Path, directory: Path, *, report: bool = True, overwrite: bool = False
) -> dict[str, Any]:
    """Find a texture and write it to a folder, with the runs before and after it.

    `overwrite` says whether a texture in the folder may be replaced, and `report` whether the runs get pages.
    """
    case, aim = load_aim(path)
    written = {what: directory / name for what, name in FILES.items()}
    files.refuse_unwritable(directory, "folder of the results", "Choose another folder with -o.")
    asked = json.dumps([content(each, file_digest) for each in (case, aim)])
    if not overwrite:
        refuse_other_case("texture", asked, written["case"], "optimisation")
    with files.alone_in(directory), progress_bar() as progress:
        found = searched(case, aim, progress)
        with files.together(directory, last=FILES["case"]) as new:
            told = _written(found, new, report=report)
            keys = any_case.in_toml(found.case, in_memory=lambda *_: FILES["texture"])
            text = toml.toml_text({"kind": found.case.kind, **keys})
            files.write_bytes(new / FILES["case"], f"{mark_of('texture', asked, text)}{text}".encode())
            written = {what: path for what, path in written.items() if (new / FILES[what]).exists()}
    say(found.sentence)
    say_files(written)
    return {"summary": found.sentence, "settled": found.settled, **told, "files": written}


def _written(found: Optimised | OptimisedBearing, directory: Path, *, report: bool) -> dict[str, Any]:
    """Write what was found as tables and on a page, with the runs before and after; what is said of it."""
    for what, tree in (("before", found.result_before), ("after", found.result_after)):
        run = save(tree, directory / FILES[what])
        if report:
            write_page(tree, run.with_name(REPORT))
    if isinstance(found, OptimisedBearing):
        told = document_of_bearing(found)
        rows = rows_of_bearing(found)
        shown = page_of_bearing(found, FILES["table"], {"case": FILES["case"]}, report=report)
    else:
        texture = np.stack([found.after.wavelength, found.after.levels], axis=1).tolist()
        write_csv(directory / FILES["texture"], ["wavelength (m)", "level (dB re 1 um)"], texture)
        told = _document(found)
        columns = _columns(found)
        rows = np.stack(list(columns.values()), axis=1).tolist()
        shown = _page(found, columns, report=report)
    write_csv(directory / FILES["table"], told["columns"], rows)
    files.write_bytes(directory / FILES["page"], shown.encode())
    return told | {"rows": rows}


def _document(found: Optimised) -> dict[str, Any]:
    """What came of it, for programs."""
    return {
        "quantity": found.measure.meaning,
        "units": found.measure.units,
        "changes": found.changes,
        "levels": {law: list(levels) for law, levels in found.levels.items()},
        "limit": found.aim.limit,
        "limits": found.active,
        "columns": list(_columns(found)),
    }


def _columns(found: Optimised) -> dict[str, Array]:
    """Numbers of the bands that were changed, by the titles of their columns."""
    changed, units = found.after.changed, found.measure.units
    columns = {
        "wavelength [m]": found.after.changed_wavelength,
        "frequency [Hz]": np.sqrt(np.prod(found.after.edges(found.case.speed), axis=0)),
        "level before [dB re 1 um]": found.before.levels[changed],
        "level after [dB re 1 um]": found.after.levels[changed],
        "lowest [dB re 1 um]": found.limits.lowest,
        "highest [dB re 1 um]": found.limits.highest,
    }
    for law in found.changes:
        for name, tree in (("before", found.result_before), ("after", found.result_after)):
            columns[f"{law} {name} [{units}]"] = found.band_levels(tree, law)
    return columns


def _page(found: Optimised, columns: dict[str, Array], *, report: bool) -> str:
    laws = data.read_entries(spec_of(law).entry() for law in found.changes)
    colours = {name: law.colour for name, law in laws.items()}
    parts = study_figures.optimised_figure(columns, found.measure.meaning, found.measure.units, colours)
    figure = PageFigure.of("bands", "Texture and response in bands", parts, FILES["table"], columns)
    offered = {"texture (CSV)": "texture", "case": "case"}
    links = {words: FILES[what] for words, what in offered.items()}
    if report:
        links |= {f"report {what}": f"{what}/{REPORT}" for what in ("before", "after")}
    return page.figures_page(
        "Optimised texture", capital(found.sentence), [_levels_table(found), figure], links
    )


def _levels_table(found: Optimised) -> ReportTable:
    """Level of the quantity before and after, by law, and the limit that was asked for."""
    before, after = zip(*found.levels.values(), strict=True)
    columns = {
        "law": text_cells(found.levels, "name"),
        "before": number_cells(before, "{:.1f}"),
        "after": number_cells(after, "{:.1f}"),
        "change / dB": number_cells(found.changes.values(), data.signed),
    }
    limit = found.aim.limit
    if limit is not None:
        columns["limit"] = number_cells([limit] * len(before), "{:.1f}")
        columns["after less limit / dB"] = number_cells([each - limit for each in after], data.signed)
    note = (
        f"In {data.written_units(found.measure.units)}: all waves of the texture, and what other bodies add."
    )
    return table("levels", capital(found.measure.meaning), columns, note)
