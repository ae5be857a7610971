"""`table`: the scanned three-dimensional contact itself, looked up."""

from __future__ import annotations

from dataclasses import dataclass

from asperity.laws import spec


@dataclass(frozen=True, eq=False)
class Table:
    """F = F_c(x, approach), interpolated, plus c times the approach rate in contact; never pulls.

    Along the path forces are interpolated by cubic splines, in the approach by monotone cubics of
    F^(2/3). Beyond the last state F^(2/3) goes on with its end slope.

    Parameters
    ----------
    table : ForceTable
        Scanned forces of the path.
    damping : float
        c, N s/m.
    plane : StateTexture, optional
        Plane from which the table's approaches count, m; the mean plane by default.
    """

    table: spec.ForceTable
    damping: float = 0.0
    plane: spec.StateTexture | None = None
    name: str = "table"

    def prepare(self, positions: spec.ArrayLike) -> spec.Prepared:
        """Lay the law out on positions (n,) of the contact, m."""
        from asperity.laws.layout import on_table

        return on_table(self.table, positions, damping=self.damping, plane=self.plane)


LAW = spec.LawSpec(
    "table",
    "The scanned three-dimensional contact force, looked up.",
    spec.from_materials(Table),
    {spec.Need.SAMPLES, spec.Need.SCAN},
    role=spec.Role.STAND_IN,
    look=spec.Look("#00805c", (0, (10, 1.5, 4, 1.5)), "D"),
)
