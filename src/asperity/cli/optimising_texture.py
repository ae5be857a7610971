"""A texture of bodies that roll that was found: its bands as a table and on a page, its levels as a file."""

from typing import Any

import numpy as np

from asperity.arguments import Array
from asperity.cli.optimising import FILES, ToldOptimisation
from asperity.laws import spec_of
from asperity.optimising.running import Optimised
from asperity.reporting import data, study_figures
from asperity.reporting.figure import PageFigure
from asperity.reporting.tables import ReportTable, number_cells, table, text_cells
from asperity.written_numbers import capital

TEXTURE = "wavelength (m)", "level (dB re 1 um)"
"""Heading of the file of levels."""


def told_texture(found: Optimised) -> ToldOptimisation:
    """What is said of a texture that was found: on the page levels before and after, and the bands."""
    columns = _columns(found)
    rows = np.stack(list(columns.values()), axis=1).tolist()
    texture = np.stack([found.after.wavelength, found.after.levels], axis=1).tolist()
    return ToldOptimisation(
        _document(found),
        rows,
        "Optimised texture",
        (_levels_table(found), _figure(found, columns)),
        {"texture": (TEXTURE, texture)},
    )


def _document(found: Optimised) -> dict[str, Any]:
    """What came of it, for programs."""
    return {
        "quantity": found.measure.meaning,
        "units": found.measure.units,
        "changes": found.changes,
        "levels": {law: list(levels) for law, levels in found.levels.items()},
        "limit": found.aim.limit,
        "missed": found.missed,
        "limits": found.active,
        "columns": list(_columns(found)),
    }


def _columns(found: Optimised) -> dict[str, Array]:
    """Numbers of the bands that were changed, by the titles of their columns."""
    changed = found.after.changed
    units = found.measure.units
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


def _figure(found: Optimised, columns: dict[str, Array]) -> PageFigure:
    """Levels of the texture before and after, and of the response, by law."""
    laws = data.read_entries(spec_of(law).entry() for law in found.changes)
    colours = {name: law.colour for name, law in laws.items()}
    parts = study_figures.optimised_figure(columns, found.measure.meaning, found.measure.units, colours)
    return PageFigure.of("bands", "Texture and response in bands", parts, FILES["table"], columns)


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
