"""Cases of any kind: from files, texts and mappings; and as a commented text."""

import importlib
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from asperity import extensions
from asperity.arguments import FilePath, file_path, nearest, require, shown
from asperity.case import PRESETS, kinds, scene, toml
from asperity.case.any_case import AnyCase, commented
from asperity.case.form import in_toml
from asperity.errors import CaseError, InputError
from asperity.files import packaged
from asperity.laws import family_of, law_keys, spec_of
from asperity.parameters import FROM_PYTHON, Origin

_HEAD = """\
# {title} Run it with: asperity run CASE
# Every key may be left out, but for kind and {needed}.
# Lines that start with '#' show keys that have no fixed default, or that go with another key.

"""


def read_case(path: FilePath) -> AnyCase:
    """Read a case file, as an object whose keys are in SI.

    Parameters
    ----------
    path : path
        A TOML file, as ``asperity new`` writes it. Relative paths in it start at its folder.

    Returns
    -------
    case
        An object of the class of its kind, as `asperity.WheelOnRail`.

    Raises
    ------
    InputError
        If the file cannot be read.
    CaseError
        With all errors at once, if its keys are wrong.

    Examples
    --------
    >>> import asperity
    >>> path = case.save("case.toml")
    >>> asperity.read_case(path) == case
    True
    """
    return case_of(*keys_and_origin(path))


def as_case(case: object) -> AnyCase:
    """Take a case in any of its forms.

    Parameters
    ----------
    case : path, mapping or case object
        A TOML file; or its keys and values, sections as mappings, quantities in SI or as text with units;
        relative paths then start at the working folder.

    Returns
    -------
    AnyCase
        Of the class of its kind, in SI.

    Raises
    ------
    InputError
        If it is none of these, or the file cannot be read.
    CaseError
        With all errors at once, if the keys are wrong.
    """
    return case if isinstance(case, AnyCase) else case_of(*keys_and_origin(case))


def keys_and_origin(case: object) -> tuple[dict[str, Any], Origin]:
    """Keys and values of a case in any of its forms, as `as_case` takes it, and where they come from."""
    if isinstance(case, AnyCase):
        return {"kind": case.kind, **in_toml(case, lambda _, value: value)}, FROM_PYTHON
    if isinstance(case, Mapping):
        return toml.plain_data(case), FROM_PYTHON
    allowed = "the path of a case file, its keys as a mapping, or a case object"
    path = file_path("case", case, allowed)
    remedy = f"Check the path, or write a case with 'asperity new {next(iter(PRESETS))} > case.toml'."
    return toml.read_toml(toml.read_definition(path, "case", remedy), "case", path), Origin.file(path)


def read_with_case(path: FilePath, what: str, remedy: str) -> tuple[dict[str, Any], dict[str, Any], Origin]:
    """Read a TOML file with a key ``case``, the path of a case, or a section with its keys.

    `what` the file is, and the remedy if it is missing, are for messages. Returns its other keys, and those
    of the case with their origin.
    """
    data = toml.read_toml(toml.read_definition(path, what, remedy), what, path)
    base = data.pop("case", None)
    if isinstance(base, dict):
        return data, base, Origin.file(path)
    if isinstance(base, str):
        return data, *keys_and_origin(Path(path).parent / base)
    received = "nothing" if base is None else shown(base)
    error = InputError("case", received, "the path of a case, or a section [case] with its keys")
    raise CaseError(str(path), [str(error)])


def parse_case(text: str, source: FilePath = "case") -> AnyCase:
    """Read a case from its text.

    Parameters
    ----------
    text : str
        The case in TOML.
    source : str or path
        Where the text comes from, for messages; relative paths in the case start at its folder.

    Returns
    -------
    AnyCase
        Of the class of its kind, in SI.

    Raises
    ------
    InputError
        If the text is no TOML.
    CaseError
        With all errors at once, if the keys are wrong.
    """
    return case_of(toml.read_toml(text, "case", source), Origin.file(source))


def case_of(data: dict[str, Any], origin: Origin = FROM_PYTHON) -> AnyCase:
    """Make a case of keys and values, sections as dicts; in SI.

    Raises
    ------
    InputError
        If there are more keys and values than a case can have.
    CaseError
        With all errors at once, if the keys are wrong.
    """
    toml.refuse_vast(data, origin.source)
    try:
        model = case_class(data.get("kind"))
    except InputError as error:
        raise CaseError(origin.source, [str(error)]) from None
    return model.read(data, origin)


def case_class(kind: object) -> type[AnyCase]:
    """Class of the cases of a kind, one of `kinds`; an `InputError` says if there is none."""
    if not isinstance(kind, str) or kind not in kinds():
        raise not_a_kind(kind, tuple(kinds()))
    if kind not in PRESETS:
        offer = next(each for each in extensions.offers(extensions.KINDS) if each.name == kind)
        return _installed_kind(kind, offer.load())
    module, _, name = PRESETS[kind].rpartition(".")
    model: type[AnyCase] = getattr(importlib.import_module(module), name)
    return model


def _installed_kind(kind: str, model: Any) -> type[AnyCase]:
    """Class of a kind that a package beside this one offers under a name."""
    what = f'kind of case "{kind}"'
    require(kind not in PRESETS, what, "a name of this program", "a name of its own")
    right = isinstance(model, type) and issubclass(model, AnyCase)
    require(right, what, shown(model), "a class of cases, as asperity.case.scene.Case")
    found: type[AnyCase] = model
    called = found.keys["kind"].default
    require(called == kind, what, f'a class whose key kind is "{called}"', f'kind = "{kind}"')
    return found


def case_classes() -> dict[str, type[AnyCase]]:
    """Classes of all kinds by name; one that cannot be imported is named in a warning, and left out."""
    own = {kind: case_class(kind) for kind in PRESETS}
    return own | extensions.taken(extensions.KINDS, _installed_kind)


def of_bodies(case: AnyCase, what: str) -> scene.Case:
    """A case of bodies that roll; an `InputError` says that another kind does not have what is asked."""
    if not isinstance(case, scene.Case):
        held = (kind for kind, model in case_classes().items() if issubclass(model, scene.Case))
        allowed = f"a kind that has it: {', '.join(held)}"
        raise InputError(what, f"a {case.kind} case, for which it is not available", allowed)
    return case


def not_a_kind(kind: object, names: Sequence[str]) -> InputError:
    """Error about a kind of case that this version does not have; None stands for a missing key."""
    allowed = ", ".join(f'"{name}"' for name in names)
    if kind is None:
        return InputError("kind", "nothing", allowed, f'Write kind = "{names[0]}" as the first line.')
    return InputError("kind", shown(kind), allowed, nearest(kind, list(names)))


def template(kind: str, laws: Sequence[str] = ()) -> str:
    """Write a commented case of a kind: each key with its value, meaning, what is allowed and default.

    With laws of one's own instead of the usual ones, where any are given: such as the kind can have.
    """
    model = case_class(kind)
    chosen = [spec_of(law).name for law in laws]
    own = {"laws": toml.toml_value(chosen)} if chosen else {}
    rolled = {family_of(law) for law in chosen or model.keys["laws"].default}
    shown_keys = {**dict.fromkeys(law_keys().keys() - rolled, ()), **model.SHOWN}
    keys = commented(model, {**model.WRITTEN_OUT, **own}, shown_keys)
    text = _HEAD.format(title=model.TITLE, needed=model.NEEDED) + keys
    if own:
        parse_case(text, f"a {kind} case")
    return text


def demo_case() -> AnyCase:
    """Return the case of ``asperity demo``: synthesised roughness, a few seconds of work."""
    return parse_case(packaged("case/demo.toml"), "demo.toml")
