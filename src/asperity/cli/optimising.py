"""Optimise a texture into a folder: its case, its bands as table and figure, and both runs."""

from __future__ import annotations

import io
from pathlib import Path

import numpy as np

from asperity.comma_separated import write_csv
from asperity.config.describing import in_toml
from asperity.config.writing import toml_text
from asperity.errors import InputError
from asperity.files import alone_in, refuse_unwritable, write_bytes
from asperity.kinds import report as reports
from asperity.laws import spec_of
from asperity.optimising.definition import load_assignment
from asperity.optimising.running import Optimised, optimise
from asperity.progress import progress_bar
from asperity.reporting.optimised import TextureBands, optimised_figure
from asperity.results import save
from asperity.terminal import say

TEXTURE, CASE, TABLE, FIGURE, TRIALS = (
    "texture.csv", "case.toml", "bands.csv", "bands.png", "trials.csv",
)  # fmt: skip


def optimise_into(path: Path, directory: Path, *, report: bool = True, overwrite: bool = False) -> None:
    """Find a texture and write it to a folder, with the runs before and after it.

    `overwrite` says whether a texture in the folder may be replaced, and `report` whether the runs get pages.
    """
    assignment = load_assignment(path)
    refuse_unwritable(directory, "folder of the results", "Choose another folder with -o.")
    if (directory / CASE).exists() and not overwrite:
        remedy = "Choose another folder with -o, or replace it with --overwrite."
        raise InputError(str(directory), f"a folder that holds a {CASE}", "a new folder", remedy)
    with alone_in(directory), progress_bar() as progress:
        found = optimise(assignment, progress)
        bands = texture_bands(found)
        rows = zip(found.after.wavelength.tolist(), found.after.levels.tolist(), strict=True)
        write_csv(directory / TEXTURE, ["wavelength (m)", "level (dB re 1 um)"], [list(row) for row in rows])
        write_bytes(directory / CASE, _case_text(found).encode())
        write_csv(directory / TABLE, *_table(bands, found.measure.units))
        write_csv(directory / TRIALS, *_trials(found))
        _draw(found, bands, directory / FIGURE)
        for name, tree in (("before", found.result_before), ("after", found.result_after)):
            save(tree, directory / name / "run.nc")
            if report:
                reports.report(tree, directory / name)
    say(found.sentence)
    say(f"Case:    {(directory / CASE).resolve()}")
    say(f"Figure:  {(directory / FIGURE).resolve()}, and as numbers {TABLE}")
    say(f"Runs:    {(directory / 'before').resolve()}, {(directory / 'after').resolve()}")


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


def _table(bands: TextureBands, units: str) -> tuple[list[str], list[list[object]]]:
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


def _draw(found: Optimised, bands: TextureBands, path: Path) -> None:
    colours = {law: str(spec_of(law).entry()["colour"]) for law in bands.heard}
    image = io.BytesIO()
    figure = optimised_figure(bands, found.measure.meaning, found.measure.units, colours)
    figure.savefig(image, format="png", dpi=150)
    write_bytes(path, image.getvalue())
