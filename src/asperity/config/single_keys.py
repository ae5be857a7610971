"""One key of a case on its own: found by its dotted name, and its values read before there is a case."""

from __future__ import annotations

from collections.abc import Callable
from typing import Annotated, Any

from pydantic import TypeAdapter, ValidationError

from asperity.arguments import nearest, shown
from asperity.config.case import Case
from asperity.config.describing import CaseKey, entries
from asperity.config.parsing import Origin
from asperity.config.values import Number, Quantity, allowed_in, is_list, value_kind
from asperity.errors import InputError


def entry_of(model: type[Case], dotted: str) -> CaseKey:
    """Find a key of a kind of case by its name with its section, as ``"contact.spacing"``."""
    found = {entry.dotted: entry for entry in entries(model)}
    if dotted in found:
        return found[dotted]
    homes = [name for name in found if name.rpartition(".")[2] == dotted]
    remedy = f'Write it with its section, "{homes[0]}".' if homes else nearest(dotted, list(found))
    kind = model.model_fields["kind"].default
    allowed = f'a key of a {kind} case, with its section, as "contact.spacing"'
    raise InputError(dotted, "an unknown key", allowed, remedy)


def reader_of(entry: CaseKey, origin: Origin) -> Callable[[object], Any]:
    """Make what reads values of a key: it returns them in SI, and raises an `InputError` if it cannot."""
    kind: Any = entry.field.annotation
    if entry.field.metadata:
        kind = Annotated[(kind, *entry.field.metadata)]
    adapter: TypeAdapter[Any] = TypeAdapter(kind)
    context = {"folder": origin.folder, "units": origin.units}

    def value_of(value: object) -> Any:
        try:
            return adapter.validate_python(value, context=context)
        except ValidationError as error:
            cause = error.errors(include_url=False)[0].get("ctx", {}).get("error")
            if isinstance(cause, InputError):
                raise InputError(entry.dotted, cause.received, cause.allowed, cause.remedy) from None
            raise InputError(entry.dotted, shown(value), allowed_in(entry.field)) from None

    return value_of


def unit_of(entry: CaseKey) -> str | None:
    """SI unit of a key whose values are single numbers; None of any other key."""
    kind = value_kind(entry.field.annotation, entry.field.metadata)
    if is_list(entry.field.annotation):
        return None
    if isinstance(kind, Quantity):
        return kind.dimension
    return "1" if isinstance(kind, Number) else None
