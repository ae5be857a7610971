"""A section of a case: keys with their defaults, read into a frozen object in SI, with all errors at once."""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping
from functools import lru_cache
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, NoReturn

import numpy as np
from pydantic import BaseModel, ConfigDict, Field, TypeAdapter, ValidationError, model_validator
from pydantic.fields import FieldInfo

from asperity.arguments import shown
from asperity.config.content import content, described_value, holds_memory
from asperity.config.values import Problems, is_list, outside_limits, value_kind
from asperity.errors import InputError


def key(default: Any, meaning: str, within: str = "", *, goes_with: str = "") -> Any:
    """Describe a key of a case that has a fixed default.

    Parameters
    ----------
    default
        As it would be written in TOML.
    meaning : str
        What the key is.
    within : str
        The least and the largest plausible value, as they are written in TOML, and the reason:
        ``"1 mm to 1 km: beams lie between"``.
    goes_with : str
        The key, ``key=value``, or keys with " or " between them, without which this one has no meaning.
    """
    return _described(default, meaning, within, goes_with=goes_with)


def optional(
    example: Any, meaning: str, otherwise: str = "", within: str = "", *, goes_with: str = ""
) -> Any:
    """Describe a key that may be left out: `otherwise` says what happens then; the rest is as in `key`."""
    return _described(None, meaning, within, goes_with=goes_with, otherwise=otherwise, example=example)


def _described(default: Any, meaning: str, within: str, **told: Any) -> Any:
    extra = {"default": default, "example": None, "otherwise": "", **told}
    if within:
        limits, _, reason = within.partition(": ")
        extra["within"] = (*limits.split(" to "), reason)
    return Field(default, description=meaning, json_schema_extra=extra)


def extra_of(field: FieldInfo) -> dict[str, Any]:
    """What `key` was told beyond the default and the meaning."""
    return field.json_schema_extra if isinstance(field.json_schema_extra, dict) else {}


if TYPE_CHECKING:
    from pydantic._internal._model_construction import ModelMetaclass
else:
    ModelMetaclass = type(BaseModel)


class _Form(ModelMetaclass):
    """What is wrong with keys from Python is said in one `CaseError`, as of a file."""

    def __call__(cls, *positional: Any, **keys: Any) -> Any:
        from asperity.config.messages import case_error

        try:
            return super().__call__(*positional, **keys)
        except ValidationError as error:
            raise case_error(error, cls, cls.__name__) from None  # type: ignore[arg-type]


class Section(BaseModel, metaclass=_Form):
    """A frozen section of a case: unknown keys are errors, and all errors are reported together."""

    model_config = ConfigDict(
        frozen=True, extra="forbid", validate_default=True, arbitrary_types_allowed=True
    )

    def default_of(self, name: str) -> Any:
        """Value of a key that is left out; without a fixed default, what was chosen for it."""
        chosen = _default(type(self), name) is None and name not in self.model_fields_set
        return getattr(self, name) if chosen else _default(type(self), name)

    def given(self) -> dict[str, Any]:
        """Keys whose values differ from their defaults, sections as dicts."""
        found: dict[str, Any] = {}
        for name in type(self).model_fields:
            value = getattr(self, name)
            if isinstance(value, Section):
                found |= {name: inner} if (inner := value.given()) else {}
            elif content(value) != content(self.default_of(name)):
                found[name] = value
        return found

    def __repr__(self) -> str:
        from asperity.config.describing import in_toml

        keys = in_toml(self, in_memory=lambda _, value: f"<{described_value(value)}>")
        return f"{type(self).__name__}({', '.join(f'{name}={value!r}' for name, value in keys.items())})"

    __str__ = __repr__

    def __setattr__(self, name: str, value: object) -> NoReturn:
        remedy = f"Make another case: case.with_({name}=…), or with the section before a dot."
        raise AttributeError(f"{name} of {type(self).__name__} does not change. {remedy}")

    def __eq__(self, other: object) -> bool:
        return type(self) is type(other) and content(self) == content(other)

    def __hash__(self) -> int:
        return hash(json.dumps(content(self)))

    @model_validator(mode="before")
    @classmethod
    def _arrays_for_lists(cls, data: Any) -> Any:
        """Take an array where a list of values may stand."""
        if not isinstance(data, Mapping):
            return data
        fields = cls.model_fields
        return {
            name: value.tolist()
            if isinstance(value, np.ndarray) and name in fields and is_list(fields[name].annotation)
            else value
            for name, value in data.items()
        }

    def problems(self) -> Iterator[InputError]:
        """Errors between keys that are right one by one."""
        yield from ()

    @model_validator(mode="after")
    def _is_consistent(self) -> Section:
        errors = [*_implausible(self)]
        if not errors:
            self._choose()
            errors = [*_lonely(self), *self.problems()]
        if errors:
            raise Problems(errors)
        return self

    def _choose(self) -> None:
        """Fill in what follows from other keys."""


@lru_cache(maxsize=1024)
def _default(model: type[Section], name: str) -> Any:
    """Default of a key, as a case has it."""
    field = model.model_fields[name]
    if field.default is None:
        return None
    kind: Any = Annotated[(field.annotation, *field.metadata)] if field.metadata else field.annotation
    adapter: TypeAdapter[Any] = TypeAdapter(kind)
    return adapter.validate_python(field.default)


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
            yield from outside_limits(name, value, kind, extra_of(field).get("within"))


def _lonely(section: BaseModel) -> Iterator[InputError]:
    for name in sorted(section.model_fields_set):
        if not is_active(section, name):
            companion, _, value = extra_of(type(section).model_fields[name])["goes_with"].partition("=")
            wanted = f'{companion} = "{value}"' if value else companion
            yield InputError(name, shown(_plain(getattr(section, name))), f"only together with {wanted}")


def _plain(value: object) -> object:
    return described_value(value) if holds_memory(value) else str(value) if isinstance(value, Path) else value
