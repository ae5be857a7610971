"""The case of any kind: its keys in and out of TOML, other values for some; and what computes it."""

import warnings
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any, ClassVar, Protocol, Self, runtime_checkable

from asperity.case.content import described_value
from asperity.case.describing import in_toml, parameters, refused
from asperity.case.form import Section
from asperity.case.toml import toml_text
from asperity.parameters import Text, key


class AnyCase(Section):
    """A case of any kind: a frozen section with a kind and other sections inside.

    It does not change; `with_` makes another one. Cases are equal if all their keys are.
    """

    TITLE: ClassVar[str]
    """One sentence: what rolls over what."""
    NEEDED: ClassVar[str] = "a source of texture, or smooth = true"
    """What a case cannot do without, beside its kind."""
    PREPARED_BY: ClassVar[str]
    """Function (case, source) that makes a `ReadyCase` of it, by module and name."""
    COMPUTED_BY: ClassVar[str]
    """Function (ready case, progress, warnings caught, brief=…) that makes its result."""
    WRITTEN_OUT: ClassVar[Mapping[str, str]] = {}
    """Values, in TOML, of keys that have no default and shall stand in a commented case."""
    SHOWN: ClassVar[Mapping[str, tuple[str, ...]]] = {}
    """Keys of some sections that a commented case shows; the others are for scenes of other kinds."""

    kind: str = key(Text(), "", "what rolls")

    if TYPE_CHECKING:  # each kind declares these
        laws: tuple[str, ...]
        seed: int

    @property
    def numbers_written(self) -> float:
        """How many numbers its result holds, at most."""
        raise NotImplementedError

    def with_(self, **changes: Any) -> Self:
        """Return the same case with other values for some keys.

        Parameters
        ----------
        **changes
            Keys with their new values, in SI or as text with a unit; None takes a key out. A key of a section
            is written ``**{"contact.spacing": 4e-6}``, or in a mapping of keys of the section, of which the
            others stay: ``contact={"spacing": "4 um"}``. A list of sections replaces all of them, as
            ``fault=[{…}, {…}]``; the second is ``fault[2]``.

        Returns
        -------
        Case
            A new case of the same kind.

        Raises
        ------
        CaseError
            With all errors at once, if the keys are wrong or do not fit together.
        """
        data = self.given()
        for name, value in changes.items():
            title, _, key_in_section = name.rpartition(".")
            _change(data, {title: {key_in_section: value}} if title else {name: value})
        return type(self)(**data)

    def to_toml(self) -> str:
        """Write the case as a case file: its kind, and all keys that are not at their defaults.

        Returns
        -------
        str
            TOML that reads as the same case, to the last bit.

        Raises
        ------
        InputError
            If a surface or a table stands in memory, which no case file can hold.
        """
        return toml_text({"kind": self.kind, **in_toml(self, in_memory=refused)})

    @property
    def text(self) -> str:
        """The case in TOML; what stands in memory is described, with its digest."""
        keys = in_toml(self, in_memory=lambda _, value: described_value(value))
        return toml_text({"kind": self.kind, **keys})

    def parameters(self) -> list[dict[str, Any]]:
        """List the keys that matter in this case, for people.

        Returns
        -------
        list of dict
            For each key: ``key`` (dotted), ``value`` and ``default`` (text with units), ``is_default`` and
            ``note`` (what the key is).
        """
        return parameters(self, self.SHOWN)


@runtime_checkable
class ReadyCase(Protocol):
    """A case of any kind that can be computed."""

    @property
    def case(self) -> AnyCase:
        """The case."""
        ...

    @property
    def caught(self) -> tuple[warnings.WarningMessage, ...]:
        """Warnings met on the way."""
        ...


def _change(data: dict[str, Any], changes: Mapping[str, Any]) -> None:
    """Put keys into the dicts of a case; None takes them out."""
    for name, value in changes.items():
        if isinstance(value, Mapping) and isinstance(inner := data.get(name, {}), dict):
            data[name] = inner = dict(inner)
            _change(inner, value)
            continue
        for each in [each for each in data if each == name or each.startswith(f"{name}[")]:
            del data[each]
        if value is not None:
            data[name] = value
