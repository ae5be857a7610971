"""`table`: the scanned three-dimensional contact itself, looked up."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from asperity.laws.base import check_damping
from asperity.laws.spec import LawSpec, Look, Need, Role

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

    from asperity.kernels.pointforce import Prepared
    from asperity.laws.materials import Materials
    from asperity.reduction.table import ForceTable
    from asperity.reduction.texture import StateTexture


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

    Raises
    ------
    InputError
        If the damping is negative.
    """

    table: ForceTable
    damping: float = 0.0
    plane: StateTexture | None = None
    name: str = "table"

    def __post_init__(self) -> None:
        check_damping(self.damping)

    def prepare(self, positions: ArrayLike) -> Prepared:
        """Lay the law out on positions (n,) of the contact, m."""
        from asperity.laws.layout import on_table

        return on_table(self.table, positions, damping=self.damping, plane=self.plane)


def _build(materials: Materials) -> Table:
    """Build the law from the materials of a case."""
    return Table(materials.table, materials.damping, plane=materials.plane, name=materials.name)


LAW = LawSpec(
    "table",
    "The scanned three-dimensional contact force, looked up.",
    _build,
    frozenset({Need.SAMPLES, Need.SCAN}),
    role=Role.STAND_IN,
    look=Look("#00805c", (0, (10, 1.5, 4, 1.5)), "D"),
)
