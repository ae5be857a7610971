"""Everything that is wrong with a section or a case, each error as one message."""

from __future__ import annotations

from pydantic import BaseModel, ValidationError

from asperity.arguments import nearest, shown
from asperity.config.values import Problems, allowed_in
from asperity.errors import CaseError, InputError


def case_error(error: ValidationError, model: type[BaseModel], source: str) -> CaseError:
    """All that is wrong at once, told of `source`."""
    return CaseError(source, _messages(error, model))


def _messages(error: ValidationError, model: type[BaseModel]) -> list[str]:
    messages: list[str] = []
    for item in error.errors(include_url=False):
        name = _dotted(item["loc"])
        cause = item.get("ctx", {}).get("error")
        if isinstance(cause, Problems):
            messages += [_message(".".join(filter(None, (name, each.what))), each) for each in cause.errors]
        elif isinstance(cause, InputError):
            messages.append(_message(name, cause))
        elif item["type"] == "extra_forbidden":
            messages.append(_unknown(item["loc"], model))
        else:
            received = "nothing" if item["type"] == "missing" else shown(item["input"])
            messages.append(str(InputError(name, received, _allowed(item["loc"], model))))
    return messages


def _message(name: str, error: InputError) -> str:
    return str(InputError(name or "the case", error.received, error.allowed, error.remedy))


def _dotted(location: tuple[int | str, ...]) -> str:
    text = ""
    for part in location:
        text += f"[{part + 1}]" if isinstance(part, int) else f".{part}"
    return text.lstrip(".")


def _sections(model: type[BaseModel]) -> dict[str, type[BaseModel]]:
    found: dict[str, type[BaseModel]] = {}
    for name, field in model.model_fields.items():
        if isinstance(field.annotation, type) and issubclass(field.annotation, BaseModel):
            found[name] = field.annotation
    return found


def _unknown(location: tuple[int | str, ...], model: type[BaseModel]) -> str:
    """Message about an unknown key: the nearest one here, or the section in which it would be known."""
    *path, name = map(str, location)
    sections = _sections(model)
    here: type[BaseModel] = sections[path[0]] if path else model
    place = f"keys of [{path[0]}]" if path else "keys at the top of a case"
    remedy = nearest(name, list(here.model_fields))
    homes = [f"[{title}]" for title, section in sections.items() if name in section.model_fields]
    if path and name in model.model_fields:
        homes.insert(0, "the top of the case, above the first section")
    if homes:
        remedy = f"Move it to {homes[0]}."
    return str(
        InputError(_dotted(location), "an unknown key", f"{place}: {', '.join(here.model_fields)}", remedy)
    )


def _allowed(location: tuple[int | str, ...], model: type[BaseModel]) -> str:
    here, names = model, [part for part in location if isinstance(part, str)]
    sections = _sections(model)
    if names[0] in sections:
        if len(names) == 1:
            return f"a section [{names[0]}]"
        here = sections[names.pop(0)]
    return allowed_in(here.model_fields[names[0]])
