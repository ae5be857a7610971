"""What may stand behind a key of a case: kinds of values, each with the text that explains it."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any, NoReturn, get_args

from pydantic import BaseModel, BeforeValidator, ConfigDict, Field, ValidationInfo, model_validator
from pydantic.fields import FieldInfo

from asperity.arguments import nearest, no_file, shown
from asperity.errors import InputError
from asperity.reference.materials import MATERIALS, Material
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
    "dB": ("a level", "+0 dB"),
}


LEAST, MOST = 1e-30, 1e30
"""Numbers in SI lie between these: nothing in mechanics is outside, and ten multiplied are finite."""

BACKSLASH = (
    "In double quotes a backslash changes the letter after it: write Windows paths in single quotes, as in "
    r"file = 'C:\data\beam.x3p', or with / instead."
)


@dataclass(frozen=True)
class Quantity:
    """A number with a unit, written as a string.

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

    def __call__(self, value: object) -> float:
        """Return the value in SI."""
        if isinstance(value, int | float) and not isinstance(value, bool):
            given = "dB" if self.dimension == "dB" else f"SI units ({self.dimension})"
            self._fail(value, f'Add unit and quotes: "{shown(value)} {self.dimension}" if it is in {given}.')
        if not isinstance(value, str):
            self._fail(value)
        try:
            number = quantity(value, self.dimension)
        except InputError as error:
            self._fail(value, error.remedy)
        if not math.isfinite(number) and not (self.infinite and number > 0):
            self._fail(value, "Give a finite value.")
        if math.isfinite(number) and _is_absurd(number):
            self._fail(value, f"In {self.dimension}, numbers lie between {LEAST:g} and {MOST:g}.")
        if _outside(number, self.above, self.at_least):
            self._fail(value)
        return number

    def _fail(self, value: object, remedy: str = "") -> NoReturn:
        raise InputError("quantity", shown(value), self.allowed, remedy)


@dataclass(frozen=True)
class Number:
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

    def __call__(self, value: object) -> float | int:
        """Return the number."""
        if self.infinite and value in ("inf", math.inf):
            return math.inf
        kinds = int if self.whole else int | float
        if isinstance(value, bool) or not isinstance(value, kinds):
            remedy = "Write it without quotes and unit." if isinstance(value, str) else ""
            raise InputError("number", shown(value), self.allowed, remedy)
        finite = isinstance(value, int) or math.isfinite(value)
        if not finite or _is_absurd(value) or _outside(value, self.above, self.at_least, self.at_most):
            raise InputError("number", shown(value), self.allowed)
        return value if self.whole else float(value)


class Problems(ValueError):
    """Several errors of one section, each an `InputError` about one key."""

    def __init__(self, errors: list[InputError]) -> None:
        self.errors = errors
        super().__init__("; ".join(map(str, errors)))


@dataclass(frozen=True)
class Choice:
    """One of a few words, or of those that a registry holds when it is asked."""

    words: tuple[str, ...] | Callable[[], tuple[str, ...]]

    @property
    def known(self) -> tuple[str, ...]:
        """The words."""
        return self.words() if callable(self.words) else self.words

    @property
    def allowed(self) -> str:
        """What may stand behind the key."""
        return ", ".join(f'"{word}"' for word in self.known)

    def __call__(self, value: object) -> str:
        """Return the word."""
        if not isinstance(value, str) or value not in self.known:
            raise InputError("choice", shown(value), self.allowed, nearest(value, self.known))
        return value


@dataclass(frozen=True)
class Flag:
    """Yes or no."""

    allowed = "true or false"

    def __call__(self, value: object) -> bool:
        """Return the flag."""
        if not isinstance(value, bool):
            raise InputError("flag", shown(value), self.allowed, "Write it without quotes.")
        return value


@dataclass(frozen=True)
class Text:
    """A word, as the name of an array."""

    allowed = "a text in quotes"

    def __call__(self, value: object) -> str:
        """Return the text."""
        if not isinstance(value, str) or not value.strip() or not _is_text(value):
            raise InputError("text", shown(value), self.allowed)
        return value


@dataclass(frozen=True)
class LengthUnit:
    """The unit of heights in a file that does not name it."""

    allowed = 'a unit of length, as "um"'

    def __call__(self, value: object) -> str:
        """Return the unit, once it is known to be one."""
        if not isinstance(value, str):
            raise InputError("unit", shown(value), self.allowed)
        try:
            factor(value, "m")
        except InputError as error:
            raise InputError("unit", shown(value), self.allowed, error.remedy) from None
        return value


@dataclass(frozen=True)
class File:
    """An existing file; a relative path starts at the folder of the case."""

    allowed = "the path of an existing file, relative to the case"

    def __call__(self, value: object, info: ValidationInfo) -> Path:
        """Return the path."""
        if not isinstance(value, str | Path) or "\0" in str(value) or not str(value):
            raise InputError("file", shown(value), self.allowed)
        path = Path((info.context or {}).get("folder", ".")) / value
        if reason := no_file(path):
            remedy = f"It is {reason}."
            if reason == "no such file":
                escaped = any(not character.isprintable() for character in str(value))
                remedy = BACKSLASH if escaped else f"There is no such file in {path.parent.resolve()}."
            raise InputError("file", shown(str(value)), self.allowed, remedy)
        return path


@dataclass(frozen=True)
class ChoiceOrFile:
    """One of a few words, or else an existing file."""

    words: tuple[str, ...]
    content: str

    @property
    def allowed(self) -> str:
        """What may stand behind the key."""
        return f"{Choice(self.words).allowed}, or the path of {self.content}"

    def __call__(self, value: object, info: ValidationInfo) -> str | Path:
        """Return the word or the path."""
        if value in self.words:
            return str(value)
        try:
            return File()(value, info)
        except InputError as error:
            remedy = nearest(value, self.words) or error.remedy
            raise InputError("choice", error.received, self.allowed, remedy) from None


@dataclass(frozen=True)
class MaterialOrName:
    """A named material, or one of its own by numbers."""

    @property
    def allowed(self) -> str:
        """What may stand behind the key."""
        return (
            f'{Choice(tuple(MATERIALS)).allowed}, or numbers: {{ youngs_modulus = "72 GPa", '
            'poisson_ratio = 0.33, density = "2700 kg/m^3" }'
        )

    def __call__(self, value: object) -> Material:
        """Return the material."""
        if isinstance(value, Material):
            return value
        if isinstance(value, Mapping):
            return _own_material(value)
        if not isinstance(value, str) or value not in MATERIALS:
            raise InputError("material", shown(value), self.allowed, nearest(value, tuple(MATERIALS)))
        return MATERIALS[value]


Limit = str | float
_OF_A_MATERIAL: dict[str, Quantity | Number] = {
    "youngs_modulus": Quantity("Pa", above=0),
    "poisson_ratio": Number(above=-1, at_most=0.5),
    "density": Quantity("kg/m^3", above=0),
}


_PLAUSIBLE: dict[str, tuple[Limit, Limit, str]] = {
    "youngs_modulus": ("1 kPa", "10 TPa", "solids that roll lie between"),
    "density": ("1 kg/m^3", "100000 kg/m^3", "solids that roll lie between"),
}


def _own_material(given: Mapping[Any, Any]) -> Material:
    """Material of numbers with units, and of a name if there is one; all errors at once."""
    allowed = ", ".join(("name", *_OF_A_MATERIAL))
    errors = [
        InputError(str(name), "an unknown key", allowed, nearest(name, [*_OF_A_MATERIAL]))
        for name in sorted(map(str, given.keys() - {"name", *_OF_A_MATERIAL}))
    ]
    found: dict[str, float] = {}
    for name, kind in _OF_A_MATERIAL.items():
        if name not in given:
            errors.append(InputError(name, "nothing", kind.allowed))
            continue
        try:
            found[name] = kind(given[name])
            errors += _outside_of(name, found[name], kind, _PLAUSIBLE.get(name))
        except InputError as error:
            errors.append(InputError(name, error.received, error.allowed, error.remedy))
    name = given.get("name", f"{found.get('youngs_modulus', 0.0) / 1e9:.4g} GPa")
    try:
        Text()(name)
    except InputError as error:
        errors.append(InputError("name", error.received, error.allowed))
    if errors:
        raise Problems(errors)
    return Material(name, **found, citation="given in the case")


Kind = Quantity | Number | Choice | Flag | Text | LengthUnit | File | ChoiceOrFile | MaterialOrName


def value_kind(annotation: Any, metadata: list[Any] | tuple[Any, ...] = ()) -> Kind | None:
    """Find the kind inside an annotation such as ``tuple[Length, ...] | None``."""
    for item in metadata:
        if isinstance(item, BeforeValidator) and isinstance(item.func, Kind):
            return item.func
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
    several = "tuple" in str(field.annotation)
    return f"a list, each {kind.allowed}" if several else kind.allowed


def key(
    default: Any,
    meaning: str,
    *,
    otherwise: str = "",
    example: str = "",
    goes_with: str = "",
    within: tuple[Limit, Limit, str] | None = None,
) -> Any:
    """Describe a key of a case.

    The default is as it would be written in TOML; without a fixed one it is None, `otherwise` says what
    happens without the key, and `example` how it is written. `goes_with` is the key, ``key=value``, or keys
    with " or " between them, without which this one has no meaning. `within` holds the least and the largest
    plausible value, as they are written in TOML, and the reason.
    """
    extra = {"otherwise": otherwise, "example": example, "goes_with": goes_with, "default": default}
    if within is not None:
        extra["within"] = within
    return Field(default, description=meaning, json_schema_extra=extra)


def extra_of(field: FieldInfo) -> dict[str, Any]:
    """What `key` was told beyond the default and the meaning."""
    return field.json_schema_extra if isinstance(field.json_schema_extra, dict) else {}


class Section(BaseModel):
    """A frozen section of a case: unknown keys are errors, and all errors are reported together."""

    model_config = ConfigDict(
        frozen=True, extra="forbid", validate_default=True, arbitrary_types_allowed=True
    )

    def problems(self) -> Iterator[InputError]:
        """Errors between keys that are right one by one."""
        yield from ()

    @model_validator(mode="after")
    def _is_consistent(self) -> Section:
        errors = [*_implausible(self)] or [*_lonely(self), *self.problems()]
        if errors:
            raise Problems(errors)
        return self


def is_active(section: BaseModel, name: str) -> bool:
    """Whether the key that `name` goes with is there."""
    companion, _, value = extra_of(type(section).model_fields[name]).get("goes_with", "").partition("=")
    if not companion:
        return True
    if value:
        return bool(getattr(section, companion) == value)
    return any(getattr(section, each) is not None for each in companion.split(" or "))


def _implausible(section: BaseModel) -> Iterator[InputError]:
    """Errors about numbers that no case of this field has."""
    for name, field in type(section).model_fields.items():
        given, kind = getattr(section, name), value_kind(field.annotation, field.metadata)
        for value in given if isinstance(given, tuple) else (given,):
            yield from _outside_of(name, value, kind, extra_of(field).get("within"))


def _outside_of(
    name: str, value: object, kind: Kind | None, within: tuple[Limit, Limit, str] | None
) -> Iterator[InputError]:
    """Error about a number out of its limits; zero and infinity, where they may stand, may."""
    if within is None or not isinstance(value, int | float) or value == 0.0 or value == math.inf:
        return
    low, high, reason = within
    unit = kind.dimension if isinstance(kind, Quantity) else ""
    least, most = (quantity(limit, unit) if isinstance(limit, str) else limit for limit in (low, high))
    if not least <= value <= most:
        received = written(value, unit, unit) if unit else f"{value:.4g}"
        yield InputError(name, received, f"{low} to {high}", _sentence(reason))


def _sentence(words: str) -> str:
    return f"{words[0].upper()}{words[1:]}."


def _lonely(section: BaseModel) -> Iterator[InputError]:
    for name in sorted(section.model_fields_set):
        if not is_active(section, name):
            companion, _, value = extra_of(type(section).model_fields[name])["goes_with"].partition("=")
            wanted = f'{companion} = "{value}"' if value else companion
            yield InputError(name, shown(_plain(getattr(section, name))), f"only together with {wanted}")


def _plain(value: object) -> object:
    return str(value) if isinstance(value, Path) else value


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


Length = Annotated[float, BeforeValidator(Quantity("m", above=0))]
Position = Annotated[float, BeforeValidator(Quantity("m", at_least=0))]
Approach = Annotated[float, BeforeValidator(Quantity("m"))]
Duration = Annotated[float, BeforeValidator(Quantity("s", above=0))]
DurationOrZero = Annotated[float, BeforeValidator(Quantity("s", at_least=0))]
Speed = Annotated[float, BeforeValidator(Quantity("m/s", above=0))]
Mass = Annotated[float, BeforeValidator(Quantity("kg", above=0))]
Force = Annotated[float, BeforeValidator(Quantity("N", above=0))]
Pressure = Annotated[float, BeforeValidator(Quantity("Pa", above=0))]
Frequency = Annotated[float, BeforeValidator(Quantity("Hz", above=0))]
Damping = Annotated[float, BeforeValidator(Quantity("N s/m", at_least=0))]
Level = Annotated[float, BeforeValidator(Quantity("dB"))]
LengthOrInfinite = Annotated[float, BeforeValidator(Quantity("m", above=0, infinite=True))]
Stiffness = Annotated[float, BeforeValidator(Quantity("N/m", above=0))]
OwnOrNamed = Annotated[Material, BeforeValidator(MaterialOrName())]
ExistingFile = Annotated[Path, BeforeValidator(File())]
Name = Annotated[str, BeforeValidator(Text())]
HeightUnit = Annotated[str, BeforeValidator(LengthUnit())]
YesNo = Annotated[bool, BeforeValidator(Flag())]
