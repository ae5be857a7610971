"""Optimise a texture into a folder: its case, its bands as table and on a page, and both runs."""

from __future__ import annotations

import json
from contextlib import suppress
from pathlib import Path
from typing import Any

import numpy as np

from asperity.config.content import content, file_digest
from asperity.config.describing import in_toml, toml_text
from asperity.config.parsing import read_definition
from asperity.errors import InputError
from asperity.files import alone_in, refuse_unwritable, together, write_bytes
from asperity.kinds import report as reports
from asperity.laws import spec_of
from asperity.optimising.definition import Assignment, load_assignment
from asperity.optimising.running import Optimised, optimise
from asperity.progress import progress_bar
from asperity.reporting.data import read_entries
from asperity.reporting.page import PageFigure, figures_page
from asperity.reporting.payload import number_cell
from asperity.reporting.study_figures import TextureBands, optimised_chart
from asperity.reporting.tables import ReportTable
from asperity.results import save
from asperity.store import content_key
from asperity.terminal import say
from asperity.text_files import write_csv

TEXTURE, CASE, TABLE, PAGE, TRIALS = (
    "texture.csv", "case.toml", "bands.csv", "bands.html", "trials.csv",
)  # fmt: skip


def optimise_into(
    path: Path, directory: Path, *, report: bool = True, overwrite: bool = False
) -> dict[str, Any]:
    """Find a texture and write it to a folder, with the runs before and after it.

    `overwrite` says whether a texture in the folder may be replaced, and `report` whether the runs get pages.
    """
    assignment = load_assignment(path)
    refuse_unwritable(directory, "folder of the results", "Choose another folder with -o.")
    asked = _asked(assignment)
    if not overwrite:
        _refuse_another(asked, directory / CASE)
    with alone_in(directory), progress_bar() as progress:
        found = optimise(assignment, progress)
        with together(directory, last=CASE) as new:
            _write(found, new, report=report)
            text = _case_text(found)
            write_bytes(new / CASE, f"{_mark(asked, text)}{text}".encode())
    say(found.sentence)
    say(f"Case:    {(directory / CASE).resolve()}")
    say(f"Page:    {(directory / PAGE).resolve()}, and as numbers {TABLE}")
    say(f"Runs:    {(directory / 'before').resolve()}, {(directory / 'after').resolve()}")
    titles, columns = _table(texture_bands(found), found.measure.units)
    written = {"case": CASE, "texture": TEXTURE, "table": TABLE, "page": PAGE, "trials": TRIALS}
    written |= {name: f"{name}/run.nc" for name in ("before", "after")}
    return {
        "summary": found.sentence,
        "quantity": found.measure.meaning,
        "units": found.measure.units,
        "settled": found.settled,
        "changes": found.changes,
        "limits": found.active,
        "columns": titles,
        "rows": columns,
        "warnings": [],
        "files": {name: str((directory / file).resolve()) for name, file in written.items()},
    }


def _asked(assignment: Assignment) -> str:
    """What was asked for, whatever the files are called that say it."""
    return json.dumps([content(each, file_digest) for each in (assignment.case, assignment.aim)])


def _mark(asked: str, text: str) -> str:
    """First line of a case that was found: it tells what it answers, and whether it was changed since."""
    return f"# {content_key('texture', asked, text)}\n"


def _refuse_another(asked: str, case: Path) -> None:
    """Let an optimisation replace what it has found itself; any other case in the folder stays."""
    if not case.exists():
        return
    mark, text = "", ""
    with suppress(InputError):
        mark, _, text = read_definition(case, "case", "").partition("\n")
    if f"{mark}\n" != _mark(asked, text):
        remedy = "Choose another folder with -o, or replace it with --overwrite."
        allowed = "a new folder, or that of the same optimisation"
        raise InputError(str(case.parent), f"a folder that holds another {CASE}", allowed, remedy)


def _write(found: Optimised, directory: Path, *, report: bool) -> None:
    """Write the texture found as tables and on a page, and the runs before and after it."""
    bands = texture_bands(found)
    rows = zip(found.after.wavelength.tolist(), found.after.levels.tolist(), strict=True)
    write_csv(directory / TEXTURE, ["wavelength (m)", "level (dB re 1 um)"], [list(row) for row in rows])
    write_csv(directory / TABLE, *_table(bands, found.measure.units))
    write_csv(directory / TRIALS, *_trials(found))
    for name, tree in (("before", found.result_before), ("after", found.result_after)):
        save(tree, directory / name / "run.nc")
        if report:
            reports.write_page(tree, directory / name / "report.html")
    _write_page(found, bands, directory / PAGE, report=report)


def texture_bands(found: Optimised) -> TextureBands:
    """Numbers of the bands: of those that were changed."""
    changed = found.after.changed
    low, high = found.after.edges(found.case.speed)
    aim = found.assignment.aim
    heard = {
        law: {
            name: found.band_levels(tree, law)
            for name, tree in (("before", found.result_before), ("after", found.result_after))
        }
        for law in dict.fromkeys((aim.verify, aim.law))
    }
    return TextureBands(
        found.after.wavelength[changed],
        {"before": found.before.levels[changed], "after": found.after.levels[changed]},
        found.limits.lowest,
        found.limits.highest,
        np.sqrt(low * high),
        heard,
    )


def _case_text(found: Optimised) -> str:
    """The case with the texture found, as a file beside its table."""
    keys = in_toml(found.case, in_memory=lambda _, value: TEXTURE)
    return toml_text({"kind": found.case.kind, **keys})


def _table(bands: TextureBands, units: str) -> tuple[list[str], list[list[float]]]:
    columns = {
        "wavelength [m]": bands.wavelength,
        "frequency [Hz]": bands.frequency,
        **{f"level {name} [dB re 1 um]": levels for name, levels in bands.levels.items()},
        "lowest [dB re 1 um]": bands.lowest,
        "highest [dB re 1 um]": bands.highest,
    }
    for law, levels in bands.heard.items():
        columns |= {f"{law} {name} [{units}]": each for name, each in levels.items()}
    return list(columns), [list(row) for row in np.stack(list(columns.values()), axis=1).tolist()]


def _trials(found: Optimised) -> tuple[list[str], list[list[object]]]:
    """Textures that the search went on from, in their order."""
    heading = ["trial", f"level [{found.measure.units}]", "lateral"]
    heading += [f"{w:.6g} m [dB re 1 um]" for w in found.after.changed_wavelength]
    rows: list[list[object]] = [
        [number, trial.level, "" if trial.lateral is None else trial.lateral, *trial.levels.tolist()]
        for number, trial in enumerate(found.trials)
    ]
    return heading, rows


def _write_page(found: Optimised, bands: TextureBands, path: Path, *, report: bool) -> None:
    laws = read_entries(spec_of(law).entry() for law in bands.heard)
    colours = {name: law.colour for name, law in laws.items()}
    chart = optimised_chart(bands, found.measure.meaning, found.measure.units, colours)
    caption = (
        "Above, the texture before and after, and what it was allowed to be; below, what is heard of it."
    )
    titles, rows = _table(bands, found.measure.units)
    numbers = ReportTable("", "Numbers", titles, [[number_cell(each) for each in row] for row in rows])
    figure = PageFigure("bands", "Texture and response in bands", caption, chart, [numbers], TABLE)
    files = {"texture (CSV)": TEXTURE, "case": CASE, "trials (CSV)": TRIALS}
    if report:
        files |= {f"report {name}": f"{name}/report.html" for name in ("before", "after")}
    summary = f"{found.sentence[:1].upper()}{found.sentence[1:]}"
    write_bytes(path, figures_page("Optimised texture", summary, [figure], files).encode())
