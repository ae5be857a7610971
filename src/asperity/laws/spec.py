"""What is known of a contact law before it is built: data, without compiled code."""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from enum import StrEnum
from typing import TYPE_CHECKING, Any, Literal

from asperity.arguments import shown
from asperity.errors import InputError
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
        if not re.fullmatch("#[0-9a-f]{6}", str(self.colour)):
            raise InputError("colour of a law", shown(self.colour), 'six digits and letters, as "#0067a5"')
        if self.marker not in MARKERS:
            raise InputError("marker of a law", shown(self.marker), " ".join(MARKERS))
        if not _are_dashes(self.dashes):
            allowed = '"-", or an offset and lengths of dashes and gaps, as (0, (6, 1.5))'
            raise InputError("dashes of a law", shown(self.dashes), allowed)


def _are_dashes(dashes: object) -> bool:
    match dashes:
        case "-":
            return True
        case (int() | float(), tuple() as lengths):
            return len(lengths) > 0 and all(isinstance(n, int | float) and n > 0 for n in lengths)
        case _:
            return False


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
    needs : frozenset of Need
        All that the variant needs.
    role : Role, optional
        What it is to the others.
    look : Look, optional
        How it is drawn; else in the colour of the law, with dashes of variants.
    """

    suffix: str
    meaning: str
    needs: frozenset[Need]
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

    Raises
    ------
    InputError
        If any of it is wrong.
    """

    name: str
    meaning: str
    build: Callable[[Materials], Law]
    needs: frozenset[Need] = frozenset()
    normalise: Literal["tangent", "low-wavenumber"] = "tangent"
    may_pull: bool = False
    solved_every_step: bool = False
    role: Role | None = None
    look: Look = Look()
    variants: tuple[Variant, ...] = ()

    def __post_init__(self) -> None:
        if not isinstance(self.name, str) or not re.fullmatch(_WORD, self.name):
            allowed = 'small letters and digits, with hyphens between words, as "my-law"'
            raise InputError("name of a law", shown(self.name), allowed)
        what = f"law {self.name}"
        if not isinstance(self.meaning, str) or not re.fullmatch(r"\S.*\.", self.meaning):
            raise InputError(f"meaning of {what}", shown(self.meaning), "one line that ends with a full stop")
        if not callable(self.build):
            raise InputError(f"build of {what}", shown(self.build), "a function of the materials")
        if self.normalise not in ("tangent", "low-wavenumber"):
            allowed = '"tangent" or "low-wavenumber"'
            raise InputError(f"normalise of {what}", shown(self.normalise), allowed)
        object.__setattr__(self, "needs", _checked(f"needs of {what}", self.needs))
        if not isinstance(self.look, Look):
            raise InputError(f"look of {what}", shown(self.look), "a Look of colour, dashes and marker")
        if self.role is not None and not isinstance(self.role, Role):
            raise InputError(f"role of {what}", shown(self.role), "None, or a Role")
        if not all(isinstance(variant, Variant) for variant in self.variants):
            raise InputError(f"variants of {what}", shown(self.variants), "a tuple of Variant")
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
        return {
            "name": self.name,
            "meaning": self.meaning,
            "colour": self.look.colour,
            "dashes": self.look.dashes,
            "marker": self.look.marker,
            "may_pull": self.may_pull,
            "needs": sorted(self.needs),
            "role": self.role or "",
        }


def _checked(what: str, needs: object) -> frozenset[Need]:
    """Needs as a set of `Need`, from members or their words, with what they need themselves."""
    words = ", ".join(f'"{need}"' for need in Need)
    try:
        found = frozenset(Need(need) for need in needs)  # type: ignore[attr-defined]
    except (TypeError, ValueError):
        raise InputError(what, shown(needs), f"a set of {words}") from None
    return found | {Need.SAMPLES} if found & {Need.DATUM, Need.AREAL, Need.SCAN} else found
