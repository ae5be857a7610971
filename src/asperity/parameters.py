"""A parameter, declared once: kind, default, meaning, limits; cases, forms and checks follow from it."""

from __future__ import annotations

import dataclasses
from dataclasses import dataclass
from typing import Any

from asperity.values import ListOf, ValueKind, Within


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
    within : (str, str, str), optional
        Its plausible limits.
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
    within: Within | None = None
    otherwise: str = ""
    example: Any = None
    goes_with: str = ""

    @property
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
    return Key(kind, default, meaning, limits_in(within), goes_with=goes_with)


def optional(
    kind: ValueKind, example: Any, meaning: str, otherwise: str = "", within: str = "", *, goes_with: str = ""
) -> Any:
    """Declare a key that may be left out: `otherwise` says what happens then; the rest is as in `key`."""
    return Key(kind, None, meaning, limits_in(within), otherwise, example, goes_with)


def parameter(
    kind: ValueKind, example: Any, meaning: str, within: str = "", *, default: Any = dataclasses.MISSING
) -> Any:
    """Declare a parameter of a physical dataclass, from which its key in a case follows.

    `default` is that of the class, in SI; the rest is as in `key`.
    """
    declared = Key(kind, None, meaning, limits_in(within), example=example)
    return dataclasses.field(default=default, metadata={"key": declared})


def keys_of(model: Any, otherwise: str) -> dict[str, Key]:
    """Keys of the parameters that a physical dataclass declares; `otherwise` is what holds without them."""
    declared = {field.name: field.metadata.get("key") for field in dataclasses.fields(model)}
    return {name: dataclasses.replace(key, otherwise=otherwise) for name, key in declared.items() if key}


def limits_in(within: str) -> Within | None:
    """Limits and reason of a text as ``"1 mm to 1 km: beams lie between"``."""
    if not within:
        return None
    limits, _, reason = within.partition(": ")
    least, _, most = limits.partition(" to ")
    return least, most, reason
