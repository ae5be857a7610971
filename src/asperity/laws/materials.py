"""What a law may be built from: the materials that a case makes for it."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Any

from asperity.errors import InputError
from asperity.laws.spec import LawSpec, Need

if TYPE_CHECKING:
    from asperity.arguments import Array
    from asperity.reduction.stiffness import ForceCurve
    from asperity.reduction.table import ForceTable
    from asperity.reduction.texture import StateTexture


@dataclass(frozen=True, eq=False)
class Materials:
    """Materials of one law of a case, each made when it is first asked for.

    Textures are positive *away* from contact, as functions of the position of the contact, m. A material
    that a law does not say it needs (`asperity.laws.Need`) is refused.
    """

    law: LawSpec
    damping: float  # contact damping, N s/m
    load: float  # working load, N
    hertz_constant: float  # K of F = K s^1.5 between the smooth bodies, N/m^1.5
    modulus: float  # contact modulus E*, Pa
    working_point: tuple[
        float, float
    ]  # approach, m, and stiffness, N/m, of the linear contact under the load
    start: float  # position of the first row of `heights`, m
    body: Array  # (nx, ny), smooth body on the contact grid, m, zero at its lowest point
    spacing: tuple[float, float]  # steps of the contact grid, (dx, dy), m
    hardness: float | None  # pressure that the softer body bears, Pa; None if it stays elastic
    rtol: float  # tolerance of a contact solution, as in `HalfSpace.solve`
    parameters: Mapping[str, Any]  # values of the law's own keys in the case, by name
    made_by: Mapping[str, Callable[[], Any]]  # what makes all others, by name
    _made: dict[str, Any] = field(default_factory=dict)

    def _take(self, material: str, *needs: Need) -> Any:
        """Make a material, or refuse it: what is planned and checked follows the needs of a law."""
        if needs and not self.law.needs & set(needs):
            wanted = " or ".join(f'"{need}"' for need in needs)
            allowed = f"materials that it needs; this one goes with {wanted}"
            raise InputError(f"materials of law {self.name}", material, allowed)
        if material not in self._made:
            self._made[material] = self.made_by[material]()
        return self._made[material]

    @property
    def name(self) -> str:
        """Name of the law in the case, which the built law bears."""
        return self.law.name

    @property
    def line(self) -> StateTexture:
        """Line texture of the path: through the contact filter where the law needs it (FILTER), else bare."""
        return self._take("line")

    def line_on(self, curve: ForceCurve) -> StateTexture:
        """The line texture with its states where a curve, as that of smooth bodies, carries their forces."""
        if "curve" not in self.made_by or Need.FILTER not in self.law.needs:
            return self.line
        return replace(self.line, approaches=curve.inverse(self._take("curve").force(self.line.approaches)))

    @property
    def line_at_load(self) -> StateTexture:
        """The line texture of one state, that under the working load."""
        return self.line.held_at(
            float(self._take("curve").inverse(self.load)) if "curve" in self.made_by else 0.0
        )

    @property
    def curve(self) -> ForceCurve:
        """Force over approach, mean of the samples (SAMPLES)."""
        return self._take("curve", Need.SAMPLES)

    @property
    def datum(self) -> float:
        """d₀ of the state r = approach + d₀, m (DATUM)."""
        return self._take("datum", Need.DATUM)

    @property
    def areal(self) -> StateTexture:
        """Heights averaged by the flat-punch pressure on the patch of each state (AREAL)."""
        return self._take("areal", Need.AREAL)

    @property
    def plane(self) -> StateTexture:
        """Plane that the nominal patch feels under the working load (AREAL, SCAN or SURFACE)."""
        return self._take("plane", Need.AREAL, Need.SCAN, Need.SURFACE)

    @property
    def table(self) -> ForceTable:
        """Scanned force of the path, N; its approaches count from `plane` (SCAN)."""
        return self._take("table", Need.SCAN)

    @property
    def heights(self) -> Array:
        """Heights of the path with its defects, m, peaks positive, shape (rows, ny) (SURFACE)."""
        return self._take("heights", Need.SURFACE)
