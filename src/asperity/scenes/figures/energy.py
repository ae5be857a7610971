"""Table of the energy balance."""

from __future__ import annotations

from xarray import DataTree

from asperity.reporting.data import engineering, laws, of_law, stored_variable
from asperity.reporting.tables import Cell, ReportTable, text_cell
from asperity.scenes.schema import ENERGY, ENERGY_RESIDUAL


def energy_table(tree: DataTree) -> ReportTable | None:
    """Energy balance per law, and what is left of it."""
    names = laws(tree, ENERGY)
    if not names:
        return None
    found = stored_variable(tree, ENERGY)
    assert found is not None
    terms = [str(term) for term in found["energy_term"].values]
    residual = stored_variable(tree, ENERGY_RESIDUAL)
    rows = []
    for law in names:
        energies = of_law(tree, ENERGY, law, "energy_term")
        row = [text_cell(law), *(Cell(engineering(energy, "J"), "number") for energy in energies)]
        if residual is not None:
            row.append(Cell(f"{float(of_law(tree, ENERGY_RESIDUAL, law)):.1e}", "number"))
        rows.append(row)
    note = "Energies from the start of the run-in to the end of the run."
    if residual is not None:
        note += f" Residual: {ENERGY_RESIDUAL.long_name}."
    head = ["law", *terms, *(["relative residual"] if residual is not None else [])]
    return ReportTable(
        "energy_balance",
        "Energy balance of the run",
        head,
        rows,
        note,
    )
