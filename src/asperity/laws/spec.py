"""What is known of a contact law before it is built: data, without compiled code."""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping, Set
from dataclasses import dataclass, field, replace
from enum import StrEnum
from typing import TYPE_CHECKING, Any, Literal

from asperity.arguments import require, shown
from asperity.errors import InputError
from asperity.parameters import Key
from asperity.schema import spectra

if TYPE_CHECKING:
    from asperity.laws.base import Law
    from asperity.laws.materials import Materials

Dashes = Literal["-"] | tuple[float, tuple[float, ...]]

MARKERS = ("o", "s", "^", "v", "<", ">", "D", "d", "P", "X", "p", "h", "H", "8", "*")
"""Markers that a law may have in figures, in the letters of matplotlib."""
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
        One of `MARKERS`.

    Raises
    ------
    InputError
        If they are none.
    """

    colour: str = "#6f7a85"
    dashes: Dashes = (0, (4, 1, 1, 1, 1, 1))
    marker: str = "<"

    def __post_init__(self) -> None:
        allowed = 'six digits and letters, as "#0067a5"'
        require(
            re.fullmatch("#[0-9a-f]{6}", str(self.colour)), "colour of a law", shown(self.colour), allowed
        )
        require(self.marker in MARKERS, "marker of a law", shown(self.marker), " ".join(MARKERS))
        allowed = '"-", or an offset and lengths of dashes and gaps, as (0, (6, 1.5))'
        require(_are_dashes(self.dashes), "dashes of a law", shown(self.dashes), allowed)


def _are_dashes(dashes: object) -> bool:
    match dashes:
        case (int() | float(), (_, *_) as lengths):
            return all(isinstance(length, int | float) and length > 0 for length in lengths)
    return dashes == "-"


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
            "look": (isinstance(self.look, Look), "a Look of colour, dashes and marker"),
            "role": (self.role is None or isinstance(self.role, Role), "None, or a Role"),
            "variants": (all(isinstance(each, Variant) for each in self.variants), "a tuple of Variant"),
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
        return replace(self, variants=()), *map(self._varied, self.variants)

    def _varied(self, variant: Variant) -> LawSpec:
        return replace(
            self,
            name=f"{self.name}-{variant.suffix}",
            meaning=f"{self.meaning} {variant.meaning}",
            needs=variant.needs,
            role=variant.role,
            look=variant.look or replace(self.look, dashes=VARIANT_DASHES),
            variants=(),
        )

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
