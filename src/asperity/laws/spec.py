"""What a contact law is: protocols, what is known of it before it is built, and what it is built from.

Nothing here imports compiled code.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping, Set
from dataclasses import dataclass, field, fields, replace
from enum import StrEnum
from typing import TYPE_CHECKING, Any, Literal, Protocol, TypeGuard, runtime_checkable

from asperity.arguments import Array, NDArray, require, shown
from asperity.errors import InputError
from asperity.parameters import Key
from asperity.schema import spectra

if TYPE_CHECKING:
    from asperity.arguments import ArrayLike as ArrayLike
    from asperity.kernels.pointforce import Prepared as Prepared
    from asperity.reduction.stiffness import ForceCurve as ForceCurve
    from asperity.reduction.stiffness import ForceTable as ForceTable
    from asperity.reduction.texture import StateTexture as StateTexture
    from asperity.surfaces.edges import Edges as Edges

Dashes = Literal["-"] | tuple[float, tuple[float, ...]]

_WORD = r"[a-z][a-z0-9]*(-[a-z0-9]+)*"


class Need(StrEnum):
    """What a law needs of a case; its materials hold nothing else for it."""

    SAMPLES = "samples"
    """Samples of the surface: the force curve and the states."""
    DATUM = "datum"
    """The datum that states count from: the force depends on where it lies."""
    FILTER = "filter"
    """The contact filter, by which the line texture has then passed."""
    AREAL = "areal"
    """The texture beside the line, averaged under the nominal patch of each state."""
    SCAN = "scan"
    """The scanned three-dimensional force of the whole path."""
    SURFACE = "surface"
    """The heights of the path beside the line, with the shape of defects."""


class Role(StrEnum):
    """What a law is to the others; one law at most has each role."""

    REFERENCE = "reference"
    """The others are held against it."""
    STAND_IN = "stand-in reference"
    """As the reference, where that is not rolled."""
    PRACTICE = spectra.PRACTICE
    """Levels are compared with it first: what TWINS and CNOSSOS-EU compute."""
    BARE = spectra.BARE
    """Levels are compared with it as well; sound power starts from it."""


@dataclass(frozen=True)
class Look:
    """How a law is drawn in every figure.

    Parameters
    ----------
    colour : str
        As ``"#0067a5"``.
    dashes : "-" or (offset, (on, off, ...))
        Of the line, in points.
    marker : str
        In the letters of matplotlib.

    Raises
    ------
    InputError
        If the colour is none.
    """

    colour: str = "#6f7a85"
    dashes: Dashes = (0, (4, 1, 1, 1, 1, 1))
    marker: str = "<"

    def __post_init__(self) -> None:
        allowed = 'six digits and letters, as "#0067a5"'
        require(
            re.fullmatch("#[0-9a-f]{6}", str(self.colour)), "colour of a law", shown(self.colour), allowed
        )


VARIANT_DASHES: Dashes = (0, (8, 1.5, 1, 1.5, 1, 1.5))


@dataclass(frozen=True)
class Variant:
    """A law that differs from another in what it is built from.

    Parameters
    ----------
    suffix : str
        Behind the name of the law and a hyphen, as ``"filtered"``.
    meaning : str
        One sentence that follows the meaning of the law.
    needs : set of Need
        All that the variant needs.
    role : Role, optional
        What it is to the others.
    look : Look, optional
        How it is drawn; else in the colour of the law, with dashes of variants.
    """

    suffix: str
    meaning: str
    needs: Set[Need]
    role: Role | None = None
    look: Look | None = None


@dataclass(frozen=True)
class LawSpec:
    """A contact law by what is known of it before it is built.

    Parameters
    ----------
    name : str
        As it stands in a case: small letters, digits and hyphens.
    meaning : str
        One sentence about its force.
    build : callable
        ``build(materials)`` returns the law, a `Law` of the name and damping in `materials`.
    needs : set of Need
        What it is built from; `Materials` refuses to hand out anything else.
    normalise : str
        How its contact filter is normalised where the case leaves it open: ``"tangent"``, or
        ``"low-wavenumber"`` as printed.
    may_pull : bool
        Whether the force may be negative, so that contact cannot be lost.
    solved_every_step : bool
        Whether each time step solves the three-dimensional contact. `asperity check` then counts these
        solutions, and an interrupted run goes on where it was: it must depend on nothing but the case.
    both_surfaces : bool
        Whether what it is built as is a `PairedLaw`, which takes the surface of what rolls beside that of the
        path. In a bearing each ball then has a law of its own; for other laws its heights are averaged.
    role : Role, optional
        What it is to the others.
    look : Look
        Colour, dashes and marker in figures.
    variants : tuple of Variant
        Laws of the same file that are built from other materials.
    parameters : mapping
        Keys of its own, made by `asperity.parameters.key`, by name: in a case they stand in a section called
        as the law, and in ``materials.parameters`` under their names.

    Raises
    ------
    InputError
        If any of it is wrong.
    """

    name: str
    meaning: str
    build: Callable[[Materials], Law]
    needs: Set[Need] = frozenset()
    normalise: Literal["tangent", "low-wavenumber"] = "tangent"
    may_pull: bool = False
    solved_every_step: bool = False
    both_surfaces: bool = False
    role: Role | None = None
    look: Look = Look()
    variants: tuple[Variant, ...] = ()
    parameters: Mapping[str, Key] = field(default_factory=dict, hash=False)

    def __post_init__(self) -> None:
        allowed = 'small letters and digits, with hyphens between words, as "my-law"'
        require(_matches(_WORD, self.name), "name of a law", shown(self.name), allowed)
        of = f"of law {self.name}"
        checks = {
            "meaning": (_matches(r"\S.*\.", self.meaning), "one line that ends with a full stop"),
            "build": (callable(self.build), "a function of the materials"),
            "normalise": (self.normalise in ("tangent", "low-wavenumber"), '"tangent" or "low-wavenumber"'),
            "parameters": (
                all(isinstance(each, Key) for each in self.parameters.values()),
                "keys of asperity.parameters.key, by name",
            ),
        }
        for name, (right, allowed) in checks.items():
            require(right, f"{name} {of}", shown(getattr(self, name)), allowed)
        object.__setattr__(self, "needs", _checked(f"needs {of}", self.needs))
        if self.variants:
            _ = self.family  # checks each of them

    @property
    def family(self) -> tuple[LawSpec, ...]:
        """The law and its variants, each by itself."""
        alone = replace(self, variants=())
        varied = (
            replace(
                alone,
                name=f"{self.name}-{each.suffix}",
                meaning=f"{self.meaning} {each.meaning}",
                needs=each.needs,
                role=each.role,
                look=each.look or replace(self.look, dashes=VARIANT_DASHES),
            )
            for each in self.variants
        )
        return alone, *varied

    @property
    def sees_heights(self) -> bool:
        """Whether it takes the rough contact as it is, with defects, not a texture averaged over a patch."""
        return bool(self.needs & {Need.SCAN, Need.SURFACE})

    @property
    def needs_areal_path(self) -> bool:
        """Whether a line is not path enough."""
        return bool(self.needs & {Need.AREAL, Need.SCAN, Need.SURFACE})

    @property
    def is_smooth(self) -> bool:
        """Whether its force is that of smooth bodies, so that no window cuts it off."""
        return not self.needs & {Need.SAMPLES, Need.SCAN, Need.SURFACE}

    def entry(self) -> Mapping[str, Any]:
        """What a result says of the law, fit for JSON."""
        of_law = {name: getattr(self, name) for name in ("name", "meaning", "may_pull")}
        return of_law | vars(self.look) | {"needs": sorted(self.needs), "role": self.role or ""}


def _matches(pattern: str, text: object) -> bool:
    return isinstance(text, str) and re.fullmatch(pattern, text) is not None


def _checked(what: str, needs: object) -> frozenset[Need]:
    """Needs as a set of `Need`, from members or their words, with what they need themselves."""
    words = ", ".join(f'"{need}"' for need in Need)
    try:
        found = frozenset(map(Need, needs))  # type: ignore[call-overload]
    except (TypeError, ValueError):
        raise InputError(what, shown(needs), f"a set of {words}") from None
    return found | {Need.SAMPLES} if found & {Need.DATUM, Need.AREAL, Need.SCAN} else found


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
    # approach, m, and stiffness, N/m, of the linear contact under the load
    working_point: tuple[float, float]
    start: float  # position of the first row of `heights`, m
    body: Array  # (nx, ny), smooth body on the contact grid, m, zero at its lowest point
    spacing: tuple[float, float]  # steps of the contact grid, (dx, dy), m
    hardness: float | None  # pressure that the softer body bears, Pa; None if it stays elastic
    rtol: float  # tolerance of a contact solution, as in `HalfSpace.solve`
    parameters: Mapping[str, Any]  # values of the law's own keys in the case, by name
    made_by: Mapping[str, Callable[[], Any]]  # what makes all others, by name
    cells: str = "whole"  # how cells at the rim of a contact count, as in `HalfSpace`
    # for contacts that are solved in every step: what tightens their solutions, and what holds those that
    # are cut off, in which a window, mm, may be told
    remedies: tuple[str, str] = ("numerics.rtol", 'contact.window = "{:.3g} mm" holds them.')
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
    def working_approach(self) -> float:
        """Approach of the linear contact under the load, m."""
        return self.working_point[0]

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
        """Heights (rows, ny) of the path with its defects, m, peaks positive, for `cells` (SURFACE)."""
        sound = self.sound_heights
        faults = self.faults
        return sound if faults is None else sound + faults

    @property
    def sound_heights(self) -> Array:
        """Heights of the path without the faults that `faults` has, m (SURFACE)."""
        return self._take("heights", Need.SURFACE)

    @property
    def faults(self) -> Array | None:
        """Heights of faults that have edges, m, on the same rows (SURFACE); None where there are none."""
        return self._take("faults", Need.SURFACE) if "faults" in self.made_by else None

    @property
    def edges(self) -> Edges | None:
        """Edges of these faults (SURFACE); None where there are none."""
        return self._take("edges", Need.SURFACE) if "edges" in self.made_by else None


@runtime_checkable
class SteppedLaw(Protocol):
    """A law on a path that is evaluated from Python, one solution of the contact at a time."""

    def evaluate(self, step: int, approach: float) -> tuple[float, float]:
        """Elastic force, N, and dF/d(approach), N/m, at a step of the path."""

    def accept(self, step: int) -> None:
        """Keep the last evaluation of this step as the start of the next."""

    def state(self) -> dict[str, NDArray[Any]]:
        """What `restore` needs to go on from here exactly."""

    def restore(self, state: dict[str, NDArray[Any]]) -> None:
        """Go on from a saved state."""

    def warn_of_flaws(self) -> None:
        """Warn of evaluations that went wrong on the way."""


class SettlingLaw(SteppedLaw, Protocol):
    """A stepped law that finds its force together with what the bodies yield to it."""

    def settle(self, step: int, approach: float, compliance: float) -> float:
        """Elastic force F, N, at `approach` − `compliance` F: approach without force, m, compliance, m/N."""


def settles(law: object) -> TypeGuard[SettlingLaw]:
    """Whether a law is a `SettlingLaw`; asked in every step, where `isinstance` would take half as long."""
    return hasattr(law, "settle")


@runtime_checkable
class Law(Protocol):
    """A contact law: contact force from approach, approach rate and position on the path."""

    @property
    def name(self) -> str:
        """Name in the registry and in results."""

    @property
    def damping(self) -> float:
        """Contact damping, N s/m."""

    def prepare(self, positions: ArrayLike) -> Prepared | SteppedLaw:
        """Lay the law out on the positions (n,) of the contact, m."""


@dataclass(frozen=True, eq=False)
class OnLaw:
    """A law laid out on another one, whose name and damping it has."""

    law: Law

    @property
    def name(self) -> str:
        """Name of the law."""
        return self.law.name

    @property
    def damping(self) -> float:
        """Contact damping, N s/m."""
        return self.law.damping


@runtime_checkable
class PairedLaw(Law, Protocol):
    """A law of a path on which something rolls whose surface it takes as well, on the same cells."""

    def prepare_pair(
        self, positions: ArrayLike, other: PairedLaw, other_positions: ArrayLike
    ) -> Prepared | SteppedLaw:
        """Lay it out on its positions (n,), m, with the same law of the other surface on those of its own."""


def from_materials(law: Callable[..., Law], **materials: str) -> Callable[[Materials], Law]:
    """Builder of a law: its fields are the materials of the same names, or of those that are named.

    A field of which there is no material keeps its default.

    Parameters
    ----------
    law : type
        A frozen dataclass, as `Shifted`.
    **materials : str
        Of fields that are called otherwise, as ``texture="line"``: their materials.

    Returns
    -------
    callable
        What `LawSpec` takes as its ``build``.
    """

    def build(of_case: Materials) -> Law:
        named = {each.name: materials.get(each.name, each.name) for each in fields(law)}  # type: ignore[arg-type]
        there = set(dir(of_case))
        return law(**{field: getattr(of_case, each) for field, each in named.items() if each in there})

    return build
