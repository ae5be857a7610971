"""A bearing as a case says it: by its name, or by its dimensions."""

from collections.abc import Iterator, Mapping
from functools import cached_property
from typing import TYPE_CHECKING, Any, ClassVar

from asperity.case.form import Section
from asperity.errors import InputError
from asperity.parameters import Key


class NamedBearing(Section):
    """A bearing, named or by its dimensions."""

    MODEL: ClassVar[Any]
    """Class of the bearing that it is."""
    DIMENSIONS: ClassVar[Mapping[str, Key]]
    """Keys that are parameters of this class."""
    NEEDED: ClassVar[tuple[str, ...]]
    """Those of them that a bearing without a name must have."""

    if TYPE_CHECKING:
        name: str | None

    @classmethod
    def names_in_words(cls) -> str:
        """A sentence about the names that there are."""
        raise NotImplementedError

    @cached_property
    def bearing(self) -> Any:
        """The bearing, built once."""
        given = {name: getattr(self, name) for name in self.DIMENSIONS if getattr(self, name) is not None}
        return self.MODEL(**given) if self.name is None else self.MODEL.named(self.name, **given)

    def default_of(self, name: str) -> Any:
        """Value of a key that is left out: that of the named bearing, or of any that has no name."""
        if name in self.DIMENSIONS and self.name is None:
            return getattr(self.MODEL, name, None)
        if name in self.DIMENSIONS and name not in self.given_names:
            return getattr(self.bearing, name)
        return super().default_of(name)

    def problems(self) -> Iterator[InputError]:
        """All dimensions of a bearing without a name, which must be one that can be."""
        missing = [name for name in self.NEEDED if getattr(self, name) is None]
        if self.name is None and missing:
            received = f"none, and no {' and no '.join(missing)}"
            yield InputError("name", received, "these, or a name", self.names_in_words())
            return
        try:
            _ = self.bearing
        except InputError as error:
            yield error
