"""A parameter, declared once: kind of value, default, meaning, limits; cases and forms follow from it."""

import math
import re
from collections.abc import Callable, Iterator, Mapping
from dataclasses import MISSING, asdict, dataclass, field, fields, replace
from functools import cache, cached_property
from itertools import pairwise
from pathlib import Path
from typing import Any, NoReturn

import numpy as np

from asperity.arguments import Array, NDArray, nearest, no_file, shown
from asperity.errors import InputError
from asperity.reference.materials import MATERIALS, Material, solid
from asperity.text_files import BACKSLASH
from asperity.units import IN_WORDS, factor, limits_in, quantity, written
from asperity.written_numbers import count_of, rounded

_MEANT = {"rad": "deg", "m/s": "km/h"}
"""Units that people leave out as often as the SI unit."""

LEAST, MOST = 1e-30, 1e30
"""Numbers in SI lie between these: nothing in mechanics is outside, and ten multiplied are finite."""


@dataclass(frozen=True)
class Origin:
    """Where keys and values come from.

    Attributes
    ----------
    source : str
        Its name, for messages.
    folder : Path
        Where relative paths start.
    units : bool
        Whether quantities must carry their units, as in a file; from Python they may be numbers in SI.
    """

    source: str = "case"
    folder: Path = Path()
    units: bool = False

    @classmethod
    def file(cls, path: object) -> "Origin":
        """Origin of what stands in a file."""
        return cls(str(path), Path(str(path)).parent, units=True)


FROM_PYTHON = Origin()


class Problems(ValueError):
    """Several errors of one value, each an `InputError` about one key of it."""

    def __init__(self, errors: list[InputError]) -> None:
        self.errors = errors
        super().__init__("; ".join(map(str, errors)))


class ValueKind:
    """A kind of value, as `Quantity`: called with what stands behind a key, it returns the value in SI."""

    @property
    def allowed(self) -> str:
        """What may stand behind the key."""
        raise NotImplementedError

    def __call__(self, value: Any, origin: Origin = FROM_PYTHON) -> Any:
        """Return the value in SI, or raise an `InputError`."""
        raise NotImplementedError

    def refuse(self, value: object, remedy: str = "") -> NoReturn:
        """Say that a value is none of this kind."""
        raise InputError("value", shown(value), self.allowed, remedy)


@dataclass(frozen=True, kw_only=True)
class Bounded(ValueKind):
    """A number within bounds: greater than one, not less and not more than another; perhaps also "inf"."""

    above: float | None = None
    at_least: float | None = None
    at_most: float | None = None
    infinite: bool = False

    def holds(self, value: float) -> bool:
        """Whether a number lies within them, and its products with others are finite."""
        usual = value == 0 or LEAST <= abs(value) <= MOST or (self.infinite and value == math.inf)
        return usual and not (
            (self.above is not None and value <= self.above)
            or (self.at_least is not None and value < self.at_least)
            or (self.at_most is not None and value > self.at_most)
        )

    @property
    def bounds(self) -> str:
        """They in words, a blank before them."""
        named = {"greater than": self.above, "at least": self.at_least, "at most": self.at_most}
        words = " and ".join(f"{word} {limit}" for word, limit in named.items() if limit is not None)
        return f" {words}" * bool(words) + ', or "inf"' * self.infinite


@dataclass(frozen=True)
class Quantity(Bounded):
    """A number with a unit, written as a string; from Python also a number in SI.

    Parameters
    ----------
    dimension : str
        The SI unit of the value behind the door.
    meant : str
        Unit that people mean by a bare number where that is another one, as 1/min of what turns.
    """

    dimension: str
    meant: str = ""

    @property
    def allowed(self) -> str:
        """What may stand behind the key."""
        word, example = IN_WORDS[self.dimension]
        if self.meant:
            example = f"1800 {self.meant}"
        return f'{word}{self.bounds}, with its unit, as "{example}"'

    def __call__(self, value: object, origin: Origin = FROM_PYTHON) -> float:
        """Return the value in SI."""
        number = self._number(value.item() if isinstance(value, np.generic) else value, origin)
        if self.holds(number):
            return number
        remedy = ""
        if not math.isfinite(number):
            remedy = "Give a finite value."
        elif number and not LEAST <= abs(number) <= MOST:
            lie = f"between {rounded(LEAST)} and {rounded(MOST)}"
            remedy = f"In {self.dimension}, numbers lie {lie}."
        self.refuse(value, remedy)

    def _number(self, value: object, origin: Origin) -> float:
        if isinstance(value, int | float) and not isinstance(value, bool):
            if origin.units:
                given = "dB" if self.dimension == "dB" else f"SI units ({self.dimension})"
                remedy = f'Add unit and quotes: "{shown(value)} {self.dimension}" if it is in {given}.'
                if meant := self.meant or _MEANT.get(self.dimension):
                    remedy = f'{remedy[:-1]}, "{shown(value)} {meant}" if in that unit.'
                self.refuse(value, remedy)
            if isinstance(value, int) and abs(value) > MOST:
                raise InputError("value", "a huge number", self.allowed)
            return float(value)
        if not isinstance(value, str):
            self.refuse(value)
        try:
            return quantity(value, self.dimension)
        except InputError as error:
            self.refuse(value, error.remedy)


LENGTH = Quantity("m", above=0)
LENGTH_OR_ZERO = Quantity("m", at_least=0)
ANGLE = Quantity("rad")
MASS = Quantity("kg", above=0)
FORCE = Quantity("N", above=0)
PRESSURE = Quantity("Pa", above=0)
STIFFNESS = Quantity("N/m", above=0)
DAMPING = Quantity("N s/m", at_least=0)
FREQUENCY = Quantity("Hz", above=0)
DURATION = Quantity("s", above=0)
DURATION_OR_ZERO = Quantity("s", at_least=0)


@dataclass(frozen=True)
class Number(Bounded):
    """A pure number."""

    whole: bool = False

    @property
    def allowed(self) -> str:
        """What may stand behind the key."""
        return f"a {'whole ' * self.whole}number{self.bounds}"

    def __call__(self, value: Any, origin: Origin = FROM_PYTHON) -> float | int:
        """Return the number."""
        value = value.item() if isinstance(value, np.generic) else value
        if self.infinite and isinstance(value, str | float) and value in ("inf", math.inf):
            return math.inf
        if isinstance(value, bool) or not isinstance(value, int if self.whole else int | float):
            self.refuse(value, "Write it without quotes and unit." if isinstance(value, str) else "")
        if not self.holds(value):
            self.refuse(value)
        return value if self.whole else float(value)


@dataclass(frozen=True)
class Choice(ValueKind):
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

    def __call__(self, value: object, origin: Origin = FROM_PYTHON) -> str:
        """Return the word."""
        words = self.known
        if not isinstance(value, str) or value not in words:
            self.refuse(value, nearest(value, words))
        return value


@dataclass(frozen=True)
class Flag(ValueKind):
    """Yes or no."""

    allowed = "true or false"

    def __call__(self, value: object, origin: Origin = FROM_PYTHON) -> bool:
        """Return the flag."""
        if not isinstance(value, bool):
            self.refuse(value, "Write it without quotes.")
        return value


@dataclass(frozen=True)
class Text(ValueKind):
    """A word, as the name of an array; files can hold no null character and no half of one."""

    allowed = "a text in quotes"

    def __call__(self, value: object, origin: Origin = FROM_PYTHON) -> str:
        """Return the text."""
        if not isinstance(value, str) or not value.strip() or re.search("[\0\ud800-\udfff]", value):
            self.refuse(value)
        return value


@dataclass(frozen=True)
class LengthUnit(ValueKind):
    """The unit of heights in a file that does not name it."""

    allowed = 'a unit of length, as "um"'

    def __call__(self, value: object, origin: Origin = FROM_PYTHON) -> str:
        """Return the unit, once it is known to be one."""
        if not isinstance(value, str):
            self.refuse(value)
        try:
            factor(value, "m")
        except InputError as error:
            self.refuse(value, error.remedy)
        return value


@dataclass(frozen=True)
class File(ValueKind):
    """An existing file, whose path starts at the folder of the case; from Python also what it would hold.

    Parameters
    ----------
    held : tuple of types
        Objects that may stand in its place.
    several : type, optional
        One of them, of which also a list may.
    columns : tuple of int
        Numbers of columns that an array in its place may have; empty where none may stand there.
    content : str
        What the file is.
    """

    held: tuple[type, ...] = ()
    several: type | None = None
    columns: tuple[int, ...] = ()
    content: str = "an existing file, relative to the case"

    @property
    def allowed(self) -> str:
        """What may stand behind the key."""
        return f"the path of {self.content}"

    def __call__(self, value: Any, origin: Origin = FROM_PYTHON) -> Any:
        """Return the path, absolute, or what stands in its place."""
        if isinstance(value, self.held):
            return value
        alike = self.several and isinstance(value, list | tuple) and len(value)
        if self.several and alike and all(isinstance(each, self.several) for each in value):
            return tuple(value)
        if self.columns and isinstance(value, np.ndarray):
            return self._table(value)
        return self._path(value, origin)

    def _table(self, value: NDArray[Any]) -> Array:
        if value.ndim != 2 or value.shape[1] not in self.columns or value.dtype.kind not in "fiu":
            shapes = " or ".join(f"(n, {count})" for count in self.columns)
            raise InputError("table", shown(value), f"an array of shape {shapes} of real numbers in SI")
        table = np.array(value, dtype=np.float64, order="C")
        table.flags.writeable = False
        return table

    def _path(self, value: object, origin: Origin) -> Path:
        if not isinstance(value, str | Path) or "\0" in str(value) or not str(value):
            held = "" if origin.units else "".join(f", or a {each.__name__}" for each in self.held)
            raise InputError("file", shown(value), self.allowed + held)
        path = (origin.folder / value).absolute()
        if reason := no_file(path):
            remedy = f"It is {reason}."
            if reason == "no such file":
                escaped = any(not character.isprintable() for character in str(value))
                remedy = BACKSLASH if escaped else f"There is no such file in {path.parent.resolve()}."
            self.refuse(str(value), remedy)
        return path


@dataclass(frozen=True)
class Either(ValueKind):
    """One of a few words, or else a value of another kind."""

    words: tuple[str, ...]
    other: ValueKind

    @property
    def allowed(self) -> str:
        """What may stand behind the key."""
        return f"{Choice(self.words).allowed}, or {self.other.allowed}"

    def __call__(self, value: object, origin: Origin = FROM_PYTHON) -> Any:
        """Return the word, or the other value."""
        if isinstance(value, str) and value in self.words:
            return value
        try:
            return self.other(value, origin)
        except InputError as error:
            remedy = nearest(value, self.words) or error.remedy
            raise InputError("value", error.received, self.allowed, remedy) from None


@dataclass(frozen=True)
class ListOf(ValueKind):
    """A list of values of one kind, of at least so many; each once, or each above the one before."""

    each: ValueKind
    least: int = 0
    once: bool = False
    rising: bool = False

    @property
    def allowed(self) -> str:
        """What may stand behind the key."""
        return f"a list{' that rises' * self.rising}, each {self.each.allowed}"

    def __call__(self, value: Any, origin: Origin = FROM_PYTHON) -> tuple[Any, ...]:
        """Return the values; errors are told of each, by number."""
        value = value.tolist() if isinstance(value, np.ndarray) else value
        if not isinstance(value, list | tuple):
            self.refuse(value)
        if len(value) < self.least:
            received = count_of(len(value), "value") if len(value) else "an empty list"
            remedy = "Add to it, or remove the key."
            raise InputError("value", received, f"at least {self.least}, each {self.each.allowed}", remedy)
        read = []
        errors = []
        for number, item in enumerate(value, 1):
            try:
                read.append(self.each(item, origin))
            except InputError as error:
                errors.append(error.about(f"[{number}]"))
        if errors:
            raise Problems(errors)
        if self.once and (twice := [item for item in read if read.count(item) > 1]):
            raise InputError("value", f'"{twice[0]}" more than once', "each once")
        if self.rising and any(later <= earlier for earlier, later in pairwise(read)):
            self.refuse(value, "Sort them, each once.")
        return tuple(read)


GIVEN = "given in the case"
"""Source of a material that states none."""
_SOLIDS = "solids that roll lie between"
_OF_A_MATERIAL: dict[str, tuple[ValueKind, str]] = {
    "name": (Text(), ""),
    "youngs_modulus": (Quantity("Pa", above=0), f"1 kPa to 10 TPa: {_SOLIDS}"),
    "poisson_ratio": (Number(above=-1, at_most=0.5), ""),
    "density": (Quantity("kg/m^3", above=0), f"1 kg/m^3 to 100000 kg/m^3: {_SOLIDS}"),
    "citation": (Text(), ""),
}


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

    def __call__(self, value: object, origin: Origin = FROM_PYTHON) -> Material:
        """Return the material."""
        if isinstance(value, Material):
            if MATERIALS.get(value.name) == value:
                return value
            return _own_material({name: each for name, each in asdict(value).items() if each}, FROM_PYTHON)
        if isinstance(value, Mapping):
            return _own_material(value, origin)
        if not isinstance(value, str) or value not in MATERIALS:
            self.refuse(value, nearest(value, tuple(MATERIALS)))
        return MATERIALS[value]


def _own_material(given: Mapping[Any, Any], origin: Origin) -> Material:
    """Material of numbers with units, and of a name and a source if there are; all errors at once."""
    optional = {"name", "citation"}
    read = dict[str, Any]()
    unknown = sorted(map(str, given.keys() - _OF_A_MATERIAL.keys()))
    numbers = [name for name in _OF_A_MATERIAL if name not in optional]
    allowed = ", ".join(_OF_A_MATERIAL)
    errors = [InputError(name, "an unknown key", allowed, nearest(name, numbers)) for name in unknown]
    for name, (kind, within) in _OF_A_MATERIAL.items():
        if name not in given:
            errors += [] if name in optional else [InputError(name, "nothing", kind.allowed)]
            continue
        try:
            read[name] = kind(given[name], origin)
            errors += outside(name, read[name], kind, within)
        except InputError as error:
            errors.append(error.about(name))
    if errors:
        raise Problems(errors)
    return solid(Material(**({"name": name_of_numbers(read["youngs_modulus"]), "citation": GIVEN} | read)))


def name_of_numbers(youngs_modulus: float) -> str:
    """Name of a material that states none."""
    return f"{youngs_modulus / 1e9:.4g} GPa"


def in_its_unit(value: object, kind: ValueKind) -> str:
    """A value as it would be written in TOML, in messages: a quantity with its unit."""
    if isinstance(kind, Quantity) and isinstance(value, int | float):
        return written(value, kind.dimension, kind.dimension)
    return shown(value)


def outside(name: str, value: object, kind: ValueKind, within: str) -> Iterator[InputError]:
    """Error about a number out of its limits; zero, infinity and NaN, where they may stand, may."""
    if not within or not isinstance(value, int | float) or value in (0.0, math.inf) or value != value:
        return
    low, high, reason = limits_in(within)
    unit = kind.dimension if isinstance(kind, Quantity) else ""
    least = quantity(low, unit) if unit else float(low)
    most = quantity(high, unit) if unit else float(high)
    if not least <= value <= most:
        received = in_its_unit(value, kind) if unit else f"{value:.4g}"
        yield InputError(name, received, f"{low} to {high}", f"{reason[0].upper()}{reason[1:]}.")


@dataclass(frozen=True, eq=False)
class Key:
    """A parameter as a key of a case.

    Attributes
    ----------
    kind : ValueKind
        What may stand there.
    default : object
        As it would be written in TOML; None where there is no fixed one.
    meaning : str
        What it is.
    within : str
        Its plausible limits, as in `key`.
    otherwise : str
        What happens without it, where there is no fixed default.
    example : object
        A value, as it would be written in TOML, where there is no fixed default.
    goes_with : str
        The key, ``key=value``, or keys with " or " between them, without which this one has no meaning.
    """

    kind: ValueKind
    default: Any
    meaning: str
    within: str = ""
    otherwise: str = ""
    example: Any = None
    goes_with: str = ""

    @cached_property
    def one(self) -> ValueKind:
        """Kind of its value, or of each in its list."""
        return self.kind.each if isinstance(self.kind, ListOf) else self.kind

    @property
    def written_example(self) -> Any:
        """Its default, or an example, as it would be written in TOML."""
        return self.example if self.default is None else self.default


def key(kind: ValueKind, default: Any, meaning: str, within: str = "", *, goes_with: str = "") -> Any:
    """Declare a key of a section that has a fixed default.

    Parameters
    ----------
    kind : ValueKind
        What may stand there.
    default
        As it would be written in TOML.
    meaning : str
        What the key is.
    within : str
        The least and the largest plausible value, as they are written in TOML, and the reason:
        ``"1 mm to 1 km: beams lie between"``.
    goes_with : str
        The key, ``key=value``, or keys with " or " between them, without which this one has no meaning.

    Returns
    -------
    Key
        Typed as Any: in a class it stands for its value.
    """
    return Key(kind, default, meaning, within, goes_with=goes_with)


def optional(
    kind: ValueKind, example: Any, meaning: str, otherwise: str = "", within: str = "", *, goes_with: str = ""
) -> Any:
    """Declare a key that may be left out: `otherwise` says what happens then; the rest is as in `key`."""
    return Key(kind, None, meaning, within, otherwise, example, goes_with)


def parameter(
    kind: ValueKind,
    example: Any,
    meaning: str,
    within: str = "",
    *,
    default: Any = MISSING,
    otherwise: str = "",
    goes_with: str = "",
) -> Any:
    """Declare a parameter of a physical dataclass, from which its key in a case follows.

    `default` is that of the class, in SI; the rest is as in `optional`.
    """
    declared = Key(kind, None, meaning, within, otherwise, example, goes_with)
    return field(default=default, metadata={"key": declared})


def usual_parameter(kind: ValueKind, example: Any, *told: str, **options: Any) -> Any:
    """Declare a parameter whose default is its example; the rest is as in `parameter`."""
    return parameter(kind, example, *told, default=kind(example), **options)


def optional_parameter(*told: Any, **options: Any) -> Any:
    """Declare a parameter that may be None, and is by default; the rest is as in `parameter`."""
    return parameter(*told, default=None, **options)


def keys_of(model: Any, otherwise: str) -> Mapping[str, Key]:
    """Keys of the parameters that a physical dataclass declares.

    `otherwise` is what holds without them, where they do not say it themselves.
    """
    return _keys_of(model, otherwise)


@cache
def _keys_of(model: Any, otherwise: str) -> Mapping[str, Key]:
    declared = {each.name: each.metadata["key"] for each in fields(model) if "key" in each.metadata}
    return {name: replace(key, otherwise=key.otherwise or otherwise) for name, key in declared.items()}


def checked_parameters(model: Any) -> None:
    """Take all parameters that a frozen dataclass declares as their kinds do; None stays if it is usual."""
    for name, key in keys_of(type(model), "").items():
        if (value := getattr(model, name)) is not None or getattr(type(model), name, 0.0) is not None:
            try:
                object.__setattr__(model, name, key.kind(value))
            except (InputError, Problems) as error:
                first = error.errors[0] if isinstance(error, Problems) else error
                of = re.sub(r"(?<=[a-z])(?=[A-Z])", " ", type(model).__name__).lower()
                raise first.about(f"{name} of the {of}") from None
