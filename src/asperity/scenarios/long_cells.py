"""Cells that are two rows of the grid long, for scans of paths: where covered ones are as good so."""

from asperity.scenarios.geometry import Geometry

ENOUGH = 6.0
"""Covered cells in the half-width of a ball with which its stiffness is off by 0.4 % at most."""
ORDER, SLENDER = 1.7, 0.82
"""Powers with which that falls with the number of cells, and with the slenderness of an ellipse.

From ``benchmarks/cell_rims.py --check``.
"""
ROWS_OF_WAVE = 16
"""Rows in the shortest wave that is looked at, of which every second one holds 0.999 then."""
SMOOTH = 0.05
"""Rms height within the contact, in approaches, up to which they are taken."""


def long_cells_fit(shape: Geometry, roughness: float, wave: float) -> bool:
    """Whether half as many cells along do as well as enough in a ball, for waves from a length on, m.

    Roughness within the contact in approaches, of covered cells.
    """
    dx, dy = shape.spacing
    along, across = shape.semi_axes
    cells = min(along / (2.0 * dx), across / dy)
    missed = (ENOUGH / cells) ** ORDER * min(along / across, across / along) ** SLENDER
    return missed <= 1.0 and roughness <= SMOOTH and wave >= ROWS_OF_WAVE * dx
