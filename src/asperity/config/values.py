"""What may stand behind a key of a case: kinds of values, each with the text that explains it."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Annotated, Any, NoReturn, get_args, get_origin

import numpy as np
from numpy.typing import NDArray
from pydantic import GetCoreSchemaHandler, ValidationInfo
from pydantic.fields import FieldInfo
from pydantic_core import CoreSchema, core_schema

from asperity.arguments import nearest, no_file, shown
from asperity.errors import InputError
from asperity.reference.materials import MATERIALS, Material
from asperity.surfaces.heightmap import HeightMap, Profile
from asperity.units import factor, quantity, written

_WORDS = {
    "m": ("a length", "25 mm"),
    "s": ("a time", "0.5 s"),
    "m/s": ("a speed", "1 m/s"),
    "kg": ("a mass", "0.5 kg"),
    "N": ("a force", "5 N"),
    "Pa": ("a pressure", "3 GPa"),
    "kg/m^3": ("a density", "2700 kg/m^3"),
    "Hz": ("a frequency", "5 kHz"),
    "N s/m": ("a damping constant", "10 N s/m"),
    "N/m": ("a stiffness", "300 MN/m"),
    "N m^2": ("a bending stiffness", "4.7 MN m^2"),
    "kg/m": ("a mass per length", "60 kg/m"),
    "kg m": ("a rotary inertia per length", "0.24 kg m"),
    "kg m^2": ("a moment of inertia", "1500 kg m^2"),
    "dB": ("a level", "+0 dB"),
    "rad": ("an angle", "30 deg"),
}


LEAST, MOST = 1e-30, 1e30
"""Numbers in SI lie between these: nothing in mechanics is outside, and ten multiplied are finite."""

BACKSLASH = (
    "In double quotes a backslash changes the letter after it: write Windows paths in single quotes, as in "
    r"file = 'C:\data\beam.x3p', or with / instead."
)


def needs_units(info: ValidationInfo | None) -> bool:
    """Whether quantities must carry their units, as in a file; from Python they may be numbers in SI."""
    return bool(info is not None and (info.context or {}).get("units"))


class ValueKind:
    """A kind of value, as `Quantity`: it reads what stands behind a key, or raises an `InputError`."""

    is_whole = False  # whether nothing is left to check of what it returns

    @property
    def allowed(self) -> str:
        """What may stand behind the key."""
        raise NotImplementedError

    def __call__(self, value: Any, info: ValidationInfo | None = None) -> Any:
        """Return the value in SI."""
        raise NotImplementedError

    def __get_pydantic_core_schema__(self, source: Any, handler: GetCoreSchemaHandler) -> CoreSchema:
        if self.is_whole:
            return core_schema.with_info_plain_validator_function(self)
        return core_schema.with_info_before_validator_function(self, handler(source))


@dataclass(frozen=True)
class Quantity(ValueKind):
    """A number with a unit, written as a string; from Python also a number in SI.

    Parameters
    ----------
    dimension : str
        The SI unit of the value behind the door.
    above : float, optional
        The value must be greater than this.
    at_least : float, optional
        The value must not be less than this.
    infinite : bool
        Whether "inf" is a value, too.
    """

    dimension: str
    above: float | None = None
    at_least: float | None = None
    infinite: bool = False

    @property
    def allowed(self) -> str:
        """What may stand behind the key."""
        word, example = _WORDS[self.dimension]
        infinite = ', or "inf"' if self.infinite else ""
        return f'{word}{_range(self.above, self.at_least)}{infinite}, with its unit, as "{example}"'

    def __call__(self, value: object, info: ValidationInfo | None = None) -> float:
        """Return the value in SI."""
        number = self._number(value.item() if isinstance(value, np.generic) else value, info)
        if not math.isfinite(number) and not (self.infinite and number > 0):
            self._fail(value, "Give a finite value.")
        if math.isfinite(number) and _is_absurd(number):
            self._fail(value, f"In {self.dimension}, numbers lie between {LEAST:g} and {MOST:g}.")
        if _outside(number, self.above, self.at_least):
            self._fail(value)
        return number

    def _number(self, value: object, info: ValidationInfo | None) -> float:
        if isinstance(value, int | float) and not isinstance(value, bool):
            if not needs_units(info) and not (isinstance(value, int) and abs(value) > MOST):
                return float(value)
            if not needs_units(info):
                self._fail("a huge number")
            given = "dB" if self.dimension == "dB" else f"SI units ({self.dimension})"
            self._fail(value, f'Add unit and quotes: "{shown(value)} {self.dimension}" if it is in {given}.')
        if not isinstance(value, str):
            self._fail(value)
        try:
            return quantity(value, self.dimension)
        except InputError as error:
            self._fail(value, error.remedy)

    def _fail(self, value: object, remedy: str = "") -> NoReturn:
        raise InputError("quantity", shown(value), self.allowed, remedy)


@dataclass(frozen=True)
class Chosen(Quantity):
    """A quantity that is chosen where nothing is given: it is not a number until then."""

    def __call__(self, value: object, info: ValidationInfo | None = None) -> float:
        """Return the value in SI; NaN for nothing."""
        return math.nan if value is None else super().__call__(value, info)


@dataclass(frozen=True)
class Number(ValueKind):
    """A pure number."""

    above: float | None = None
    at_least: float | None = None
    at_most: float | None = None
    whole: bool = False
    infinite: bool = False  # "inf" is a value, too

    @property
    def allowed(self) -> str:
        """What may stand behind the key."""
        limits = _range(self.above, self.at_least, self.at_most)
        return ("a whole number" if self.whole else "a number") + limits + (', or "inf"' * self.infinite)

    def __call__(self, value: object, info: ValidationInfo | None = None) -> float | int:
        """Return the number."""
        value = value.item() if isinstance(value, np.generic) else value
        if self.infinite and isinstance(value, str | float) and value in ("inf", math.inf):
            return math.inf
        kinds = int if self.whole else int | float
        if isinstance(value, bool) or not isinstance(value, kinds):
            remedy = "Write it without quotes and unit." if isinstance(value, str) else ""
            raise InputError("number", shown(value), self.allowed, remedy)
        finite = isinstance(value, int) or math.isfinite(value)
        if not finite or _is_absurd(value) or _outside(value, self.above, self.at_least, self.at_most):
            raise InputError("number", shown(value), self.allowed)
        return value if self.whole else float(value)


@dataclass(frozen=True)
class NumberOrWord(ValueKind):
    """A pure number, or one word."""

    number: Number
    word: str

    @property
    def allowed(self) -> str:
        """What may stand behind the key."""
        return f'{self.number.allowed}, or "{self.word}"'

    def __call__(self, value: object, info: ValidationInfo | None = None) -> float | int | str:
        """Return the number or the word."""
        if isinstance(value, str) and value == self.word:
            return value
        try:
            return self.number(value)
        except InputError as error:
            remedy = nearest(value, (self.word,)) or error.remedy
            raise InputError("number", error.received, self.allowed, remedy) from None


class Problems(ValueError):
    """Several errors of one section, each an `InputError` about one key."""

    def __init__(self, errors: list[InputError]) -> None:
        self.errors = errors
        super().__init__("; ".join(map(str, errors)))


@dataclass(frozen=True)
class Choice(ValueKind):
    """One of a few words, or of those that a registry holds when it is asked."""

    words: tuple[str, ...] | Callable[[], tuple[str, ...]]
    numbers: tuple[int, ...] = ()  # that mean the words, one each

    @property
    def known(self) -> tuple[str, ...]:
        """The words."""
        return self.words() if callable(self.words) else self.words

    @property
    def allowed(self) -> str:
        """What may stand behind the key."""
        return ", ".join(f'"{word}"' for word in self.known)

    def __call__(self, value: object, info: ValidationInfo | None = None) -> str:
        """Return the word."""
        if isinstance(value, int) and not isinstance(value, bool) and value in self.numbers:
            return self.known[self.numbers.index(value)]
        if not isinstance(value, str) or value not in self.known:
            raise InputError("choice", shown(value), self.allowed, nearest(value, self.known))
        return value


@dataclass(frozen=True)
class Flag(ValueKind):
    """Yes or no."""

    allowed = "true or false"

    def __call__(self, value: object, info: ValidationInfo | None = None) -> bool:
        """Return the flag."""
        if not isinstance(value, bool):
            raise InputError("flag", shown(value), self.allowed, "Write it without quotes.")
        return value


@dataclass(frozen=True)
class Text(ValueKind):
    """A word, as the name of an array."""

    allowed = "a text in quotes"

    def __call__(self, value: object, info: ValidationInfo | None = None) -> str:
        """Return the text."""
        if not isinstance(value, str) or not value.strip() or not _is_text(value):
            raise InputError("text", shown(value), self.allowed)
        return value


@dataclass(frozen=True)
class LengthUnit(ValueKind):
    """The unit of heights in a file that does not name it."""

    allowed = 'a unit of length, as "um"'

    def __call__(self, value: object, info: ValidationInfo | None = None) -> str:
        """Return the unit, once it is known to be one."""
        if not isinstance(value, str):
            raise InputError("unit", shown(value), self.allowed)
        try:
            factor(value, "m")
        except InputError as error:
            raise InputError("unit", shown(value), self.allowed, error.remedy) from None
        return value


@dataclass(frozen=True)
class File(ValueKind):
    """An existing file, whose path starts at the folder of the case; from Python also what it would hold.

    Parameters
    ----------
    held : tuple of types
        Surfaces that may stand in its place.
    columns : int
        Number of columns of an array that may stand in its place; 0 for none.
    further : int
        How many columns more such an array may have.
    """

    held: tuple[type, ...] = ()
    columns: int = 0
    further: int = 0
    is_whole = True

    @property
    def allowed(self) -> str:
        """What may stand behind the key."""
        return "the path of an existing file, relative to the case"

    def __call__(self, value: object, info: ValidationInfo | None = None) -> Any:
        """Return the path, absolute, or what stands in its place."""
        if self.held and isinstance(value, self.held):
            return value
        several = isinstance(value, list | tuple) and len(value) > 0
        if HeightMap in self.held and several and all(isinstance(each, HeightMap) for each in value):  # type: ignore[attr-defined]
            return tuple(value)  # type: ignore[arg-type]
        if self.columns and isinstance(value, np.ndarray):
            return self._table(value)
        return self._path(value, info)

    def _table(self, value: NDArray[Any]) -> NDArray[np.float64]:
        counts = sorted({self.columns, self.columns + self.further})
        if value.ndim != 2 or value.shape[1] not in counts or value.dtype.kind not in "fiu":
            shapes = " or ".join(f"(n, {count})" for count in counts)
            allowed = f"an array of shape {shapes} of real numbers in SI"
            raise InputError("table", shown(value), allowed)
        table = np.array(value, dtype=np.float64, order="C")
        table.flags.writeable = False
        return table

    def _path(self, value: object, info: ValidationInfo | None) -> Path:
        if not isinstance(value, str | Path) or "\0" in str(value) or not str(value):
            held = "" if needs_units(info) else "".join(f", or a {each.__name__}" for each in self.held)
            raise InputError("file", shown(value), self.allowed + held)
        path = (Path(((info and info.context) or {}).get("folder", ".")) / value).absolute()
        if reason := no_file(path):
            remedy = f"It is {reason}."
            if reason == "no such file":
                escaped = any(not character.isprintable() for character in str(value))
                remedy = BACKSLASH if escaped else f"There is no such file in {path.parent.resolve()}."
            raise InputError("file", shown(str(value)), self.allowed, remedy)
        return path


@dataclass(frozen=True)
class ChoiceOrFile(ValueKind):
    """One of a few words, or else an existing file."""

    words: tuple[str, ...]
    content: str
    columns: int = 0  # of an array that Python may hand over
    is_whole = True

    @property
    def allowed(self) -> str:
        """What may stand behind the key."""
        return f"{Choice(self.words).allowed}, or the path of {self.content}"

    def __call__(self, value: object, info: ValidationInfo | None = None) -> Any:
        """Return the word, the path or the array."""
        if isinstance(value, str) and value in self.words:
            return value
        try:
            return File(columns=self.columns)(value, info)
        except InputError as error:
            remedy = nearest(value, self.words) or error.remedy
            raise InputError("choice", error.received, self.allowed, remedy) from None


@dataclass(frozen=True)
class MaterialOrName(ValueKind):
    """A named material, or one of its own by numbers."""

    @property
    def allowed(self) -> str:
        """What may stand behind the key."""
        return (
            f'{Choice(tuple(MATERIALS)).allowed}, or numbers: {{ youngs_modulus = "72 GPa", '
            'poisson_ratio = 0.33, density = "2700 kg/m^3" }'
        )

    def __call__(self, value: object, info: ValidationInfo | None = None) -> Material:
        """Return the material."""
        if isinstance(value, Material):
            known = MATERIALS.get(value.name) == value
            return value if known else _own_material({k: v for k, v in asdict(value).items() if v}, None)
        if isinstance(value, Mapping):
            return _own_material(value, info)
        if not isinstance(value, str) or value not in MATERIALS:
            raise InputError("material", shown(value), self.allowed, nearest(value, tuple(MATERIALS)))
        return MATERIALS[value]


_OF_A_MATERIAL: dict[str, Quantity | Number] = {
    "youngs_modulus": Quantity("Pa", above=0),
    "poisson_ratio": Number(above=-1, at_most=0.5),
    "density": Quantity("kg/m^3", above=0),
}


_PLAUSIBLE: dict[str, tuple[str, str, str]] = {
    "youngs_modulus": ("1 kPa", "10 TPa", "solids that roll lie between"),
    "density": ("1 kg/m^3", "100000 kg/m^3", "solids that roll lie between"),
}


GIVEN = "given in the case"
"""Source of a material that states none."""


def name_of_numbers(youngs_modulus: float) -> str:
    """Name of a material that states none."""
    return f"{youngs_modulus / 1e9:.4g} GPa"


def _own_material(given: Mapping[Any, Any], info: ValidationInfo | None) -> Material:
    """Material of numbers with units, and of a name and a source if there are; all errors at once."""
    allowed = ", ".join(("name", *_OF_A_MATERIAL, "citation"))
    errors = [
        InputError(str(name), "an unknown key", allowed, nearest(name, [*_OF_A_MATERIAL]))
        for name in sorted(map(str, given.keys() - {"name", "citation", *_OF_A_MATERIAL}))
    ]
    found: dict[str, float] = {}
    for name, kind in _OF_A_MATERIAL.items():
        if name not in given:
            errors.append(InputError(name, "nothing", kind.allowed))
            continue
        try:
            value = given[name]
            found[name] = kind(value, info)
            errors += outside_limits(name, found[name], kind, _PLAUSIBLE.get(name))
        except InputError as error:
            errors.append(InputError(name, error.received, error.allowed, error.remedy))
    words = {"name": name_of_numbers(found.get("youngs_modulus", 0.0)), "citation": GIVEN}
    for name in words.keys() & given.keys():
        try:
            words[name] = Text()(given[name])
        except InputError as error:
            errors.append(InputError(name, error.received, error.allowed))
    if errors:
        raise Problems(errors)
    return Material(words["name"], **found, citation=words["citation"])


def value_kind(annotation: Any, metadata: list[Any] | tuple[Any, ...] = ()) -> ValueKind | None:
    """Find the kind inside an annotation such as ``tuple[Length, ...] | None``."""
    for item in metadata:
        if isinstance(item, ValueKind):
            return item
    for inner in get_args(annotation):
        found = value_kind(inner, getattr(annotation, "__metadata__", ()))
        if found is not None:
            return found
    return None


def allowed_in(field: FieldInfo) -> str:
    """What may stand behind a key, in words."""
    kind = value_kind(field.annotation, field.metadata)
    if kind is None:
        return "a section"
    return f"a list, each {kind.allowed}" if is_list(field.annotation) else kind.allowed


def is_list(annotation: Any) -> bool:
    """Whether a key takes a list of values, as ``tuple[Length, ...] | None`` does."""
    return any(get_origin(each) is tuple for each in (annotation, *get_args(annotation)))


def outside_limits(
    name: str, value: object, kind: ValueKind | None, within: tuple[str, str, str] | None
) -> Iterator[InputError]:
    """Error about a number out of its limits; zero, infinity and NaN, where they may stand, may."""
    if within is None or not isinstance(value, int | float) or value in (0.0, math.inf) or value != value:
        return
    low, high, reason = within
    unit = kind.dimension if isinstance(kind, Quantity) else ""
    least, most = (quantity(limit, unit) if unit else float(limit) for limit in (low, high))
    if not least <= value <= most:
        received = written(value, unit, unit) if unit else f"{value:.4g}"
        yield InputError(name, received, f"{low} to {high}", _sentence(reason))


def _sentence(words: str) -> str:
    return f"{words[0].upper()}{words[1:]}."


def _is_text(value: str) -> bool:
    """Whether files can hold a text: no null character, no half of one."""
    return "\0" not in value and not any("\ud800" <= character <= "\udfff" for character in value)


def _is_absurd(value: float) -> bool:
    """Whether a number is so large or small that its products are not finite."""
    return value != 0 and not LEAST <= abs(value) <= MOST


def _outside(value: float, above: float | None, at_least: float | None, at_most: float | None = None) -> bool:
    return (
        (above is not None and value <= above)
        or (at_least is not None and value < at_least)
        or (at_most is not None and value > at_most)
    )


def _range(above: float | None, at_least: float | None, at_most: float | None = None) -> str:
    limits = []
    if above is not None:
        limits.append(f"greater than {above}")
    if at_least is not None:
        limits.append(f"at least {at_least}")
    if at_most is not None:
        limits.append(f"at most {at_most}")
    return " " + " and ".join(limits) if limits else ""


Length = Annotated[float, Quantity("m", above=0)]
ChosenLength = Annotated[float, Chosen("m", above=0)]
Position = Annotated[float, Quantity("m", at_least=0)]
Approach = Annotated[float, Quantity("m")]
Duration = Annotated[float, Quantity("s", above=0)]
DurationOrZero = Annotated[float, Quantity("s", at_least=0)]
Speed = Annotated[float, Quantity("m/s", above=0)]
Mass = Annotated[float, Quantity("kg", above=0)]
Force = Annotated[float, Quantity("N", above=0)]
Pressure = Annotated[float, Quantity("Pa", above=0)]
Frequency = Annotated[float, Quantity("Hz", above=0)]
Damping = Annotated[float, Quantity("N s/m", at_least=0)]
Level = Annotated[float, Quantity("dB")]
Angle = Annotated[float, Quantity("rad")]
LengthOrInfinite = Annotated[float, Quantity("m", above=0, infinite=True)]
Stiffness = Annotated[float, Quantity("N/m", above=0)]
OwnOrNamed = Annotated[Material, MaterialOrName()]
MapFile = Annotated[Path | HeightMap | tuple[HeightMap, ...], File(held=(HeightMap,))]
LineFile = Annotated[Path | HeightMap | Profile, File(held=(HeightMap, Profile))]
SectionFile = Annotated[Path | Profile, File(held=(Profile,))]
Name = Annotated[str, Text()]
HeightUnit = Annotated[str, LengthUnit()]
YesNo = Annotated[bool, Flag()]
