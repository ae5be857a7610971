"""The page with its forms, which are made from the schemas of kinds of case, and what is typed into them."""

import tomllib
from collections.abc import Callable, Mapping
from functools import cache
from itertools import groupby
from pathlib import Path
from typing import Any

from asperity import __version__
from asperity.arguments import shown
from asperity.case import any_case, cases, toml
from asperity.case.documented import allowed_in
from asperity.case.speed import Speed, names_table
from asperity.errors import InputError
from asperity.files import amount
from asperity.parameters import Choice, Either, File, Flag, ListOf, MaterialOrName, Number
from asperity.reporting.templates import page_template
from asperity.serving.stored_runs import LARGEST_UPLOAD

LONGEST_VALUE = 2000
"""Characters of one value: more than any list of a case needs."""
YES, NO = "yes", "no"
_KIND = "kind"


SLIDERS = (
    ("Roughness", "surface.rms surface.level outer_raceway.roughness outer_raceway.waviness"),
    ("Load", ".load axial radial"),
    ("Speed", "speed"),
)
"""What is turned most, and ends of the keys that do it: the first of them that holds a number."""


@cache
def page_text() -> str:
    """Write the page; what it shows of runs and contacts its script asks for."""
    largest = {"largest": LARGEST_UPLOAD, "largest_words": amount(LARGEST_UPLOAD)}
    page = page_template("page.html.jinja", "asperity.serving")
    return page.render(forms=forms(), sliders=SLIDERS, version=__version__, **largest)


@cache
def forms() -> dict[str, dict[str, Any]]:
    """Make the form of each kind of case: what it is, and its sections with their keys."""
    return {name: _form(model) for name, model in cases.case_classes().items()}


def _form(model: type[any_case.AnyCase]) -> dict[str, Any]:
    whole = model.TITLE.rstrip(".")
    sections = model.sections()
    shown = [
        each
        for each in any_case.entries(model)
        if each.dotted != _KIND and each.name in model.SHOWN.get(each.section, (each.name,))
    ]
    groups = [
        {
            "title": title,
            "meaning": sections[title].meaning if title else whole,
            "fields": [_field(entry, model.WRITTEN_OUT.get(entry.dotted)) for entry in keys],
        }
        for title, keys in groupby(shown, lambda entry: entry.section)
    ]
    return {"title": whole, "groups": groups}


def _field(entry: any_case.CaseKey, written: str | None) -> dict[str, Any]:
    """A key as the form shows it: its words, its control, and what stands there at first."""
    usual = entry.key.default
    companion = entry.key.goes_with
    with_section = f"{entry.section}.{{}}".lstrip(".")
    return {
        "key": entry.dotted,
        "name": entry.name,
        "meaning": entry.key.meaning,
        "allowed": allowed_in(entry.key).removesuffix(" in quotes"),
        "otherwise": entry.key.otherwise if usual is None else typed(usual),  # where nothing is typed
        "value": "" if written is None else typed(tomllib.loads(f"v = {written}")["v"]),
        # keys, with " or " between them, or "key=value", without which it has no meaning
        "goes_with": " or ".join(map(with_section.format, filter(None, (companion or "").split(" or ")))),
        **dict(zip(("control", "choices"), _control(entry), strict=True)),
    }


def _control(entry: any_case.CaseKey) -> tuple[str, tuple[str, ...]]:
    """Of "text", "choice" (one of them), "choices" (several) and "file", and the words to choose from."""
    match entry.key.kind:
        case Choice() as choice:
            return "choice", choice.known
        case ListOf(Choice() as choice):
            return "choices", choice.known
        case Flag():
            return "choice", (YES, NO)
        case File():
            return "file", ()
        case Either(words, File()):
            return "file", words
    return "text", ()


def typed(value: object) -> str:
    """Write a value of a case file as it would be typed into the form."""
    if isinstance(value, bool):
        return YES if value else NO
    if isinstance(value, list | tuple):
        return ", ".join(map(typed, value))
    return toml.toml_value(value) if isinstance(value, Mapping) else str(value)


def case_data(
    kind: object, values: Mapping[str, object], file_of: Callable[[str], Path | None]
) -> dict[str, Any]:
    """Make keys and values, as a case file has them, of what was typed into a form.

    Parameters
    ----------
    kind : object
        Name of the kind of case.
    values : mapping
        What was typed, by key with its section; empty text leaves a key out.
    file_of : callable
        Finds the file of an identifier; None where there is none.

    Raises
    ------
    InputError
        If a key or a file is unknown, or a value is no text.
    """
    model = cases.case_class(kind)
    data: dict[str, Any] = {_KIND: kind}
    for dotted, text in values.items():
        entry = any_case.entry_of(model, dotted)
        if not isinstance(text, str) or len(text) > LONGEST_VALUE:
            raise InputError(dotted, shown(text), f"a text of at most {LONGEST_VALUE} characters")
        if text.strip():
            title, _, name = dotted.rpartition(".")
            section = data.setdefault(title, {}) if title else data
            section[name] = _value(entry, text.strip(), file_of)
    return data


def _value(entry: any_case.CaseKey, text: str, file_of: Callable[[str], Path | None]) -> Any:
    kind = entry.key.kind
    if isinstance(kind, ListOf):
        parts = (part.strip() for part in text.split(","))
        return [_number(part) if isinstance(kind.each, Number) else part for part in parts if part]
    match kind:
        case Speed() if names_table(text):
            raise _speed_table(entry.dotted, kind, text)
        case Number() | Either(_, Number()):
            return _number(text)
        case Flag():
            return {YES: True, NO: False}.get(text, text)
        case Either(words, File()) if text in words:
            return text
        case File() | Either(_, File()):
            found = file_of(text)
            if found is None:
                raise InputError(entry.dotted, shown(text), "a surface that was uploaded", "Upload it.")
            return str(found)
        case MaterialOrName() if text.startswith("{"):
            try:
                return tomllib.loads(f"v = {text}")["v"]
            except (ValueError, RecursionError):
                raise InputError(entry.dotted, shown(text), kind.allowed) from None
    return text


def _speed_table(dotted: str, kind: Speed, text: str) -> InputError:
    allowed = f'{kind.allowed}, or points of it, as "1 {kind.meant or "m/s"} at 0 s, …"'
    return InputError(dotted, shown(text), allowed, "Write its points.")


def _number(text: str) -> int | float | str:
    """The number that a text is; the text itself if it is none, of which the case will complain."""
    for kind in (int, float):
        try:
            return kind(text)
        except ValueError:
            continue
    return text


def form_values(data: Mapping[str, Any], id_of: Callable[[str], str | None]) -> dict[str, str]:
    """Write the keys and values of a case as they would be typed into its form.

    `id_of` finds the identifier of a file's path; an `InputError` names a file that has none. No file is
    opened.
    """
    model = cases.case_class(data.get(_KIND))
    found = {}
    sections = {name: value for name, value in data.items() if isinstance(value, Mapping)}
    flat = {name: value for name, value in data.items() if name not in {_KIND, *sections}}
    for title, keys in sections.items():  # in which a material of numbers is a value
        flat |= {f"{title}.{name}": value for name, value in keys.items()}
    for dotted, value in flat.items():
        kind = any_case.entry_of(model, dotted).key.kind
        if isinstance(kind, Speed) and isinstance(value, str) and names_table(value):
            raise _speed_table(dotted, kind, value)
        named = isinstance(kind, File)
        named |= isinstance(kind, Either) and isinstance(kind.other, File) and value not in kind.words
        text = id_of(str(value)) if named else typed(value)
        if text is None:
            remedy = "Upload it, and choose it in the form."
            raise InputError(dotted, shown(Path(str(value)).name), "a surface that was uploaded", remedy)
        found[dotted] = text
    return found
