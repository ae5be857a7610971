"""The sound of a wheel, mode by mode."""

import numpy as np
from xarray import DataTree

from asperity.reporting import data
from asperity.reporting.tables import ReportTable, number_cells, table, text_cells
from asperity.scenes import schema
from asperity.spectra import energy_sum

LOUDEST = 10
"""Modes that have a line of their own."""


def wheel_table(tree: DataTree) -> ReportTable | None:
    """The loudest modes of the wheels by the main law, and all others together."""
    laws = data.laws(tree, schema.WHEEL_MODE_POWER_LEVEL_A)
    if not laws:
        return None
    level = np.nan_to_num(data.of_law(tree, schema.WHEEL_MODE_POWER_LEVEL_A, laws[0]), nan=-np.inf)
    frequency, damping, diameters = (
        data.values(tree, each)
        for each in (schema.WHEEL_MODE_FREQUENCY, schema.WHEEL_MODE_DAMPING, schema.WHEEL_MODE_DIAMETERS)
    )
    order = np.argsort(-level, kind="stable")
    shown, rest = order[:LOUDEST], order[LOUDEST:]
    more = [f"{len(rest)} others"] * (len(rest) > 0)
    names = [f"{frequency[k]:.0f} Hz" if frequency[k] else "rigid motion" for k in shown]
    levels = np.append(level[shown], [energy_sum(level[rest])] * (len(rest) > 0))
    share = 100.0 * 10.0 ** ((levels - energy_sum(level)) / 10.0)
    columns = {
        "mode at": text_cells(names + more),
        "nodal diameters": number_cells([*diameters[shown], *[np.nan] * len(more)], "{:.0f}"),
        "damping ratio": number_cells(
            [*np.where(frequency, damping, np.nan)[shown], *[np.nan] * len(more)], "{:.2g}"
        ),
        "dB(A)": number_cells(levels, "{:.1f}"),
        "share / %": number_cells(share, "{:.1f}"),
    }
    note = (
        f"A-weighted sound power of the wheels of all axles, dB re 1 pW, by {laws[0]}, over the bands that "
        "were computed. Frequencies are those of the wheel at rest: seen from the contact, a mode with n "
        "nodal diameters rings n times the turning speed beside it, above and below."
    )
    return table("wheel_modes_table", "The wheel, mode by mode", columns, note)
