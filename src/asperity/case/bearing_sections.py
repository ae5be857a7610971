"""Sections of a bearing case: its dimensions, its rings, what is on its parts all around, and faults."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import MISSING, dataclass, fields, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, ClassVar

from asperity.arguments import Array, require
from asperity.case.form import Section
from asperity.case.in_memory import Numbers, name_of
from asperity.case.named_bearing import NamedBearing
from asperity.case.table_headings import Column
from asperity.case.tables import TableFile, TableSource, read_table
from asperity.errors import InputError
from asperity.parameters import (
    FROM_PYTHON,
    LENGTH,
    MASS,
    Choice,
    File,
    Number,
    Origin,
    Quantity,
    key,
    keys_of,
    optional,
)
from asperity.reference.bearings import LISTED, LISTING, named_bearings
from asperity.structures.ball_bearing import BallBearing
from asperity.structures.rolling_bearing import PARTS
from asperity.surfaces.faults import Fault
from asperity.surfaces.raceway import AroundTexture, closed_trace

if TYPE_CHECKING:
    from asperity.structures.modal import ModalStructure
    from asperity.structures.ring import Around

_STIFFNESS = Quantity("N/m", at_least=0)
_STIFF = "1 N/m to 1 TN/m: softer holds nothing, harder is rigid"
_RATIO = Number(at_least=0, at_most=0.99)
_COUNT = Number(at_least=1, whole=True)
_RINGS = "0.1 mm to 1 m: rings lie between"
LOAD = Quantity("N", at_least=0)
LOADS = "0 N to 100 MN: bearings carry less"
DAMPED = "1e-9 N s/m to 1e9 N s/m: less damps nothing, more is rigid"
DIMENSIONS = keys_of(BallBearing, otherwise="that of the named bearing")


def _refused(made: Callable[[], object]) -> Iterator[InputError]:
    """Why something cannot be made, if so."""
    try:
        made()
    except InputError as error:
        yield error


@dataclass(frozen=True)
class _BearingName(Choice):
    """A name of the list of bearings, which is too long to stand in a message."""

    words: tuple[str, ...] = tuple(LISTED)

    @property
    def allowed(self) -> str:
        """What may stand behind the key."""
        return f"one of {len(self.words)} names: {LISTING}"

    def __call__(self, value: object, origin: Origin = FROM_PYTHON) -> str:
        """Return the name."""
        if not isinstance(value, str) or value not in self.words:
            self.refuse(value, named_bearings(value))
        return value


class BearingGeometry(NamedBearing, parameters=DIMENSIONS):
    """A ball bearing, named or by its dimensions."""

    MODEL = BallBearing
    DIMENSIONS = DIMENSIONS
    NEEDED = ("balls", "ball_diameter", "pitch_diameter")
    ALTERNATIVES = (("clearance", "contact_angle"),)

    name: str | None = optional(_BearingName(), "6205", "named bearing", "the dimensions are given")

    if TYPE_CHECKING:

        @property
        def bearing(self) -> BallBearing:
            """The bearing."""

    @classmethod
    def names_in_words(cls) -> str:
        """How many names there are, and which command lists them."""
        return named_bearings()


class ShaftKeys(Section):
    """What a ring carries, and what holds it."""

    mass: float = key(
        MASS, "1 kg", "mass of the ring with all that moves with it", "1 mg to 1000 t: what bearings carry"
    )
    radial_stiffness: float = key(_STIFFNESS, "100 MN/m", "spring that holds it radially; 0 for none", _STIFF)
    axial_stiffness: float = key(_STIFFNESS, "100 MN/m", "spring that holds it axially; 0 for none", _STIFF)
    damping_ratio: float = key(_RATIO, 0.02, "damping ratio on these springs, and of its lobes")
    modes: Path | ModalStructure | None = optional(
        File(held=(Numbers,), content="a table of modes over the angle"),
        "around.csv",
        "modes in which the ring bends, with what holds it: radially, once around",
        "it is rigid, but for its lobes",
    )

    def bending(self, contact_angle: float) -> Around | None:
        """The ring by its modes, where it has any."""
        from asperity.structures.modal import ModalStructure
        from asperity.structures.modal_files import read_modal_structure
        from asperity.structures.ring import Around

        found = self.modes
        if found is None:
            return None
        if isinstance(found, Path):
            found = read_modal_structure(found, around=True)
        known = isinstance(found, ModalStructure)
        require(known, "modes", name_of(found), "a file, or an asperity.ModalStructure over angles in rad")
        remedy = "Leave out rigid modes, which mass and springs make."
        require(found.frequencies.all(), "modes", "one of 0 Hz", "modes that bend", remedy)
        return Around(found, contact_angle)

    def problems(self) -> Iterator[InputError]:
        """Modes that can be read, and close."""
        try:
            self.bending(0.0)
        except InputError as error:
            about = "" if error.what == "modes" else f" ({error.what})"
            yield error.about("modes", f"{error.received}{about}")


class HousingKeys(ShaftKeys):
    """The same of the outer ring, which may bend by its section."""

    ALTERNATIVES = (("lobes", "modes"),)

    lobes: int | None = optional(
        Number(at_least=2, at_most=20, whole=True), 4, "most lobes in which the ring bends", "it is rigid"
    )
    width: float = key(LENGTH, "15 mm", "width of its section", _RINGS, goes_with="lobes")
    thickness: float = key(LENGTH, "3 mm", "thickness of its section", _RINGS, goes_with="lobes")


def read_roundness(table: TableSource) -> Array:
    """Read a roundness trace (n, 2), rad and m, over one turn that closes."""
    rows = read_table(table, (Column("angle", "rad"), Column("deviation", "m")))
    closed_trace(rows)
    return rows


def _keys_of(model: Any) -> dict[str, Any]:
    """Keys of what a dataclass declares: where the class has a default, it is their example."""
    fixed = {field.name for field in fields(model) if field.default not in (None, MISSING, ())}
    return {
        name: replace(key, default=key.example, otherwise="") if name in fixed else key
        for name, key in keys_of(model, otherwise="none").items()
    }


_AROUND = _keys_of(AroundTexture)
_TRACE = TableFile(columns=(2,), content="a table of angle and deviation", read=read_roundness)


def _values(section: Section) -> dict[str, Any]:
    return {name: value for name in section.keys if (value := getattr(section, name)) is not None}


class AroundKeys(Section, parameters=_AROUND | {"trace": replace(_AROUND["trace"], kind=_TRACE)}):
    """What is on a raceway or on the balls all around."""

    if TYPE_CHECKING:
        trace: Path | Array | None

    def texture(self) -> AroundTexture:
        """It, with what its files hold."""
        given = _values(self)
        if self.trace is not None:
            given["trace"] = read_roundness(self.trace)
        return AroundTexture(**given)

    def problems(self) -> Iterator[InputError]:
        """Waves with their amplitudes, one texture of each sort."""
        yield from _refused(self.texture)


class FaultKeys(Section, parameters=_keys_of(Fault)):
    """One fault of a raceway or of a ball, or several alike around it."""

    ABSENT_WITHOUT: ClassVar = "on"
    ELEMENT: ClassVar = "ball"
    """What may have it beside the raceways."""

    on: str | None = optional(Choice(PARTS), "outer", "part that has it", "no fault")
    ball: int = key(
        _COUNT, 1, "ball that has it, by number", "1 to 500: balls are fewer", goes_with="on=ball"
    )

    @property
    def part(self) -> str | None:
        """Part that has it, of `PARTS`: what rolls is the ball."""
        return "ball" if self.on == self.ELEMENT else self.on

    @property
    def number(self) -> int:
        """Number of the ball or roller that has it."""
        return int(getattr(self, self.ELEMENT))

    @property
    def fault(self) -> Fault | None:
        """The fault, if there is one."""
        given = _values(self)
        del given[self.ELEMENT]
        return Fault(**given) if given.pop("on", None) else None

    def lies_on(self, part: str, number: int) -> bool:
        """Whether a raceway has it, or the ball or roller of a number."""
        return self.part == part and (part != "ball" or self.number == number)

    def problems(self) -> Iterator[InputError]:
        """All that a fault of its shape has, and a part that has it."""
        if self.on is None and self.given():
            allowed = self.keys["on"].kind.allowed
            yield InputError("on", "nothing", allowed, "Say which part has the fault.")
        yield from _refused(lambda: self.fault)


class RollerFaultKeys(FaultKeys):
    """One fault of a raceway or of a roller, or several alike around it."""

    ELEMENT = "roller"
    RENAMED: ClassVar = {"ball": "roller"}

    on: str | None = optional(Choice(("outer", "inner", "roller")), "outer", "part that has it", "no fault")
    roller: int = key(
        _COUNT, 1, "roller that has it, by number", "1 to 500: rollers are fewer", goes_with="on=roller"
    )

    @classmethod
    def prepared(cls, given: Mapping[str, Any]) -> Mapping[str, Any]:
        """A roller that is called a ball, as what rolls is in results."""
        return {**given, "on": "roller"} if given.get("on") == "ball" else given
