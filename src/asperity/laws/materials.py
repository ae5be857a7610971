"""What a law may be built from: the materials that a case lays ready for it."""

from __future__ import annotations

from typing import TYPE_CHECKING, Protocol

if TYPE_CHECKING:
    from asperity.arguments import Array
    from asperity.reduction.stiffness import ForceCurve
    from asperity.reduction.table import ForceTable
    from asperity.reduction.texture import StateTexture


class Materials(Protocol):
    """Materials of one law of a case, each made when it is first asked for.

    Textures are positive *away* from contact, as functions of the position of the contact, m. A material
    that a law does not say it needs (`asperity.laws.Need`) is refused.
    """

    @property
    def name(self) -> str:
        """Name of the law in the case, which the built law bears."""

    @property
    def damping(self) -> float:
        """Contact damping, N s/m."""

    @property
    def load(self) -> float:
        """Working load, N."""

    @property
    def hertz_constant(self) -> float:
        """K of F = K s^1.5 between the smooth bodies, N/m^1.5."""

    @property
    def modulus(self) -> float:
        """Contact modulus E*, Pa."""

    @property
    def working_point(self) -> tuple[float, float]:
        """Approach, m, and stiffness, N/m, of the linear contact under the working load."""

    @property
    def line(self) -> StateTexture:
        """Line texture of the path: through the contact filter where the law needs it (FILTER), else bare."""

    def line_on(self, curve: ForceCurve) -> StateTexture:
        """The line texture with its states where a curve, as that of smooth bodies, carries their forces."""

    @property
    def line_at_load(self) -> StateTexture:
        """The line texture of one state, that under the working load."""

    @property
    def curve(self) -> ForceCurve:
        """Force over approach, mean of the samples (SAMPLES)."""

    @property
    def datum(self) -> float:
        """d₀ of the state r = approach + d₀, m (DATUM)."""

    @property
    def areal(self) -> StateTexture:
        """Heights averaged by the flat-punch pressure on the patch of each state (AREAL)."""

    @property
    def plane(self) -> StateTexture:
        """Plane that the nominal patch feels under the working load (AREAL, SCAN or SURFACE)."""

    @property
    def table(self) -> ForceTable:
        """Scanned force of the path, N; its approaches count from `plane` (SCAN)."""

    @property
    def heights(self) -> Array:
        """Heights of the path with its defects, m, peaks positive, shape (rows, ny) (SURFACE)."""

    @property
    def start(self) -> float:
        """Position of the first row of `heights`, m."""

    @property
    def body(self) -> Array:
        """Shape of the smooth body on the contact grid, m, zero at its lowest point, shape (nx, ny)."""

    @property
    def spacing(self) -> tuple[float, float]:
        """Steps of the contact grid, (dx, dy), m."""

    @property
    def hardness(self) -> float | None:
        """Pressure that the softer body bears, Pa; None if it stays elastic."""

    @property
    def rtol(self) -> float:
        """Tolerance of a contact solution, as in `HalfSpace.solve`."""
